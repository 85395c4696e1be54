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
from presswear.results.provenance import provenance
from presswear.scene.scene import Scene
from presswear.show.figures import style
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable
from presswear.validation.cases import Check, Progress, contacts_of, finished, order_of

# Largest change of a coordinate of the disturbed initial state, m or rad
DISTURBANCE = 1e-9
GROWTH = 1000.0  # growth of the disturbance up to the horizon
# Tolerance of the in-house solver while trajectories are compared
REFERENCE_TOLERANCE = 1e-13
# Divisors of the steps of exudyn-joints; bounds apply to the last
FINENESS = (1, 2, 4, 8, 16)
# Divisors of the tolerance of the tree; bounds apply to the last
TOLERANCE_PARTS = (1, 10, 100, 1000)
FIRST_TOUCHDOWNS = 10  # number of touchdowns with bounds
CYCLES = 50  # number of cycles in the compared means, unless the scene has a number
PARTS = 40  # parts of a run; more make the recorded series and the longest steps finer
GRID = 2001  # common times at which series are compared
OUTPUT_BOUND = 1e-6  # m, up to the horizon
# Relative to the largest speed, up to the last of the first touchdowns. Later a bound
# would judge the motion: a touchdown moved by 1e-5 s changes a velocity by much.
VELOCITY_BOUND = 1e-3
TIME_BOUND = 1e-6  # s, of the first touchdowns
CLOSING_BOUND = 1e-4  # relative, of their closing speeds
FORCE_BOUND = 1e-3  # relative, of their peak forces
ORDER = 2.0  # order of Exudyn's trapezoidal rule
ORDER_BOUND = 0.3
# Bounds of the tree up to the last of the first touchdowns
TREE_TIME_BOUND = 1e-8  # s
TREE_OUTPUT_BOUND = 1e-8  # m
MEAN_BOUND = 0.1  # largest relative difference of two means over cycles
INTEGRATOR_BOUND = 1e-10  # s, of the first touchdowns between two in-house integrators


# numbers of a touchdown, SI
TOUCHDOWN = ("joint", "time", "closing_speed", "peak_force")
JOINT, TIME = range(2)  # the first of their columns
Means = dict[str, dict[str, Estimate]]  # by engine and quantity


@dataclass(frozen=True)
class Trajectory:
    """Recorded series that are compared."""

    time: Array  # s, shape (n,)
    # position along the recorded direction, m, and velocity, m/s; shape (n, 2)
    output: Array
    eccentricity: Array  # m, shape (n, 2 joints)
    # see ``TOUCHDOWN``, shape (touchdowns, 4), in the order of their times
    touchdowns: Array


def touchdowns_of(run: Run) -> Array:
    """Return the touchdowns of all recorded contacts, and of those that last to the end."""
    rows = []
    records = run.recorder.records
    for k, memory in enumerate(records.memory):
        contacts = contacts_of(run, k)
        columns = [contacts[n] for n in ("touchdown", "closing_speed", "peak_force")]
        rows += [(k, *row) for row in zip(*columns, strict=True)]
        if records.onset[k] > 0.0 and not memory["started_closed"]:
            time = memory["touchdown_time"]
            rows.append((k, time, records.onset[k], memory["peak_force"]))
    touchdowns = np.array(rows, float).reshape(-1, len(TOUCHDOWN))
    return touchdowns[np.argsort(touchdowns[:, TIME], kind="stable")]


def output_difference(first: Trajectory, second: Trajectory) -> Array:
    """Return the distances of the output points of two runs, shape (n, 3).

    Columns are evenly spaced times, s, distance, m, and difference of the velocities, m/s.
    """
    time = np.linspace(0.0, min(first.time[-1], second.time[-1]), GRID)
    curves = []
    for trajectory in (first, second):
        place, velocity = trajectory.output.T
        curves.append(CubicHermiteSpline(trajectory.time, place, velocity))
    distance = np.abs(curves[0](time) - curves[1](time))
    speed = np.abs(curves[0](time, 1) - curves[1](time, 1))
    return np.column_stack([time, distance, speed])


def touchdown_differences(reference: Array, compared: Array) -> Array:
    """Return the differences of touchdowns with the same number in the same joint, shape (n, 3).

    They are time, s, and relative closing speed and peak force; infinite for a
    touchdown that the compared run lacks.
    """
    differences = np.full((len(reference), 3), math.inf)
    for joint in np.unique(reference[:, JOINT]):
        rows = np.flatnonzero(reference[:, JOINT] == joint)
        rows_compared = np.flatnonzero(compared[:, JOINT] == joint)
        count = min(len(rows), len(rows_compared))
        rows = rows[:count]
        expected = reference[rows, TIME:]
        result = compared[rows_compared[:count], TIME:]
        differences[rows, 0] = result[:, 0] - expected[:, 0]
        differences[rows, 1:] = result[:, 1:] / expected[:, 1:] - 1.0
    return np.abs(differences)


def divergence_time(
    first: Trajectory, second: Trajectory, distance: float
) -> float | None:
    """Return the time, s, at which output point or eccentricities first differ by a distance, m."""
    time, largest, _ = output_difference(first, second).T
    pairs = zip(first.eccentricity.T, second.eccentricity.T, strict=True)
    for first_values, second_values in pairs:
        place = np.interp(time, first.time, first_values)
        second_place = np.interp(time, second.time, second_values)
        largest = np.maximum(largest, np.abs(place - second_place))
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
        plan = replace(plan, report=lambda share, recorder: self.report(word, share))
        return finished(engine.simulate(self.linkage, start, plan))

    def trajectory(
        self, word: str, engine: Engine, end: float, moved: bool = False
    ) -> Trajectory:
        plan = Plan(end / PARTS, PARTS, PARTS, by_clock=True)
        run = self.run(word, engine, plan, moved)
        recorder = run.recorder
        # The displacement is measured from the start, which may be disturbed.
        start = float(recorder.records.output["start"][0])
        position = recorder.series("displacement") + start
        eccentricities = []
        for k in range(recorder.records.memory.size):
            eccentricities.append(recorder.series("eccentricity_x", k))
            eccentricities.append(recorder.series("eccentricity_y", k))
        return Trajectory(
            time=recorder.series("time").copy(),
            output=np.column_stack([position, recorder.series("velocity")]),
            eccentricity=np.array(eccentricities).reshape(-1, position.size).T,
            touchdowns=touchdowns_of(run),
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
    touchdowns: Array  # touchdowns of the reference up to the horizon
    # See `output_difference`: the disturbed initial state, then Exudyn, coarsest first.
    differences: Mapping[str, Array]
    statistics: Means  # over cycles

    @property
    def passed(self) -> bool:
        """True if every check passed."""
        return all(check.passed for check in self.checks)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain data."""
        names = self.scene.clearance_joints
        checks = [asdict(check) | {"passed": check.passed} for check in self.checks]
        touchdowns = []
        for row in self.touchdowns.tolist():
            touchdown = dict(zip(TOUCHDOWN, row, strict=True))
            touchdowns.append(touchdown | {"joint": names[int(row[JOINT])]})
        return {
            "scene": self.scene.as_dict(),
            "provenance": provenance(),
            "horizon_s": self.horizon,
            "diverged": self.diverged,
            "passed": self.passed,
            "undecided": self.undecided,
            "checks": checks,
            "touchdowns": touchdowns,
            "statistics": self.statistics,
        }


def exudyn_of(scene: Scene) -> dict[str, Engine]:
    """Return the model of Exudyn for a scene, from its default settings to the finest."""
    scene = replace(scene, engine="exudyn") if scene.engine == "dae" else scene
    scene = replace(scene, purpose="trajectory")
    scene.check()
    period = scene.mechanism.period
    engine = scene.solver.for_cycle(period)
    engines: dict[str, Engine] = {}
    if isinstance(engine, ExudynTree):
        for divisor in TOLERANCE_PARTS:
            tolerance = engine.tolerance / divisor
            name = f"Exudyn's tree at {tolerance:g}"
            engines[name] = replace(engine, tree_tolerance=tolerance)
        return engines
    for factor in FINENESS:
        name = f"Exudyn, steps / {factor}" if factor > 1 else "Exudyn"
        engines[name] = finer_joints(scene.numerics.joints, factor, period)
    return engines


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
        time, undisturbed, disturbed_motion = separation
        diverged = time is not None
        end = time or end
        label = f"in-house, start moved by {DISTURBANCE:g} m"
        curves[label] = output_difference(undisturbed, disturbed_motion)
    reference = runner.trajectory("dae to the horizon", precise, end)
    engines = exudyn_of(scene)
    compared = {}
    distances = {}
    for word, engine in engines.items():
        compared[word] = runner.trajectory(word, engine, end)
        distances[word] = output_difference(reference, compared[word])
    is_tree = isinstance(next(iter(engines.values())), ExudynTree)
    checks = list(_exudyn_checks(is_tree, reference, compared, distances))
    if len(reference.touchdowns):
        checks.append(_check_integrators(runner, precise, reference, end))
    undecided: list[str] = []
    statistics: Means = {}
    if diverged:
        checks_of_means, undecided, statistics = _check_means(scene, runner)
        checks += checks_of_means
    return Crosscheck(
        scene=scene,
        horizon=end,
        diverged=diverged,
        checks=tuple(checks),
        undecided=tuple(undecided),
        touchdowns=reference.touchdowns,
        differences=curves | distances,
        statistics=statistics,
    )


def _check_integrators(
    runner: _Runner, precise: InHouse, reference: Trajectory, end: float
) -> Check:
    """Compare the times of the first touchdowns between two in-house integrators."""
    first = reference.touchdowns[:FIRST_TOUCHDOWNS]
    # The duration includes the last of these touchdowns.
    plan = Plan(min(1.001 * first[-1, TIME], end), 1, 1, by_clock=True)
    engine = replace(precise, integrator="dopri5", coordinates="fewest")
    run = runner.run("dae with dopri5 in fewest coordinates", engine, plan)
    largest = float(touchdown_differences(first, touchdowns_of(run))[:, 0].max())
    name = f"first {len(first)} touches, dop853 to dopri5 in fewest coordinates"
    return Check(name, largest, INTEGRATOR_BOUND, "s")


def _exudyn_checks(
    is_tree: bool,
    reference: Trajectory,
    compared: Mapping[str, Trajectory],
    distances: Mapping[str, Array],
) -> Iterator[Check]:
    """Check the finest run of Exudyn against the reference, and the order of all runs."""
    first = reference.touchdowns[:FIRST_TOUCHDOWNS]
    name = list(compared)[-1]
    differences = []
    for trajectory in compared.values():
        differences.append(touchdown_differences(first, trajectory.touchdowns))
    time, distance, speed = distances[name].T
    yield Check(f"{name}: output", float(distance.max()), OUTPUT_BOUND, "m")
    if len(first):
        early = time <= first[-1, TIME]
        count = f"{name}: first {len(first)}"
        times, speeds, forces = differences[-1].max(axis=0).tolist()
        largest = float(speed[early].max() / np.abs(reference.output[:, 1]).max())
        time_bound = TREE_TIME_BOUND if is_tree else TIME_BOUND
        yield Check(f"{count} touches, times", times, time_bound, "s")
        yield Check(f"{count} closing speeds", speeds, CLOSING_BOUND, "relative")
        yield Check(f"{count} peak forces", forces, FORCE_BOUND, "relative")
        words = f"{name}: velocity to touch {len(first)}"
        yield Check(words, largest, VELOCITY_BOUND, "relative")
        if is_tree:
            words = f"{name}: output to touch {len(first)}"
            yield Check(words, float(distance[early].max()), TREE_OUTPUT_BOUND, "m")
    if not is_tree:
        # Without touchdowns, the distance of the output has the order.
        errors = [curve[:, 1].max() for curve in distances.values()]
        if len(first):
            errors = [np.sqrt(np.mean(table[:, 0] ** 2)) for table in differences]
        order = -order_of(FINENESS, errors)
        words = f"Exudyn's order {order:.2f}, from 2"
        yield Check(words, abs(order - ORDER), ORDER_BOUND)


def _check_means(scene: Scene, runner: _Runner) -> tuple[list[Check], list[str], Means]:
    """Compare means over cycles of both engines; see ``mean_check``."""
    cycles = CYCLES if scene.cycles is None else scene.cycles
    plan = Plan(scene.mechanism.period, cycles, recorded_cycles=1)
    # By quantity: its name in the cycles of a recorder, and the joint.
    quantities: dict[str, tuple[str, int | None]] = {
        "greatest output velocity": ("velocity_max", None),
        "greatest output acceleration": ("acceleration_max", None),
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
    in_house, by_exudyn = means.values()
    checks = list[Check]()
    undecided = list[str]()
    for quantity, mean in in_house.items():
        compared = mean_check(quantity, mean, by_exudyn[quantity], len(quantities))
        if isinstance(compared, Check):
            checks.append(compared)
        else:
            undecided.append(compared)
    return checks, undecided, means


def mean_check(
    quantity: str, first: Estimate, second: Estimate, count: int = 1
) -> Check | str:
    """Return the check of the relative difference of two means, or a text without a verdict.

    The check passes if the 95 % interval of the difference lies within ``MEAN_BOUND``.
    It fails if a wider interval lies beyond ``MEAN_BOUND``: the interval that holds for
    all of ``count`` comparisons with 95 % (Bonferroni). If neither is true, the intervals
    are too wide for a verdict. The checked number is the end of the interval that is
    compared with the bound.
    """
    size = 0.5 * (abs(first.mean) + abs(second.mean))
    if first.half_width is None or second.half_width is None or size == 0.0:
        return f"mean {quantity}: no verdict, too few cycles"
    difference = abs(first.mean - second.mean) / size
    half_width = math.hypot(first.half_width, second.half_width) / size
    upper = difference + half_width
    if upper <= MEAN_BOUND:
        return Check(f"mean {quantity}", upper, MEAN_BOUND, "relative")
    quantile = NormalDist().inv_cdf
    lower = difference - half_width * quantile(1.0 - 0.025 / count) / quantile(0.975)
    if lower > MEAN_BOUND:
        return Check(f"mean {quantity}", lower, MEAN_BOUND, "relative")
    interval = (
        f"{readable(100.0 * difference, 2)} ± {readable(100.0 * half_width, 2)} %"
    )
    return f"mean {quantity}: no verdict, difference {interval}"


_COLOURS = (style.MUTED, "#56B4E9", "#0072B2", "#009E73", "#E69F00", "#D55E00")


@matplotlib.rc_context(style.SETTINGS)
def draw_differences(result: Crosscheck) -> style.Drawing:
    """Draw the distance of the output from the reference over time, up to 1.5 horizons."""
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    end = max(float(curve[-1, 0]) for curve in result.differences.values())
    end = min(end, 1.5 * result.horizon)
    curves = zip(result.differences.items(), _COLOURS, strict=False)
    for (label, curve), colour in curves:
        # A logarithm shows no zeros.
        time, distance, _ = curve.T
        rows = (time <= end) & (distance > 0.0)
        axes.semilogy(
            time[rows], distance[rows], color=colour, linewidth=0.9, label=label
        )
    axes.axhline(
        OUTPUT_BOUND, color=style.REFERENCE, linewidth=0.7, linestyle=(0.0, (4.0, 2.0))
    )
    axes.text(0.0, OUTPUT_BOUND, " bound", va="bottom", ha="left")
    if result.diverged:
        axes.axvline(result.horizon, color=style.REFERENCE, linewidth=0.7)
        side = "left" if result.horizon < 0.7 * end else "right"
        axes.text(
            result.horizon,
            0.02,
            f" horizon: grown {GROWTH:g} times ",
            transform=axes.get_xaxis_transform(),
            va="bottom",
            ha=side,
        )
    label = "distance of the output from the\nin-house reference (m)"
    axes.set(xlim=(0.0, end), xlabel="time (s)", ylabel=label)
    sheet.legend(loc="outside upper center", ncols=3)
    (drawing,) = style.finished("difference", sheet)
    return drawing
