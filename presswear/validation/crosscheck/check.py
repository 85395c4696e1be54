"""Engine against engine: Exudyn and the in-house solver from the same start.

Impacts drive neighbouring motions apart, so two engines can agree on a trajectory
only for a while.  How long is measured: the in-house solver runs twice, the second
time from a start moved by 1e-9 m along a free direction; the horizon is where the
two have parted by a thousand times as much.  Up to there positions, velocities,
touchdowns and forces are compared one by one; beyond it only means over cycles are.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import disturbed, start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.recording.observer import AdvanceObserver
from presswear.recording.statistics import Estimate, estimate
from presswear.results.provenance import provenance
from presswear.scene.scene import Scene
from presswear.validation.crosscheck.traces import (
    Difference,
    Touchdown,
    Trace,
    matched,
    parting_time,
    slider_difference,
    touchdown_differences,
    trace_of,
    velocity_difference,
)
from presswear.validation.runs import Check, Told, finished, order_of
from presswear.validation.stored import as_plain

Array = NDArray[np.float64]

DISTURBANCE = 1e-9
"""Greatest change of a coordinate of the disturbed start, m or rad."""
GROWTH = 1000.0
"""Growth of the disturbance at the horizon."""
REFERENCE_TOLERANCE = 1e-13
"""Tolerance of the in-house solver while trajectories are compared."""
FINENESS = (1, 2, 4, 8, 16)
"""Steps of Exudyn's joints model are the scene's divided by these; bounds hold for the last."""
TOLERANCE_PARTS = (1, 10, 100, 1000)
"""The tolerance of its open tree is the scene's divided by these; bounds hold for the last."""
FIRST_TOUCHDOWNS = 10
"""Touchdowns whose bounds are stated."""
CYCLES = 8
"""Cycles whose means are compared, unless the scene says how many."""
PARTS = 40
"""Parts of a run; more make the recorded series and the longest steps finer."""
SLIDER_BOUND = 1e-6
"""m, up to the horizon."""
VELOCITY_BOUND = 1e-3
"""Part of the slider's greatest speed, up to the last of the first touchdowns.

Later a bound would judge the motion: a touchdown moved by 1e-5 s shifts a velocity by much.
"""
TIME_BOUND = 1e-6
"""Bound of the first touchdowns' times, s."""
CLOSING_BOUND = 1e-4
"""Bound of their closing speeds, relative."""
FORCE_BOUND = 1e-3
"""Bound of the peak forces of the contacts that they begin, relative."""
ORDER, ORDER_BOUND = 2.0, 0.3
"""Order of Exudyn's trapezoidal rule, and how far the observed one may be from it."""
TREE_TIME_BOUND, TREE_SLIDER_BOUND = 1e-8, 1e-8
"""Bounds of the open tree at its finest: first touchdowns, s; slider up to the last of them, m."""
INTEGRATOR_BOUND = 1e-10
"""Bound of the first touchdowns' times between two in-house integrators, s."""


@dataclass(frozen=True)
class Crosscheck:
    """Outcome of a cross-check.

    Attributes
    ----------
    horizon : float
        s.
    parted : bool
        True where the trajectories parted at the horizon; else it is where the runs end.
    touchdowns : tuple of Touchdown
        Those of the reference, up to the horizon.
    differences : tuple of Difference
        The disturbed start first, then Exudyn, coarsest first.
    exudyn : tuple of str
        Models that Exudyn ran, coarsest first.
    statistics : dict
        Means over cycles of both engines.
    """

    scene: Scene
    horizon: float
    parted: bool
    checks: tuple[Check, ...]
    touchdowns: tuple[Touchdown, ...]
    differences: tuple[Difference, ...]
    exudyn: tuple[str, ...]
    statistics: dict[str, Any]

    @property
    def passed(self) -> bool:
        """True where every bound is kept."""
        return all(check.passed for check in self.checks)

    def as_dict(self) -> dict[str, Any]:
        """The outcome as plain data."""
        names = self.scene.clearance_joints
        return {
            "scene": self.scene.as_dict(),
            "provenance": provenance(),
            "horizon_s": self.horizon,
            "parted": self.parted,
            "passed": self.passed,
            "exudyn": list(self.exudyn),
            "checks": [{**asdict(check), "passed": check.passed} for check in self.checks],
            "touchdowns": [{**asdict(own), "joint": names[own.joint]} for own in self.touchdowns],
            "slider_difference_max_m": {
                curve.label: float(curve.slider[curve.time <= self.horizon].max())
                for curve in self.differences
            },
            "statistics": self.statistics,
        }


@dataclass(frozen=True)
class _Runner:
    """Runs the unworn linkage of a scene and says how far it is."""

    linkage: Linkage
    told: Told

    def run(self, word: str, start: Start, engine: Engine, plan: Plan) -> Run:
        self.told(word, 0.0)
        plan = replace(plan, observers=(AdvanceObserver(partial(self.told, word)),))
        return finished(engine.simulate(self.linkage, start, plan))

    def trace(self, word: str, start: Start, engine: Engine, end: float) -> Trace:
        return trace_of(self.run(word, start, engine, Plan(end / PARTS, PARTS, PARTS)))


def finer(engine: ExudynJoints, period: float, fineness: int) -> ExudynJoints:
    """Divide steps of a cycle of a period, s, and Newton's errors as theirs fall."""
    return replace(
        engine,
        steps_per_contact=engine.steps_per_contact * fineness,
        steps_sustained=engine.steps_sustained * fineness,
        free_step=engine.longest(period) / fineness,
        newton=engine.newton / fineness**2,
    )


def exudyn_of(scene: Scene) -> dict[str, ExudynTree | ExudynJoints]:
    """The model that Exudyn takes for a scene, from its working settings to its finest."""
    scene = replace(scene, engine="exudyn") if scene.engine == "dae" else scene
    scene = replace(scene, purpose="trajectory")
    scene.check()
    period = scene.mechanism.period
    engine = scene.solver.over(period)
    if isinstance(engine, ExudynTree):
        trees = [
            replace(engine, tree_tolerance=engine.tolerance / part) for part in TOLERANCE_PARTS
        ]
        return {f"Exudyn's tree at {tree.tree_tolerance:g}": tree for tree in trees}
    return {
        "Exudyn" if n == 1 else f"Exudyn, steps / {n}": finer(scene.numerics.joints, period, n)
        for n in FINENESS
    }


def check_engines(scene: Scene, duration: float | None, told: Told) -> Crosscheck:
    """Run and compare both engines on a scene's unworn linkage; RunFailed if one finds no way on.

    Parameters
    ----------
    duration : float or None
        Longest time over which trajectories are compared, s; None: one cycle.
    """
    end = scene.mechanism.period if duration is None else duration
    linkage, start = scene.linkage(), start_of(scene)
    runner = _Runner(linkage, told)
    precise = InHouse(integration_tolerance=REFERENCE_TOLERANCE, coordinates="all")
    other_start = disturbed(linkage, start, DISTURBANCE)
    found, curves = None, []
    if other_start is not None:
        calm = runner.trace("dae", start, precise, end)
        moved = runner.trace("dae, disturbed", other_start, precise, end)
        found = parting_time(calm, moved, GROWTH * DISTURBANCE)
        label = f"in-house, start moved by {DISTURBANCE:g} m"
        curves.append(slider_difference(label, calm, moved))
    horizon, parted = (end, False) if found is None else (found, True)
    reference = runner.trace("dae to the horizon", start, precise, horizon)
    first = reference.touchdowns[:FIRST_TOUCHDOWNS]
    engines = exudyn_of(scene)
    traces = {word: runner.trace(word, start, own, horizon) for word, own in engines.items()}
    curves += [slider_difference(word, reference, trace) for word, trace in traces.items()]
    is_tree = isinstance(next(iter(engines.values())), ExudynTree)
    checks = _exudyn_checks(is_tree, reference, traces, horizon)
    if parted:
        checks += _reported("disturbed start", reference, moved, horizon)
    if first:
        # Far enough to hold the last of the touchdowns.
        until = min(1.001 * first[-1].time, horizon)
        second = replace(precise, integrator="dopri5", coordinates="fewest")
        words = "dae with dopri5 in fewest coordinates"
        other = trace_of(runner.run(words, start, second, Plan(until, 1, 1)))
        apart = float(touchdown_differences(first, other.touchdowns)[:, 0].max())
        words = f"first {len(first)} touches, dop853 to dopri5 in fewest coordinates"
        checks.append(Check(words, apart, INTEGRATOR_BOUND, "s"))
    statistics: dict[str, Any] = {}
    if parted:
        beyond, statistics = _check_means(scene, start, runner)
        checks += beyond
    return Crosscheck(
        scene,
        horizon,
        parted,
        tuple(checks),
        reference.touchdowns,
        tuple(curves),
        tuple(engines),
        statistics,
    )


def _exudyn_checks(
    is_tree: bool, reference: Trace, traces: Mapping[str, Trace], horizon: float
) -> list[Check]:
    """Check Exudyn, ever finer, against the reference up to the horizon."""
    first = reference.touchdowns[:FIRST_TOUCHDOWNS]
    apart = [touchdown_differences(first, trace.touchdowns) for trace in traces.values()]
    curves = [slider_difference(name, reference, trace) for name, trace in traces.items()]
    name, finest = list(traces.items())[-1]
    distance = curves[-1].slider
    checks = [Check(f"{name}: slider", float(distance.max()), SLIDER_BOUND, "m")]
    if first:
        last = first[-1].time
        times, speeds, forces = apart[-1].max(axis=0).tolist()
        speed = velocity_difference(reference, finest, last)
        time_bound = TREE_TIME_BOUND if is_tree else TIME_BOUND
        count = f"{name}: first {len(first)}"
        checks += [
            Check(f"{count} touches, times", times, time_bound, "s"),
            Check(f"{count} closing speeds", speeds, CLOSING_BOUND, "relative"),
            Check(f"{count} peak forces", forces, FORCE_BOUND, "relative"),
            Check(f"{name}: velocity to touch {len(first)}", speed, VELOCITY_BOUND, "relative"),
            *_reported(name, reference, finest, horizon),
        ]
        if is_tree:
            early = float(distance[curves[-1].time <= last].max())
            words = f"{name}: slider to touch {len(first)}"
            checks.append(Check(words, early, TREE_SLIDER_BOUND, "m"))
    if not is_tree:
        # Where nothing touches, the slider's distance has the order.
        errors = [float(own.slider.max()) for own in curves]
        if first:
            errors = [float(np.sqrt(np.mean(own[:, 0] ** 2))) for own in apart]
        order = -order_of(FINENESS, errors)
        words = f"Exudyn's order {order:.2f}, from 2"
        checks.append(Check(words, abs(order - ORDER), ORDER_BOUND))
    return checks


def _reported(name: str, reference: Trace, trace: Trace, end: float) -> list[Check]:
    """Report differences up to the horizon, where no bound could be kept by any solver."""
    # A touchdown just before the horizon may come just behind it in the other run.
    apart = [
        abs(twin.time - own.time)
        for own, twin in matched(reference.touchdowns, trace.touchdowns)
        if twin is not None
    ]
    speed = velocity_difference(reference, trace, end)
    return [
        Check(f"{name}: slider velocity", speed, None, "relative"),
        Check(f"{name}: {len(apart)} touches, times", max(apart, default=math.nan), None, "s"),
    ]


def _check_means(scene: Scene, start: Start, runner: _Runner) -> tuple[list[Check], dict[str, Any]]:
    """Check means over cycles of both engines: their 95 % intervals must overlap."""
    cycles = CYCLES if scene.cycles is None else scene.cycles
    plan = Plan(scene.mechanism.period, cycles, recorded_cycles=1)
    # Name in a recorder's cycles, joint, and unit.
    quantities: dict[str, tuple[str, int | None, str]] = {
        "greatest slider velocity": ("velocity_max", None, "m/s"),
        "greatest slider acceleration": ("acceleration_max", None, "m/s^2"),
    }
    for k, joint in enumerate(scene.clearance_joints):
        quantities[f"peak force in {joint}"] = ("force_max", k, "N")
        quantities[f"dose of wear in {joint}"] = ("load_distance", k, "N m")
    means: dict[str, dict[str, Estimate]] = {}
    exudyn = next(iter(exudyn_of(scene).values()))
    for word, engine in (("dae", scene.numerics.dae), ("Exudyn", exudyn)):
        recorder = runner.run(f"{word}, {cycles} cycles", start, engine, plan).recorder
        means[word.lower()] = {
            quantity: estimate(recorder.each_cycle(name, k))
            for quantity, (name, k, _) in quantities.items()
        }
    checks = []
    for quantity, (*_, unit) in quantities.items():
        one, other = (found[quantity] for found in means.values())
        bound = None  # one cycle alone has no interval
        if one.half_width is not None and other.half_width is not None:
            bound = one.half_width + other.half_width
        checks.append(Check(f"mean {quantity}", abs(one.mean - other.mean), bound, unit))
    return checks, as_plain(means)
