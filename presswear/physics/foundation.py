"""Worn surfaces and the elastic foundation between a round pin and its worn bearing.

The overlap at an angle s from the direction of the eccentricity e is
p(s) = e cos(s) - c - h_bearing - h_pin, the pressure k_w p where p > 0. The elastic energy is the
integral of k_w b R p^2 / 2 over the angle; force and couples are its gradient. A pin cannot enter
a groove narrower than itself: grooves are bridged, and two patches need no case of their own.

The arc is integrated segment by segment between neighbouring nodes of the two maps. Over a
segment of a few hundredths of a radian the values and slopes of the overlap at both ends give it
to round-off: the cubic through them, and of the cosine a term of fourth order that vanishes at
both ends (``segment.py``).
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.linkage.surface import Surface
from presswear.physics.segment import (
    C3,
    C4,
    C5,
    C7,
    C9,
    C11,
    NOWHERE,
    THIRD,
    ArcIntegrals,
    Place,
    add_pressed,
    add_whole,
    cell_of,
    onward,
    segment_between,
    share_out,
    turned,
    with_peak,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled, fused, fused_inlined
from presswear.tools.lanes import anywhere, lane_of, lanes_at, where

# Rows of each surface, of the bearing from 0 and of the pin from 5: depth, m, and slope, m/rad, at
# the bin centres; coefficients of x^2 and x^3 of the cubic after each, m/rad^2 and m/rad^3; bound
# on the distance of this cubic and the next from a chord over one bin, m. Then cosine and sine of
# the angles of the bins from the first. The first columns follow the last once more.
BEARING, PIN, COSINE, SINE, ROWS = 0, 5, 10, 11, 12
SLOPE, SQUARE, CUBE, BULGE, SIDE_ROWS = 1, 2, 3, 4, 5
TOGETHER = 4  # cells that are tried at once
SURFACES = np.zeros((ROWS, 1))  # example of the type of packed surfaces, contiguous

MAX_SEGMENT = 0.02  # rad; longer segments would show the terms that are left out


def pack_rows(bearing: Surface, pin: Surface, count: int) -> Array:
    """Return the rows of both maps of ``count`` bins, shape (ROWS, count + TOGETHER)."""
    rows = np.zeros((ROWS, count))
    width = 2.0 * math.pi / count
    for side, surface in ((BEARING, bearing), (PIN, pin)):
        if surface.is_worn:
            part = rows[side : side + SIDE_ROWS]
            depth, slope = surface.depth, surface.slope
            following, following_slope = np.roll(depth, -1), np.roll(slope, -1)
            secant = (following - depth) / width
            part[0], part[SLOPE] = depth, slope
            part[SQUARE] = (3.0 * secant - 2.0 * slope - following_slope) / width
            part[CUBE] = (slope + following_slope - 2.0 * secant) / width**2
            bend = np.maximum(abs(part[SQUARE]), abs(part[SQUARE] + 3.0 * width * part[CUBE]))
            part[BULGE] = 0.25 * width**2 * np.maximum(bend, np.roll(bend, -1))
    angles = width * np.arange(count)
    rows[COSINE], rows[SINE] = np.cos(angles), np.sin(angles)
    return np.pad(rows, ((0, 0), (0, TOGETHER)), "wrap")


def foundation_stiffness(stiffness: float, clearance: float) -> float:
    """Return k_w b R, N/m^2 per rad, with which a round joint gives K delta^1.5.

    The overlap of a round joint is delta - c s^2 / 2. Its integral over the arc is
    (4/3) sqrt(2 / c) delta^1.5; the curvature of the arc adds parts of delta / c.
    """
    return 0.75 * stiffness * math.sqrt(0.5 * clearance)


@compiled
def bin_of(angle: float, count: int) -> int:
    """Return the index of the bin that holds an angle, rad."""
    return math.floor(angle * count / (2.0 * math.pi)) % count


@fused_inlined
def depth_at(surfaces: Array, row: int, k: int, x: float) -> tuple[float, float]:
    """Return depth, m, and slope, m/rad, of a map x rad after its node ``k``."""
    c1, c2, c3 = surfaces[row + SLOPE, k], surfaces[row + SQUARE, k], surfaces[row + CUBE, k]
    return surfaces[row, k] + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + x * 3.0 * c3)


@fused_inlined
def profile(surfaces: Array, row: int, count: int, angle: float) -> tuple[float, float, float]:
    """Return depth, m, slope, m/rad, and second derivative of a map of ``count`` bins at an angle.

    The second derivative, m/rad^2, jumps at the bin centres.
    """
    if count == 0:
        return 0.0, 0.0, 0.0
    k, x = cell_of(angle, count, 0.5)
    depth, slope = depth_at(surfaces, row, k, x)
    return depth, slope, 2.0 * surfaces[row + SQUARE, k] + 6.0 * x * surfaces[row + CUBE, k]


class Fit(NamedTuple):
    """Pin in its bearing; see ``press``."""

    eccentricity: float
    clearance: float
    bearing_place: float
    pin_place: float


@fused_inlined
def place_at(
    fit: Fit, surfaces: Array, bearing: int, pin: int, bearing_x: float, pin_x: float, angle: float
) -> Place:
    """Return the overlap at an angle, rad, and at ways into cells of both maps, rad."""
    depth, slope = depth_at(surfaces, BEARING, bearing, bearing_x)
    pin_depth, pin_slope = depth_at(surfaces, PIN, pin, pin_x)
    cosine, sine = turned(angle)
    overlap = fit.eccentricity * cosine - fit.clearance - depth - pin_depth
    return Place(overlap, -fit.eccentricity * sine - slope - pin_slope, slope, cosine, sine)


@fused_inlined
def overlap_at_nodes(
    surfaces: Array, b: int, p: int, i: int, pin_x: float, along: float, across: float
) -> float:
    """Return overlap plus clearance at some nodes of the bearing, from ``b``, in lanes, m.

    The pin's cells from ``p`` hold them ``pin_x`` rad from their nodes. ``along`` and ``across``
    are parts of the eccentricity, m, from which node ``i`` of a turn is that of ``b``.
    """
    depth = lanes_at(surfaces, BEARING, b) + lanes_at(surfaces, PIN, p)
    c1, c2 = lanes_at(surfaces, PIN + SLOPE, p), lanes_at(surfaces, PIN + SQUARE, p)
    depth += pin_x * (c1 + pin_x * (c2 + pin_x * lanes_at(surfaces, PIN + CUBE, p)))
    return along * lanes_at(surfaces, COSINE, i) - across * lanes_at(surfaces, SINE, i) - depth


@fused_inlined
def add_part(
    fit: Fit,
    surfaces: Array,
    b: int,
    p: int,
    cell: float,
    offset: float,
    pin_x: float,
    half: float,
    pieces: int,
    left: Place,
    sums: ArcIntegrals,
    shares: Array,
) -> tuple[Place, ArcIntegrals]:
    """Return the end of a part of a cell, and the sums with it; see ``press``.

    The part begins ``offset`` rad from the start of the cell, which is ``cell`` rad from the
    eccentricity, and has ``pieces`` segments; its nodes of the pin are ``pin_x`` rad further on.
    """
    cube = surfaces[BEARING + CUBE, b]
    quartic = C4 * fit.eccentricity * half * half * half * half
    for j in range(pieces):
        since = offset + 2.0 * j * half
        end = since + 2.0 * half
        right = place_at(fit, surfaces, b, p, end, end + pin_x, cell + end)
        # A cubic lies within its Bezier points.
        second = left.overlap + 2.0 * THIRD * half * left.rise
        third = right.overlap - 2.0 * THIRD * half * right.rise
        low = min(min(left.overlap, right.overlap), min(second, third)) - quartic
        high = max(max(left.overlap, right.overlap), max(second, third)) + quartic
        if high > 0.0 or high > sums.overlap:
            g = segment_between(left, right, half, quartic, cube)
            if high > sums.overlap:
                sums = with_peak(g, cell + since, sums)
            places = fit.bearing_place + cell + since, fit.pin_place + cell + since
            if low <= 0.0 < high:
                sums = add_pressed(g, sums, *places, shares)
            elif low > 0.0:
                sums = add_whole(g, sums)
                if shares.shape[1] > 0:
                    share_out(g, -1.0, 1.0, *places, shares)
        left = right
    return left, sums


@fused
def press(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
    shares: Array,
) -> ArcIntegrals:
    """Return the sums of a pin in its bearing, and spread the overlap over bins.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, m)
    count : int
        Bins of both maps.
    least_depth : float
        Sum of the least depths of both, m.
    bearing_place, pin_place : float
        Direction of the eccentricity in the maps of bearing and pin, rad.
    shares : ndarray, shape (2, n)
        The integrals of the overlap over n bins of bearing and pin, m rad, are added; n may be 0.
    """
    fit = Fit(eccentricity, clearance, bearing_place, pin_place)
    width = 2.0 * math.pi / count
    b, into = cell_of(bearing_place, count, 0.5)
    p, p_x = cell_of(pin_place, count, 0.5)
    here = depth_at(surfaces, BEARING, b, into)[0] + depth_at(surfaces, PIN, p, p_x)[0]
    # Beyond ``end`` the overlap is negative and less than here: 1 - cos(s) = rise / e.
    rise = max(here, eccentricity - clearance) - least_depth
    part = min(max(0.5 * rise / eccentricity, 0.0), 1.0) if eccentricity > 0.0 else 1.0
    sine = math.sqrt(part)
    end = 2.0 * sine * (1.0 + (0.5 * math.pi - 1.0) * sine * sine) + 1e-9  # above 2 asin(sine)
    ahead = max(math.ceil((end - into) / width), 0)
    cells = min(ahead + math.ceil((end + into) / width), count)
    # Every cell of the bearing holds a node of the pin at the same place.
    node = width - p_x + into
    if node > width:
        node -= width
        p -= 1
    rest = width - node
    before, behind = max(math.ceil(node / MAX_SEGMENT), 1), max(math.ceil(rest / MAX_SEGMENT), 1)
    half_before, half_behind = 0.5 * node / before, 0.5 * rest / behind
    b, p = (b - ahead + 2 * count) % count, (p - ahead + 2 * count) % count
    start = -ahead * width - into
    cosine, sine = turned(start)
    parts = rest, eccentricity * cosine, eccentricity * sine
    # Overlap plus clearance at the ends of a cell that touches; e width^2 / 8 is the bulge of the
    # cosine, the rest more than round-off
    needed = clearance - 0.126 * eccentricity * width * width
    sums = ArcIntegrals(eccentricity - clearance - here, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    left, left_cell = NOWHERE, -1
    for first in range(0, cells, TOGETHER):
        # Most cells are passed over: overlap at both ends and bulges bound it from above.
        bounds = overlap_at_nodes(surfaces, b, p, first, *parts)
        following = overlap_at_nodes(surfaces, b + 1, p + 1, first + 1, *parts)
        bounds = where(following > bounds, following, bounds)
        bounds += lanes_at(surfaces, BEARING + BULGE, b) + lanes_at(surfaces, PIN + BULGE, p)
        if anywhere(bounds > needed + min(sums.overlap, 0.0)):
            for i in range(first, min(first + TOGETHER, cells)):
                if lane_of(bounds, i - first) <= needed + min(sums.overlap, 0.0):
                    continue
                k, m, cell = (b + i - first) % count, (p + i - first) % count, start + i * width
                if left_cell != i:
                    left = place_at(fit, surfaces, k, m, 0.0, rest, cell)
                left, sums = add_part(
                    *(fit, surfaces, k, m, cell, 0.0, rest, half_before, before, left, sums, shares)
                )
                m = m + 1 if m + 1 < count else 0
                left, sums = add_part(
                    *(fit, surfaces, k, m, cell, node, -node, half_behind, behind),
                    *(left, sums, shares),
                )
                left_cell = i + 1
        b, p = b + TOGETHER, p + TOGETHER
        b, p = b - count if b >= count else b, p - count if p >= count else p
    return sums


@fused_inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Return the integral of the overlap of a round pin from the direction of e to x, m rad."""
    y = x * x
    short = math.sin(x) - x
    if y < 0.25:  # the difference cancels
        short = x * y * (C3 + y * (C5 + y * (C7 + y * (C9 + y * C11))))
    return (eccentricity - clearance) * x + eccentricity * short


@fused
def spread_round(
    eccentricity: float, clearance: float, bearing_place: float, pin_place: float, shares: Array
) -> None:
    """Spread the overlap over bins as ``press``, of surfaces without wear."""
    if eccentricity <= clearance:
        return
    bins = shares.shape[1]
    width = 2.0 * math.pi / bins
    end = 2.0 * math.asin(math.sqrt(0.5 * (eccentricity - clearance) / eccentricity))
    b_bin, b_way = cell_of(bearing_place - end, bins, 0.0)
    p_bin, p_way = cell_of(pin_place - end, bins, 0.0)
    left, until = -end, round_area(eccentricity, clearance, -end)
    while left < end:
        length = min(min(width - b_way, width - p_way), end - left)
        left += length
        before, until = until, round_area(eccentricity, clearance, left)
        share = max(until - before, 0.0)  # at its end it is nothing but round-off
        shares[0, b_bin] += share
        shares[1, p_bin] += share
        b_bin, b_way = onward(b_bin, b_way, length, width, bins)
        p_bin, p_way = onward(p_bin, p_way, length, width, bins)
