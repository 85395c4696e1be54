"""Statistics of a stage: peaks, means over cycles with intervals, wear.

The largest value of a run is one sample of a chaotic motion; means over cycles stand
beside it. The start-up cycles are left out, if enough other ones ran.
"""

import json
import math

import numpy as np

from presswear.campaign.bottom_statistics import bottom_statistics
from presswear.campaign.bumps import bumps_of
from presswear.campaign.cycle_means import CycleMeans
from presswear.campaign.ensemble import Ensemble
from presswear.campaign.stage_arrays import arrays_of
from presswear.campaign.stage_wear import StageWear, stage_wear_of, wear_peaks_of
from presswear.campaign.wall_statistics import wall_statistics
from presswear.campaign.wear_update import (
    STEP_SAFETY,
    WearUpdate,
    cycles_of_update,
    wear_error,
)
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner
from presswear.physics.wear import worn_volume
from presswear.recording.columns import CYCLE, FILM_CYCLE, JOINT_CYCLE
from presswear.recording.soundness import Finding
from presswear.recording.statistics import (
    Estimate,
    half_width_of_runs,
    map_batches,
    map_errors,
)
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import (
    Bumps,
    JointStatistics,
    OutputStatistics,
    StageStatistics,
)
from presswear.scene.scene import Scene


def stage_result(
    scene: Scene,
    index: int,
    ensemble: Ensemble,
    update: WearUpdate | None = None,
    finding: Finding | None = None,
) -> StageResult:
    """Return a stage with statistics, arrays and the wear of its update.

    Without an update the wear is that of one jump.
    """
    together = ensemble.together
    joints = ensemble.linkage.clearances
    cycles_per_update = cycles_of_update(scene, ensemble)
    wear = stage_wear_of(scene, index, cycles_per_update, ensemble, update)
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
        arrays=arrays_of(scene, ensemble, wear),
        joint_names=tuple(joint.name for joint in joints),
        read_film=lambda: film,
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
    # After the first stage each replicate has its surfaces, and is one sample.
    independent = ensemble.alone.recorders if index > 0 else ()
    recorders = [run for run in ensemble.together.recorders if len(run.cycles)]
    alone = [run for run in independent if len(run.cycles)]
    count = sum(len(run.cycles) for run in ensemble.recorders[: ensemble.replicates])
    if not recorders:
        return StageStatistics(cycles=0)
    settling = ensemble.settling
    bumps = bumps_of(ensemble, recorders)
    are_high = any(surface is not None and surface.are_high for surface in bumps)
    is_mixture = settling is not None and settling.is_mixture
    means = CycleMeans(recorders, alone, not (is_mixture or are_high))
    joints = {}
    for k, joint in enumerate(ensemble.linkage.clearances):
        joints[joint.name] = _joint_statistics(joint, k, means, wear, bumps[k])
    step_errors = ensemble.state.step_errors
    statistics = StageStatistics(
        cycles=count,
        energy_made_per_cycle=means.mean("contact_made").positive,
        drive_work_per_cycle=means.drive_work,
        output=_output_statistics(means),
        joints=joints,
        bdc=bottom_statistics(scene, recorders, alone),
        wear_error=wear_error if joints and math.isfinite(wear_error) else None,
        energy_residual=float(diagnostics["energy_residual_J"]),
        energy_exchanged=float(diagnostics["drive_exchange_J"]),
        energy_made_fraction=_created_fraction(diagnostics),
        load_distance_step_error=step_errors.get("load_distance_step_error"),
        peak_force_step_error=step_errors.get("peak_force_step_error"),
        settling=settling,
        means=means.declared(CYCLE),
        walls=wall_statistics(ensemble.linkage, recorders),
    )
    return statistics if _is_finite(statistics) else StageStatistics(count)


def _is_finite(statistics: StageStatistics) -> bool:
    """Return whether all numbers are finite; those of a failed run may not be."""
    try:
        json.dumps(statistics, default=vars, allow_nan=False)
    except ValueError:
        return False
    return True


def _output_statistics(means: CycleMeans) -> OutputStatistics:
    """Return the peaks of the motion of the output point."""
    return OutputStatistics(
        displacement_max=means.largest("displacement_max"),
        velocity_min=-means.largest("velocity_min", sign=-1.0),
        velocity_max=means.largest("velocity_max"),
        acceleration_max=means.largest("acceleration_max"),
        displacement_max_per_cycle=means.peak("displacement_max"),
        velocity_max_per_cycle=means.peak("velocity_max"),
        acceleration_max_per_cycle=means.peak("acceleration_max").positive,
    )


def _created_fraction(diagnostics: dict[str, float | int | str]) -> float:
    """Return the energy that contacts create over the energy that is dissipated."""
    created = float(diagnostics.get("contact_made_J", 0.0))
    dissipated = float(diagnostics.get("contact_loss_J", 0.0)) + created
    dissipated += float(diagnostics.get("friction_loss_J", 0.0))
    return created / dissipated if dissipated > 0.0 else 0.0


def _joint_statistics(
    joint: ClearanceJoint,
    k: int,
    means: CycleMeans,
    wear: StageWear,
    bumps: Bumps | None,
) -> JointStatistics:
    """Return the statistics of joint number ``k``.

    The wear of a wall, by both of its corners, is in the statistics of the walls.
    """
    is_corner = isinstance(joint, GuideCorner)
    if is_corner:
        wear = wear.without_wear
    wear = wear.of_joint(k, joint.bins)
    volume = worn_volume(joint, wear.added_depth)
    counters = np.array([recorder.records.counters[k] for recorder in means.recorders])
    contacts = int(counters["contacts"].sum())
    columns = JOINT_CYCLE if joint.oil is None else (*JOINT_CYCLE, *FILM_CYCLE)
    declared = means.declared(columns, k)
    step_error = None
    if wear.coarser is not None:
        step_error = STEP_SAFETY * abs(worn_volume(joint, wear.coarser) - volume)
    deepest = wear.by_replicate.max(axis=(1, 2))
    (map_error,) = map_errors(wear.maps[:, np.newaxis], wear.weights)
    wear_peaks = {}
    if not (wear.is_frozen or is_corner):
        wear_peaks = wear_peaks_of(joint, wear)
    return JointStatistics(
        peak_force=means.largest("force_max", k),
        peak_force_per_cycle=means.peak("force_max", k).positive,
        contacts=contacts,
        contacts_per_cycle=means.peak("contacts", k).positive,
        unresolved_contacts=int(counters["unresolved"].sum()),
        min_steps_per_contact=int(counters["fewest_steps"].min()) if contacts else None,
        contact_time_fraction=declared["closed_time"].mean / means.cycle_time,
        load_distance_per_cycle=means.mean("load_distance", k).positive,
        wear_volume=_wear_volume(joint, volume, wear),
        wear_volume_step_error=step_error,
        wear_map_error=float(map_error) if math.isfinite(map_error) else None,
        wear_depth_max_by_replicate=tuple(deepest.tolist()),
        wear_peaks=wear_peaks,
        bumps=bumps,
        means=declared,
    )


def _wear_volume(joint: ClearanceJoint, volume: float, wear: StageWear) -> Estimate:
    """Return the worn volume of a joint, m^3, with the interval of the volumes of its maps."""
    half_width = None
    if len(wear.maps) > 1:
        volumes = np.array([worn_volume(joint, depth) for depth in wear.maps])
        # The wear that is applied may differ from the mean of the maps.
        change = volume - float(np.average(volumes, weights=wear.weights))
        half_width = half_width_of_runs(wear.series(volumes)) or 0.0
        half_width = math.hypot(half_width, change)
    return Estimate.symmetric(volume, half_width, len(wear.maps)).positive
