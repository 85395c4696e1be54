"""An oscillator x'' + 2 z x' + x = b cos(w t) beside a wall at s, which it leaves with -r x'.

Shaw and Holmes, J. Sound Vib. 90 (1983) 129: what lands once in so many periods of the force is
known in closed form, and so is how its neighbours move, M = S F: F is the free motion's, S that of
the landing, the saltation matrix (Mueller, Chaos, Solitons and Fractals 5 (1995) 1671).  The
determinant of M is r^2 exp(-2 z T).
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ImpactOscillator:
    """The oscillator, its force and its wall; without units."""

    restitution: float
    frequency: float
    damping: float = 0.0
    wall: float = 0.0
    force: float = 1.0

    @property
    def period(self) -> float:
        """Of the force."""
        return 2.0 * math.pi / self.frequency

    def free(self, s: float) -> Array:
        """The motion of small differences without a landing over a time, shape (2, 2)."""
        z = self.damping
        own = math.sqrt(1.0 - z * z)
        c, d = math.cos(own * s), math.sin(own * s) / own
        return math.exp(-z * s) * np.array([[c + z * d, d], [-d, c - z * d]])

    def forced(self, t: float) -> tuple[float, float]:
        """Place and velocity of the motion that has the period of the force."""
        w, z = self.frequency, self.damping
        wave = self.force / complex(1.0 - w * w, 2.0 * z * w) * cmath.exp(1j * w * t)
        return wave.real, (1j * w * wave).real

    def _acceleration(self, x: float, v: float, t: float) -> float:
        return self.force * math.cos(self.frequency * t) - 2.0 * self.damping * v - x

    def saltation(self, v: float, t: float) -> Array:
        """How small differences are turned by a landing at a velocity v > 0."""
        r = self.restitution
        before, after = (self._acceleration(self.wall, own, t) for own in (v, -r * v))
        return np.array([[-r, 0.0], [(after + r * before) / v, -r]])

    def periodic(self, periods: int) -> tuple[float, float, Array]:
        """Time and velocity of the one landing in so many periods, and the motion of neighbours.

        Of the two there are that with the greater velocity.
        """
        w, r, sigma = self.frequency, self.restitution, self.wall
        span = periods * self.period
        c = np.linalg.solve(self.free(span) - np.eye(2), [0.0, 1.0 + r])
        size = self.force / abs(complex(1.0 - w * w, 2.0 * self.damping * w))
        # (sigma - c0 V)^2 + ((r + c1) V / w)^2 = size^2
        quadratic = [c[0] ** 2 + ((r + c[1]) / w) ** 2, -2.0 * sigma * c[0], sigma**2 - size**2]
        v = float(np.roots(quadratic).real.max())
        place, rate = sigma - c[0] * v, -(r + c[1]) * v
        # The forced motion is there where its place and rate are these.
        first = complex(*self.forced(0.0))
        turned = cmath.phase(complex(place, -rate / w)) - cmath.phase(
            complex(first.real, -first.imag / w)
        )
        t = turned / w % self.period
        return t, v, self.saltation(v, t) @ self.free(span)

    def after(self, state: Array, t: float, duration: float) -> tuple[Array, Array]:
        """Place and velocity some time later, and how small differences have moved."""
        moved, left = np.eye(2), duration
        x, v = map(float, state)
        while True:
            landing = self._landing(x, v, t, left)
            step = left if landing is None else landing
            free = self.free(step)
            now, then = np.array(self.forced(t)), np.array(self.forced(t + step))
            x, v = map(float, then + free @ (np.array([x, v]) - now))
            moved, t, left = free @ moved, t + step, left - step
            if landing is None:
                return np.array([x, v]), moved
            moved = self.saltation(v, t) @ moved
            x, v = self.wall, -self.restitution * v

    def _landing(self, x: float, v: float, t: float, left: float) -> float | None:
        """Time to the next landing; None where there is none before ``left``."""
        place, rate = self.forced(t)
        x, v = x - place, v - rate
        z = self.damping
        own = math.sqrt(1.0 - z * z)

        def gap(s: float) -> float:
            free = x * math.cos(own * s) + (v + z * x) / own * math.sin(own * s)
            return self.wall - self.forced(t + s)[0] - math.exp(-z * s) * free

        # It leaves the wall with a gap that is round-off.
        low, step = 1e-9 * self.period, self.period / 100.0
        while low < left:
            high = min(low + step, left)
            if gap(high) < 0.0:
                return float(brentq(gap, low, high, xtol=1e-15)) if gap(low) > 0.0 else low
            low = high
        return None
