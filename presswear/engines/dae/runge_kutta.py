"""Explicit Runge-Kutta steps of the equations of motion.

The classical method of order 4 and Dormand and Prince's of order 8 with embedded
error estimates of order 5 and 3 (Hairer, Norsett, Wanner: Solving Ordinary
Differential Equations I, section II.5), its coefficients as published in SciPy.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

from presswear.compiled import compiled
from presswear.engines.dae.dynamics import System, rates

Array = NDArray[np.float64]

STAGES = 12


class Tableau(NamedTuple):
    """Coefficients of DOP853: a (12, 12), b and c (12,), error weights (13,)."""

    a: Array
    b: Array
    c: Array
    fifth: Array
    third: Array


def dormand_prince() -> Tableau:
    """The tableau of order 8."""
    return Tableau(
        np.ascontiguousarray(DOP853.A[:STAGES, :STAGES]),
        np.array(DOP853.B),
        np.array(DOP853.C[:STAGES]),
        np.array(DOP853.E5),
        np.array(DOP853.E3),
    )


@compiled
def classical_step(
    system: System, onset: Array, t: float, h: float, y: Array, slopes: Array, new: Array
) -> None:
    """One step of order 4; ``slopes[0]`` holds dy/dt at the start.

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
def dormand_prince_step(
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
    """One step of order 8; returns its error as a multiple of the allowed one.

    ``slopes[0]`` holds dy/dt at the start, ``slopes[12]`` afterwards that at the end.

    Parameters
    ----------
    scale : ndarray, shape (n,)
        Allowed error of the first n components; the integrals behind them follow.
    """
    size = y.shape[0]
    for stage in range(1, STAGES):
        new[:] = y
        for j in range(stage):
            factor = h * tableau.a[stage, j]
            if factor != 0.0:
                for i in range(size):
                    new[i] += factor * slopes[j, i]
        rates(system, onset, t + tableau.c[stage] * h, new, slopes[stage])
    new[:] = y
    for j in range(STAGES):
        factor = h * tableau.b[j]
        if factor != 0.0:
            for i in range(size):
                new[i] += factor * slopes[j, i]
    rates(system, onset, t + h, new, slopes[STAGES])
    fifth = 0.0
    third = 0.0
    count = scale.shape[0]
    for i in range(count):
        five = 0.0
        three = 0.0
        for j in range(STAGES + 1):
            five += tableau.fifth[j] * slopes[j, i]
            three += tableau.third[j] * slopes[j, i]
        fifth += (five / scale[i]) ** 2
        third += (three / scale[i]) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return abs(h) * fifth / math.sqrt((fifth + 0.01 * third) * count)
