"""Confidence intervals of a wear map by the bootstrap.

``count`` is the number of maps from which the bootstrap samples are drawn.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics.estimate import (
    LEVEL,
    MIN_SAMPLES,
    Estimate,
    about,
    quantile,
)
from presswear.tools.arrays import Array

# Number of bootstrap samples. An end of an interval scatters by about 5 % of its width.
RESAMPLES = 1000
# Probabilities at the ends of an interval
_ENDS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)


def resampled(maps: Array, weights: Array, seed: int = 1) -> Array:
    """Return bootstrap means, (RESAMPLES, bins), of maps, (n, bins), with weights, (n,)."""
    count = len(maps)
    generator = np.random.default_rng(seed)
    shares = np.full(count, 1.0 / count)
    # numbers of copies of each map
    repeats = generator.multinomial(count, shares, RESAMPLES)
    factors = repeats * weights
    return np.asarray(factors @ maps / factors.sum(axis=1, keepdims=True))


def _ends(draws: Array, centre: Array | float, count: int) -> Array:
    """Return the ends of an interval relative to a centre, from bootstrap samples.

    The quantiles of the samples are widened by the ratio of Student's quantile to that
    of the normal distribution, and by sqrt(n / (n - 1)), because the standard deviation
    of bootstrap means has the factor 1 / n instead of 1 / (n - 1).
    """
    ratio = quantile(count - 1) / quantile(math.inf) * math.sqrt(count / (count - 1))
    return np.asarray(ratio * (np.quantile(draws, _ENDS, axis=0) - centre))


def basic_interval(value: float, draws: Array, count: int) -> Estimate:
    """Return the interval of a statistic from its bootstrap samples, shape (RESAMPLES,).

    A statistic that is biased by noise, such as the deepest of many bins, is biased
    again by as much in the samples: the interval is reflected at the estimate ("basic"
    bootstrap, Davison and Hinkley, Bootstrap Methods and their Application, section
    2.4), and widened as Student's is.
    """
    if count < MIN_SAMPLES:
        return Estimate(value, samples=count)
    below, above = _ends(draws, value, count).tolist()
    return Estimate(value, value - above, value - below, count)


def angle_interval(
    place: int, places: NDArray[np.int64], bins: int, count: int
) -> Estimate:
    """Return the angle of a bin, rad, with its interval from its places in bootstrap samples.

    The ends are continuous with the angle: they may lie below 0 or above 2 pi.
    """
    angle = 2.0 * math.pi * (place + 0.5) / bins
    if count < MIN_SAMPLES:
        return Estimate(angle, samples=count)
    # Distances from the place in bins, the short way round
    distances = (places - place + bins // 2) % bins - bins // 2
    below, above = _ends(distances.astype(np.float64), 0.0, count).tolist()
    width = 2.0 * math.pi / bins
    # The interval is at least as wide as a bin.
    low = angle + width * min(below, -0.5)
    high = angle + width * max(above, 0.5)
    return Estimate(angle, low, high, count)


def pointwise_interval(mean: Array, draws: Array, count: int) -> tuple[Array, Array]:
    """Return the ends of the interval of each bin of a mean map, m; one map has the width zero."""
    if count < 2:
        return mean, mean
    low, high = mean + _ends(draws, mean, count)
    return low, high


def peak_of(
    mean: Array, draws: Array, count: int, centre: Array | None = None
) -> tuple[Estimate, Estimate]:
    """Return depth, m, and angle, rad, of the deepest place of a mean wear map.

    Parameters
    ----------
    mean : ndarray, shape (bins,)
        Depth, m.
    draws : ndarray, shape (RESAMPLES, bins)
        Bootstrap samples of ``resampled``.
    centre : ndarray, shape (bins,) or None
        Mean of the maps from which the samples are drawn, m, if it differs from ``mean``.
        The interval is then moved to ``mean`` and widened by the distance.
    """
    place = int(mean.argmax())
    deepest = float((mean if centre is None else centre).max())
    depth = about(float(mean[place]), basic_interval(deepest, draws.max(axis=1), count))
    if depth.low is not None:
        depth = replace(depth, low=max(depth.low, 0.0))
    return depth, angle_interval(place, draws.argmax(axis=1), mean.size, count)
