"""The cost of each feature of a model: the same run with the feature and without.

The motion differs between the two, and with it the number of steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import start_of
from presswear.campaign.segment import linkage_on
from presswear.engines.base import Plan
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import RunFailed
from presswear.validation.runs import Told
from presswear.validation.timing import TimedRun, Timing, time_runs

Array = NDArray[np.float64]

WARM_UP_PART = 0.05
"""Part of a run's time that is run beforehand and thrown away."""
CLEARANCES = {"none": "none", "A": "A", "C": "C", "A and C": "AC"}
"""Name of a row, and the scene's word for it."""
SWITCHES = (
    ("friction", "no friction", "the scene"),
    ("worn surfaces", "the scene", "worn surfaces"),
    ("foundation", "worn surfaces", "on a foundation"),
    ("wear account", "no wear account", "the scene"),
    ("torques stored", "the scene", "torques stored"),
)
"""Feature, and the names of the runs without it and with it."""
_WORN = ("worn surfaces", "on a foundation")


@dataclass(frozen=True)
class FeatureRow:
    """A run with a feature on or off.

    Attributes
    ----------
    step_ratio, wall_ratio : float
        Wall time per attempted step and per simulated second, parts of those of the run with
        the feature off.
    """

    feature: str
    state: str
    timing: Timing
    step_ratio: float
    wall_ratio: float

    @staticmethod
    def of(feature: str, state: str, timing: Timing, off: Timing) -> "FeatureRow":
        """Hold a run against that with the feature off."""
        step_ratio, wall_ratio = timing.per_step / off.per_step, timing.per_second / off.per_second
        return FeatureRow(feature, state, timing, step_ratio, wall_ratio)


@dataclass(frozen=True)
class FeatureTable:
    """Rows that were timed in turn."""

    title: str
    rows: tuple[FeatureRow, ...]


def plan_of(period: float, cycles: float, torques: bool = False) -> Plan:
    """A plan of so many whole cycles, or of a part of one below 1, all recorded."""
    if cycles < 1.0:
        return Plan(cycles * period, 1, 1, torques=torques)
    return Plan(period, int(cycles), int(cycles), torques=torques)


def timed_run(name: str, scene: Scene, cycles: float, worn: Array | None = None) -> TimedRun:
    """A scene as a run to be timed, on unworn or worn surfaces."""
    period = scene.mechanism.period
    plan = plan_of(period, cycles, scene.stores_torques)
    linkage = scene.linkage() if worn is None else linkage_on(scene, worn)
    return TimedRun(name, linkage, start_of(scene), scene.solver.over(period), plan)


def warm_up(timed: TimedRun) -> None:
    """Compile and load everything that a timed run needs."""
    plan = replace(timed.plan, cycle=WARM_UP_PART * timed.plan.cycle, cycles=1)
    replace(timed, plan=plan).run()


def _timed(runs: Sequence[TimedRun], repeats: int, told: Told) -> tuple[Timing, ...]:
    for run in runs:
        told(run.name, 0.0)
        warm_up(run)
    return time_runs(runs, repeats, told)


def wear_once(scene: Scene, cycles: int) -> Array:
    """Depth of the surfaces after one wear, from so many cycles, shape (joints, 2, m), m."""
    stage, ran = run_stage(replace(scene, cycles=cycles), 0)
    if stage.failed:
        raise RunFailed(stage.message)
    return scene.cycles_per_update * ran.depth()


def deepest(scene: Scene, worn: Array) -> dict[str, float]:
    """Deepest wear of each joint, bearing and pin together, m."""
    depths = worn.max(axis=2).sum(axis=1)
    return dict(zip(scene.clearance_joints, map(float, depths), strict=True))


def clearance_rows(scene: Scene, cycles: float, repeats: int, told: Told) -> tuple[FeatureRow, ...]:
    """Time a scene with neither, one and both of its joints open, in the engine it names."""
    runs = [
        timed_run(f"clearance {state}", replace(scene, joints=joints), cycles)
        for state, joints in CLEARANCES.items()
    ]
    timings = _timed(runs, repeats, told)
    return tuple(
        FeatureRow.of("clearance", state, timing, timings[0])
        for state, timing in zip(CLEARANCES, timings, strict=True)
    )


def switched_rows(
    scene: Scene, worn: Array, cycles: float, repeats: int, told: Told
) -> tuple[FeatureRow, ...]:
    """Time a scene with friction, worn surfaces and others of SWITCHES off and on."""
    bearings = scene.bearings
    scenes = {
        "the scene": scene,
        "no friction": replace(scene, bearings=replace(bearings, friction=0.0)),
        "worn surfaces": scene,
        "on a foundation": changed(scene, {"contact": "foundation"}),
        "no wear account": changed(scene, {"wear_coefficient": 0.0}),
        "torques stored": replace(scene, drive_torque="on"),
    }
    runs = [
        timed_run(name, own, cycles, worn if name in _WORN else None)
        for name, own in scenes.items()
    ]
    timings = dict(zip(scenes, _timed(runs, repeats, told), strict=True))
    return tuple(
        FeatureRow.of(feature, state, timings[name], timings[off])
        for feature, off, on in SWITCHES
        for state, name in (("off", off), ("on", on))
    )
