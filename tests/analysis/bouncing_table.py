"""Ball with restitution e on a table that moves as A sin(omega t).

Luo and Han, Nonlinear Dynamics 10 (1996) 1: a ball that lands once per period leaves the table
with w = pi g / omega, where the table moves with (1 - e) / (1 + e) w. The determinant of the map
from landing to landing is e^2 and its trace 1 + e^2 + (1 + e)^2 a / g with the acceleration a of
the table, so that the period doubles at a = -2 (1 + e^2) / (1 + e)^2 g. (Holmes, J. Sound Vib. 84
(1982) 173, gives the same for a table of small amplitude.)
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
GRAVITY = 9.81
FREQUENCY = 20.0  # omega, rad/s
PERIOD = 2.0 * math.pi / FREQUENCY


@dataclass(frozen=True)
class BouncingTable:
    """The ball and the table; ``drive`` is the largest acceleration of the table over gravity."""

    restitution: float
    drive: float = 1.0

    @property
    def existence(self) -> float:
        """Drive from which one landing per period is possible."""
        return math.pi * (1.0 - self.restitution) / (1.0 + self.restitution)

    @property
    def doubling(self) -> float:
        """Drive at which the period doubles."""
        e = self.restitution
        return math.hypot(2.0 * (1.0 + e * e) / (1.0 + e) ** 2, self.existence)

    def table(self, t: float) -> tuple[float, float]:
        """Return the height, m, and the velocity, m/s, of the table."""
        amplitude = self.drive * GRAVITY / FREQUENCY**2
        angle = FREQUENCY * t
        return amplitude * math.sin(angle), amplitude * FREQUENCY * math.cos(angle)

    def period_one(self, elapsed: float) -> tuple[Array, float]:
        """Return the state of the periodic ball some time after a landing, and the time."""
        angle = math.acos(self.existence / self.drive)
        velocity = math.pi * GRAVITY / FREQUENCY
        height = self.table(angle / FREQUENCY)[0] + velocity * elapsed - 0.5 * GRAVITY * elapsed**2
        return np.array([height, velocity - GRAVITY * elapsed]), angle / FREQUENCY + elapsed

    def after(self, state: Array, t: float, duration: float) -> Array:
        """Return height and velocity after a duration; landings are located to round-off."""
        x, v = map(float, state)
        while True:
            flight = self._flight(x, v, t, duration)
            x, v = x + v * flight - 0.5 * GRAVITY * flight**2, v - GRAVITY * flight
            t, duration = t + flight, duration - flight
            if duration <= 0.0:
                return np.array([x, v])
            x, speed = self.table(t)
            v = speed + self.restitution * (speed - v)

    def _flight(self, x: float, v: float, t: float, limit: float) -> float:
        """Return the time to the next landing, at most ``limit``."""

        def gap(s: float) -> float:
            return x + v * s - 0.5 * GRAVITY * s * s - self.table(t + s)[0]

        low = 1e-7 * PERIOD
        while low < limit:
            high = min(low + PERIOD / 200.0, limit)
            if gap(high) < 0.0:
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if gap(middle) < 0.0 else (middle, high)
                return low
            low = high
        return limit
