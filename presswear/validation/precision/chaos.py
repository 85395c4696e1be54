"""Statistics beyond the horizon: growth of a disturbance, and statistics against their cost.

Trajectories are no quantity there: two runs that start 1e-9 m apart part within a cycle.
What remains are statistics, and the question is which setting is cheap and yet wrong by
less than a run's own scatter.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from statistics import median

from presswear.bifurcation.flow import scene_exponent
from presswear.campaign.ensemble import FEWEST
from presswear.campaign.replicates import start_of
from presswear.dynamics.lyapunov import Exponent
from presswear.engines.base import Plan, Run
from presswear.physics.tree import Tree, tree_of
from presswear.recording.sampling import Estimate, map_batches, map_errors
from presswear.recording.tracker import Telling
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.validation.precision.growth import Parting, measure_growth
from presswear.validation.precision.methods import Method, finest, grouped, statistics_methods
from presswear.validation.precision.statistic import (
    Draws,
    StepError,
    honest_cycles,
    is_for_wear,
    names_of,
    statistics_of,
    step_errors,
)
from presswear.validation.runs import Told, part_of

_GROWTH_SHARE = 0.1
"""Part of the work that the growth of a disturbance takes, roughly."""


@dataclass(frozen=True)
class ChaosExtent:
    """Lengths of what is run beyond the horizon.

    Attributes
    ----------
    exponent_cycles : int
        Cycles that the exponent is the mean of.
    starts, cycles : int
        Those of each method.
    reference : int
        So many times the starts for the finest method.
    few : mapping or None
        Steps or tolerances that are run, by family; None: all of all.
    """

    exponent_cycles: int
    replicates: int
    cycles: int
    reference: int = 3
    few: Mapping[str, tuple[float, ...]] | None = None


FEW = {
    "exudyn-tree, DOPRI5": (1e-4, 1e-6),
    "dae, DOPRI5": (1e-3, 1e-4, 1e-5, 1e-7),
    "dae, RK4": (1e-4, 5e-5),
}
QUICK = ChaosExtent(exponent_cycles=3, replicates=2, cycles=26, reference=2, few=FEW)
FULL = ChaosExtent(exponent_cycles=20, replicates=4, cycles=30)


@dataclass(frozen=True)
class StatisticPoint:
    """A method with its statistics and their cost.

    Attributes
    ----------
    rates : tuple of float
        Wall time of the solve per simulated second, one a start.
    warm_up : float
        Time of compiling and loading before the first run, s.
    simulated : float
        Simulated time of all starts together, s.
    steps : int
        Accepted steps of all starts together.
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
    statistics: Mapping[str, Estimate] = field(default_factory=dict)
    step_errors: Mapping[str, StepError] = field(default_factory=dict)
    failure: str = ""

    @property
    def cost(self) -> float:
        """Median wall time per simulated second; nan where nothing was timed."""
        return median(self.rates) if self.rates else math.nan

    def and_run(self, run: Run) -> "StatisticPoint":
        """The point with what a further run took, and with how it failed."""
        told, failed = run.diagnostics, run.status == "failed"
        rate = float(told["wall_solve_s"]) / run.time if not failed else math.nan
        return replace(
            self,
            rates=self.rates if failed else (*self.rates, rate),
            warm_up=self.warm_up if self.rates else float(told["wall_compile_s"]),
            simulated=self.simulated + run.time,
            steps=self.steps + int(told["steps"]),
            failure=f"start {len(self.rates) + 1}: {run.message}" if failed else "",
        )


@dataclass(frozen=True)
class Chaos:
    """Growth of a disturbance and statistics of a scene's unworn linkage beyond the horizon.

    Attributes
    ----------
    growth : Parting
        Over the first cycle, from a start of the scene.
    exponent : Exponent or None
        The largest, 1/s; None where loops stay closed, of which there is none.
    reference, points : StatisticPoint, tuple of StatisticPoint
        The finest method, with more cycles than the others, which are compared with it.
    stage_cycles : int
        Cycles that a stage of the scene takes until its wear maps are known to the scene's
        tolerance.
    """

    growth: Parting
    exponent: Exponent | None
    reference: StatisticPoint
    points: tuple[StatisticPoint, ...]
    stage_cycles: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the statistics."""
        return tuple(self.reference.statistics)

    def honest_cycles(self, point: StatisticPoint, name: str) -> float:
        """Cycles up to which the bound of a statistic's step error is below its sampling error.

        The sampling error is the motion's own, which the finest method knows best.
        """
        return honest_cycles(self.reference.statistics[name], point.step_errors[name])

    def is_honest_in(self, point: StatisticPoint, name: str) -> bool:
        """True where a step error is not seen, and must be below a stage's sampling error."""
        enough = self.honest_cycles(point, name) >= self.stage_cycles
        return enough and not point.step_errors[name].is_seen

    def is_honest(self, point: StatisticPoint) -> bool:
        """True where a method has the statistics right that count for wear in a stage."""
        wear = filter(is_for_wear, self.names)
        return not point.failure and all(self.is_honest_in(point, name) for name in wear)

    def cheapest(self, points: Sequence[StatisticPoint] | None = None) -> StatisticPoint | None:
        """The cheapest honest setting of some, or of all; None if none is."""
        honest = filter(self.is_honest, self.points if points is None else points)
        return min(honest, key=lambda point: point.cost, default=None)

    @property
    def families(self) -> dict[str, list[StatisticPoint]]:
        """Points of each curve, from coarse to fine, failures included."""
        return grouped(self.points)


def follow(scene: Scene, extent: ChaosExtent, told: Told) -> Chaos:
    """Run a scene's unworn linkage with each method, start by start in turn.

    RunFailed where the finest method fails.
    """
    growing = part_of(told, 0.0, _GROWTH_SHARE)
    linkage, period = scene.linkage(), scene.mechanism.period
    growth = measure_growth(linkage, start_of(scene), period, 1, growing)
    is_open = isinstance(tree_of(linkage), Tree)
    exponent = scene_exponent(scene, extent.exponent_cycles) if is_open else None
    names, few = names_of(linkage), extent.few
    methods = [
        own
        for own in statistics_methods(scene)
        if few is None or own.value in few.get(own.family, ())
    ]
    points = [StatisticPoint(method) for method in (*methods, finest(scene))]
    draws = [Draws((), ()) for _ in points]
    # In turn, so that a slow minute of the machine is shared by all.  The finest method has
    # starts of its own: where it is among the others as well, it is held against other draws.
    tasks = [(start, k) for start in range(extent.replicates) for k in range(len(methods))]
    own_starts = range(extent.replicates, (1 + extent.reference) * extent.replicates)
    tasks += [(start, len(methods)) for start in own_starts]
    share = (1.0 - _GROWTH_SHARE) / len(tasks)
    for done, (start, k) in enumerate(tasks):
        if points[k].failure:
            continue
        method = points[k].method
        tell = partial(part_of(told, _GROWTH_SHARE + share * done, share), method.label)
        tell(0.0)
        plan = Plan(period, extent.cycles, 1, torques=False, trackers=(Telling(tell),))
        run = method.engine.simulate(linkage, start_of(scene, start), plan)
        points[k] = points[k].and_run(run)
        if not points[k].failure:
            # Of a run its numbers a cycle are kept, not its large series.
            draws[k] = draws[k].and_of(run.recorder, names)
    if points[-1].failure:
        raise RunFailed(f"{points[-1].method.label}: {points[-1].failure}")
    known = [
        point
        if point.failure
        else replace(
            point,
            statistics=statistics_of(names, own),
            step_errors=step_errors(names, own, draws[-1]),
        )
        for point, own in zip(points, draws, strict=True)
    ]
    return Chaos(growth, exponent, known[-1], tuple(known[:-1]), stage_cycles(scene, draws[-1]))


def stage_cycles(scene: Scene, reference: Draws) -> int:
    """Cycles until a stage of the scene knows its wear maps to the scene's tolerance."""
    if scene.cycles is not None:
        return scene.cycles * scene.draws
    maps, weights = map_batches(reference.maps)
    error = float(map_errors(maps, weights).max())
    if not math.isfinite(error):
        return scene.max_cycles
    samples = sum(run.samples for run in reference.maps)
    needed = math.ceil(samples * (error / scene.tolerance) ** 2)
    return min(max(needed, FEWEST), scene.max_cycles)
