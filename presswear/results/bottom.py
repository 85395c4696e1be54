"""Bottom dead centre of stored stages: stroke by stroke, and from stage to stage."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.bottom import bottom_of
from presswear.recording.statistics import Estimate
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


def strokes_of(scene: Scene, stage: StageResult) -> list[tuple[Array, Array]]:
    """Each start's strokes, by number, and their bottoms over the ideal, m, shape (n,) each.

    None where nothing moves.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return []
    error, start = stage.each_cycle("bottom_height") - ideal.height, stage.arrays["cycle_start"]
    found = []
    for own in np.unique(start):
        rows = error[start == own][ideal.first :]
        found.append((ideal.first + 1.0 + np.arange(rows.size), rows))
    return found


def rise(stage: StageResult, since: StageResult) -> Estimate | None:
    """How much higher bottom dead centre is in a stage than in another, m; None: not known.

    The other is the unworn stage, which gives the drift over wear, or a stage of a run at
    another speed.  Both are taken as independent.
    """
    later, earlier = stage.statistics.bdc, since.statistics.bdc
    if later is None or earlier is None:
        return None
    halves = later.error.half_width, earlier.error.half_width
    half = None if None in halves else math.hypot(*filter(None, halves))
    return Estimate.symmetric(later.error.mean - earlier.error.mean, half)
