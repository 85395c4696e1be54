"""Arrays of a stage that are stored, and its deviation from the ideal motion."""

import math
from itertools import pairwise

import numpy as np

from presswear.campaign.ensemble import Ensemble
from presswear.campaign.stage_wear import StageWear
from presswear.campaign.wall_statistics import wall_arrays
from presswear.engines.base import Plan
from presswear.linkage.elements import GuideCorner
from presswear.linkage.surface import SIDES, bin_centres
from presswear.recording.columns import JOINT_ARRAYS
from presswear.recording.recorder import Recorder
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# columns of ``deviation``: m, m/s, s, m
COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")


def arrays_of(scene: Scene, ensemble: Ensemble, wear: StageWear) -> dict[str, Array]:
    """Return the arrays of a stage by their names in ``stage-K.npz``; SI units.

    Series, contacts and torques are those of the first replicate. The rows of cycles of
    the second set of replicates follow those of the first set.
    """
    joints = ensemble.linkage.clearances
    recording = scene.recording
    recorder = ensemble.recorders[0]
    recorders = ensemble.recorders
    depth = ensemble.together.depth.mean(axis=0)

    def stacked(*names: str, joint: int | None = None) -> Array:
        # Copies: the arrays of the recorder are much longer.
        columns = [recorder.series(name, joint) for name in names]
        values = np.column_stack(columns) if len(columns) > 1 else columns[0].copy()
        if joint is None or recording.digits != "single":
            return values
        # Rounded numbers in double precision: their trailing zeros are compressed.
        return values.astype(np.float32).astype(np.float64)

    arrays = {
        "time": recorder.nominal_times.copy(),
        "slider": stacked("displacement", "velocity", "acceleration"),
        "wear_batch_cycles": wear.weights,
        "cycles": np.concatenate([run.cycles for run in recorders]),
    }
    if recorder.has_leader:
        arrays["clock"] = stacked("time")
        arrays["nominal_rate"] = recorder.nominal_rates.copy()
    if recorder.torques.size:
        arrays["drive_torque"] = recorder.torques.copy()
    if recorder.stretches.size:
        arrays["stretch"] = recorder.stretches.copy()
    if recorder.pin_stretches.size:
        arrays["pin_stretch"] = recorder.pin_stretches.copy()
    if recorder.turns.size:
        arrays["drive_angle"] = recorder.turns[:, 0].copy()
        arrays["drive_speed"] = recorder.turns[:, 1].copy()
    if recorder.sections_per_cycle:
        arrays["sections"] = recorder.sections
    deviations = [deviation(scene, run) for run in recorders]
    each = np.concatenate(deviations)
    cycles = [run.cycles for run in recorders]
    numbers = np.arange(float(len(recorders)))
    arrays["cycle_start"] = np.repeat(numbers, list(map(len, cycles)))
    arrays["deviation_start"] = np.repeat(numbers, list(map(len, deviations)))
    arrays["deviation"] = each[:, : len(COLUMNS)].copy()
    for k, joint in enumerate(joints):
        name = joint.name
        if recording.series == "all":
            for array, names in JOINT_ARRAYS.items():
                arrays[f"{name}_{array}"] = stacked(*names, joint=k)
        arrays[f"{name}_contacts"] = recorder.stored_contacts(k).copy()
        arrays[f"{name}_flight"] = each[:, len(COLUMNS) + k].copy()
        if isinstance(joint, GuideCorner):
            continue
        arrays[f"{name}_wear_batches"] = wear.maps[:, k, :, : joint.bins]
        for i, side in enumerate(SIDES):
            arrays[f"{name}_depth_{side}"] = depth[k, i, : joint.bins]
            arrays[f"{name}_wear_{side}"] = wear.added_depth[k, i, : joint.bins]
    arrays |= wall_arrays(ensemble.linkage, depth, ensemble.together.recorders)
    pins = [joint for joint in joints if not isinstance(joint, GuideCorner)]
    are_alike = len({joint.bins for joint in pins}) == 1
    angles = {
        "angle" if are_alike else f"{joint.name}_angle": joint.bins for joint in pins
    }
    return arrays | {name: bin_centres(bins) for name, bins in angles.items()}


def deviation(scene: Scene, recorder: Recorder) -> Array:
    """Return the deviation of a run from the ideal motion in each recorded cycle.

    Not more cycles are used than are recorded of a scene without work. The lag is the
    delay of the ideal motion with the least squares of the displacement off a constant
    offset, to first order. The columns are COLUMNS and, for each clearance joint, the
    fraction of the time without contact. With a motor the ideal motion is that at the
    nominal time, at the nominal speed.
    """
    last = scene.run_up + (Plan.recorded_cycles + 1e-3) * scene.mechanism.period
    time = recorder.nominal_times
    recorded = slice(int(np.searchsorted(time, last, side="right")))
    time = time[recorded]
    clock, moved, speed = (
        recorder.series(name)[recorded] for name in ("time", "displacement", "velocity")
    )
    joints = range(recorder.records.memory.size)
    flights = [
        (recorder.series("penetration", k)[recorded] <= 0.0).astype(np.float64)
        for k in joints
    ]
    since = time - scene.run_up
    period = scene.mechanism.period
    # The last row of a series may lie a rounding before the end of its cycle.
    count = math.floor(float(since[-1]) / period + 1e-3) if since.size else -1
    ends = np.searchsorted(since, period * np.arange(count + 1) - 1e-9 * period)
    ends[-1:] = np.maximum(ends[-1:], 1)
    deviations = []
    for first, end in pairwise(map(int, ends)):
        if end - first < 2:
            continue
        rows = slice(first, end)
        at = clock[rows]
        ideal = scene.ideal_slider(time[rows], closed=False)
        off = moved[rows] - ideal[:, 0]
        velocity_difference = speed[rows] - ideal[:, 1]
        wanted = ideal[:, 1]
        centred = off - _time_mean(at, off)
        square = _time_mean(at, wanted**2)
        lag = -_time_mean(at, centred * wanted) / square if square > 0.0 else 0.0
        means = (off**2, velocity_difference**2, *(flight[rows] for flight in flights))
        off_mean, faster_mean, *open_parts = (
            _time_mean(at, values) for values in means
        )
        stroke = float(np.ptp(moved[rows]))
        deviations.append(
            [math.sqrt(off_mean), math.sqrt(faster_mean), lag, stroke, *open_parts]
        )
    return np.array(deviations).reshape(len(deviations), len(COLUMNS) + len(flights))


def _time_mean(time: Array, values: Array) -> float:
    """Return the mean of a sampled function by the trapezoidal rule."""
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))
