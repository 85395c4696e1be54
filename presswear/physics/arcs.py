"""Arcs of two worn surfaces: where they may meet, and what is known along them.

Both maps have nodes at one distance, so that in each cell between two nodes of the bearing the
pin's node lies alike.  The overlap is taken at one place of all cells at once, as a processor does
eight numbers at once; a segment between two places follows from both (``overlap``).
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.overlap import (
    Segment,
    fourth_order,
    hull,
    mean_turned,
    segment_between,
    series,
    turned,
)
from presswear.physics.surface import BEARING, CUBE, PIN, SLOPE, SQUARE
from presswear.tools.compile import fused_inlined

Array = NDArray[np.float64]
Cell = int | np.unsignedinteger[Any]
"""Place of a cell; a loop over those that cannot be below zero is done by whole vectors."""

LONGEST_SEGMENT = 0.02
"""rad."""


@fused_inlined
def depth_at(surfaces: Array, row: int, k: Cell, x: float) -> tuple[float, float]:
    """Depth of a map, m, and its slope, m/rad, in piece ``k`` behind its first node by x rad."""
    c1 = surfaces[row + SLOPE, k]
    c2 = surfaces[row + SQUARE, k]
    c3 = surfaces[row + CUBE, k]
    return surfaces[row, k] + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + x * 3.0 * c3)


@fused_inlined
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


@fused_inlined
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


@fused_inlined
def map_at(surfaces: Array, row: int, count: int, angle: float) -> tuple[float, float]:
    """Depth of a map of so many bins, m, and its slope, m/rad, at any angle, rad."""
    k, x = cell_of(angle, count, 0.5)
    return depth_at(surfaces, row, k, x)


@fused_inlined
def onto(cell: int, count: int) -> int:
    """The same cell by its number from 0, less than a turn off."""
    if cell < 0:
        return cell + count
    return cell - count if cell >= count else cell


@fused_inlined
def onward(cell: int, x: float, length: float, width: float, count: int) -> tuple[int, float]:
    """The cell and the way into it a length further on, which ends in the cell or with it."""
    x += length
    if x >= width * (1.0 - 1e-14):
        return (cell + 1 if cell + 1 < count else 0), 0.0
    return cell, x


@fused_inlined
def angle_of(eccentricity: float, clearance: float, least_depth: float, here: float) -> float:
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


class Places(NamedTuple):
    """Where in each cell the overlap is taken; segments run from one place to the next.

    Attributes
    ----------
    width : float
        Length of a cell, rad.
    node : float
        Way from its beginning, a node of the bearing, to one of the pin, rad.
    before, behind : int
        Segments before that node and behind it.
    half_before, half_behind : float
        Half the length of each of these, rad.
    """

    width: float
    node: float
    before: int
    behind: int
    half_before: float
    half_behind: float


class Arc(NamedTuple):
    """Cells side by side.

    Attributes
    ----------
    places : Places
    bearing, pin : int
        First cell, and the pin's in which it begins.
    cells : int
        Their number.
    origin : int
        A cell within half a radian of all of them.
    turn : float
        Where that begins, from the direction of the eccentricity, rad.
    """

    places: Places
    bearing: int
    pin: int
    cells: int
    origin: int
    turn: float


@fused_inlined
def segments_of(places: Places) -> int:
    """Segments in a cell."""
    return places.before + places.behind


@fused_inlined
def segment_of(places: Places, j: int) -> tuple[float, float]:
    """Where segment ``j`` of a cell begins, and half its length, rad."""
    if j < places.before:
        return 2.0 * j * places.half_before, places.half_before
    return places.node + 2.0 * (j - places.before) * places.half_behind, places.half_behind


@fused_inlined
def begin_of(arc: Arc, i: int) -> float:
    """Where cell ``i`` of an arc begins, from the direction of the eccentricity, rad."""
    return arc.turn + (i - arc.origin) * arc.places.width


@fused_inlined
def lanes(count: int) -> int:
    """So many or more: a multiple that the compiler sees is done by whole vectors."""
    return LANES * ((count + LANES - 1) // LANES)


@fused_inlined
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
    for j in range(segments_of(arc.places)):
        x, _ = segment_of(arc.places, j)
        is_behind = j >= arc.places.before
        pin = arc.pin + (1 if is_behind else 0)
        pin_x = x - arc.places.node + (0.0 if is_behind else arc.places.width)
        cosine, sine = turned(arc.turn + x)
        for i in range(lanes(arc.cells + 1)):
            c, s = series((i - arc.origin) * arc.places.width)
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


@fused_inlined
def right_of(places: Places, j: int) -> tuple[int, int]:
    """First row, and columns further, of the place in which segment ``j`` of a cell ends."""
    return (OF_PLACE * (j + 1), 0) if j + 1 < segments_of(places) else (0, 1)


@fused_inlined
def note_bounds(eccentricity: float, arc: Arc, known: Array, bounds: Array) -> None:
    """Fill in bounds of the overlap of the segments of an arc, m.

    Parameters
    ----------
    bounds : ndarray, shape (2 places, n)
        Rows LOW and HIGH of each segment of a cell.
    """
    for j in range(segments_of(arc.places)):
        half = segment_of(arc.places, j)[1]
        quartic = fourth_order(eccentricity, half)
        right, on = right_of(arc.places, j)
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


@fused_inlined
def known_segment(
    surfaces: Array, eccentricity: float, arc: Arc, known: Array, j: int, i: Cell
) -> Segment:
    """Segment ``j`` of cell ``i`` from what is known at both ends."""
    half = segment_of(arc.places, j)[1]
    left = OF_PLACE * j
    right, on = right_of(arc.places, j)
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


@fused_inlined
def highest_of(arc: Arc, known: Array, tops: Array) -> float:
    """The greatest overlap at the places of an arc, m.

    Parameters
    ----------
    tops : ndarray, shape (1, LANES)
        Working space.
    """
    for lane in range(LANES):
        tops[0, lane] = -math.inf
    for j in range(segments_of(arc.places)):
        for part in range(lanes(arc.cells + 1) // LANES):
            for lane in range(LANES):
                i = LANES * part + lane
                value = known[OF_PLACE * j + VALUE, np.uintp(i)]
                tops[0, lane] = max(tops[0, lane], value if i <= arc.cells else -math.inf)
    one = max(max(tops[0, 0], tops[0, 1]), max(tops[0, 2], tops[0, 3]))
    return max(one, max(max(tops[0, 4], tops[0, 5]), max(tops[0, 6], tops[0, 7])))


class Reach(NamedTuple):
    """Where two surfaces may meet: cells side by side, which are taken in one arc or more.

    Attributes
    ----------
    places : Places
    bearing, pin : int
        First cell, and the pin's in which it begins.
    ahead : int
        Cells before the one that holds the direction of the eccentricity.
    into : float
        Way from its beginning to that direction, rad.
    cells, whole : int
        Their number, and that of a turn.
    overlap : float
        Overlap in that direction, m.
    """

    places: Places
    bearing: int
    pin: int
    ahead: int
    into: float
    cells: int
    whole: int
    overlap: float


@fused_inlined
def reach_between(
    surfaces: Array,
    count: int,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> Reach:
    """Where two surfaces may meet; parameters are those of ``press``."""
    width = 2.0 * math.pi / count
    b, into = cell_of(bearing_place, count, 0.5)
    p, p_x = cell_of(pin_place, count, 0.5)
    here = depth_at(surfaces, BEARING, b, into)[0] + depth_at(surfaces, PIN, p, p_x)[0]
    end = angle_of(eccentricity, clearance, least_depth, here)
    ahead = max(math.ceil((end - into) / width), 0)
    cells = min(ahead + math.ceil((end + into) / width), count)
    # In each cell of the bearing lies a node of the pin, everywhere in the same place.
    node = width - p_x + into
    if node > width:
        node -= width
        p -= 1
    before = behind = 1
    half_before, half_behind = 0.5 * node, 0.5 * (width - node)
    if width > LONGEST_SEGMENT:
        before = max(math.ceil(node / LONGEST_SEGMENT), 1)
        behind = max(math.ceil((width - node) / LONGEST_SEGMENT), 1)
        half_before, half_behind = half_before / before, half_behind / behind
    return Reach(
        Places(width, node, before, behind, half_before, half_behind),
        onto(b - ahead, count),
        onto(p - ahead, count),
        ahead,
        into,
        cells,
        count,
        eccentricity - clearance - here,
    )


@fused_inlined
def arc_behind(reach: Reach, done: int) -> Arc:
    """The arc behind so many cells that are done."""
    width = reach.places.width
    cells = min(reach.cells - done, min(CELLS, max(int(1.0 / width), 1)))
    first = done - reach.ahead
    # The cell that holds the direction of e, where it is near.
    origin = -first
    if max(origin, cells - origin) * width > 0.5:
        origin = cells // 2
    return Arc(
        reach.places,
        onto(reach.bearing + done, reach.whole),
        onto(reach.pin + done, reach.whole),
        cells,
        origin,
        (first + origin) * width - reach.into,
    )
