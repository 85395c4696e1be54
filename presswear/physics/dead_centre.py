"""Bottom dead centre of the ideal motion."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from presswear.physics.ideal import IdealMotion, Motion
from presswear.tools.arrays import Array

# A motion that stays at the bottom for at least this part of a cycle dwells. Its bottom
# dead centre has no instant.
DWELL = 0.02
# Least rise between two minima of a motion, and least stroke, relative to the stroke and
# to the size of the linkage; above the round-off of the assembly
LEAST_RISE = 1e-9
# Largest difference of places that count as equal, relative to the size of the linkage
_EQUAL = 1e-12
_STEPS = 60  # largest number of steps of Newton's method and of bisection


@dataclass(frozen=True)
class Bottom:
    """Bottom dead centre of an ideal motion, and the stroke to it.

    Times, s, are counted from the beginning of the cycle in which the stroke ends. The
    windows contain the bottom dead centres of motions with clearance, too.
    """

    time: float  # negative if it lies in the previous cycle
    height: float  # height of the output point at this time in the axes of the frame, m
    stroke: float  # distance of the lowest and the highest position, m
    top: float  # time of the previous highest position
    window: tuple[float, float]  # beginning and end of the lower half of the stroke
    period: float  # period of a cycle, s
    # Time and height of each minimum in the window
    minima: tuple[tuple[float, float], ...]

    @property
    def first(self) -> int:
        """Cycle in which the first whole stroke ends."""
        return 1 if self.time < 0.0 else 0

    def delay(self, time: Array) -> Array:
        """Return the delay of instants relative to the nearest bottom dead centre, s.

        ``time`` counts from the start of the run. A run-up takes whole cycles.
        """
        delay = time - self.time
        return np.asarray(delay - self.period * np.round(delay / self.period))


@lru_cache(maxsize=64)
def bottom_of(ideal: IdealMotion) -> Bottom | None:
    """Return the bottom dead centre of an ideal motion; None if the output point is at rest.

    It is the lowest minimum of a cycle, and the first of several equal minima.
    """
    place = _places(ideal)
    period = ideal.period
    nodes = place.size
    if float(np.ptp(place)) < LEAST_RISE * ideal.rows.size:
        return None
    time, height = _lowest(ideal, _first_lowest(ideal, place), nodes, 1.0)
    top, negative_height = _lowest(ideal, _first_lowest(ideal, -place), nodes, -1.0)
    top -= period * math.ceil((top - time) / period)
    step = period / nodes
    lowest = round(time / step)
    range_of_place = float(np.ptp(place))
    middle = place.min() + 0.5 * range_of_place
    above = np.flatnonzero(np.roll(place, -lowest) > middle)
    # Nodes between which the lower half of the stroke lies
    first = lowest + int(above[-1]) - nodes
    last = lowest + int(above[0])
    # The stroke belongs to the cycle in which its window ends.
    shift = period * math.ceil(last * step / period - 1.0)
    window_places = place[np.arange(first, last + 1) % nodes]
    minima = []
    for k in _minima(window_places, LEAST_RISE * range_of_place):
        minimum_time, minimum_height = _lowest(ideal, first + k, nodes, 1.0)
        minima.append((minimum_time - shift, minimum_height))
    return Bottom(
        time=time - shift,
        height=height,
        stroke=-negative_height - height,
        top=top - shift,
        window=(first * step - shift, last * step - shift),
        period=period,
        minima=tuple(minima),
    )


def dwell_of(ideal: IdealMotion, height: float) -> float:
    """Return the time for which a motion stays below a height, m, over its bottom, s.

    It is accurate to a 1440th of the cycle, the distance of two nodes.
    """
    place = _places(ideal)
    from_bottom = np.roll(place, -int(place.argmin())) - place.min()
    above = np.flatnonzero(from_bottom > height)
    nodes_below = place.size
    if above.size:
        nodes_below = int(above[0]) + place.size - 1 - int(above[-1])
    return (nodes_below - 1) * ideal.period / place.size


def _places(ideal: IdealMotion) -> Array:
    """Return the places of the output point at the nodes of a cycle, m."""
    levels = (ideal.position, ideal.velocity, ideal.acceleration)
    flat = (level.reshape(len(level), -1)[:-1] for level in levels)
    return Motion(ideal.times[:-1], *flat).output(ideal.rows.linkage)[:, 0]


def _first_lowest(ideal: IdealMotion, place: Array) -> int:
    """Return the node of the lowest place, the first of several equal places."""
    return int((place < place.min() + _EQUAL * ideal.rows.size).argmax())


def _minima(place: Array, depth: float) -> list[int]:
    """Return the nodes of the minima between which the position rises by more than ``depth``, m.

    Of two minima with a smaller rise between them the lower one is returned.
    """
    result = list[int]()
    inner = np.arange(1, len(place) - 1)
    is_minimum = (place[inner] < place[inner - 1]) & (place[inner] <= place[inner + 1])
    for k in map(int, inner[is_minimum]):
        if not result:
            result.append(k)
            continue
        last = result[-1]
        rise = place[last:k].max() - place[[last, k]].max()
        if rise > depth:
            result.append(k)
        elif place[k] < place[last]:
            result[-1] = k
    return result


def _lowest(
    ideal: IdealMotion, node: int, nodes: int, sign: float
) -> tuple[float, float]:
    """Return time, s, and position, m, of the minimum near a node.

    With the ``sign`` -1 it is a maximum, whose position has the opposite sign.
    """
    linkage = ideal.rows.linkage
    period = ideal.period
    step = period / nodes
    low = (node - 1) * step
    high = (node + 1) * step
    time = node * step

    def motion_at(time: float) -> list[float]:
        """Return place, velocity and acceleration of the output point, times the sign."""
        # The time can be negative. The motion is evaluated in the second cycle.
        instant = np.array([linkage.run_up_time + period + time])
        return list(map(float, sign * ideal.at(instant).output(linkage)[0]))

    for _ in range(_STEPS):
        _, speed, acceleration = motion_at(time)
        if speed < 0.0:
            low = time
        else:
            high = time
        new = low
        if acceleration > 0.0:
            new = time - speed / acceleration
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - time) < 1e-15 * period:
            break
        time = new
    place, _, _ = motion_at(time)
    return time, place
