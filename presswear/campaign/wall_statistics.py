"""Wear of the walls of guides with clearance, from the maps of all replicates."""

from collections.abc import Sequence

import numpy as np

from presswear.linkage.guide_corner import WALLS, GuideCorner, WallMap
from presswear.linkage.linkage import Linkage
from presswear.physics.wall_wear import bin_centres_of, wall_volume, walls_of
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import (
    Estimate,
    half_width,
    half_width_of_runs,
    mean_map,
)
from presswear.results.stage_statistics import WallStatistics
from presswear.tools.arrays import Array


def wall_statistics(
    linkage: Linkage, recorders: Sequence[Recorder]
) -> dict[str, dict[str, WallStatistics]]:
    """Return the wear rates of the walls of each guide by side."""
    runs = [recorder.maps for recorder in recorders]
    means = walls_of(linkage, mean_map(runs))
    if len(runs) > 1:
        # The mean map of each independent run is a sample.
        maps = [run.sampled[np.newaxis] / run.samples for run in runs]
    else:
        # The samples of a single run are its batches, which may be correlated.
        maps = [run.batches for run in runs]
    samples = [walls_of(linkage, depth) for depth in maps]
    statistics: dict[str, dict[str, WallStatistics]] = {}
    for name, corner in _corners(linkage).items():
        statistics[name] = {}
        for row, side in enumerate(WALLS):
            depths = [walls[name][:, row] for walls in samples]
            statistics[name][side] = _wall(corner, means[name][row], depths)
    return statistics


def wall_arrays(
    linkage: Linkage, depth: Array, recorders: Sequence[Recorder]
) -> dict[str, Array]:
    """Return arrays of the walls of each guide by name, m.

    They are the places of the bins, the depth of the walls in the stage from the
    ``depth`` of all joints, (joints, 2, bins), and the mean depth that a cycle adds.
    """
    depths = walls_of(linkage, depth)
    means = walls_of(linkage, mean_map([run.maps for run in recorders]))
    arrays: dict[str, Array] = {}
    for name, corner in _corners(linkage).items():
        arrays[f"{name}_wall_place"] = bin_centres_of(_map_of(corner))
        arrays[f"{name}_wall_depth"] = depths[name]
        arrays[f"{name}_wall_wear"] = means[name]
    return arrays


def _corners(linkage: Linkage) -> dict[str, GuideCorner]:
    """Return a corner of each guide whose walls have maps, by guide."""
    worn = (corner for corner in linkage.corners if corner.wall is not None)
    return {corner.guide.name: corner for corner in worn}


def _map_of(corner: GuideCorner) -> WallMap:
    assert corner.wall is not None, "see _corners"
    return corner.wall


def _wall(corner: GuideCorner, mean: Array, samples: Sequence[Array]) -> WallStatistics:
    """Return the wear rate of a wall.

    ``mean`` is its mean depth per cycle, (bins,), and ``samples`` has those of each run,
    (samples, bins), m.
    """
    deepest = int(mean.argmax())
    area = corner.width * _map_of(corner).bin_length

    def estimate(value: float, by_run: list[Array]) -> Estimate:
        values = np.concatenate(by_run)
        # The interval of a single run includes the correlation of its batches.
        half = half_width(values) if len(by_run) > 1 else half_width_of_runs(by_run)
        return Estimate.symmetric(value, half, values.size).positive

    volumes = [area * depth.sum(axis=-1) for depth in samples]
    depths = [depth[:, deepest] for depth in samples]
    return WallStatistics(
        volume_per_cycle=estimate(wall_volume(corner, mean), volumes),
        depth_per_cycle=estimate(float(mean[deepest]), depths),
        place=float(bin_centres_of(_map_of(corner))[deepest]),
    )
