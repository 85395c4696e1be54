"""Wear maps of the walls of guides, over the range of the slide in the ideal motion."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner, WallMap
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import IdealMotion
from presswear.scene.bearing import Bearing
from presswear.tools.arrays import Array

# Additional length of a map at each end, part of the length over which the slide rubs
_MARGIN = 0.01


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

    def with_map(joint: ClearanceJoint) -> ClearanceJoint:
        if not isinstance(joint, GuideCorner):
            return joint
        return replace(joint, wall=maps.get(joint.guide.name))

    return replace(linkage, clearances=tuple(map(with_map, linkage.clearances)))


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
