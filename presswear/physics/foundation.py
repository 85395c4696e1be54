"""Worn surfaces and the elastic foundation between a round pin and its worn bearing.

The overlap at an angle s from the direction of the eccentricity e is
p(s) = e cos(s) - c - h_bearing - h_pin, the pressure k_w p where p > 0. The elastic energy is the
integral of k_w b R p^2 / 2 over the angle; force and couples are its gradient. A pin cannot enter
a groove narrower than itself: grooves are bridged, and two patches need no case of their own.

The arc is integrated segment by segment between neighbouring nodes of the two maps. Over a
segment of a few hundredths of a radian the values and slopes of the overlap at both ends give it
to round-off: the cubic through them, and of the cosine a term of fourth order that vanishes at
both ends. A segment is integrated from root to root of the overlap in closed form.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.linkage.surface import Surface
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled, fused, fused_inlined

# Rows of each surface, of the bearing from 0 and of the pin from 4: depth, m, and slope, m/rad, at
# the bin centres; coefficients of x^2 and x^3 of the cubic after each, m/rad^2 and m/rad^3
BEARING, PIN, ROWS = 0, 4, 8
SLOPE, SQUARE, CUBE = 1, 2, 3
SURFACES = np.zeros((ROWS, 1))  # example of the type of packed surfaces, contiguous

MAX_SEGMENT = 0.02  # rad; longer segments would show the terms that are left out
ROOT_TOL = 1e-8  # part of half a segment; overlaps and sums change with the square of it
NEWTON_TOL = 1e-3  # part of half a segment; the next Newton step would be about its square
MAX_ROOT_STEPS = 60  # Newton's method needs four; bisection helps where it strays

# Numba divides where it is told to; a product takes a fifth of the time.
THIRD, FIFTH, SEVENTH, NINTH = 1 / 3, 1 / 5, 1 / 7, 1 / 9
C2, C4, C6, C8, C10 = -1 / 2, 1 / 24, -1 / 720, 1 / 40320, -1 / 3628800  # series of the cosine
C3, C5, C7, C9, C11 = -1 / 6, 1 / 120, -1 / 5040, 1 / 362880, -1 / 39916800  # and of the sine


def packed_rows(surface: Surface, count: int) -> Array:
    """Pack depth, slope and the two higher coefficients of the cubic after each bin centre."""
    rows = np.zeros((PIN, count))
    if surface.is_worn:
        depth, slope = surface.depth, surface.slope
        width = 2.0 * math.pi / count
        following, following_slope = np.roll(depth, -1), np.roll(slope, -1)
        secant = (following - depth) / width
        rows[0], rows[SLOPE] = depth, slope
        rows[SQUARE] = (3.0 * secant - 2.0 * slope - following_slope) / width
        rows[CUBE] = (slope + following_slope - 2.0 * secant) / width**2
    return rows


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


class ArcIntegrals(NamedTuple):
    """Sums over a foundation of unit stiffness."""

    overlap: float  # greatest, m; below zero while open
    place: float  # its direction, rad from that of the eccentricity
    along: float  # integral of p cos(s), m rad
    across: float  # of p sin(s), m rad
    slope: float  # of p times the slope of the bearing's map, m^2
    square: float  # of p^2, m^2 rad
    area: float  # of p, m rad


NOTHING = ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


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
def place_at(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    bearing: int,
    pin: int,
    bearing_x: float,
    pin_x: float,
    angle: float,
) -> Place:
    """Return the overlap at an angle, rad, and at ways into cells of both maps, rad."""
    depth, slope = depth_at(surfaces, BEARING, bearing, bearing_x)
    pin_depth, pin_slope = depth_at(surfaces, PIN, pin, pin_x)
    cosine, sine = turned(angle)
    overlap = eccentricity * cosine - clearance - depth - pin_depth
    return Place(overlap, -eccentricity * sine - slope - pin_slope, slope, cosine, sine)


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


@fused
def add_pressed(g: Segment, sums: ArcIntegrals) -> ArcIntegrals:
    """Return the sums with the pressed parts of a segment."""
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
    return sums


@fused_inlined
def onward(cell: int, x: float, length: float, width: float, count: int) -> tuple[int, float]:
    """Return cell and way into it a length further on, which ends in the cell or with it."""
    x += length
    if x >= width * (1.0 - 1e-14):
        return (cell + 1 if cell + 1 < count else 0), 0.0
    return cell, x


@fused
def _share_segment(g: Segment, bearing_place: float, pin_place: float, shares: Array) -> None:
    """Add the integrals of the overlap of a segment, which begins at two places, rad, over bins."""
    bins = shares.shape[1]
    bin_width = 2.0 * math.pi / bins
    b_bin, b_way = cell_of(bearing_place, bins, 0.0)
    p_bin, p_way = cell_of(pin_place, bins, 0.0)
    place = -1.0
    while place < 1.0:
        length = min(bin_width - b_way, bin_width - p_way)
        following = place + length / g.half
        if length >= (1.0 - place) * g.half:
            following, length = 1.0, (1.0 - place) * g.half
        share = add_pressed(part_of(g, place, following), NOTHING).area
        # The overlap at its end is nothing but round-off.
        if share > 0.0:
            shares[0, b_bin] += share
            shares[1, p_bin] += share
        place = following
        b_bin, b_way = onward(b_bin, b_way, length, bin_width, bins)
        p_bin, p_way = onward(p_bin, p_way, length, bin_width, bins)


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
    before = max(math.ceil(node / MAX_SEGMENT), 1)
    behind = max(math.ceil((width - node) / MAX_SEGMENT), 1)
    half_before, half_behind = 0.5 * node / before, 0.5 * (width - node) / behind
    b = (b - ahead + 2 * count) % count
    p = (p - ahead + 2 * count) % count
    sums, peak, place = NOTHING, eccentricity - clearance - here, 0.0
    start = -ahead * width - into
    left = place_at(surfaces, eccentricity, clearance, b, p, 0.0, width - node, start)
    for i in range(cells):
        cell = start + i * width
        cube = surfaces[BEARING + CUBE, b]
        for j in range(before + behind):
            if j == before:
                p = p + 1 if p + 1 < count else 0
            offset, half, pin_x = 2.0 * j * half_before, half_before, width - node
            if j >= before:
                offset, half = node + 2.0 * (j - before) * half_behind, half_behind
                pin_x = -node
            end = offset + 2.0 * half
            right = place_at(surfaces, eccentricity, clearance, b, p, end, end + pin_x, cell + end)
            quartic = C4 * eccentricity * half * half * half * half
            # A cubic lies within its Bezier points.
            second = left.overlap + 2.0 * THIRD * half * left.rise
            third = right.overlap - 2.0 * THIRD * half * right.rise
            low = min(min(left.overlap, right.overlap), min(second, third)) - quartic
            high = max(max(left.overlap, right.overlap), max(second, third)) + quartic
            if high > 0.0 or high > peak:
                g = segment_between(left, right, half, quartic, cube)
                if high > peak:
                    first, _, second = turning_points(g)
                    for x in (-1.0, first, second, 1.0):
                        if value_at(g, x) > peak:
                            peak, place = value_at(g, x), cell + offset + half + half * x
                sums = add_whole(g, sums) if low > 0.0 else add_pressed(g, sums)
                if shares.shape[1] > 0 and high > 0.0:
                    at = cell + offset
                    _share_segment(g, bearing_place + at, pin_place + at, shares)
            left = right
        b = b + 1 if b + 1 < count else 0
    return ArcIntegrals(peak, place, *sums[2:])


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
