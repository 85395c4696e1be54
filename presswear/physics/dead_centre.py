"""Bottom dead centre of the ideal motion."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from presswear.physics.ideal import IdealMotion, Motion
from presswear.tools.arrays import Array

# Duration at the bottom, in cycles, from which on an ideal motion dwells: its bottom
# then has no instant
DWELL = 0.02
DEPTH = 1e-9  # of the stroke, by which a motion rises between two bottoms
_STEPS = 60  # most steps of Newton's method, or halvings, between two nodes


@dataclass(frozen=True)
class Bottom:
    """Bottom dead centre of an ideal motion, and the stroke to it.

    Times, s, are counted from the beginning of the cycle in which the stroke ends. No
    bottom dead centre falls between two windows, whatever a clearance does to it.
    """

    time: float  # below zero if it lies in the cycle before
    height: float  # of the output point there, m, in the axes of the frame
    stroke: float  # between its lowest and highest place, m
    top: float  # time of the highest place before it
    window: tuple[float, float]  # in which the lower half of the stroke begins and ends
    period: float  # of a cycle, s
    # time and height of each minimum in the window
    minima: tuple[tuple[float, float], ...]

    @property
    def first(self) -> int:
        """Cycle in which the first whole stroke ends."""
        return 1 if self.time < 0.0 else 0

    def delay(self, time: Array) -> Array:
        """Return the delay of instants since the start against the nearest bottom, s."""
        # A run-up takes whole cycles.
        late = time - self.time
        return np.asarray(late - self.period * np.round(late / self.period))


@lru_cache(maxsize=64)
def bottom_of(ideal: IdealMotion) -> Bottom | None:
    """Return the bottom dead centre of an ideal motion; None where the output point stands.

    It is the lowest bottom of a cycle. If several have the same height, it is the first
    of them.
    """
    place = _places(ideal)
    period = ideal.period
    nodes = place.size
    if float(np.ptp(place)) < 1e-9 * ideal.rows.size:
        return None
    time, height = _lowest(ideal, _first_lowest(ideal, place), nodes, 1.0)
    top, negative = _lowest(ideal, _first_lowest(ideal, -place), nodes, -1.0)
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
    for k in _minima(window_places, DEPTH * range_of_place):
        minimum_time, minimum_height = _lowest(ideal, first + k, nodes, 1.0)
        minima.append((minimum_time - shift, minimum_height))
    return Bottom(
        time=time - shift,
        height=height,
        stroke=-negative - height,
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
    nodes = place.size  # below the height
    if above.size:
        nodes = int(above[0]) + place.size - 1 - int(above[-1])
    return (nodes - 1) * ideal.period / place.size


def _places(ideal: IdealMotion) -> Array:
    """Return the places of the output point at the nodes of a cycle, m."""
    levels = (ideal.position, ideal.velocity, ideal.acceleration)
    flat = (level.reshape(len(level), -1)[:-1] for level in levels)
    return Motion(ideal.times[:-1], *flat).output(ideal.rows.linkage)[:, 0]


def _first_lowest(ideal: IdealMotion, place: Array) -> int:
    """Return the node of the lowest place, the first of several equal places."""
    return int((place < place.min() + 1e-12 * ideal.rows.size).argmax())


def _minima(place: Array, depth: float) -> list[int]:
    """Return the nodes of the minima between which a place rises by more than a depth, m."""
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
    """Return time, s, and place, m, of the minimum at a node; ``sign`` may turn the coordinate."""
    linkage = ideal.rows.linkage
    period = ideal.period
    step = period / nodes
    low = (node - 1) * step
    high = (node + 1) * step
    time = node * step

    def motion_at(time: float) -> list[float]:
        # A cycle after the run-up, because a time may be before the first cycle.
        instant = np.array([linkage.run_up_time + period + time])
        return list(map(float, sign * ideal.at(instant).output(linkage)[0]))

    for _ in range(_STEPS):
        _, speed, acceleration = motion_at(time)
        if speed < 0.0:
            low = time
        else:
            high = time
        new = time - speed / acceleration if acceleration > 0.0 else low
        new = new if low <= new <= high else 0.5 * (low + high)
        if abs(new - time) < 1e-15 * period:
            break
        time = new
    return time, motion_at(time)[0]
