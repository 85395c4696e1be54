"""Worn surfaces as the kernels see them; see ``presswear.linkage.surface``."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.surface import Surface
from presswear.tools.compile import compiled, fused_inlined

Array = NDArray[np.float64]

BEARING, PIN = 0, 4
"""First of the rows that the kernels keep of a surface: see ``packed_rows``."""
SLOPE, SQUARE, CUBE = 1, 2, 3
"""Rows behind the depth."""
ROWS = 8
"""Number of rows that the kernels keep of a bearing and its pin."""
SURFACES = np.zeros((ROWS, 1))
"""An array of the type that the kernels keep: side by side in memory."""


@compiled
def piece(
    depth: Array, slope: Array, angle: float
) -> tuple[float, float, float, float, float, float]:
    """The cubic that holds an angle: its place s in 0 .. 1, the bin width, rad, and the
    coefficients c0 .. c3 of c0 + s (c1 + s (c2 + s c3)), m.
    """
    count = depth.shape[0]
    width = 2.0 * math.pi / count
    position = angle / width - 0.5
    left = math.floor(position)
    k = left % count
    j = k + 1 if k + 1 < count else 0
    rise = depth[j] - depth[k]
    a = slope[k] * width
    b = slope[j] * width
    return position - left, width, depth[k], a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise


@compiled
def profile(depth: Array, slope: Array, angle: float) -> tuple[float, float]:
    """Depth h, m, and dh/dangle, m/rad, of a map at any angle, rad.

    Parameters
    ----------
    depth, slope : ndarray, shape (m,)
        Values and derivatives at the bin centres; empty for an unworn surface.
    """
    if depth.shape[0] == 0:
        return 0.0, 0.0
    s, width, c0, c1, c2, c3 = piece(depth, slope, angle)
    return c0 + s * (c1 + s * (c2 + s * c3)), (c1 + s * (2.0 * c2 + s * 3.0 * c3)) / width


@compiled
def curvature(depth: Array, slope: Array, angle: float) -> float:
    """Second derivative of a map's depth, m/rad^2; it jumps at the bin centres."""
    if depth.shape[0] == 0:
        return 0.0
    s, width, _, _, c2, c3 = piece(depth, slope, angle)
    return (2.0 * c2 + 6.0 * s * c3) / (width * width)


@compiled
def bin_of(angle: float, count: int) -> int:
    """Index of the bin that holds an angle, rad."""
    return math.floor(angle * count / (2.0 * math.pi)) % count


@fused_inlined
def depth_at(surfaces: Array, row: int, k: int, x: float) -> tuple[float, float]:
    """Return depth, m, and slope, m/rad, of a map in piece ``k``, ``x`` rad behind its node."""
    c1 = surfaces[row + SLOPE, k]
    c2 = surfaces[row + SQUARE, k]
    c3 = surfaces[row + CUBE, k]
    return surfaces[row, k] + x * (c1 + x * (c2 + x * c3)), c1 + x * (2.0 * c2 + x * 3.0 * c3)


@fused_inlined
def cell_of(angle: float, count: int, shift: float) -> tuple[int, float]:
    """Return the cell that holds an angle, of ``count`` around the turn, and the distance from
    its start, rad.  The first cell starts at ``shift`` of a cell.
    """
    turn = angle * (0.5 / math.pi)
    position = (turn - np.floor(turn)) * count - shift
    before = np.floor(position)
    width = 2.0 * math.pi / count
    cell = int(before)
    if cell < 0:
        cell += count
    # The angle of a trial state may be so large that round-off leaves no position in a cell.
    if not 0 <= cell < count:
        return 0, 0.0
    return cell, min(max((position - before) * width, 0.0), width)


def packed_rows(surface: Surface, count: int) -> Array:
    """Return a surface as the kernels see it, shape (4, count).

    Depth and slope at the bin centres; coefficients of x^2 and x^3 of the cubic behind
    each centre, m/rad^2 and m/rad^3.
    """
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
