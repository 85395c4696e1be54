"""Overlap of a pin and its worn bearing in a cell: nodes, polynomials, roots and integrals.

In a cell the overlap is the polynomial through its values and derivatives at both
nodes (docs/theory/contact.md, equations W1, W2, W4 and W5).
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.physics.worn_map import (
    ARC_END,
    ARC_START,
    BEARING,
    COSINE,
    PIN,
    SINE,
    SLOPE,
    depth_at,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

NEWTON_TOL = 1e-3  # part of a cell; the next Newton step would be about its square
ROOT_TOL = 1e-8  # part of a cell; integrals change with the square of it
MAX_ROOT_STEPS = 60  # Newton's method needs two; bisection helps where it strays
# part of a cell, and of the slope that changes over it; Halley's next step would be
# about the cube
HALLEY_TOL = 0.01
HALLEY_STEPS = 3


class Place(NamedTuple):
    """Pin in the map of its bearing."""

    dx: float  # eccentricity in the frame of the map, m
    dy: float
    eccentricity: float  # m
    clearance: float  # m
    width: float  # width of a cell, rad
    # The pin's map is turned by lag + offset cells relative to the bearing's: whole cells,
    # and a part of a cell, 0 to 1.
    lag: int
    offset: float


@inlined
def place_of(
    joint: Records, dx: float, dy: float, eccentricity: float, relative_angle: float
) -> Place:
    """Return the place of a pin whose map is turned by a relative angle, rad, from the bearing's.

    ``dx`` and ``dy`` are the eccentricity in the frame of the bearing's map, m.
    """
    nodes = joint.surface_nodes
    turns = relative_angle * (0.5 / math.pi)
    position = (turns - np.floor(turns + 0.5)) * nodes
    before = np.floor(position)
    # In a trial state the angle may be so large that round-off leaves no place in a
    # cell.
    if not abs(before) <= nodes:
        position = before = 0.0
    return Place(
        dx,
        dy,
        eccentricity,
        joint.clearance,
        joint.cell_width,
        int(before),
        position - before,
    )


class Node(NamedTuple):
    """Overlap at a node of the bearing's map or at an end of an arc; derivatives are per cell."""

    nx: float  # cosine of its angle
    ny: float  # and sine
    along: float  # eccentricity in its direction, m
    overlap: float  # m
    rise: float  # derivative of the overlap, m
    pin_slope: float  # derivatives of the depth of the pin, m
    pin_curvature: float


@inlined
def node_at(surfaces: Array, place: Place, node: int) -> Node:
    """Return the overlap at a node of the bearing's map; equation W1."""
    column = np.uintp(node)
    nx = surfaces[COSINE, column]
    ny = surfaces[SINE, column]
    bearing_depth = surfaces[BEARING, column]
    bearing_slope = surfaces[BEARING + SLOPE, column]
    depth, slope, curvature = depth_at(surfaces, PIN, node + place.lag, place.offset)
    along = place.dx * nx + place.dy * ny
    overlap = along - place.clearance - bearing_depth - depth
    rise = place.width * (place.dy * nx - place.dx * ny) - bearing_slope - slope
    return Node(nx, ny, along, overlap, rise, slope, curvature)


class Cubic(NamedTuple):
    """Polynomial a_0 + a_1 x + ... + a_4 x^4 over a cell, x from 0 to 1."""

    a0: float
    a1: float
    a2: float
    a3: float
    a4: float


@inlined
def cubic_between(p0: float, d0: float, p1: float, d1: float, a4: float) -> Cubic:
    """Return the cubic through values and derivatives at both ends, plus a_4 x^2 (1 - x)^2."""
    rise = p1 - p0
    a2 = 3.0 * rise - 2.0 * d0 - d1
    a3 = d0 + d1 - 2.0 * rise
    return Cubic(p0, d0, a2 + a4, a3 - 2.0 * a4, a4)


@inlined
def fourth_order(left: Node, right: Node, width: float) -> float:
    """Return the coefficient a_4 of the overlap in a cell, ``width`` rad wide; equation W2."""
    square = width * width
    return (1 / 48) * square * square * (left.along + right.along)


@inlined
def overlap_between(left: Node, right: Node, width: float) -> Cubic:
    """Return the overlap in a cell, ``width`` rad wide, from that at its nodes; equation W2."""
    a4 = fourth_order(left, right, width)
    return cubic_between(left.overlap, left.rise, right.overlap, right.rise, a4)


@inlined
def value_at(p: Cubic, x: float) -> float:
    """Return the value of a polynomial."""
    return p.a0 + x * (p.a1 + x * (p.a2 + x * (p.a3 + x * p.a4)))


@inlined
def slope_at(p: Cubic, x: float) -> float:
    """Return the derivative of a polynomial."""
    return p.a1 + x * (2.0 * p.a2 + x * (3.0 * p.a3 + x * 4.0 * p.a4))


@inlined
def half_curvature_at(p: Cubic, x: float) -> float:
    """Return half of the second derivative of a polynomial."""
    return p.a2 + x * (3.0 * p.a3 + x * 6.0 * p.a4)


@inlined
def only_root(p: Cubic) -> float:
    """Return the only root of a polynomial in a cell at whose ends its signs differ.

    Halley's method starts from the parabola through both ends and the middle of the
    cubic.
    """
    first = p.a1 - 0.5 * p.a3
    half_curvature = p.a2 + 1.5 * p.a3
    size = math.sqrt(max(first * first - 4.0 * p.a0 * half_curvature, 0.0))
    x = -2.0 * p.a0 / (first + math.copysign(size, -p.a0))
    for _ in range(HALLEY_STEPS):
        value = value_at(p, x)
        slope = slope_at(p, x)
        half_curvature = half_curvature_at(p, x)
        step = value * slope / (slope * slope - value * half_curvature)
        x -= step
        change = abs(step * half_curvature)  # half of that of the slope over the step
        if abs(step) < HALLEY_TOL and change < HALLEY_TOL * abs(slope):
            break
    else:
        x = -1.0
    if 0.0 <= x <= 1.0:
        return x
    return root_between(p, 0.0, 1.0)


@compiled
def root_between(p: Cubic, low: float, high: float) -> float:
    """Return the root of a polynomial that is monotone between two places of different signs."""
    at_low = value_at(p, low)
    at_high = value_at(p, high)
    rises = at_high > 0.0
    # Start from the root of a parabola through both ends.
    first = (high - low) * slope_at(p, low)
    square = at_high - at_low - first
    size = math.sqrt(max(first * first - 4.0 * at_low * square, 0.0))
    divisor = first + size if rises else first - size
    x = low - 2.0 * at_low * (high - low) / divisor if divisor != 0.0 else low
    if not low <= x <= high:
        x = 0.5 * (low + high)
    for _ in range(MAX_ROOT_STEPS):
        value = value_at(p, x)
        slope = slope_at(p, x)
        if (value > 0.0) == rises:
            high = x
        else:
            low = x
        following = x - value / slope if slope != 0.0 else low
        tolerance = NEWTON_TOL
        if not low <= following <= high:
            following = 0.5 * (low + high)
            tolerance = ROOT_TOL
        if abs(following - x) < tolerance:
            return following
        x = following
    return x


@inlined
def maximum_of(p: Cubic) -> float:
    """Return where a polynomial has a maximum, or 2 without one.

    A Newton step from the maximum of the cubic, where the second derivative of that is
    minus twice the root, corrects for the small a_4.
    """
    square = p.a2 * p.a2 - 3.0 * p.a1 * p.a3
    if square <= 0.0:
        return 2.0
    root = math.sqrt(square)
    x = p.a1 / (root - p.a2) if root != p.a2 else 2.0
    return x + slope_at(p, x) * (0.5 / root)


@inlined
def turning_points(p: Cubic) -> tuple[float, float]:
    """Return where a cubic has its maximum and its minimum; 2 where there is none."""
    square = p.a2 * p.a2 - 3.0 * p.a1 * p.a3
    if square <= 0.0:
        return 2.0, 2.0
    root = math.sqrt(square)
    maximum = p.a1 / (root - p.a2) if root != p.a2 else 2.0
    minimum = -p.a1 / (root + p.a2) if root != -p.a2 else 2.0
    return maximum, minimum


class ArcIntegrals(NamedTuple):
    """Integrals over the arc where surfaces overlap, in the frame of the bearing's map."""

    x: float  # integral of p cos(theta), m rad
    y: float  # integral of p sin(theta), m rad
    pin_slope: float  # integral of p times the slope of the pin's map, m^2
    square: float  # integral of p^2, m^2 rad
    arcs: int  # number of arcs of overlap; see ARC_START


@inlined
def with_part(
    left: Node, right: Node, length: float, width: float, a4: float, sums: ArcIntegrals
) -> ArcIntegrals:
    """Return the integrals with a part of a cell that overlaps throughout; equations W4 and W5.

    ``length`` is its part of the cell, of ``width`` rad, whose polynomial has the
    coefficient a_4.
    """
    p0 = left.overlap
    d0 = length * left.rise
    p1 = right.overlap
    d1 = length * right.rise
    q = a4 * length * length * length * length
    l0 = 156.0 * p0 + 22.0 * d0 + 54.0 * p1 - 13.0 * d1 + 7.0 * q
    l1 = 22.0 * p0 + 4.0 * d0 + 13.0 * p1 - 3.0 * d1 + 1.5 * q
    l2 = 54.0 * p0 + 13.0 * d0 + 156.0 * p1 - 22.0 * d1 + 7.0 * q
    l3 = -13.0 * p0 - 3.0 * d0 - 22.0 * p1 + 4.0 * d1 - 1.5 * q
    middle = 7.0 * (p0 + p1) + 1.5 * (d0 - d1) + (2 / 3) * q
    turn = length * width
    scale = (1 / 420) * turn
    x = l0 * left.nx + l2 * right.nx - turn * (l1 * left.ny + l3 * right.ny)
    y = l0 * left.ny + l2 * right.ny + turn * (l1 * left.nx + l3 * right.nx)
    slope = l0 * left.pin_slope + l2 * right.pin_slope
    slope += length * (l1 * left.pin_curvature + l3 * right.pin_curvature)
    square = l0 * p0 + l1 * d0 + l2 * p1 + l3 * d1 + q * middle
    return ArcIntegrals(
        sums.x + scale * x,
        sums.y + scale * y,
        sums.pin_slope + scale * slope,
        sums.square + scale * square,
        sums.arcs,
    )


@inlined
def node_within(left: Node, right: Node, p: Cubic, width: float, x: float) -> Node:
    """Return the overlap at a place of a cell, ``width`` rad wide, between its nodes."""
    angle = width * x
    y = angle * angle
    cosine = 1.0 - y * (1 / 2 - y * (1 / 24))
    sine = angle * (1.0 - y * (1 / 6 - y * (1 / 120)))
    pin = cubic_between(
        left.pin_slope, left.pin_curvature, right.pin_slope, right.pin_curvature, 0.0
    )
    return Node(
        left.nx * cosine - left.ny * sine,
        left.ny * cosine + left.nx * sine,
        left.along,
        value_at(p, x),
        slope_at(p, x),
        value_at(pin, x),
        slope_at(pin, x),
    )


@inlined
def monotony(left: Node, right: Node) -> float:
    """Return a number below zero if the overlap between two nodes may rise and fall.

    Otherwise the differences of its Bezier points have one sign.
    """
    middle = 3.0 * (right.overlap - left.overlap) - left.rise - right.rise
    return min(left.rise * right.rise, min(left.rise * middle, middle * right.rise))


@inlined
def has_one_root(left: Node, right: Node) -> bool:
    """Return whether the overlap between two nodes of different signs has one root only.

    If the slopes have different signs the overlap turns once in the cell.
    """
    return (monotony(left, right) >= 0.0) | (left.rise * right.rise < 0.0)


@inlined
def inner_points(left: Node, right: Node) -> tuple[float, float]:
    """Return the inner two Bezier points of the cubic of a cell, which lies within all four."""
    return left.overlap + (1 / 3) * left.rise, right.overlap - (1 / 3) * right.rise


@compiled
def add_parts(
    surfaces: Array,
    place: Place,
    node: int,
    left: Node,
    right: Node,
    sums: ArcIntegrals,
) -> ArcIntegrals:
    """Return the integrals with those parts of a cell where the overlap is positive."""
    p = overlap_between(left, right, place.width)
    first = second = 2.0
    if monotony(left, right) < 0.0:
        maximum, minimum = turning_points(p)
        first = min(maximum, minimum)
        second = max(maximum, minimum)
    start = 0.0
    arcs = sums.arcs
    for end in (first, second, 1.0):
        if not start < end <= 1.0:
            continue
        low, high = start, end
        start = end
        at_low = value_at(p, low)
        at_high = value_at(p, high)
        if at_low <= 0.0 and at_high <= 0.0:
            continue
        if at_low <= 0.0:
            low = root_between(p, low, high)
            surfaces[ARC_START, arcs] = node + low
        elif at_high <= 0.0:
            high = root_between(p, low, high)
            surfaces[ARC_END, arcs] = node + high
            arcs += 1
        before = node_within(left, right, p, place.width, low) if low > 0.0 else left
        after = node_within(left, right, p, place.width, high) if high < 1.0 else right
        sums = with_part(before, after, high - low, place.width, p.a4, sums)
    return ArcIntegrals(sums.x, sums.y, sums.pin_slope, sums.square, arcs)
