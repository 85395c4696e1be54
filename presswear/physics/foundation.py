"""A round pin on the worn arc of its bearing: a linear elastic foundation.

The overlap at an angle theta is p = e . n(theta) - c - h_bearing - h_pin, the pressure
k_w p where p > 0.  The elastic energy is the integral of k_w b R p^2 / 2 over the angle;
force and couples are its gradient.  A pin cannot enter a groove narrower than itself:
grooves are bridged, and two patches are two patches without a case for it.

The arc is taken in segments between neighbouring nodes of the two maps.  Those that cannot meet
are passed over by a bound.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.overlap import (
    C2,
    C3,
    C4,
    C5,
    C6,
    TWELFTH,
    Bed,
    Segment,
    area_of,
    press_segment,
    turned,
)
from presswear.physics.surface import BEARING, CUBE, LEAST, PIN, SLOPE, SQUARE, profile
from presswear.tools.compiled import compiled, inlined

Array = NDArray[np.float64]

LONGEST_SEGMENT = 0.1
"""rad."""


@inlined
def cubic_about(surfaces: Array, row: int, k: int, x: float) -> tuple[float, float, float, float]:
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
    bearing: int,
    pin: int,
    bearing_x: float,
    pin_x: float,
    middle: float,
) -> Segment:
    """The overlap about a place, from pieces of both maps and places in them, rad."""
    b0, b1, b2, b3 = cubic_about(surfaces, BEARING, bearing, bearing_x)
    p0, p1, p2, p3 = cubic_about(surfaces, PIN, pin, pin_x)
    cosine, sine = turned(middle)
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
def bound_of(
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


@compiled
def press(
    surfaces: Array,
    eccentricity: float,
    clearance: float,
    least_depth: float,
    bearing_place: float,
    pin_place: float,
) -> Bed:
    """The bed of a pin in its bearing.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, m)
    least_depth : float
        Sum of the least depths of both, m.
    bearing_place, pin_place : float
        Direction of the eccentricity in the maps of bearing and pin, rad.
    """
    count = surfaces.shape[1]
    width = 2.0 * math.pi / count
    here = profile(surfaces[BEARING], surfaces[BEARING + SLOPE], bearing_place)[0]
    here += profile(surfaces[PIN], surfaces[PIN + SLOPE], pin_place)[0]
    bed = Bed(eccentricity - clearance - here, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if eccentricity == 0.0:
        return bed
    end = reach_of(eccentricity, clearance, least_depth, here)
    left = -end
    b, b_x = cell_of(bearing_place - end, count, 0.5)
    p, p_x = cell_of(pin_place - end, count, 0.5)
    while left < end:
        length = min(min(width - b_x, width - p_x), min(end - left, LONGEST_SEGMENT))
        half = 0.5 * length
        bound = bound_of(surfaces, eccentricity, clearance, b, p, left, length)
        if bound > 0.0 or bound > bed.overlap:
            middle = left + half
            segment = segment_of(
                surfaces, eccentricity, clearance, b, p, b_x + half, p_x + half, middle
            )
            bed = press_segment(segment, middle, half, bed)
        left += length
        b, b_x = onward(b, b_x, length, width, count)
        p, p_x = onward(p, p_x, length, width, count)
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
        if bound_of(surfaces, eccentricity, clearance, b, p, left, length) > 0.0:
            middle = left + half
            segment = segment_of(
                surfaces, eccentricity, clearance, b, p, b_x + half, p_x + half, middle
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
