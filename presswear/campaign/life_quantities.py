"""Quantities of a service life, from surfaces and from strokes."""

from collections.abc import Sequence

import numpy as np

from presswear.campaign.replicates import linkage_on
from presswear.linkage.guide_corner import GuideCorner
from presswear.physics.dead_centre import bottom_of
from presswear.physics.statics import total_clearance
from presswear.physics.wall_wear import tilt_between, wall_volume, walls_of
from presswear.physics.wear import largest_play, worn_volume
from presswear.recording.columns import cycle_column
from presswear.scene.options import NEW_OVER_CLEARANCE
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def levels_of(scene: Scene, depth: Array, limited: Sequence[str]) -> dict[str, Array]:
    """Return the quantities of surfaces of shape (histories, joints, 2, bins), m, by key.

    Clearances take long and are computed only if a limit is on one of them.
    """
    levels = {}
    linkage = scene.linkage()
    has_clearance_limit = not NEW_OVER_CLEARANCE.keys().isdisjoint(limited)
    for k, joint in enumerate(linkage.clearances):
        if isinstance(joint, GuideCorner):
            continue
        surfaces = depth[:, k, :, : joint.bins]  # one for each history
        volumes = [worn_volume(joint, worn) for worn in surfaces]
        levels[f"{joint.name}.depth"] = surfaces.max(axis=(1, 2))
        levels[f"{joint.name}.wear_volume"] = np.array(volumes)
        if has_clearance_limit:
            play = np.array([largest_play(joint, worn) for worn in surfaces])
            levels[f"{joint.name}.radial_clearance"] = 0.5 * play
            levels[f"{joint.name}.diametral_clearance"] = play
    # All corners of a guide have the same walls.
    corners = {corner.guide.name: corner for corner in linkage.corners}
    for guide, walls in walls_of(linkage, depth).items():
        corner = corners[guide]
        volumes = [wall_volume(corner, wall) for wall in walls]
        tilts = [tilt_between(corner, wall) for wall in walls]
        levels[f"{guide}.depth"] = walls.max(axis=(1, 2))
        levels[f"{guide}.wear_volume"] = np.array(volumes)
        levels[f"{guide}.tilt"] = np.array(tilts)
    if "total_clearance" in limited:
        travels = [total_clearance(linkage_on(scene, joints)) for joints in depth]
        levels["total_clearance"] = np.array(travels)
    return levels


def pseudo_levels_of(
    scene: Scene, depth: Array, limited: Sequence[str]
) -> dict[str, Array]:
    """Return pseudo-values of the quantities of the mean surfaces of several histories, by key.

    Noise makes the deepest place of a map too deep. The mean of the pseudo-values of the
    jackknife has no error of first order in 1 / histories; that of the mean surfaces has.
    """
    count = len(depth)
    mean_of_all = depth.mean(axis=0, keepdims=True)
    means_of_others = (depth.sum(axis=0) - depth) / (count - 1)
    levels = levels_of(scene, mean_of_all, limited)
    levels_without = levels_of(scene, means_of_others, limited)  # without each history
    return {
        key: count * levels[key] - (count - 1) * values
        for key, values in levels_without.items()
    }


def samples_of(scene: Scene, rows: Array) -> dict[str, Array]:
    """Return the quantities of rows of cycles, shape (histories, cycles, columns), by key."""
    samples = {}
    corners: dict[str, list[int]] = {guide.name: [] for guide in scene.worn_guides}
    for k, joint in enumerate(scene.linkage().clearances):
        column = cycle_column("force_max", k)
        samples[f"{joint.name}.force_max"] = rows[:, :, column].mean(axis=1)
        if isinstance(joint, GuideCorner) and joint.guide.name in corners:
            corners[joint.guide.name].append(column)
    for guide, columns in corners.items():
        greatest = rows[:, :, columns].max(axis=2)
        samples[f"{guide}.force_max"] = greatest.mean(axis=1)
    ideal = bottom_of(scene.ideal)
    if ideal is not None:
        error = rows[:, :, cycle_column("bottom_height")] - ideal.height
        mean = error.mean(axis=1)
        if error.shape[1] == 1:
            # With one cycle the variance is that between the histories.
            variance = np.full(len(error), error.var(ddof=1))
        else:
            variance = error.var(axis=1, ddof=1)
        # ``refinement`` computes the drift as the change of the mean error, and the
        # repeatability as the square root of the mean variance.
        samples["bdc_error"] = mean
        samples["bdc_drift"] = mean
        samples["repeatability"] = variance
    return samples
