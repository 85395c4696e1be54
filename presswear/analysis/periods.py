"""Poincaré sections and the period of a motion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.tools.errors import InputError

Array = NDArray[np.float64]

TOLERANCE = 1e-2  # relative to a scale: largest difference of states of a periodic motion


def times_at_phase(start: float, end: float, period: float, phase: float) -> Array:
    """Return the times between ``start`` and ``end``, s, at which a cycle has a phase, 0 to 1."""
    roundoff = 1e-9
    first = int(np.ceil(start / period - phase - roundoff))
    last = int(np.floor(end / period - phase + roundoff))
    return np.asarray((np.arange(first, last + 1) + phase) * period)


def section(time: Array, values: Array, times: Array) -> Array:
    """Return the values at ``times``, linear between rows; times outside the series are omitted.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Increasing, s.
    values : ndarray, shape (n, d)
    times : ndarray, shape (m,)
        s.
    """
    inside = times[(times >= time[0]) & (times <= time[-1])]
    return np.column_stack([np.interp(inside, time, column) for column in values.T])


@dataclass(frozen=True)
class Periodicity:
    """Period of a motion.

    Attributes
    ----------
    period : int or None
        Smallest number of cycles after which every state returns within the tolerance; None if
        there is none up to half of the cycles.
    error : float
        Largest difference of states one period apart, relative to the scales. Without a period,
        the smallest of these errors over all candidates; infinite for fewer than two states.
    cycles : int
        Number of states.
    tolerance : float
        Relative to the scales.
    """

    period: int | None
    error: float
    cycles: int
    tolerance: float

    def __str__(self) -> str:
        extent = f"within {100.0 * self.tolerance:g} % in {self.cycles} cycles"
        return f"no period {extent}" if self.period is None else f"period {self.period} {extent}"


def periodicity(states: Array, scales: Array, tolerance: float = TOLERANCE) -> Periodicity:
    """Return the period of a motion from its states at one phase of each cycle.

    Each state is compared with the state k cycles later, for k up to half of the cycles, so that
    every state of the orbit is seen twice.

    Parameters
    ----------
    states : ndarray, shape (cycles, d)
        Without the states of the start-up.
    scales : ndarray, shape (d,)
        Positive size of each component, in the unit of the component.
    tolerance : float
        Largest difference of a periodic motion, relative to the scales.
    """
    if not np.all(scales > 0.0):
        raise InputError(f"scales = {scales.tolist()}: must be positive")
    scaled = states / scales
    smallest = np.inf
    for period in range(1, len(scaled) // 2 + 1):
        error = float(np.abs(scaled[period:] - scaled[:-period]).max())
        if error <= tolerance:
            return Periodicity(period, error, len(scaled), tolerance)
        smallest = min(smallest, error)
    return Periodicity(None, smallest, len(scaled), tolerance)
