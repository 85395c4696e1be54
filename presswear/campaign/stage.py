"""A stage that ran, as results keep it."""

import math
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.bottom import bottom_statistics
from presswear.campaign.deviation import deviations
from presswear.campaign.ensemble import Ensemble
from presswear.campaign.growth import Growth, error_of
from presswear.campaign.statistics import Wear, stage_statistics
from presswear.linkage.surface import bin_centres
from presswear.recording.soundness import Finding
from presswear.recording.statistics import map_errors
from presswear.results.stage import SIDES, StageResult, StageStatistics, angle_names
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


def stage_of(
    scene: Scene, index: int, ran: Ensemble, growth: Growth | None, finding: Finding | None
) -> StageResult:
    """A stage with its statistics and arrays.

    Parameters
    ----------
    growth : Growth or None
        The wear after it as far as it is known; None: what one jump would add is told.
    """
    represented = scene.cycles_per_update
    together, alone = ran.together, ran.alone
    if growth is None:
        added, by_start = represented * together.depth(), represented * alone.depths()
    else:
        added, by_start = (
            growth.added[: ran.replicates].mean(axis=0),
            growth.added[-ran.replicates :],
        )
    errors = map_errors(*together.batches())
    # Depth that one wear adds by each batch of the stage's cycles alone.
    batches, weights = together.batches()
    batches = represented * batches
    is_frozen = growth is None and index > 0 and scene.wears_in_steps
    coarser = None
    is_in_steps = growth is not None and scene.wears_in_steps
    if scene.draws > 1 and (index > 0 or is_in_steps):
        # Cycles on one surface are no draws of what other surfaces do: the starts are.
        batches = by_start
        weights = np.ones(len(batches))
    elif is_in_steps:
        batches, weights = batches[:0], weights[:0]
    if growth is not None and growth.coarser is not None:
        coarser = growth.coarser.mean(axis=0)
    single = alone.recorders if index > 0 else ()
    statistics = stage_statistics(
        ran.linkage,
        together.recorders,
        Wear(added, batches, weights, coarser, by_start, is_frozen),
        alone=single,
    )
    joints = ran.linkage.clearances
    error = float(errors.max(initial=0.0))
    if growth is not None and is_in_steps:
        error = error_of(joints, growth)
    diagnostics = ran.diagnostics()
    made = float(diagnostics.get("contact_made_J", 0.0))
    dissipated = float(diagnostics.get("contact_loss_J", 0.0)) + made
    dissipated += float(diagnostics.get("friction_loss_J", 0.0))
    statistics = replace(
        statistics,
        bdc=bottom_statistics(scene, together.recorders, single),
        wear_error=error if joints and math.isfinite(error) else None,
        energy_residual=float(diagnostics["energy_residual_J"]),
        energy_exchanged=float(diagnostics["drive_exchange_J"]),
        energy_made_fraction=made / dissipated if dissipated > 0.0 else 0.0,
        load_distance_step_error=ran.step_errors.get("load_distance_step_error"),
        peak_force_step_error=ran.step_errors.get("peak_force_step_error"),
    )
    if not _all_finite(asdict(statistics)):
        statistics = StageStatistics(statistics.cycles)
    film = ran.recorders[0].film
    steps = () if growth is None else growth.steps
    samples = max(sum(own.maps.samples for own in together.recorders), 1)
    return StageResult(
        index=index,
        status=ran.status,
        message=ran.failure,
        finding=finding,
        amplification=steps[0].factor if steps else represented * len(together.runs) / samples,
        wear_steps=steps,
        simulated_s=ran.time,
        wall_s=ran.wall,
        diagnostics=diagnostics,
        statistics=statistics,
        arrays=_arrays(scene, ran, added, batches, weights),
        joint_names=tuple(joint.name for joint in ran.linkage.clearances),
        read_film=lambda: film,
    )


def _all_finite(value: Any) -> bool:
    """Return whether all numbers in nested containers are finite."""
    if isinstance(value, dict):
        return all(map(_all_finite, value.values()))
    if isinstance(value, tuple):
        return all(map(_all_finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def without_wear(scene: Scene, index: int, ran: Ensemble) -> StageResult:
    """A stage after which no wear is applied; tells what one would add in one jump."""
    return stage_of(scene, index, ran, None, ran.finding)


def _arrays(
    scene: Scene, ran: Ensemble, added: Array, batches: Array, weights: Array
) -> dict[str, Array]:
    """The arrays of one stage under their contracted names; SI units.

    Series, contacts and torques are those of the first run; behind the starts of the first set
    stand those of the other.
    """
    joints, recording = ran.linkage.clearances, scene.recording
    recorder = ran.recorders[0]
    worn = ran.together.worn.mean(axis=0)

    def stacked(*names: str, joint: int | None = None) -> Array:
        return np.column_stack([recorder.series(name, joint) for name in names])

    # Copies: the recorder has room for much more.
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
            for word, own in series.items():
                # Rounded, and still doubles to whoever reads them: what is zero packs to nothing.
                kept = own.astype(np.float32) if recording.digits == "single" else own
                arrays[f"{name}_{word}"] = kept.astype(np.float64)
        arrays[f"{name}_contacts"] = recorder.episodes(k).copy()
        for i, side in enumerate(SIDES):
            arrays[f"{name}_depth_{side}"] = worn[k, i, : joint.bins]
            arrays[f"{name}_wear_{side}"] = added[k, i, : joint.bins]
        arrays[f"{name}_wear_batches"] = batches[:, k, :, : joint.bins]
    bins = {joint.name: joint.bins for joint in joints}
    arrays |= {angle: bin_centres(bins[name]) for name, angle in angle_names(bins).items()}
    arrays["wear_batch_cycles"] = weights
    if recorder.sections_per_cycle:
        arrays["sections"] = recorder.sections
    replicates = ran.recorders
    arrays["cycles"] = np.concatenate([own.cycles for own in replicates])
    arrays["cycle_start"] = np.repeat(
        np.arange(float(len(replicates))), [len(own.cycles) for own in replicates]
    )
    return arrays | deviations(scene, list(bins), replicates)
