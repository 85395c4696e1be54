"""Worn walls of a guide with clearance, along their length: dV = K_d F_n ds.

V is the worn volume, K_d the wear coefficient, F_n the normal force on a corner of the slide
and s its sliding distance.

A map holds the mean depth of equal bins along a wall. Both corners of the slide on the
side of the wall wear it, over its width, and the slide does not wear. Between the
middles of the bins a worn wall is the monotone cubic of ``linkage.surface``.
"""

import math

import numpy as np

from presswear.linkage.guide_corner import WALL_BINS, GuideCorner, WallMap, largest_tilt
from presswear.linkage.linkage import Linkage
from presswear.physics.worn_map import BEARING, depth_at
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

_BEARING_SIDE = 0  # index of the bearing in the maps of a joint


@inlined
def wall_profile(
    joint: Records, surfaces: Array, along: float
) -> tuple[float, float, float]:
    """Return depth, m, slope and second derivative, 1/m, of a wall at a place along it, m.

    Beyond the middles of the bins at both ends the wall is flat.
    """
    bins = joint.surface_bins
    if bins == 0:
        return 0.0, 0.0, 0.0
    length = joint.wall_bin
    position = (along - joint.wall_start) / length - 0.5
    if not 0.0 <= position < bins - 1.0:
        end = 0 if position < 0.0 else bins - 1
        return surfaces[BEARING, end], 0.0, 0.0
    node = int(position)
    depth, slope, curvature = depth_at(surfaces, BEARING, node, position - node)
    return depth, slope / length, curvature / (length * length)


@compiled
def deposit_on_wall(
    depth: Array,
    k: int,
    joint: Records,
    contact: Records,
    load_distance: float,
    h: float,
) -> None:
    """Add the wear of a load distance F_n ds, N m, of corner ``k`` to its wall.

    ``depth`` has the depths of all joints, m, shape (joints, 2, bins). The depths of a
    wall are stored twice, at both of its corners. The wear is spread over the distance
    that the corner moves in a step of ``h`` seconds.
    """
    end = (contact.place - joint.wall_start) / joint.wall_bin
    start = end - joint.wall_sense * contact.sliding * h / joint.wall_bin
    depth_sum = joint.wear_coefficient * load_distance / (joint.width * joint.wall_bin)
    spread_along(depth[k, 0], start, end, depth_sum)
    spread_along(depth[joint.wall_partner, 0], start, end, depth_sum)


@compiled
def spread_along(depth: Array, start: float, end: float, depth_sum: float) -> None:
    """Spread a sum of depths, m, evenly over the bins between two places, in bins.

    The part beyond an end of the map is added to the bin at this end.
    """
    last = depth.shape[0] - 1
    low = min(max(min(start, end), 0.0), float(last))
    high = min(max(max(start, end), 0.0), float(last + 1))
    first = int(low)
    if not high - low > 0.0 or high <= first + 1.0:
        depth[first] += depth_sum
        return
    for k in range(first, min(math.ceil(high), last + 1)):
        fraction = min(high, k + 1.0) - max(low, float(k))
        depth[k] += depth_sum * fraction / (high - low)


def bin_centres_of(wall: WallMap) -> Array:
    """Return the places of the bins of a wall along its guide, from its point, m, (bins,)."""
    bins = np.arange(WALL_BINS, dtype=np.float64)
    return wall.start + (bins + 0.5) * wall.bin_length


def wall_volume(corner: GuideCorner, depth: Array) -> float:
    """Return the worn volume of a wall, m^3, from its depths, m, shape (bins,)."""
    assert corner.wall is not None
    return float(depth.sum()) * corner.width * corner.wall.bin_length


def tilt_between(corner: GuideCorner, walls: Array) -> float:
    """Return the largest tilt of a slide between two worn walls, rad.

    ``walls`` are the depths of the left and the right wall, m, shape (2, bins). At some
    place along the guide two opposite corners touch rigid walls.
    """
    widest = float(openings_between(corner, walls).max())
    return largest_tilt(corner.guide, corner.clearance + 0.5 * widest)


def openings_between(corner: GuideCorner, walls: Array) -> Array:
    """Return the sum of the worn depths at two opposite corners of a slide, m.

    The shape is (2, places along the guide), for a tilt to either side. ``walls`` are the
    depths of the left and the right wall, m, shape (2, bins).
    """
    guide = corner.guide
    wall = corner.wall
    assert guide.length is not None
    assert wall is not None
    place = bin_centres_of(wall)
    front = place[place - guide.length >= wall.start]
    back = front - guide.length
    depth_at_front = np.array([np.interp(front, place, depth) for depth in walls])
    depth_at_back = np.array([np.interp(back, place, depth) for depth in walls])
    return np.asarray(depth_at_front + depth_at_back[::-1])


def walls_of(linkage: Linkage, maps: Array) -> dict[str, Array]:
    """Return the left and the right wall of each guide from maps of all joints.

    Parameters
    ----------
    linkage : Linkage
    maps : ndarray, shape (..., joints, 2, bins)
        Depths, m. Those of a wall are stored twice, as the bearing of both corners on
        its side.

    Returns
    -------
    dict of str to ndarray, shape (..., 2, WALL_BINS)
        Depths, m, by guide.
    """
    corners: dict[str, dict[float, int]] = {}  # index of a corner, by guide and side
    for k, joint in enumerate(linkage.clearances):
        if isinstance(joint, GuideCorner) and joint.wall is not None:
            corners.setdefault(joint.guide.name, {})[joint.side] = k
    walls = {}
    for name, by_side in corners.items():
        left_and_right = [by_side[1.0], by_side[-1.0]]
        walls[name] = maps[..., left_and_right, _BEARING_SIDE, :WALL_BINS]
    return walls
