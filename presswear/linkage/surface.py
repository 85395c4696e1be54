"""Worn surfaces: wear depth as a smooth periodic function of angle.

A map holds the mean depth of ``m`` equal angular bins, bin ``k`` covering ``[k, k + 1)
2 pi / m``. Between the bin centres the depth is the monotone piecewise cubic of Fritsch
and Carlson (SIAM J. Numer. Anal. 17, 1980): value and slope are continuous, seam
included, and it never leaves the range of its neighbours, so that a worn surface cannot
rise above the new one.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, shown

SIDES = ("bearing", "pin")


def monotone_slopes(depth: Array) -> Array:
    """Return slopes at the bin centres, m/rad, that keep the interpolant monotone.

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


def bin_centres(count: int) -> Array:
    """Return the angles of the bin centres, rad, shape (count,)."""
    return (np.arange(count, dtype=np.float64) + 0.5) * (2.0 * math.pi / count)


@dataclass(frozen=True, eq=False)
class Surface:
    """Worn surface: depth, m, and slope, m/rad, at the bin centres, (m,); empty where unworn."""

    depth: Array = field(default_factory=lambda: np.zeros(0))
    slope: Array = field(init=False)

    def __post_init__(self) -> None:
        try:
            depth = np.array(self.depth, dtype=float)
        except (TypeError, ValueError, OverflowError):
            depth = np.full((1, 1), np.nan)
        if depth.ndim != 1 or not np.all(np.isfinite(depth)):
            raise InputError(
                f"depth = {shown(self.depth)}: a one-dimensional array of numbers is expected, m"
            )
        slope = monotone_slopes(depth) if depth.size else np.zeros(0)
        depth.flags.writeable = slope.flags.writeable = False
        object.__setattr__(self, "depth", depth)
        object.__setattr__(self, "slope", slope)

    def __eq__(self, surface: object) -> bool:
        return isinstance(surface, Surface) and np.array_equal(
            self.depth, surface.depth
        )

    def __hash__(self) -> int:
        return hash(self.depth.tobytes())

    @property
    def is_worn(self) -> bool:
        """True if the surface is worn."""
        return bool(np.any(self.depth != 0.0))

    def __call__(self, angle: Array) -> Array:
        """Return the depth, m, at any angles, rad (same shape)."""
        angles = np.asarray(angle, dtype=float)
        count = self.depth.size
        if count == 0:
            return np.zeros(angles.shape)
        width = 2.0 * math.pi / count
        position = angles / width - 0.5
        left = np.floor(position)
        s, k = position - left, left.astype(int) % count
        j = (k + 1) % count
        rise = self.depth[j] - self.depth[k]
        a, b = self.slope[k] * width, self.slope[j] * width
        return np.asarray(
            self.depth[k]
            + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
        )
