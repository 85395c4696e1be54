"""Trial steps of the equations of motion by embedded and classical Runge-Kutta methods."""

import math
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.dae.dynamics import System, evaluate
from presswear.physics.dormand_prince import DOP853, Tableau
from presswear.physics.equations.function import ACCELERATIONS, END, RATES
from presswear.physics.equations.layout import CONTACT_LOSS, DRIVE_EXCHANGE
from presswear.recording.observe import StepObserver
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined
from presswear.tools.packing import PackedArguments, unpack

# Largest error of a position in a step, m or rad, divided by the tolerance
POSITION_SCALE = 1e-3
# Least energy to which the error of a loss is compared, divided by the kinetic energy
LEAST_ENERGY = 1e-3
# Rows of ``Motion.slopes`` for dy/dt at the start of a step, and for working space. A
# computed index is an int64 too, so that kernels are compiled for one type only.
START: Any = np.int64(0)
SPARE: Any = np.int64(DOP853.b.size + 1)

# State of an integration
CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("most", np.int64),  # largest number of steps of a march
        ("step", np.float64),  # next step, s
        ("whole", np.float64),  # trial step before events shorten it, s
        ("length", np.float64),  # trial step, s
        ("reaches_end", np.bool_),  # the trial step ends at the end of the march
        # Search for the event that ends the step
        ("searches", np.int64),  # events that were searched for in this step
        ("moves", np.int64),  # Newton steps towards the present event
        ("event", np.int64),  # number of the present event, or -1
        ("is_located", np.bool_),  # the trial step ends on the event
        *floats("low", "high"),  # step lengths between which the event lies, s
        ("extension", np.float64),  # additional length of the next trial step, s
        ("is_last", np.bool_),  # no other length is tried
        # time at which a step of fixed length ends that an event has shortened, s; or 0
        ("due", np.float64),
        ("longest", np.float64),  # longest allowed step, s
        ("shortest", np.float64),  # shortest allowed step, s
        ("resolution", np.float64),  # round-off of the coordinates, m
        ("parts", np.float64),  # least number of steps in a free impact
        ("tolerance", np.float64),
        ("projected", np.bool_),  # steps are projected on the constraints
        ("has_started", np.bool_),  # the initial state is recorded
        ("has_slope", np.bool_),  # dy/dt of the state is evaluated
        # the next step may pass a corner of the friction law
        ("ignores_corners", np.bool_),
        ("steps", np.int64),  # accepted steps
        ("rejected", np.int64),  # rejected trial steps
        ("events", np.int64),  # located events
        ("evaluations", np.int64),  # evaluations of the accelerations
        ("position_error", np.float64),  # greatest |Phi|
        ("velocity_error", np.float64),  # greatest |dPhi/dt|
    ]
)


class Motion(NamedTuple):
    """State vector and a trial step from it."""

    y: Array  # state vector, (m,)
    trial: Array  # state vector at the end of the trial step, (m,)
    # dy/dt of the stages, (14, m): the first row at the start, the last is working space
    slopes: Array


class Integration(NamedTuple):
    """Integration of a system; a march receives its address."""

    system: System
    # Either the coefficients of an embedded method, or the number of stages of the classical
    # method, for steps of fixed length. The other field is None, and the kernels are
    # compiled without it.
    tableau: Tableau | None
    classical: int | None
    records: RecorderState
    observer: StepObserver
    control: Records  # one of CONTROL
    motion: Motion
    last: int  # row of the slopes at the end of a step


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
    classical = run.classical
    control = run.control
    y = run.motion.y
    new = run.motion.trial
    slopes = run.motion.slopes
    control[0].evaluations += classical
    for stage in range(1, 4):
        elapsed = h if stage == 3 else 0.5 * h
        for i in range(y.shape[0]):
            new[i] = y[i] + elapsed * slopes[stage - 1, i]
        rates(address, t + elapsed, new, stage)
    for i in range(y.shape[0]):
        new[i] = y[i] + h / 6.0 * (
            slopes[0, i] + 2.0 * (slopes[1, i] + slopes[2, i]) + slopes[3, i]
        )


@inlined
def weighted_sum(
    target: Array, slopes: Array, weights: Array, count: int, size: int
) -> None:
    """Set ``target`` to the weighted sum of the first ``count`` rows of slopes.

    The sum has ``size`` columns. Two rows are added at a time, which is faster.
    """
    odd = count & 1
    for i in range(size):
        target[i] = weights[0] * slopes[0, i]
    if odd == 0:
        for i in range(size):
            target[i] += weights[1] * slopes[1, i]
    for j in range(2 - odd, count, 2):
        first = weights[j]
        second = weights[j + 1]
        if first != 0.0 or second != 0.0:
            for i in range(size):
                target[i] += first * slopes[j, i] + second * slopes[j + 1, i]


@inlined
def mean_error(run: Integration, weights: Array) -> float:
    """Return the mean square of error over allowed error, divided by the step squared.
    The mean is over coordinates, rates and states of interactions. If the force of a
    joint can end before its contact, the loss in contacts is included: the energy that
    is lost after the end of the force has no effect on the rates.
    """
    system = run.system
    tolerance = run.control[0].tolerance
    layout = system.layout
    y = run.motion.y
    new = run.motion.trial
    slopes = run.motion.slopes
    position = 1.0 / (tolerance * POSITION_SCALE)
    errors = slopes[SPARE]
    checked = layout.first_wear_integral if system.has_abrupt else layout.first_energy
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
        energy = max(new[loss], exchange, LEAST_ENERGY * kinetic_energy(system))
        total += (errors[loss] / (tolerance * energy)) ** 2
        count += 1.0
    return total / count


@inlined
def kinetic_energy(system: System) -> float:
    """Return the kinetic energy of the motion that was evaluated last, J."""
    energy = 0.0
    for i in range(system.packed.mass.shape[0]):
        energy += 0.5 * system.packed.mass[i] * system.v[i] * system.v[i]
    return energy


@compiled
def embedded_step(
    address: PackedArguments, tableau: Tableau, t: float, h: float
) -> float:
    """Make a trial step; return its error over the allowed error.

    Afterwards the slopes of the last stage are dy/dt at the end of the step. Integrals
    are not checked, because their error is small if positions, rates and states are
    accurate.
    """
    (run,) = unpack(address)
    system = run.system
    y = run.motion.y
    new = run.motion.trial
    slopes = run.motion.slopes
    stages = tableau.b.shape[0]
    for stage in range(1, stages):
        # Slopes do not depend on the integrals, which come after the first ``count`` values.
        count = system.layout.first_energy
        weighted_sum(new, slopes, tableau.a[stage], stage, count)
        for i in range(count):
            new[i] = y[i] + h * new[i]
        # A stage with weight zero does not contribute to the integrals: no powers needed.
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
    return step_error(run, tableau, h)


@inlined
def step_error(run: Integration, tableau: Tableau, h: float) -> float:
    """Return the error of a trial step over the allowed error.

    A method with two error estimates combines them as DOP853 does.
    """
    error = mean_error(run, tableau.error)
    if tableau.second_error[0] == 0.0:
        return abs(h) * math.sqrt(error)
    second = mean_error(run, tableau.second_error)
    denominator = error + 0.01 * second
    if denominator > 0.0:
        return abs(h) * error / math.sqrt(denominator)
    return denominator  # zero or nan
