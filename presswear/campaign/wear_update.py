"""Wear update between two stages; each replicate wears its surfaces.

Wear follows dh/dN = E[w(h)]: the mean depth that a cycle adds on the surfaces h. One
cycle of a chaotic motion is a sample of it. A wear update cycle by cycle applies the wear
of many cycles after each computed cycle. A bump carries more pressure and wears faster,
so that noise is worn away again, as long as the depth of one step is less than the
elastic overlap of the surfaces. The error of the steps is proportional to one over the
number of cycles. A refinement with twice as many cycles shows it, and twice the
difference is stated.

In one jump, as in the paper, a map is multiplied with its noise: the fewer cycles a map
has, the rougher is the surface. Maps are therefore smoothed, unless the scene keeps them
raw. The replicates then run twice: together, on the mean of all their maps, and each
alone on its own map. The runs alone are independent and give the scatter. The distance of
their mean from that of the runs together is counted as an error.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from presswear.campaign.cycle_means import CycleMeans
from presswear.campaign.ensemble import Ensemble
from presswear.campaign.limited_wear import limited_wear
from presswear.campaign.replicates import RunSpec
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES
from presswear.physics.running_in import (
    Laws,
    archard_depth,
    depth_laws_of,
    worn_off,
)
from presswear.physics.wear import map_shape, worn_volume
from presswear.recording.columns import cycle_column
from presswear.recording.settling import Settling
from presswear.recording.statistics import (
    STARTUP_CYCLES,
    half_width,
    smoothed,
    smoothed_mean,
    smoothing_widths,
)
from presswear.results.stage import StageResult, WearStep
from presswear.scene.scene import Scene
from presswear.scene.stage_names import stage_name
from presswear.tools.arrays import Array

QUICK_CYCLES = 8  # cycles of each replicate in a stage of a quick life
# cycles of each replicate in the first refinement of a wear update
FIRST_REFINEMENT = 8
# Factor on the error of the steps, because it follows from a few chaotic runs
STEP_SAFETY = 2.0
_UPDATE_CHANGE = 0.1  # part of the clearance that an update wears off by default
# Part of the clearance in a cycle below which nothing wears: under a thick oil film
_LEAST_CHANGE = 1e-15


@dataclass(frozen=True)
class WearUpdate:
    """Wear update as far as it is known."""

    # depth of the surfaces after it, (runs, joints, 2, bins), m; see ``Ensemble``
    depth: Array
    added_depth: Array  # depth that it added, m
    steps: tuple[WearStep, ...]  # steps of the update, means over the replicates
    coarser: Array | None = None  # depth added in half as many steps, m
    # by which smoothing lowers the mean of ``added_depth``, m
    flattening: Array | None = None


def initial_depth(scene: Scene) -> Array:
    """Return the depth of the surfaces at the start, shape (replicates, joints, 2, bins), m."""
    joints = scene.linkage().clearances
    depth = np.zeros(map_shape(joints))
    for k, joint in enumerate(joints):
        for i, surface in enumerate((joint.bearing_surface, joint.pin_surface)):
            if surface.is_worn:
                depth[k, i, : joint.bins] = surface.depth
    return np.repeat(depth[np.newaxis], scene.replicate_count, axis=0)


@dataclass(frozen=True)
class CycleWear:
    """The ``wear`` of a plan in which each cycle after the start-up stands for some cycles.

    Each cycle adds an extra depth as well, which may be negative. No bin gains material:
    a bin whose sum is negative stays as it is, and the depth of the other bins is reduced
    so that the volume is that of the sum. Surfaces that run in lose the depth that
    corresponds to this depth of Archard's law.
    """

    share: float  # cycles that each stands for
    laws: Laws  # laws of running-in, by joint
    extra: Array | float = 0.0  # m, shape (joints, 2, bins)
    start_up: int = STARTUP_CYCLES  # cycles

    def __call__(self, cycle: int, added_depth: Array, depth: Array) -> Array:
        """Return the depth that a cycle takes off, m; see ``Plan.wear``."""
        if cycle <= self.start_up:
            return np.zeros_like(added_depth)
        by_archard = _material_loss(self.share, self.extra, added_depth)
        return worn_off(self.laws, depth, by_archard)


def _material_loss(share: float, extra: Array | float, added_depth: Array) -> Array:
    """Return the depth by Archard's law, m, without a negative one; see ``CycleWear``."""
    wanted = added_depth * share + extra
    if np.ndim(extra) == 0:
        return wanted
    material_loss = np.maximum(wanted, 0.0)
    total = material_loss.sum(axis=-1, keepdims=True)
    remaining = np.maximum(wanted.sum(axis=-1, keepdims=True), 0.0)
    return material_loss * np.divide(
        remaining, total, out=np.ones_like(total), where=total > 0.0
    )


def jump(ensemble: Ensemble, cycles_per_update: float) -> WearUpdate:
    """Return a wear update in one jump, of all replicates together and of each alone."""
    together = ensemble.together
    alone = ensemble.alone
    mean = smoothed_mean(together.maps, ensemble.bins)
    before = together.depth
    per_cycle = np.broadcast_to(mean, before.shape)
    if ensemble.replicates > 1:
        before = np.concatenate([before, alone.depth])
        per_cycle = np.concatenate([per_cycle, alone.added_by_run()])
    joints = ensemble.linkage.clearances
    laws = depth_laws_of(joints)
    added_depth = worn_off(laws, before, cycles_per_update * per_cycle)
    depth = before + added_depth
    cycles = sum(maps.samples for maps in together.maps)
    means = CycleMeans(together.recorders)
    peaks = [means.largest("force_max", k) for k in range(len(joints))]
    step = WearStep(
        cycles_per_update=cycles_per_update,
        cycles=cycles,
        factor=cycles_per_update * ensemble.replicates / cycles,
        clearance_change=largest_change(joints, added_depth[0]),
        max_depth=by_side(joints, depth[0].max(axis=2)),
        peak_force=by_joint(joints, peaks),
        wall_s=ensemble.state.wall,
    )
    return WearUpdate(depth, added_depth, (step,))


def cycles_of_update(scene: Scene, ensemble: Ensemble) -> float:
    """Return the cycles that a wear update after some runs represents.

    By default they are those that wear the deepest place by a tenth of the clearance at
    the wear rate of the runs, to one digit; in a quick life those in which half of the
    first limit is reached.
    """
    if scene.cycles_per_update is not None and not scene.is_quick:
        return scene.cycles_per_update
    added_depth = smoothed_mean(ensemble.together.maps, ensemble.bins)
    joints = ensemble.linkage.clearances
    if scene.is_quick:
        reached = _largest_reached(scene, ensemble.linkage, added_depth)
        return max(0.5 / reached, 1.0) if reached > 0.0 else 1.0
    laws = depth_laws_of(joints)
    if any(laws):
        depth = ensemble.depth.mean(axis=0)
        cycles = _cycles_to_change(laws, joints, depth, added_depth)
    else:
        change = largest_change(joints, added_depth)
        cycles = _UPDATE_CHANGE / change if change > _LEAST_CHANGE else 1.0
    return max(float(f"{cycles:.1g}"), 1.0)


def _cycles_to_change(
    laws: Laws, joints: Sequence[ClearanceJoint], depth: Array, added_depth: Array
) -> float:
    """Return the cycles after which surfaces that run in are worn by a part of the clearance.

    ``added_depth``, m, is the depth that a cycle adds by Archard's law.
    """
    clearance = np.array([joint.clearance for joint in joints])
    deeper = depth + _UPDATE_CHANGE * clearance[:, np.newaxis, np.newaxis]
    needed = archard_depth(laws, deeper) - archard_depth(laws, depth)
    share = float((added_depth / needed).max(initial=0.0))
    return 1.0 / share if _UPDATE_CHANGE * share > _LEAST_CHANGE else 1.0


def _largest_reached(scene: Scene, linkage: Linkage, added_depth: Array) -> float:
    """Return the largest part of a limit of a quick life that some wear reaches."""
    assert scene.life is not None
    reached = []
    for limit in scene.life_limits:
        wear = limited_wear(linkage, limit)
        numbers = wear.numbers(wear.depth_of(linkage, added_depth))
        reached.append(float(numbers.max()) / wear.bound)
    return max(reached)


def start_up_of(settling: Settling | None) -> int:
    """Return the cycles of a wear update before wear begins: until all replicates have settled."""
    if settling is None or settling.verdict != "settled":
        return STARTUP_CYCLES
    return max(STARTUP_CYCLES, *(start or 0 for start in settling.starts))


def cycle_by_cycle(
    ensemble: Ensemble,
    cycles_per_update: float,
    coarser: WearUpdate | None,
    start_up: int,
) -> WearUpdate:
    """Return a wear update cycle by cycle, after one in half as many cycles, if any."""
    added_depth = ensemble.surface_depth - ensemble.depth
    runs = len(added_depth)
    bins = ensemble.bins
    widths = smoothing_widths(
        added_depth.mean(axis=0), runs, added_depth, np.ones(runs), bins
    )
    added_depth = smoothed(added_depth, widths, bins)
    depth = ensemble.depth + added_depth
    mean = added_depth.mean(axis=0)
    # A second smoothing lowers a map by about as much as the first, without the noise of
    # the raw map.
    flattening = mean - smoothed(mean, widths, bins)
    return WearUpdate(
        depth,
        added_depth,
        _steps_of(ensemble, cycles_per_update, start_up),
        None if coarser is None else coarser.added_depth,
        flattening,
    )


def _steps_of(
    ensemble: Ensemble, cycles_per_update: float, start_up: int
) -> tuple[WearStep, ...]:
    """Return the cycles after the start-up, each of which is a step of a wear update."""
    joints = ensemble.linkage.clearances
    recorders = ensemble.recorders
    # Depths that a cycle adds, and depths after it, (runs, cycles, 2, joints, sides)
    growth = np.array([recorder.growth for recorder in recorders])[:, start_up:]
    added_depth, depth = np.moveaxis(growth, 2, 0)
    clearance = np.array([joint.clearance for joint in joints])[:, np.newaxis]
    change = (added_depth / clearance).max(axis=(0, 2, 3))
    deepest = depth.mean(axis=0)
    columns = [cycle_column("force_max", k) for k in range(len(joints))]
    rows = [run.cycles[start_up:, columns] for run in recorders]
    forces = np.max(rows, axis=0)  # of all replicates in each cycle, (cycles, joints)
    cycles = len(change)
    share = cycles_per_update / cycles
    return tuple(
        WearStep(
            cycles_per_update=share,
            cycles=len(recorders),
            factor=share,
            clearance_change=float(change[n]),
            max_depth=by_side(joints, deepest[n]),
            peak_force=by_joint(joints, forces[n]),
            wall_s=ensemble.state.wall / cycles,
        )
        for n in range(cycles)
    )


def by_joint(
    joints: Sequence[ClearanceJoint], values: Iterable[float]
) -> dict[str, float]:
    """Return numbers by joint."""
    names = [joint.name for joint in joints]
    return dict(zip(names, map(float, values), strict=True))


def by_side(
    joints: Sequence[ClearanceJoint], depths: Array
) -> dict[str, dict[str, float]]:
    """Return depths of shape (joints, 2) by joint and side."""
    by_name = {}
    for joint, sides in zip(joints, depths, strict=True):
        by_name[joint.name] = dict(zip(SIDES, sides.tolist(), strict=True))
    return by_name


def largest_change(joints: Sequence[ClearanceJoint], added_depth: Array) -> float:
    """Return the largest added depth, shape (joints, 2, bins), relative to the clearance."""
    changes = [
        float(sides.max()) / joint.clearance
        for joint, sides in zip(joints, added_depth, strict=True)
    ]
    return max(changes, default=0.0)


def wear_error(joints: Sequence[ClearanceJoint], update: WearUpdate) -> float:
    """Return the largest relative error of the volumes and the deepest places of a wear update.

    The half width over the replicates and the error of the steps, twice the difference
    from the coarser update, are added as the root of the sum of squares; infinite
    without a coarser one.
    """
    if update.coarser is None:
        return math.inf

    errors = [0.0]
    for k, joint in enumerate(joints):
        fine = _volume_and_depths(joint, update.added_depth[:, k])
        coarse = _volume_and_depths(joint, update.coarser[:, k])
        for values, coarser in zip(fine, coarse, strict=True):
            mean = float(values.mean())
            if mean > 0.0:
                step = STEP_SAFETY * (mean - float(coarser.mean()))
                errors.append(math.hypot(half_width(values) or 0.0, step) / mean)
    return max(errors)


def _volume_and_depths(joint: ClearanceJoint, depth: Array) -> list[Array]:
    """Return worn volumes, m^3, and deepest places of bearing and pin, m, each (replicates,).

    ``depth`` are the worn depths, shape (replicates, 2, bins), m.
    """
    depth = depth[:, :, : joint.bins]
    volumes = np.array([worn_volume(joint, sides) for sides in depth])
    return [volumes, *depth.max(axis=2).T]


def stage_spec(scene: Scene, index: int) -> RunSpec:
    """Return the run specification of a stage: its cycles, or the tolerance of its wear maps."""
    if scene.cycles is not None:
        return RunSpec(scene.cycles)
    if scene.is_quick:
        return RunSpec(STARTUP_CYCLES + QUICK_CYCLES)
    # A jump multiplies the noise of its map. The noise changes the motion afterwards long
    # before it shows in the map. All allowed cycles therefore run, as in the paper.
    jumps = index < scene.wear_updates and not scene.wears_in_steps
    most = max(scene.max_cycles // scene.replicate_count, 1)
    if jumps or not scene.clearance_joints:
        return RunSpec(most)
    return RunSpec(most, scene.tolerance)


def refinement_spec(
    scene: Scene,
    index: int,
    cycles_per_update: float,
    update: WearUpdate | None,
    start_up: int,
) -> RunSpec | None:
    """Return the next refinement of the wear update after a stage; None if it is known.

    With the number of cycles set, half of them and then all; else twice as many in each
    refinement, until two agree, or the cycles are used up.
    """
    done = 0 if update is None else len(update.steps)
    if scene.cycles is not None:
        cycles = scene.cycles if done else max(scene.cycles // 2, 1)
        is_enough = done == scene.cycles
    else:
        most = scene.max_cycles // scene.replicate_count
        cycles = 2 * done or min(FIRST_REFINEMENT, max(most, 1))
        is_enough = update is not None and (
            cycles > most
            or wear_error(scene.linkage().clearances, update) <= scene.tolerance
        )
    if is_enough:
        return None
    label = f"{stage_name(index + 1)} in {cycles} steps"
    laws = depth_laws_of(scene.linkage().clearances)
    wear = CycleWear(cycles_per_update / cycles, laws, start_up=start_up)
    # Replicates that settled in the stage start as they did there, to settle again.
    number = 1 + done if start_up == STARTUP_CYCLES else 0
    return RunSpec(start_up + cycles, wear=wear, number=number, label=label)


def unknown_wear(scene: Scene, stage: StageResult) -> list[str]:
    """Return a message if the wear of a stage is less accurate than requested."""
    error = stage.statistics.wear_error
    if scene.cycles is not None or error is None or error <= scene.tolerance:
        return []
    # The error of sampling falls with the square root of the cycles, and refinements
    # double.
    more = (error / scene.tolerance) ** 2
    steps = len(stage.wear_steps)
    needed = more * stage.statistics.cycles
    if steps > 1:
        needed = 2.0 ** math.ceil(math.log2(more)) * steps * scene.replicate_count
    return [
        f"the error of the {stage_name(stage.index + 1)}, {100.0 * error:.2g} %, exceeds tolerance "
        f"= {100.0 * scene.tolerance:.2g} %: about max_cycles = {math.ceil(needed)} is needed"
    ]
