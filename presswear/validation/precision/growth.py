"""Growth of the distance of runs that start side by side.

All run with one method at its tightest tolerance, so that what grows is the distance of the
starts and not an error of the steps.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import disturbed
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.recording.recorder import Recorder
from presswear.recording.tracker import Telling, Tracker
from presswear.validation.runs import Told, finished, part_of

Array = NDArray[np.float64]

TOLERANCE = 1e-13
"""Tolerance of DOP853, the in-house solver's, in all runs."""
SAMPLES = 400
"""Times in a cycle at which two runs are compared; both stop there, so that nothing has to be
interpolated."""
LEAST_STEPS = 500
"""Steps in a cycle, at least."""
APART = 1e-9
"""Initial distance of two runs, m."""
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
    """

    DERIVED: ClassVar = ("rate", "per_touchdown", "window", "divergence")

    time: tuple[float, ...]
    distance: tuple[float, ...]
    touchdowns: tuple[int, ...]

    def _first(self, distance: float) -> int | None:
        """Place of the first distance that is as large, m."""
        return next((i for i, apart in enumerate(self.distance) if apart >= distance), None)

    @property
    def window(self) -> tuple[float, float] | None:
        """Times from which the distance stays above LOW and first reaches HIGH, s, if ever.

        "Stays" until HIGH is reached: distances dip where two curves cross.
        """
        high = self._first(HIGH)
        if high is None:
            return None
        below = [i for i, apart in enumerate(self.distance[:high]) if apart < LOW]
        first = below[-1] + 1 if below else 0
        return (self.time[first], self.time[high]) if first < high else None

    @property
    def inside(self) -> NDArray[np.bool_]:
        """True in the window, where a logarithm can be taken."""
        begin, end = self.window or (math.inf, -math.inf)
        time = np.array(self.time)
        return (time >= begin) & (time <= end) & (np.array(self.distance) > 0.0)

    def _slope(self, over: Sequence[float]) -> float | None:
        """Slope of log distance in the window, by least squares; None where ``over`` is even."""
        inside = self.inside
        x, y = np.array(over, dtype=float)[inside], np.array(self.distance)[inside]
        return float(np.polyfit(x, np.log(y), 1)[0]) if np.unique(x).size > 1 else None

    @property
    def rate(self) -> float | None:
        """Slope of log distance over time in the window, 1/s."""
        return self._slope(self.time)

    @property
    def per_touchdown(self) -> float | None:
        """Slope of log distance over touchdowns in the window."""
        return self._slope(self.touchdowns)

    @property
    def divergence(self) -> float | None:
        """Time at which both runs have parted, s; None where they never do."""
        late = self._first(PARTED)
        return None if late is None else self.time[late]

    @property
    def touchdowns_to_divergence(self) -> int | None:
        """Touchdowns before both runs have parted."""
        late = self._first(PARTED)
        return None if late is None else self.touchdowns[late]


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
    trackers = sampler, Telling(told)
    plan = Plan(period / SAMPLES, cycles * SAMPLES, 1, torques=False, trackers=trackers)
    return finished(engine.simulate(linkage, start, plan)), sampler


def measure_growth(
    linkage: Linkage, start: Start, period: float, cycles: int, told: Told
) -> Parting:
    """Run a start and one APART from it; RunFailed where a run fails."""
    beside = disturbed(linkage, start, APART)
    assert beside is not None, "a scene with a clearance joint has a free direction"
    samplers = []
    for k, own in enumerate((start, beside)):
        tell = partial(part_of(told, 0.5 * k, 0.5), "growth of a disturbance")
        samplers.append(sampled_run(linkage, own, period, cycles, tell)[1])
    calm, moved = samplers
    apart = np.abs(np.array(calm.places) - np.array(moved.places)).max(axis=(1, 2))
    time = period / SAMPLES * np.arange(1, apart.size + 1)
    return Parting(tuple(time.tolist()), tuple(apart.tolist()), tuple(calm.touchdowns))
