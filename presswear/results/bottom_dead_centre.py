"""Bottom dead centre of the strokes of a stage over the ideal one, and its change."""

import numpy as np

from presswear.physics.dead_centre import bottom_of
from presswear.recording.statistics import Estimate
from presswear.recording.statistics.estimate import weighted_sum
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array


def bottom_errors(scene: Scene, stage: StageResult) -> list[tuple[Array, Array]]:
    """Return the numbers and the errors of the strokes of each replicate.

    An error is the height of bottom dead centre over the ideal one, m. Each array has
    the shape (strokes,). The list is empty if nothing moves.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return []
    error = stage.each_cycle("bottom_height") - ideal.height
    start = stage.arrays["cycle_start"]
    by_replicate = []
    for replicate in np.unique(start):
        errors = error[start == replicate][ideal.first :]
        by_replicate.append((ideal.first + 1.0 + np.arange(errors.size), errors))
    return by_replicate


@checked_arguments
def rise(stage: StageResult, since: StageResult) -> Estimate | None:
    """Return how much higher bottom dead centre is in a stage than in another, m.

    ``since`` is the unworn stage, which gives the drift by wear, or the stage of a run
    at another speed. Both stages are assumed to be independent. None if either has no
    sampled stroke.
    """
    later = stage.statistics.bdc
    earlier = since.statistics.bdc
    if later is None or earlier is None:
        return None
    return weighted_sum((later.error, earlier.error), (1.0, -1.0))
