"""Elastic foundation: a round pin pressed into the worn arc of its bearing.

The overlap at an angle theta is p = e . n(theta) - c - h_bearing - h_pin, and the pressure is
k_w p where p > 0.  The elastic energy is the integral of k_w b R p^2 / 2 over the angle; force
and couples are its gradient.  A pin cannot enter a groove that is narrower than itself: grooves
are bridged, and several pressed patches need no special case.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.overlap import (
    C3,
    C4,
    C5,
    C7,
    C9,
    C11,
    THIRD,
    ArcIntegrals,
    Segment,
    add_parts,
    add_whole,
    cosine_and_sine,
    pressed_area,
    pressed_part,
)
from presswear.physics.surface import BEARING, CUBE, PIN, cell_of, depth_at
from presswear.tools.compile import fused, fused_inlined

Array = NDArray[np.float64]

LONGEST_SEGMENT = 0.02  # rad; the series of a segment are exact to round-off


class Arc(NamedTuple):
    """Cells between nodes of the bearing's map, in which the two surfaces may meet.

    Attributes
    ----------
    bearing, pin : int
        First cell, and the cell of the pin's map in which it begins.
    cells : int
        Number of cells.
    begin : float
        Start of the first cell, rad from the direction of the eccentricity.
    width, node : float
        Length of a cell, and the distance from its start to a node of the pin's map, rad.
    before, behind : int
        Number of segments before and behind that node.
    half_before, half_behind : float
        Half the length of each of these segments, rad.
    overlap : float
        Overlap in the direction of the eccentricity, m.
    """

    bearing: int
    pin: int
    cells: int
    begin: float
    width: float
    node: float
    before: int
    behind: int
    half_before: float
    half_behind: float
    overlap: float


class Place(NamedTuple):
    """The overlap at one end of a segment.

    Attributes
    ----------
    overlap, rise, slope : float
        Overlap, m, its derivative, and the slope of the bearing's map, m/rad.
    cosine, sine : float
        Of the angle from the direction of the eccentricity.
    half, cube : float
        Half the length of the segment that begins here, rad, and the coefficient of third order
        of the bearing's map in it, m/rad^3.
    angle : float
        From the direction of the eccentricity, rad.
    """

    overlap: float
    rise: float
    slope: float
    cosine: float
    sine: float
    half: float
    cube: float
    angle: float


@fused_inlined
def arc_of(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> Arc:
    """Return the arc that holds all overlaps above zero and the greatest; see ``press``."""
    width = 2.0 * math.pi / count
    b, into = cell_of(bearing_place, count, 0.5)
    p, p_x = cell_of(pin_place, count, 0.5)
    here = depth_at(surfaces, BEARING, b, into)[0] + depth_at(surfaces, PIN, p, p_x)[0]
    # Beyond this angle the overlap is below zero and below the overlap in the direction of e.
    rise = max(here, eccentricity - clearance) - least_depth
    sine = math.sqrt(min(max(0.5 * rise / eccentricity, 0.0), 1.0)) if eccentricity > 0.0 else 1.0
    # The arc sine is at most this.
    end = 2.0 * sine * (1.0 + (0.5 * math.pi - 1.0) * sine * sine) + 1e-9
    ahead = max(math.ceil((end - into) / width), 0)
    cells = min(ahead + math.ceil((end + into) / width), count)
    # Each cell of the bearing holds a node of the pin, everywhere at the same distance.
    node = width - p_x + into
    if node > width:
        node -= width
        p -= 1
    before = max(math.ceil(node / LONGEST_SEGMENT), 1)
    behind = max(math.ceil((width - node) / LONGEST_SEGMENT), 1)
    return Arc(
        (b - ahead) % count,
        (p - ahead) % count,
        cells,
        -ahead * width - into,
        width,
        node,
        before,
        behind,
        0.5 * node / before,
        0.5 * (width - node) / behind,
        eccentricity - clearance - here,
    )


@fused_inlined
def place_at(
    surfaces: Array, count: int, arc: Arc, eccentricity: float, clearance: float, n: int
) -> Place:
    """Return the overlap at the start of segment ``n`` of an arc, or at the end of the last."""
    i = n // (arc.before + arc.behind)
    j = n - i * (arc.before + arc.behind)
    b, p = arc.bearing + i, arc.pin + i
    if j < arc.before:
        half = arc.half_before
        x = 2.0 * j * half
        pin_x = x - arc.node + arc.width
    else:
        half = arc.half_behind
        pin_x = 2.0 * (j - arc.before) * half
        x = arc.node + pin_x
        p += 1
    b = b - count if b >= count else b
    p = p - count if p >= count else p
    bearing_depth, bearing_slope = depth_at(surfaces, BEARING, b, x)
    pin_depth, pin_slope = depth_at(surfaces, PIN, p, pin_x)
    angle = arc.begin + i * arc.width + x
    cosine, sine = cosine_and_sine(angle)
    return Place(
        eccentricity * cosine - clearance - bearing_depth - pin_depth,
        -eccentricity * sine - bearing_slope - pin_slope,
        bearing_slope,
        cosine,
        sine,
        half,
        surfaces[BEARING + CUBE, b],
        angle,
    )


@fused_inlined
def segment_between(left: Place, right: Place, eccentricity: float) -> Segment:
    """Return the overlap of the segment between two neighbouring places."""
    half = left.half
    square = half * half
    # The sum of the cosines at both ends times this is the cosine of the middle; likewise sines.
    scale = 0.5 + square * (0.25 + square * (5.0 / 48.0 + square * (61.0 / 1440.0)))
    cosine = scale * (left.cosine + right.cosine)
    # The term of fourth order of the cosine multiplies (x^2 - 1)^2.
    fourth = C4 * eccentricity * square * square * cosine
    difference = 0.25 * (right.overlap - left.overlap)
    mean = 0.25 * half * (left.rise + right.rise)
    turn = 0.25 * half * (right.rise - left.rise)
    bend = 3.0 * square * left.cube
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
        scale * (left.sine + right.sine),
    )


@fused_inlined
def bounds_between(left: Place, right: Place, eccentricity: float) -> tuple[float, float]:
    """Return bounds below and above the overlap of a segment, m: a cubic lies within its
    Bezier points.
    """
    half = left.half
    second = left.overlap + 2.0 * THIRD * half * left.rise
    third = right.overlap - 2.0 * THIRD * half * right.rise
    fourth = C4 * eccentricity * half * half * half * half
    low = min(min(left.overlap, right.overlap), min(second, third))
    return low - fourth, max(max(left.overlap, right.overlap), max(second, third)) + fourth


@fused
def press(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> ArcIntegrals:
    """Return the integrals over the overlap of a pin and its bearing.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, columns)
        The worn surfaces, see ``packed_rows``.
    count : int
        Number of bins of both maps.
    eccentricity, clearance : float
        m.
    least_depth : float
        Sum of the least depths of both surfaces, m.
    bearing_place, pin_place : float
        Direction of the eccentricity in the maps of bearing and pin, rad.
    """
    arc = arc_of(surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place)
    sums = ArcIntegrals(arc.overlap, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if eccentricity <= 0.0:
        return sums
    left = place_at(surfaces, count, arc, eccentricity, clearance, 0)
    for n in range(1, arc.cells * (arc.before + arc.behind) + 1):
        right = place_at(surfaces, count, arc, eccentricity, clearance, n)
        low, high = bounds_between(left, right, eccentricity)
        if high > 0.0 or high > sums.overlap:
            g = segment_between(left, right, eccentricity)
            if low > 0.0 and high <= sums.overlap:
                sums = add_whole(g, sums)
            else:
                sums = add_parts(g, left.angle + left.half, sums)
        left = right
    return sums


@fused_inlined
def next_bin(place: int, x: float, length: float, width: float, count: int) -> tuple[int, float]:
    """Return bin and distance from its start, rad, a length further on, at most at its end."""
    x += length
    if x >= width * (1.0 - 1e-14):
        return (place + 1 if place + 1 < count else 0), 0.0
    return place, x


@fused
def add_areas(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
    areas: Array,
) -> float:
    """Add the integrals of the overlap over the bins of both maps; return that over the arc.

    Parameters
    ----------
    surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place
        As for ``press``.
    areas : ndarray, shape (2, bins)
        Of bearing and pin, m rad.
    """
    if eccentricity <= 0.0:
        return 0.0
    arc = arc_of(surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place)
    bins = areas.shape[1]
    bin_width = 2.0 * math.pi / bins
    b_bin = p_bin = 0
    b_x = p_x = total = 0.0
    is_located = False
    left = place_at(surfaces, count, arc, eccentricity, clearance, 0)
    for n in range(1, arc.cells * (arc.before + arc.behind) + 1):
        right = place_at(surfaces, count, arc, eccentricity, clearance, n)
        low, high = bounds_between(left, right, eccentricity)
        if high <= 0.0:
            is_located = False
            left = right
            continue
        if not is_located:
            b_bin, b_x = cell_of(bearing_place + left.angle, bins, 0.0)
            p_bin, p_x = cell_of(pin_place + left.angle, bins, 0.0)
            is_located = True
        g = segment_between(left, right, eccentricity)
        start, end = -1.0, 1.0
        if low <= 0.0:
            start, end = pressed_part(g)
        x = -1.0
        while x < 1.0:
            length = min(min(bin_width - b_x, bin_width - p_x), (1.0 - x) * g.half)
            following = x + length / g.half if length < (1.0 - x) * g.half else 1.0
            area = pressed_area(g, x, following, start, end)
            # At its end the overlap is round-off, which may be negative.
            if area > 0.0:
                areas[0, b_bin] += area
                areas[1, p_bin] += area
                total += area
            x = following
            b_bin, b_x = next_bin(b_bin, b_x, length, bin_width, bins)
            p_bin, p_x = next_bin(p_bin, p_x, length, bin_width, bins)
        left = right
    return total


@fused_inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Return the integral of a round pin's overlap from the direction of e to an angle, m rad."""
    y = x * x
    # sin x - x by its series, because the difference cancels.
    short = math.sin(x) - x
    if y < 0.25:
        short = x * y * (C3 + y * (C5 + y * (C7 + y * (C9 + y * C11))))
    return (eccentricity - clearance) * x + eccentricity * short


@fused
def add_round_areas(
    eccentricity: float, clearance: float, bearing_place: float, pin_place: float, areas: Array
) -> float:
    """Add the integrals of the overlap of unworn surfaces; see ``add_areas``."""
    if eccentricity <= clearance:
        return 0.0
    bins = areas.shape[1]
    width = 2.0 * math.pi / bins
    end = 2.0 * math.asin(math.sqrt(0.5 * (eccentricity - clearance) / eccentricity))
    b_bin, b_x = cell_of(bearing_place - end, bins, 0.0)
    p_bin, p_x = cell_of(pin_place - end, bins, 0.0)
    angle, until = -end, round_area(eccentricity, clearance, -end)
    total = 0.0
    while angle < end:
        length = min(min(width - b_x, width - p_x), end - angle)
        angle += length
        before, until = until, round_area(eccentricity, clearance, angle)
        # At its end the overlap is round-off, which may be negative.
        area = max(until - before, 0.0)
        areas[0, b_bin] += area
        areas[1, p_bin] += area
        total += area
        b_bin, b_x = next_bin(b_bin, b_x, length, width, bins)
        p_bin, p_x = next_bin(p_bin, p_x, length, width, bins)
    return total


def foundation_stiffness(stiffness: float, clearance: float) -> float:
    """Return k_w b R, N/m^2 per rad, with which a round joint gives K delta^1.5.

    The overlap of a round joint is delta - c s^2 / 2, and its integral over the arc
    (4/3) sqrt(2 / c) delta^1.5; the curvature of the arc adds parts of delta / c.
    """
    return 0.75 * stiffness * math.sqrt(0.5 * clearance)
