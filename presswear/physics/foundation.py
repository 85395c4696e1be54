"""A round pin on the worn arc of its bearing: a linear elastic foundation.

The overlap at an angle theta is p = e . n(theta) - c - h_bearing - h_pin, the pressure
k_w p where p > 0.  The elastic energy is the integral of k_w b R p^2 / 2 over the angle;
force and couples are its gradient.  A pin cannot enter a groove narrower than itself:
grooves are bridged, and two patches are two patches without a case for it.

The arc is taken in segments between neighbouring nodes of the two maps: those that are pressed all
over many at once, and one by one where the overlap has a root or is greatest.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.arcs import (
    BOUNDS,
    COLUMNS,
    HIGH,
    KNOWN,
    LOW,
    SUMS,
    Arc,
    arc_behind,
    begin_of,
    cell_of,
    highest_of,
    known_segment,
    lanes,
    note_bounds,
    note_places,
    onward,
    reach_between,
    segment_of,
    segments_of,
)
from presswear.physics.overlap import (
    C3,
    C5,
    C7,
    C9,
    C11,
    FIFTH,
    NOTHING,
    THIRD,
    Bed,
    Segment,
    add_pressed,
    add_whole,
    part_of,
    pressed_part,
    with_peak_of,
)
from presswear.tools.compile import fused, fused_inlined, working_space

Array = NDArray[np.float64]


@fused_inlined
def add_pressed_cells(
    surfaces: Array,
    eccentricity: float,
    arc: Arc,
    first: int,
    last: int,
    known: Array,
    bounds: Array,
    sums: Array,
    bed: Bed,
) -> Bed:
    """The bed with all segments of some cells that are pressed all over.

    Parameters
    ----------
    first, last : int
        Cells.
    sums : ndarray, shape (5, n)
        Working space.
    """
    count = lanes(last - first + 1)
    for k in range(SUMS):
        for i in range(count):
            sums[k, np.uintp(i)] = 0.0
    for j in range(segments_of(arc.places)):
        for i in range(count):
            g = known_segment(surfaces, eccentricity, arc, known, j, first + i)
            whole = add_whole(g, NOTHING)
            is_whole = bounds[2 * j + LOW, np.uintp(first + i)] > 0.0
            sums[0, np.uintp(i)] += whole.along if is_whole else 0.0
            sums[1, np.uintp(i)] += whole.across if is_whole else 0.0
            sums[2, np.uintp(i)] += whole.slope if is_whole else 0.0
            sums[3, np.uintp(i)] += whole.square if is_whole else 0.0
            sums[4, np.uintp(i)] += whole.area if is_whole else 0.0
    along, across, slope, square, area = bed.along, bed.across, bed.slope, bed.square, bed.area
    for i in range(last - first + 1):
        along += sums[0, np.uintp(i)]
        across += sums[1, np.uintp(i)]
        slope += sums[2, np.uintp(i)]
        square += sums[3, np.uintp(i)]
        area += sums[4, np.uintp(i)]
    return Bed(bed.overlap, bed.place, along, across, slope, square, area)


@fused_inlined
def with_arc(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    arc: Arc,
    known: Array,
    bounds: Array,
    sums: Array,
    bed: Bed,
) -> Bed:
    """The bed with the segments of an arc."""
    note_places(surfaces, eccentricity, clearance, arc, known)
    note_bounds(eccentricity, arc, known, bounds)
    enough = max(bed.overlap, highest_of(arc, known, sums))
    first, last = arc.cells, -1
    for j in range(segments_of(arc.places)):
        for i in range(arc.cells):
            low, high = bounds[2 * j + LOW, np.uintp(i)], bounds[2 * j + HIGH, np.uintp(i)]
            if low > 0.0:
                first, last = min(first, i), max(last, i)
            if (low <= 0.0 and high > 0.0) or high >= enough:
                g = known_segment(surfaces, eccentricity, arc, known, j, i)
                if high > bed.overlap:
                    x, half = segment_of(arc.places, j)
                    bed = with_peak_of(g, begin_of(arc, i) + x + half, bed)
                if low <= 0.0:
                    bed = add_pressed(g, bed)
    if first <= last:
        bed = add_pressed_cells(surfaces, eccentricity, arc, first, last, known, bounds, sums, bed)
    return bed


@fused
def press(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> Bed:
    """The bed of a pin in its bearing.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, count + AROUND)
    count : int
        Bins of both maps.
    least_depth : float
        Sum of the least depths of both, m.
    bearing_place, pin_place : float
        Direction of the eccentricity in the maps of bearing and pin, rad.
    """
    known = working_space(KNOWN, COLUMNS)
    bounds = working_space(BOUNDS, COLUMNS)
    sums = working_space(SUMS, COLUMNS)
    reach = reach_between(
        surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place
    )
    bed = Bed(reach.overlap, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    done = 0
    while done < reach.cells and eccentricity > 0.0:
        arc = arc_behind(reach, done)
        bed = with_arc(surfaces, eccentricity, clearance, arc, known, bounds, sums, bed)
        done += arc.cells
    return bed


@fused_inlined
def area_until(g: Segment, x: float) -> float:
    """Integral of the overlap of a segment from its middle to a place, m rad."""
    return (
        g.half
        * x
        * (g.a0 + x * (0.5 * g.a1 + x * (THIRD * g.a2 + x * (0.25 * g.a3 + x * FIFTH * g.a4))))
    )


@fused
def spread(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
    shares: Array,
) -> float:
    """Add the integrals of the overlap over the bins of both maps; returns that over the arc.

    Parameters
    ----------
    surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place
        As for ``press``.
    shares : ndarray, shape (2, n)
        Of bearing and pin, m rad.
    """
    known = working_space(KNOWN, COLUMNS)
    bounds = working_space(BOUNDS, COLUMNS)
    reach = reach_between(
        surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place
    )
    bins = shares.shape[1]
    bin_width = 2.0 * math.pi / bins
    b_bin = p_bin = 0
    b_way = p_way = 0.0
    is_behind = False
    total = 0.0
    done = 0
    while done < reach.cells and eccentricity > 0.0:
        arc = arc_behind(reach, done)
        done += arc.cells
        note_places(surfaces, eccentricity, clearance, arc, known)
        note_bounds(eccentricity, arc, known, bounds)
        for i in range(arc.cells):
            for j in range(segments_of(arc.places)):
                if bounds[2 * j + HIGH, i] <= 0.0:
                    is_behind = False
                    continue
                x, half = segment_of(arc.places, j)
                begin = begin_of(arc, i) + x
                if not is_behind:
                    b_bin, b_way = cell_of(bearing_place + begin, bins, 0.0)
                    p_bin, p_way = cell_of(pin_place + begin, bins, 0.0)
                    is_behind = True
                g = known_segment(surfaces, eccentricity, arc, known, j, i)
                # Pressed from one place to another, but for the few that are not monotone.
                low, high = (-1.0, 1.0) if bounds[2 * j + LOW, i] > 0.0 else pressed_part(g)
                place = -1.0
                while place < 1.0:
                    length = min(bin_width - b_way, bin_width - p_way)
                    following = 1.0
                    if length < (1.0 - place) * half:
                        following = place + length / half
                    else:
                        length = (1.0 - place) * half
                    share = 0.0
                    if high < low:
                        share = add_pressed(part_of(g, place, following), NOTHING).area
                    elif place < high and following > low:
                        share = area_until(g, min(following, high))
                        share -= area_until(g, max(place, low))
                    # The overlap at its end is nothing but round-off.
                    if share > 0.0:
                        shares[0, b_bin] += share
                        shares[1, p_bin] += share
                        total += share
                    place = following
                    b_bin, b_way = onward(b_bin, b_way, length, bin_width, bins)
                    p_bin, p_way = onward(p_bin, p_way, length, bin_width, bins)
    return total


@fused_inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Integral of the overlap of a round pin from the direction of e to a place, m rad."""
    y = x * x
    # x - sin x as a series: the difference cancels.
    short = math.sin(x) - x
    if y < 0.25:
        short = x * y * (C3 + y * (C5 + y * (C7 + y * (C9 + y * C11))))
    return (eccentricity - clearance) * x + eccentricity * short


@fused
def spread_round(
    eccentricity: float,
    clearance: float,
    bearing_place: float,
    pin_place: float,
    shares: Array,
) -> float:
    """Do what ``spread`` does for surfaces without wear."""
    if eccentricity <= clearance:
        return 0.0
    bins = shares.shape[1]
    width = 2.0 * math.pi / bins
    end = 2.0 * math.asin(math.sqrt(0.5 * (eccentricity - clearance) / eccentricity))
    b_bin, b_way = cell_of(bearing_place - end, bins, 0.0)
    p_bin, p_way = cell_of(pin_place - end, bins, 0.0)
    left, until = -end, round_area(eccentricity, clearance, -end)
    total = 0.0
    while left < end:
        length = min(min(width - b_way, width - p_way), end - left)
        left += length
        before, until = until, round_area(eccentricity, clearance, left)
        # The overlap at its end is nothing but round-off.
        share = max(until - before, 0.0)
        shares[0, b_bin] += share
        shares[1, p_bin] += share
        total += share
        b_bin, b_way = onward(b_bin, b_way, length, width, bins)
        p_bin, p_way = onward(p_bin, p_way, length, width, bins)
    return total


def foundation_stiffness(stiffness: float, clearance: float) -> float:
    """k_w b R, N/m^2 per rad, with which a round joint gives K delta^1.5.

    The overlap of a round joint is delta - c s^2 / 2, and its integral over the arc
    (4/3) sqrt(2 / c) delta^1.5; the arc's curvature adds parts of delta / c.
    """
    return 0.75 * stiffness * math.sqrt(0.5 * clearance)
