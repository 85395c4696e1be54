"""A round pin on the worn arc of its bearing: a linear elastic foundation.

The overlap at an angle theta is p = e . n(theta) - c - h_bearing - h_pin, the pressure
k_w p where p > 0.  The elastic energy is the integral of k_w b R p^2 / 2 over the angle;
force and couples are its gradient.  A pin cannot enter a groove narrower than itself:
grooves are bridged, and two patches are two patches without a case for it.

The arc is taken in segments between neighbouring nodes of the two maps.  Both have nodes at one
distance, so that every other segment lies alike in the cells of both: these are integrated side by
side, as a processor does eight numbers at once, and one by one where the overlap has a root or is
greatest.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
    fourth_order,
    hull,
    mean_turned,
    part_of,
    pressed_part,
    segment_between,
    series,
    turned,
    with_peak,
    with_peak_of,
)
from presswear.physics.surface import BEARING, CUBE, PIN, SLOPE, SQUARE
from presswear.tools.compiled import compiled, inlined, working_space

Array = NDArray[np.float64]
Cell = int | np.unsignedinteger[Any]
"""Place of a cell; a loop over those that cannot be below zero is done by whole vectors."""

LONGEST_SEGMENT = 0.02
"""rad."""


@inlined
def depth_at(surfaces: Array, row: int, k: Cell, x: float) -> tuple[float, float]:
    """Depth of a map, m, and its slope, m/rad, in piece ``k`` behind its first node by x rad."""
    c1 = surfaces[row + SLOPE, k]
    c2 = surfaces[row + SQUARE, k]
    c3 = surfaces[row + CUBE, k]
    return surfaces[row, k] + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + x * 3.0 * c3)


@inlined
def overlap_at(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    bearing: Cell,
    pin: Cell,
    bearing_x: float,
    pin_x: float,
    cosine: float,
    sine: float,
) -> tuple[float, float, float]:
    """The overlap at a place, m, its derivative, and the slope of the bearing's map, m/rad.

    Parameters
    ----------
    bearing, pin : int
        Pieces of both maps.
    bearing_x, pin_x : float
        Places in them, rad.
    cosine, sine : float
        Those of the place, from the direction of the eccentricity.
    """
    depth, slope = depth_at(surfaces, BEARING, bearing, bearing_x)
    other, rise = depth_at(surfaces, PIN, pin, pin_x)
    overlap = eccentricity * cosine - clearance - depth - other
    return overlap, -eccentricity * sine - slope - rise, slope


@inlined
def cell_of(angle: float, count: int, shift: float) -> tuple[int, float]:
    """Cell of a grid of so many around the turn that holds an angle, and the way into it, rad.

    ``shift`` is where the first cell begins, as a part of a cell.
    """
    turn = angle * (0.5 / math.pi)
    position = (turn - np.floor(turn)) * count - shift
    before = np.floor(position)
    width = 2.0 * math.pi / count
    cell = int(before)
    if cell < 0:
        cell += count
    # A trial state may be so far off that round-off leaves no place in a cell.
    if not 0 <= cell < count:
        return 0, 0.0
    return cell, min(max((position - before) * width, 0.0), width)


@inlined
def map_at(surfaces: Array, row: int, count: int, angle: float) -> tuple[float, float]:
    """Depth of a map of so many bins, m, and its slope, m/rad, at any angle, rad."""
    k, x = cell_of(angle, count, 0.5)
    return depth_at(surfaces, row, k, x)


@inlined
def onto(cell: int, count: int) -> int:
    """The same cell by its number from 0, less than a turn off."""
    if cell < 0:
        return cell + count
    return cell - count if cell >= count else cell


@inlined
def onward(cell: int, x: float, length: float, width: float, count: int) -> tuple[int, float]:
    """The cell and the way into it a length further on, which ends in the cell or with it."""
    x += length
    if x >= width * (1.0 - 1e-14):
        return (cell + 1 if cell + 1 < count else 0), 0.0
    return cell, x


@inlined
def reach_of(eccentricity: float, clearance: float, least_depth: float, here: float) -> float:
    """Angle from the direction of e within which the overlap is greatest, and above zero, rad.

    Parameters
    ----------
    least_depth, here : float
        Sums of both depths: the least ones, and those in the direction of e, m.
    """
    rise = max(here, eccentricity - clearance) - least_depth
    sine = math.sqrt(min(max(0.5 * rise / eccentricity, 0.0), 1.0))
    # The arc of a sine is no longer than this.
    return 2.0 * sine * (1.0 + (0.5 * math.pi - 1.0) * sine * sine) + 1e-9


LANES = 8
"""Numbers of a vector, at most."""
CELLS = 32
"""Most cells that are taken at once; with LANES and one more they lie within AROUND."""
COLUMNS = CELLS + 2 * LANES
"""Of the working space."""
PLACES = 48
"""Most places in a cell at which the overlap is taken."""
OF_PLACE = 5
"""Rows of what is known at a place of each cell."""
VALUE, RISE, BEARING_SLOPE, COSINE, SINE = range(OF_PLACE)
"""Overlap, its derivative, slope of the bearing's map; those of the direction from that of e."""
KNOWN, BOUNDS, SUMS = OF_PLACE * PLACES, 2 * PLACES, 5
"""Rows of the working space."""
LOW, HIGH = 0, 1
"""Rows of the bounds of each segment."""


class Arc(NamedTuple):
    """Cells side by side, each with the same places; segments run from one place to the next.

    Attributes
    ----------
    bearing, pin : int
        First cell, and the pin's in which it begins.
    cells : int
        Their number.
    origin : int
        A cell within half a radian of all of them.
    turn : float
        Where that begins, from the direction of the eccentricity, rad.
    width : float
        Length of a cell, rad.
    node : float
        Way from its beginning to a node of the pin, rad.
    before, behind : int
        Segments before that node and behind it.
    half_before, half_behind : float
        Half the length of each of these, rad.
    """

    bearing: int
    pin: int
    cells: int
    origin: int
    turn: float
    width: float
    node: float
    before: int
    behind: int
    half_before: float
    half_behind: float


@inlined
def segment_of(arc: Arc, j: int) -> tuple[float, float]:
    """Where segment ``j`` of a cell begins, and half its length, rad."""
    if j < arc.before:
        return 2.0 * j * arc.half_before, arc.half_before
    return arc.node + 2.0 * (j - arc.before) * arc.half_behind, arc.half_behind


@inlined
def begin_of(arc: Arc, i: int) -> float:
    """Where cell ``i`` of an arc begins, from the direction of the eccentricity, rad."""
    return arc.turn + (i - arc.origin) * arc.width


@inlined
def lanes(count: int) -> int:
    """So many or more: a multiple that the compiler sees is done by whole vectors."""
    return LANES * ((count + LANES - 1) // LANES)


@inlined
def note_places(
    surfaces: Array, eccentricity: float, clearance: float, arc: Arc, known: Array
) -> None:
    """Fill in what is known at the places of an arc, and at its end.

    Parameters
    ----------
    known : ndarray, shape (OF_PLACE places, n)
        Rows VALUE to SINE of each place, a column for each cell.  The last
        columns, up to a multiple of LANES, are of cells behind.
    """
    for j in range(arc.before + arc.behind):
        x, _ = segment_of(arc, j)
        is_behind = j >= arc.before
        pin = arc.pin + (1 if is_behind else 0)
        pin_x = x - arc.node + (0.0 if is_behind else arc.width)
        cosine, sine = turned(arc.turn + x)
        for i in range(lanes(arc.cells + 1)):
            c, s = series((i - arc.origin) * arc.width)
            along = cosine * c - sine * s
            across = cosine * s + sine * c
            value, rise, slope = overlap_at(
                surfaces,
                eccentricity,
                clearance,
                np.uintp(arc.bearing + i),
                np.uintp(pin + i),
                x,
                pin_x,
                along,
                across,
            )
            known[OF_PLACE * j + COSINE, np.uintp(i)] = along
            known[OF_PLACE * j + SINE, np.uintp(i)] = across
            known[OF_PLACE * j + VALUE, np.uintp(i)] = value
            known[OF_PLACE * j + RISE, np.uintp(i)] = rise
            known[OF_PLACE * j + BEARING_SLOPE, np.uintp(i)] = slope


@inlined
def right_of(arc: Arc, j: int) -> tuple[int, int]:
    """First row, and columns further, of the place in which segment ``j`` of a cell ends."""
    return (OF_PLACE * (j + 1), 0) if j + 1 < arc.before + arc.behind else (0, 1)


@inlined
def note_bounds(eccentricity: float, arc: Arc, known: Array, bounds: Array) -> None:
    """Fill in bounds of the overlap of the segments of an arc, m.

    Parameters
    ----------
    bounds : ndarray, shape (2 places, n)
        Rows LOW and HIGH of each segment of a cell.
    """
    for j in range(arc.before + arc.behind):
        half = segment_of(arc, j)[1]
        quartic = fourth_order(eccentricity, half)
        right, on = right_of(arc, j)
        for i in range(lanes(arc.cells)):
            low, high = hull(
                known[OF_PLACE * j + VALUE, np.uintp(i)],
                known[right + VALUE, np.uintp(i + on)],
                half * known[OF_PLACE * j + RISE, np.uintp(i)],
                half * known[right + RISE, np.uintp(i + on)],
                quartic,
            )
            bounds[2 * j + LOW, np.uintp(i)] = low
            bounds[2 * j + HIGH, np.uintp(i)] = high


@inlined
def known_segment(
    surfaces: Array, eccentricity: float, arc: Arc, known: Array, j: int, i: Cell
) -> Segment:
    """Segment ``j`` of cell ``i`` from what is known at both ends."""
    half = segment_of(arc, j)[1]
    left = OF_PLACE * j
    right, on = right_of(arc, j)
    scale = mean_turned(half)
    return segment_between(
        known[left + VALUE, np.uintp(i)],
        known[right + VALUE, np.uintp(i + on)],
        half * known[left + RISE, np.uintp(i)],
        half * known[right + RISE, np.uintp(i + on)],
        known[left + BEARING_SLOPE, np.uintp(i)],
        known[right + BEARING_SLOPE, np.uintp(i + on)],
        3.0 * half * half * surfaces[BEARING + CUBE, np.uintp(arc.bearing + i)],
        fourth_order(eccentricity, half),
        half,
        scale * (known[left + COSINE, np.uintp(i)] + known[right + COSINE, np.uintp(i + on)]),
        scale * (known[left + SINE, np.uintp(i)] + known[right + SINE, np.uintp(i + on)]),
    )


@inlined
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
    for j in range(arc.before + arc.behind):
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


@inlined
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
    first, last = arc.cells, -1
    for j in range(arc.before + arc.behind):
        x, half = segment_of(arc, j)
        for i in range(arc.cells):
            bed = with_peak(bed, known[OF_PLACE * j + VALUE, np.uintp(i)], begin_of(arc, i) + x)
    bed = with_peak(bed, known[VALUE, np.uintp(arc.cells)], begin_of(arc, arc.cells))
    for j in range(arc.before + arc.behind):
        x, half = segment_of(arc, j)
        for i in range(arc.cells):
            low, high = bounds[2 * j + LOW, np.uintp(i)], bounds[2 * j + HIGH, np.uintp(i)]
            if low > 0.0:
                first, last = min(first, i), max(last, i)
            is_cut = high > 0.0 and low <= 0.0
            if is_cut or high > bed.overlap:
                g = known_segment(surfaces, eccentricity, arc, known, j, i)
                if high > bed.overlap:
                    bed = with_peak_of(g, begin_of(arc, i) + x + half, bed)
                if is_cut:
                    bed = add_pressed(g, bed)
    if first <= last:
        bed = add_pressed_cells(surfaces, eccentricity, arc, first, last, known, bounds, sums, bed)
    return bed


class Reach(NamedTuple):
    """Where two surfaces may meet: cells side by side, which are taken in one arc or more.

    Attributes
    ----------
    bearing, pin : int
        First cell, and the pin's in which it begins.
    ahead : int
        Cells before the one that holds the direction of the eccentricity.
    into : float
        Way from there to that direction, rad.
    cells, count : int
        Their number, and that of a turn.
    """

    bearing: int
    pin: int
    ahead: int
    into: float
    cells: int
    count: int


@inlined
def laid(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> tuple[Reach, Arc, float]:
    """Where two surfaces may meet, an arc's places in each cell, and the overlap towards e, m.

    Parameters are those of ``press``.
    """
    width = 2.0 * math.pi / count
    b, into = cell_of(bearing_place, count, 0.5)
    p, p_x = cell_of(pin_place, count, 0.5)
    here = depth_at(surfaces, BEARING, b, into)[0] + depth_at(surfaces, PIN, p, p_x)[0]
    end = reach_of(eccentricity, clearance, least_depth, here)
    ahead = max(math.ceil((end - into) / width), 0)
    cells = min(ahead + math.ceil((end + into) / width), count)
    # In each cell of the bearing lies a node of the pin, everywhere in the same place.
    node = width - p_x + into
    if node > width:
        node -= width
        p -= 1
    before = after = 1
    half_before, half_behind = 0.5 * node, 0.5 * (width - node)
    if width > LONGEST_SEGMENT:
        before = max(math.ceil(node / LONGEST_SEGMENT), 1)
        after = max(math.ceil((width - node) / LONGEST_SEGMENT), 1)
        half_before, half_behind = half_before / before, half_behind / after
    b, p = onto(b - ahead, count), onto(p - ahead, count)
    places = Arc(b, p, 0, 0, 0.0, width, node, before, after, half_before, half_behind)
    return Reach(b, p, ahead, into, cells, count), places, eccentricity - clearance - here


@inlined
def arc_behind(reach: Reach, places: Arc, done: int) -> Arc:
    """The arc behind so many cells that are done."""
    cells = min(reach.cells - done, min(CELLS, max(int(1.0 / places.width), 1)))
    first = done - reach.ahead
    # The cell that holds the direction of e, where it is near.
    origin = -first
    if max(origin, cells - origin) * places.width > 0.5:
        origin = cells // 2
    return Arc(
        onto(reach.bearing + done, reach.count),
        onto(reach.pin + done, reach.count),
        cells,
        origin,
        (first + origin) * places.width - reach.into,
        places.width,
        places.node,
        places.before,
        places.behind,
        places.half_before,
        places.half_behind,
    )


@compiled
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
    reach, places, overlap = laid(
        surfaces, count, eccentricity, clearance, least_depth, bearing_place, pin_place
    )
    bed = Bed(overlap, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    done = 0
    while done < reach.cells and eccentricity > 0.0:
        arc = arc_behind(reach, places, done)
        bed = with_arc(surfaces, eccentricity, clearance, arc, known, bounds, sums, bed)
        done += arc.cells
    return bed


@inlined
def area_until(g: Segment, x: float) -> float:
    """Integral of the overlap of a segment from its middle to a place, m rad."""
    return (
        g.half
        * x
        * (g.a0 + x * (0.5 * g.a1 + x * (THIRD * g.a2 + x * (0.25 * g.a3 + x * FIFTH * g.a4))))
    )


@compiled
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
    reach, places, _ = laid(
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
        arc = arc_behind(reach, places, done)
        done += arc.cells
        note_places(surfaces, eccentricity, clearance, arc, known)
        note_bounds(eccentricity, arc, known, bounds)
        for i in range(arc.cells):
            for j in range(arc.before + arc.behind):
                if bounds[2 * j + HIGH, i] <= 0.0:
                    is_behind = False
                    continue
                x, half = segment_of(arc, j)
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


@inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Integral of the overlap of a round pin from the direction of e to a place, m rad."""
    y = x * x
    # x - sin x as a series: the difference cancels.
    short = math.sin(x) - x
    if y < 0.25:
        short = x * y * (C3 + y * (C5 + y * (C7 + y * (C9 + y * C11))))
    return (eccentricity - clearance) * x + eccentricity * short


@compiled
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
