"""Trial steps of the equations of motion: embedded Runge-Kutta methods, and the classical one."""

import math
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.dae.dynamics import System, evaluate
from presswear.engines.dormand_prince import DOP853, Tableau
from presswear.physics.equations.function import ACCELERATIONS, END, RATES
from presswear.physics.equations.layout import CONTACT_LOSS, DRIVE_EXCHANGE
from presswear.recording.observe import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined
from presswear.tools.packing import PackedArguments, unpack

# The tolerance times this is the error allowed in a position, m or rad, per step.
POSITION_SCALE = 1e-3
# part of the kinetic energy to which the error of a loss is compared at least
UNEXCHANGED = 1e-3
# Indices of the slopes at the start of a step, and of spare ones; compiled as any other
# index
START: Any = np.int64(0)
SPARE: Any = np.int64(DOP853.b.size + 1)

# State of an integration
CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("most", np.int64),  # steps of a march
        ("step", np.float64),  # next, s
        ("whole", np.float64),  # step on trial before events cut it, s
        ("length", np.float64),  # of the step on trial, s
        ("reaches_end", np.bool_),  # of a march
        # Search for the event that ends the step: events looked for, Newton steps
        # towards the present one, its number or -1, and whether it was located
        ("searches", np.int64),
        ("moves", np.int64),
        ("event", np.int64),
        ("is_located", np.bool_),
        *floats(
            "low", "high", "further"
        ),  # lengths between which it lies, and beyond the last, s
        ("is_last", np.bool_),  # the last length that is tried
        # time at which an equal step that was cut is to end, s; or 0
        ("due", np.float64),
        ("longest", np.float64),  # s
        ("shortest", np.float64),  # s
        ("resolution", np.float64),  # of the coordinates, m: below it lies round-off
        ("parts", np.float64),  # steps in a free impact, at least
        ("tolerance", np.float64),
        ("projected", np.bool_),
        ("has_started", np.bool_),  # the initial state is recorded
        ("has_slope", np.bool_),  # the slopes of the state are evaluated
        # the next step does not end where friction has a corner
        ("ignores_corners", np.bool_),
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
    # of the stages, (14, m); the first holds dy/dt at the start, the last is spare
    slopes: Array


class Integration(NamedTuple):
    """Integration of a system; a march receives its address."""

    system: System
    tableau: Tableau | None  # of an embedded method
    # Stages of the classical method, for equal steps; the compiler leaves out the None
    # of both
    classical: int | None
    records: RecorderState
    control: Records  # one of CONTROL
    motion: Motion
    last: int  # index of the slopes at the end of a step


@compiled
def rates(address: PackedArguments, t: float, y: Array, stage: int) -> None:
    """Evaluate dy/dt in a state and store it as the slopes of a stage."""
    (run,) = unpack(address)
    system = run.system
    evaluate(system, system.constraints, t, y, run.motion.slopes[stage], END)


@compiled
def classical_step(address: PackedArguments, t: float, h: float) -> None:
    """Make a trial step of order 4."""
    (run,) = unpack(address)
    classical, control, motion = run.classical, run.control, run.motion
    y, new, slopes = motion.y, motion.trial, motion.slopes
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
def weighted_sum(
    target: Array, slopes: Array, weights: Array, count: int, size: int
) -> None:
    """Fill the sum of the first rows of slopes, each times its weight, in the first columns."""
    odd = count & 1
    for i in range(size):
        target[i] = weights[0] * slopes[0, i]
    if odd == 0:
        for i in range(size):
            target[i] += weights[1] * slopes[1, i]
    for j in range(2 - odd, count, 2):
        one = weights[j]
        two = weights[j + 1]
        if one != 0.0 or two != 0.0:
            for i in range(size):
                target[i] += one * slopes[j, i] + two * slopes[j + 1, i]


@inlined
def mean_error(run: Integration, weights: Array) -> float:
    """Return an estimate of the error of a trial step over the allowed one, squared, per step^2.

    It is the mean over coordinates, rates and states of interactions. Where the force
    of a joint ends before its contact does, the loss of contacts counts, too: no rate
    feels the energy lost until then.
    """
    system, tolerance = run.system, run.control[0].tolerance
    layout = system.layout
    motion = run.motion
    y, new, slopes = motion.y, motion.trial, motion.slopes
    position = 1.0 / (tolerance * POSITION_SCALE)
    errors = slopes[SPARE]
    checked = layout.first_dose if system.has_abrupt else layout.first_energy
    weighted_sum(errors, slopes, weights, run.last + 1, checked)
    total = 0.0
    count = float(layout.first_energy)
    for i in range(layout.coordinates):
        total += (errors[i] * position) ** 2
    for i in range(layout.coordinates, layout.first_state):
        total += (errors[i] / (tolerance * (1.0 + abs(y[i])))) ** 2
    for i in range(layout.first_state, layout.first_energy):
        total += (errors[i] * position) ** 2
    loss = layout.first_energy + CONTACT_LOSS
    if system.has_abrupt and slopes[0, loss] != 0.0:
        exchange = new[layout.first_energy + DRIVE_EXCHANGE]
        energy = max(new[loss], exchange, UNEXCHANGED * kinetic_energy(system))
        total += (errors[loss] / (tolerance * energy)) ** 2
        count += 1.0
    return total / count


@inlined
def kinetic_energy(system: System) -> float:
    """Return the kinetic energy of the motion placed last, J."""
    energy = 0.0
    for i in range(system.packed.mass.shape[0]):
        energy += 0.5 * system.packed.mass[i] * system.state[1, i] * system.state[1, i]
    return energy


@compiled
def embedded_step(
    address: PackedArguments, tableau: Tableau, t: float, h: float
) -> float:
    """Make a trial step; returns its error over the allowed one.

    The slopes of the last stage hold dy/dt at the end afterwards.  The error of the
    integrals follows that of positions, rates and states.
    """
    (run,) = unpack(address)
    system = run.system
    motion = run.motion
    y, new, slopes = motion.y, motion.trial, motion.slopes
    stages = tableau.b.shape[0]
    for stage in range(1, stages):
        # Slopes do not depend on the integrals.
        count = system.layout.first_energy
        weighted_sum(new, slopes, tableau.a[stage], stage, count)
        for i in range(count):
            new[i] = y[i] + h * new[i]
        # Powers are summed with the weights of the step.
        level = RATES if tableau.b[stage] != 0.0 else ACCELERATIONS
        evaluate(
            system,
            system.constraints,
            t + tableau.c[stage] * h,
            new,
            slopes[stage],
            level,
        )
    size = y.shape[0]
    weighted_sum(new, slopes, tableau.b, stages, size)
    for i in range(size):
        new[i] = y[i] + h * new[i]
    evaluate(system, system.constraints, t + h, new, slopes[stages], END)
    error = mean_error(run, tableau.error)
    if tableau.second_error[0] == 0.0:
        return abs(h) * math.sqrt(error)
    second = mean_error(run, tableau.second_error)
    blended = error + 0.01 * second
    return abs(h) * error / math.sqrt(blended) if blended > 0.0 else blended
