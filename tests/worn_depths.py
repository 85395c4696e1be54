"""Depths of worn surfaces as the elastic foundation sees them, by splines of scipy."""

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from presswear.linkage.surface import Surface
from presswear.physics.worn_map import parts_of

TURN = 2.0 * math.pi


def periodic(surface: Surface) -> CubicHermiteSpline:
    """Return the depth of a map over three turns from -2 pi."""
    depth = surface.depth
    slope = surface.slope
    angles = (np.arange(3 * depth.size) - depth.size + 0.5) * TURN / depth.size
    return CubicHermiteSpline(angles, np.tile(depth, 3), np.tile(slope, 3))


def depths(
    bearing: Surface, pin: Surface, *places: float
) -> tuple[CubicHermiteSpline, CubicHermiteSpline]:
    """Return the depths of bearing and pin by the angle from the direction of the eccentricity.

    Between nodes of the bearing that of the pin is the cubic through its values and
    slopes there.
    """
    count = max(bearing.depth.size, pin.depth.size)
    nodes = count * parts_of(count)
    zero = (places[0] * nodes / TURN) % 1.0
    at = (np.arange(-nodes, nodes) + 0.5 - zero) * TURN / nodes
    found = []
    for surface, place in zip((bearing, pin), places, strict=True):
        curve = periodic(surface if surface.depth.size else Surface(np.zeros(count)))
        angles = (place + at) % TURN
        found.append(CubicHermiteSpline(at, curve(angles), curve(angles, 1)))
    return found[0], found[1]
