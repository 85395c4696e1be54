"""A stage that ran, as results keep it."""

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.amplification import Amplification
from presswear.campaign.deviation import deviations
from presswear.campaign.ensemble import Ensemble
from presswear.campaign.statistics import stage_statistics
from presswear.linkage.surface import bin_centres
from presswear.record.soundness import Finding
from presswear.results.stage import StageResult, WearStep
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


def stage_of(
    scene: Scene,
    index: int,
    ran: Ensemble,
    added: Array,
    steps: tuple[WearStep, ...],
    finding: Finding | None,
) -> StageResult:
    """A stage with its statistics and arrays.

    Parameters
    ----------
    added : ndarray, shape (joints, 2, m)
        Depth that the wear after it adds, bearing and pin, m: the sum of its steps.
    """
    factor = Amplification.of(scene).factor(max(ran.cycles, 1))
    maps, weights = ran.batches()
    # Depth that one wear adds by each batch of the stage's cycles alone, with the mean added.
    batches = scene.represented_cycles * maps
    if len(batches):
        # Of a wear in steps, the sum of steps with the scatter of the first: in all runs but
        # that one the tolerance is wider by the root of their number.
        batches += added - np.average(batches, axis=0, weights=weights)
    statistics = stage_statistics(ran.linkage, ran.recorders, added, batches, weights)
    diagnostics = ran.diagnostics()
    statistics["energy_residual_J"] = diagnostics["energy_residual_J"]
    statistics["energy_exchanged_J"] = diagnostics["drive_exchange_J"]
    film = ran.recorders[0].film
    return StageResult(
        index=index,
        status=ran.status,
        message=ran.failure,
        finding=finding,
        amplification=steps[0].factor if steps else factor,
        wear_steps=steps,
        simulated_s=ran.time,
        wall_s=ran.wall,
        diagnostics=diagnostics,
        statistics=statistics,
        arrays=_arrays(scene, ran, added, batches, weights),
        joint_names=tuple(joint.name for joint in ran.linkage.clearances),
        read_film=lambda: film,
    )


def without_wear(scene: Scene, index: int, ran: Ensemble) -> StageResult:
    """A stage after which no wear is applied; tells what one would add in one jump."""
    added = ran.depth() * scene.represented_cycles
    return stage_of(scene, index, ran, added, (), ran.finding)


def _arrays(
    scene: Scene, ran: Ensemble, added: Array, batches: Array, weights: Array
) -> dict[str, Array]:
    """The arrays of one stage under their contracted names; SI units.

    Series, contacts and torques are those of the first start.
    """
    joints = ran.linkage.clearances
    recorder = ran.recorders[0]

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
        arrays[f"{name}_eccentricity"] = stacked("eccentricity_x", "eccentricity_y", joint=k)
        arrays[f"{name}_penetration"] = recorder.series("penetration", k).copy()
        arrays[f"{name}_force"] = stacked("normal", "tangential", joint=k)
        arrays[f"{name}_sliding"] = recorder.series("sliding", k).copy()
        arrays[f"{name}_contacts"] = recorder.episodes(k).copy()
        bins = added.shape[2]
        arrays["angle"] = bin_centres(bins)
        for side, surface, depth in (
            ("bearing", joint.bearing_surface, added[k, 0]),
            ("pin", joint.pin_surface, added[k, 1]),
        ):
            arrays[f"{name}_depth_{side}"] = surface.depth if surface.is_worn else np.zeros(bins)
            arrays[f"{name}_wear_{side}"] = depth
        arrays[f"{name}_wear_batches"] = batches[:, k]
    arrays["wear_batch_cycles"] = weights
    starts = ran.recorders
    arrays["cycles"] = np.concatenate([own.cycles for own in starts])
    arrays["cycle_start"] = np.repeat(
        np.arange(float(len(starts))), [len(own.cycles) for own in starts]
    )
    arrays |= deviations(scene, ran)
    return arrays
