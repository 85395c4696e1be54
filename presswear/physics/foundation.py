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
    C2,
    C3,
    C4,
    C5,
    C6,
    NOTHING,
    TWELFTH,
    Bed,
    Segment,
    add_whole,
    area_of,
    bound_of,
    change_of,
    press_segment,
    series,
    turned,
    with_peak_of,
)
from presswear.physics.surface import BEARING, CUBE, LEAST, PIN, SLOPE, SQUARE, profile
from presswear.tools.compiled import compiled, inlined, working_space

Array = NDArray[np.float64]
Cell = int | np.unsignedinteger[Any]
"""Place of a cell; a loop over those that cannot be below zero is done by whole vectors."""

LONGEST_SEGMENT = 0.1
"""rad."""


@inlined
def cubic_about(surfaces: Array, row: int, k: Cell, x: float) -> tuple[float, float, float, float]:
    """Coefficients of piece ``k`` of a map about a place x behind its first node, rad."""
    c1 = surfaces[row + SLOPE, k]
    c2 = surfaces[row + SQUARE, k]
    c3 = surfaces[row + CUBE, k]
    triple = 3.0 * x * c3
    return (
        surfaces[row, k] + x * (c1 + x * (c2 + x * c3)),
        c1 + x * (2.0 * c2 + triple),
        c2 + triple,
        c3,
    )


@inlined
def segment_of(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    bearing: Cell,
    pin: Cell,
    bearing_x: float,
    pin_x: float,
    cosine: float,
    sine: float,
) -> Segment:
    """The overlap about a place, from pieces of both maps and places in them, rad.

    ``cosine`` and ``sine`` are those of the place, from the direction of the eccentricity.
    """
    b0, b1, b2, b3 = cubic_about(surfaces, BEARING, bearing, bearing_x)
    p0, p1, p2, p3 = cubic_about(surfaces, PIN, pin, pin_x)
    ec = eccentricity * cosine
    es = eccentricity * sine
    return Segment(
        ec - clearance - b0 - p0,
        -es - b1 - p1,
        C2 * ec - b2 - p2,
        -C3 * es - b3 - p3,
        C4 * ec,
        -C5 * es,
        C6 * ec,
        b1,
        2.0 * b2,
        3.0 * b3,
        cosine,
        sine,
    )


@inlined
def cell_of(angle: float, count: int, shift: float) -> tuple[int, float]:
    """Cell of a grid of so many around the turn that holds an angle, and the way into it, rad.

    ``shift`` is where the first cell begins, as a part of a cell.
    """
    width = 2.0 * math.pi / count
    position = angle / width - shift
    cell = math.floor(position)
    # A trial state may be so far off that round-off leaves no place in a cell.
    return cell % count, min(max((position - cell) * width, 0.0), width)


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
    return min(2.0 * math.asin(sine) + 1e-9, math.pi)


@inlined
def least_bound(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    bearing: int,
    pin: int,
    left: float,
    length: float,
) -> float:
    """Bound above the overlap between two places, from pieces of both maps, m."""
    near = max(left, -left - length, 0.0)
    # 1 - cos x is at least x^2 / 2 (1 - x^2 / 12).
    bound = eccentricity * (1.0 - 0.5 * near * near * (1.0 - TWELFTH * near * near)) - clearance
    return bound - (surfaces[BEARING + LEAST, bearing] + surfaces[PIN + LEAST, pin])


LANES = 8
"""Numbers of a vector, at most."""
CELLS = 32
"""Most cells that are looked over at once; with LANES more they lie within AROUND."""
TOLD = 8
"""Numbers that are told of each segment."""


@inlined
def with_whole(told: Array, i: int, bed: Bed) -> Bed:
    """The bed with all of a segment that was looked over."""
    return Bed(
        bed.overlap,
        bed.place,
        bed.along + told[3, i],
        bed.across + told[4, i],
        bed.slope + told[5, i],
        bed.square + told[6, i],
        bed.area + told[7, i],
    )


class Strip(NamedTuple):
    """Segments side by side that lie alike in the cells of both maps.

    Attributes
    ----------
    bearing, pin : int
        Cells of the first in either map.
    bearing_x, pin_x : float
        Middle of each in its cells, rad.
    first, half : float
        Middle of the first, from the direction of the eccentricity, and half the length, rad.
    segments : int
        Their number.
    """

    bearing: int
    pin: int
    bearing_x: float
    pin_x: float
    first: float
    half: float
    segments: int


@inlined
def look_over(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    strip: Strip,
    width: float,
    turn: float,
    told: Array,
) -> None:
    """Integrate the segments of a strip, all of them at once.

    Parameters
    ----------
    width : float
        Way from each to the next, rad.
    turn : float
        An angle within half a radian of all of them, from the direction of the eccentricity, rad.
    told : ndarray, shape (TOLD, n)
        Filled in, a column for each segment: overlap in the middle, how far it may be from that
        elsewhere, and a bound above it, m; the sums of ``Bed`` over the whole segment.  The last
        columns, up to a multiple of LANES, are of cells behind.
    """
    cosine, sine = turned(turn)
    first = strip.first - turn
    # A multiple that the compiler sees is done by whole vectors.
    for i in range(LANES * ((strip.segments + LANES - 1) // LANES)):
        c, s = series(first + i * width)
        g = segment_of(
            surfaces,
            eccentricity,
            clearance,
            np.uintp(strip.bearing + i),
            np.uintp(strip.pin + i),
            strip.bearing_x,
            strip.pin_x,
            cosine * c - sine * s,
            cosine * s + sine * c,
        )
        whole = add_whole(g, strip.half, NOTHING)
        told[0, i] = g.a0
        told[1, i] = change_of(g, strip.half)
        told[2, i] = bound_of(g, strip.half)
        told[3, i] = whole.along
        told[4, i] = whole.across
        told[5, i] = whole.slope
        told[6, i] = whole.square
        told[7, i] = whole.area


@inlined
def with_strip(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    strip: Strip,
    width: float,
    told: Array,
    bed: Bed,
) -> Bed:
    """The bed with a strip that was looked over: whole segments as told, those cut one by one.

    Before these the one with the highest bound: beside its peak few others are worth a look.
    """
    highest = 0
    for i in range(strip.segments):
        if told[2, i] > told[2, highest]:
            highest = i
        if told[0, i] >= told[1, i]:
            bed = with_whole(told, i, bed)
    for k in range(-1, strip.segments):
        i = highest if k < 0 else k
        is_cut = k >= 0 and told[2, i] > 0.0 and told[0, i] < told[1, i]
        if is_cut or told[2, i] > bed.overlap:
            middle = strip.first + i * width
            cosine, sine = turned(middle)
            segment = segment_of(
                surfaces,
                eccentricity,
                clearance,
                strip.bearing + i,
                strip.pin + i,
                strip.bearing_x,
                strip.pin_x,
                cosine,
                sine,
            )
            if is_cut:
                bed = press_segment(segment, middle, strip.half, bed)
            else:
                bed = with_peak_of(segment, middle, strip.half, bed)
    return bed


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
    width = 2.0 * math.pi / count
    maps = surfaces[:, :count]
    here = profile(maps[BEARING], maps[BEARING + SLOPE], bearing_place)[0]
    here += profile(maps[PIN], maps[PIN + SLOPE], pin_place)[0]
    bed = Bed(eccentricity - clearance - here, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if eccentricity == 0.0:
        return bed
    end = reach_of(eccentricity, clearance, least_depth, here)
    told = working_space(TOLD, CELLS)
    # Cells of the bearing; in each of them lies a node of the pin, everywhere in the same place.
    b, b_x = cell_of(bearing_place - end, count, 0.5)
    p, p_x = cell_of(pin_place - end, count, 0.5)
    left = -end - b_x
    node = width - p_x + b_x
    if node > width:
        node -= width
        p = p - 1 if p > 0 else count - 1
    most = min(CELLS, max(int(1.0 / width), 1))
    cells = min(math.ceil((end - left) / width), count)
    while cells > 0:
        many = min(cells, most)
        turn = left + 0.5 * many * width
        for part in range(2):
            start, p_start = (0.0, width - node) if part == 0 else (node, 0.0)
            length = node if part == 0 else width - node
            pieces = math.ceil(length / LONGEST_SEGMENT)
            half = 0.5 * length / max(pieces, 1)
            for piece in range(pieces):
                way = (2 * piece + 1) * half
                b_way, p_way = start + way, p_start + way
                strip = Strip(b, p + part, b_way, p_way, left + b_way, half, many)
                look_over(surfaces, eccentricity, clearance, strip, width, turn, told)
                bed = with_strip(surfaces, eccentricity, clearance, strip, width, told, bed)
        left += many * width
        b, p = (b + many) % count, (p + many) % count
        cells -= many
    return bed


@compiled
def spread(
    surfaces: Array,
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
    surfaces : ndarray, shape (ROWS, m)
        As for ``press``; round ones are a map of one bin.
    shares : ndarray, shape (2, n)
        Of bearing and pin, m rad.
    """
    if eccentricity == 0.0:
        return 0.0
    count = surfaces.shape[1]
    width = 2.0 * math.pi / count
    bins = shares.shape[1]
    bin_width = 2.0 * math.pi / bins
    end = reach_of(eccentricity, clearance, least_depth, eccentricity - clearance)
    left = -end
    b, b_x = cell_of(bearing_place - end, count, 0.5)
    p, p_x = cell_of(pin_place - end, count, 0.5)
    b_bin, b_way = cell_of(bearing_place - end, bins, 0.0)
    p_bin, p_way = cell_of(pin_place - end, bins, 0.0)
    total = 0.0
    while left < end:
        length = min(min(width - b_x, width - p_x), min(bin_width - b_way, bin_width - p_way))
        length = min(length, min(end - left, LONGEST_SEGMENT))
        half = 0.5 * length
        if least_bound(surfaces, eccentricity, clearance, b, p, left, length) > 0.0:
            cosine, sine = turned(left + half)
            segment = segment_of(
                surfaces, eccentricity, clearance, b, p, b_x + half, p_x + half, cosine, sine
            )
            share = area_of(segment, half)
            # The overlap at its end is nothing but round-off.
            if share > 0.0:
                shares[0, b_bin] += share
                shares[1, p_bin] += share
                total += share
        left += length
        b, b_x = onward(b, b_x, length, width, count)
        p, p_x = onward(p, p_x, length, width, count)
        b_bin, b_way = onward(b_bin, b_way, length, bin_width, bins)
        p_bin, p_way = onward(p_bin, p_way, length, bin_width, bins)
    return total


def foundation_stiffness(stiffness: float, clearance: float) -> float:
    """k_w b R, N/m^2 per rad, with which a round joint gives K delta^1.5.

    The overlap of a round joint is delta - c s^2 / 2, and its integral over the arc
    (4/3) sqrt(2 / c) delta^1.5; the arc's curvature adds parts of delta / c.
    """
    return 0.75 * stiffness * math.sqrt(0.5 * clearance)
