"""How fast runs that start side by side part.

Of one method at its tightest tolerance, so that what grows is the distance of the
starts and not an error of the steps.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import APART, disturbed, start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import InHouse
from presswear.linkage.elements import Linkage
from presswear.record.recorder import Recorder
from presswear.record.tracker import Telling, Tracker
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed

Array = NDArray[np.float64]

TOLERANCE = 1e-13
"""Of DOP853, the in-house solver's, in all runs."""
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
class Growth:
    """Distance of two runs over time.

    Attributes
    ----------
    time, distance : tuple of float
        s; the greatest difference of the pins' places in their bearings, m.
    touches : tuple of int
        Touches in the first of both runs until then.
    rate : float
        Of log distance over time, by least squares, 1/s; nan where it never grew from LOW
        to HIGH.
    per_touch : float
        Of log distance over touches; nan likewise.
    window : (float, float) or None
        Between which both are fitted, s.
    divergence : float or None
        Time at which both runs have parted, s.
    """

    time: tuple[float, ...]
    distance: tuple[float, ...]
    touches: tuple[int, ...]
    rate: float
    per_touch: float
    window: tuple[float, float] | None
    divergence: float | None

    @staticmethod
    def of(time: Array, apart: Array, touches: NDArray[np.int64]) -> "Growth":
        """Fit a distance over time, each shape (n,)."""
        window = growing(time, apart)
        rate = per_touch = math.nan
        if window is not None:
            inside = (time >= window[0]) & (time <= window[1]) & (apart > 0.0)
            logarithm = np.log(apart[inside])
            rate = fitted_slope(time[inside], logarithm)
            per_touch = fitted_slope(touches[inside].astype(float), logarithm)
        late = np.flatnonzero(apart >= PARTED)
        return Growth(
            tuple(time.tolist()),
            tuple(apart.tolist()),
            tuple(touches.tolist()),
            rate,
            per_touch,
            window,
            float(time[late[0]]) if late.size else None,
        )

    @property
    def touches_to_divergence(self) -> int | None:
        """Touches before both runs have parted."""
        if self.divergence is None:
            return None
        return self.touches[self.time.index(self.divergence)]

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

    def as_dict(self) -> dict[str, Any]:
        """The growth as plain data."""
        return asdict(self)

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Growth":
        """A growth from ``as_dict``; what is not a number may be stored as null."""
        window = data["window"]
        return Growth(
            tuple(data["time"]),
            tuple(data["distance"]),
            tuple(data["touches"]),
            number(data["rate"]),
            number(data["per_touch"]),
            None if window is None else tuple(window),
            data["divergence"],
        )


def number(value: float | None) -> float:
    """A number from JSON, which has null for nan."""
    return math.nan if value is None else value


def growing(time: Array, apart: Array) -> tuple[float, float] | None:
    """From when the distance stays above LOW to when it first reaches HIGH, s; None if never.

    "Stays" until HIGH is reached: distances dip where two curves cross.
    """
    high = np.flatnonzero(apart >= HIGH)
    if not high.size:
        return None
    below = np.flatnonzero(apart[: high[0]] < LOW)
    first = below[-1] + 1 if below.size else 0
    return (float(time[first]), float(time[high[0]])) if first < high[0] else None


def fitted_slope(x: Array, y: Array) -> float:
    """Slope of a straight line by least squares; nan where x does not vary."""
    if x.size < 2 or np.ptp(x) == 0.0:
        return math.nan
    return float(np.polyfit(x, y, 1)[0])


def turned_back(end: Start, start: Start) -> Start:
    """A state after whole cycles as a start: with the full turns of its bodies taken off."""
    position = end.position.copy()
    turns = np.round((position[2::3] - start.position[2::3]) / (2.0 * math.pi))
    position[2::3] -= 2.0 * math.pi * turns
    return Start(position, end.velocity)


@dataclass
class _Sampler(Tracker):
    """Asked after each part of a run: notes where the pins are."""

    places: list[Array]
    touches: list[int]

    def cycle(self, recorder: Recorder, state: object) -> bool:
        """File a state; it never ends the run."""
        contacts = recorder.book.contacts
        self.places.append(np.array([contacts["eccentricity_x"], contacts["eccentricity_y"]]))
        self.touches.append(int(recorder.book.tally["contacts"].sum()))
        return False


def sampled_run(
    linkage: Linkage, start: Start, period: float, cycles: int, progress: Callable[[float], None]
) -> tuple[Run, _Sampler]:
    """A run of so many cycles that is sampled SAMPLES times in each; RunFailed if it fails."""
    accuracy = InHouse("dop853", TOLERANCE, free_step=period / LEAST_STEPS)
    sampler = _Sampler([], [])
    plan = Plan(
        period / SAMPLES,
        cycles * SAMPLES,
        recorded_cycles=1,
        torques=False,
        trackers=(sampler, Telling(progress)),
    )
    run = accuracy.simulate(linkage, start, plan)
    if run.status == "failed":
        raise RunFailed(run.message)
    return run, sampler


def measure_growth(
    scene: Scene, cycles: int, pairs: int, progress: Callable[[str, float], None]
) -> tuple[Growth, ...]:
    """Run pairs of starts that are APART, each pair from where the last one's first run ended.

    So a pair each begins somewhere else on the motion; pairs beside each other would only
    repeat one growth.  Contacts begin anew with each pair.

    Parameters
    ----------
    cycles : int
        Of each run; of the first pair one, which tells whether it parts.
    progress : callable
        Told what runs and which part of all is done, 0 .. 1.

    Raises
    ------
    RunFailed
        Where a run fails.
    """
    linkage, period = scene.linkage(), scene.mechanism.period
    start = start_of(scene)
    lengths = [1, *(cycles for _ in range(pairs - 1))]
    work = 2 * sum(lengths)
    found: list[Growth] = []
    done = 0
    for length in lengths:
        beside = disturbed(linkage, start, APART)
        assert beside is not None, "a scene with a clearance joint has a free direction"
        runs: list[tuple[Run, _Sampler]] = []
        for own in (start, beside):

            def told(part: float, before: int = done, length: int = length) -> None:
                progress("growth of a disturbance", (before + length * part) / work)

            runs.append(sampled_run(linkage, own, period, length, told))
            done += length
        (first, calm), (_, moved) = runs
        apart = np.abs(np.array(calm.places) - np.array(moved.places)).max(axis=(1, 2))
        time = period / SAMPLES * np.arange(1, apart.size + 1)
        found.append(Growth.of(time, apart, np.array(calm.touches)))
        start = turned_back(first.end, start)
    return tuple(found)
