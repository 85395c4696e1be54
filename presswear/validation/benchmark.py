"""Benchmarks: error against CPU time of every method, and the cost of each feature of the model.

CPU time hardly depends on what else the machine does; runs are interleaved all the
same. Only the solution is timed; compiling, loading and building the model are not. The
motion differs between runs with and without a feature, and so does the number of steps;
the time of a step is the fair measure.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from statistics import median
from typing import Any

import matplotlib
import numpy as np

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.campaign.wear_update import cycles_of_update
from presswear.engines.base import Plan, Run
from presswear.recording.statistics import mean_map
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.figures import style
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.validation import benchmark_problems as problems
from presswear.validation.benchmark_problems import Extent, Method, Problem
from presswear.validation.cases import Progress, finished, guarded, part_of


@dataclass(frozen=True)
class Timing:
    """Repeated runs with equal steps."""

    model: str  # coordinates and joints that the engine solves for
    simulated: float  # simulated time, s
    steps: int
    rejected: int  # steps that were repeated with a shorter length
    # evaluations of the accelerations, if the engine counts them
    evaluations: int | None
    times: tuple[float, ...]  # CPU times of the solution, s

    @property
    def cpu(self) -> float:
        """Least CPU time, s: other programs only make runs longer."""
        return min(self.times)

    @property
    def per_step(self) -> float:
        """CPU time per attempted step, s."""
        return self.cpu / max(self.steps + self.rejected, 1)

    @property
    def per_second(self) -> float:
        """CPU time per simulated second."""
        return self.cpu / self.simulated

    def columns(self) -> dict[str, object]:
        """Return the columns of a table."""
        return {
            "steps": self.steps,
            "rejected_steps": self.rejected,
            "evaluations": self.evaluations,
            "cpu_s": self.cpu,
            "cpu_median_s": median(self.times),
            "cpu_max_s": max(self.times),
        }


def time_runs(
    runs: Mapping[str, Callable[[], Run]], repeats: int, report: Progress
) -> dict[str, Timing]:
    """Run all in turn, ``repeats`` times; return their timings by name.

    `RunFailed` if a run fails, or if a repeat takes other steps than the first run.
    """
    timings: dict[str, Timing] = {}
    for repeat in range(repeats):
        for i, (name, simulate) in enumerate(runs.items()):
            report(name, (repeat * len(runs) + i) / (repeats * len(runs)))
            timing = _timing_of(finished(simulate(), name))
            first = timings.get(name, timing)
            if replace(timing, times=first.times) != first:
                raise RunFailed(f"{name}: a repeated run took other steps")
            times = (*first.times[:repeat], timing.cpu)
            timings[name] = replace(first, times=times)
    return timings


def _timing_of(run: Run) -> Timing:
    """Return the timing of one run."""
    numbers = run.diagnostics
    evaluations = numbers.get("evaluations")
    return Timing(
        model=str(numbers["model"]).partition(";")[0],
        simulated=run.time,
        steps=int(numbers["steps"]),
        rejected=int(numbers["steps_sent_back"]),
        evaluations=None if evaluations is None else int(evaluations),
        times=(run.cpu,),
    )


# --- Speed against error ------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """Result of a method on a problem; ``timing`` is None and ``errors`` empty if it failed."""

    problem: Problem
    method: Method
    errors: Mapping[str, float]
    timing: Timing | None = None
    failure: str = ""


def first_run(problem: Problem, method: Method) -> Point:
    """Run a method once for its errors; a failure of any kind becomes a point with a failure."""
    plan = problem.plan
    plan = replace(plan, report=guarded(plan.cycle, plan.cycles).report)
    try:
        with np.errstate(all="ignore"):  # a run that diverges overflows before it fails
            run = finished(method.engine.simulate(problem.linkage, problem.start, plan))
            values = map(float, problem.errors(run))
            errors = dict(zip(problem.quantities, values, strict=True))
        for name, error in errors.items():
            if not math.isfinite(error):
                raise RunFailed(f"error of {name} is not finite")
    except (InputError, RunFailed, ArithmeticError) as error:
        return Point(problem, method, {}, failure=str(error) or type(error).__name__)
    return Point(problem, method, errors)


def measure(problem: Problem, repeats: int, report: Progress) -> list[Point]:
    """Run all methods of a problem once for their errors, then in turn for their CPU times."""
    points = []
    weight = 2.0 / (2.0 + repeats)  # compiling makes the first runs longer
    for i, method in enumerate(problem.methods):
        report(method.label, weight * i / len(problem.methods))
        points.append(first_run(problem, method))
    arguments = problem.linkage, problem.start, problem.plan
    runs = {}
    for point in points:
        if not point.failure:
            simulate = point.method.engine.simulate
            runs[point.method.label] = partial(simulate, *arguments)
    timings = time_runs(runs, repeats, part_of(report, weight, 1.0 - weight))
    return [replace(point, timing=timings.get(point.method.label)) for point in points]


def work_precision(scene: Scene, extent: Extent, report: Progress) -> list[Point]:
    """Measure errors and CPU times of every engine and integrator.

    `InputError` if the scene has no clearance, `RunFailed` if a reference solution
    fails.
    """
    if not scene.clearance_joints:
        raise InputError(
            f"scene {scene.name} has no clearance: choose a scene with clearance"
        )
    points: list[Point] = []
    for k, make in enumerate(problems.MAKERS):
        start = k / len(problems.MAKERS)
        size = 1.0 / len(problems.MAKERS)
        problem = make(scene, extent, part_of(report, start, 0.0))
        progress = part_of(report, start, size, f"{problem.name}: ")
        points += measure(problem, extent.repeats, progress)
    return points


def problems_of(points: Sequence[Point]) -> list[Problem]:
    """Return the problems of points in their order."""
    return list({id(point.problem): point.problem for point in points}.values())


def table(points: Sequence[Point]) -> list[dict[str, object]]:
    """Return one row for each problem, method and quantity; a method that failed has no numbers."""
    rows: list[dict[str, object]] = []
    for point in points:
        method = point.method
        timing = point.timing.columns() if point.timing else {}
        for quantity, uncertainty in point.problem.quantities.items():
            row = {
                "problem": point.problem.name,
                "engine": method.engine.word,
                "integrator": method.integrator,
                "parameter": method.parameter,
                "value": method.value,
                "is_default": method.is_default,
                "is_paper": method.is_paper,
                "quantity": quantity,
                "error": point.errors.get(quantity, ""),
                "reference_uncertainty": uncertainty,
            }
            rows.append({**row, **timing, "failure": point.failure})
    return rows


_STYLES = (*style.LINES, ("#56B4E9", (0.0, (4.0, 1.0, 1.0, 1.0, 1.0, 1.0))))
_CURVES = tuple(zip(("o", "s", "^", "D", "v", "P"), _STYLES, strict=True))
_MARK: dict[str, Any] = {
    "color": style.REFERENCE,
    "markersize": 10.0,
    "linestyle": "none",
    "markerfacecolor": "none",
}


@matplotlib.rc_context(style.SETTINGS)
def draw_work_precision(points: Sequence[Point]) -> style.Drawing:
    """Draw the first two errors of each problem over the CPU time."""
    listed = problems_of(points)
    families = list(dict.fromkeys(point.method.family for point in points))
    sheet, grid = style.panels(len(listed), 2, 1.0 + 2.4 * len(listed))
    handles: dict[str, Any] = {}  # lines of the legend, by label
    for row, problem in zip(grid, listed, strict=True):
        timed = [p for p in points if p.problem is problem and p.timing is not None]
        quantities = list(problem.quantities.items())[:2]
        for axes, (quantity, uncertainty) in zip(row, quantities, strict=True):
            _draw_errors(axes, timed, quantity, families)
            if uncertainty:
                axes.axhline(uncertainty, color="0.6", linewidth=1.6, zorder=0.5)
            axes.set_title(problem.name)
        lines, labels = row[0].get_legend_handles_labels()
        handles |= dict(zip(labels, lines, strict=True))
    sheet.legend(handles.values(), handles, loc="outside upper center", ncols=2)
    failed = "; ".join(
        f"{p.problem.name}: {p.method.label}" for p in points if p.failure
    )
    return style.finished("benchmark", sheet, failed=failed)[0]


def _draw_errors(
    axes: style.Axes, points: Sequence[Point], quantity: str, families: Sequence[str]
) -> None:
    """Draw one error of all methods of a problem; rings and stars mark default and paper."""
    axes.set_xscale("log", subs=style.SUBTICKS)
    axes.set_yscale("log", subs=style.SUBTICKS)
    axes.set(xlabel="CPU time (ms)", ylabel=quantity)
    for family, (marker, (colour, dashes)) in zip(families, _CURVES, strict=False):
        of_family = [point for point in points if point.method.family == family]
        line = [point for point in of_family if not point.method.is_paper]
        x, y = np.reshape([_place(point, quantity) for point in line], (-1, 2)).T
        pen = style.Pen(family, colour, dashes)
        pen.draw(axes, x, y, marker=marker, markersize=4.5, label=family)
        for point in of_family:
            place = _place(point, quantity)
            if point.method.is_default:
                axes.plot(*place, "o", label="default setting", **_MARK)
            if point.method.is_paper:
                axes.plot(*place, "*", label="paper, RK4 at 1e-4 s", **_MARK)


def _place(point: Point, quantity: str) -> tuple[float, float]:
    """Return the CPU time, ms, and an error of a point as a place in the figure."""
    assert point.timing is not None, "only timed points are drawn"
    return 1e3 * point.timing.cpu, max(point.errors[quantity], 1e-17)


# --- Cost of features ---------------------------------------------------------------

WARM_UP = 0.05  # part of a run's time that is run before, to compile and load
FEATURES: dict[str, dict[str, dict[str, Any]]] = problems.DATA["features"]
ENGINES = {  # features that are timed in each engine
    "exudyn": ["clearance"],
    "exudyn-tree": [name for name in FEATURES if name != "clearance"],
    "exudyn-joints": [*FEATURES],
}


@dataclass(frozen=True)
class FeatureExtent:
    """Repeats of each run, and whole simulated cycles, or a fraction of one."""

    repeats: int = 5
    tree_cycles: float = 2.0
    joints_cycles: float = 1.0
    wear_cycles: int = 5  # cycles whose wear makes the worn surfaces


QUICK_FEATURES = FeatureExtent(
    repeats=2, tree_cycles=0.25, joints_cycles=0.1, wear_cycles=1
)


def run_of(scene: Scene, cycles: float, worn: Array | None = None) -> Callable[[], Run]:
    """Return the run of a scene on unworn or worn surfaces, with all cycles recorded."""
    period = scene.mechanism.period
    cycle = min(cycles, 1.0) * period
    count = max(int(cycles), 1)
    plan = Plan(cycle, count, count, torques=scene.stores_torques)
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    return partial(
        scene.solver.for_cycle(period).simulate, linkage, start_of(scene), plan
    )


def feature_costs(
    scene: Scene, extent: FeatureExtent, report: Progress
) -> list[dict[str, object]]:
    """Time a scene of the press with each feature on and off, in both models of Exudyn.

    Return one row for each feature and state; ratios are to the row without the
    feature. `InputError` if the scene has not clearance at A and C, `RunFailed` if a
    run fails.
    """
    if scene.clearance_joints != ("A", "C"):
        raise InputError(
            f"scene {scene.name}: --features needs a press with clearance at A and C"
        )
    report("wear of the worn surfaces", 0.0)
    stage, ensemble = run_stage(replace(scene, cycles=extent.wear_cycles))
    if stage.failed:
        raise RunFailed(stage.message)
    worn = cycles_of_update(scene, ensemble) * mean_map(ensemble.maps)
    rows: list[dict[str, object]] = []
    for i, (engine, features) in enumerate(ENGINES.items()):
        share = 0.95 / len(ENGINES)
        progress = part_of(report, 0.05 + i * share, share)
        cycles = extent.tree_cycles
        repeats = extent.repeats
        if engine == "exudyn-joints":
            cycles = extent.joints_cycles
            repeats = max(2, (extent.repeats + 1) // 2)
        runs = {}  # by their settings: states of several features are the same run
        for settings in chain(*(FEATURES[feature].values() for feature in features)):
            values = {key: value for key, value in settings.items() if key != "worn"}
            variant = changed(replace(scene, engine=engine), values)
            depth = worn if "worn" in settings else None
            name = _name(settings)
            progress(f"{name}: compiling", 0.0)
            finished(run_of(variant, WARM_UP * cycles, depth)(), name)
            runs[name] = run_of(variant, cycles, depth)
        timings = time_runs(runs, repeats, progress)
        for feature in features:
            rows += _feature_rows(engine, feature, timings)
    return rows


def _feature_rows(
    engine: str, feature: str, timings: Mapping[str, Timing]
) -> list[dict[str, object]]:
    """Return a row for each state of a feature; ``timings`` are by the names of settings."""
    states = FEATURES[feature]
    off = timings[_name(next(iter(states.values())))]
    rows: list[dict[str, object]] = []
    for state, settings in states.items():
        timing = timings[_name(settings)]
        row = {
            "engine": engine,
            "feature": feature,
            "state": state,
            "model": timing.model,
            "simulated_s": timing.simulated,
            **timing.columns(),
            "cpu_s_per_simulated_s": timing.per_second,
            "cpu_s_per_step": timing.per_step,
            "ratio_per_step": timing.per_step / off.per_step,
            "ratio_per_simulated_second": timing.per_second / off.per_second,
        }
        rows.append(row)
    return rows


def _name(settings: Mapping[str, object]) -> str:
    return ", ".join(f"{key} = {value}" for key, value in settings.items()) or "scene"
