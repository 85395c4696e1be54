"""Elastic foundation between a round pin and its worn bearing.

The overlap at an angle theta is p = e . n(theta) - c - h_i - h_j, and the pressure is
k_w p where p > 0. The elastic energy is the integral of k_w b R p^2 / 2 over the angle;
force and couples are its gradient. A pin cannot enter a groove narrower than itself:
grooves are bridged.

The nodes of the bearing's map, its bin centres, divide the turn into cells. In a cell
the overlap is the polynomial through its values and derivatives at both nodes. Force,
couples and energy are sums of closed formulas over the cells (docs/theory/contact.md,
equations W1 to W5).
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.linkage.surface import Surface
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

# Rows of each surface, of the bearing from 0 and of the pin from 5: depth at the nodes,
# the coefficients of x, x^2 and x^3 of the cubic after each, with x from 0 to 1 over a
# cell, m, and a lower bound of the depth in the cell. Cosine and sine of the angles of
# the nodes. As working space, the places where arcs of overlap start and end, in cells,
# and the place of the pin for which they are and their number. The columns are the
# nodes of three turns, so that no search crosses a seam.
BEARING = 0
PIN = 5
COSINE = 10
SINE = 11
ARC_START, ARC_END, ARC_PLACE, ROWS = range(12, 16)
SLOPE = 1
SQUARE = 2
CUBE = 3
LEAST = 4
SIDE_ROWS = 5
TURNS = 3
SURFACES = np.zeros((ROWS, 1))  # example of the type of packed surfaces, contiguous

# rad, of nodes; over wider cells neglected terms of the cosine would show
MAX_SPACING = 0.02
NEAR = 0.1  # tangent of an angle that is computed from its series
NEWTON_TOL = 1e-3  # part of a cell; the next Newton step would be about its square
ROOT_TOL = 1e-8  # part of a cell; integrals change with the square of it
MAX_ROOT_STEPS = 60  # Newton's method needs two; bisection helps where it strays


def parts_of(bins: int) -> int:
    """Return into how many cells a map divides its bins; odd, so that bin centres are nodes."""
    return 1 + 2 * math.ceil(0.5 * (2.0 * math.pi / (MAX_SPACING * bins) - 1.0))


def pack_rows(bearing: Surface, pin: Surface, bins: int) -> Array:
    """Return the rows of both maps, shape (ROWS, 3 nodes + 2), of ``bins parts_of(bins)`` nodes."""
    parts = parts_of(bins)
    nodes = bins * parts
    width = 2.0 * math.pi / nodes
    angles = width * (np.arange(nodes) + 0.5)
    rows = np.zeros((ROWS, TURNS * nodes + 2))
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
                filled, ((0, 0), (0, 2 * nodes + 2)), "wrap"
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
    """Return a lower bound of the depth in each cell, and of that of any cubic through its depths.

    A cubic lies within its Bezier points. Those of one through depths and slopes of the
    surface are its depths, and these plus or minus a third of the slopes.
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
    slope = surfaces[row + SLOPE, node]
    square = surfaces[row + SQUARE, node]
    cube = surfaces[row + CUBE, node]
    depth = surfaces[row, node] + x * (slope + x * (square + x * cube))
    return (
        depth,
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


class Place(NamedTuple):
    """Pin in the map of its bearing."""

    dx: float  # eccentricity in the frame of the map, m
    dy: float
    eccentricity: float  # m
    clearance: float  # m
    width: float  # of a cell, rad
    # node of the pin's map at or before a node of the bearing's, less the latter
    lag: int
    offset: float  # way between the two, in cells


@inlined
def place_of(
    joint: Records, dx: float, dy: float, eccentricity: float, relative_angle: float
) -> Place:
    """Return the place of a pin whose map is turned by a relative angle, rad, from the bearing's.

    ``dx`` and ``dy`` are the eccentricity in the frame of the bearing's map, m.
    """
    nodes = joint.surface_nodes
    turns = relative_angle * (0.5 / math.pi)
    position = (turns - np.floor(turns + 0.5)) * nodes
    before = np.floor(position)
    # In a trial state the angle may be so large that round-off leaves no place in a
    # cell.
    if not abs(before) <= nodes:
        position = before = 0.0
    width = 2.0 * math.pi / nodes
    return Place(
        dx, dy, eccentricity, joint.clearance, width, int(before), position - before
    )


class Node(NamedTuple):
    """Overlap at a node of the bearing's map or at an end of an arc; derivatives are per cell."""

    nx: float  # cosine of its angle
    ny: float  # and sine
    along: float  # eccentricity in its direction, m
    overlap: float  # m
    rise: float  # derivative of the overlap, m
    pin_slope: float  # derivatives of the depth of the pin, m
    pin_curvature: float


@inlined
def node_at(surfaces: Array, place: Place, node: int) -> Node:
    """Return the overlap at a node of the bearing's map; equation W1."""
    nx, ny = surfaces[COSINE, node], surfaces[SINE, node]
    depth, slope, curvature = depth_at(surfaces, PIN, node + place.lag, place.offset)
    along = place.dx * nx + place.dy * ny
    overlap = along - place.clearance - surfaces[BEARING, node] - depth
    rise = (
        place.width * (place.dy * nx - place.dx * ny)
        - surfaces[BEARING + SLOPE, node]
        - slope
    )
    return Node(nx, ny, along, overlap, rise, slope, curvature)


class Cubic(NamedTuple):
    """Polynomial a_0 + a_1 x + ... + a_4 x^4 over a cell, x from 0 to 1."""

    a0: float
    a1: float
    a2: float
    a3: float
    a4: float


@inlined
def cubic_between(p0: float, d0: float, p1: float, d1: float, a4: float) -> Cubic:
    """Return the cubic through values and derivatives at both ends, plus a_4 x^2 (1 - x)^2."""
    rise = p1 - p0
    a2 = 3.0 * rise - 2.0 * d0 - d1
    a3 = d0 + d1 - 2.0 * rise
    return Cubic(p0, d0, a2 + a4, a3 - 2.0 * a4, a4)


@inlined
def overlap_between(left: Node, right: Node, width: float) -> Cubic:
    """Return the overlap in a cell, ``width`` rad wide, from that at its nodes; equation W2."""
    square = width * width
    a4 = (1 / 48) * square * square * (left.along + right.along)
    return cubic_between(left.overlap, left.rise, right.overlap, right.rise, a4)


@inlined
def value_at(p: Cubic, x: float) -> float:
    """Return the value of a polynomial."""
    return p.a0 + x * (p.a1 + x * (p.a2 + x * (p.a3 + x * p.a4)))


@inlined
def slope_at(p: Cubic, x: float) -> float:
    """Return the derivative of a polynomial."""
    return p.a1 + x * (2.0 * p.a2 + x * (3.0 * p.a3 + x * 4.0 * p.a4))


@inlined
def root_between(p: Cubic, low: float, high: float) -> float:
    """Return the root of a polynomial that is monotone between two places of different signs."""
    at_low, at_high = value_at(p, low), value_at(p, high)
    rises = at_high > 0.0
    # Start from the root of a parabola through both ends.
    first = (high - low) * slope_at(p, low)
    square = at_high - at_low - first
    size = math.sqrt(max(first * first - 4.0 * at_low * square, 0.0))
    divisor = first + size if rises else first - size
    x = low - 2.0 * at_low * (high - low) / divisor if divisor != 0.0 else low
    if not low <= x <= high:
        x = 0.5 * (low + high)
    for _ in range(MAX_ROOT_STEPS):
        value = value_at(p, x)
        slope = slope_at(p, x)
        if (value > 0.0) == rises:
            high = x
        else:
            low = x
        following = x - value / slope if slope != 0.0 else low
        tolerance = NEWTON_TOL
        if not low <= following <= high:
            following = 0.5 * (low + high)
            tolerance = ROOT_TOL
        if abs(following - x) < tolerance:
            return following
        x = following
    return x


@inlined
def turning_points(p: Cubic) -> tuple[float, float]:
    """Return where a cubic has its maximum and its minimum; 2 where there is none."""
    square = p.a2 * p.a2 - 3.0 * p.a1 * p.a3
    if square <= 0.0:
        return 2.0, 2.0
    root = math.sqrt(square)
    maximum = p.a1 / (root - p.a2) if root != p.a2 else 2.0
    minimum = -p.a1 / (root + p.a2) if root != -p.a2 else 2.0
    return maximum, minimum


class ArcIntegrals(NamedTuple):
    """Integrals over the arc where surfaces overlap, in the frame of the bearing's map."""

    x: float  # of p cos(theta), m rad
    y: float  # of p sin(theta), m rad
    pin_slope: float  # of p times the slope of the pin's map, m^2
    square: float  # of p^2, m^2 rad
    arcs: int  # of overlap; see ARC_START


@inlined
def with_part(
    left: Node, right: Node, length: float, width: float, a4: float, sums: ArcIntegrals
) -> ArcIntegrals:
    """Return the integrals with a part of a cell that overlaps throughout; equations W4 and W5.

    ``length`` is its part of the cell, of ``width`` rad, whose polynomial has the
    coefficient a_4.
    """
    p0, d0 = left.overlap, length * left.rise
    p1, d1 = right.overlap, length * right.rise
    q = a4 * length * length * length * length
    l0 = 156.0 * p0 + 22.0 * d0 + 54.0 * p1 - 13.0 * d1 + 7.0 * q
    l1 = 22.0 * p0 + 4.0 * d0 + 13.0 * p1 - 3.0 * d1 + 1.5 * q
    l2 = 54.0 * p0 + 13.0 * d0 + 156.0 * p1 - 22.0 * d1 + 7.0 * q
    l3 = -13.0 * p0 - 3.0 * d0 - 22.0 * p1 + 4.0 * d1 - 1.5 * q
    middle = 7.0 * (p0 + p1) + 1.5 * (d0 - d1) + (2 / 3) * q
    turn = length * width
    scale = (1 / 420) * turn
    x = l0 * left.nx + l2 * right.nx - turn * (l1 * left.ny + l3 * right.ny)
    y = l0 * left.ny + l2 * right.ny + turn * (l1 * left.nx + l3 * right.nx)
    slope = l0 * left.pin_slope + l2 * right.pin_slope
    slope += length * (l1 * left.pin_curvature + l3 * right.pin_curvature)
    square = l0 * p0 + l1 * d0 + l2 * p1 + l3 * d1 + q * middle
    return ArcIntegrals(
        sums.x + scale * x,
        sums.y + scale * y,
        sums.pin_slope + scale * slope,
        sums.square + scale * square,
        sums.arcs,
    )


@inlined
def node_within(left: Node, right: Node, p: Cubic, width: float, x: float) -> Node:
    """Return the overlap at a place of a cell, ``width`` rad wide, between its nodes."""
    angle = width * x
    y = angle * angle
    cosine = 1.0 - y * (1 / 2 - y * (1 / 24 - y * (1 / 720)))
    sine = angle * (1.0 - y * (1 / 6 - y * (1 / 120 - y * (1 / 5040))))
    pin = cubic_between(
        left.pin_slope, left.pin_curvature, right.pin_slope, right.pin_curvature, 0.0
    )
    return Node(
        left.nx * cosine - left.ny * sine,
        left.ny * cosine + left.nx * sine,
        left.along,
        value_at(p, x),
        slope_at(p, x),
        value_at(pin, x),
        slope_at(pin, x),
    )


@inlined
def is_monotone(left: Node, right: Node) -> bool:
    """Return whether the Bezier points of the overlap between two nodes only rise or only fall."""
    middle = 3.0 * (right.overlap - left.overlap) - left.rise - right.rise
    if left.rise > 0.0:
        return right.rise >= 0.0 and middle >= 0.0
    return right.rise <= 0.0 and middle <= 0.0


@compiled
def add_parts(
    surfaces: Array,
    place: Place,
    node: int,
    left: Node,
    right: Node,
    sums: ArcIntegrals,
) -> ArcIntegrals:
    """Return the integrals with those parts of a cell where the overlap is positive."""
    p = overlap_between(left, right, place.width)
    first = second = 2.0
    if not is_monotone(left, right):
        maximum, minimum = turning_points(p)
        first = min(maximum, minimum)
        second = max(maximum, minimum)
    start = 0.0
    arcs = sums.arcs
    for end in (first, second, 1.0):
        if not start < end <= 1.0:
            continue
        low, high = start, end
        start = end
        at_low, at_high = value_at(p, low), value_at(p, high)
        if at_low <= 0.0 and at_high <= 0.0:
            continue
        if at_low <= 0.0:
            low = root_between(p, low, high)
            surfaces[ARC_START, arcs] = node + low
        elif at_high <= 0.0:
            high = root_between(p, low, high)
            surfaces[ARC_END, arcs] = node + high
            arcs += 1
        before = node_within(left, right, p, place.width, low) if low > 0.0 else left
        after = node_within(left, right, p, place.width, high) if high < 1.0 else right
        sums = with_part(before, after, high - low, place.width, p.a4, sums)
    return ArcIntegrals(sums.x, sums.y, sums.pin_slope, sums.square, arcs)


@inlined
def cell_of_eccentricity(
    surfaces: Array, nodes: int, place: Place, angle: float
) -> float:
    """Return the direction of the eccentricity, in cells of the second turn.

    It is computed from an angle, rad, if that is near it.
    """
    node, _ = cell_of(angle, nodes)
    nx, ny = surfaces[COSINE, node], surfaces[SINE, node]
    along = place.dx * nx + place.dy * ny
    across = place.dy * nx - place.dx * ny
    if abs(across) < NEAR * along:
        t = across / along
        cell = node + t * (1.0 - t * t * (1 / 3 - t * t * (1 / 5))) / place.width
        if cell < 0.0:
            cell += nodes
        elif cell >= nodes:
            cell -= nodes
        return nodes + cell
    node, x = cell_of(math.atan2(place.dy, place.dx), nodes)
    return nodes + node + x


@inlined
def reach_of_overlap(joint: Records, place: Place, least: float) -> float:
    """Return how far from the eccentricity an overlap can exceed ``least``, in cells.

    Equation W3; at most half a turn.
    """
    along = joint.clearance + joint.least_depth + least
    if not along > -place.eccentricity:
        return 0.5 * joint.surface_nodes
    return math.acos(min(along / place.eccentricity, 1.0)) / place.width


@inlined
def inner_points(left: Node, right: Node) -> tuple[float, float]:
    """Return the inner two Bezier points of the cubic of a cell, which lies within all four."""
    return left.overlap + (1 / 3) * left.rise, right.overlap - (1 / 3) * right.rise


@inlined
def greatest_within(
    left: Node, right: Node, p: Cubic, node: int, greatest: float, peak: float
) -> tuple[float, float]:
    """Return the greatest overlap so far with that of a cell, and its place, in cells."""
    if left.overlap > greatest:
        greatest = left.overlap
        peak = float(node)
    if right.overlap > greatest:
        greatest = right.overlap
        peak = node + 1.0
    second, third = inner_points(left, right)
    if max(second, third) + abs(p.a4) > greatest and not is_monotone(left, right):
        x, _ = turning_points(p)
        x -= slope_at(p, x) / (2.0 * p.a2 + x * (6.0 * p.a3 + x * 12.0 * p.a4))
        if 0.0 < x < 1.0 and value_at(p, x) > greatest:
            greatest = value_at(p, x)
            peak = node + x
    return greatest, peak


@inlined
def with_cell(
    surfaces: Array,
    place: Place,
    node: int,
    left: Node,
    right: Node,
    a4: float,
    sums: ArcIntegrals,
) -> ArcIntegrals:
    """Return the integrals with those of the overlap in a cell."""
    second, third = inner_points(left, right)
    if min(min(left.overlap, right.overlap), min(second, third)) > 0.0:
        return with_part(left, right, 1.0, place.width, a4, sums)
    if max(max(left.overlap, right.overlap), max(second, third)) + abs(a4) > 0.0:
        return add_parts(surfaces, place, node, left, right, sums)
    return sums


@compiled
def integrate_overlap(
    surfaces: Array, joint: Records, place: Place, angle: float
) -> tuple[float, float, ArcIntegrals]:
    """Return the greatest overlap of a pin and its bearing, its place, and the integrals.

    Cells in which the pin can neither overlap nor come nearer than elsewhere are
    skipped.

    Parameters
    ----------
    surfaces : ndarray, shape (ROWS, m)
    joint : record of JOINT
    place : Place
    angle : float
        Angle of the bearing's map, rad, near which the overlap was greatest before.
    """
    nodes = joint.surface_nodes
    half_turn = joint.surface_nodes // 2
    reached = nodes + cell_of(angle, nodes)[0]
    right = node_at(surfaces, place, reached)
    greatest = right.overlap
    peak = float(reached)
    sums = ArcIntegrals(0.0, 0.0, 0.0, 0.0, 0)
    # Between two nodes the pin reaches farther than at both by less than this.
    bulge = 0.125 * place.width * place.width * place.eccentricity
    direction = cell_of_eccentricity(surfaces, nodes, place, angle)
    reach = reach_of_overlap(joint, place, min(greatest, 0.0) - bulge)
    centre = int(direction)
    first = max(int(direction - reach), centre - half_turn)
    last = min(int(direction + reach), centre + half_turn)
    following = place.dx * surfaces[COSINE, first] + place.dy * surfaces[SINE, first]
    for node in range(first, last + 1):
        along = following
        following = (
            place.dx * surfaces[COSINE, node + 1] + place.dy * surfaces[SINE, node + 1]
        )
        least = (
            surfaces[BEARING + LEAST, node] + surfaces[PIN + LEAST, node + place.lag]
        )
        most = max(along, following) + bulge - place.clearance - least
        if most <= min(greatest, 0.0):
            continue
        left = right if node == reached else node_at(surfaces, place, node)
        right = node_at(surfaces, place, node + 1)
        reached = node + 1
        p = overlap_between(left, right, place.width)
        greatest, peak = greatest_within(left, right, p, node, greatest, peak)
        sums = with_cell(surfaces, place, node, left, right, p.a4, sums)
    surfaces[ARC_PLACE, 0] = place.dx
    surfaces[ARC_PLACE, 1] = place.dy
    surfaces[ARC_PLACE, 2] = place.lag + place.offset
    surfaces[ARC_PLACE, 3] = sums.arcs
    # Mean of cosine and sine over a cell, over that of their cubics
    scale = 1.0 + (1 / 720) * place.width**4
    sums = ArcIntegrals(
        scale * sums.x, scale * sums.y, sums.pin_slope, sums.square, sums.arcs
    )
    return greatest, peak, sums


@inlined
def node_of_peak(surfaces: Array, place: Place, cell: float) -> tuple[Node, float]:
    """Return the overlap at its maximum, a place in cells, and the depth of the pin there."""
    node = int(cell)
    x = cell - node
    left = node_at(surfaces, place, node)
    right = node_at(surfaces, place, node + 1)
    p = overlap_between(left, right, place.width)
    peak = node_within(left, right, p, place.width, x)
    gap = place.dx * peak.nx + place.dy * peak.ny - place.clearance
    return peak, gap - peak.overlap - depth_at(surfaces, BEARING, node, x)[0]


@inlined
def derivatives_at(
    surfaces: Array, place: Place, node: int, x: float
) -> tuple[float, float, float, float, float, float]:
    """Return derivatives of the overlap at a place of a cell, for ``deepest_acceleration``.

    Cosine and sine of its angle, the second derivative of the overlap, m, the slope of
    the pin's map, m, and the derivatives of the slope by x and by the relative angle,
    in cells.
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


@inlined
def count_arcs(surfaces: Array, joint: Records, place: Place, angle: float) -> int:
    """Return the number of arcs of overlap, whose ends are in the surfaces.

    The integrals are computed, as by ``integrate_overlap``, if those before had another
    place.
    """
    last = surfaces[ARC_PLACE]
    is_same = (
        last[0] == place.dx
        and last[1] == place.dy
        and last[2] == place.lag + place.offset
    )
    if not is_same:
        integrate_overlap(surfaces, joint, place, angle)
    return int(last[3])


@inlined
def area_at(p: Cubic, x: float) -> float:
    """Return the integral of a polynomial from 0."""
    rest = (1 / 3) * p.a2 + x * ((1 / 4) * p.a3 + x * (1 / 5) * p.a4)
    return x * (p.a0 + x * ((1 / 2) * p.a1 + x * rest))


@inlined
def share_cell(
    p: Cubic,
    node: int,
    low: float,
    high: float,
    shift: float,
    ratio: float,
    shares: Array,
) -> None:
    """Add the integral of the overlap in a cell, between two places, to the bins of a map, (n,).

    A cell is ``ratio`` bins wide; the bins begin ``shift`` cells before the nodes.
    """
    count = shares.shape[0]
    k = int(np.floor((node + low + shift) * ratio))
    x = low
    before = area_at(p, low)
    while x < high:
        x = min(max((k + 1) / ratio - shift - node, x), high)
        area = area_at(p, x)
        # At an end of the arc the overlap is nothing but round-off.
        shares[k % count] += max(area - before, 0.0)
        before = area
        k += 1


@compiled
def share_arc(
    surfaces: Array, joint: Records, place: Place, arc: int, shares: Array
) -> None:
    """Add the integrals of the overlap over an arc to the bins of bearing and pin, shape (2, n)."""
    start, end = surfaces[ARC_START, arc], surfaces[ARC_END, arc]
    ratio = shares.shape[1] / joint.surface_nodes
    pin_shift = 0.5 + place.lag + place.offset
    left = node_at(surfaces, place, int(start))
    for node in range(int(start), int(np.ceil(end))):
        right = node_at(surfaces, place, node + 1)
        p = overlap_between(left, right, place.width)
        low = max(start - node, 0.0)
        high = min(end - node, 1.0)
        share_cell(p, node, low, high, 0.5, ratio, shares[0])
        share_cell(p, node, low, high, pin_shift, ratio, shares[1])
        left = right


@inlined
def round_area(eccentricity: float, clearance: float, x: float) -> float:
    """Return the integral of the overlap of a round pin from the direction of e to x, m rad."""
    y = x * x
    if y < 0.25:  # the difference of sine and x would cancel
        series = 1 / 5040 - y * (1 / 362880 - y * (1 / 39916800))
        short = -x * y * (1 / 6 - y * (1 / 120 - y * series))
    else:
        short = math.sin(x) - x
    return (eccentricity - clearance) * x + eccentricity * short


@compiled
def deposit_round(
    eccentricity: float,
    clearance: float,
    direction: float,
    half: float,
    depth_sum: float,
    depth: Array,
) -> None:
    """Add depths in proportion to the overlap of round surfaces to the bins of a map, shape (n,).

    The arc reaches ``half`` rad to both sides of the direction of e in the map.
    ``depth_sum`` is the sum of the depths, m.
    """
    count = depth.shape[0]
    overlap = round_area(eccentricity, clearance, half)
    if not overlap > 0.0:
        depth[bin_of(direction, count)] += depth_sum
        return
    # The area is odd in x, so that the whole arc has twice that up to its end.
    scale = 0.5 * depth_sum / overlap
    width = 2.0 * math.pi / count
    k = int(np.floor((direction - half) / width))
    place = k % count
    x = -half
    before = -overlap
    while x < half:
        k += 1
        x = min(max(k * width - direction, x), half)
        area = round_area(eccentricity, clearance, x)
        # At the end of the arc the overlap is nothing but round-off.
        depth[place] += scale * max(area - before, 0.0)
        before = area
        place = place + 1 if place + 1 < count else 0
