"""Ratio of two lives whose replicates start alike."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from presswear.recording.statistics import quantile
from presswear.results.life import LifeResult, RefinementResult, life_ratio
from presswear.tools.arrays import Array

REPLICATES = 8
WEIGHTS = 0.2, 0.3, 0.5  # of the refinements
RATIO = 1.5
TRIES = 2000
SCATTER = 0.5  # of a replicate; large, because texts of ratios have three digits


def life_of(strokes: float, logarithms: Array) -> LifeResult:
    """Return a life with the logarithms of its replicates, (refinements, replicates)."""
    weights = np.array(WEIGHTS[-len(logarithms) :])
    weights /= weights.sum()
    means = logarithms.mean(axis=1)
    refinements = tuple(
        RefinementResult(1e-3, 100, None, None, tuple(weight * (row - mean)))
        for weight, row, mean in zip(weights, logarithms, means, strict=True)
    )
    scale = quantile(REPLICATES - 1) / math.sqrt(REPLICATES)
    half = scale * math.hypot(*(weights * logarithms.std(axis=1, ddof=1)))
    strokes *= math.exp(float(weights @ means))
    return LifeResult("limit", "", strokes, half, 0.0, 0.0, (), refinements)


def ends_of(life: LifeResult, reference: LifeResult) -> tuple[float, float]:
    low, high = re.findall(r"[\d.]+", life_ratio(life, reference)[0])[1:]
    return float(low), float(high)


@pytest.mark.parametrize("shared", [0.0, 0.5, 0.9])
def test_intervals_of_the_ratio_hold(shared):
    """``shared`` is the part of the variance that two replicates of one number share."""
    random = np.random.default_rng(7)
    held = 0
    widths = []
    for _ in range(TRIES):
        common = math.sqrt(shared) * random.normal(size=(3, REPLICATES))
        first, second = (
            SCATTER
            * (common + math.sqrt(1.0 - shared) * random.normal(size=(3, REPLICATES)))
            for _ in range(2)
        )
        low, high = ends_of(life_of(RATIO * 1e6, first), life_of(1e6, second))
        held += low <= RATIO <= high
        widths.append(math.log(high / low))
    assert held / TRIES == pytest.approx(0.95, abs=0.02)
    # Differences of pairs have the part of the variance that is not shared.
    part = math.sqrt(2.0 * (1.0 - shared) * float(np.sum(np.square(WEIGHTS))))
    deviation = SCATTER * part / math.sqrt(REPLICATES)
    assert np.mean(widths) == pytest.approx(2.0 * 2.1 * deviation, rel=0.05)


def test_lives_with_equal_replicates_have_an_exact_ratio():
    logarithms = 0.1 * np.random.default_rng(1).normal(size=(3, REPLICATES))
    life = life_of(1e6, logarithms)
    longer = life_of(2e6, logarithms)
    assert life_ratio(longer, life) == ("2.00", "1")


def test_a_refinement_that_one_life_has_not_counts_alone():
    logarithms = 0.1 * np.random.default_rng(1).normal(size=(3, REPLICATES))
    life = life_of(2e6, logarithms)
    shorter = replace(life, refinements=life.refinements[:2])
    last = np.array(life.refinements[2].deviations)
    half = quantile(REPLICATES - 1) * last.std(ddof=1) / math.sqrt(REPLICATES)
    low, high = ends_of(life, shorter)
    assert math.log(high / low) == pytest.approx(2.0 * half, abs=0.01)
