"""Engine against engine: Exudyn and the in-house solver from the same start.

Impacts drive neighbouring motions apart, so two engines can agree on a trajectory
only for a while.  How long is measured: the in-house solver runs twice, the second
time from a start moved by 1e-9 m along a free direction; the horizon is where the
two have parted by a thousand times as much.  Up to there positions, velocities,
touches and forces are compared one by one; beyond it only means over cycles are.
"""

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import disturbed, start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.elements import Linkage
from presswear.record.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.record.sampling import Estimate, estimate
from presswear.record.tracker import Telling
from presswear.results.provenance import provenance
from presswear.results.result import plain
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import write_whole
from presswear.trials.crosscheck.traces import (
    Difference,
    Touch,
    Trace,
    matched,
    parting_time,
    slider_difference,
    touch_differences,
    trace_of,
    velocity_difference,
)

Array = NDArray[np.float64]
Progress = Callable[[str, float], None]
"""Told what is being run and which part of it is done, 0 .. 1."""

DISTURBANCE = 1e-9
"""Greatest change of a coordinate of the disturbed start, m or rad."""
GROWTH = 1000.0
"""Growth of the disturbance at the horizon."""
REFERENCE_TOLERANCE = 1e-13
"""Of the in-house solver while trajectories are compared."""
FINENESS = (1, 2, 4, 8, 16)
"""Steps of Exudyn's joints model are the scene's divided by these; bounds hold for the last."""
TOLERANCE_PARTS = (1, 10, 100, 1000)
"""The tolerance of its open tree is the scene's divided by these; bounds hold for the last."""
FIRST_TOUCHES = 10
"""Touches whose bounds are stated."""
CYCLES = 8
"""Cycles whose means are compared, unless the scene says how many."""
PARTS = 40
"""Parts of a run; more make the recorded series and the longest steps finer."""
SLIDER_BOUND = 1e-6
"""m, up to the horizon."""
VELOCITY_BOUND = 1e-3
"""Part of the slider's greatest speed, up to the last of the first touches.

Later a bound would judge the motion: a touch moved by 1e-5 s shifts a velocity by much.
"""
TIME_BOUND = 1e-6
"""Of the first touches, s."""
CLOSING_BOUND = 1e-4
"""Of the first touches, part of their closing speed."""
FORCE_BOUND = 1e-3
"""Of the first touches, part of their peak force."""
ORDER, ORDER_BOUND = 2.0, 0.3
"""Order of Exudyn's trapezoidal rule, and how far the observed one may be from it."""
TREE_TIME_BOUND, TREE_SLIDER_BOUND = 1e-8, 1e-8
"""Of the open tree at its finest: first touches, s, and slider up to the last of them, m."""
INTEGRATOR_BOUND = 1e-10
"""Of the first touches between two in-house integrators, s."""


@dataclass(frozen=True)
class Check:
    """A difference with its bound; without a bound it is only reported."""

    quantity: str
    difference: float
    bound: float | None
    unit: str

    @property
    def passed(self) -> bool:
        """Whether the difference is a number within the bound."""
        return self.bound is None or bool(self.difference <= self.bound)


@dataclass(frozen=True)
class Crosscheck:
    """Outcome of a cross-check.

    Attributes
    ----------
    horizon : float
        s.
    parted : bool
        Whether the trajectories parted at the horizon; else it is where the runs end.
    checks : tuple of Check
    touches : tuple of Touch
        Of the reference, up to the horizon.
    differences : tuple of Difference
        The disturbed start first, then Exudyn, coarsest first.
    statistics : dict
        Means over cycles of both engines.
    """

    scene: Scene
    horizon: float
    parted: bool
    checks: tuple[Check, ...]
    touches: tuple[Touch, ...]
    differences: tuple[Difference, ...]
    statistics: dict[str, Any]

    @property
    def passed(self) -> bool:
        """Whether every bound is kept."""
        return all(check.passed for check in self.checks)


@dataclass(frozen=True)
class _Runner:
    """Runs the unworn linkage of a scene and says how far it is."""

    linkage: Linkage
    progress: Progress

    def run(self, word: str, start: Start, accuracy: Engine, plan: Plan) -> Run:
        def told(part: float) -> None:
            self.progress(word, part)

        told(0.0)
        return accuracy.simulate(self.linkage, start, replace(plan, trackers=(Telling(told),)))

    def trace(self, word: str, start: Start, accuracy: Engine, end: float) -> Trace:
        return trace_of(self.run(word, start, accuracy, Plan(end / PARTS, PARTS, PARTS)))


def finer(accuracy: ExudynJoints, period: float, fineness: int) -> ExudynJoints:
    """Steps of a cycle of a period, s, divided, with Newton's errors divided as theirs are."""
    return replace(
        accuracy,
        steps_per_contact=accuracy.steps_per_contact * fineness,
        steps_sustained=accuracy.steps_sustained * fineness,
        free_step=accuracy.longest(period) / fineness,
        newton=accuracy.newton / fineness**2,
    )


@dataclass(frozen=True)
class Ladder:
    """An Exudyn model from its working accuracy to its finest.

    Attributes
    ----------
    rungs : tuple
        Label and accuracy of each.
    time_bound : float
        Of the first touches at the finest, s.
    fineness : tuple of int or None
        What the steps are divided by, where the error has a known order in them.
    """

    rungs: tuple[tuple[str, ExudynTree | ExudynJoints], ...]
    time_bound: float
    fineness: tuple[int, ...] | None


def ladder_of(scene: Scene) -> Ladder:
    """Of the model that Exudyn takes for the scene."""
    scene = replace(scene, engine="exudyn") if scene.engine == "dae" else scene
    accuracy = scene.solver.over(scene.mechanism.period)
    if isinstance(accuracy, ExudynTree):
        tree = tuple(
            (
                f"Exudyn's tree at {accuracy.tree_tolerance / parts:g}",
                replace(accuracy, tree_tolerance=accuracy.tree_tolerance / parts),
            )
            for parts in TOLERANCE_PARTS
        )
        return Ladder(tree, TREE_TIME_BOUND, None)
    period = scene.mechanism.period
    joints = tuple(
        (
            "Exudyn" if n == 1 else f"Exudyn, steps / {n}",
            finer(scene.numerics.joints, period, n),
        )
        for n in FINENESS
    )
    return Ladder(joints, TIME_BOUND, FINENESS)


def observed_order(fineness: tuple[int, ...], errors: list[float]) -> float:
    """Order at which errors fall with the step: slope of a line through the logarithms."""
    if not np.all(np.isfinite(errors)) or min(errors) <= 0.0:
        return math.nan
    return -float(np.polyfit(np.log(fineness), np.log(errors), 1)[0])


def check_engines(scene: Scene, duration: float | None, progress: Progress) -> Crosscheck:
    """Run and compare both engines on the unworn linkage of a scene.

    Parameters
    ----------
    duration : float or None
        Longest time over which trajectories are compared, s; None: one cycle.

    Raises
    ------
    RunFailed
        Where an engine finds no way on.
    """
    end = scene.mechanism.period if duration is None else duration
    if not (math.isfinite(end) and end > 0.0):
        raise InputError(f"duration = {end:g} s: a time above 0 is expected")
    linkage, start = scene.linkage(), start_of(scene)
    runner = _Runner(linkage, progress)
    precise = InHouse(integration_tolerance=REFERENCE_TOLERANCE)
    other_start = disturbed(linkage, start, DISTURBANCE)
    horizon, parted = end, False
    differences = []
    if other_start is not None:
        calm_run = runner.trace("dae", start, precise, end)
        moved_run = runner.trace("dae, disturbed", other_start, precise, end)
        found = parting_time(calm_run, moved_run, GROWTH * DISTURBANCE)
        horizon, parted = (end, False) if found is None else (found, True)
        label = f"in-house, start moved by {DISTURBANCE:g} m"
        differences.append(slider_difference(label, calm_run, moved_run))
    reference = runner.trace("dae to the horizon", start, precise, horizon)
    first = reference.touches[:FIRST_TOUCHES]
    checks, exudyn = _check_exudyn(scene, start, runner, reference, horizon)
    differences += exudyn
    if parted:
        checks += _reported("disturbed start", reference, moved_run, horizon)
    if first:
        # Far enough to hold the last of the touches.
        until = min(1.001 * first[-1].onset, horizon)
        second = replace(precise, integrator="dopri5")
        other = runner.run("dae with dopri5", start, second, Plan(until, 1, 1))
        apart = float(touch_differences(first, trace_of(other).touches)[:, 0].max())
        checks.append(
            Check(f"first {len(first)} touches, dop853 to dopri5", apart, INTEGRATOR_BOUND, "s")
        )
    statistics: dict[str, Any] = {}
    if parted:
        beyond, statistics = _check_means(scene, start, runner)
        checks += beyond
    return Crosscheck(
        scene,
        horizon,
        parted,
        tuple(checks),
        reference.touches,
        tuple(differences),
        statistics,
    )


def _check_exudyn(
    scene: Scene, start: Start, runner: _Runner, reference: Trace, horizon: float
) -> tuple[list[Check], list[Difference]]:
    """Exudyn, ever finer, against the reference up to the horizon."""
    first = reference.touches[:FIRST_TOUCHES]
    ladder = ladder_of(scene)
    differences: list[Difference] = []
    errors: list[float] = []
    for word, accuracy in ladder.rungs:
        trace = runner.trace(word, start, accuracy, horizon)
        differences.append(slider_difference(word, reference, trace))
        apart = touch_differences(first, trace.touches)
        errors.append(
            float(np.sqrt(np.mean(apart[:, 0] ** 2)))
            if first
            else float(differences[-1].slider.max())
        )
    name = ladder.rungs[-1][0]
    slider = differences[-1]
    checks = [Check(f"{name}: slider", float(slider.slider.max()), SLIDER_BOUND, "m")]
    if first:
        count = f"{name}: first {len(first)}"
        largest = apart.max(axis=0).tolist()
        speed = velocity_difference(reference, trace, first[-1].onset)
        checks += [
            Check(f"{count} touches, times", largest[0], ladder.time_bound, "s"),
            Check(f"{count} closing speeds", largest[1], CLOSING_BOUND, "relative"),
            Check(f"{count} peak forces", largest[2], FORCE_BOUND, "relative"),
            Check(f"{name}: velocity to touch {len(first)}", speed, VELOCITY_BOUND, "relative"),
            *_reported(name, reference, trace, horizon),
        ]
    if ladder.fineness is None:
        if first:
            early = float(slider.slider[slider.time <= first[-1].onset].max())
            words = f"{name}: slider to touch {len(first)}"
            checks.append(Check(words, early, TREE_SLIDER_BOUND, "m"))
    else:
        order = observed_order(ladder.fineness, errors)
        words = f"Exudyn's order {order:.2f}, from 2"
        checks.append(Check(words, abs(order - ORDER), ORDER_BOUND, ""))
    return checks, differences


def _reported(name: str, reference: Trace, trace: Trace, end: float) -> list[Check]:
    """What is reported up to the horizon, where no bound could be kept by any solver."""
    # A touch just before the horizon may come just behind it in the other run.
    apart = [
        abs(twin.onset - touch.onset)
        for touch, twin in matched(reference.touches, trace.touches)
        if twin is not None
    ]
    return [
        Check(
            f"{name}: slider velocity", velocity_difference(reference, trace, end), None, "relative"
        ),
        Check(f"{name}: {len(apart)} touches, times", max(apart, default=math.nan), None, "s"),
    ]


def _check_means(scene: Scene, start: Start, runner: _Runner) -> tuple[list[Check], dict[str, Any]]:
    """Means over cycles of both engines: their 95 % intervals must overlap."""
    cycles = CYCLES if scene.cycles is None else scene.cycles
    plan = Plan(scene.mechanism.period, cycles, recorded_cycles=1)
    means: list[dict[str, Estimate]] = []
    for engine, accuracy in (
        ("dae", scene.numerics.dae),
        ("Exudyn", ladder_of(scene).rungs[0][1]),
    ):
        run = runner.run(f"{engine}, {cycles} cycles", start, accuracy, plan)
        if run.status == "failed":
            raise RunFailed(run.message)
        rows = np.array(run.recorder.cycles)
        means.append(
            {
                quantity: estimate(rows[:, column])
                for quantity, (column, _) in mean_columns(runner.linkage).items()
            }
        )
    checks = []
    for quantity, (_, unit) in mean_columns(runner.linkage).items():
        one, other = (found[quantity] for found in means)
        # One cycle alone has no interval.
        bound = (
            None
            if one.half_width is None or other.half_width is None
            else one.half_width + other.half_width
        )
        checks.append(Check(f"mean {quantity}", abs(one.mean - other.mean), bound, unit))
    named = zip(("dae", "exudyn"), means, strict=True)
    return checks, {
        engine: {quantity: asdict(mean) for quantity, mean in found.items()}
        for engine, found in named
    }


def mean_columns(linkage: Linkage) -> dict[str, tuple[int, str]]:
    """Column of the account's cycles and unit of each quantity whose means are compared."""
    columns = {
        "greatest slider velocity": (CYCLE_FIXED.index("velocity_max"), "m/s"),
        "greatest slider acceleration": (CYCLE_FIXED.index("acceleration_max"), "m/s^2"),
    }
    for k, joint in enumerate(linkage.clearances):
        base = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
        columns[f"peak force in {joint.name}"] = (base + CYCLE_JOINT.index("force_max"), "N")
        columns[f"dose of wear in {joint.name}"] = (base + CYCLE_JOINT.index("dose"), "N m")
    return columns


def document_of(outcome: Crosscheck) -> Mapping[str, Any]:
    """The outcome as plain data."""
    names = [joint.name for joint in outcome.scene.linkage().clearances]
    return {
        "scene": outcome.scene.as_dict(),
        "provenance": provenance(),
        "horizon_s": outcome.horizon,
        "parted": outcome.parted,
        "passed": outcome.passed,
        "exudyn": [label for label, _ in ladder_of(outcome.scene).rungs],
        "checks": [{**asdict(check), "passed": check.passed} for check in outcome.checks],
        "touches": [{**asdict(touch), "joint": names[touch.joint]} for touch in outcome.touches],
        "slider_difference_max_m": {
            curve.label: float(curve.slider[curve.time <= outcome.horizon].max())
            for curve in outcome.differences
        },
        "statistics": outcome.statistics,
    }


def store(outcome: Crosscheck, folder: Path) -> None:
    """Write ``crosscheck.json`` into a folder, which is made where needed."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(plain(document_of(outcome)), indent=1, allow_nan=False)

    def write(file: BinaryIO) -> None:
        file.write(text.encode())

    write_whole(folder / "crosscheck.json", write)
