"""Arrays of a stage that are stored, and its deviation from the ideal motion."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from presswear.campaign.ensemble import Ensemble
from presswear.campaign.stage_wear import StageWear
from presswear.campaign.wall_statistics import wall_arrays
from presswear.engines.base import Plan
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.surface import SIDES, bin_centres
from presswear.recording.columns import JOINT_ARRAYS
from presswear.recording.recorder import Recorder
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Columns of ``deviation``: root mean squares, m and m/s, then s and m
COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")
# Part of a cycle by which the last row of a series may lie before the end of its cycle
_END_TOL = 1e-3
_START_TOL = 1e-9  # round-off of the start of a cycle, part of a cycle


def arrays_of(scene: Scene, ensemble: Ensemble, wear: StageWear) -> dict[str, Array]:
    """Return the arrays of a stage by their names in ``stage-K.npz``; SI units.

    Series, contacts and torques are those of the first replicate. The rows of cycles of
    the second set of replicates follow those of the first set.
    """
    recorders = ensemble.recorders
    arrays = _output_arrays(recorders[0])
    arrays["wear_batch_cycles"] = wear.weights
    cycles = [run.cycles for run in recorders]
    deviations = [deviation(scene, run) for run in recorders]
    numbers = np.arange(float(len(recorders)))
    arrays["cycles"] = np.concatenate(cycles)
    arrays["cycle_start"] = np.repeat(numbers, list(map(len, cycles)))
    arrays["deviation_start"] = np.repeat(numbers, list(map(len, deviations)))
    all_deviations = np.concatenate(deviations)
    arrays["deviation"] = all_deviations[:, : len(COLUMNS)].copy()
    for k, joint in enumerate(ensemble.linkage.clearances):
        if scene.recording.series == "all":
            is_rounded = scene.recording.digits == "single"
            arrays |= _joint_series(recorders[0], k, joint.name, is_rounded)
        arrays[f"{joint.name}_contacts"] = recorders[0].stored_contacts(k).copy()
        arrays[f"{joint.name}_flight"] = all_deviations[:, len(COLUMNS) + k].copy()
    return arrays | _wear_arrays(ensemble, wear)


def _stacked(recorder: Recorder, names: Sequence[str], joint: int | None) -> Array:
    """Return a copy of series as columns, or of one series; the recorder has spare rows."""
    columns = [recorder.series(name, joint) for name in names]
    return np.column_stack(columns) if len(columns) > 1 else columns[0].copy()


def _output_arrays(recorder: Recorder) -> dict[str, Array]:
    """Return the series of the output point, of drives, springs and sections."""
    slider = ("displacement", "velocity", "acceleration")
    arrays = {
        "time": recorder.nominal_times.copy(),
        "slider": _stacked(recorder, slider, joint=None),
    }
    if recorder.has_leader:
        arrays["clock"] = recorder.series("time").copy()
        arrays["nominal_rate"] = recorder.nominal_rates.copy()
    optional = {
        "drive_torque": recorder.torques,
        "stretch": recorder.stretches,
        "pin_stretch": recorder.pin_stretches,
    }
    if recorder.turns.size:
        optional["drive_angle"] = recorder.turns[:, 0]
        optional["drive_speed"] = recorder.turns[:, 1]
    arrays |= {name: values.copy() for name, values in optional.items() if values.size}
    if recorder.sections_per_cycle:
        arrays["sections"] = recorder.sections
    return arrays


def _joint_series(
    recorder: Recorder, joint: int, name: str, is_rounded: bool
) -> dict[str, Array]:
    """Return the series of a joint."""
    arrays = {}
    for array, names in JOINT_ARRAYS.items():
        values = _stacked(recorder, names, joint)
        if is_rounded:
            # In double precision: the trailing zeros of the numbers are compressed.
            values = values.astype(np.float32).astype(np.float64)
        arrays[f"{name}_{array}"] = values
    return arrays


def _wear_arrays(ensemble: Ensemble, wear: StageWear) -> dict[str, Array]:
    """Return the wear maps of pins, bearings and walls, and the angles of their bins."""
    depth = ensemble.together.depth.mean(axis=0)
    arrays = {}
    bins = {}
    for k, joint in enumerate(ensemble.linkage.clearances):
        if isinstance(joint, GuideCorner):
            continue
        bins[joint.name] = joint.bins
        arrays[f"{joint.name}_wear_batches"] = wear.maps[:, k, :, : joint.bins]
        for i, side in enumerate(SIDES):
            arrays[f"{joint.name}_depth_{side}"] = depth[k, i, : joint.bins]
            arrays[f"{joint.name}_wear_{side}"] = wear.added_depth[k, i, : joint.bins]
    arrays |= wall_arrays(ensemble.linkage, depth, ensemble.together.recorders)
    counts = set(bins.values())
    if len(counts) == 1:
        return arrays | {"angle": bin_centres(counts.pop())}
    for name, count in bins.items():
        arrays[f"{name}_angle"] = bin_centres(count)
    return arrays


def deviation(scene: Scene, recorder: Recorder) -> Array:
    """Return the deviation of a run from the ideal motion in each recorded cycle.

    The columns are COLUMNS and, for each clearance joint, the fraction of the time
    without contact; the shape is (cycles, columns). The lag is the delay of the ideal
    motion with the least squares of the displacement off a constant offset, to first
    order. At most ``Plan.recorded_cycles`` cycles are used. With a motor the ideal
    motion is that at the nominal time, at the nominal speed.
    """
    period = scene.mechanism.period
    last = scene.run_up + (Plan.recorded_cycles + _END_TOL) * period
    time = recorder.nominal_times
    recorded = slice(int(np.searchsorted(time, last, side="right")))
    time = time[recorded]
    clock = recorder.series("time")[recorded]
    displacement = recorder.series("displacement")[recorded]
    velocity = recorder.series("velocity")[recorded]
    open_joints = []  # 1 where a joint is open, 0 where it is closed
    for k in range(recorder.records.memory.size):
        penetration = recorder.series("penetration", k)[recorded]
        open_joints.append((penetration <= 0.0).astype(np.float64))
    deviations = []
    for first, end in pairwise(_cycle_starts(time - scene.run_up, period)):
        if end - first < 2:
            continue
        rows = slice(first, end)
        ideal = scene.ideal_slider(time[rows], closed=False)
        motion = np.column_stack([displacement[rows], velocity[rows]])
        row = _deviation_in_cycle(clock[rows], motion, ideal)
        row += [_time_mean(clock[rows], is_open[rows]) for is_open in open_joints]
        deviations.append(row)
    columns = len(COLUMNS) + len(open_joints)
    return np.array(deviations).reshape(len(deviations), columns)


def _cycle_starts(since: Array, period: float) -> list[int]:
    """Return the first row of each cycle, and of the cycle after the last complete one.

    ``since`` is the time of each row since the run-up, s.
    """
    if not since.size:
        return []
    count = math.floor(float(since[-1]) / period + _END_TOL)
    instants = period * np.arange(count + 1) - _START_TOL * period
    starts = np.searchsorted(since, instants)
    starts[-1:] = np.maximum(starts[-1:], 1)
    return [int(start) for start in starts]


def _deviation_in_cycle(clock: Array, motion: Array, ideal: Array) -> list[float]:
    """Return the numbers of COLUMNS of one cycle.

    ``motion`` and ``ideal`` have displacement and velocity in their columns.
    """
    difference = motion[:, 0] - ideal[:, 0]
    velocity_difference = motion[:, 1] - ideal[:, 1]
    ideal_velocity = ideal[:, 1]
    centred = difference - _time_mean(clock, difference)
    square = _time_mean(clock, ideal_velocity**2)
    product = _time_mean(clock, centred * ideal_velocity)
    return [
        math.sqrt(_time_mean(clock, difference**2)),
        math.sqrt(_time_mean(clock, velocity_difference**2)),
        -product / square if square > 0.0 else 0.0,
        float(np.ptp(motion[:, 0])),
    ]


def _time_mean(time: Array, values: Array) -> float:
    """Return the mean of a sampled function by the trapezoidal rule."""
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))
