"""A ball on a table that moves as A sin(omega t), with restitution e: its flow, and its period one.

Luo and Han, Nonlinear Dynamics 10 (1996) 1: the ball that lands once in each period of the table
leaves it with w = pi g / omega, where the table moves with (1 - e) / (1 + e) w.  The determinant of
its map from landing to landing is e^2 and the trace 1 + e^2 + (1 + e)^2 a / g, with a the table's
acceleration: it doubles its period where a = -2 (1 + e^2) / (1 + e)^2 g.  (Holmes, J. Sound
Vib. 84 (1982) 173, has the same for a table that is low beside the ball's flights.)
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BouncingTable:
    """The ball and its table.

    Attributes
    ----------
    restitution : float
    drive : float
        Greatest acceleration of the table, A omega^2 / g.
    frequency : float
        omega, rad/s.
    """

    restitution: float
    drive: float = 1.0
    frequency: float = 20.0
    gravity: float = 9.81

    @property
    def period(self) -> float:
        """Of the table, s."""
        return 2.0 * math.pi / self.frequency

    @property
    def amplitude(self) -> float:
        """Of the table, m."""
        return self.drive * self.gravity / self.frequency**2

    @property
    def existence(self) -> float:
        """Drive from which one landing a period is possible."""
        return math.pi * (1.0 - self.restitution) / (1.0 + self.restitution)

    @property
    def doubling(self) -> float:
        """Drive at which the period doubles."""
        e = self.restitution
        return math.hypot(2.0 * (1.0 + e * e) / (1.0 + e) ** 2, self.existence)

    def driven(self, drive: float) -> "BouncingTable":
        """The same at another drive."""
        return replace(self, drive=drive)

    def table(self, t: float) -> tuple[float, float]:
        """Height, m, and velocity, m/s, of the table."""
        angle = self.frequency * t
        speed = self.amplitude * self.frequency
        return self.amplitude * math.sin(angle), speed * math.cos(angle)

    def period_one(self, since: float) -> tuple[Array, float]:
        """Height and velocity some time behind a landing of the periodic ball, and the time."""
        angle = math.acos(self.existence / self.drive)
        leaves = math.pi * self.gravity / self.frequency
        height = self.table(angle / self.frequency)[0]
        height += leaves * since - 0.5 * self.gravity * since**2
        velocity = leaves - self.gravity * since
        return np.array([height, velocity]), angle / self.frequency + since

    def after(self, state: Array, t: float, duration: float) -> Array:
        """Height and velocity some time later, every landing found to round-off."""
        x, v = map(float, state)
        left = duration
        while True:
            landing = self._landing(x, v, t, left)
            x, v = x + v * landing - 0.5 * self.gravity * landing**2, v - self.gravity * landing
            t, left = t + landing, left - landing
            if left <= 0.0:
                return np.array([x, v])
            height, speed = self.table(t)
            x, v = height, speed + self.restitution * (speed - v)

    def _landing(self, x: float, v: float, t: float, left: float) -> float:
        """Time to the next landing, or ``left`` where that is sooner."""

        def gap(s: float) -> float:
            return x + v * s - 0.5 * self.gravity * s * s - self.table(t + s)[0]

        step = self.period / 200.0
        low = 1e-7 * self.period
        while low < left:
            high = min(low + step, left)
            if gap(high) < 0.0:
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if gap(middle) < 0.0 else (middle, high)
                return low
            low = high
        return left
