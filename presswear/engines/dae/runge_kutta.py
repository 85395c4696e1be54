"""Explicit Runge-Kutta steps of the equations of motion.

The classical method of order 4, and embedded methods by their tableau.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import System, bristle_place, evaluate, rates
from presswear.engines.dormand_prince import Tableau
from presswear.physics.forces import BRISTLE, CONTACT_LOSS
from presswear.tools.compile import compiled, inlined

Array = NDArray[np.float64]

# The tolerance times this is the error allowed in a position, m or rad, per step.
POSITION_SCALE = 1e-3

UNEXCHANGED = 1e-3  # part of the kinetic energy to which the error of a loss is compared at least


class Integration(NamedTuple):
    """A state and the step from it.

    Attributes
    ----------
    y, trial : ndarray, shape (m,)
        The state, and its successor on trial.
    slopes : ndarray, shape (13, m)
        Slopes of the stages; the first holds dy/dt at the start.
    scale : ndarray, shape (n,)
        Allowed error of the first n components; the integrals behind them follow, but for the
        deflections of bristles, in which it is as in the first.
    """

    y: Array
    trial: Array
    slopes: Array
    scale: Array


@compiled
def classical_step(system: System, onset: Array, motion: Integration, t: float, h: float) -> None:
    """Make one trial step of order 4."""
    y, new, slopes, _ = motion
    for stage in range(1, 4):
        part = h if stage == 3 else 0.5 * h
        for i in range(y.shape[0]):
            new[i] = y[i] + part * slopes[stage - 1, i]
        rates(system, onset, t + part, new, slopes[stage])
    for i in range(y.shape[0]):
        new[i] = y[i] + h / 6.0 * (
            slopes[0, i] + 2.0 * (slopes[1, i] + slopes[2, i]) + slopes[3, i]
        )


@inlined
def errors_of(tableau: Tableau, slopes: Array, i: int) -> tuple[float, float]:
    """Both estimates of the error of a component, over the length of the step."""
    one = 0.0
    two = 0.0
    for j in range(tableau.b.shape[0] + 1):
        one += tableau.error[j] * slopes[j, i]
        two += tableau.second_error[j] * slopes[j, i]
    return one, two


@compiled
def embedded_step(
    system: System,
    tableau: Tableau,
    onset: Array,
    motion: Integration,
    t: float,
    h: float,
) -> float:
    """Make one trial step with an embedded method; returns its error over the allowed one.

    ``slopes[stages]`` holds dy/dt at the end afterwards.
    """
    y, new, slopes, scale = motion
    stages = tableau.b.shape[0]
    for stage in range(1, stages + 1):
        is_last = stage == stages
        weights = tableau.b if is_last else tableau.a[stage]
        # Slopes do not depend on the integrals, but for those of bristles.
        size = y.shape[0] if is_last else system.felt
        for i in range(size):
            new[i] = y[i]
        for j in range(stage):
            factor = h * weights[j]
            if factor != 0.0:
                for i in range(size):
                    new[i] += factor * slopes[j, i]
        part = 1.0 if is_last else tableau.c[stage]
        # The torques of the drives are summed with the weights of the step, and known at its end.
        torques = is_last or tableau.b[stage] != 0.0
        evaluate(system, onset, t + part * h, new, slopes[stage], torques)
    first = 0.0
    second = 0.0
    count = scale.shape[0]
    for i in range(count):
        one, two = errors_of(tableau, slopes, i)
        first += (one / scale[i]) ** 2
        second += (two / scale[i]) ** 2
    for k in range(system.packed.joints.shape[0]):
        if system.packed.joints[k].friction.bristle_stiffness > 0.0:
            one, two = errors_of(tableau, slopes, bristle_place(scale.shape[0], k))
            first += (one / scale[0]) ** 2
            second += (two / scale[0]) ** 2
            count += 1
        loss = bristle_place(scale.shape[0], k) - BRISTLE + CONTACT_LOSS
        if system.packed.joints[k].normal.abrupt and slopes[0, loss] != 0.0:
            # Its force ends before the contact does: no rate feels the energy lost until then.
            kinetic = 0.0
            for i in range(system.packed.mass.shape[0]):
                kinetic += 0.5 * system.packed.mass[i] * system.state[1, i] ** 2
            energy = max(new[loss], new[scale.shape[0] + 1], UNEXCHANGED * kinetic)
            allowed = energy * scale[0] / POSITION_SCALE
            one, two = errors_of(tableau, slopes, loss)
            first += (one / allowed) ** 2
            second += (two / allowed) ** 2
            count += 1
    if first == 0.0 and second == 0.0:
        return 0.0
    return abs(h) * first / math.sqrt((first + 0.01 * second) * count)
