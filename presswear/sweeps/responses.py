"""A measure at the points of a sweep: means over the draws at each, and how well they are known."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import Estimate, quantile
from presswear.sweeps.table import Column, Table
from presswear.tools.arrays import Array

NoiseSource = Literal["draws", "intervals", "nothing"]


@dataclass(frozen=True)
class Responses:
    """A measure at each point, in the order in which the points first came.

    Attributes
    ----------
    factors : tuple of Column
    measure : Column
    points : ndarray, shape (n, d)
    means : ndarray, shape (n,)
        Over the draws that have a value; NaN where none has.
    variances : ndarray, shape (n,)
        Of one draw about the mean of its point; 0 where nothing tells it.
    counts : ndarray, shape (n,)
        Draws with a value.
    is_beyond : ndarray of bool, shape (n,)
        True where a draw is a lower bound only, and so the mean.
    path : ndarray of int, shape (rows of the first draw,)
        Places of the points in the order of the rows: a plan may come to a point again.
    noise_source : str
        Where the variances are from: several draws at the points, the intervals that the runs
        tell, or nothing.
    """

    factors: tuple[Column, ...]
    measure: Column
    points: Array
    means: Array
    variances: Array
    counts: Array
    is_beyond: NDArray[np.bool_]
    path: NDArray[np.int64]
    noise_source: NoiseSource

    @property
    def noise(self) -> Array:
        """Variance of the mean of each point, shape (n,)."""
        return self.variances / np.maximum(self.counts, 1.0)

    @property
    def freedoms(self) -> Array:
        """Degrees of freedom of each variance, shape (n,); infinite where runs tell them."""
        if self.noise_source != "draws":
            return np.full(len(self.counts), math.inf)
        own = np.maximum(self.counts - 1.0, 0.0)
        return np.where(own > 0.0, own, own.sum())

    @property
    def half_widths(self) -> Array:
        """Half widths of the 95 % intervals of the means, shape (n,); NaN where nothing tells."""
        if self.noise_source == "nothing":
            return np.full(len(self.counts), math.nan)
        wide = np.array([quantile(own) for own in self.freedoms])
        return wide * np.sqrt(self.noise)

    def difference(self, row: int, other: int) -> Estimate:
        """The mean of one point less that of another; no ends where nothing tells the scatter.

        Points scatter by as much as they do: the degrees of freedom are those of Welch (1947).
        """
        value = float(self.means[row] - self.means[other])
        if self.noise_source == "nothing":
            return Estimate(value, None, None)
        parts, freedoms = self.noise[[row, other]], self.freedoms[[row, other]]
        total = float(parts.sum())
        if total == 0.0:
            return Estimate(value, value, value)
        lost = float((parts**2 / freedoms).sum())
        half = quantile(total**2 / lost if lost > 0.0 else math.inf) * math.sqrt(total)
        return Estimate(value, value - half, value + half)

    @property
    def has_value(self) -> NDArray[np.bool_]:
        """True for each point where a draw has a value, shape (n,)."""
        return self.counts > 0.0

    @property
    def middle(self) -> Array:
        """A point in the middle of all, shape (d,): medians, and the first of the words."""
        is_word = [bool(factor.words) for factor in self.factors]
        return np.where(is_word, 0.0, np.median(self.points, axis=0))

    def only(self, kept: NDArray[np.bool_] | NDArray[np.int64]) -> "Responses":
        """Some of the points, or all in another order, each of them once."""
        beyond = self.is_beyond[kept]
        return replace(
            self,
            points=self.points[kept],
            means=self.means[kept],
            variances=self.variances[kept],
            counts=self.counts[kept],
            is_beyond=beyond,
            path=np.arange(len(beyond)),
        )


def responses(table: Table, key: str) -> Responses:
    """The measure of a table with some key at each of its points; InputError where there is none.

    Where several draws tell the scatter at some points, the others take the mean of it.  A draw
    that is there twice, as where paths cross, is one.
    """
    place = table.place(key)
    values, halves = table.values[:, place], table.halves[:, place]
    _, first, own = np.unique(table.points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    own = np.argsort(order)[own.reshape(-1)]
    runs = np.column_stack([own, table.draws])
    is_new = np.zeros(len(runs), np.bool_)
    is_new[np.unique(runs, axis=0, return_index=True)[1]] = True
    known = np.isfinite(values) & is_new
    size = len(first)

    def summed(rows: Array) -> Array:
        return np.asarray(np.bincount(own[known], rows[known], size), np.float64)

    counts = summed(np.ones(len(values)))
    with np.errstate(invalid="ignore", divide="ignore"):
        means = summed(values) / counts
        squares = summed((values - means[own]) ** 2)
        told = summed((halves / quantile(math.inf)) ** 2) / counts
    free = np.maximum(counts - 1.0, 0.0)
    variances = np.zeros(size)
    source: NoiseSource = "nothing"
    if free.any():
        source = "draws"
        variances = np.where(
            free > 0.0, squares / np.maximum(free, 1.0), squares.sum() / free.sum()
        )
    elif np.isfinite(told[counts > 0.0]).all() and known.any():
        source = "intervals"
        variances = np.where(counts > 0.0, told, 0.0)
    beyond = np.bincount(own[known], weights=table.is_beyond[known, place], minlength=size) > 0.0
    return Responses(
        table.factors,
        table.measures[place],
        table.points[first[order]],
        means,
        variances,
        counts,
        beyond,
        own[table.draws == table.draws.min(initial=0)],
        source,
    )
