"""Beyond the horizon: growth of a disturbance, and statistics against their cost.

Trajectories are no quantity there: two runs that start 1e-9 m apart part within a cycle.
What remains are statistics, and the question is which setting is cheap and yet wrong by
less than a run's own scatter.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import Any

import numpy as np

from presswear.campaign.ensemble import FEWEST
from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run
from presswear.record.sampling import half_width, map_batches, map_errors
from presswear.record.tracker import Telling
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.trials.precision.extent import Extent
from presswear.trials.precision.growth import Growth, measure_growth, number
from presswear.trials.precision.ladder import finest, ladder, method_as_dict, method_from_dict
from presswear.trials.precision.points import Method
from presswear.trials.precision.statistic import (
    Draws,
    Statistic,
    StepError,
    as_plain,
    honest_cycles,
    is_for_wear,
    names_of,
    statistics_of,
    step_errors,
)

Progress = Callable[[str, float], None]
"""Told what is being run and which part of all is done, 0 .. 1."""

_GROWTH_SHARE = 0.1
"""Part of the work that the growth of a disturbance takes, roughly."""


@dataclass(frozen=True)
class Size:
    """How much is run.

    Attributes
    ----------
    pairs : int
        Pairs of neighbouring starts whose distance is followed.
    duration : int
        Over so many cycles; the first over one.
    starts, cycles : int
        Of each method.
    reference : int
        So many times the starts, of the finest method.
    methods : callable
        Picks from the ladder.
    """

    pairs: int
    duration: int
    starts: int
    cycles: int
    reference: int = 3
    methods: Callable[[Method], bool] = lambda method: True


_FEW = {
    "exudyn-tree, DOPRI5": (1e-4, 1e-6),
    "dae, DOPRI5": (1e-3, 1e-4, 1e-5, 1e-7),
    "dae, RK4": (1e-4, 5e-5),
}


def _is_cheap(method: Method) -> bool:
    return method.value in _FEW.get(method.family, ())


QUICK = Size(pairs=2, duration=2, starts=2, cycles=26, reference=2, methods=_is_cheap)
FULL = Size(pairs=6, duration=3, starts=4, cycles=30)


@dataclass(frozen=True)
class StatisticPoint:
    """A method with its statistics and their cost.

    Attributes
    ----------
    rates : tuple of float
        Wall time of the solve per simulated second, one a start.
    warm_up : float
        Compiling and loading before the first run, s.
    simulated : float
        All starts together, s.
    steps : int
        Accepted, all starts together.
    statistics, step_errors : mapping
        By name; empty for a failure.
    failure : str
        Why it failed, or nothing.
    """

    method: Method
    rates: tuple[float, ...] = ()
    warm_up: float = 0.0
    simulated: float = 0.0
    steps: int = 0
    statistics: Mapping[str, Statistic] = field(default_factory=dict)
    step_errors: Mapping[str, StepError] = field(default_factory=dict)
    failure: str = ""

    @property
    def cost(self) -> float:
        """Median wall time per simulated second; nan where nothing was timed."""
        return median(self.rates) if self.rates else math.nan

    def as_dict(self) -> dict[str, Any]:
        """The point as plain data."""
        return {
            "method": method_as_dict(self.method),
            "rates": list(self.rates),
            "warm_up": self.warm_up,
            "simulated": self.simulated,
            "steps": self.steps,
            "statistics": as_plain(self.statistics),
            "step_errors": as_plain(self.step_errors),
            "failure": self.failure,
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "StatisticPoint":
        """A point from ``as_dict``."""
        return StatisticPoint(
            method_from_dict(data["method"]),
            tuple(data["rates"]),
            data["warm_up"],
            data["simulated"],
            data["steps"],
            {name: Statistic(**one) for name, one in data["statistics"].items()},
            {
                name: StepError(
                    number(one["value"]),
                    one["low"],
                    one["high"],
                    math.inf if one["bound"] is None else one["bound"],
                )
                for name, one in data["step_errors"].items()
            },
            data["failure"],
        )


@dataclass(frozen=True)
class Chaos:
    """What is known of a scene's unworn linkage beyond the horizon.

    Attributes
    ----------
    growths : tuple of Growth
        One a pair of starts.
    reference : StatisticPoint
        The finest method, with more cycles than the others.
    points : tuple of StatisticPoint
        The ladder, each compared with the reference.
    stage_cycles : int
        Cycles that a stage of the scene takes until its wear maps are known to the scene's
        tolerance.
    """

    growths: tuple[Growth, ...]
    reference: StatisticPoint
    points: tuple[StatisticPoint, ...]
    stage_cycles: int

    @property
    def names(self) -> tuple[str, ...]:
        """Of the statistics."""
        return tuple(self.reference.statistics)

    @property
    def rate(self) -> float:
        """Growth rate of the first pair, from the start that scenes have, 1/s."""
        return self.growths[0].rate if self.growths else math.nan

    @property
    def divergence(self) -> float | None:
        """Time at which the first pair had parted, s."""
        return self.growths[0].divergence if self.growths else None

    @property
    def settled_rate(self) -> Statistic:
        """Mean growth rate of the further pairs, lulls included, 1/s."""
        rates = np.array([growth.overall for growth in self.growths[1:]])
        known = rates[np.isfinite(rates)]
        mean = float(known.mean()) if known.size else math.nan
        return Statistic(mean, half_width(known), known.size)

    def honest_cycles(self, point: StatisticPoint, name: str) -> float:
        """Cycles up to which the bound of a statistic's step error is below its sampling error.

        The sampling error is the motion's own, which the finest method knows best.
        """
        return honest_cycles(self.reference.statistics[name], point.step_errors[name])

    def is_honest(self, point: StatisticPoint, wear_only: bool = True) -> bool:
        """Whether a method has the statistics of a stage of the scene right.

        Its step errors are not seen, and even the largest that they may be are below the
        sampling errors of such a stage.

        Parameters
        ----------
        wear_only : bool
            Only those that count for wear.
        """
        return not point.failure and all(
            not point.step_errors[name].is_seen
            and self.honest_cycles(point, name) >= self.stage_cycles
            for name in self.names
            if is_for_wear(name) or not wear_only
        )

    def cheapest(
        self, points: Sequence[StatisticPoint] | None = None, wear_only: bool = True
    ) -> StatisticPoint | None:
        """The cheapest honest setting of some, or of all; None if none is."""
        honest = [
            point
            for point in (self.points if points is None else points)
            if self.is_honest(point, wear_only)
        ]
        return min(honest, key=lambda point: point.cost, default=None)

    def families(self) -> dict[str, list[StatisticPoint]]:
        """Points of each curve, from coarse to fine, failures included."""
        found: dict[str, list[StatisticPoint]] = {}
        for point in self.points:
            found.setdefault(point.method.family, []).append(point)
        return found

    def as_dict(self) -> dict[str, Any]:
        """What is known as plain data."""
        return {
            "growths": [growth.as_dict() for growth in self.growths],
            "reference": self.reference.as_dict(),
            "points": [point.as_dict() for point in self.points],
            "stage_cycles": self.stage_cycles,
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Chaos":
        """What is known from ``as_dict``."""
        return Chaos(
            tuple(Growth.from_dict(growth) for growth in data["growths"]),
            StatisticPoint.from_dict(data["reference"]),
            tuple(StatisticPoint.from_dict(point) for point in data["points"]),
            data["stage_cycles"],
        )


@dataclass
class _Gathered:
    """What the runs of a method have given so far; large series are not kept."""

    method: Method
    runs: int = 0
    draws: Draws = Draws((), ())
    rates: tuple[float, ...] = ()
    warm_up: float = 0.0
    simulated: float = 0.0
    steps: int = 0
    failure: str = ""

    def add(self, run: Run) -> None:
        """File a run."""
        self.runs += 1
        if self.runs == 1:
            self.warm_up = float(run.diagnostics["wall_compile_s"])
        self.simulated += run.time
        self.steps += int(run.diagnostics["steps"])
        if run.status == "failed":
            self.failure = f"start {self.runs}: {run.message}"
            return
        self.rates += (float(run.diagnostics["wall_solve_s"]) / run.time,)
        recorder = run.recorder
        self.draws = Draws(
            (*self.draws.rows, np.array(recorder.cycles)), (*self.draws.maps, recorder.maps)
        )

    def point(self, names: Mapping[str, tuple[str, int]], reference: Draws) -> StatisticPoint:
        """The method's point."""
        known = not self.failure
        return StatisticPoint(
            self.method,
            self.rates,
            self.warm_up,
            self.simulated,
            self.steps,
            statistics_of(names, self.draws) if known else {},
            step_errors(names, self.draws, reference) if known else {},
            self.failure,
        )


def measure(scene: Scene, extent: Extent, progress: Progress) -> Chaos:
    """What is known of a scene beyond the horizon, quick or in full; see ``follow``."""
    return follow(scene, QUICK if extent.quick else FULL, progress)


def follow(scene: Scene, size: Size, progress: Progress) -> Chaos:
    """Run a scene's unworn linkage with each method, start by start in turn.

    Raises
    ------
    InputError
        Where the scene has no clearance joint.
    RunFailed
        Where the finest method fails.
    """
    if not scene.clearance_joints:
        raise InputError(f"scene {scene.name}: without a clearance joint nothing is chaotic")
    period = scene.mechanism.period
    growths = measure_growth(
        scene,
        size.duration,
        size.pairs,
        lambda word, part: progress(word, _GROWTH_SHARE * part),
    )
    linkage = scene.linkage()
    reference = _Gathered(finest(scene))
    methods = [_Gathered(method) for method in ladder(scene) if size.methods(method)]
    # In turn, so that a slow minute of the machine is shared by all.  The finest method has
    # starts of its own: where it is on the ladder as well, it is held against other draws.
    tasks = [(gathered, start) for start in range(size.starts) for gathered in methods]
    own = range(size.starts, (1 + size.reference) * size.starts)
    tasks += [(reference, start) for start in own]
    share = (1.0 - _GROWTH_SHARE) / len(tasks)
    for done, (gathered, start) in enumerate(tasks):
        if gathered.failure:
            continue

        def told(part: float, done: int = done, word: str = gathered.method.label) -> None:
            progress(word, _GROWTH_SHARE + share * (done + part))

        told(0.0)
        plan = Plan(
            period, size.cycles, recorded_cycles=1, torques=False, trackers=(Telling(told),)
        )
        gathered.add(gathered.method.accuracy.simulate(linkage, start_of(scene, start), plan))
    if reference.failure:
        raise RunFailed(f"{reference.method.label}: {reference.failure}")
    names = names_of(linkage)
    return Chaos(
        growths,
        reference.point(names, reference.draws),
        tuple(gathered.point(names, reference.draws) for gathered in methods),
        stage_cycles(scene, reference.draws),
    )


def stage_cycles(scene: Scene, reference: Draws) -> int:
    """Cycles until a stage of the scene knows its wear maps to the scene's tolerance."""
    if scene.cycles is not None:
        return scene.cycles * scene.starts
    maps, weights = map_batches(reference.maps)
    error = float(map_errors(maps, weights).max())
    if not math.isfinite(error):
        return scene.most_cycles
    samples = sum(run.samples for run in reference.maps)
    needed = math.ceil(samples * (error / scene.tolerance) ** 2)
    return min(max(needed, FEWEST), scene.most_cycles)
