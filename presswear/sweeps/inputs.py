"""Factors as coordinates in which distances mean something."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.sweeps.table import Column
from presswear.tools.arrays import Array

_EVEN = 1e-6
"""Difference of two skews that is no rounding: two values are as even as their logarithms."""


@dataclass(frozen=True)
class Inputs:
    """Factors as coordinates of about one length: values over their range, words as corners.

    Attributes
    ----------
    factors : tuple of Column
    low, high : ndarray, shape (d,)
        Ends of the range of each.
    is_logarithmic : ndarray of bool, shape (d,)
    """

    factors: tuple[Column, ...]
    low: Array
    high: Array
    is_logarithmic: NDArray[np.bool_]

    @staticmethod
    def of(factors: tuple[Column, ...], points: Array) -> "Inputs":
        """The coordinates that points ask for: logarithms where these lie more evenly."""
        is_even = [
            not factor.words and own.min() > 0.0 and _skew(np.log(own)) < _skew(own) - _EVEN
            for factor, own in zip(factors, points.T, strict=True)
        ]
        return Inputs(factors, points.min(axis=0), points.max(axis=0), np.array(is_even))

    def at(self, points: Array) -> Array:
        """Coordinates of points, shape (n, coordinates)."""
        columns = []
        for k, factor in enumerate(self.factors):
            own, low, high = points[:, k], self.low[k], self.high[k]
            if factor.words:
                columns += [(own == place).astype(np.float64) for place in range(len(factor.words))]
                continue
            if self.is_logarithmic[k]:
                own, low, high = np.log(own), math.log(low), math.log(high)
            columns.append((own - low) / (high - low if high > low else 1.0))
        return np.column_stack(columns)


def _skew(values: Array) -> float:
    """Size of the mean cube of values about their mean, over that of their deviation."""
    off = values - values.mean()
    return abs(float(np.mean(off**3))) / max(float(np.mean(off**2)), 1e-300) ** 1.5
