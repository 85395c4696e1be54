"""Bottom dead centre: where the watched coordinate of an ideal motion is lowest.

A linkage whose tool works at the highest place watches the opposite direction; a scene whose
process lies there sees to that.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from presswear.physics.ideal import IdealMotion, Motion

Array = NDArray[np.float64]

DWELL = 0.02
"""Part of a cycle for which an ideal motion stays at its bottom that has no instant there."""
_STEPS = 60
"""Most steps of Newton's method, or halvings, between two nodes."""


@dataclass(frozen=True)
class Bottom:
    """Bottom dead centre of an ideal motion, and the stroke to it.

    Attributes
    ----------
    time : float
        Since the beginning of the cycle in which the stroke ends, s; below zero where it lies in
        the cycle before.
    height : float
        Of the watched coordinate there, m, in the axes of the frame.
    stroke : float
        Between its lowest and highest place, m.
    top : float
        Time of the highest place before it, at which the stroke begins, s, as ``time`` is counted.
    window : tuple of float
        Times at which the lower half of the stroke begins and ends, s, as ``time`` is counted:
        no bottom dead centre falls between two windows, whatever a clearance does to it.
    period : float
        Of a cycle, s.
    """

    time: float
    height: float
    stroke: float
    top: float
    window: tuple[float, float]
    period: float

    @property
    def first(self) -> int:
        """Cycle in which the first whole stroke ends."""
        return 1 if self.time < 0.0 else 0

    def delay(self, time: Array) -> Array:
        """How much later than the ideal bottom dead centre next to it an instant is, s.

        Parameters
        ----------
        time : ndarray, shape (n,)
            Since the start, s.
        """
        # A run-up takes whole cycles.
        late = time - self.time
        return np.asarray(late - self.period * np.round(late / self.period))


@lru_cache(maxsize=64)
def bottom_of(ideal: IdealMotion) -> Bottom | None:
    """The bottom dead centre of an ideal motion; None where the watched coordinate stands.

    Of several bottoms in a cycle the lowest, and of those that are alike the first.
    """
    place, period = _places(ideal), ideal.period
    nodes = place.size
    if float(np.ptp(place)) < 1e-9 * ideal.rows.size:
        return None
    time, height = _turning(ideal, place, 1.0)
    top, negative = _turning(ideal, -place, -1.0)
    top -= period * math.ceil((top - time) / period)
    step = period / nodes
    lowest = round(time / step)
    above = np.flatnonzero(np.roll(place, -lowest) > place.min() + 0.5 * float(np.ptp(place)))
    end = (lowest + int(above[0])) * step
    # The stroke is filed in the cycle in which its window ends.
    back = period * math.ceil(end / period - 1.0)
    begin = (lowest + int(above[-1]) - nodes) * step
    window = begin - back, end - back
    return Bottom(time - back, height, -negative - height, top - back, window, period)


def dwell_of(ideal: IdealMotion, within: float) -> float:
    """How long an ideal motion stays at bottom dead centre, s, to a 1440th of its cycle.

    Parameters
    ----------
    within : float
        Height over it up to which it does, m.
    """
    place = _places(ideal)
    is_above = np.roll(place, -int(place.argmin())) > place.min() + within
    above = np.flatnonzero(is_above)
    stays = place.size if not above.size else int(above[0]) + place.size - 1 - int(above[-1])
    return (stays - 1) * ideal.period / place.size


def _places(ideal: IdealMotion) -> Array:
    """Places of the watched coordinate at the nodes of a cycle, m."""
    nodes = len(ideal.position) - 1
    levels = (ideal.position, ideal.velocity, ideal.acceleration)
    flat = (level.reshape(nodes + 1, -1)[:nodes] for level in levels)
    return Motion(ideal.times[:nodes], *flat).output(ideal.rows.linkage)[:, 0]


def _turning(ideal: IdealMotion, place: Array, sign: float) -> tuple[float, float]:
    """Time, s, and place, m, at which a coordinate is lowest, from its places at the nodes.

    Parameters
    ----------
    sign : float
        With which the watched coordinate is taken, 1 or -1.
    """
    linkage, period = ideal.rows.linkage, ideal.period
    started = linkage.run_up_time
    step = period / len(place)
    lowest = int((place < place.min() + 1e-12 * ideal.rows.size).argmax())
    low, high = (lowest - 1) * step, (lowest + 1) * step
    time = lowest * step

    def moved(time: float) -> tuple[float, float, float]:
        # Behind a run-up, and a cycle on: a time may lie before the first.
        found = sign * ideal.at(np.array([started + period + time])).output(linkage)[0]
        return float(found[0]), float(found[1]), float(found[2])

    for _ in range(_STEPS):
        _, speed, faster = moved(time)
        if speed < 0.0:
            low = time
        else:
            high = time
        nearer = time - speed / faster if faster > 0.0 else low
        nearer = nearer if low < nearer < high else 0.5 * (low + high)
        if abs(nearer - time) < 1e-15 * period:
            break
        time = nearer
    return time, moved(time)[0]
