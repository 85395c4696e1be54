"""Worn surfaces: wear depth as a smooth periodic function of angle.

A map holds the mean depth of ``m`` equal angular bins. Bin ``k`` is the range ``[k, k + 1)
2 pi / m``. Between the bin centres the depth is the monotone piecewise cubic of Fritsch
and Carlson (SIAM J. Numer. Anal. 17, 1980). Value and slope are continuous, also at the
angle 0. The cubic stays between the values at both ends, so that a worn surface cannot
be above the new one.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, shown

SIDES = ("bearing", "pin")


def monotone_slopes(depth: Array) -> Array:
    """Return slopes at the bin centres, m/rad, that keep the interpolant monotone.

    A slope is the harmonic mean of the two neighbouring secants, and zero at an extremum
    (form of Fritsch and Butland for equal spacing).
    """
    width = 2.0 * math.pi / depth.size
    to_next = (np.roll(depth, -1) - depth) / width
    from_last = np.roll(to_next, 1)
    same_sign = to_next * from_last > 0.0
    total = np.where(same_sign, to_next + from_last, 1.0)
    # The quotient is computed first, because the product of two small secants could
    # underflow.
    slopes = np.zeros(depth.size)
    slopes[same_sign] = (2.0 * to_next * (from_last / total))[same_sign]
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
        depth.flags.writeable = False
        slope.flags.writeable = False
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
        """Return the depth at angles, rad, in an array of the same shape, m."""
        angles = np.asarray(angle, dtype=float)
        count = self.depth.size
        if count == 0:
            return np.zeros(angles.shape)
        width = 2.0 * math.pi / count
        position = angles / width - 0.5
        cell = np.floor(position)
        s = position - cell
        k = cell.astype(int) % count
        j = (k + 1) % count
        rise = self.depth[j] - self.depth[k]
        a = self.slope[k] * width
        b = self.slope[j] * width
        quadratic = 3.0 * rise - 2.0 * a - b
        cubic = a + b - 2.0 * rise
        return np.asarray(self.depth[k] + s * (a + s * (quadratic + s * cubic)))
