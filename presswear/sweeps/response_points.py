"""Means of a response at the points of a sweep, with the variance of single runs."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import quantile
from presswear.sweeps.parameters import Column
from presswear.sweeps.plan import Table
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class Points:
    """One response at the n points of a sweep in d parameters, averaged over the replicates."""

    parameters: tuple[Column, ...]
    response: Column
    points: Array  # shape (n, d)
    means: Array  # shape (n,); NaN where no replicate has a value
    # shape (n,), of a single run about the mean of its point; 0 if unknown
    variances: Array
    counts: Array  # shape (n,), replicates with a value
    # shape (n,), whether the value of a replicate is a lower bound
    censored: NDArray[np.bool_]
    # degrees of freedom of the variances; infinite if from intervals of the runs
    freedom: float
    # degrees of freedom of the interval of a run, which the variances are from
    interval_freedom: float = math.inf

    @property
    def has_value(self) -> NDArray[np.bool_]:
        """True for each point where a replicate has a value, shape (n,)."""
        return self.counts > 0.0

    @property
    def noise(self) -> Array:
        """Variance of each mean, shape (n,)."""
        return self.variances / np.maximum(self.counts, 1.0)

    @property
    def quantile(self) -> float:
        """Half width of a 95 % interval over the standard deviation; NaN if that is unknown."""
        freedom = min(self.freedom, self.interval_freedom)
        return quantile(freedom) if freedom > 0.0 else math.nan

    @property
    def is_constant(self) -> bool:
        """True if the response has at most one value."""
        values = self.means[self.has_value]
        return not values.size or float(np.ptp(values)) == 0.0

    @property
    def half_widths(self) -> Array:
        """Half widths of the 95 % intervals of the means, shape (n,); NaN if unknown."""
        return self.quantile * np.sqrt(self.noise)


def points_of(table: Table, key: str) -> Points:
    """Return the means of a response over the replicates of each point.

    Replicates share one pooled variance. Without replicates the intervals of the runs
    are used.
    """
    k = table.index(key)
    shape = (-1, table.replicates)
    values = table.values[:, k].reshape(shape)
    halves = table.half_widths[:, k].reshape(shape)
    censored = table.censored[:, k].reshape(shape)
    counts = np.isfinite(values).sum(axis=1).astype(float)
    with np.errstate(invalid="ignore"):
        means = np.nansum(values, axis=1) / np.where(counts > 0.0, counts, np.nan)
    freedom = float(np.maximum(counts - 1.0, 0.0).sum())
    interval_freedom = math.inf
    halves = np.where(np.isfinite(values), halves, 0.0)
    variances = np.zeros(len(counts))
    if freedom > 0.0:
        variances += np.nansum((values - means[:, None]) ** 2) / freedom
    elif counts.any() and np.isfinite(halves).all():
        freedom = math.inf
        interval_freedom = table.freedom[k] if table.freedom else math.inf
        squared = (halves / quantile(interval_freedom)) ** 2
        variances = squared.sum(axis=1) / np.maximum(counts, 1.0)
    return Points(
        parameters=table.parameters,
        response=table.responses[k],
        points=table.points[:: table.replicates],
        means=means,
        variances=variances,
        counts=counts,
        censored=np.logical_or.reduce(censored & np.isfinite(values), axis=1),
        freedom=freedom,
        interval_freedom=interval_freedom,
    )
