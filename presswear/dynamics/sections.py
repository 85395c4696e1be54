"""Poincare sections: a motion seen once a cycle."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def times_at_phase(begin: float, end: float, period: float, phase: float) -> Array:
    """Times between two others at which a cycle has a phase, s.

    Parameters
    ----------
    begin, end : float
        s.
    period : float
        Duration of a cycle, s.
    phase : float
        Parts of a cycle, from 0 to 1.
    """
    noise = 1e-9
    first = int(np.ceil(begin / period - phase - noise))
    last = int(np.floor(end / period - phase + noise))
    return np.asarray((np.arange(first, last + 1) + phase) * period)


def section(time: Array, values: Array, at: Array) -> Array:
    """States at some times, linear between the rows of a series; times outside are left out.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Rising, s.
    values : ndarray, shape (n, d)
    at : ndarray, shape (m,)
        s.
    """
    inside = at[(at >= time[0]) & (at <= time[-1])]
    return np.column_stack([np.interp(inside, time, column) for column in values.T])
