"""Wall time of each feature of a model: runs of a scene with the feature and without it.

The motion differs between the two runs, and so does the number of steps; the time of a step is the
fair measure.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import linkage_on, start_of
from presswear.engines.base import Plan
from presswear.recording.statistics import mean_map
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.cases import Progress, part_of
from presswear.validation.timing import TimedRun, Timing, time_runs

Array = NDArray[np.float64]

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
    """Run with a feature on or off.

    Attributes
    ----------
    step_ratio, wall_ratio : float
        Wall time per attempted step and per simulated second, divided by that of the run without
        the feature.
    """

    engine: str
    feature: str
    state: str
    timing: Timing
    step_ratio: float
    wall_ratio: float


def timed_run(name: str, scene: Scene, cycles: float, worn: Array | None = None) -> TimedRun:
    """Return a scene as a run to be timed, on unworn or worn surfaces, all cycles recorded."""
    period = scene.mechanism.period
    cycle, count = (period, int(cycles)) if cycles >= 1.0 else (cycles * period, 1)
    plan = Plan(cycle, count, count, torques=scene.stores_torques)
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    return TimedRun(name, linkage, start_of(scene), scene.solver.for_cycle(period), plan)


def clearance_runs(scene: Scene, cycles: float) -> dict[str, TimedRun]:
    """Return runs with no, one and two open joints of the press."""
    return {
        state: timed_run(f"clearance {state}", replace(scene, joints=joints), cycles)
        for state, joints in CLEARANCES.items()
    }


def switched_runs(scene: Scene, worn: Array, cycles: float) -> dict[str, TimedRun]:
    """Return the runs that SWITCHES names."""
    scenes = {
        "scene": scene,
        "no friction": replace(scene, bearings=replace(scene.bearings, friction=0.0)),
        "worn surfaces": scene,
        "foundation": changed(scene, {"contact": "foundation"}),
        "no wear account": changed(scene, {"wear_coefficient": 0.0}),
        "torques stored": replace(scene, drive_torque="on"),
    }
    on_worn = ("worn surfaces", "foundation")
    return {
        name: timed_run(name, each, cycles, worn if name in on_worn else None)
        for name, each in scenes.items()
    }


def worn_surfaces(scene: Scene, cycles: int) -> Array:
    """Return the depth after one wear update from so many cycles, shape (joints, 2, m), m."""
    stage, ensemble = run_stage(replace(scene, cycles=cycles), 0)
    if stage.failed:
        raise RunFailed(stage.message)
    return scene.cycles_per_update * mean_map(ensemble.maps)


def feature_costs(scene: Scene, extent: FeatureExtent, report: Progress) -> list[FeatureCost]:
    """Time a scene of the press with each feature on and off, in both models of Exudyn.

    Raises
    ------
    InputError
        If the scene has not clearance at A and C.
    RunFailed
        If a run fails.
    """
    if scene.clearance_joints != ("A", "C"):
        raise InputError(f"scene {scene.name}: --features needs a press with clearance at A and C")
    report("wear of the worn surfaces", 0.0)
    worn = worn_surfaces(scene, extent.wear_cycles)
    tree, joints = (replace(scene, engine=word) for word in ("exudyn-tree", "exudyn-joints"))
    auto = replace(scene, engine="exudyn")
    few = max(2, (extent.repeats + 1) // 2)
    groups: list[tuple[Scene, dict[str, TimedRun], int]] = [
        (auto, clearance_runs(auto, extent.tree_cycles), extent.repeats),
        (tree, switched_runs(tree, worn, extent.tree_cycles), extent.repeats),
        (joints, clearance_runs(joints, extent.joints_cycles), few),
        (joints, switched_runs(joints, worn, extent.joints_cycles), few),
    ]
    costs: list[FeatureCost] = []
    for i, (each, runs, repeats) in enumerate(groups):
        part = part_of(report, 0.05 + 0.95 * i / len(groups), 0.95 / len(groups))
        for run in runs.values():
            part(f"{run.name}: compiling", 0.0)
            replace(run, plan=replace(run.plan, cycle=WARM_UP * run.plan.cycle, cycles=1)).run()
        timings = dict(zip(runs, time_runs(list(runs.values()), repeats, part), strict=True))
        if "scene" in runs:
            for feature, (off, on) in SWITCHES.items():
                costs.append(_cost(each, feature, "off", timings[off], timings[off]))
                costs.append(_cost(each, feature, "on", timings[on], timings[off]))
        else:
            for state, timing in timings.items():
                costs.append(_cost(each, "clearance", state, timing, timings["none"]))
    return costs


def _cost(scene: Scene, feature: str, state: str, timing: Timing, off: Timing) -> FeatureCost:
    ratios = timing.per_step / off.per_step, timing.per_second / off.per_second
    return FeatureCost(scene.engine, feature, state, timing, *ratios)


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
