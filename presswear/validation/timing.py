"""CPU times of runs, and of a scene with and without each feature of its model.

CPU time hardly depends on what else the machine does; runs are interleaved all the same. Only the
solution is timed; compiling, loading and building the model are not. The motion differs between
runs with and without a feature, and so does the number of steps; the time of a step is the fair
measure.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.recording.statistics import mean_map
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import write_bytes
from presswear.validation.cases import Progress, finished, part_of


@dataclass(frozen=True)
class TimedRun:
    """Run to be timed."""

    name: str
    linkage: Linkage
    start: Start
    engine: Engine
    plan: Plan

    def run(self) -> Run:
        """Run once; RunFailed if the run fails."""
        return finished(self.engine.simulate(self.linkage, self.start, self.plan), self.name)


@dataclass(frozen=True)
class Timing:
    """Repeated runs with equal steps."""

    model: str  # coordinates and joints that the engine solves for
    simulated: float  # simulated time, s
    steps: int
    rejected: int  # steps that were repeated with a shorter length
    evaluations: int | None  # of the accelerations, if the engine counts them
    times: tuple[float, ...]  # CPU times of the solution, s

    @property
    def cpu(self) -> float:
        """Least CPU time, s: other programs only make runs longer."""
        return min(self.times)

    @property
    def per_second(self) -> float:
        """CPU time per simulated second, s/s."""
        return self.cpu / self.simulated

    @property
    def per_step(self) -> float:
        """CPU time per attempted step, s."""
        return self.cpu / max(self.steps + self.rejected, 1)

    def columns(self) -> dict[str, object]:
        """Return the columns of a table."""
        times = {"cpu_s": self.cpu, "cpu_median_s": median(self.times)}
        counts = {"steps": self.steps, "rejected_steps": self.rejected}
        return {**counts, "evaluations": self.evaluations, **times, "cpu_max_s": max(self.times)}


def time_runs(runs: Sequence[TimedRun], repeats: int, report: Progress) -> list[Timing]:
    """Run all in turn, ``repeats`` times.

    `RunFailed` if a run fails, or if a repeat takes other steps than the first run.
    """
    timings: list[Timing] = []
    for repeat in range(repeats):
        for i, timed in enumerate(runs):
            report(timed.name, (repeat * len(runs) + i) / (repeats * len(runs)))
            run = timed.run()
            numbers, evaluations = run.diagnostics, run.diagnostics.get("evaluations")
            timing = Timing(
                str(numbers["model"]).partition(";")[0],
                run.time,
                int(numbers["steps"]),
                int(numbers["steps_sent_back"]),
                None if evaluations is None else int(evaluations),
                (run.cpu,),
            )
            if repeat == 0:
                timings.append(timing)
                continue
            first = timings[i]
            if replace(timing, times=first.times) != first:
                raise RunFailed(f"{timed.name}: a repeated run took other steps")
            timings[i] = replace(first, times=(*first.times, *timing.times))
    return timings


def write_csv(rows: Sequence[Mapping[str, object]], file: Path) -> None:
    """Write a table; the columns are those of all rows."""
    text = io.StringIO()
    writer = csv.DictWriter(text, {name: None for row in rows for name in row})
    writer.writeheader()
    writer.writerows(rows)
    write_bytes(file, text.getvalue().encode())


Variants = dict[str, tuple[dict[str, object], Array | None]]  # settings and worn depth by name
WARM_UP = 0.05  # of a run's time, run before to compile and load
CLEARANCES = {"none": "none", "A": "A", "C": "C", "A and C": "AC"}
SWITCHES = {  # names of the runs without and with a feature
    "friction": ("no friction", "scene"),
    "worn surfaces": ("scene", "worn surfaces"),
    "foundation": ("worn surfaces", "foundation"),
    "wear account": ("no wear account", "scene"),
    "torques stored": ("scene", "torques stored"),
}


@dataclass(frozen=True)
class FeatureExtent:
    """Repeats of each run, and whole simulated cycles, or a fraction of one."""

    repeats: int = 5
    tree_cycles: float = 2.0
    joints_cycles: float = 1.0
    wear_cycles: int = 5  # whose wear makes the worn surfaces


QUICK = FeatureExtent(repeats=2, tree_cycles=0.25, joints_cycles=0.1, wear_cycles=1)


@dataclass(frozen=True)
class FeatureCost:
    """Run with a feature on or off."""

    engine: str
    feature: str
    state: str
    timing: Timing
    without: Timing  # of the run without the feature

    @property
    def step_ratio(self) -> float:
        """CPU time per attempted step over that of the run without the feature."""
        return self.timing.per_step / self.without.per_step

    @property
    def cpu_ratio(self) -> float:
        """CPU time per simulated second over that of the run without the feature."""
        return self.timing.per_second / self.without.per_second


def timed_run(name: str, scene: Scene, cycles: float, worn: Array | None = None) -> TimedRun:
    """Return a scene as a run to be timed, on unworn or worn surfaces, all cycles recorded."""
    period = scene.mechanism.period
    cycle, count = (period, int(cycles)) if cycles >= 1.0 else (cycles * period, 1)
    plan = Plan(cycle, count, count, torques=scene.stores_torques)
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    return TimedRun(name, linkage, start_of(scene), scene.solver.for_cycle(period), plan)


def feature_costs(scene: Scene, extent: FeatureExtent, report: Progress) -> list[FeatureCost]:
    """Time a scene of the press with each feature on and off, in both models of Exudyn.

    `InputError` if the scene has not clearance at A and C, `RunFailed` if a run fails.
    """
    if scene.clearance_joints != ("A", "C"):
        raise InputError(f"scene {scene.name}: --features needs a press with clearance at A and C")
    report("wear of the worn surfaces", 0.0)
    stage, ensemble = run_stage(replace(scene, cycles=extent.wear_cycles), 0)
    if stage.failed:
        raise RunFailed(stage.message)
    worn = scene.cycles_per_update * mean_map(ensemble.maps)
    by_clearance: Variants = {name: ({"joints": word}, None) for name, word in CLEARANCES.items()}
    switched: Variants = {
        "scene": ({}, None),
        "no friction": ({"friction": 0.0}, None),
        "worn surfaces": ({}, worn),
        "foundation": ({"contact": "foundation"}, worn),
        "no wear account": ({"wear_coefficient": 0.0}, None),
        "torques stored": ({"drive_torque": "on"}, None),
    }
    pairs = [("clearance", state, state, "none") for state in CLEARANCES]
    switches = [
        (feature, state, run, names[0])
        for feature, names in SWITCHES.items()
        for state, run in zip(("off", "on"), names, strict=True)
    ]
    few = max(2, (extent.repeats + 1) // 2)
    groups = (
        ("exudyn", by_clearance, pairs, extent.tree_cycles, extent.repeats),
        ("exudyn-tree", switched, switches, extent.tree_cycles, extent.repeats),
        ("exudyn-joints", by_clearance, pairs, extent.joints_cycles, few),
        ("exudyn-joints", switched, switches, extent.joints_cycles, few),
    )
    costs: list[FeatureCost] = []
    for i, (engine, variants, compared, cycles, repeats) in enumerate(groups):
        part = part_of(report, 0.05 + 0.95 * i / len(groups), 0.95 / len(groups))
        base, runs = replace(scene, engine=engine), []
        for name, (changes, depth) in variants.items():
            runs.append(timed_run(name, changed(base, changes), cycles, depth))
            part(f"{name}: compiling", 0.0)
            plan = runs[-1].plan
            replace(runs[-1], plan=replace(plan, cycle=WARM_UP * plan.cycle, cycles=1)).run()
        timings = dict(zip(variants, time_runs(runs, repeats, part), strict=True))
        costs += [
            FeatureCost(engine, feature, state, timings[name], timings[without])
            for feature, state, name, without in compared
        ]
    return costs


def table(costs: Sequence[FeatureCost]) -> list[dict[str, object]]:
    """Return one row for each feature and state."""
    return [
        {
            **{name: getattr(cost, name) for name in ("engine", "feature", "state")},
            "model": cost.timing.model,
            "simulated_s": cost.timing.simulated,
            **cost.timing.columns(),
            "ratio_per_step": cost.step_ratio,
            "ratio_per_simulated_second": cost.cpu_ratio,
        }
        for cost in costs
    ]
