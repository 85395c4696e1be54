"""A life that nobody computed, for results that nobody computed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswear.results.life import Ended, LifeResult, LimitResult, PassResult, Phase
from presswear.results.result import Result
from presswear.scene.options import Life

Array = NDArray[np.float64]

STROKES = np.array([4.0, 2e6, 4e6, 6e6])
LIFE = 5e6
ASKED = Life(until="depth > 50 um, bdc_drift > 2 mm", replaced="A@2e6", turned="C@7e6", at_most=8e6)


def _curve(values: Array, half: float) -> Array:
    return np.column_stack([values, values - half * values, values + half * values])


def made_up_life(sampling: float | None = 0.03, step: float | None = 0.04) -> LifeResult:
    """Depth of C passes 50 um first, after five million strokes."""
    depth = LimitResult("C.depth", "m", 5e-5, LIFE, sampling, step, 6e-5, 3e-6)
    drift = LimitResult("bdc_drift", "m", 2e-3, None, None, None, 1e-4, 2e-5)
    part = STROKES / LIFE
    return LifeResult(
        ended="limit",
        message="",
        strokes=LIFE,
        sampling=sampling,
        step=step,
        scatter=0.5,
        limits=(LimitResult("A.depth", "m", 5e-5, None, None, None, 2e-5, 1e-6), depth, drift),
        passes=(PassResult(5e-3, 64, 5.2e6, 0.08), PassResult(1e-3, 320, LIFE, sampling)),
        phases=(
            Phase("A", "running-in", 4.0, 2e6, 3e-15, 2e-16),
            Phase("A", "steady", 2e6, 6e6, 1e-15, 1e-16),
            Phase("C", "steady", 4.0, 6e6, 2e-15, 1e-16),
        ),
        services=("bush of A replaced after 2e+06 strokes",),
        curves={
            "strokes": STROKES,
            "A.depth": _curve(2e-5 * part, 0.1),
            "A.wear_volume": _curve(4e-9 * part, 0.1),
            "C.depth": _curve(5e-5 * part, 0.1),
            "C.wear_volume": _curve(1e-8 * part, 0.1),
            "A.force_max": _curve(3e4 + 0.0 * part, 0.1),
            "C.force_max": _curve(3e3 + 0.0 * part, 0.1),
            "bdc_drift": _curve(1e-4 * part, 0.2),
        },
    )


def lived(result: Result, life: LifeResult | None = None) -> Result:
    """A result with a life."""
    scene = replace(result.scene, life=ASKED, wear_updates=2)
    return replace(result, scene=scene, life=life or made_up_life())


def not_passed(ended: Ended = "at_most", message: str = "") -> LifeResult:
    """The same life where no limit is passed within five million strokes."""
    life = made_up_life(None, None)
    limits = [replace(own, strokes=None, last=0.5 * own.value) for own in life.limits]
    return replace(life, ended=ended, message=message, limits=tuple(limits))
