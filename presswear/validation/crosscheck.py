"""Comparison of Exudyn with the in-house solver from the same initial state.

Impacts separate neighbouring motions, so that two engines agree on a trajectory only
for a limited time. The in-house solver measures it: it runs twice, the second time from
a state moved by 1e-9 m along a free direction. The horizon is the time at which the two
have separated a thousandfold. Positions, velocities, touchdowns and forces are compared
one by one up to it, and means over cycles beyond it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from statistics import NormalDist
from typing import Any

import matplotlib
import numpy as np
from scipy.interpolate import CubicHermiteSpline

from presswear.campaign.replicates import disturbed, start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.recording.statistics import Estimate, pooled
from presswear.results.folder import provenance
from presswear.scene.scene import Scene
from presswear.show.figures import style
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable
from presswear.validation.cases import Check, Progress, contacts_of, finished, order_of

# largest change of a coordinate of the disturbed initial state, m or rad
DISTURBANCE = 1e-9
GROWTH = 1000.0  # of the disturbance at the horizon
REFERENCE_TOLERANCE = 1e-13  # of the in-house solver while trajectories are compared
# divide the steps of exudyn-joints; bounds apply to the last
FINENESS = (1, 2, 4, 8, 16)
# divide the tolerance of the tree; bounds apply to the last
TOLERANCE_PARTS = (1, 10, 100, 1000)
FIRST_TOUCHDOWNS = 10  # touchdowns with bounds
CYCLES = 50  # whose means are compared, unless the scene has a number
MEAN_BOUND = 0.1  # of the relative difference of two means
PARTS = 40  # of a run; more make the recorded series and the longest steps finer
GRID = 2001  # common times at which series are compared
SLIDER_BOUND = 1e-6  # m, up to the horizon
# Relative to the largest speed, up to the last of the first touchdowns. Later a bound
# would judge the motion: a touchdown moved by 1e-5 s changes a velocity by much.
VELOCITY_BOUND = 1e-3
TIME_BOUND = 1e-6  # s, of the first touchdowns
CLOSING_BOUND = 1e-4  # relative, of their closing speeds
FORCE_BOUND = 1e-3  # relative, of their peak forces
ORDER = 2.0  # of Exudyn's trapezoidal rule
ORDER_BOUND = 0.3
# Of the tree up to the last of them
TREE_TIME_BOUND = 1e-8  # s
TREE_SLIDER_BOUND = 1e-8  # m
INTEGRATOR_BOUND = 1e-10  # s, of the first touchdowns between two in-house integrators


# numbers of a touchdown, SI
TOUCHDOWN = ("joint", "time", "closing_speed", "peak_force")
Means = dict[str, dict[str, Estimate]]  # by engine and quantity


@dataclass(frozen=True)
class Trajectory:
    """Recorded series that are compared."""

    time: Array  # s, shape (n,)
    # position along the recorded direction, m, and velocity, m/s; shape (n, 2)
    slider: Array
    eccentricity: Array  # m, shape (n, 2 joints)
    # see ``TOUCHDOWN``, shape (touchdowns, 4), in the order of their times
    touchdowns: Array


def touchdowns_of(run: Run) -> Array:
    """Return the touchdowns of all recorded contacts, and of those that last to the end."""
    rows = []
    records = run.recorder.records
    for k, last in enumerate(records.memory):
        contacts = contacts_of(run, k)
        columns = (
            contacts[name] for name in ("touchdown", "closing_speed", "peak_force")
        )
        rows += [(k, *row) for row in zip(*columns, strict=True)]
        if records.onset[k] > 0.0 and not last["started_closed"]:
            rows.append(
                (k, last["touchdown_time"], records.onset[k], last["peak_force"])
            )
    touchdowns = np.array(rows, float).reshape(-1, len(TOUCHDOWN))
    return touchdowns[np.argsort(touchdowns[:, 1], kind="stable")]


def slider_difference(one: Trajectory, two: Trajectory) -> Array:
    """Return the distances of two sliders at evenly spaced common times, shape (n, 3).

    Columns are time, s, distance, m, and difference of the velocities, m/s.
    """
    time = np.linspace(0.0, min(one.time[-1], two.time[-1]), GRID)
    first, second = (
        CubicHermiteSpline(each.time, *each.slider.T) for each in (one, two)
    )
    speed = np.abs(first(time, 1) - second(time, 1))
    return np.column_stack([time, np.abs(first(time) - second(time)), speed])


def touchdown_differences(reference: Array, compared: Array) -> Array:
    """Return the differences of touchdowns with the same number in the same joint, shape (n, 3).

    They are time, s, and relative closing speed and peak force; infinite for a
    touchdown that the compared run lacks.
    """
    differences = np.full((len(reference), 3), math.inf)
    for joint in np.unique(reference[:, 0]):
        twins = compared[compared[:, 0] == joint]
        rows = np.flatnonzero(reference[:, 0] == joint)
        rows = rows[: len(twins)]
        twins = twins[: len(rows), 1:]
        ours = reference[rows, 1:]
        differences[rows, 0] = twins[:, 0] - ours[:, 0]
        differences[rows, 1:] = twins[:, 1:] / ours[:, 1:] - 1.0
    return np.abs(differences)


def divergence_time(one: Trajectory, two: Trajectory, distance: float) -> float | None:
    """Return the time, s, at which slider or eccentricities first differ by a distance, m."""
    time, largest, _ = slider_difference(one, two).T
    for first, second in zip(one.eccentricity.T, two.eccentricity.T, strict=True):
        between = np.interp(time, one.time, first) - np.interp(time, two.time, second)
        largest = np.maximum(largest, np.abs(between))
    late = np.flatnonzero(largest >= distance)
    return float(time[late[0]]) if late.size else None


class _Runner:
    """Runs of the unworn linkage of a scene, with their progress."""

    def __init__(self, scene: Scene, report: Progress) -> None:
        self.linkage = scene.linkage()
        self.start = start_of(scene)
        self.report = report
        # None: no free direction
        self.moved = disturbed(self.linkage, self.start, DISTURBANCE)

    def run(self, word: str, engine: Engine, plan: Plan, moved: bool = False) -> Run:
        """Run from the start, or from the disturbed start; RunFailed if the run fails."""
        self.report(word, 0.0)
        start = (moved and self.moved) or self.start
        plan = replace(plan, report=lambda part, recorder: self.report(word, part))
        return finished(engine.simulate(self.linkage, start, plan))

    def trajectory(
        self, word: str, engine: Engine, end: float, moved: bool = False
    ) -> Trajectory:
        run = self.run(
            word, engine, Plan(end / PARTS, PARTS, PARTS, by_clock=True), moved
        )
        recorder = run.recorder
        records = run.recorder.records
        # The series holds displacements, and a disturbed initial state is displaced
        # already.
        position = recorder.series("displacement") + float(records.output["start"][0])
        names = ("eccentricity_x", "eccentricity_y")
        series = [
            recorder.series(n, k) for k in range(records.memory.size) for n in names
        ]
        return Trajectory(
            recorder.series("time").copy(),
            np.column_stack([position, recorder.series("velocity")]),
            np.array(series).reshape(-1, position.size).T,
            touchdowns_of(run),
        )

    def separation(
        self, engine: Engine, end: float
    ) -> tuple[float | None, Trajectory, Trajectory] | None:
        """Return the horizon, s, and both trajectories; None if no direction is free.

        The horizon is None if the trajectories stay together up to ``end``, s.
        """
        if self.moved is None:
            return None
        first = self.trajectory("dae", engine, end)
        second = self.trajectory("dae, disturbed", engine, end, moved=True)
        return divergence_time(first, second, GROWTH * DISTURBANCE), first, second


def horizon(scene: Scene, engine: Engine, longest: float, report: Progress) -> float:
    """Return the time up to which trajectories of a scene can be compared, s, at most a cycle."""
    end = min(scene.mechanism.period, longest)
    separation = _Runner(scene, report).separation(engine, end)
    return end if separation is None or separation[0] is None else separation[0]


@dataclass(frozen=True)
class Crosscheck:
    """Result of a cross-check."""

    scene: Scene
    horizon: float  # s
    # whether trajectories diverged at the horizon; else it is the end of the runs
    diverged: bool
    checks: tuple[Check, ...]
    # differences of means whose intervals are too wide for a verdict
    undecided: tuple[str, ...]
    touchdowns: Array  # of the reference up to the horizon
    # See `slider_difference`: the disturbed initial state, then Exudyn, coarsest first.
    differences: Mapping[str, Array]
    statistics: Means  # over cycles

    @property
    def passed(self) -> bool:
        """True if every check passed."""
        return all(check.passed for check in self.checks)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        names = self.scene.clearance_joints
        return {
            "scene": self.scene.as_dict(),
            "provenance": provenance(),
            "horizon_s": self.horizon,
            "diverged": self.diverged,
            "passed": self.passed,
            "undecided": self.undecided,
            "checks": [{**asdict(each), "passed": each.passed} for each in self.checks],
            "touchdowns": [
                {**dict(zip(TOUCHDOWN, row, strict=True)), "joint": names[int(row[0])]}
                for row in self.touchdowns.tolist()
            ],
            "statistics": self.statistics,
        }


def exudyn_of(scene: Scene) -> dict[str, Engine]:
    """Return the model of Exudyn for a scene, from its default settings to the finest."""
    scene = replace(scene, engine="exudyn") if scene.engine == "dae" else scene
    scene = replace(scene, purpose="trajectory")
    scene.check()
    period = scene.mechanism.period
    engine = scene.solver.for_cycle(period)
    if isinstance(engine, ExudynTree):
        tolerances = [engine.tolerance / part for part in TOLERANCE_PARTS]
        return {
            f"Exudyn's tree at {t:g}": replace(engine, tree_tolerance=t)
            for t in tolerances
        }
    return {
        f"Exudyn{f', steps / {n}' if n > 1 else ''}": finer_joints(
            scene.numerics.joints, n, period
        )
        for n in FINENESS
    }


def finer_joints(joints: ExudynJoints, factor: float, period: float) -> ExudynJoints:
    """Return ``exudyn-joints`` with all steps shorter by a factor; a cycle lasts a period, s."""
    return replace(
        joints,
        steps_per_contact=round(joints.steps_per_contact * factor),
        steps_sustained=max(5, round(joints.steps_sustained * factor)),
        free_step=joints.longest(period) / factor,
        newton=joints.newton / max(factor, 1.0) ** 2,
    )


def check_engines(scene: Scene, duration: float | None, report: Progress) -> Crosscheck:
    """Run and compare both engines on the unworn linkage of a scene; RunFailed if a run fails.

    Trajectories are compared over at most a duration, s; None: one cycle.
    """
    end = scene.mechanism.period if duration is None else duration
    runner = _Runner(scene, report)
    precise = InHouse(integration_tolerance=REFERENCE_TOLERANCE, coordinates="all")
    separation = runner.separation(precise, end)
    curves = {}
    diverged = False
    if separation is not None:
        time, calm, moved = separation
        diverged = time is not None
        end = time or end
        curves[f"in-house, start moved by {DISTURBANCE:g} m"] = slider_difference(
            calm, moved
        )
    reference = runner.trajectory("dae to the horizon", precise, end)
    engines = exudyn_of(scene)
    compared = {
        word: runner.trajectory(word, engine, end) for word, engine in engines.items()
    }
    distances = {
        word: slider_difference(reference, each) for word, each in compared.items()
    }
    is_tree = isinstance(next(iter(engines.values())), ExudynTree)
    checks = [*_exudyn_checks(is_tree, reference, compared, distances)]
    if len(first := reference.touchdowns[:FIRST_TOUCHDOWNS]):
        # Far enough to include the last of the touchdowns.
        plan = Plan(min(1.001 * first[-1, 1], end), 1, 1, by_clock=True)
        second = replace(precise, integrator="dopri5", coordinates="fewest")
        run = runner.run("dae with dopri5 in fewest coordinates", second, plan)
        largest = float(touchdown_differences(first, touchdowns_of(run))[:, 0].max())
        words = f"first {len(first)} touches, dop853 to dopri5 in fewest coordinates"
        checks.append(Check(words, largest, INTEGRATOR_BOUND, "s"))
    beyond, undecided, statistics = (
        _check_means(scene, runner) if diverged else ([], [], {})
    )
    every = (*checks, *beyond)
    curves = curves | distances
    return Crosscheck(
        scene,
        end,
        diverged,
        every,
        tuple(undecided),
        reference.touchdowns,
        curves,
        statistics,
    )


def _exudyn_checks(
    is_tree: bool,
    reference: Trajectory,
    compared: Mapping[str, Trajectory],
    distances: Mapping[str, Array],
) -> Iterator[Check]:
    """Check the finest run of Exudyn against the reference, and the order of all runs."""
    first = reference.touchdowns[:FIRST_TOUCHDOWNS]
    name = list(compared)[-1]
    differences = [
        touchdown_differences(first, each.touchdowns) for each in compared.values()
    ]
    time, distance, speed = distances[name].T
    yield Check(f"{name}: slider", float(distance.max()), SLIDER_BOUND, "m")
    if len(first):
        early = time <= first[-1, 1]
        count = f"{name}: first {len(first)}"
        times, speeds, forces = differences[-1].max(axis=0).tolist()
        largest = float(speed[early].max() / np.abs(reference.slider[:, 1]).max())
        time_bound = TREE_TIME_BOUND if is_tree else TIME_BOUND
        yield Check(f"{count} touches, times", times, time_bound, "s")
        yield Check(f"{count} closing speeds", speeds, CLOSING_BOUND, "relative")
        yield Check(f"{count} peak forces", forces, FORCE_BOUND, "relative")
        yield Check(
            f"{name}: velocity to touch {len(first)}",
            largest,
            VELOCITY_BOUND,
            "relative",
        )
        if is_tree:
            words = f"{name}: slider to touch {len(first)}"
            yield Check(words, float(distance[early].max()), TREE_SLIDER_BOUND, "m")
    if not is_tree:
        # Without touchdowns, the distance of the slider has the order.
        errors = [each[:, 1].max() for each in distances.values()]
        if len(first):
            errors = [np.sqrt(np.mean(each[:, 0] ** 2)) for each in differences]
        order = -order_of(FINENESS, errors)
        yield Check(
            f"Exudyn's order {order:.2f}, from 2", abs(order - ORDER), ORDER_BOUND
        )


def _check_means(scene: Scene, runner: _Runner) -> tuple[list[Check], list[str], Means]:
    """Compare means over cycles of both engines; see ``mean_check``."""
    cycles = CYCLES if scene.cycles is None else scene.cycles
    plan = Plan(scene.mechanism.period, cycles, recorded_cycles=1)
    # By quantity: its name in the cycles of a recorder, and the joint.
    quantities: dict[str, tuple[str, int | None]] = {
        "greatest slider velocity": ("velocity_max", None),
        "greatest slider acceleration": ("acceleration_max", None),
    }
    for k, joint in enumerate(scene.clearance_joints):
        quantities[f"peak force in {joint}"] = "force_max", k
        quantities[f"load distance in {joint}"] = "load_distance", k
    means: Means = {}
    exudyn = next(iter(exudyn_of(scene).values()))
    for word, engine in (("dae", scene.numerics.dae), ("Exudyn", exudyn)):
        cycle = runner.run(f"{word}, {cycles} cycles", engine, plan).recorder.each_cycle
        means[word.lower()] = {
            key: pooled([cycle(name, k)])[0] for key, (name, k) in quantities.items()
        }
    checks = list[Check]()
    undecided = list[str]()
    for quantity in quantities:
        one, two = (each[quantity] for each in means.values())
        compared = mean_check(quantity, one, two, len(quantities))
        if isinstance(compared, Check):
            checks.append(compared)
        else:
            undecided.append(compared)
    return checks, undecided, means


def mean_check(
    quantity: str, one: Estimate, two: Estimate, count: int = 1
) -> Check | str:
    """Check the relative difference of two means, or say that their intervals are too wide.

    The check passes if the 95 % interval of the difference lies within ``MEAN_BOUND``.
    It misses if the interval lies beyond it that holds for all of ``count`` comparisons
    with 95 % (Bonferroni). Otherwise there is no verdict. The checked number is the end
    of the interval that decides.
    """
    size = 0.5 * (abs(one.mean) + abs(two.mean))
    if one.half_width is None or two.half_width is None or size == 0.0:
        return f"mean {quantity}: no verdict, too few cycles"
    difference = abs(one.mean - two.mean) / size
    half = math.hypot(one.half_width, two.half_width) / size
    if difference + half <= MEAN_BOUND:
        return Check(f"mean {quantity}", difference + half, MEAN_BOUND, "relative")
    quantile = NormalDist().inv_cdf
    of_all = half * quantile(1.0 - 0.025 / count) / quantile(0.975)
    if difference - of_all > MEAN_BOUND:
        return Check(f"mean {quantity}", difference - of_all, MEAN_BOUND, "relative")
    parts = f"{readable(100.0 * difference, 2)} ± {readable(100.0 * half, 2)} %"
    return f"mean {quantity}: no verdict, difference {parts}"


_COLOURS = (style.MUTED, "#56B4E9", "#0072B2", "#009E73", "#E69F00", "#D55E00")


@matplotlib.rc_context(style.SETTINGS)
def draw_differences(result: Crosscheck) -> style.Drawing:
    """Draw the distance of the slider from the reference over time, up to 1.5 horizons."""
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    end = max(float(curve[-1, 0]) for curve in result.differences.values())
    end = min(end, 1.5 * result.horizon)
    for (label, curve), colour in zip(
        result.differences.items(), _COLOURS, strict=False
    ):
        shown = curve[
            (curve[:, 0] <= end) & (curve[:, 1] > 0.0)
        ]  # a logarithm shows no zeros
        axes.semilogy(*shown[:, :2].T, color=colour, linewidth=0.9, label=label)
    axes.axhline(
        SLIDER_BOUND, color=style.REFERENCE, linewidth=0.7, linestyle=(0.0, (4.0, 2.0))
    )
    axes.text(0.0, SLIDER_BOUND, " bound", va="bottom", ha="left")
    if result.diverged:
        axes.axvline(result.horizon, color=style.REFERENCE, linewidth=0.7)
        side = "left" if result.horizon < 0.7 * end else "right"
        place = (result.horizon, 0.02)
        text_style: dict[str, Any] = {
            "transform": axes.get_xaxis_transform(),
            "va": "bottom",
        }
        axes.text(*place, f" horizon: grown {GROWTH:g} times ", ha=side, **text_style)
    label = "distance of the slider from the\nin-house reference (m)"
    axes.set(xlim=(0.0, end), xlabel="time (s)", ylabel=label)
    sheet.legend(loc="outside upper center", ncols=3)
    return style.finished("difference", sheet)[0]
