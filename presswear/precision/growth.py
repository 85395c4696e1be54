"""How fast runs that start side by side part.

Of one method at its tightest tolerance, so that what grows is the distance of the
starts and not an error of the steps.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines import engine_for
from presswear.engines.base import DaeAccuracy, Plan, Run, Start
from presswear.scene import Scene
from presswear.starts import APART, disturbed, start_of
from presswear.traces import distance, trace_of

Array = NDArray[np.float64]

TOLERANCE = 1e-13
"""Of DOP853, the in-house solver's, in all runs."""
LOW, HIGH = 3.0 * APART, 1e-5
"""Distances between which the rate is read, m: above what the start itself makes, below one
per cent of a clearance, where the walls begin to hold the pins together."""
PARTED = 1000.0 * APART
"""Distance at which two runs have parted, m."""
_PARTS = 40
"""Parts of a run: the recorded series is so much finer."""


@dataclass(frozen=True)
class Growth:
    """Distance of two runs over time.

    Attributes
    ----------
    time, distance : tuple of float
        s; the greatest difference of the slider's position and of all eccentricities, m.
    touches : tuple of float
        Times at which pins touch in the first of both runs, s.
    rate : float
        Of log distance over time, 1/s; nan where it never grew from LOW to HIGH.
    per_touch : float
        Of log distance over touches; nan likewise.
    window : (float, float) or None
        Between which both are read, s.
    divergence : float or None
        Time at which both runs have parted, s.
    """

    time: tuple[float, ...]
    distance: tuple[float, ...]
    touches: tuple[float, ...]
    rate: float
    per_touch: float
    window: tuple[float, float] | None
    divergence: float | None

    @staticmethod
    def of(time: Array, apart: Array, touches: Sequence[float]) -> "Growth":
        """Fit a distance over time, each shape (n,)."""
        window = growing(time, apart)
        rate = per_touch = math.nan
        if window is not None:
            inside = (time >= window[0]) & (time <= window[1]) & (apart > 0.0)
            logarithm = np.log(apart[inside])
            rate = fitted_slope(time[inside], logarithm)
            count = np.searchsorted(np.sort(touches), time[inside], side="right")
            per_touch = fitted_slope(count.astype(float), logarithm)
        late = np.flatnonzero(apart >= PARTED)
        return Growth(
            tuple(time.tolist()),
            tuple(apart.tolist()),
            tuple(touches),
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
        return sum(onset <= self.divergence for onset in self.touches)

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
            None if window is None else (float(window[0]), float(window[1])),
            data["divergence"],
        )


def number(value: float | None) -> float:
    """A number from JSON, which has null for nan."""
    return math.nan if value is None else float(value)


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


def measure_growth(
    scene: Scene, cycles: int, pairs: int, progress: Callable[[str, float], None]
) -> tuple[Growth, ...]:
    """Run pairs of starts that are APART, each pair from where the last one's first run ended.

    So a pair each begins somewhere else on the motion; pairs beside each other would only
    repeat one growth.  Contacts begin anew with each pair.

    Parameters
    ----------
    cycles : int
        Of each run.
    progress : callable
        Told what runs and which part of all is done, 0 .. 1.

    Raises
    ------
    RunError
        Where a run fails.
    """
    linkage = scene.linkage()
    accuracy = DaeAccuracy("dop853", TOLERANCE)
    engine = engine_for(accuracy)
    duration = cycles * scene.mechanism.period
    start = start_of(scene)
    found = []
    for pair in range(pairs):
        beside = disturbed(linkage, start, APART)
        assert beside is not None, "a scene with a clearance joint has a free direction"
        runs: list[Run] = []
        for own in (start, beside):

            def told(part: float, done: int = 2 * pair + len(runs)) -> None:
                progress("growth of a disturbance", (done + part) / (2 * pairs))

            plan = Plan(duration / _PARTS, _PARTS, _PARTS, torques=False, progress=told)
            runs.append(engine(linkage, own, accuracy, plan))
        one, other = map(trace_of, runs)
        found.append(Growth.of(*distance(one, other), [touch.onset for touch in one.touches]))
        start = turned_back(runs[0].end, start)
    return tuple(found)
