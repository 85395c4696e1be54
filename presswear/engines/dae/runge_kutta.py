"""Explicit Runge-Kutta steps of the equations of motion.

The classical method of order 4, and embedded methods by their tableau.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import System, rates
from presswear.engines.dormand_prince import Tableau
from presswear.tools.compiled import compiled, copy_to

Array = NDArray[np.float64]


@compiled
def classical_step(
    system: System, onset: Array, t: float, h: float, y: Array, slopes: Array, new: Array
) -> None:
    """Make one step of order 4; ``slopes[0]`` holds dy/dt at the start.

    Parameters
    ----------
    slopes : ndarray, shape (13, len(y))
        Working space.
    new : ndarray, shape (len(y),)
        Result.
    """
    for stage in range(1, 4):
        part = h if stage == 3 else 0.5 * h
        for i in range(y.shape[0]):
            new[i] = y[i] + part * slopes[stage - 1, i]
        rates(system, onset, t + part, new, slopes[stage])
    for i in range(y.shape[0]):
        new[i] = y[i] + h / 6.0 * (
            slopes[0, i] + 2.0 * (slopes[1, i] + slopes[2, i]) + slopes[3, i]
        )


@compiled
def embedded_step(
    system: System,
    tableau: Tableau,
    onset: Array,
    t: float,
    h: float,
    y: Array,
    slopes: Array,
    new: Array,
    scale: Array,
) -> float:
    """Make one embedded step; returns its error as a multiple of the allowed one.

    ``slopes[0]`` holds dy/dt at the start, ``slopes[stages]`` afterwards that at the end.

    Parameters
    ----------
    scale : ndarray, shape (n,)
        Allowed error of the first n components; the integrals behind them follow.
    """
    size = y.shape[0]
    stages = tableau.b.shape[0]
    for stage in range(1, stages):
        copy_to(new, y)
        for j in range(stage):
            factor = h * tableau.a[stage, j]
            if factor != 0.0:
                for i in range(size):
                    new[i] += factor * slopes[j, i]
        rates(system, onset, t + tableau.c[stage] * h, new, slopes[stage])
    copy_to(new, y)
    for j in range(stages):
        factor = h * tableau.b[j]
        if factor != 0.0:
            for i in range(size):
                new[i] += factor * slopes[j, i]
    rates(system, onset, t + h, new, slopes[stages])
    first = 0.0
    second = 0.0
    count = scale.shape[0]
    for i in range(count):
        one = 0.0
        two = 0.0
        for j in range(stages + 1):
            one += tableau.error[j] * slopes[j, i]
            two += tableau.second_error[j] * slopes[j, i]
        first += (one / scale[i]) ** 2
        second += (two / scale[i]) ** 2
    if first == 0.0 and second == 0.0:
        return 0.0
    return abs(h) * first / math.sqrt((first + 0.01 * second) * count)
