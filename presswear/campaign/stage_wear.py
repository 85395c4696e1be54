"""Wear of a stage: depth that its wear update adds, its deepest places and their intervals."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from presswear.campaign.ensemble import Ensemble
from presswear.campaign.wear_update import STEP_SAFETY, WearUpdate
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.surface import bin_centres
from presswear.physics.running_in import depth_laws_of, worn_off
from presswear.recording.statistics import (
    Estimate,
    differ,
    half_width_of_runs,
    inefficiency,
    map_batches,
    peak_of,
    resampled,
    smoothed_mean,
    widened,
)
from presswear.results.stage_statistics import WearPeak
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

BOOTSTRAP_SAMPLES = 10  # samples of a raw wear map that a bootstrap needs


@dataclass(frozen=True)
class StageWear:
    """Depth that the wear update after a stage adds, with its samples, m."""

    added_depth: Array  # (joints, 2, bins)
    # samples of the depth, by batches of cycles or by replicates; none: no intervals
    maps: Array
    weights: Array  # cycles in each sample, (n,)
    successive: tuple[int, ...]  # samples of each run, which are correlated
    # depth added in half as many steps: the difference is the error of the steps
    coarser: Array | None
    by_replicate: Array  # added by each replicate, (replicates, joints, 2, bins)
    # True if the wear of an update in steps is extrapolated from cycles on constant
    # surfaces: the noise of few cycles hides the deepest places.
    is_frozen: bool
    is_smoothed: bool  # True if ``added_depth`` is smoothed
    # depth by which smoothing lowers ``added_depth`` and the samples alike
    flattening: Array | None

    @property
    def without_wear(self) -> "StageWear":
        """Wear of a stage whose surfaces do not wear."""
        return replace(
            self,
            added_depth=np.zeros_like(self.added_depth),
            maps=np.zeros_like(self.maps),
            coarser=None,
            by_replicate=np.zeros_like(self.by_replicate),
            flattening=None,
        )

    def of_joint(self, k: int, bins: int) -> "StageWear":
        """Return the wear of joint ``k``, whose arrays are over its sides and bins."""
        return self._with(lambda maps: maps[..., k, :, :bins])

    def of_sides(self, sides: list[int]) -> "StageWear":
        """Return the sum of the wear of some sides of a joint, arrays over its bins."""
        return self._with(lambda maps: maps[..., sides, :].sum(axis=-2))

    def _with(self, function: Callable[[Array], Array]) -> "StageWear":
        """Return the wear with a function of each array of depths."""
        changes: dict[str, Any] = {}
        for name in ("added_depth", "maps", "coarser", "by_replicate", "flattening"):
            depth = getattr(self, name)
            changes[name] = None if depth is None else function(depth)
        return replace(self, **changes)

    def series(self, values: Array) -> list[Array]:
        """Return values of the samples, (n,), as one series for each run."""
        return np.split(values, np.cumsum(self.successive)[:-1])


def stage_wear_of(
    scene: Scene,
    index: int,
    factor: float,
    ensemble: Ensemble,
    update: WearUpdate | None,
) -> StageWear:
    """Return the wear of a stage by its update, or by one jump of ``factor`` cycles."""
    together = ensemble.together
    laws = depth_laws_of(ensemble.linkage.clearances)
    initial_depth = together.depth.mean(axis=0)
    coarser = None
    flattening = None
    if update is None:
        mean_depth = factor * smoothed_mean(together.maps, ensemble.bins)
        added_depth = worn_off(laws, initial_depth, mean_depth)
        alone = ensemble.alone
        by_replicate = worn_off(laws, alone.depth, factor * alone.added_by_run())
    else:
        added_depth = update.added_depth[: ensemble.replicates].mean(axis=0)
        by_replicate = update.added_depth[-ensemble.replicates :]
        flattening = update.flattening
        if update.coarser is not None:
            coarser = update.coarser.mean(axis=0)
    is_in_steps = update is not None and scene.wears_in_steps
    # Cycles on one surface are not samples of the motion on other surfaces. Neither are
    # the cycles of a replicate if the replicates differ. The samples are then the
    # replicates.
    are_alike = index == 0 and not is_in_steps and not _replicates_differ(together)
    if scene.replicate_count > 1 and not are_alike:
        samples = by_replicate
        weights = np.ones(len(by_replicate))
        successive = [1] * len(by_replicate)
    elif is_in_steps:
        samples = by_replicate[:0]
        weights = np.zeros(0)
        successive = [0]
    else:
        batches, weights = map_batches(together.maps)
        samples = worn_off(laws, initial_depth, factor * batches)
        successive = [len(run.batches) for run in together.maps]
    return StageWear(
        added_depth=added_depth,
        maps=samples,
        weights=weights,
        successive=tuple(successive),
        coarser=coarser,
        by_replicate=by_replicate,
        is_frozen=update is None and index > 0 and scene.wears_in_steps,
        is_smoothed=bool(ensemble.bins),
        flattening=flattening,
    )


def _replicates_differ(ensemble: Ensemble) -> bool:
    """Return whether the worn volumes of the runs differ significantly at a joint."""
    # Worn volume of each batch of each run, shape (joints, batches)
    volumes_of_runs = [run.batches.sum(axis=(-2, -1)).T for run in ensemble.maps]
    return any(differ(volumes) for volumes in zip(*volumes_of_runs, strict=True))


def wear_peaks_of(joint: ClearanceJoint, wear: StageWear) -> dict[str, WearPeak]:
    """Return the deepest places of the wear map of a joint by side, from its wear."""
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    return {name: _peak_of_map(wear.of_sides(rows)) for name, rows in sides.items()}


def _peak_of_map(wear: StageWear) -> WearPeak:
    """Return the deepest place of one wear map.

    The largest of many noisy bins is biased, which the bootstrap corrects.  A smoothed
    map has no such bias, and a bootstrap of a few maps is not valid. The interval is
    then that of the samples at the deepest place.
    """
    depth = wear.added_depth
    samples = wear.maps
    place = int(depth.argmax())
    value = float(depth[place])
    error = None
    if wear.coarser is not None:
        error = STEP_SAFETY * abs(value - float(wear.coarser.max()))
    if not len(samples):
        angle = float(bin_centres(depth.size)[place])
        return WearPeak(Estimate(value), Estimate(angle), error)
    centre = np.average(samples, axis=0, weights=wear.weights)
    # Correlated samples scatter more than the bootstrap of independent samples shows.
    variance_ratio = inefficiency(wear.series(samples[:, place]))
    deviations = resampled(samples, wear.weights) - centre
    draws = centre + math.sqrt(variance_ratio) * deviations
    deepest, direction = peak_of(depth, draws, len(samples), centre)
    is_at_place = wear.is_smoothed or len(samples) < BOOTSTRAP_SAMPLES
    if is_at_place:
        half_width = half_width_of_runs(wear.series(samples[:, place]))
        deepest = Estimate.symmetric(value, half_width, len(samples))
        deepest = widened(deepest, value - float(centre[place]))
    if wear.flattening is not None:
        deepest = widened(deepest, float(wear.flattening[place]))
    deepest = widened(deepest, error or 0.0)
    if is_at_place:
        deepest = deepest.positive
    return WearPeak(deepest, direction, error)
