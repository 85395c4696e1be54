"""Elastic foundation between a round pin and its worn bearing.

The overlap at an angle theta is p = e . n(theta) - c - h_i - h_j, with the eccentricity e,
the unit vector n(theta), the clearance c and the wear depths h_i of the bearing and h_j of
the pin. The pressure is k_w p where p > 0, with the stiffness k_w of the foundation. The
elastic energy is the integral of k_w b R p^2 / 2 over the angle, with the width b and the
radius R of the bearing. Force and couples are its gradient. A pin cannot enter a groove
narrower than itself: grooves are bridged.

Force, couples and energy are sums of closed formulas over the cells between the nodes
of the bearing's map (``overlap``).
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.physics.overlap import (
    ArcIntegrals,
    Node,
    Place,
    add_parts,
    cubic_between,
    fourth_order,
    has_one_root,
    inner_points,
    maximum_of,
    monotony,
    node_at,
    node_within,
    only_root,
    overlap_between,
    value_at,
    with_part,
)
from presswear.physics.worn_map import (
    ARC_COUNT,
    ARC_END,
    ARC_PLACE,
    ARC_START,
    BEARING,
    COSINE,
    CUBE,
    LEAST,
    PIN,
    PLACE_LAG,
    PLACE_X,
    PLACE_Y,
    SINE,
    cell_of,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, vectorised

# The number of summed cells is a multiple of LANES, because vector instructions sum so many
# at once.
LANES = 4
# Smallest number of cells on each side of the previous place of the greatest overlap that
# are searched for an overlap
LEAST_CELLS = 8


def foundation_stiffness(stiffness: float, clearance: float) -> float:
    """Return k_w b R, N/m^2 per rad, with which a round joint gives the force K delta^1.5.

    ``stiffness`` is K, N/m^1.5, and ``clearance`` c, m. At an angle s from the line of
    centres the overlap of a round joint is delta - c s^2 / 2. Its integral over the arc
    is (4/3) sqrt(2 / c) delta^1.5, with a relative error of the order of delta / c.
    """
    return 0.75 * stiffness * math.sqrt(0.5 * clearance)


@inlined
def along_at(surfaces: Array, place: Place, node: int) -> float:
    """Return the eccentricity in the direction of a node, m."""
    column = np.uintp(node)
    return place.dx * surfaces[COSINE, column] + place.dy * surfaces[SINE, column]


@inlined
def cells_in_reach(
    surfaces: Array, joint: Records, place: Place, before: int, least: float
) -> tuple[int, int]:
    """Return the first of the cells in which an overlap may exceed ``least``, and their number.

    The cells lie on both sides of cell ``before``, the previous place of the greatest
    overlap, which is counted in the second turn. Their number is doubled until the pin
    does not reach the least depth of all cells at both ends; equation W3. If all cells of
    a turn are needed, they begin opposite to the eccentricity, so that no arc is cut.
    """
    nodes = joint.surface_nodes
    farthest = place.clearance + joint.least_depth + least
    cells = LEAST_CELLS
    while 2 * cells < nodes:
        low = along_at(surfaces, place, before - cells)
        high = along_at(surfaces, place, before + cells)
        # The pin reaches less than a quarter of a turn to both sides of the eccentricity.
        if max(max(low, high), 0.0) <= farthest:
            return before - cells, 2 * cells
        cells *= 2
    direction, _ = cell_of(math.atan2(place.dy, place.dx), nodes)
    return direction + nodes - nodes // 2, nodes


@vectorised
def cells_of_overlap(
    surfaces: Array, place: Place, first: int, count: int, least: float
) -> tuple[int, int]:
    """Return the first and the last of some cells in which the overlap can exceed ``least``, m."""
    needed = place.clearance + least
    low = count
    high = -1
    for k in range(count):
        node = first + k
        along = max(
            along_at(surfaces, place, node), along_at(surfaces, place, node + 1)
        )
        bearing = surfaces[BEARING + LEAST, np.uintp(node)]
        pin = surfaces[PIN + LEAST, np.uintp(node + place.lag)]
        can_exceed = along - bearing - pin > needed
        low = min(low, k if can_exceed else count)
        high = max(high, k if can_exceed else -1)
    return first + low, first + high


class Survey(NamedTuple):
    """Integrals over cells that overlap throughout, and the cells that need more than sums.

    Cells are counted from the first one.
    """

    x: float  # see ``ArcIntegrals``
    y: float
    pin_slope: float
    square: float
    # number of cells in which the overlap becomes positive, and the last of them
    starts: int
    start: int
    # number of cells in which the overlap becomes negative, and the last of them
    ends: int
    end: int
    # first and last cell that may have the greatest overlap between their nodes; the last
    # is -1 if there is none
    first_hump: int
    last_hump: int
    # cells with several roots, or that may overlap between their nodes only
    others: int


@vectorised
def survey_cells(
    surfaces: Array, place: Place, first: int, count: int, previous: float
) -> Survey:
    """Sum the integrals of some cells.

    ``previous`` is the overlap at the previous place of the greatest overlap, m.
    """
    none = ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0)
    x = y = pin_slope = square = 0.0
    starts = ends = others = 0
    start = end = last_hump = -1
    first_hump = count
    for k in range(count):
        left = node_at(surfaces, place, first + k)
        right = node_at(surfaces, place, first + k + 1)
        a4 = fourth_order(left, right, place.width)
        second, third = inner_points(left, right)
        lower = min(min(left.overlap, right.overlap), min(second, third))
        upper = max(max(left.overlap, right.overlap), max(second, third)) + a4
        part = with_part(left, right, 1.0, place.width, a4, none)
        weight = 1.0 if lower > 0.0 else 0.0
        x += weight * part.x
        y += weight * part.y
        pin_slope += weight * part.pin_slope
        square += weight * part.square
        is_start = (left.overlap <= 0.0) & (right.overlap > 0.0)
        is_end = (left.overlap > 0.0) & (right.overlap <= 0.0)
        is_cut = (is_start | is_end) & has_one_root(left, right)
        is_plain = (lower > 0.0) | (upper <= 0.0) | is_cut
        is_hump = (monotony(left, right) <= 0.0) & (upper > previous)
        starts += 1 if is_start else 0
        start = max(start, k if is_start else -1)
        ends += 1 if is_end else 0
        end = max(end, k if is_end else -1)
        first_hump = min(first_hump, k if is_hump else count)
        last_hump = max(last_hump, k if is_hump else -1)
        others += 0 if is_plain else 1
    return Survey(
        x, y, pin_slope, square, starts, start, ends, end, first_hump, last_hump, others
    )


@inlined
def with_cell(
    surfaces: Array, place: Place, node: int, greatest: float, peak: float
) -> tuple[float, float]:
    """Return the greatest overlap of the previous cells and of one more cell, and its place.

    ``greatest``, m, and ``peak``, in cells, are the overlap and the place of the previous
    cells.
    """
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    if left.overlap > greatest:
        greatest = left.overlap
        peak = float(node)
    if right.overlap > greatest:
        greatest = right.overlap
        peak = node + 1.0
    p = overlap_between(left, right, place.width)
    x = maximum_of(p)
    if 0.0 < x < 1.0 and value_at(p, x) > greatest:
        return value_at(p, x), node + x
    return greatest, peak


@inlined
def with_start(
    surfaces: Array, place: Place, node: int, sums: ArcIntegrals
) -> ArcIntegrals:
    """Return the integrals with the cell in which an arc of overlap starts."""
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    p = overlap_between(left, right, place.width)
    x = only_root(p)
    surfaces[ARC_START, sums.arcs] = node + x
    root = node_within(left, right, p, place.width, x)
    return with_part(root, right, 1.0 - x, place.width, p.a4, sums)


@inlined
def with_end(
    surfaces: Array, place: Place, node: int, sums: ArcIntegrals
) -> ArcIntegrals:
    """Return the integrals with the cell in which an arc of overlap ends."""
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    p = overlap_between(left, right, place.width)
    x = only_root(p)
    surfaces[ARC_END, sums.arcs] = node + x
    root = node_within(left, right, p, place.width, x)
    sums = with_part(left, root, x, place.width, p.a4, sums)
    return ArcIntegrals(sums.x, sums.y, sums.pin_slope, sums.square, sums.arcs + 1)


@compiled
def integrate_cells(
    surfaces: Array, place: Place, first: int, last: int
) -> ArcIntegrals:
    """Return the integrals over all arcs of overlap in the cells ``first`` to ``last``."""
    sums = ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0)
    right = node_at(surfaces, place, first)
    for node in range(first, last + 1):
        left = right
        right = node_at(surfaces, place, node + 1)
        a4 = fourth_order(left, right, place.width)
        second, third = inner_points(left, right)
        lower = min(min(left.overlap, right.overlap), min(second, third))
        upper = max(max(left.overlap, right.overlap), max(second, third)) + a4
        if lower > 0.0:
            sums = with_part(left, right, 1.0, place.width, a4, sums)
        elif upper > 0.0:
            is_cut = (left.overlap > 0.0) != (right.overlap > 0.0)
            if not (is_cut and has_one_root(left, right)):
                sums = add_parts(surfaces, place, node, left, right, sums)
            elif right.overlap > 0.0:
                sums = with_start(surfaces, place, node, sums)
            else:
                sums = with_end(surfaces, place, node, sums)
    return sums


class Search(NamedTuple):
    """Cells in which the overlap may be greatest."""

    first: int
    last: int  # less than ``first`` if there is no such cell
    before: int  # node near which the overlap was greatest before
    previous: float  # overlap at this node, m


@inlined
def integrate_arcs(
    surfaces: Array, place: Place, first: int, last: int, survey: Survey
) -> ArcIntegrals:
    """Return the integrals over all arcs of overlap in surveyed cells.

    A single arc that starts and ends in two simple cells needs no further sum.
    """
    is_arc = survey.starts == survey.ends == 1 and survey.start < survey.end
    if survey.others == 0 and is_arc:
        sums = ArcIntegrals(survey.x, survey.y, survey.pin_slope, survey.square, 0)
        sums = with_start(surfaces, place, first + survey.start, sums)
        return with_end(surfaces, place, first + survey.end, sums)
    if survey.others + survey.starts + survey.ends > 0:
        return integrate_cells(surfaces, place, first, last)
    return ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0)


@inlined
def integrate_overlap(
    surfaces: Array, joint: Records, place: Place, angle: float
) -> tuple[Search, ArcIntegrals]:
    """Return the cells in which the overlap may be greatest, and the integrals of the overlap.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, m)
    joint : record of JOINT
    place : Place
    angle : float
        Angle of the bearing's map, rad, near which the overlap was greatest before.
    """
    before = joint.surface_nodes + cell_of(angle, joint.surface_nodes)[0]
    previous = node_at(surfaces, place, before).overlap
    # Bound on the additional reach of the pin between two nodes, m
    bulge = 0.125 * place.width * place.width * place.eccentricity
    least = min(previous, 0.0) - bulge
    first, count = cells_in_reach(surfaces, joint, place, before, least)
    first, last = cells_of_overlap(surfaces, place, first, count, least)
    # Number of cells from first to last, rounded up to a multiple of LANES
    count = min((last + LANES - first) // LANES * LANES, joint.surface_nodes)
    survey = survey_cells(surfaces, place, first, count, previous)
    last_hump = first + survey.last_hump
    search = Search(first + survey.first_hump, last_hump, before, previous)
    sums = integrate_arcs(surfaces, place, first, last, survey)
    surfaces[ARC_PLACE, PLACE_X] = place.dx
    surfaces[ARC_PLACE, PLACE_Y] = place.dy
    surfaces[ARC_PLACE, PLACE_LAG] = place.lag + place.offset
    surfaces[ARC_PLACE, ARC_COUNT] = sums.arcs
    # Ratio of the means of cosine and sine over a cell to the means of their cubics
    scale = 1.0 + (1 / 720) * place.width**4
    sums = ArcIntegrals(
        scale * sums.x, scale * sums.y, sums.pin_slope, sums.square, sums.arcs
    )
    return search, sums


@inlined
def greatest_overlap(
    surfaces: Array, place: Place, search: Search
) -> tuple[float, float]:
    """Return the greatest overlap, m, and its place in cells."""
    greatest = search.previous
    peak = float(search.before)
    for node in range(search.first, search.last + 1):
        greatest, peak = with_cell(surfaces, place, node, greatest, peak)
    return greatest, peak


@inlined
def node_of_peak(surfaces: Array, place: Place, cell: float) -> Node:
    """Return the overlap at its maximum, a place in cells."""
    node = int(cell)
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    p = overlap_between(left, right, place.width)
    return node_within(left, right, p, place.width, cell - node)


@inlined
def derivatives_at(
    surfaces: Array, place: Place, node: int, x: float
) -> tuple[float, float, float, float, float, float]:
    """Return six numbers at a place of a cell, for ``deepest_acceleration``.

    They are the cosine and the sine of its angle, the second derivative of the overlap,
    m, the slope of the pin's map, m, and the derivatives of the slope by x and by the
    relative angle, in cells.
    """
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    p = overlap_between(left, right, place.width)
    here = node_within(left, right, p, place.width, x)
    third = 6.0 * surfaces[PIN + CUBE, node + place.lag]
    following = 6.0 * surfaces[PIN + CUBE, node + 1 + place.lag]
    by_turning = cubic_between(
        left.pin_curvature, third, right.pin_curvature, following, 0.0
    )
    curvature = 2.0 * p.a2 + x * (6.0 * p.a3 + x * 12.0 * p.a4)
    return (
        here.nx,
        here.ny,
        curvature,
        here.pin_slope,
        here.pin_curvature,
        value_at(by_turning, x),
    )
