"""Linkage of a scene: bearings in the joints of the ideal linkage, and wear maps of walls."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner, WallMap, slide_inertia
from presswear.linkage.joints import Guide, Joint
from presswear.linkage.linkage import Linkage
from presswear.linkage.part_checks import check_inertias
from presswear.linkage.surface import Surface
from presswear.physics.ideal import IdealMotion
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import Conventions
from presswear.scene.guide_clearance import corners_of
from presswear.scene.pin_joints import clearance_joint, rigid_joint
from presswear.tools.arrays import Array

# Additional length of a map at each end, part of the length over which the slide rubs
_MARGIN = 0.01


def with_bearings(
    ideal: Linkage,
    bearings: Mapping[str, Bearing],
    conventions: Conventions,
    surfaces: Mapping[str, tuple[Surface, Surface]],
) -> Linkage:
    """Return a linkage with the bearings of its joints.

    Parameters
    ----------
    ideal : Linkage
        Linkage with ideal joints.
    bearings : mapping of str to Bearing
        Bearings by joint. A pin with a clearance of 0 stays rigid, with friction.
    conventions : Conventions
    surfaces : mapping of str to pair of Surface
        Worn surfaces of bearing and pin by joint, of the left and the right wall by
        guide; the other ones are round, or flat.

    Raises
    ------
    InputError
        A body that a guide with clearance lets turn has no inertia.
    """
    round_surfaces = Surface(), Surface()
    joints: list[Joint] = []
    loose_pins: list[ClearanceJoint] = []
    loose_guides: list[Guide] = []
    corners: list[GuideCorner] = []
    for joint in ideal.joints:
        bearing = bearings.get(joint.name)
        worn = surfaces.get(joint.name, round_surfaces)
        if bearing is None:
            joints.append(joint)
        elif isinstance(joint, Guide):
            loose_guides.append(joint)
            corners += corners_of(bearing, joint, worn)
        elif bearing.clearance > 0.0:
            loose_pins.append(clearance_joint(bearing, joint, conventions, worn))
        else:
            joints.append(rigid_joint(bearing, joint))
    bodies = tuple(_with_inertia(body, loose_guides) for body in ideal.bodies)
    if loose_guides:
        tight = [joint for joint in joints if isinstance(joint, Guide)]
        check_inertias(bodies, tight, ideal.drives)
    clearances = (*ideal.clearances, *loose_pins, *corners)
    loosened = replace(
        ideal, bodies=bodies, joints=tuple(joints), clearances=clearances
    )
    return loosened.released


def _with_inertia(body: Body, loose_guides: Sequence[Guide]) -> Body:
    """Return a body; a slide that can tilt has by default the inertia of a block."""
    for guide in loose_guides:
        if guide.body == body.name and body.inertia == 0.0:
            return replace(body, inertia=slide_inertia(body.mass, guide))
    return body


def with_wall_maps(
    linkage: Linkage, ideal: IdealMotion, bearings: Mapping[str, Bearing]
) -> Linkage:
    """Return a linkage whose corners have the wear maps of their walls, if their bearings wear.

    Parameters
    ----------
    linkage : Linkage
        With the bearings in its joints.
    ideal : IdealMotion
        Motion of all slides without clearance.
    bearings : mapping of str to Bearing
        Bearings by guide.
    """
    maps = {}
    for guide in linkage.loose_guides:
        coefficient = bearings[guide.name].materials.wear_coefficient
        if coefficient > 0.0:
            maps[guide.name] = _wall_map(guide, ideal, coefficient)

    clearances = list(linkage.clearances)
    for k, joint in enumerate(clearances):
        if isinstance(joint, GuideCorner):
            clearances[k] = replace(joint, wall=maps.get(joint.guide.name))
    return replace(linkage, clearances=tuple(clearances))


def _wall_map(guide: Guide, ideal: IdealMotion, coefficient: float) -> WallMap:
    """Return the map of both walls of a guide, from the positions of its slide."""
    slide_length, _ = guide.size
    x, y = _slide_in_frame(guide, ideal)
    cosine = math.cos(guide.direction)
    sine = math.sin(guide.direction)
    along = cosine * (x - guide.x) + sine * (y - guide.y)
    length = float(np.ptp(along)) + slide_length
    margin = _MARGIN * length
    start = float(along.min()) - 0.5 * slide_length - margin
    return WallMap(coefficient, start, (1.0 + 2.0 * _MARGIN) * length)


def _slide_in_frame(guide: Guide, ideal: IdealMotion) -> tuple[Array, Array]:
    """Return x and y of a slide, m, shape (n,) each, in the axes of the body with the walls."""
    linkage = ideal.rows.linkage
    x, y, _ = ideal.position[:, linkage.index(guide.body)].T
    if not guide.is_moving:
        return x, y
    carrier_x, carrier_y, angle = ideal.position[:, linkage.index(guide.on)].T
    dx = x - carrier_x
    dy = y - carrier_y
    cosine = np.cos(angle)
    sine = np.sin(angle)
    return cosine * dx + sine * dy, cosine * dy - sine * dx
