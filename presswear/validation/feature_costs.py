"""Wall time of each feature of a model: runs of a scene with the feature and without it.

The motion differs between the two runs, and so does the number of steps; the time of a step is the
fair measure.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.engines.base import Plan
from presswear.recording.statistics import mean_map
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.cases import Progress, part_of
from presswear.validation.timing import TimedRun, Timing, time_runs

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
    step_ratio: float  # wall time per attempted step over that of the run without the feature
    wall_ratio: float  # wall time per simulated second over that of the run without the feature


def timed_run(name: str, scene: Scene, cycles: float, worn: Array | None = None) -> TimedRun:
    """Return a scene as a run to be timed, on unworn or worn surfaces, all cycles recorded."""
    period = scene.mechanism.period
    cycle, count = (period, int(cycles)) if cycles >= 1.0 else (cycles * period, 1)
    plan = Plan(cycle, count, count, torques=scene.stores_torques)
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    return TimedRun(name, linkage, start_of(scene), scene.solver.for_cycle(period), plan)


def worn_surfaces(scene: Scene, cycles: int) -> Array:
    """Return the depth after one wear update from so many cycles, shape (joints, 2, m), m."""
    stage, ensemble = run_stage(replace(scene, cycles=cycles), 0)
    if stage.failed:
        raise RunFailed(stage.message)
    return scene.cycles_per_update * mean_map(ensemble.maps)


def feature_costs(scene: Scene, extent: FeatureExtent, report: Progress) -> list[FeatureCost]:
    """Time a scene of the press with each feature on and off, in both models of Exudyn.

    `InputError` if the scene has not clearance at A and C, `RunFailed` if a run fails.
    """
    if scene.clearance_joints != ("A", "C"):
        raise InputError(f"scene {scene.name}: --features needs a press with clearance at A and C")
    report("wear of the worn surfaces", 0.0)
    worn = worn_surfaces(scene, extent.wear_cycles)

    def clearances(scene: Scene, cycles: float) -> dict[str, TimedRun]:
        return {
            state: timed_run(f"clearance {state}", replace(scene, joints=joints), cycles)
            for state, joints in CLEARANCES.items()
        }

    def switched(scene: Scene, cycles: float) -> dict[str, TimedRun]:
        calm = replace(scene, bearings=replace(scene.bearings, friction=0.0))
        scenes = {
            "scene": (scene, None),
            "no friction": (calm, None),
            "worn surfaces": (scene, worn),
            "foundation": (changed(scene, {"contact": "foundation"}), worn),
            "no wear account": (changed(scene, {"wear_coefficient": 0.0}), None),
            "torques stored": (replace(scene, drive_torque="on"), None),
        }
        return {name: timed_run(name, one, cycles, depth) for name, (one, depth) in scenes.items()}

    few = max(2, (extent.repeats + 1) // 2)
    groups = (
        ("exudyn", clearances, extent.tree_cycles, extent.repeats),
        ("exudyn-tree", switched, extent.tree_cycles, extent.repeats),
        ("exudyn-joints", clearances, extent.joints_cycles, few),
        ("exudyn-joints", switched, extent.joints_cycles, few),
    )
    costs: list[FeatureCost] = []
    for i, (engine, make, cycles, repeats) in enumerate(groups):
        part = part_of(report, 0.05 + 0.95 * i / len(groups), 0.95 / len(groups))
        runs = make(replace(scene, engine=engine), cycles)
        for run in runs.values():
            part(f"{run.name}: compiling", 0.0)
            replace(run, plan=replace(run.plan, cycle=WARM_UP * run.plan.cycle, cycles=1)).run()
        timings = dict(zip(runs, time_runs(list(runs.values()), repeats, part), strict=True))
        pairs = [("clearance", state, state, "none") for state in CLEARANCES]
        if make is switched:
            pairs = [
                (feature, state, run, names[0])
                for feature, names in SWITCHES.items()
                for state, run in zip(("off", "on"), names, strict=True)
            ]
        for feature, state, name, without in pairs:
            on, off = timings[name], timings[without]
            ratios = on.per_step / off.per_step, on.per_second / off.per_second
            costs.append(FeatureCost(engine, feature, state, on, *ratios))
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
            "ratio_per_simulated_second": cost.wall_ratio,
        }
        for cost in costs
    ]
