"""Trial steps of the equations of motion: embedded Runge-Kutta methods, and the classical one."""

import math
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.dae.dynamics import System, bristle_place, evaluate
from presswear.engines.dormand_prince import Tableau
from presswear.physics.forces import BRISTLE, CONTACT_LOSS
from presswear.recording.observe import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import (
    PackedArguments,
    Records,
    compiled,
    floats,
    inlined,
    unpack,
)
from presswear.tools.lanes import where

# The tolerance times this is the error allowed in a position, m or rad, per step.
POSITION_SCALE = 1e-3
UNEXCHANGED = 1e-3  # part of the kinetic energy to which the error of a loss is compared at least
START: Any = np.int64(0)  # index of the slopes at the start of a step; compiled as any other index

# State of an integration
CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("most", np.int64),  # steps of a march
        ("step", np.float64),  # next, s
        ("whole", np.float64),  # step on trial before events cut it, s
        ("length", np.float64),  # of the step on trial, s
        ("reaches_end", np.bool_),  # of a march
        # Search for the event that ends the step: events looked for, Newton steps towards the
        # present one, its number or -1, and whether it was located
        ("searches", np.int64),
        ("moves", np.int64),
        ("event", np.int64),
        ("is_located", np.bool_),
        *floats("low", "high", "further"),  # lengths between which it lies, and beyond the last, s
        ("is_last", np.bool_),  # the last length that is tried
        ("due", np.float64),  # time at which an equal step that was cut is to end, s; or 0
        ("longest", np.float64),  # s
        ("shortest", np.float64),  # s
        ("resolution", np.float64),  # of the coordinates, m: below it lies round-off
        ("parts", np.float64),  # steps in a free impact, at least
        ("tolerance", np.float64),
        ("projected", np.bool_),
        ("has_started", np.bool_),  # the initial state is recorded
        ("has_slope", np.bool_),  # the slopes of the state are evaluated
        ("ignores_corners", np.bool_),  # the next step does not end where friction has a corner
        ("steps", np.int64),
        ("rejected", np.int64),
        ("events", np.int64),
        ("evaluations", np.int64),  # of the accelerations
        ("position_error", np.float64),  # greatest |Phi|
        ("velocity_error", np.float64),  # greatest |dPhi/dt|
    ]
)


class Motion(NamedTuple):
    """State and the step from it."""

    y: Array  # (m,)
    trial: Array  # the state's successor on trial, (m,)
    slopes: Array  # of the stages, (13, m); the first holds dy/dt at the start


class Integration(NamedTuple):
    """Integration of a system; a march receives its address."""

    system: System
    tableau: Tableau | None  # of an embedded method
    # Stages of the classical method, for equal steps; the compiler leaves out the None of both
    classical: int | None
    records: RecorderState | None  # None of several replicates
    control: Records  # one of CONTROL
    motion: Motion
    last: int  # index of the slopes at the end of a step


@compiled
def rates(address: PackedArguments, t: float, y: Array, stage: int) -> None:
    """Evaluate dy/dt in a state and store it as the slopes of a stage."""
    (run,) = unpack(address)
    system = run.system
    out, torques = run.motion.slopes[stage], stage >= 0  # not a literal, as START
    alone, members = system.alone, system.members
    evaluate(system, system.held, system.tree, alone, members, t, y, out, torques, True)


@compiled
def classical_step(address: PackedArguments, t: float, h: float) -> None:
    """Make a trial step of order 4."""
    (run,) = unpack(address)
    classical, control, motion = run.classical, run.control, run.motion
    y, new, slopes = motion
    control[0].evaluations += classical
    for stage in range(1, 4):
        part = h if stage == 3 else 0.5 * h
        for i in range(y.shape[0]):
            new[i] = y[i] + part * slopes[stage - 1, i]
        rates(address, t + part, new, stage)
    for i in range(y.shape[0]):
        new[i] = y[i] + h / 6.0 * (
            slopes[0, i] + 2.0 * (slopes[1, i] + slopes[2, i]) + slopes[3, i]
        )


@inlined
def _errors(tableau: Tableau, slopes: Array, i: int, allowed: float) -> tuple[float, float]:
    """Return both estimates of the error of a component over the allowed one, squared, per step."""
    one = 0.0
    two = 0.0
    for j in range(tableau.b.shape[0] + 1):
        one += tableau.error[j] * slopes[j, i]
        two += tableau.second_error[j] * slopes[j, i]
    one /= allowed
    two /= allowed
    return one * one, two * two


@compiled
def embedded_step(address: PackedArguments, tableau: Tableau, t: float, h: float) -> float:
    """Make a trial step; returns its error over the allowed one.

    The slopes of the last stage hold dy/dt at the end afterwards.  The error of the integrals
    follows that of positions and rates, but for the deflections of bristles.
    """
    (run,) = unpack(address)
    system, tolerance = run.system, run.control[0].tolerance
    y, new, slopes = run.motion
    stages = tableau.b.shape[0]
    for stage in range(1, stages + 1):
        is_last = stage == stages
        weights = tableau.b if is_last else tableau.a[stage]
        # Slopes do not depend on the integrals, but for those of bristles.
        size = y.shape[0] if is_last else system.felt
        for i in range(size):
            new[i] = y[i]
        for j in range(stage):
            if weights[j] != 0.0:
                factor = h * weights[j]
                for i in range(size):
                    new[i] += factor * slopes[j, i]
        part = 1.0 if is_last else tableau.c[stage]
        # The torques of the drives are summed with the weights of the step, and needed at its end.
        torques = is_last or tableau.b[stage] != 0.0
        out = slopes[stage]
        held, tree, alone, members = system.held, system.tree, system.alone, system.members
        at = t + part * h
        evaluate(system, held, tree, alone, members, at, new, out, torques, is_last)
    first = 0.0
    second = 0.0
    size, count, allowed = 2 * system.size, 2.0 * system.size, tolerance * POSITION_SCALE
    for i in range(size):
        if i < system.size:
            one, two = _errors(tableau, slopes, i, allowed)
        else:
            one, two = _errors(tableau, slopes, i, tolerance * (1.0 + abs(y[i])))
        first += one
        second += two
    for k in range(system.packed.joints.shape[0]):
        bristle = bristle_place(size, k)
        if system.packed.joints[k].friction.bristle_stiffness > 0.0:
            one, two = _errors(tableau, slopes, bristle, allowed)
            first += one
            second += two
            count += 1.0
        loss = bristle - BRISTLE + CONTACT_LOSS
        if system.packed.joints[k].normal.abrupt:
            # Its force ends before the contact does: no rate feels the energy lost until then.
            kinetic = 0.0
            for i in range(system.packed.mass.shape[0]):
                kinetic += 0.5 * system.packed.mass[i] * system.state[1, i] * system.state[1, i]
            energy = max(max(new[loss], new[size + 1]), UNEXCHANGED * kinetic)
            one, two = _errors(tableau, slopes, loss, energy * allowed / POSITION_SCALE)
            is_lossy = slopes[0, loss] != 0.0
            first += where(is_lossy, one, 0.0)
            second += where(is_lossy, two, 0.0)
            count += where(is_lossy, 1.0, 0.0)
    error = abs(h) * first / math.sqrt((first + 0.01 * second) * count)
    return where((first == 0.0) & (second == 0.0), 0.0, error)
