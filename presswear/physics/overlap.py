"""Overlap of a pin and its bearing over a short arc, and its integrals.

Between neighbouring nodes of the two maps the overlap is a cubic and a cosine.  Over a segment
of a few hundredths of a radian its values and slopes at both ends give it to round-off: the cubic
through them, and of the cosine a term of fourth order that vanishes there.  A segment is
integrated from root to root of the overlap in closed form.
"""

import math
from typing import NamedTuple

from presswear.tools.compile import fused, fused_inlined

# Numba divides where it is told to; multiplying by these takes a fifth of the time.
THIRD, FIFTH, SEVENTH, NINTH = 1 / 3, 1 / 5, 1 / 7, 1 / 9
C2, C4, C6, C8, C10 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800
C3, C5, C7, C9, C11 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880, -1 / 39916800
"""Coefficients of the series of cosine and sine."""
ROOT_TOLERANCE = 1e-8
"""Part of half a segment; overlaps and sums change with the square of an error here."""
LAST_STEP = 1e-3
"""Part of half a segment; a step of Newton's method below it leaves its square, times a
curvature, behind."""
ROOT_STEPS = 60
"""Most steps to a root; Newton's method needs four, bisection helps where it strays."""


class Bed(NamedTuple):
    """Sums over a foundation of unit stiffness.

    Attributes
    ----------
    overlap : float
        Greatest overlap, m; below zero while open.
    place : float
        Its direction, rad from that of the eccentricity.
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


NOTHING = Bed(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Segment(NamedTuple):
    """The overlap as a polynomial a0 .. a4 in x, which runs from -1 to 1 over a segment.

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


@fused_inlined
def turned(x: float) -> tuple[float, float]:
    """Cosine and sine, the quicker way."""
    if abs(x) > 0.5:
        return math.cos(x), math.sin(x)
    return series(x)


@fused_inlined
def series(x: float) -> tuple[float, float]:
    """Cosine and sine of at most half a radian, to round-off."""
    y = x * x
    cosine = 1.0 + y * (C2 + y * (C4 + y * (C6 + y * (C8 + y * C10))))
    sine = x * (1.0 + y * (C3 + y * (C5 + y * (C7 + y * C9))))
    return cosine, sine


@fused_inlined
def mean_turned(half: float) -> float:
    """By what the sum of cosines, or sines, at both ends of a segment gives that of its middle."""
    y = half * half
    return 0.5 + y * (0.25 + y * (5.0 / 48.0 + y * (61.0 / 1440.0)))


@fused_inlined
def fourth_order(eccentricity: float, half: float) -> float:
    """What (x^2 - 1)^2 is multiplied by in a segment about the direction of e, m."""
    square = half * half
    return C4 * eccentricity * square * square


@fused_inlined
def segment_between(
    left: float,
    right: float,
    rise_left: float,
    rise_right: float,
    slope_left: float,
    slope_right: float,
    bend: float,
    quartic: float,
    half: float,
    cosine: float,
    sine: float,
) -> Segment:
    """The overlap of a segment from what it is at both ends.

    Parameters
    ----------
    left, right : float
        Overlaps, m.
    rise_left, rise_right : float
        Their derivatives by x, m.
    slope_left, slope_right : float
        Slopes of the bearing's map, m/rad.
    bend : float
        Half the second derivative by x of that slope, m/rad.
    quartic : float
        See ``fourth_order``.
    half, cosine, sine : float
        See ``Segment``.
    """
    fourth = quartic * cosine
    difference = 0.25 * (right - left)
    mean = 0.25 * (rise_left + rise_right)
    turn = 0.25 * (rise_right - rise_left)
    return Segment(
        0.5 * (left + right) - turn + fourth,
        3.0 * difference - mean,
        turn - 2.0 * fourth,
        mean - difference,
        fourth,
        0.5 * (slope_left + slope_right) - bend,
        0.5 * (slope_right - slope_left),
        bend,
        half,
        cosine,
        sine,
    )


@fused_inlined
def hull(
    left: float, right: float, rise_left: float, rise_right: float, quartic: float
) -> tuple[float, float]:
    """Bounds below and above the overlap of a segment, m; see ``segment_between``.

    A cubic lies within its Bezier points.
    """
    second = left + 2.0 * THIRD * rise_left
    third = right - 2.0 * THIRD * rise_right
    low = min(min(left, right), min(second, third))
    high = max(max(left, right), max(second, third))
    return low - quartic, high + quartic


@fused_inlined
def value_at(g: Segment, x: float) -> float:
    """Overlap at a place of a segment, m."""
    return g.a0 + x * (g.a1 + x * (g.a2 + x * (g.a3 + x * g.a4)))


@fused_inlined
def rise_at(g: Segment, x: float) -> float:
    """Derivative of the overlap by x, m."""
    return g.a1 + x * (2.0 * g.a2 + x * (3.0 * g.a3 + x * 4.0 * g.a4))


@fused_inlined
def bend_at(g: Segment, x: float) -> float:
    """Second derivative of the overlap by x, m."""
    return 2.0 * g.a2 + x * (6.0 * g.a3 + x * 12.0 * g.a4)


@fused
def root_between(
    g: Segment, of_rise: bool, low: float, high: float, at_low: float, at_high: float
) -> float:
    """Root of the overlap or of its derivative between two places at which their signs differ."""
    rises = at_high > at_low
    # The root of the parabola that the first coefficients make, else the secant's.
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
        enough = LAST_STEP
        if not low <= following <= high:
            following, enough = 0.5 * (low + high), ROOT_TOLERANCE
        if abs(following - x) < enough:
            return following
        x = following
    return x


@fused_inlined
def add_whole(g: Segment, bed: Bed) -> Bed:
    """The bed with all of a segment."""
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
    return Bed(
        bed.overlap,
        bed.place,
        bed.along + g.cosine * even - g.sine * odd,
        bed.across + g.sine * even + g.cosine * odd,
        bed.slope + length * (g.b0 * m0 + g.b1 * m1 + g.b2 * m2),
        bed.square + length * square,
        bed.area + length * m0,
    )


@fused_inlined
def part_of(g: Segment, low: float, high: float) -> Segment:
    """The part of a segment between two of its places, as a segment."""
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


@fused_inlined
def inflection(g: Segment) -> float:
    """Inflection of the overlap in a segment, or its end where there is none.

    The second derivative is all but linear: two steps of Newton's method from the
    secant's root leave nothing.
    """
    low = bend_at(g, -1.0)
    high = bend_at(g, 1.0)
    if (low > 0.0) == (high > 0.0):
        return 1.0
    x = (low + high) / (low - high)
    for _ in range(2):
        third = 6.0 * g.a3 + x * 24.0 * g.a4
        if third != 0.0:
            x = min(max(x - bend_at(g, x) / third, -1.0), 1.0)
    return x


@fused_inlined
def is_monotone(g: Segment) -> bool:
    """True where the coefficients tell that the overlap rises, or falls, all over a segment."""
    return abs(g.a1) > 2.0 * abs(g.a2) + 3.0 * abs(g.a3) + 4.0 * abs(g.a4)


@fused_inlined
def extremum(g: Segment, low: float, high: float) -> float:
    """Extremum of the overlap between two places with a monotone slope, or the second place."""
    if high <= low:
        return high
    at_low = rise_at(g, low)
    at_high = rise_at(g, high)
    if (at_low > 0.0) == (at_high > 0.0):
        return high
    return root_between(g, True, low, high, at_low, at_high)


@fused_inlined
def between_roots(
    g: Segment, low: float, high: float, at_low: float, at_high: float
) -> tuple[float, float]:
    """Ends of the pressed part between two places with a monotone overlap of which one is."""
    if at_low < 0.0:
        low = root_between(g, False, low, high, at_low, at_high)
    elif at_high < 0.0:
        high = root_between(g, False, low, high, at_low, at_high)
    return low, high


@fused
def pressed_part(g: Segment) -> tuple[float, float]:
    """Ends of the only pressed part of a segment; the second before the first where others are."""
    start, end = value_at(g, -1.0), value_at(g, 1.0)
    if not is_monotone(g):
        return 1.0, -1.0
    if start <= 0.0 and end <= 0.0:
        return 1.0, 1.0
    return between_roots(g, -1.0, 1.0, start, end)


@fused
def add_monotone(
    g: Segment, low: float, high: float, at_low: float, at_high: float, bed: Bed
) -> Bed:
    """The bed with the pressed part between two places with a monotone overlap."""
    if high <= low or (at_low <= 0.0 and at_high <= 0.0):
        return bed
    low, high = between_roots(g, low, high, at_low, at_high)
    return add_whole(part_of(g, low, high), bed)


@fused
def add_pressed(g: Segment, bed: Bed) -> Bed:
    """The bed with the pressed parts of a segment.

    Most are monotone, as their coefficients tell.  Else the overlap is so between the ends, the
    inflection and the extremes to both sides of that.
    """
    start, end = value_at(g, -1.0), value_at(g, 1.0)
    if is_monotone(g):
        return add_monotone(g, -1.0, 1.0, start, end, bed)
    turn = inflection(g)
    first = extremum(g, -1.0, turn)
    second = extremum(g, turn, 1.0)
    at_first = value_at(g, first)
    at_turn = at_first if first == turn else value_at(g, turn)
    at_second = at_turn if second == turn else value_at(g, second)
    bed = add_monotone(g, -1.0, first, start, at_first, bed)
    bed = add_monotone(g, first, turn, at_first, at_turn, bed)
    bed = add_monotone(g, turn, second, at_turn, at_second, bed)
    return add_monotone(g, second, 1.0, at_second, end, bed)


@fused_inlined
def with_peak(bed: Bed, overlap: float, place: float) -> Bed:
    """The bed with an overlap at a place, where it is the greatest so far."""
    if overlap <= bed.overlap:
        return bed
    return Bed(overlap, place, bed.along, bed.across, bed.slope, bed.square, bed.area)


@fused
def with_peak_of(g: Segment, middle: float, bed: Bed) -> Bed:
    """The bed with the greatest overlap of a segment, where it is the greatest so far."""
    bed = with_peak(bed, value_at(g, -1.0), middle - g.half)
    bed = with_peak(bed, value_at(g, 1.0), middle + g.half)
    if is_monotone(g):
        return bed
    turn = inflection(g)
    first = extremum(g, -1.0, turn)
    bed = with_peak(bed, value_at(g, first), middle + g.half * first)
    second = extremum(g, turn, 1.0)
    return with_peak(bed, value_at(g, second), middle + g.half * second)
