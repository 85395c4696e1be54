"""Sobol' indices of first order from any one plan of points, such as a grid or a sample.

Two ways, of which ``first_order`` takes the one that the points allow.  Neighbours by rank ask for
points that are independent of each other, which Sobol' points are not: on them, next to each other
in one value says much about the others.  Waves ask for nothing.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import Estimate, quantile
from presswear.sweeps.estimates import jackknife
from presswear.sweeps.responses import Responses
from presswear.sweeps.sensitivity import Indices
from presswear.tools.arrays import Array

LEAST_POINTS = 32
"""Points below which nothing is told."""
WAVES = 8
"""Cosines that stand for what a measure does over one factor."""
_CHANCE = 1e-3
"""Probability at which independent points are taken for others."""


def first_order(own: Responses, seed: int = 1) -> Indices | None:
    """Indices of first order, less what chaos takes of them.

    Parameters
    ----------
    seed : int
        Draws the order of points with one and the same value.

    Returns
    -------
    indices : Indices or None
        None where there are too few points, or nothing but chaos.
    """
    kept = own.only(own.has_value)
    count = len(kept.means)
    if count < LEAST_POINTS or np.square(kept.means - kept.means.mean()).sum() <= kept.noise.sum():
        return None
    mixed = kept.only(np.random.default_rng(seed).permutation(count))
    if are_independent(mixed.points):
        found = by_rank(mixed)
        method = (
            "from neighbours by rank (Gamboa, Gremaud, Klein and Lagnoux 2022; Chatterjee 2021)"
        )
    else:
        found = by_waves(mixed)
        method = f"from the first {WAVES} cosines over each factor (EASI, Plischke 2010)"
    return Indices(found, (), None, count, method)


def are_independent(points: Array) -> bool:
    """Tell whether neighbours in one value are independent in all others.

    The distance of two independent ranks has a triangular distribution, against which those of
    neighbours are tested (Kolmogorov and Smirnov), each factor over each other.
    """
    from scipy.stats import kstest  # slow to import

    count, dimension = points.shape
    ranks = np.column_stack([_ranked(factor) for factor in points.T])
    pairs = [(k, j) for k in range(dimension) for j in range(dimension) if k != j]
    for k, j in pairs:
        apart = np.abs(np.diff(ranks[np.argsort(ranks[:, k]), j])) / count
        if kstest(apart, lambda t: 1.0 - (1.0 - t) ** 2).pvalue < _CHANCE / len(pairs):
            return False
    return True


def by_rank(own: Responses) -> tuple[Estimate, ...]:
    """Mean product of neighbours in the order of a factor, over the variance.

    Gamboa, Gremaud, Klein and Lagnoux, Global sensitivity analysis: a novel generation of mighty
    estimators based on rank statistics, Bernoulli 28, 4, 2022; after Chatterjee, A new
    coefficient of correlation, JASA 116, 2021.  The bootstrap fails for ranks (Lin and Han, On
    the failure of the bootstrap for Chatterjee's rank correlation, Biometrika 111, 3, 2024), so
    that the interval is that of the sum of products, of which only neighbours hang together.

    Parameters
    ----------
    own : Responses
        With a value at each point; points in random order.
    """
    count = len(own.means)
    values = own.means - own.means.mean()
    squares = values**2 - own.noise
    variance = float(squares.mean())
    found = []
    for factor in own.points.T:
        ranked = np.argsort(factor, kind="stable")
        products = values[ranked] * values[np.roll(ranked, -1)]
        index = float(products.mean()) / variance
        moved = (products - index * squares[ranked]) / variance
        # Neighbours share a value; what they share beyond it is the trend over the factor, which
        # neighbours but one have as well, and which is drawn with the points.
        alone, beside, apart = (float(np.mean(moved * np.roll(moved, -lag))) for lag in (0, 1, 2))
        scatter = alone + 2.0 * max(beside - apart, 0.0)
        half = quantile(count - 1) * math.sqrt(scatter / count)
        found.append(Estimate(index, index - half, index + half))
    return tuple(found)


def by_waves(own: Responses) -> tuple[Estimate, ...]:
    """Variance that the first cosines over the rank of a factor explain, over the variance.

    Plischke, An effective algorithm for computing global sensitivity indices (EASI), Reliability
    Engineering and System Safety 95, 4, 2010.  Chance gives each cosine up to as much as one of
    independent points would take of the rest, and none where points are evenly spread: half of it
    is taken off, and the interval, by the jackknife over points, holds both.

    Parameters
    ----------
    own : Responses
        With a value at each point; points in random order.
    """
    count = len(own.means)
    values = own.means - own.means.mean()
    number = np.arange(1, WAVES + 1)

    def shares(mean: Array) -> Array:
        variance = mean[..., 1] - mean[..., 0] ** 2
        parameters = variance - mean[..., 2]
        explained = np.square(mean[..., 3:]).sum(axis=-1)
        chance = WAVES / count * np.maximum(variance - explained, 0.0)
        return np.stack([explained / parameters, chance / parameters], axis=-1)

    found = []
    for factor in own.points.T:
        place = (_ranked(factor) + 0.5) / count
        waves = math.sqrt(2.0) * np.cos(np.pi * np.outer(place, number))
        terms = np.column_stack([values, values**2, own.noise, values[:, None] * waves])
        (share, chance), (half, _) = jackknife(terms, shares)
        index, wide = float(share - 0.5 * chance), float(half + 0.5 * chance)
        found.append(Estimate(index, index - wide, index + wide))
    return tuple(found)


def _ranked(factor: Array) -> NDArray[np.int64]:
    """Place of each value in their order; of equal ones the first is lower."""
    return np.argsort(np.argsort(factor, kind="stable"))
