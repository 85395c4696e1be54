"""Means of a response at the points of a sweep, with the variance of single runs."""

import math
from dataclasses import dataclass
from typing import Any

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

    The variance of a replicate is estimated from those of all points, as one number or as
    a share of the mean (``_variances``). Without replicates the intervals of the runs are
    used.
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
        squares = np.nansum((values - means[:, None]) ** 2, axis=1)
        variances = _variances(squares, counts - 1.0, means)
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


def _variances(squares: Array, freedom: Array, means: Array) -> Array:
    """Return the variance of a replicate at each point, from sums of squared residuals.

    Either all points have one variance, or it is proportional to the square of the mean,
    as that of peak forces over the speed. The model with the greater likelihood of
    normal residuals is used.
    """
    is_used = freedom > 0.0
    total = float(freedom[is_used].sum())
    equal = np.full(len(means), squares[is_used].sum() / total)
    level = means[is_used] ** 2
    signs = np.sign(means[is_used])
    has_one_sign = level.all() and abs(signs.sum()) == level.size
    if equal[0] == 0.0 or not has_one_sign:
        return equal
    share = float((squares[is_used] / level).sum()) / total
    cost = total * math.log(share) + float((freedom[is_used] * np.log(level)).sum())
    if cost >= total * math.log(equal[0]):
        return equal
    return np.where(np.isfinite(means), share * means**2, equal)


def means_of(table: Table) -> tuple[dict[str, list[Any]], dict[str, str]]:
    """Return columns with a row for each point, and their units.

    Columns are the parameters, and of each response the mean over its replicates, the
    half width of its 95 % interval, the number of replicates with a value, and whether one
    of them is a lower bound.
    """
    columns: dict[str, list[Any]] = {}
    first = table.points[:: table.replicates]
    for column, values in zip(table.parameters, first.T, strict=True):
        columns[column.key] = [column.setting(value) for value in values.tolist()]
    for column in table.responses:
        points = points_of(table, column.key)
        columns[column.key] = points.means.tolist()
        columns[f"{column.key}_half_width"] = points.half_widths.tolist()
        columns[f"{column.key}_replicates"] = points.counts.astype(int).tolist()
        columns[f"{column.key}_is_lower_bound"] = points.censored.tolist()
    return columns, table.units
