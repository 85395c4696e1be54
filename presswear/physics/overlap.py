"""Overlap of a pin and its bearing over a short arc, and its integrals.

Between neighbouring nodes of the two maps the overlap is smooth: a cubic and a cosine,
which a polynomial of degree six gives to round-off over a segment of a tenth of a radian.
Each segment is integrated from root to root of the overlap with Gauss points enough for
its square.
"""

import math
from typing import NamedTuple

from presswear.tools.compiled import compiled, inlined

ABSCISSAE = (0.8611363115940526, 0.3399810435848563)
WEIGHTS = (0.3478548451374538, 0.6521451548625461)
"""Four-point Gauss-Legendre quadrature, symmetric halves."""
# Numba divides where it is told to; multiplying by these takes a fifth of the time.
THIRD, FIFTH, SEVENTH, NINTH, TWELFTH = 1 / 3, 1 / 5, 1 / 7, 1 / 9, 1 / 12
C2, C4, C6, C8, C10 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800
C3, C5, C7, C9 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880
"""Coefficients of the series of cosine and sine."""
ROOT_TOLERANCE = 1e-10
"""rad; overlaps and sums change with the square of an error here."""
LEAST_BEND = 1e-300
"""m/rad^2; keeps a division from zero."""
LAST_STEP = 1e-6
"""rad; a step of Newton's method below it leaves its square, times a curvature, behind."""
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
    """The overlap as a polynomial a0 .. a6 in x, rad from the segment's middle.

    ``b1 + b2 x + b3 x^2`` is the slope of the bearing's map; ``cosine`` and ``sine`` are
    those of the middle, from the direction of the eccentricity.
    """

    a0: float
    a1: float
    a2: float
    a3: float
    a4: float
    a5: float
    a6: float
    b1: float
    b2: float
    b3: float
    cosine: float
    sine: float


@inlined
def turned(x: float) -> tuple[float, float]:
    """Cosine and sine, the quicker way."""
    if abs(x) > 0.5:
        return math.cos(x), math.sin(x)
    return series(x)


@inlined
def series(x: float) -> tuple[float, float]:
    """Cosine and sine of at most half a radian, to round-off."""
    y = x * x
    cosine = 1.0 + y * (C2 + y * (C4 + y * (C6 + y * (C8 + y * C10))))
    sine = x * (1.0 + y * (C3 + y * (C5 + y * (C7 + y * C9))))
    return cosine, sine


@inlined
def value_at(g: Segment, x: float) -> float:
    """Overlap at a place of a segment, m."""
    return g.a0 + x * (g.a1 + x * (g.a2 + x * (g.a3 + x * (g.a4 + x * (g.a5 + x * g.a6)))))


@inlined
def slope_at(g: Segment, x: float) -> float:
    """Derivative of the overlap at a place of a segment, m/rad."""
    return g.a1 + x * (
        2.0 * g.a2 + x * (3.0 * g.a3 + x * (4.0 * g.a4 + x * (5.0 * g.a5 + x * 6.0 * g.a6)))
    )


@inlined
def bend_at(g: Segment, x: float) -> float:
    """Second derivative of the overlap at a place of a segment, m/rad^2."""
    return 2.0 * g.a2 + x * (6.0 * g.a3 + x * (12.0 * g.a4 + x * (20.0 * g.a5 + x * 30.0 * g.a6)))


@compiled
def root_between(
    g: Segment, of_slope: bool, low: float, high: float, at_low: float, at_high: float
) -> float:
    """Root of the overlap or of its slope between two places at which their signs differ."""
    rises = at_high > at_low
    # The root of the parabola that the first coefficients make, else the secant's.
    c0, c1, c2 = (g.a1, 2.0 * g.a2, 3.0 * g.a3) if of_slope else (g.a0, g.a1, g.a2)
    size = math.sqrt(max(c1 * c1 - 4.0 * c0 * c2, 0.0))
    slope = c1 + (size if rises else -size)
    x = -2.0 * c0 / slope if slope != 0.0 else low
    if not low < x < high:
        x = low - at_low * (high - low) / (at_high - at_low)
    for _ in range(ROOT_STEPS):
        value = slope_at(g, x) if of_slope else value_at(g, x)
        slope = bend_at(g, x) if of_slope else slope_at(g, x)
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


@inlined
def mean_of(g: Segment, y: float) -> float:
    """Mean overlap of a segment, m, from the square of half its length, rad^2."""
    return g.a0 + y * (g.a2 * THIRD + y * (g.a4 * FIFTH + y * g.a6 * SEVENTH))


@inlined
def add_whole(g: Segment, half: float, bed: Bed) -> Bed:
    """The bed with all of a segment, integrated in closed form."""
    y = half * half
    m0 = mean_of(g, y)
    m1 = y * (g.a1 * THIRD + y * (g.a3 * FIFTH + y * g.a5 * SEVENTH))
    m2 = y * (g.a0 * THIRD + y * (g.a2 * FIFTH + y * g.a4 * SEVENTH))
    m3 = y * y * (g.a1 * FIFTH + y * g.a3 * SEVENTH)
    m4 = y * y * (g.a0 * FIFTH + y * g.a2 * SEVENTH)
    s2 = g.a1 * g.a1 + 2.0 * g.a0 * g.a2
    s4 = g.a2 * g.a2 + 2.0 * (g.a0 * g.a4 + g.a1 * g.a3)
    s6 = g.a3 * g.a3 + 2.0 * (g.a0 * g.a6 + g.a1 * g.a5 + g.a2 * g.a4)
    s8 = g.a4 * g.a4 + 2.0 * (g.a2 * g.a6 + g.a3 * g.a5)
    square = y * (s2 * THIRD + y * (s4 * FIFTH + y * (s6 * SEVENTH + y * s8 * NINTH)))
    square += g.a0 * g.a0
    return with_moments(g, 2.0 * half, m0, m1, m2, m3, m4, square, bed)


@inlined
def with_moments(
    g: Segment,
    scale: float,
    m0: float,
    m1: float,
    m2: float,
    m3: float,
    m4: float,
    square: float,
    bed: Bed,
) -> Bed:
    """The bed with a part whose moments of p about the segment's middle are given."""
    # Integrals of p cos x and p sin x.
    even = scale * (m0 + C2 * m2 + C4 * m4)
    odd = scale * (m1 + C3 * m3)
    return Bed(
        bed.overlap,
        bed.place,
        bed.along + g.cosine * even - g.sine * odd,
        bed.across + g.sine * even + g.cosine * odd,
        bed.slope + scale * (g.b1 * m0 + g.b2 * m1 + g.b3 * m2),
        bed.square + scale * square,
        bed.area + scale * m0,
    )


@compiled
def add_pressed(g: Segment, low: float, high: float, bed: Bed) -> Bed:
    """The bed with the part of a segment between two places, by Gauss points."""
    middle = 0.5 * (low + high)
    half = 0.5 * (high - low)
    m0 = m1 = m2 = m3 = m4 = square = 0.0
    for i in range(2):
        for side in (-1.0, 1.0):
            x = middle + side * half * ABSCISSAE[i]
            p = value_at(g, x)
            share = WEIGHTS[i] * p
            square += share * p
            m0 += share
            share *= x
            m1 += share
            share *= x
            m2 += share
            share *= x
            m3 += share
            m4 += share * x
    return with_moments(g, half, m0, m1, m2, m3, m4, square, bed)


@inlined
def inflection(g: Segment, half: float) -> float:
    """Inflection of the overlap in a segment, or its end where there is none.

    The second derivative is all but linear: two steps of Newton's method from the
    secant's root leave nothing.
    """
    low = bend_at(g, -half)
    high = bend_at(g, half)
    if (low > 0.0) == (high > 0.0):
        return half
    x = half * (low + high) / (low - high)
    for _ in range(2):
        third = 6.0 * g.a3 + x * (24.0 * g.a4 + x * (60.0 * g.a5 + x * 120.0 * g.a6))
        if third != 0.0:
            x = min(max(x - bend_at(g, x) / third, -half), half)
    return x


@inlined
def is_monotone(g: Segment, half: float) -> bool:
    """True where the coefficients tell that the overlap rises, or falls, all over a segment."""
    bend = 4.0 * abs(g.a4) + half * (5.0 * abs(g.a5) + half * 6.0 * abs(g.a6))
    bend = half * (2.0 * abs(g.a2) + half * (3.0 * abs(g.a3) + half * bend))
    return abs(g.a1) > bend


@inlined
def change_of(g: Segment, half: float) -> float:
    """Bound of how far the overlap in a segment is from that in its middle, m."""
    high = abs(g.a4) + half * (abs(g.a5) + half * abs(g.a6))
    return half * (abs(g.a1) + half * (abs(g.a2) + half * (abs(g.a3) + half * high)))


@inlined
def bound_of(g: Segment, half: float) -> float:
    """Bound above the overlap of a segment, m: the parabola's vertex or end, and the rest."""
    rest = abs(g.a3) + half * (abs(g.a4) + half * (abs(g.a5) + half * abs(g.a6)))
    x = min(abs(g.a1) / max(-2.0 * g.a2, LEAST_BEND), half)
    return g.a0 + x * (abs(g.a1) + x * g.a2) + half * half * half * rest


@inlined
def extremum(g: Segment, low: float, high: float) -> float:
    """Extremum of the overlap between two places with a monotone slope, or the second place."""
    if high <= low:
        return high
    at_low = slope_at(g, low)
    at_high = slope_at(g, high)
    if (at_low > 0.0) == (at_high > 0.0):
        return high
    return root_between(g, True, low, high, at_low, at_high)


@compiled
def add_monotone(
    g: Segment, low: float, high: float, at_low: float, at_high: float, bed: Bed
) -> Bed:
    """The bed with the pressed part between two places with a monotone overlap."""
    if high <= low or (at_low <= 0.0 and at_high <= 0.0):
        return bed
    if at_low < 0.0:
        low = root_between(g, False, low, high, at_low, at_high)
    elif at_high < 0.0:
        high = root_between(g, False, low, high, at_low, at_high)
    return add_pressed(g, low, high, bed)


@inlined
def with_peak(bed: Bed, overlap: float, place: float) -> Bed:
    """The bed with an overlap at a place, where it is the greatest so far."""
    if overlap <= bed.overlap:
        return bed
    return Bed(overlap, place, bed.along, bed.across, bed.slope, bed.square, bed.area)


@compiled
def press_segment(g: Segment, middle: float, half: float, bed: Bed) -> Bed:
    """The bed with a segment added: its greatest overlap and its pressed parts.

    Most are monotone, as their coefficients tell.  Else the overlap is so between the ends, the
    inflection and the extremes to both sides of that.
    """
    if is_monotone(g, half):
        start, end = value_at(g, -half), value_at(g, half)
        bed = with_peak(bed, start, middle - half)
        bed = with_peak(bed, end, middle + half)
        if min(start, end) >= 0.0:
            return add_whole(g, half, bed)
        return add_monotone(g, -half, half, start, end, bed)
    turn = inflection(g, half)
    first = extremum(g, -half, turn)
    second = extremum(g, turn, half)
    start = value_at(g, -half)
    at_first = value_at(g, first)
    at_turn = at_first if first == turn else value_at(g, turn)
    at_second = at_turn if second == turn else value_at(g, second)
    end = at_second if second == half else value_at(g, half)
    bed = with_peak(bed, start, middle - half)
    bed = with_peak(bed, at_first, middle + first)
    bed = with_peak(bed, at_second, middle + second)
    bed = with_peak(bed, end, middle + half)
    if min(min(start, at_first), min(at_second, end)) >= 0.0:
        return add_whole(g, half, bed)
    bed = add_monotone(g, -half, first, start, at_first, bed)
    bed = add_monotone(g, first, turn, at_first, at_turn, bed)
    bed = add_monotone(g, turn, second, at_turn, at_second, bed)
    return add_monotone(g, second, half, at_second, end, bed)


@compiled
def with_peak_of(g: Segment, middle: float, half: float, bed: Bed) -> Bed:
    """The bed with the greatest overlap of a segment, where it is the greatest so far."""
    if is_monotone(g, half):
        x = math.copysign(half, g.a1)
        return with_peak(bed, value_at(g, x), middle + x)
    bed = with_peak(bed, value_at(g, -half), middle - half)
    bed = with_peak(bed, value_at(g, half), middle + half)
    turn = inflection(g, half)
    first = extremum(g, -half, turn)
    bed = with_peak(bed, value_at(g, first), middle + first)
    second = extremum(g, turn, half)
    return with_peak(bed, value_at(g, second), middle + second)


@compiled
def area_of(g: Segment, half: float) -> float:
    """Integral of the overlap of a segment where it is above zero, m rad."""
    if g.a0 > change_of(g, half):
        return 2.0 * half * mean_of(g, half * half)
    return press_segment(g, 0.0, half, NOTHING).area
