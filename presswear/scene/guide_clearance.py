"""Guides with clearance: contacts at the four corners of a slide, with the laws of a bearing."""

import math
from dataclasses import fields, replace

from presswear.linkage.clearance_joint import deepest_wear
from presswear.linkage.guide_corner import (
    CORNERS,
    GuideCorner,
    corner_ends,
    turning_clearance,
)
from presswear.linkage.joints import Guide
from presswear.linkage.normal_law import NormalLaw
from presswear.linkage.surface import Surface
from presswear.scene.bearing import AUTO, LEAST_CLEARANCE, Bearing
from presswear.scene.conventions import Conventions
from presswear.scene.pin_joints import normal_law_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import written

# Settings of round bearings, which have no effect in a flat guide
_ROUND = (
    "bearing_radius",
    "elasticity",
    "viscosity",
    "film",
    "asperity_pressure",
    "roughness",
    "pressure_limit",
    "pv_limit",
    "angles",
    "wear_law",
)


def corners_of(
    bearing: Bearing, guide: Guide, walls: tuple[Surface, Surface]
) -> tuple[GuideCorner, ...]:
    """Return the corners of a slide in a guide with the clearance and laws of a bearing.

    ``walls`` are the surfaces of the left and the right wall. Without a contact
    stiffness, each corner is a line contact with the force F = (pi / 4) E* b delta, with
    the effective modulus E* of the materials, the total width b of the bearing and the
    penetration delta.
    """
    check_guide(bearing, guide)
    _, width = guide.size
    normal = _corner_normal(bearing)
    radius = 0.5 * width + bearing.clearance
    left_wall, right_wall = walls
    corners = []
    for name, (along, side) in CORNERS.items():
        corner = GuideCorner(
            f"{guide.name} {name}",
            *corner_ends(guide, along, side),
            radius,
            bearing.clearance,
            bearing.total_width,
            normal,
            bearing.friction_parameters,
            map_frame="fixed",
            contact="radial",
            bearing_surface=left_wall if side > 0.0 else right_wall,
            guide=guide,
            side=side,
        )
        corners.append(corner)
    return tuple(corners)


def _corner_normal(bearing: Bearing) -> NormalLaw:
    """Return the normal law of a corner of a slide."""
    if bearing.contact_stiffness is None:
        stiffness = 0.25 * math.pi * bearing.width / bearing.materials.compliance
        bearing = replace(bearing, contact_stiffness=stiffness, exponent=1.0)
    law = normal_law_of(bearing, Conventions(contact="radial"))
    return replace(law, elasticity="power")


def check_guide(bearing: Bearing, guide: Guide) -> None:
    """Raise InputError if a guide has no sizes, or its sizes do not fit the bearing."""
    if bearing.has_film:
        raise InputError(
            f"{guide.name}.film = run: a guide has no oil film; allowed is report"
        )
    if bearing.clearance == 0.0:
        raise InputError(
            f"{guide.name}.clearance = 0 m: a guide without clearance is ideal; allowed is "
            f"from {written(LEAST_CLEARANCE, 'm')}, or joints without {guide.name}"
        )
    for key in ("length", "width"):
        if getattr(guide, key) is None:
            raise InputError(
                f"{key} of {guide.name}: a guide with clearance needs it; set {key} of the "
                f"guide, or guide_{key} of a press or slider-crank, such as 300 mm"
            )
    _, width = guide.size
    if bearing.clearance > 0.5 * width:
        raise InputError(
            f"clearance of {guide.name} = {written(bearing.clearance, 'm')}: allowed is up to "
            f"half the width of the slide, {written(0.5 * width, 'm')}"
        )
    if bearing.clearance >= turning_clearance(guide):
        sizes = (written(size, "m") for size in guide.size)
        raise InputError(
            f"clearance of {guide.name} = {written(bearing.clearance, 'm')}: allowed is below "
            f"{written(turning_clearance(guide), 'm')}, with which a slide of "
            f"{' by '.join(sizes)} can turn over"
        )
    if bearing.elasticity not in (AUTO, "power"):
        raise InputError(
            f"{guide.name}.elasticity = {bearing.elasticity}: in a guide allowed is auto or power"
        )


def deepest_wall(bearing: Bearing, guide: Guide) -> float:
    """Return the depth up to which the model of a worn wall holds, m."""
    _, width = guide.size
    return deepest_wear("foundation", bearing.clearance, 0.5 * width)


def unread_in_guide(bearing: Bearing) -> tuple[str, ...]:
    """Return the names of the settings of a bearing that have no effect in a guide."""
    read = ("youngs_modulus", "bearing_modulus", "poisson_ratio", "wear_coefficient")
    unread = [
        setting.name
        for setting in fields(bearing.materials)
        if setting.name not in read
    ]
    return (*bearing.unread, *_ROUND, *unread)
