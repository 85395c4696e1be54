"""Depths of worn surfaces as the elastic foundation sees them, by splines of scipy."""

import math

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from two_bodies import Pair

from presswear.linkage.surface import Surface
from presswear.physics.contact import direction_of
from presswear.physics.worn_map import parts_of
from presswear.tools.arrays import Array

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


def fine_overlaps(pair: Pair, count: int) -> list[Array]:
    """Return the overlap of a contact on the maps of bearing and pin, each (count, 400).

    Each of the ``count`` bins of a map is a row of 400 equal parts.
    """
    joint = pair.joint
    contact = pair.contact()
    direction = direction_of(contact)
    places = direction - float(joint.map_frame == "body") * pair.q[[2, 5]]
    surfaces = joint.bearing_surface, joint.pin_surface
    if not joint.pin_surface.is_worn:
        surfaces = Surface(np.zeros(count)), Surface(np.zeros(count))
    bearing, pin = depths(*surfaces, *places)
    fine = (np.arange(400 * count) + 0.5) * TURN / (400 * count)
    overlaps = []
    for place in places:
        angle = np.remainder(fine - place + math.pi, TURN) - math.pi
        gap = joint.clearance + bearing(angle) + pin(angle)
        overlap = np.maximum(contact.eccentricity * np.cos(angle) - gap, 0.0)
        overlaps.append(overlap.reshape(count, 400))
    return overlaps
