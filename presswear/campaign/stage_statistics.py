"""Statistics and arrays of a stage: peaks, means over cycles with intervals, wear, deviations.

The largest value of a run is one sample of a chaotic motion; means over cycles stand
beside it. The start-up cycles are left out, where enough more ran.
"""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from presswear.campaign.bumps import bumps_of
from presswear.campaign.ensemble import Ensemble
from presswear.campaign.wear_update import (
    STEP_SAFETY,
    WearUpdate,
    cycles_of_update,
    wear_error,
)
from presswear.engines.base import Plan
from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.surface import SIDES, bin_centres
from presswear.physics.ideal import DWELL, Bottom, bottom_of, dwell_of
from presswear.physics.running_in import running_in_of, worn_off
from presswear.physics.wear import worn_volume
from presswear.recording.columns import (
    CYCLE,
    JOINT_ARRAYS,
    JOINT_CYCLE,
    Column,
    with_mean,
)
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.recording.statistics import (
    Estimate,
    after_startup,
    differ,
    half_width_of_runs,
    inefficiency,
    map_batches,
    map_errors,
    mean_range,
    peak_of,
    pooled,
    resampled,
    smoothed_mean,
    spread,
    widened,
)
from presswear.results.stage import (
    BottomStatistics,
    Bumps,
    JointStatistics,
    OutputStatistics,
    StageResult,
    StageStatistics,
    WearPeak,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

Recorders = Sequence[Recorder]
Mean = Callable[[Recorders, Recorders, str, int | None], Estimate]

_OUTPUTS = "displacement_max", "velocity_max", "acceleration_max"

# of ``deviation``: m, m/s, s, m
COLUMNS = ("displacement_off", "velocity_off", "lag", "stroke")
SHARP = 0.01  # of the scatter of bottom dead centre, over which its instant is sharp
BOOTSTRAP_SAMPLES = 10  # of a raw wear map, from which a bootstrap gives its interval
STILL = 1e-9  # of the stroke, by which an ideal slider at rest moves


@dataclass(frozen=True)
class StageWear:
    """Depth that the wear update after a stage adds, with its samples, m."""

    added_depth: Array  # (joints, 2, bins)
    # samples of it, by batches of cycles or by replicates; none: no intervals
    maps: Array
    weights: Array  # cycles in each sample, (n,)
    successive: tuple[int, ...]  # samples of each run, which are correlated
    # added in half as many steps: the difference is the error of the step
    coarser: Array | None
    by_replicate: Array  # added by each replicate alone, (replicates, joints, 2, bins)
    # True if a wear update cycle by cycle is extrapolated from surfaces that stood
    # still: the noise of few cycles hides its deepest places.
    is_frozen: bool
    is_smoothed: bool  # True if ``added_depth`` is smoothed
    # by which smoothing lowers ``added_depth`` and the samples alike
    flattening: Array | None

    def series(self, values: Array) -> list[Array]:
        """Return values of the samples by run."""
        return np.split(values, np.cumsum(self.successive)[:-1])


def stage_result(
    scene: Scene,
    index: int,
    ensemble: Ensemble,
    update: WearUpdate | None = None,
    finding: Finding | None = None,
) -> StageResult:
    """Return a stage with statistics, arrays and the wear of its update, or else of one jump."""
    together = ensemble.together
    joints = ensemble.linkage.clearances
    cycles_per_update = cycles_of_update(scene, ensemble)
    wear = _stage_wear(scene, index, cycles_per_update, ensemble, update)
    diagnostics = ensemble.diagnostics()
    film = ensemble.recorders[0].film
    if update is not None and scene.wears_in_steps:
        error = wear_error(joints, update)
    else:
        error = float(map_errors(*map_batches(together.maps)).max(initial=0.0))
    return StageResult(
        index=index,
        status=ensemble.status,
        message=ensemble.failure,
        finding=finding or ensemble.finding,
        cycles_per_update=cycles_per_update,
        wear_steps=() if update is None else update.steps,
        simulated_s=ensemble.simulated_s,
        wall_s=ensemble.state.wall,
        diagnostics=diagnostics,
        statistics=_statistics(scene, index, ensemble, wear, error, diagnostics),
        arrays=_arrays(scene, ensemble, wear),
        joint_names=tuple(joint.name for joint in joints),
        read_film=lambda: film,
    )


def _stage_wear(
    scene: Scene,
    index: int,
    factor: float,
    ensemble: Ensemble,
    update: WearUpdate | None,
) -> StageWear:
    count = ensemble.replicates
    together = ensemble.together
    batches, weights = map_batches(together.maps)
    laws = running_in_of(ensemble.linkage.clearances)
    before = together.depth.mean(axis=0)
    samples = worn_off(laws, before, factor * batches)
    coarser = None
    successive = [len(run.batches) for run in together.maps]
    if update is None:
        mean_depth = factor * smoothed_mean(together.maps, ensemble.bins)
        added_depth = worn_off(laws, before, mean_depth)
        alone = ensemble.alone
        by_replicate = worn_off(laws, alone.depth, factor * alone.added_by_run())
    else:
        added_depth = update.added_depth[:count].mean(axis=0)
        by_replicate = update.added_depth[-count:]
        coarser = None if update.coarser is None else update.coarser.mean(axis=0)
    is_in_steps = update is not None and scene.wears_in_steps
    volumes = zip(
        *(run.batches.sum(axis=(-2, -1)).T for run in together.maps), strict=True
    )
    # Cycles on one surface are no samples of the motion on other surfaces, nor are
    # those of one replicate where the worn volumes of the replicates differ at a joint:
    # replicates are.
    are_alike = index == 0 and not is_in_steps and not any(map(differ, volumes))
    if scene.replicate_count > 1 and not are_alike:
        samples = by_replicate
        weights = np.ones(len(by_replicate))
        successive = [1] * len(by_replicate)
    elif is_in_steps:
        samples = samples[:0]
        weights = weights[:0]
        successive = [0]
    is_frozen = update is None and index > 0 and scene.wears_in_steps
    is_smoothed = bool(ensemble.bins)
    flattening = None if update is None else update.flattening
    return StageWear(
        added_depth,
        samples,
        weights,
        tuple(successive),
        coarser,
        by_replicate,
        is_frozen,
        is_smoothed,
        flattening,
    )


def _statistics(
    scene: Scene,
    index: int,
    ensemble: Ensemble,
    wear: StageWear,
    wear_error: float,
    diagnostics: dict[str, float | int | str],
) -> StageStatistics:
    """Return the statistics of a stage; only its cycles if they are not finite."""
    # After the first stage the runs on surfaces of their own are the samples, not their
    # cycles.
    independent = ensemble.alone.recorders if index > 0 else ()
    recorders, alone = (
        [run for run in runs if len(run.cycles)]
        for runs in (ensemble.together.recorders, independent)
    )
    count = sum(len(run.cycles) for run in ensemble.recorders[: ensemble.replicates])
    if not recorders:
        return StageStatistics(cycles=0)
    joints = ensemble.linkage.clearances
    settling = ensemble.settling
    surfaces = bumps_of(ensemble, recorders)
    are_high = any(surface is not None and surface.are_high for surface in surfaces)
    is_mixture = settling is not None and settling.is_mixture
    mean_peak = _mean_without_interval if is_mixture or are_high else _mean
    output: dict[str, Any] = {name: _largest(recorders, name) for name in _OUTPUTS}
    output["velocity_min"] = -_largest(recorders, "velocity_min", sign=-1.0)
    output |= {
        f"{name}_per_cycle": mean_peak(recorders, alone, name) for name in _OUTPUTS
    }
    magnitude = "acceleration_max_per_cycle"
    output[magnitude] = output[magnitude].positive
    created_energy = float(diagnostics.get("contact_made_J", 0.0))
    dissipated = float(diagnostics.get("contact_loss_J", 0.0)) + created_energy
    dissipated += float(diagnostics.get("friction_loss_J", 0.0))
    statistics = StageStatistics(
        cycles=count,
        energy_made_per_cycle=_mean(recorders, alone, "contact_made").positive,
        drive_work_per_cycle=_drive_work(recorders, alone),
        output=OutputStatistics(**output),
        joints={
            joint.name: _joint_statistics(
                joint, k, recorders, alone, wear, mean_peak, surfaces[k]
            )
            for k, joint in enumerate(joints)
        },
        bdc=bottom_statistics(scene, recorders, alone),
        wear_error=wear_error if joints and math.isfinite(wear_error) else None,
        energy_residual=float(diagnostics["energy_residual_J"]),
        energy_exchanged=float(diagnostics["drive_exchange_J"]),
        energy_made_fraction=created_energy / dissipated if dissipated > 0.0 else 0.0,
        load_distance_step_error=ensemble.state.step_errors.get(
            "load_distance_step_error"
        ),
        peak_force_step_error=ensemble.state.step_errors.get("peak_force_step_error"),
        settling=settling,
        means=_means(mean_peak, recorders, alone, CYCLE),
    )
    try:
        json.dumps(asdict(statistics), allow_nan=False)
    except ValueError:  # of a run that failed
        return StageStatistics(count)
    return statistics


def _largest(
    recorders: Recorders, name: str, joint: int | None = None, sign: float = 1.0
) -> float:
    samples = (
        after_startup(recorder.each_cycle(name, joint)) for recorder in recorders
    )
    return max(float((sign * rows).max()) for rows in samples)


def _mean(
    recorders: Recorders, alone: Recorders, name: str, joint: int | None = None
) -> Estimate:
    """Return the mean over cycles of a quantity; see ``pooled``."""
    rows = (
        [run.each_cycle(name, joint) for run in runs] for runs in (recorders, alone)
    )
    return pooled(*rows)[0]


def _means(
    mean: Mean,
    recorders: Recorders,
    alone: Recorders,
    columns: tuple[Column, ...],
    joint: int | None = None,
) -> dict[str, Estimate]:
    """Return the means over cycles of the columns that declare one, by name."""
    return {
        column.name: mean(recorders, alone, column.name, joint)
        for column in with_mean(columns)
    }


def _cycle_time(recorders: Recorders, alone: Recorders) -> float:
    """Return the mean duration of a cycle, s; cycles of a motor differ."""
    if recorders[0].has_leader:
        return _mean(recorders, alone, "duration").mean
    return float(recorders[0].records.output["period"][0])


def _drive_work(recorders: Recorders, alone: Recorders) -> Estimate:
    """Return the mean drive work of a cycle, J.

    The samples are the drive work minus the change of stored energy.  In the long run
    their mean is the same.  It scatters less: energy stored at the end of a cycle is
    returned in the next.
    """

    def used(run: Recorder) -> Array:
        return run.each_cycle("drive_work") - run.each_cycle("stored_energy_change")

    return pooled(*([used(run) for run in runs] for runs in (recorders, alone)))[0]


def _mean_without_interval(
    recorders: Recorders, alone: Recorders, name: str, joint: int | None = None
) -> Estimate:
    """Return a mean over different motions, or on rough surfaces, whose interval would not hold."""
    return _mean(recorders, alone, name, joint).without_interval


def _joint_statistics(
    joint: ClearanceJoint,
    k: int,
    recorders: Recorders,
    alone: Recorders,
    wear: StageWear,
    mean_peak: Mean,
    bumps: Bumps | None,
) -> JointStatistics:
    added_depth = wear.added_depth[k, :, : joint.bins]
    maps = wear.maps[:, k, :, : joint.bins]
    coarser = None if wear.coarser is None else wear.coarser[k, :, : joint.bins]
    volume = worn_volume(joint, added_depth)
    counters = np.array([recorder.records.counters[k] for recorder in recorders])
    contacts = int(counters["contacts"].sum())
    means = _means(mean_peak, recorders, alone, JOINT_CYCLE, k)
    half = None
    if len(maps) > 1:
        volumes = np.array([worn_volume(joint, depth) for depth in maps])
        off = volume - float(np.average(volumes, weights=wear.weights))
        half = math.hypot(half_width_of_runs(wear.series(volumes)) or 0.0, off)
    error = float(map_errors(maps[:, np.newaxis], wear.weights)[0])
    return JointStatistics(
        peak_force=_largest(recorders, "force_max", k),
        peak_force_per_cycle=mean_peak(recorders, alone, "force_max", k).positive,
        contacts=contacts,
        contacts_per_cycle=mean_peak(recorders, alone, "contacts", k).positive,
        unresolved_contacts=int(counters["unresolved"].sum()),
        min_steps_per_contact=int(counters["fewest_steps"].min()) if contacts else None,
        contact_time_fraction=means["closed_time"].mean / _cycle_time(recorders, alone),
        load_distance_per_cycle=_mean(recorders, alone, "load_distance", k).positive,
        wear_volume=Estimate.symmetric(volume, half, len(maps)).positive,
        wear_volume_step_error=None
        if coarser is None
        else STEP_SAFETY * abs(worn_volume(joint, coarser) - volume),
        wear_map_error=error if math.isfinite(error) else None,
        wear_depth_max_by_replicate=tuple(
            wear.by_replicate[:, k, :, : joint.bins].max(axis=(1, 2)).tolist()
        ),
        wear_peaks={} if wear.is_frozen else _wear_peaks(joint, k, wear),
        bumps=bumps,
        means=means,
    )


def _wear_peaks(joint: ClearanceJoint, k: int, wear: StageWear) -> dict[str, WearPeak]:
    """Return the deepest places of the wear map of one joint by side.

    The largest of many noisy bins is biased, which the bootstrap corrects.  A smoothed
    map has no such bias, and a few maps are too few for a bootstrap: the interval is
    that of the samples at the deepest place.
    """
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    is_at_place = wear.is_smoothed or len(wear.maps) < BOOTSTRAP_SAMPLES
    peaks = {}

    def of_sides(maps: Array, rows: list[int]) -> Array:
        return np.asarray(maps[..., k, rows, : joint.bins].sum(axis=-2))

    for name, rows in sides.items():
        depth = of_sides(wear.added_depth, rows)
        samples = of_sides(wear.maps, rows)
        place = int(depth.argmax())
        value = float(depth.max())
        error = None
        if wear.coarser is not None:
            coarser = float(of_sides(wear.coarser, rows).max())
            error = STEP_SAFETY * abs(value - coarser)
        deepest = Estimate(value)
        angle = Estimate(float(bin_centres(joint.bins)[place]))
        if len(samples):
            centre = np.average(samples, axis=0, weights=wear.weights)
            share = inefficiency(wear.series(samples[:, place]))
            draws = centre + math.sqrt(share) * (
                resampled(samples, wear.weights) - centre
            )
            deepest, angle = peak_of(depth, draws, len(samples), centre)
            if is_at_place:
                half = half_width_of_runs(wear.series(samples[:, place]))
                deepest = Estimate.symmetric(value, half, len(samples))
                deepest = widened(deepest, value - float(centre[place]))
            if wear.flattening is not None:
                deepest = widened(
                    deepest, float(of_sides(wear.flattening, rows)[place])
                )
            deepest = widened(deepest, error or 0.0)
            deepest = deepest.positive if is_at_place else deepest
        peaks[name] = WearPeak(deepest, angle, error)
    return peaks


def bottom_statistics(
    scene: Scene, recorders: Recorders, alone: Recorders = ()
) -> BottomStatistics | None:
    """Return accuracy and repeatability at bottom dead centre after GB/T 29548-2024.

    None if there is no sampled stroke. The ideal motion of a servo that dwells there
    has no instant to be later than: there is no delay if the ideal motion stays within
    ``SHARP`` of the scatter for longer than ``DWELL``. Nor is there one if the ideal
    stroke has several equal bottoms.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return None
    finished, alone = (
        [run for run in runs if len(run.cycles) > ideal.first]
        for runs in (recorders, alone)
    )
    if not finished:
        return None
    heights = [run.each_cycle("bottom_height") for run in finished]
    samples = [after_startup(rows) for rows in heights]
    height = _mean(finished, alone, "bottom_height")
    scatter = spread(heights)
    span, count = mean_range(heights)
    near = max(0.0 if scatter is None else SHARP * scatter.mean, STILL * ideal.stroke)
    dwell = dwell_of(scene.ideal, near)
    delay = angle = delay_scatter = None
    delays, alone_delays = (
        [ideal.delay(run.each_cycle("bottom_time")) for run in runs]
        for runs in (finished, alone)
    )
    every_delay = np.concatenate(
        [after_startup(rows) for rows in (*delays, *alone_delays)]
    )
    resolution = max(0.0 if scatter is None else scatter.mean, STILL * ideal.stroke)
    equal = equal_bottoms(ideal, every_delay, resolution)
    if dwell < DWELL * ideal.period and not equal:
        delay = pooled(delays, alone_delays)[0]
        delay_scatter = spread(delays)
        angle = delay.scaled(2.0 * math.pi / ideal.period)
    return BottomStatistics(
        strokes=sum(run.size for run in samples),
        ideal_height=ideal.height,
        ideal_time=ideal.time,
        ideal_dwell=dwell,
        height=height,
        error=Estimate.symmetric(
            height.mean - ideal.height, height.half_width, height.samples
        ),
        range_of_all=float(np.ptp(np.concatenate(samples))),
        range=span,
        range_strokes=count,
        standard_deviation=scatter,
        delay=delay,
        delay_angle=angle,
        delay_standard_deviation=delay_scatter,
        equal_bottoms=equal,
    )


def equal_bottoms(ideal: Bottom, delay: Array, resolution: float) -> tuple[float, ...]:
    """Return the times in the cycle, s, of bottoms of an ideal stroke that are not told apart.

    They are the minima within ``resolution``, m, of the lowest, and those to which a
    stroke with one of the delays, s, is nearest. Empty if there is only one.
    """
    times = np.array([time for time, _ in ideal.minima])
    if times.size < 2:
        return ()
    nearest = np.abs(delay[:, np.newaxis] - (times - ideal.time)).argmin(axis=1)
    is_equal = np.array(
        [height - ideal.height < resolution for _, height in ideal.minima]
    )
    is_equal[nearest] = True
    equal = times[is_equal]
    return tuple((equal % ideal.period).tolist()) if equal.size > 1 else ()


def _arrays(scene: Scene, ensemble: Ensemble, wear: StageWear) -> dict[str, Array]:
    """Return the arrays of a stage by their names in ``stage-K.npz``; SI units.

    Series, contacts and torques are those of the first run; rows of cycles of the
    second set follow those of the first.
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
        arrays[f"{name}_wear_batches"] = wear.maps[:, k, :, : joint.bins]
        for i, side in enumerate(SIDES):
            arrays[f"{name}_depth_{side}"] = depth[k, i, : joint.bins]
            arrays[f"{name}_wear_{side}"] = wear.added_depth[k, i, : joint.bins]
    are_alike = len({joint.bins for joint in joints}) == 1
    angles = {
        "angle" if are_alike else f"{joint.name}_angle": joint.bins for joint in joints
    }
    return arrays | {name: bin_centres(bins) for name, bins in angles.items()}


def deviation(scene: Scene, recorder: Recorder) -> Array:
    """Return the deviation of a run from the ideal motion in each recorded cycle.

    It covers as many cycles as are recorded of a scene without work. The delay is the
    one by which the ideal motion fits best, up to a constant offset: by least squares,
    of first order in the delay. Columns are COLUMNS, and of each clearance joint the
    fraction of the time out of contact. With a motor the ideal motion is that at the
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
