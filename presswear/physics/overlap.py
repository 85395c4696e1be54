"""Overlap of two worn surfaces over a short segment of the arc, and its integrals.

Over a segment of a few hundredths of a radian between neighbouring nodes of the two maps, the
overlap is a cubic through its values and slopes at both ends, and of the cosine a term of fourth
order that vanishes at both ends.  Each segment is integrated in closed form from root to root of
the overlap.
"""

import math
from typing import NamedTuple

from presswear.tools.compile import fused, fused_inlined

# Multiplication by these constants is faster than the division that numba would compile.
THIRD, FIFTH, SEVENTH, NINTH = 1 / 3, 1 / 5, 1 / 7, 1 / 9
# Coefficients of the series of cosine and sine.
C2, C4, C6, C8, C10 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800
C3, C5, C7, C9, C11 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880, -1 / 39916800
ROOT_TOLERANCE = 1e-8  # of half a segment; integrals change with the square of an error here
NEWTON_TOLERANCE = 1e-3  # of half a segment; the error left by a Newton step is its square
ROOT_STEPS = 60  # most steps to a root; Newton's method needs about four


class ArcIntegrals(NamedTuple):
    """Integrals of the overlap p over the pressed arc, for a foundation of unit stiffness.

    Attributes
    ----------
    overlap : float
        Greatest overlap, m; negative while the joint is open.
    place : float
        Its direction, rad from the direction of the eccentricity.
    along, across : float
        Integrals of p cos(s) and p sin(s), m rad.
    slope : float
        Integral of p times the slope of the bearing's map, m^2.
    square : float
        Integral of p^2, m^2 rad.
    area : float
        Integral of p, m rad.
    """

    overlap: float
    place: float
    along: float
    across: float
    slope: float
    square: float
    area: float


class Segment(NamedTuple):
    """The overlap as a polynomial a0 .. a4 in x, which runs from -1 to 1 over a segment.

    ``b0 + b1 x + b2 x^2`` is the slope of the bearing's map, ``half`` half the length, rad;
    ``cosine`` and ``sine`` belong to the middle, from the direction of the eccentricity.
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


@fused_inlined
def cosine_and_sine(x: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, rad: up to half a radian by series, to round-off."""
    if abs(x) > 0.5:
        return math.cos(x), math.sin(x)
    y = x * x
    cosine = 1.0 + y * (C2 + y * (C4 + y * (C6 + y * (C8 + y * C10))))
    return cosine, x * (1.0 + y * (C3 + y * (C5 + y * (C7 + y * C9))))


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
    """Return the root of the overlap, or of its derivative, between two places of different sign.

    Newton's method, with bisection where it leaves the interval.
    """
    rises = at_high > at_low
    # Start at the root of the parabola of the first coefficients, else of the secant.
    c0, c1, c2 = (g.a1, 2.0 * g.a2, 3.0 * g.a3) if of_rise else (g.a0, g.a1, g.a2)
    size = math.sqrt(max(c1 * c1 - 4.0 * c0 * c2, 0.0))
    slope = c1 + (size if rises else -size)
    x = -2.0 * c0 / slope if slope != 0.0 else low
    if not low < x < high:
        x = low - at_low * (high - low) / (at_high - at_low)
    for _ in range(ROOT_STEPS):
        value = rise_at(g, x) if of_rise else value_at(g, x)
        slope = bend_at(g, x) if of_rise else rise_at(g, x)
        if (value > 0.0) == rises:
            high = x
        else:
            low = x
        following = x - value / slope if slope != 0.0 else low
        enough = NEWTON_TOLERANCE
        if not low <= following <= high:
            following, enough = 0.5 * (low + high), ROOT_TOLERANCE
        if abs(following - x) < enough:
            return following
        x = following
    return x


@fused_inlined
def extremum(g: Segment, low: float, high: float) -> float:
    """Return the extremum of the overlap between two places, or the second place if none."""
    if high <= low:
        return high
    at_low, at_high = rise_at(g, low), rise_at(g, high)
    if (at_low > 0.0) == (at_high > 0.0):
        return high
    return root_between(g, True, low, high, at_low, at_high)


@fused_inlined
def is_monotone(g: Segment) -> bool:
    """Return whether the coefficients show that the overlap is monotone over a segment."""
    return abs(g.a1) > 2.0 * abs(g.a2) + 3.0 * abs(g.a3) + 4.0 * abs(g.a4)


@fused
def monotone_parts(g: Segment) -> tuple[float, float, float]:
    """Return the extremum before the inflection, the inflection, and the extremum behind it.

    Between these places the overlap is monotone; a place that does not exist is 1.
    """
    if is_monotone(g):
        return 1.0, 1.0, 1.0
    low, high = bend_at(g, -1.0), bend_at(g, 1.0)
    turn = 1.0
    if (low > 0.0) != (high > 0.0):
        # Two Newton steps suffice because the second derivative is nearly linear.
        turn = (low + high) / (low - high)
        for _ in range(2):
            third = 6.0 * g.a3 + turn * 24.0 * g.a4
            if third != 0.0:
                turn = min(max(turn - bend_at(g, turn) / third, -1.0), 1.0)
    return extremum(g, -1.0, turn), turn, extremum(g, turn, 1.0)


@fused_inlined
def part_of(g: Segment, low: float, high: float) -> Segment:
    """Return the part of a segment between two of its places, as a segment."""
    m, s = 0.5 * (low + high), 0.5 * (high - low)
    square = s * s
    cosine, sine = cosine_and_sine(g.half * m)
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


@fused_inlined
def add_whole(g: Segment, sums: ArcIntegrals) -> ArcIntegrals:
    """Return the integrals with a segment that is pressed from end to end."""
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
    # Integrals of p cos and p sin of the angle from the middle.
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
def with_peak(sums: ArcIntegrals, overlap: float, place: float) -> ArcIntegrals:
    """Return the integrals with an overlap at a place, if it is the greatest so far."""
    if overlap <= sums.overlap:
        return sums
    return ArcIntegrals(overlap, place, sums.along, sums.across, sums.slope, sums.square, sums.area)


@fused_inlined
def between_roots(
    g: Segment, low: float, high: float, at_low: float, at_high: float
) -> tuple[float, float]:
    """Return the ends of the pressed part between two places with a monotone overlap."""
    if at_low < 0.0:
        low = root_between(g, False, low, high, at_low, at_high)
    elif at_high < 0.0:
        high = root_between(g, False, low, high, at_low, at_high)
    return low, high


@fused
def add_parts(g: Segment, middle: float, sums: ArcIntegrals) -> ArcIntegrals:
    """Return the integrals with the pressed parts of a segment and its greatest overlap.

    Parameters
    ----------
    middle : float
        Angle of its middle from the direction of the eccentricity, rad.
    """
    low, at_low = -1.0, value_at(g, -1.0)
    sums = with_peak(sums, at_low, middle - g.half)
    first, turn, second = monotone_parts(g)
    for high in (first, turn, second, 1.0):
        if high <= low:
            continue
        at_high = value_at(g, high)
        sums = with_peak(sums, at_high, middle + g.half * high)
        if at_low > 0.0 or at_high > 0.0:
            left, right = between_roots(g, low, high, at_low, at_high)
            sums = add_whole(part_of(g, left, right), sums)
        low, at_low = high, at_high
    return sums


@fused
def pressed_part(g: Segment) -> tuple[float, float]:
    """Return the ends of the only pressed part; the second before the first if more may exist."""
    if not is_monotone(g):
        return 1.0, -1.0
    start, end = value_at(g, -1.0), value_at(g, 1.0)
    if start <= 0.0 and end <= 0.0:
        return 1.0, 1.0
    return between_roots(g, -1.0, 1.0, start, end)


@fused_inlined
def area_until(g: Segment, x: float) -> float:
    """Return the integral of the overlap of a segment from its middle to a place, m rad."""
    area = g.a0 + x * (0.5 * g.a1 + x * (THIRD * g.a2 + x * (0.25 * g.a3 + x * FIFTH * g.a4)))
    return g.half * x * area


@fused_inlined
def pressed_area(g: Segment, low: float, high: float, start: float, end: float) -> float:
    """Return the integral of the overlap over the pressed parts between two places, m rad.

    Parameters
    ----------
    start, end : float
        Ends of the only pressed part; the second before the first if there may be others.
    """
    if end < start:
        nothing = ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        return add_parts(part_of(g, low, high), 0.0, nothing).area
    if low >= end or high <= start:
        return 0.0
    return area_until(g, min(high, end)) - area_until(g, max(low, start))
