"""Segments of the elastic foundation: overlap as a polynomial, and its integrals.

A segment is integrated from root to root of the overlap in closed form; see ``foundation.py``.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.compile import fused, fused_inlined

ROOT_TOL = 1e-8  # part of half a segment; overlaps and sums change with the square of it
NEWTON_TOL = 1e-3  # part of half a segment; the next Newton step would be about its square
MAX_ROOT_STEPS = 60  # Newton's method needs four; bisection helps where it strays

# Numba divides where it is told to; a product takes a fifth of the time.
THIRD, FIFTH, SEVENTH, NINTH = 1 / 3, 1 / 5, 1 / 7, 1 / 9
C2, C4, C6, C8, C10 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800  # series of the cosine
C3, C5, C7, C9, C11 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880, -1 / 39916800  # and of the sine


@fused_inlined
def cell_of(angle: float, count: int, shift: float) -> tuple[int, float]:
    """Return the cell that holds an angle, rad, and the way into it, rad.

    The first of ``count`` cells begins at the part ``shift`` of a cell.
    """
    turn = angle * (0.5 / math.pi)
    position = (turn - np.floor(turn)) * count - shift
    before = np.floor(position)
    width = 2.0 * math.pi / count
    cell = int(before)
    if cell < 0:
        cell += count
    # In a trial state the angle may be so large that round-off leaves no place in a cell.
    if not 0 <= cell < count:
        return 0, 0.0
    return cell, min(max((position - before) * width, 0.0), width)


class ArcIntegrals(NamedTuple):
    """Sums over a foundation of unit stiffness."""

    overlap: float  # greatest, m; below zero while open
    place: float  # its direction, rad from that of the eccentricity
    along: float  # integral of p cos(s), m rad
    across: float  # of p sin(s), m rad
    slope: float  # of p times the slope of the bearing's map, m^2
    square: float  # of p^2, m^2 rad
    area: float  # of p, m rad


class Segment(NamedTuple):
    """Overlap as a polynomial a0 .. a4 in x, which runs from -1 to 1 over a segment.

    ``b0 + b1 x + b2 x^2`` is the slope of the bearing's map, ``half`` half the length, rad;
    ``cosine`` and ``sine`` are those of the middle, from the direction of the eccentricity.
    """

    a0: float
    a1: float
    a2: float
    a3: float
    a4: float
    b0: float
    b1: float
    b2: float
    half: float
    cosine: float
    sine: float


class Place(NamedTuple):
    """Overlap, m, its derivative and the slope of the bearing's map, m/rad; cosine and sine."""

    overlap: float
    rise: float
    slope: float
    cosine: float
    sine: float


NOWHERE = Place(0.0, 0.0, 0.0, 0.0, 0.0)


@fused_inlined
def series(x: float) -> tuple[float, float]:
    """Return cosine and sine of at most half a radian, to round-off."""
    y = x * x
    cosine = 1.0 + y * (C2 + y * (C4 + y * (C6 + y * (C8 + y * C10))))
    return cosine, x * (1.0 + y * (C3 + y * (C5 + y * (C7 + y * C9))))


@fused_inlined
def turned(x: float) -> tuple[float, float]:
    """Return cosine and sine the quicker way."""
    if abs(x) > 0.5:
        return math.cos(x), math.sin(x)
    return series(x)


@fused_inlined
def segment_between(left: Place, right: Place, half: float, quartic: float, cube: float) -> Segment:
    """Return the overlap of a segment from the overlap at both ends.

    ``quartic`` is e half^4 / 24, m, the factor of (x^2 - 1)^2 where the direction is that of e;
    ``cube`` the coefficient of the cube of the bearing's map, m/rad^3.
    """
    y = half * half
    # From the sum of the cosines of both ends to the cosine of the middle.
    scale = 0.5 + y * (0.25 + y * (5.0 / 48.0 + y * (61.0 / 1440.0)))
    cosine, sine = scale * (left.cosine + right.cosine), scale * (left.sine + right.sine)
    fourth = quartic * cosine
    difference = 0.25 * (right.overlap - left.overlap)
    mean = 0.25 * half * (left.rise + right.rise)
    turn = 0.25 * half * (right.rise - left.rise)
    bend = 3.0 * y * cube
    return Segment(
        0.5 * (left.overlap + right.overlap) - turn + fourth,
        3.0 * difference - mean,
        turn - 2.0 * fourth,
        mean - difference,
        fourth,
        0.5 * (left.slope + right.slope) - bend,
        0.5 * (right.slope - left.slope),
        bend,
        half,
        cosine,
        sine,
    )


@fused_inlined
def value_at(g: Segment, x: float) -> float:
    """Return the overlap at a place of a segment, m."""
    return g.a0 + x * (g.a1 + x * (g.a2 + x * (g.a3 + x * g.a4)))


@fused_inlined
def rise_at(g: Segment, x: float) -> float:
    """Return the derivative of the overlap by x, m."""
    return g.a1 + x * (2.0 * g.a2 + x * (3.0 * g.a3 + x * 4.0 * g.a4))


@fused_inlined
def bend_at(g: Segment, x: float) -> float:
    """Return the second derivative of the overlap by x, m."""
    return 2.0 * g.a2 + x * (6.0 * g.a3 + x * 12.0 * g.a4)


@fused
def root_between(
    g: Segment, of_rise: bool, low: float, high: float, at_low: float, at_high: float
) -> float:
    """Return a root of the overlap, or of its derivative, between places of different signs."""
    rises = at_high > at_low
    # Start from the root of the parabola of the first coefficients, else from the secant's.
    c0, c1, c2 = (g.a1, 2.0 * g.a2, 3.0 * g.a3) if of_rise else (g.a0, g.a1, g.a2)
    size = math.sqrt(max(c1 * c1 - 4.0 * c0 * c2, 0.0))
    slope = c1 + (size if rises else -size)
    x = -2.0 * c0 / slope if slope != 0.0 else low
    if not low < x < high:
        x = low - at_low * (high - low) / (at_high - at_low)
    for _ in range(MAX_ROOT_STEPS):
        value = rise_at(g, x) if of_rise else value_at(g, x)
        slope = bend_at(g, x) if of_rise else rise_at(g, x)
        if (value > 0.0) == rises:
            high = x
        else:
            low = x
        following = x - value / slope if slope != 0.0 else low
        tolerance = NEWTON_TOL
        if not low <= following <= high:
            following, tolerance = 0.5 * (low + high), ROOT_TOL
        if abs(following - x) < tolerance:
            return following
        x = following
    return x


@fused_inlined
def add_whole(g: Segment, sums: ArcIntegrals) -> ArcIntegrals:
    """Return the sums with all of a segment."""
    # Means of p x^n.
    m0 = g.a0 + g.a2 * THIRD + g.a4 * FIFTH
    m1 = g.a1 * THIRD + g.a3 * FIFTH
    m2 = g.a0 * THIRD + g.a2 * FIFTH + g.a4 * SEVENTH
    m3 = g.a1 * FIFTH + g.a3 * SEVENTH
    m4 = g.a0 * FIFTH + g.a2 * SEVENTH
    s2 = g.a1 * g.a1 + 2.0 * g.a0 * g.a2
    s4 = g.a2 * g.a2 + 2.0 * (g.a0 * g.a4 + g.a1 * g.a3)
    s6 = g.a3 * g.a3 + 2.0 * g.a2 * g.a4
    square = g.a0 * g.a0 + s2 * THIRD + s4 * FIFTH + s6 * SEVENTH + g.a4 * g.a4 * NINTH
    length = 2.0 * g.half
    y = g.half * g.half
    # Integrals of p cos and p sin of the way from the middle.
    even = length * (m0 + y * (C2 * m2 + y * C4 * m4))
    odd = length * g.half * (m1 + y * C3 * m3)
    return ArcIntegrals(
        sums.overlap,
        sums.place,
        sums.along + g.cosine * even - g.sine * odd,
        sums.across + g.sine * even + g.cosine * odd,
        sums.slope + length * (g.b0 * m0 + g.b1 * m1 + g.b2 * m2),
        sums.square + length * square,
        sums.area + length * m0,
    )


@fused_inlined
def part_of(g: Segment, low: float, high: float) -> Segment:
    """Return the part of a segment between two of its places, as a segment."""
    m, s = 0.5 * (low + high), 0.5 * (high - low)
    square = s * s
    cosine, sine = series(g.half * m)
    return Segment(
        value_at(g, m),
        s * rise_at(g, m),
        square * 0.5 * bend_at(g, m),
        s * square * (g.a3 + 4.0 * m * g.a4),
        square * square * g.a4,
        g.b0 + m * (g.b1 + m * g.b2),
        s * (g.b1 + 2.0 * m * g.b2),
        square * g.b2,
        s * g.half,
        g.cosine * cosine - g.sine * sine,
        g.cosine * sine + g.sine * cosine,
    )


@fused
def turning_points(g: Segment) -> tuple[float, float, float]:
    """Return the places between which, and the ends, the overlap of a segment is monotone.

    The inflection in the middle and an extremum to each side of it; 1 where there is none.
    """
    if abs(g.a1) > 2.0 * abs(g.a2) + 3.0 * abs(g.a3) + 4.0 * abs(g.a4):
        return 1.0, 1.0, 1.0
    low, high = bend_at(g, -1.0), bend_at(g, 1.0)
    middle = 1.0
    if (low > 0.0) != (high > 0.0):
        # The second derivative is all but linear: two Newton steps from the secant's root do.
        middle = (low + high) / (low - high)
        for _ in range(2):
            third = 6.0 * g.a3 + middle * 24.0 * g.a4
            if third != 0.0:
                middle = min(max(middle - bend_at(g, middle) / third, -1.0), 1.0)
    start, at_middle, end = rise_at(g, -1.0), rise_at(g, middle), rise_at(g, 1.0)
    first, second = middle, 1.0
    if middle > -1.0 and (start > 0.0) != (at_middle > 0.0):
        first = root_between(g, True, -1.0, middle, start, at_middle)
    if middle < 1.0 and (at_middle > 0.0) != (end > 0.0):
        second = root_between(g, True, middle, 1.0, at_middle, end)
    return first, middle, second


@fused_inlined
def with_peak(g: Segment, start: float, sums: ArcIntegrals) -> ArcIntegrals:
    """Return the sums with the greatest overlap of a segment that starts at an angle, rad."""
    peak, place = sums.overlap, sums.place
    first, _, second = turning_points(g)
    for x in (-1.0, first, second, 1.0):
        if value_at(g, x) > peak:
            peak, place = value_at(g, x), start + g.half * (1.0 + x)
    return ArcIntegrals(peak, place, sums.along, sums.across, sums.slope, sums.square, sums.area)


@fused_inlined
def onward(cell: int, x: float, length: float, width: float, count: int) -> tuple[int, float]:
    """Return cell and way into it a length further on, which ends in the cell or with it."""
    x += length
    if x >= width * (1.0 - 1e-14):
        return (cell + 1 if cell + 1 < count else 0), 0.0
    return cell, x


@fused_inlined
def area_until(g: Segment, x: float) -> float:
    """Return the integral of the overlap of a segment from its middle to a place, m rad."""
    fourth = g.a3 * 0.25 + x * g.a4 * FIFTH
    return g.half * x * (g.a0 + x * (g.a1 * 0.5 + x * (g.a2 * THIRD + x * fourth)))


@fused
def share_out(
    g: Segment, low: float, high: float, bearing_place: float, pin_place: float, shares: Array
) -> None:
    """Add the integral of the overlap of a segment between two of its places, bin by bin.

    The segment begins at ``bearing_place`` and ``pin_place``, rad, in the maps. See ``press``.
    """
    bins = shares.shape[1]
    width = 2.0 * math.pi / bins
    way = (low + 1.0) * g.half
    b_bin, b_way = cell_of(bearing_place + way, bins, 0.0)
    p_bin, p_way = cell_of(pin_place + way, bins, 0.0)
    place, until = low, area_until(g, low)
    while place < high:
        length = min(width - b_way, width - p_way)
        rest = (high - place) * g.half
        place = place + length / g.half if length < rest else high
        length = min(length, rest)
        before, until = until, area_until(g, place)
        share = max(until - before, 0.0)  # at its end the overlap is nothing but round-off
        shares[0, b_bin] += share
        shares[1, p_bin] += share
        b_bin, b_way = onward(b_bin, b_way, length, width, bins)
        p_bin, p_way = onward(p_bin, p_way, length, width, bins)


@fused
def add_pressed(
    g: Segment, sums: ArcIntegrals, bearing_place: float, pin_place: float, shares: Array
) -> ArcIntegrals:
    """Return the sums with the pressed parts of a segment, and share these out."""
    first, middle, second = turning_points(g)
    start = -1.0
    for end in (first, middle, second, 1.0):
        low, high = start, end
        start = end
        at_low, at_high = value_at(g, low), value_at(g, high)
        if high <= low or (at_low <= 0.0 and at_high <= 0.0):
            continue
        if at_low < 0.0:
            low = root_between(g, False, low, high, at_low, at_high)
        elif at_high < 0.0:
            high = root_between(g, False, low, high, at_low, at_high)
        sums = add_whole(part_of(g, low, high), sums)
        if shares.shape[1] > 0:
            share_out(g, low, high, bearing_place, pin_place, shares)
    return sums
