"""Wear along arcs of overlap: integrals of the overlap over the bins of both maps."""

import math
from typing import NamedTuple

import numpy as np

from presswear.physics.foundation import integrate_overlap
from presswear.physics.overlap import Cubic, Place, node_at, overlap_between
from presswear.physics.worn_map import (
    ARC_COUNT,
    ARC_END,
    ARC_PLACE,
    ARC_START,
    PLACE_LAG,
    PLACE_X,
    PLACE_Y,
    bin_of,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined


@inlined
def count_arcs(surfaces: Array, joint: Records, place: Place, angle: float) -> int:
    """Return the number of arcs of overlap, whose ends are in the surfaces.

    ``integrate_overlap`` is called if its last call was at another place.
    """
    last = surfaces[ARC_PLACE]
    is_same = (
        last[PLACE_X] == place.dx
        and last[PLACE_Y] == place.dy
        and last[PLACE_LAG] == place.lag + place.offset
    )
    if not is_same:
        integrate_overlap(surfaces, joint, place, angle)
    return int(last[ARC_COUNT])


@inlined
def area_at(p: Cubic, x: float) -> float:
    """Return the integral of a polynomial from 0."""
    higher_terms = (1 / 3) * p.a2 + x * ((1 / 4) * p.a3 + x * (1 / 5) * p.a4)
    return x * (p.a0 + x * ((1 / 2) * p.a1 + x * higher_terms))


class Edge(NamedTuple):
    """Next edge between two bins of a map, on the way along its cells."""

    place: float  # in cells after the present node
    bin: int  # before the edge


@inlined
def edge_after(position: float, parts: float, bins: int) -> Edge:
    """Return the first edge after a position, in cells from the start of a map.

    A bin is ``parts`` cells wide.
    """
    before = np.floor(position / parts)
    return Edge(parts * (before + 1.0) - position, int(before) % bins)


@inlined
def share_cell(
    p: Cubic, low: float, high: float, edge: Edge, parts: float, shares: Array
) -> Edge:
    """Add the integral of the overlap in a part of a cell to the bins of a map, (n,).

    Return the first edge after the cell. At an end of an arc the overlap is nothing but
    round-off.
    """
    place, k = edge
    before = area_at(p, low)
    while place < high:
        area = area_at(p, max(place, low))
        shares[k] += max(area - before, 0.0)
        before = area
        place += parts
        k = k + 1 if k + 1 < shares.shape[0] else 0
    shares[k] += max(area_at(p, high) - before, 0.0)
    return Edge(place - 1.0, k)


@compiled
def share_arc(
    surfaces: Array, joint: Records, place: Place, arc: int, shares: Array
) -> None:
    """Add the integrals of the overlap over an arc to the bins of bearing and pin, shape (2, n)."""
    start, end = surfaces[ARC_START, arc], surfaces[ARC_END, arc]
    first = int(start)
    bins = shares.shape[1]
    parts = joint.surface_nodes / bins
    bearing = edge_after(first + 0.5, parts, bins)
    pin = edge_after(first + 0.5 + place.lag + place.offset, parts, bins)
    left = node_at(surfaces, place, first)
    for node in range(first, int(np.ceil(end))):
        right = node_at(surfaces, place, node + 1)
        p = overlap_between(left, right, place.width)
        low = max(start - node, 0.0)
        high = min(end - node, 1.0)
        bearing = share_cell(p, low, high, bearing, parts, shares[0])
        pin = share_cell(p, low, high, pin, parts, shares[1])
        left = right


@inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Return the integral of the overlap of a round pin from the direction of e to x, m rad.

    It is e sin x - c x = (e - c) x + e (sin x - x), which does not cancel at small x.
    """
    y = x * x
    if y < 0.25:  # power series of the sine up to x^11
        series = 1 / 5040 - y * (1 / 362880 - y * (1 / 39916800))
        sine_minus_x = -x * y * (1 / 6 - y * (1 / 120 - y * series))
    else:
        sine_minus_x = math.sin(x) - x
    return (eccentricity - clearance) * x + eccentricity * sine_minus_x


@compiled
def deposit_round(
    eccentricity: float,
    clearance: float,
    direction: float,
    half: float,
    depth_sum: float,
    depth: Array,
) -> None:
    """Add depths in proportion to the overlap of round surfaces to the bins of a map, shape (n,).

    The arc reaches ``half`` rad to both sides of the direction of e in the map.
    ``depth_sum`` is the sum of the depths, m.
    """
    count = depth.shape[0]
    overlap = round_area(eccentricity, clearance, half)
    if not overlap > 0.0:
        depth[bin_of(direction, count)] += depth_sum
        return
    # The area is odd in x, so that the whole arc has twice that up to its end.
    scale = 0.5 * depth_sum / overlap
    width = 2.0 * math.pi / count
    k = int(np.floor((direction - half) / width))
    place = k % count
    x = -half
    before = -overlap
    while x < half:
        k += 1
        x = min(max(k * width - direction, x), half)
        area = round_area(eccentricity, clearance, x)
        # At the end of the arc the overlap is nothing but round-off.
        depth[place] += scale * max(area - before, 0.0)
        before = area
        place = place + 1 if place + 1 < count else 0
