"""Bottom dead centre of stored stages: stroke by stroke, and from stage to stage."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.physics.bottom import bottom_of
from presswear.recording.sampling import Interval
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


def rise(stage: StageResult, since: StageResult) -> Interval | None:
    """How much higher bottom dead centre is in a stage than in another, m; None: not known.

    The other is the unworn stage, which gives the drift over wear, or a stage of a run at
    another speed.  Both are taken as independent.
    """
    means: list[Mapping[str, Any] | None] = [
        own.bdc.get("error_per_cycle_m") for own in (stage, since)
    ]
    later, earlier = means
    if later is None or earlier is None:
        return None
    off = later["mean"] - earlier["mean"]
    halves = later["half_width"], earlier["half_width"]
    if None in halves:
        return Interval(off, None, None)
    half = math.hypot(*halves)
    return Interval(off, off - half, off + half)
