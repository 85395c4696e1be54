"""Functions of means, with their intervals by the jackknife."""

from collections.abc import Callable

import numpy as np

from presswear.recording.statistics import Estimate, quantile
from presswear.tools.arrays import Array


def jackknife(terms: Array, statistic: Callable[[Array], Array]) -> tuple[Array, Array]:
    """Functions of the means of some terms, shape (m,), and half widths of their 95 % intervals.

    One row is left out at a time (Miller, The jackknife - a review, Biometrika 61, 1, 1974):
    what is drawn at random is drawn by the rows alone, and nothing is drawn anew.

    Parameters
    ----------
    terms : ndarray, shape (n, k)
        Of independent rows, two at least.
    statistic : callable
        Gives arrays of shape (..., m) from means of shape (..., k).
    """
    count = len(terms)
    total = terms.sum(axis=0)
    without = statistic((total - terms) / (count - 1))
    scatter = (count - 1) / count * np.square(without - without.mean(axis=0)).sum(axis=0)
    return statistic(total / count), quantile(count - 1) * np.sqrt(scatter)


def intervals(values: Array, halves: Array) -> tuple[Estimate, ...]:
    """Numbers with the half widths of their intervals as intervals."""
    return tuple(
        Estimate(float(value), float(value - half), float(value + half))
        for value, half in zip(values, halves, strict=True)
    )


def as_share(own: Estimate) -> Estimate:
    """A share within 0 and 1, beyond which an estimate and its interval reach by chance."""
    low, high = (None if end is None else min(max(end, 0.0), 1.0) for end in (own.low, own.high))
    return Estimate(min(max(own.mean, 0.0), 1.0), low, high)
