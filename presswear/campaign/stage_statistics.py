"""Statistics and arrays of a stage: peaks, means over cycles with intervals, wear, deviations.

The largest value of a run is one sample of a chaotic motion; means over cycles stand beside it.
The start-up cycles are left out, where enough more ran.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import Ensemble
from presswear.campaign.wear_update import WearUpdate, wear_error
from presswear.engines.base import Plan
from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES, bin_centres
from presswear.physics.ideal import DWELL, bottom_of, dwell_of
from presswear.physics.wear import worn_volume
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.recording.statistics import (
    Estimate,
    after_startup,
    half_width,
    map_errors,
    mean_range,
    peak_of,
    pooled,
    resampled,
    spread,
    widened,
)
from presswear.results.stage import (
    BottomStatistics,
    JointStatistics,
    OutputStatistics,
    StageResult,
    StageStatistics,
    WearPeak,
    angle_names,
)
from presswear.scene.scene import Scene

Array = NDArray[np.float64]
Recorders = Sequence[Recorder]

COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")  # of ``deviation``: m, m/s, s, m
SHARP = 0.01  # of the scatter of bottom dead centre, over which its instant is sharp
STILL = 1e-9  # of the stroke, by which an ideal slider at rest moves


@dataclass(frozen=True)
class StageWear:
    """Depth that one wear update adds, with its samples.

    Attributes
    ----------
    added : ndarray, shape (joints, 2, bins)
        Depth that it adds to bearing and pin, m.
    maps : ndarray, shape (n, joints, 2, bins)
        Samples of it, by batches of cycles or by replicates, m; empty: no intervals.
    weights : ndarray, shape (n,)
        Cycles in each sample.
    coarser : ndarray or None
        Depth added in half as many steps, m; the difference is the error of the step.
    by_replicate : ndarray, shape (replicates, joints, 2, bins)
        Depth added by each replicate alone, m.
    is_frozen : bool
        True if a wear update cycle by cycle is extrapolated from surfaces that stood still: the
        noise of few cycles hides its deepest places.
    """

    added: Array
    maps: Array
    weights: Array
    coarser: Array | None
    by_replicate: Array
    is_frozen: bool

    def of_joint(self, k: int, bins: int) -> "StageWear":
        """Return the wear of joint ``k``: arrays without the axis of joints, with its bins."""
        return replace(
            self,
            added=self.added[k, :, :bins],
            maps=self.maps[:, k, :, :bins],
            coarser=None if self.coarser is None else self.coarser[k, :, :bins],
            by_replicate=self.by_replicate[:, k, :, :bins],
        )


def _joint_statistics(
    joint: ClearanceJoint, k: int, recorders: Recorders, alone: Recorders, wear: StageWear
) -> JointStatistics:
    """Return the statistics of one clearance joint; see ``stage_statistics``."""
    wear = wear.of_joint(k, joint.bins)
    added, maps, weights, coarser = wear.added, wear.maps, wear.weights, wear.coarser
    mean, volume = mean_of(recorders, alone), worn_volume(joint, added)
    force = [recorder.each_cycle("force_max", k) for recorder in recorders]
    counters = np.array([recorder.records.counters[k] for recorder in recorders])
    contacts = int(counters["contacts"].sum())
    time = sum(recorder.last_time for recorder in recorders)
    half = None
    if len(maps) > 1:
        volumes = np.array([worn_volume(joint, depth) for depth in maps])
        off = volume - float(np.average(volumes, weights=weights))
        half = math.hypot(half_width(volumes) or 0.0, off)
    error = float(map_errors(maps[:, np.newaxis], weights)[0])
    return JointStatistics(
        peak_force=float(max(after_startup(peaks).max() for peaks in force)),
        peak_force_per_cycle=mean(lambda run: run.each_cycle("force_max", k)),
        contacts=contacts,
        contacts_per_cycle=mean(lambda run: run.each_cycle("contacts", k)),
        unresolved_contacts=int(counters["unresolved"].sum()),
        min_steps_per_contact=int(counters["fewest_steps"].min()) if contacts else None,
        contact_time_fraction=float(counters["closed_time"].sum()) / time,
        load_distance_per_cycle=mean(lambda run: run.each_cycle("load_distance", k)),
        wear_volume=Estimate.symmetric(volume, half, len(maps)),
        wear_volume_step_error=(
            None if coarser is None else abs(worn_volume(joint, coarser) - volume)
        ),
        wear_map_error=error if math.isfinite(error) else None,
        wear_depth_max_by_replicate=tuple(wear.by_replicate.max(axis=(1, 2)).tolist()),
        wear_peaks={} if wear.is_frozen else _wear_peaks(joint, wear),
    )


def _wear_peaks(joint: ClearanceJoint, wear: StageWear) -> dict[str, WearPeak]:
    """Return the deepest places of the wear map of one joint by side."""
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    angles = bin_centres(wear.added.shape[1])
    peaks = {}
    for name, rows in sides.items():
        depth = wear.added[rows].sum(axis=0)
        deepest = float(depth.max())
        error = None
        if wear.coarser is not None:
            error = abs(float(deepest - wear.coarser[rows].sum(axis=0).max()))
        estimates = Estimate(deepest), Estimate(float(angles[int(depth.argmax())]))
        if len(wear.maps):
            drawn = wear.maps[:, rows].sum(axis=1)
            draws = resampled(drawn, wear.weights)
            centre = np.average(drawn, axis=0, weights=wear.weights)
            peak = peak_of(depth, draws, len(wear.maps), centre)
            estimates = widened(peak[0], error or 0.0), peak[1]
        peaks[name] = WearPeak(*estimates, error)
    return peaks


def mean_of(
    recorders: Recorders, alone: Recorders
) -> Callable[[Callable[[Recorder], Array]], Estimate]:
    """Return a function that estimates the mean of a quantity that recorders have of each cycle.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """

    def mean(each: Callable[[Recorder], Array]) -> Estimate:
        return pooled([each(run) for run in recorders], [each(run) for run in alone])[0]

    return mean


def stage_statistics(
    linkage: Linkage, recorders: Recorders, wear: StageWear, alone: Recorders = ()
) -> StageStatistics:
    """Return the statistics of one stage that its recorders and its wear give.

    Parameters
    ----------
    recorders : sequence of Recorder
        One for each replicate.
    alone : sequence of Recorder
        One for each replicate on surfaces of its own, where the runs are the samples, not their
        cycles; they may be the same.
    """
    finished, alone = ([run for run in runs if len(run.cycles)] for runs in (recorders, alone))
    if not finished:
        return StageStatistics(cycles=0)
    mean = mean_of(finished, alone)
    displacement, slowest, fastest, acceleration = (
        [after_startup(recorder.each_cycle(name)) for recorder in finished]
        for name in ("displacement_max", "velocity_min", "velocity_max", "acceleration_max")
    )
    return StageStatistics(
        cycles=sum(len(run.cycles) for run in finished),
        energy_made_per_cycle=mean(lambda run: run.each_cycle("contact_made")),
        drive_work_per_cycle=mean(lambda run: run.each_cycle("drive_work")),
        output=OutputStatistics(
            displacement_max=float(max(values.max() for values in displacement)),
            velocity_min=float(min(values.min() for values in slowest)),
            velocity_max=float(max(values.max() for values in fastest)),
            acceleration_max=float(max(values.max() for values in acceleration)),
            displacement_max_per_cycle=mean(lambda run: run.each_cycle("displacement_max")),
            velocity_max_per_cycle=mean(lambda run: run.each_cycle("velocity_max")),
            acceleration_max_per_cycle=mean(lambda run: run.each_cycle("acceleration_max")),
        ),
        joints={
            joint.name: _joint_statistics(joint, k, finished, alone, wear)
            for k, joint in enumerate(linkage.clearances)
        },
    )


def bottom_statistics(
    scene: Scene, recorders: Recorders, alone: Recorders = ()
) -> BottomStatistics | None:
    """Return accuracy and repeatability at bottom dead centre after GB/T 29548-2024.

    None if there is no settled stroke. The ideal motion of a servo that dwells there has no instant
    to be later than: there is no delay if the ideal motion stays within ``SHARP`` of the scatter
    for longer than ``DWELL``.

    Parameters
    ----------
    recorders, alone : sequence of Recorder
        As in ``stage_statistics``.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return None
    finished, alone = (
        [run for run in runs if len(run.cycles) > ideal.first] for runs in (recorders, alone)
    )
    if not finished:
        return None
    turn = 2.0 * math.pi / ideal.period

    def heights(run: Recorder) -> Array:
        return run.each_cycle("bottom_height")

    def delays(run: Recorder) -> Array:
        return ideal.delay(run.each_cycle("bottom_time"))

    mean = mean_of(finished, alone)
    settled = [after_startup(heights(run)) for run in finished]
    height = mean(heights)
    span, count = mean_range(list(map(heights, finished)))
    scatter = spread(list(map(heights, finished)))
    near = max(0.0 if scatter is None else SHARP * scatter.mean, STILL * ideal.stroke)
    dwell = dwell_of(scene.ideal, near)
    delay: dict[str, Estimate | None] = {}
    if dwell < DWELL * ideal.period:
        delay = {
            "delay": mean(delays),
            "delay_angle": mean(lambda run: turn * delays(run)),
            "delay_standard_deviation": spread(list(map(delays, finished))),
        }
    return BottomStatistics(
        strokes=sum(run.size for run in settled),
        ideal_height=ideal.height,
        ideal_time=ideal.time,
        ideal_dwell=dwell,
        height=height,
        error=Estimate.symmetric(height.mean - ideal.height, height.half_width, height.samples),
        range_of_all=float(max(run.max() for run in settled) - min(run.min() for run in settled)),
        range=span,
        range_strokes=count,
        standard_deviation=scatter,
        **delay,
    )


def stage_result(
    scene: Scene,
    index: int,
    ensemble: Ensemble,
    update: WearUpdate | None = None,
    finding: Finding | None = None,
) -> StageResult:
    """Return a stage with its statistics and arrays.

    Parameters
    ----------
    update : WearUpdate or None
        Wear update after the stage, as far as it is known; None: the statistics are of what one
        jump would add.
    """
    together, joints = ensemble.together, ensemble.linkage.clearances
    batches, weights = together.batches()
    error = float(map_errors(batches, weights).max(initial=0.0))
    is_in_steps = update is not None and scene.wears_in_steps
    if update is not None and is_in_steps:
        error = wear_error(joints, update)
    wear = _stage_wear(scene, index, ensemble, update)
    alone = ensemble.alone.recorders if index > 0 else ()
    diagnostics = ensemble.diagnostics()
    made = float(diagnostics.get("contact_made_J", 0.0))
    dissipated = float(diagnostics.get("contact_loss_J", 0.0)) + made
    dissipated += float(diagnostics.get("friction_loss_J", 0.0))
    statistics = replace(
        stage_statistics(ensemble.linkage, together.recorders, wear, alone),
        bdc=bottom_statistics(scene, together.recorders, alone),
        wear_error=error if joints and math.isfinite(error) else None,
        energy_residual=float(diagnostics["energy_residual_J"]),
        energy_exchanged=float(diagnostics["drive_exchange_J"]),
        energy_made_fraction=made / dissipated if dissipated > 0.0 else 0.0,
        load_distance_step_error=ensemble.state.step_errors.get("load_distance_step_error"),
        peak_force_step_error=ensemble.state.step_errors.get("peak_force_step_error"),
    )
    if not _all_finite(asdict(statistics)):
        statistics = StageStatistics(statistics.cycles)
    film = ensemble.recorders[0].film
    steps = () if update is None else update.steps
    samples = max(sum(recorder.maps.samples for recorder in together.recorders), 1)
    factor = scene.cycles_per_update * len(together.runs) / samples
    return StageResult(
        index=index,
        status=ensemble.status,
        message=ensemble.failure,
        finding=finding or ensemble.finding,
        amplification=steps[0].factor if steps else factor,
        wear_steps=steps,
        simulated_s=sum(run.time for run in ensemble.runs),
        wall_s=ensemble.state.wall,
        diagnostics=diagnostics,
        statistics=statistics,
        arrays=_arrays(scene, ensemble, wear),
        joint_names=tuple(joint.name for joint in joints),
        read_film=lambda: film,
    )


def _stage_wear(
    scene: Scene, index: int, ensemble: Ensemble, update: WearUpdate | None
) -> StageWear:
    """Return the depth that the wear update after a stage adds, with its samples."""
    factor, count = scene.cycles_per_update, ensemble.replicates
    batches, weights = ensemble.together.batches()
    samples = factor * batches
    if update is None:
        added = factor * ensemble.together.mean_added()
        by_replicate = factor * ensemble.alone.added_by_run()
    else:
        added, by_replicate = update.added[:count].mean(axis=0), update.added[-count:]
    is_in_steps = update is not None and scene.wears_in_steps
    if scene.replicate_count > 1 and (index > 0 or is_in_steps):
        # Cycles on one surface are no samples of the motion on other surfaces: replicates are.
        samples, weights = by_replicate, np.ones(len(by_replicate))
    elif is_in_steps:
        samples, weights = samples[:0], weights[:0]
    coarser = None
    if update is not None and update.coarser is not None:
        coarser = update.coarser.mean(axis=0)
    is_frozen = update is None and index > 0 and scene.wears_in_steps
    return StageWear(added, samples, weights, coarser, by_replicate, is_frozen)


def _all_finite(value: Any) -> bool:
    """Return whether all numbers in nested containers are finite."""
    if isinstance(value, dict):
        return all(map(_all_finite, value.values()))
    if isinstance(value, tuple):
        return all(map(_all_finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def _arrays(scene: Scene, ensemble: Ensemble, wear: StageWear) -> dict[str, Array]:
    """Return the arrays of a stage by their names in ``stage-K.npz``; SI units.

    Series, contacts and torques are those of the first run; rows of cycles of the second set
    follow those of the first.
    """
    joints, recording = ensemble.linkage.clearances, scene.recording
    recorder, recorders = ensemble.recorders[0], ensemble.recorders
    depth = ensemble.together.depth.mean(axis=0)

    def stacked(*names: str, joint: int | None = None) -> Array:
        return np.column_stack([recorder.series(name, joint) for name in names])

    # Copies: the arrays of the recorder are much longer.
    arrays: dict[str, Array] = {
        "time": recorder.series("time").copy(),
        "slider": stacked("displacement", "velocity", "acceleration"),
    }
    if recorder.torques.size:
        arrays["drive_torque"] = recorder.torques.copy()
    for k, joint in enumerate(joints):
        name = joint.name
        if recording.series == "all":
            series = {
                "eccentricity": stacked("eccentricity_x", "eccentricity_y", joint=k),
                "penetration": recorder.series("penetration", k).copy(),
                "force": stacked("normal", "tangential", joint=k),
                "sliding": recorder.series("sliding", k).copy(),
            }
            for word, values in series.items():
                # Rounded numbers in double precision: their trailing zeros are compressed.
                is_single = recording.digits == "single"
                rounded = values.astype(np.float32) if is_single else values
                arrays[f"{name}_{word}"] = rounded.astype(np.float64)
        arrays[f"{name}_contacts"] = recorder.stored_contacts(k).copy()
        for i, side in enumerate(SIDES):
            arrays[f"{name}_depth_{side}"] = depth[k, i, : joint.bins]
            arrays[f"{name}_wear_{side}"] = wear.added[k, i, : joint.bins]
        arrays[f"{name}_wear_batches"] = wear.maps[:, k, :, : joint.bins]
    bins = {joint.name: joint.bins for joint in joints}
    arrays |= {angle: bin_centres(bins[name]) for name, angle in angle_names(bins).items()}
    arrays["wear_batch_cycles"] = wear.weights
    if recorder.sections_per_cycle:
        arrays["sections"] = recorder.sections
    arrays["cycles"] = np.concatenate([run.cycles for run in recorders])
    counts = [len(run.cycles) for run in recorders]
    arrays["cycle_start"] = np.repeat(np.arange(float(len(recorders))), counts)
    rows = [deviation(scene, run) for run in recorders]
    counts, deviations = list(map(len, rows)), np.concatenate(rows)
    arrays["deviation_start"] = np.repeat(np.arange(float(len(recorders))), counts)
    arrays["deviation"] = deviations[:, : len(COLUMNS)].copy()
    for name, flight in zip(bins, deviations[:, len(COLUMNS) :].T, strict=True):
        arrays[f"{name}_flight"] = flight.copy()
    return arrays


def deviation(scene: Scene, recorder: Recorder) -> Array:
    """Return the deviation of a run from the ideal motion in each recorded cycle.

    It covers as many cycles as are recorded of a scene without work. The delay is the one by which
    the ideal motion fits best, up to a constant offset: by least squares, of first order in the
    delay.

    Returns
    -------
    ndarray, shape (cycles, 4 + joints)
        COLUMNS, and of each clearance joint the fraction of the time out of contact.
    """
    last = scene.run_up + (Plan.recorded_cycles + 1e-3) * scene.mechanism.period
    recorded = slice(int(np.searchsorted(recorder.series("time"), last, side="right")))
    time, moved, speed = (
        recorder.series(name)[recorded] for name in ("time", "displacement", "velocity")
    )
    joints = range(recorder.records.memory.size)
    flights = [
        (recorder.series("penetration", k)[recorded] <= 0.0).astype(np.float64) for k in joints
    ]
    deviations = []
    for rows in whole_cycles(time - scene.run_up, scene.mechanism.period):
        at = time[rows]
        ideal = scene.ideal_slider(at, closed=False)
        off, faster, wanted = moved[rows] - ideal[:, 0], speed[rows] - ideal[:, 1], ideal[:, 1]
        centred, square = off - _time_mean(at, off), _time_mean(at, wanted**2)
        lag = -_time_mean(at, centred * wanted) / square if square > 0.0 else 0.0
        deviations.append(
            [
                math.sqrt(_time_mean(at, off**2)),
                math.sqrt(_time_mean(at, faster**2)),
                lag,
                float(np.ptp(moved[rows])),
                *(_time_mean(at, flight[rows]) for flight in flights),
            ]
        )
    return np.array(deviations).reshape(len(deviations), len(COLUMNS) + len(flights))


def whole_cycles(time: Array, period: float) -> list[slice]:
    """Return the rows of each complete cycle of a series at times in s, shape (n,)."""
    if time.size == 0 or time[-1] < 0.0:
        return []
    # The last row of a series may lie a rounding before the end of its cycle.
    count = math.floor(float(time[-1]) / period + 1e-3)
    ends = np.searchsorted(time, period * np.arange(count + 1) - 1e-9 * period)
    ends[-1] = max(ends[-1], 1)
    return [slice(int(first), int(last)) for first, last in pairwise(ends) if last - first > 1]


def _time_mean(time: Array, values: Array) -> float:
    """Return the mean of a sampled function by the trapezoidal rule."""
    return float(np.trapezoid(values, time) / (time[-1] - time[0]))
