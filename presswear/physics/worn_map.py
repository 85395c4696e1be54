"""Maps of worn surfaces: packed rows of cubics, and depth and slope at an angle.

The nodes of the bearing's map, its bin centres, divide the turn into cells. Between two
nodes the depth is the cubic of ``linkage.surface``.
"""

import math

import numpy as np

from presswear.linkage.surface import Surface
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled, inlined

# Rows of each surface, of the bearing from 0 and of the pin from 5: depth at the nodes,
# the coefficients of x, x^2 and x^3 of the cubic after each, with x from 0 to 1 over a
# cell, m, and a lower bound of the depth in the cell. Cosine and sine of the angles of
# the nodes. The columns are the nodes of three turns, so that no search crosses a seam.
BEARING = 0
PIN = 5
COSINE = 10
SINE = 11
# Working space of ``foundation``: the places where arcs of overlap start and end, in
# cells, and the place of the pin for which they are and their number.
ARC_START, ARC_END, ARC_PLACE, ROWS = range(12, 16)
# Columns of the row ARC_PLACE: eccentricity in the frame of the map, m; lag of the pin's
# map, in cells; number of arcs
PLACE_X, PLACE_Y, PLACE_LAG, ARC_COUNT = range(4)
SLOPE = 1
SQUARE = 2
CUBE = 3
LEAST = 4
SIDE_ROWS = 5
TURNS = 3
SPARE = 8  # nodes behind them, so that cells can be summed by fours
SURFACES = np.zeros((ROWS, 1))  # example of the type of packed surfaces, contiguous

# rad, of nodes; over wider cells neglected terms of the cosine would show
MAX_SPACING = 0.02


def parts_of(bins: int) -> int:
    """Return into how many cells a map divides its bins; odd, so that bin centres are nodes."""
    return 1 + 2 * math.ceil(0.5 * (2.0 * math.pi / (MAX_SPACING * bins) - 1.0))


def pack_rows(bearing: Surface, pin: Surface, bins: int) -> Array:
    """Return the rows of both maps, shape (ROWS, 3 nodes + 2), of ``bins parts_of(bins)`` nodes."""
    parts = parts_of(bins)
    nodes = bins * parts
    width = 2.0 * math.pi / nodes
    angles = width * (np.arange(nodes) + 0.5)
    rows = np.zeros((ROWS, TURNS * nodes + SPARE))
    rows[COSINE] = np.resize(np.cos(angles), rows.shape[1])
    rows[SINE] = np.resize(np.sin(angles), rows.shape[1])
    for side, surface in ((BEARING, bearing), (PIN, pin)):
        if surface.is_worn:
            cubics = _cubics(surface, parts)
            least = _least_depths(cubics)
            if side == PIN:
                # A cell of the bearing lies over two of the pin.
                least = np.minimum(least, np.roll(least, -1))
            filled = np.vstack((cubics, least))
            rows[side : side + SIDE_ROWS] = np.pad(
                filled, ((0, 0), (0, 2 * nodes + SPARE)), "wrap"
            )
    return rows


def _cubics(surface: Surface, parts: int) -> Array:
    """Return the coefficients of the cubic after each node, m, shape (4, nodes)."""
    depth = surface.depth
    slope = surface.slope * (2.0 * math.pi / depth.size)
    following = np.roll(slope, -1)
    rise = np.roll(depth, -1) - depth
    square = 3.0 * rise - 2.0 * slope - following
    cube = slope + following - 2.0 * rise
    x = np.arange(parts) / parts
    d, s, q, c = (values[:, np.newaxis] for values in (depth, slope, square, cube))
    coefficients = (
        d + x * (s + x * (q + x * c)),
        (s + x * (2.0 * q + 3.0 * x * c)) / parts,
        (q + 3.0 * x * c) / parts**2,
        (c + 0.0 * x) / parts**3,
    )
    return np.roll(np.reshape(coefficients, (4, -1)), parts // 2, axis=1)


def _least_depths(cubics: Array) -> Array:
    """Return a lower bound of the depth in each cell, m, shape (nodes,).

    It is also a lower bound of any cubic, one cell long, whose depths and slopes at its
    ends occur in the cell. A cubic lies within its Bezier points. Those of this cubic are
    the depths, and the depths plus or minus a third of the slopes.
    """
    depth, slope, square, cube = cubics
    points = [depth, depth + slope / 3, depth + (2.0 * slope + square) / 3]
    points.append(depth + slope + square + cube)
    first, second, third = np.diff(points, axis=0)
    thirds = [first, (first + 2.0 * second) / 3, (2.0 * second + third) / 3, third]
    return np.asarray((np.array(points) - np.abs(thirds)).min(axis=0))


def least_depth(rows: Array) -> float:
    """Return a lower bound of the depths of both surfaces together, m."""
    return float(rows[BEARING + LEAST].min() + rows[PIN + LEAST].min())


@compiled
def bin_of(angle: float, count: int) -> int:
    """Return the index of the bin that holds an angle, rad."""
    return math.floor(angle * count / (2.0 * math.pi)) % count


@inlined
def cell_of(angle: float, nodes: int) -> tuple[int, float]:
    """Return the node at or before an angle, rad, and the way from there, in cells."""
    turn = angle * (0.5 / math.pi)
    position = (turn - np.floor(turn)) * nodes - 0.5
    before = np.floor(position)
    node = int(before)
    if node < 0:
        node += nodes
    # In a trial state the angle may be so large that round-off leaves no place in a
    # cell.
    if not 0 <= node < nodes:
        return 0, 0.0
    return node, min(max(position - before, 0.0), 1.0)


@inlined
def depth_at(
    surfaces: Array, row: int, node: int, x: float
) -> tuple[float, float, float]:
    """Return depth, m, slope, m per cell, and second derivative of a map x cells after a node."""
    # An index without a sign needs no test for a negative one, and loops over nodes
    # take several at a time.
    column = np.uintp(node)
    depth = surfaces[row, column]
    slope = surfaces[row + SLOPE, column]
    square = surfaces[row + SQUARE, column]
    cube = surfaces[row + CUBE, column]
    return (
        depth + x * (slope + x * (square + x * cube)),
        slope + x * (2.0 * square + x * 3.0 * cube),
        2.0 * square + x * 6.0 * cube,
    )


@inlined
def profile(
    surfaces: Array, row: int, nodes: int, angle: float
) -> tuple[float, float, float]:
    """Return depth, m, slope, m/rad, and second derivative of a map at an angle.

    The second derivative, m/rad^2, jumps at the bin centres.
    """
    if nodes == 0:
        return 0.0, 0.0, 0.0
    node, x = cell_of(angle, nodes)
    depth, slope, curvature = depth_at(surfaces, row, node, x)
    per_radian = nodes * (0.5 / math.pi)
    return depth, per_radian * slope, per_radian * per_radian * curvature
