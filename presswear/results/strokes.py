"""Strokes of a press on its work, from what a stage recorded."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.physics.load_modes import sizes_over
from presswear.physics.touchdown import crossing, hermite
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Strokes:
    """Moments of the recorded strokes on the work; see ``strokes_of``.

    Attributes
    ----------
    contact, fracture, separation : ndarray, shape (strokes, 2)
        Time, s, and height over the ideal bottom dead centre, m, at which what is watched comes
        to the work, at which that breaks, and at which it leaves the height of the work again;
        not a number where there is none.
    """

    contact: Array
    fracture: Array
    separation: Array


def height_of(scene: Scene, stage: StageResult) -> Array:
    """Height of what is watched over the ideal bottom dead centre, shape (n,), m."""
    return np.asarray(_place(scene, stage) - scene.bottom)


def _place(scene: Scene, stage: StageResult) -> Array:
    """Watched coordinate at the times of the series, shape (n,), m."""
    begun = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    return np.asarray(stage.displacement + begun)


def process_force(scene: Scene, stage: StageResult) -> Array | None:
    """Force of the work on what is watched, shape (n,), N; None where the scene has no process.

    Positive away from the work.  It is that of the run itself, by the laws and modes of the loads,
    at the times of the series.
    """
    if scene.process is None:
        return None
    series = (stage.time, _place(scene, stage), stage.velocity, stage.acceleration)
    sizes = sizes_over(scene.process_laws.values(), scene.loaded, np.column_stack(series))
    return np.asarray(sizes.sum(axis=1))


def strokes_of(scene: Scene, stage: StageResult) -> Strokes | None:
    """The strokes of a stage's first start on the work; None where the scene has no process.

    A stroke begins with the first contact after what is watched was half way up between the
    work and the other end of the ideal stroke.  Engines end a step, and write a row, at contact
    and fracture.
    """
    process = scene.process
    if process is None:
        return None
    height, rate, time = height_of(scene, stage), stage.velocity, stage.time

    def passed(level: float, up: bool) -> list[tuple[float, float]]:
        """Moments at which the height passes a level, and its height then."""
        sign = 1.0 if up else -1.0
        off = sign * (height - level)
        found = []
        for k in np.flatnonzero((off[:-1] < 0.0) & (off[1:] >= 0.0)):
            h = time[k + 1] - time[k]
            own = off[k], sign * rate[k], off[k + 1], sign * rate[k + 1], h
            part = min(crossing(*own), 1.0)
            found.append((time[k] + part * h, level + sign * hermite(*own, part)[0]))
        return found

    rows = []
    touched = passed(process.height, up=False)
    left = passed(process.height, up=True)
    broken = [] if process.fracture is None else passed(process.height - process.fracture, up=False)
    turned = [own for own, _ in passed(process.height + scene.lift, up=True)]
    edges = [-np.inf, *turned, np.inf]
    for begin, end in pairwise(edges):
        own = [moment for moment in touched if begin < moment[0] < end]
        if not own:
            continue
        first = own[0]
        none = np.nan, np.nan
        # Where the run ends before the stroke is over, it may have bounced only.
        last = reversed(left) if np.isfinite(end) else ()
        rows.append(
            (
                first,
                next((m for m in broken if first[0] < m[0] < end), none),
                next((m for m in last if first[0] < m[0] < end), none),
            )
        )
    moments = np.array(rows).reshape(-1, 3, 2)
    return Strokes(*moments.transpose(1, 0, 2))
