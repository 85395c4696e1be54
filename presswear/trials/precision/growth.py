"""Growth of the distance of runs that start side by side.

All run with one method at its tightest tolerance, so that what grows is the distance of the
starts and not an error of the steps.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import APART, disturbed, start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import InHouse
from presswear.linkage.elements import Linkage
from presswear.record.recorder import Recorder
from presswear.record.tracker import Telling, Tracker
from presswear.scene.scene import Scene
from presswear.trials.runs import Told, finished, part_of

Array = NDArray[np.float64]

TOLERANCE = 1e-13
"""Tolerance of DOP853, the in-house solver's, in all runs."""
SAMPLES = 400
"""Times in a cycle at which two runs are compared; both stop there, so that nothing has to be
interpolated."""
LEAST_STEPS = 500
"""Steps in a cycle, at least."""
LOW, HIGH = 3.0 * APART, 1e-5
"""Distances between which the rate is read, m: above what the start itself makes, below one
per cent of a clearance, where the walls begin to hold the pins together."""
PARTED = 1000.0 * APART
"""Distance at which two runs have parted, m."""


@dataclass(frozen=True)
class Parting:
    """Distance of two runs over time.

    Attributes
    ----------
    time, distance : tuple of float
        s; the greatest difference of the pins' places in their bearings, m.
    touchdowns : tuple of int
        Touchdowns in the first of both runs until then.
    rate : float or None
        Slope of log distance over time, by least squares, 1/s; None where it never grew
        from LOW to HIGH.
    per_touchdown : float or None
        Slope of log distance over touchdowns; None likewise.
    window : (float, float) or None
        Times between which both are fitted, s.
    divergence : float or None
        Time at which both runs have parted, s.
    """

    time: tuple[float, ...]
    distance: tuple[float, ...]
    touchdowns: tuple[int, ...]
    rate: float | None
    per_touchdown: float | None
    window: tuple[float, float] | None
    divergence: float | None

    @staticmethod
    def of(time: Array, apart: Array, touchdowns: NDArray[np.int64]) -> "Parting":
        """Fit a distance over time, each shape (n,)."""
        window = growing(time, apart)
        rate = per_touchdown = None
        if window is not None:
            inside = (time >= window[0]) & (time <= window[1]) & (apart > 0.0)
            logarithm = np.log(apart[inside])
            rate = fitted_slope(time[inside], logarithm)
            per_touchdown = fitted_slope(touchdowns[inside].astype(float), logarithm)
        late = np.flatnonzero(apart >= PARTED)
        return Parting(
            tuple(time.tolist()),
            tuple(apart.tolist()),
            tuple(touchdowns.tolist()),
            rate,
            per_touchdown,
            window,
            float(time[late[0]]) if late.size else None,
        )

    @property
    def touchdowns_to_divergence(self) -> int | None:
        """Touchdowns before both runs have parted."""
        if self.divergence is None:
            return None
        return self.touchdowns[self.time.index(self.divergence)]

    @property
    def overall(self) -> float:
        """Mean growth rate from the start until HIGH or the end, 1/s; nan for an empty one.

        Lulls count, unlike in ``rate``.
        """
        apart = np.array(self.distance)
        late = np.flatnonzero(apart >= HIGH)
        last = int(late[0]) if late.size else apart.size - 1
        if last < 0 or self.time[last] <= 0.0 or apart[last] <= 0.0:
            return math.nan
        return math.log(apart[last] / APART) / self.time[last]


def growing(time: Array, apart: Array) -> tuple[float, float] | None:
    """Times from which the distance stays above LOW and first reaches HIGH, s; None if never.

    "Stays" until HIGH is reached: distances dip where two curves cross.
    """
    high = np.flatnonzero(apart >= HIGH)
    if not high.size:
        return None
    below = np.flatnonzero(apart[: high[0]] < LOW)
    first = below[-1] + 1 if below.size else 0
    return (float(time[first]), float(time[high[0]])) if first < high[0] else None


def fitted_slope(x: Array, y: Array) -> float | None:
    """Slope of a straight line by least squares; None where x does not vary."""
    if x.size < 2 or np.ptp(x) == 0.0:
        return None
    return float(np.polyfit(x, y, 1)[0])


def turned_back(end: Start, start: Start) -> Start:
    """Take a state after whole cycles as a start: without the full turns of its bodies."""
    position = end.position.copy()
    turns = np.round((position[2::3] - start.position[2::3]) / (2.0 * math.pi))
    position[2::3] -= 2.0 * math.pi * turns
    return Start(position, end.velocity)


@dataclass
class _Sampler(Tracker):
    """Notes after each part of a run where the pins are."""

    places: list[Array]
    touchdowns: list[int]

    def cycle(self, recorder: Recorder, state: object) -> bool:
        """File a state; it never ends the run."""
        contacts = recorder.book.contacts
        self.places.append(np.array([contacts["eccentricity_x"], contacts["eccentricity_y"]]))
        self.touchdowns.append(int(recorder.book.tally["contacts"].sum()))
        return False


def sampled_run(
    linkage: Linkage, start: Start, period: float, cycles: int, told: Callable[[float], None]
) -> tuple[Run, _Sampler]:
    """Run so many cycles and sample each SAMPLES times; RunFailed if the run fails."""
    engine = InHouse("dop853", TOLERANCE, free_step=period / LEAST_STEPS)
    sampler = _Sampler([], [])
    plan = Plan(
        period / SAMPLES,
        cycles * SAMPLES,
        recorded_cycles=1,
        torques=False,
        trackers=(sampler, Telling(told)),
    )
    return finished(engine.simulate(linkage, start, plan)), sampler


def measure_growth(scene: Scene, cycles: int, pairs: int, told: Told) -> tuple[Parting, ...]:
    """Run pairs of starts that are APART, each pair from where the last one's first run ended.

    So a pair each begins somewhere else on the motion; pairs beside each other would only
    repeat one growth.  Contacts begin anew with each pair.

    Parameters
    ----------
    cycles : int
        Length of each run; of the first pair one, which tells whether it parts.

    Raises
    ------
    RunFailed
        Where a run fails.
    """
    linkage, period = scene.linkage(), scene.mechanism.period
    start = start_of(scene)
    lengths = [1, *(cycles for _ in range(pairs - 1))]
    work = 2 * sum(lengths)
    found: list[Parting] = []
    done = 0
    for length in lengths:
        beside = disturbed(linkage, start, APART)
        assert beside is not None, "a scene with a clearance joint has a free direction"
        runs: list[tuple[Run, _Sampler]] = []
        for own in (start, beside):
            tell = partial(part_of(told, done, length, work), "growth of a disturbance")
            runs.append(sampled_run(linkage, own, period, length, tell))
            done += length
        (first, calm), (_, moved) = runs
        apart = np.abs(np.array(calm.places) - np.array(moved.places)).max(axis=(1, 2))
        time = period / SAMPLES * np.arange(1, apart.size + 1)
        found.append(Parting.of(time, apart, np.array(calm.touchdowns)))
        start = turned_back(first.end, start)
    return tuple(found)
