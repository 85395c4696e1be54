"""Periodicity: after how many cycles a motion repeats itself, if it does."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import InputError

Array = NDArray[np.float64]

TOLERANCE = 1e-2
"""Parts of a scale by which states of a periodic motion may differ."""


@dataclass(frozen=True)
class Periodicity:
    """The period of a motion, as far as the cycles that were looked at tell.

    Attributes
    ----------
    period : int or None
        Fewest cycles after which every state comes back within the tolerance; None: there are
        none, up to half of the cycles.
    error : float
        Largest difference of states a period apart, in scales; without a period that of the
        number of cycles that comes nearest, infinite where there are no two states.
    cycles : int
        Cycles that were looked at.
    tolerance : float
        In scales.
    """

    period: int | None
    error: float
    cycles: int
    tolerance: float

    @property
    def words(self) -> str:
        """The finding in words."""
        told = f"{100.0 * self.tolerance:g} % in {self.cycles} cycles"
        if self.period is None:
            return f"no period within {told}"
        return f"period {self.period} within {told}"


def periodicity(states: Array, scales: Array, tolerance: float = TOLERANCE) -> Periodicity:
    """Find the period of a motion from its states at one phase of each cycle.

    Every state is held against the one a number of cycles later; a period is looked for up to
    half of the cycles, so that each state of the orbit is seen twice.

    Parameters
    ----------
    states : ndarray, shape (cycles, d)
        Without those of the start-up.
    scales : ndarray, shape (d,)
        Size of each number, in its own unit.
    tolerance : float
        Largest difference of a motion that repeats, in scales.
    """
    if not np.all(scales > 0.0):
        raise InputError(f"scales = {scales.tolist()}: numbers above 0 are expected")
    own = states / scales
    nearest = np.inf
    for period in range(1, len(own) // 2 + 1):
        error = float(np.abs(own[period:] - own[:-period]).max())
        if error <= tolerance:
            return Periodicity(period, error, len(own), tolerance)
        nearest = min(nearest, error)
    return Periodicity(None, nearest, len(own), tolerance)
