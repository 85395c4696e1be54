"""Worn surfaces: wear depth as a smooth periodic function of angle.

A map holds the mean depth of ``m`` equal angular bins, bin ``k`` covering
``[k, k + 1) 2 pi / m``; between the bin centres the depth is the monotone
piecewise cubic of Fritsch and Carlson (SIAM J. Numer. Anal. 17, 1980): value
and slope are continuous, seam included, and it never leaves the range of its
neighbours, so that a worn surface cannot rise above the new one.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from presswear.compiled import compiled

Array = NDArray[np.float64]


BEARING, PIN = 0, 5
"""First of the rows that the kernels keep of a surface: see ``packed_rows``."""
SLOPE, SQUARE, CUBE, LEAST = 1, 2, 3, 4
"""Rows behind the depth."""
ROWS = 10
"""Of a bearing and its pin."""


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


def monotone_slopes(depth: Array) -> Array:
    """Slopes at the bin centres, m/rad, that keep the interpolant monotone.

    Harmonic mean of the two neighbouring secants, zero at an extremum (Fritsch
    and Butland's form for equal spacing).
    """
    width = 2.0 * math.pi / depth.size
    ahead = (np.roll(depth, -1) - depth) / width
    behind = np.roll(ahead, 1)
    same_sign = ahead * behind > 0.0
    total = np.where(same_sign, ahead + behind, 1.0)
    # The quotient first: the product of two tiny secants would underflow.
    slopes = np.zeros(depth.size)
    slopes[same_sign] = (2.0 * ahead * (behind / total))[same_sign]
    return slopes


def packed_rows(surface: "Surface", count: int) -> Array:
    """A surface as the kernels see it, shape (5, m).

    Depth and slope at the bin centres; coefficients of x^2 and x^3 of the cubic behind
    each centre, m/rad^2 and m/rad^3; its least depth.
    """
    rows = np.zeros((5, count))
    if surface.is_worn:
        depth, slope = surface.depth, surface.slope
        width = 2.0 * math.pi / count
        following, following_slope = np.roll(depth, -1), np.roll(slope, -1)
        secant = (following - depth) / width
        rows[0], rows[SLOPE] = depth, slope
        rows[SQUARE] = (3.0 * secant - 2.0 * slope - following_slope) / width
        rows[CUBE] = (slope + following_slope - 2.0 * secant) / width**2
        # Monotone between the centres.
        rows[LEAST] = np.minimum(depth, following)
    return rows


def bin_centres(count: int) -> Array:
    """Angles of the bin centres, rad, shape (count,)."""
    return (np.arange(count, dtype=np.float64) + 0.5) * (2.0 * math.pi / count)


@dataclass(frozen=True, eq=False)
class Surface:
    """One worn surface, bearing or pin.

    Attributes
    ----------
    depth : ndarray, shape (m,)
        Wear depth at the bin centres, m; empty for an unworn surface.
    slope : ndarray, shape (m,)
        Its derivative, m/rad, derived from the depth.
    """

    depth: Array = field(default_factory=lambda: np.zeros(0))
    slope: Array = field(init=False)

    def __post_init__(self) -> None:
        depth = np.array(self.depth, dtype=float)
        if depth.ndim != 1 or not np.all(np.isfinite(depth)):
            raise ValueError("a wear depth is a one-dimensional array of finite numbers, m")
        slope = monotone_slopes(depth) if depth.size else np.zeros(0)
        depth.flags.writeable = slope.flags.writeable = False
        object.__setattr__(self, "depth", depth)
        object.__setattr__(self, "slope", slope)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Surface) and np.array_equal(self.depth, other.depth)

    def __hash__(self) -> int:
        return hash(self.depth.tobytes())

    @property
    def is_worn(self) -> bool:
        """Whether any part of the surface has lost material."""
        return bool(np.any(self.depth != 0.0))

    def __call__(self, angle: Array) -> Array:
        """Depth, m, at any angles, rad (same shape)."""
        angles = np.asarray(angle, dtype=float)
        values = [profile(self.depth, self.slope, float(a))[0] for a in angles.ravel()]
        return np.reshape(values, angles.shape)

    def worn_by(self, added: Array) -> "Surface":
        """The surface after a further loss of depth, m, shape (m,)."""
        if self.depth.size and self.depth.shape != added.shape:
            raise ValueError(f"wear on {added.shape} bins cannot be added to {self.depth.shape}")
        return Surface(self.depth + added if self.depth.size else np.array(added))
