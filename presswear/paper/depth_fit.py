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
        if number.quantity == "depth" and number.place.wear_updates == 1:
            ours = evidence.estimate(case, number.place, "depth")
            if ours is not None and ours.mean > 0.0:
                factors[number.place] = number.value / ours.mean
    return factors


class Fit(NamedTuple):
    """One factor on K_d / b for all printed depths; nan if there are none."""

    best: float  # geometric mean of all but the doubtful prints
    # factor between a printed depth and the fit: root mean square of its logarithm
    typical: float
    largest: float  # largest factor between a printed depth and the fit


def fit(factors: Mapping[Place, float]) -> Fit:
    """Return the factor on K_d / b that fits best, and the scatter of the printed depths."""
    certain = [factors[place] for place in factors if place not in DOUBTFUL]
    if not certain:
        return Fit(math.nan, math.nan, math.nan)
    logs = np.log(certain)
    mean = logs.mean()
    largest = np.abs(logs - mean).max()
    return Fit(math.exp(mean), math.exp(logs.std()), math.exp(largest))
