"""Fit of the wear coefficient: printed depths divided by ours."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from presswear.paper.evidence import Evidence
from presswear.paper.printed import DOUBTFUL, PRINTED, Place


def depth_factors(evidence: Evidence, case: str) -> dict[Place, float]:
    """Return printed depths after a first wear divided by ours."""
    factors: dict[Place, float] = {}
    for number in PRINTED:
        if (number.quantity, number.place.wear_updates) == ("depth", 1):
            ours = evidence.estimate(case, number.place, "depth")
            if ours is not None and ours.mean > 0.0:
                factors[number.place] = number.value / ours.mean
    return factors


class Fit(NamedTuple):
    """One factor on K_d / b for all printed depths; nan if there are none."""

    best: float  # geometric mean of all but the doubtful prints
    # factor by which single depths miss it, root mean square of logarithms
    typical: float
    largest: float  # largest of these factors


def fit(factors: Mapping[Place, float]) -> Fit:
    """Return the factor on K_d / b that fits best, and how far single depths are from it."""
    logs = np.log(
        [factor for place, factor in factors.items() if place not in DOUBTFUL]
    )
    if not logs.size:
        return Fit(math.nan, math.nan, math.nan)
    off = logs - logs.mean()
    numbers = (logs.mean(), logs.std(), np.abs(off).max())
    return Fit(*(math.exp(number) for number in numbers))
