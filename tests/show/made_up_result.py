"""Results made up from formulas, without a computation."""

from dataclasses import replace
from typing import Any

import numpy as np

import presswear as pw
from presswear.linkage.surface import SIDES, bin_centres
from presswear.recording.columns import cycle_column, cycle_columns
from presswear.results import stage as stages
from presswear.results.life import (
    Ended,
    LifeResult,
    LimitResult,
    RefinementResult,
)
from presswear.results.stage_statistics import (
    BottomStatistics,
    JointStatistics,
    OutputStatistics,
    StageStatistics,
    WearPeak,
)
from presswear.scene.conventions import CONVENTIONS

BINS = 72
PROVENANCE = {
    "python": "3.12.0",
    "packages": {"presswear": "0.1.0"},
    "revision": "0123456789ab",
    "machine": "a machine",
    "started": "2024-01-01T00:00:00Z",
}


def made_up(
    scene: pw.Scene, count: int, status: str = "completed", message: str = ""
) -> pw.Result:
    """A result as a run of the scene would leave it, from formulas; stage depth grows."""
    ends = [("completed", "")] * (count - 1) + [(status, message)]
    made = tuple(_stage(scene, k, *end) for k, end in enumerate(ends))
    return pw.Result(scene, made, status, message, PROVENANCE, wall_s=3.0)


def _stage(
    scene: pw.Scene, index: int, status: Any, message: str
) -> stages.StageResult:
    time = np.linspace(0.0, 2.0 * scene.mechanism.period, 400)
    angle = bin_centres(BINS)
    arrays = {
        "time": time,
        "slider": scene.ideal_slider(time) * (1.0 + 0.01 * (index + 1)),
        "angle": angle,
        "cycles": np.zeros((2, cycle_columns(len(scene.clearance_joints), 2))),
        "cycle_start": np.zeros(2),
    }
    arrays["cycles"][:, cycle_column("bottom_height")] = -0.5878, -0.5879
    if scene.drive_torque == "on":
        arrays["drive_torque"] = np.column_stack(
            [np.cos(40.0 * time), 1.0 + 0.0 * time]
        )
    each = pw.statistics.Estimate.symmetric(80.0, 12.0, 2)
    turn = 6.0 * np.pi * time / time[-1]
    one = 5e-6 * np.exp(-((angle - np.radians(92.5)) ** 2) / 0.1)
    peak = WearPeak(
        pw.statistics.Estimate(float(one.max())),
        pw.statistics.Estimate(np.radians(92.5)),
    )
    for joint in scene.clearance_joints:
        arrays[f"{joint}_eccentricity"] = 8e-4 * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )
        arrays[f"{joint}_force"] = np.column_stack(
            [100.0 * np.cos(turn) ** 8, 0.0 * turn]
        )
        arrays[f"{joint}_penetration"] = 1e-6 * np.sin(turn)
        arrays[f"{joint}_sliding"] = np.cos(turn)
        # Touchdown, separation, closing and release speed, peak force, steps.
        begin = time[-1] / 6.0 * np.arange(6)
        half = time[-1] / 12.0
        rest = np.tile([0.1, -0.1, 50.0, 30.0], (6, 1))
        arrays[f"{joint}_contacts"] = np.column_stack([begin, begin + half, rest])
        for side in SIDES:
            arrays[f"{joint}_depth_{side}"] = index * one
            arrays[f"{joint}_wear_{side}"] = one
    numbers: dict[str, Any] = {
        "peak_force": 100.0 + index,
        "peak_force_per_cycle": each,
        "contacts_per_cycle": each,
        "contacts": 1234,
        "unresolved_contacts": 0,
        "min_steps_per_contact": 50,
        "contact_time_fraction": 0.5,
        "load_distance_per_cycle": pw.statistics.Estimate(80.0, samples=2),
        "wear_volume": pw.statistics.Estimate(3e-9),
        "wear_volume_step_error": None,
        "wear_map_error": 0.1,
        "wear_depth_max_by_replicate": (5e-6,),
    }
    peaks = dict.fromkeys((*SIDES, "both"), peak)
    joint_statistics = JointStatistics(**numbers, wear_peaks=peaks)
    each = pw.statistics.Estimate.symmetric(0.107, 0.001, 2)
    output = OutputStatistics(0.10731, -0.9, 1.0, 1221.0, each, each, each)
    error = pw.statistics.Estimate.symmetric(-(7.6 + index) * 1e-4, 3e-5, 2)
    numbers = {
        "strokes": 2,
        "ideal_height": -0.5871,
        "ideal_time": 0.5,
        "ideal_dwell": 0.0,
        "height": pw.statistics.Estimate.symmetric(-0.58785, 2e-5, 2),
        "error": error,
        "range_of_all": 1e-4,
        "range": pw.statistics.Estimate(1e-4),
        "range_strokes": 2,
        "standard_deviation": pw.statistics.Estimate(4e-5, 3e-5, 6e-5),
        "delay": pw.statistics.Estimate(-3e-3, samples=2),
        "delay_angle": pw.statistics.Estimate.symmetric(-0.0314159, 0.0174533, 2),
    }
    bdc = BottomStatistics(**numbers)
    names = scene.clearance_joints
    joints = dict.fromkeys(names, joint_statistics)
    solver = "6 bodies, 2 drives"
    statistics = StageStatistics(2, output=output, bdc=bdc, joints=joints)
    ended: Any = (index, status, message, None, 2e6, (), float(time[-1]), 1.0)
    last: Any = ({"model": solver, "steps": 4000}, statistics, arrays, names)
    return stages.StageResult(*ended, *last)


def altered(result: pw.Result, index: int, **changes: Any) -> pw.Result:
    changed = replace(result.stages[index], **changes)
    return replace(
        result, stages=(*result.stages[:index], changed, *result.stages[index + 1 :])
    )


def grown() -> pw.Result:
    """Three stages with two wears of three steps each between them, and torques."""
    result = made_up(replace(BOTH, drive_torque="on"), 3)
    for index in range(2):
        deepest = [{"bearing": 1e-6 * (3 * index + k), "pin": 1e-6} for k in (1, 2, 3)]
        forces = {"A": 9.0, "C": 9.0}
        steps = [
            stages.WearStep(1e6, 2, 5e5, 0.1, dict.fromkeys("AC", each), forces, 1.0)
            for each in deepest
        ]
        result = altered(result, index, wear_steps=tuple(steps))
    return result


BOTH = replace(pw.scenes.wear_times(), cycles=2)
ONE = replace(BOTH, joints="C")
BODY = replace(BOTH, conventions=CONVENTIONS["refined"])
IDEAL = replace(BOTH, joints="none", wear_updates=0)

STROKES = np.array([4.0, 2e6, 4e6, 6e6])
LIFE = 5e6
UNTIL = "depth > 50 um, bdc_drift > 2 mm"
ASKED = pw.Life(UNTIL, replaced="A@2e6", rotated="C@7e6", at_most=8e6)


def made_up_life(
    sampling: float | None = 0.03, step: float | None = 0.04
) -> LifeResult:
    """Depth of C passes 50 um first, after five million strokes."""
    depth = LimitResult("C.depth", "m", 5e-5, LIFE, sampling, step, 6e-5, 3e-6)
    drift = LimitResult("bdc_drift", "m", 2e-3, None, None, None, 1e-4, 2e-5)
    values = {
        "A.depth": 2e-5,
        "A.wear_volume": 4e-9,
        "C.depth": 5e-5,
        "C.wear_volume": 1e-8,
    }
    values |= {"A.force_max": 3e4, "C.force_max": 3e3, "bdc_drift": 1e-4}
    curves = {"strokes": STROKES}
    for key, value in values.items():
        mean = value * (STROKES / LIFE if "force" not in key else np.ones(4))
        half = (0.2 if key == "bdc_drift" else 0.1) * mean
        curves[key] = np.column_stack([mean, mean - half, mean + half])
    return LifeResult(
        ended="limit",
        message="",
        strokes=LIFE,
        sampling=sampling,
        step=step,
        scatter=0.5,
        limits=(
            LimitResult("A.depth", "m", 5e-5, None, None, None, 2e-5, 1e-6),
            depth,
            drift,
        ),
        refinements=(
            RefinementResult(5e-3, 64, 5.2e6, 0.08),
            RefinementResult(1e-3, 320, LIFE, sampling),
        ),
        services=("bushing of A replaced after 2e+06 strokes",),
        curves=curves,
    )


def lived(result: pw.Result, life: LifeResult | None = None) -> pw.Result:
    scene = replace(result.scene, life=ASKED, wear_updates=2)
    return replace(result, scene=scene, life=life or made_up_life())


def not_passed(ended: Ended = "at_most", message: str = "") -> LifeResult:
    """The same life where no limit is passed within five million strokes."""
    life = made_up_life(None, None)
    limits = [
        replace(limit, strokes=None, last=0.5 * limit.value) for limit in life.limits
    ]
    return replace(life, ended=ended, message=message, limits=tuple(limits))
