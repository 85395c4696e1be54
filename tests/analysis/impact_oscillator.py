"""Oscillator x'' + 2 z x' + x = cos(w t) with a wall at x = 0 and restitution r.

Shaw and Holmes, J. Sound Vib. 90 (1983) 129: a motion with one landing per period of the force is
known in closed form, and so is the map of small differences M = S F with the free motion F and the
saltation matrix S of the landing (Mueller, Chaos, Solitons and Fractals 5 (1995) 1671). The
determinant of M is r^2 exp(-2 z T).
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from presswear.tools.arrays import Array


@dataclass(frozen=True)
class ImpactOscillator:
    """The oscillator, dimensionless."""

    restitution: float
    frequency: float
    damping: float = 0.0

    @property
    def period(self) -> float:
        """Period of the force."""
        return 2.0 * math.pi / self.frequency

    def free(self, s: float) -> Array:
        """Return the map of small differences over a time without landing, shape (2, 2)."""
        z = self.damping
        w = math.sqrt(1.0 - z * z)
        c, d = math.cos(w * s), math.sin(w * s) / w
        return math.exp(-z * s) * np.array([[c + z * d, d], [-d, c - z * d]])

    def forced(self, t: float) -> tuple[float, float]:
        """Return position and velocity of the motion with the period of the force."""
        w, z = self.frequency, self.damping
        wave = 1.0 / complex(1.0 - w * w, 2.0 * z * w) * cmath.exp(1j * w * t)
        return wave.real, (1j * w * wave).real

    def saltation(self, v: float, t: float) -> Array:
        """Return the map of small differences by a landing at a velocity v > 0."""
        r, force = self.restitution, math.cos(self.frequency * t)
        before, after = (force - 2.0 * self.damping * u for u in (v, -r * v))
        return np.array([[-r, 0.0], [(after + r * before) / v, -r]])

    def periodic(self) -> tuple[float, float, Array]:
        """Return time and velocity of the landing in each period, and the map of differences.

        Of the two solutions it is the one with the larger velocity.
        """
        w, r = self.frequency, self.restitution
        c = np.linalg.solve(self.free(self.period) - np.eye(2), [0.0, 1.0 + r])
        size = 1.0 / abs(complex(1.0 - w * w, 2.0 * self.damping * w))
        # (c0 v)^2 + ((r + c1) v / w)^2 = size^2
        v = size / math.hypot(c[0], (r + c[1]) / w)
        position, rate = -c[0] * v, -(r + c[1]) * v
        x, u = self.forced(0.0)
        turned = cmath.phase(complex(position, -rate / w)) - cmath.phase(complex(x, -u / w))
        t = turned / w % self.period
        return t, v, self.saltation(v, t) @ self.free(self.period)

    def after(self, state: Array, t: float, duration: float) -> tuple[Array, Array]:
        """Return position and velocity after a duration, and the map of small differences."""
        differences, remaining = np.eye(2), duration
        x, v = map(float, state)
        while True:
            landing = self._landing(x, v, t, remaining)
            step = remaining if landing is None else landing
            free = self.free(step)
            now, then = np.array(self.forced(t)), np.array(self.forced(t + step))
            x, v = map(float, then + free @ (np.array([x, v]) - now))
            differences, t, remaining = free @ differences, t + step, remaining - step
            if landing is None:
                return np.array([x, v]), differences
            differences = self.saltation(v, t) @ differences
            x, v = 0.0, -self.restitution * v

    def _landing(self, x: float, v: float, t: float, limit: float) -> float | None:
        """Return the time to the next landing, or None if there is none before ``limit``."""
        x0, v0 = self.forced(t)
        x, v, z = x - x0, v - v0, self.damping
        w = math.sqrt(1.0 - z * z)

        def gap(s: float) -> float:
            free = x * math.cos(w * s) + (v + z * x) / w * math.sin(w * s)
            return -self.forced(t + s)[0] - math.exp(-z * s) * free

        low, step = 1e-9 * self.period, self.period / 100.0  # the first gap is round-off
        while low < limit:
            high = min(low + step, limit)
            if gap(high) < 0.0:
                return float(brentq(gap, low, high, xtol=1e-15)) if gap(low) > 0.0 else low
            low = high
        return None
