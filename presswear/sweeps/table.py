"""Rows of a sweep: what was varied, what was measured there, and how each run ended."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import unknown

Array = NDArray[np.float64]
NOT_RUN = "not run yet"
"""Reason of a row that nobody has run."""


@dataclass(frozen=True)
class Column:
    """A quantity that is varied or measured.

    Attributes
    ----------
    key : str
        As it is typed, such as ``A.friction`` or ``A.force_max``.
    unit : str
        Of its values in a table, SI; nothing for a pure number.
    text : str
        What it is.
    words : tuple of str
        Values of one that is no number, which a table holds by their places; empty: numbers.
    """

    key: str
    unit: str
    text: str
    words: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """The runs of a sweep, a row each.

    Attributes
    ----------
    factors, measures : tuple of Column
    points : ndarray, shape (n, d)
        Values of the factors.
    values : ndarray, shape (n, m)
        Values of the measures; NaN where a run has none.
    halves : ndarray, shape (n, m)
        Half widths of their 95 % intervals as the runs tell them; NaN where none is told.
    is_beyond : ndarray of bool, shape (n, m)
        True where a value is a lower bound only, such as a life that was followed no further.
    draws : ndarray of int, shape (n,)
        Which of several independent runs at its point a row is, from 0.
    reasons : tuple of str
        Why a row has no values; nothing where it has.
    """

    factors: tuple[Column, ...]
    measures: tuple[Column, ...]
    points: Array
    values: Array
    halves: Array
    is_beyond: NDArray[np.bool_]
    draws: NDArray[np.int64]
    reasons: tuple[str, ...]

    def place(self, key: str) -> int:
        """Column of a measure; InputError where there is none of that key."""
        keys = [column.key for column in self.measures]
        if key not in keys:
            raise unknown("measure", key, keys)
        return keys.index(key)

    def at(self, values: Array) -> "Table":
        """The rows at which the last factors have some values, without these factors."""
        count = len(values)
        kept = (self.points[:, -count:] == values).all(axis=1)
        return Table(
            self.factors[:-count],
            self.measures,
            self.points[kept, :-count],
            self.values[kept],
            self.halves[kept],
            self.is_beyond[kept],
            self.draws[kept],
            tuple(own for own, is_kept in zip(self.reasons, kept, strict=True) if is_kept),
        )
