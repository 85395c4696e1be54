"""Kernels of the model with bodies and joints: connector forces and accepted steps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.closed_loops import drive_torques, place_prescribed
from presswear.physics.constraints import (
    ConstraintSystem,
    evaluate_constraints,
    factor,
    multipliers_of,
    project,
    project_acceleration,
)
from presswear.physics.contact import copy_contacts
from presswear.physics.drive_motion import drive_motion, step_to_break
from presswear.physics.equations.function import (
    ACCELERATIONS,
    END,
    FORCE,
    RATES,
    Model,
    Written,
    fill,
)
from presswear.physics.equations.layout import (
    DOSE_COUNT,
    DRIVE_EXCHANGE,
    DRIVE_WORK,
    FRICTION_LOSS,
    LOAD_WORK,
    PRESSURE,
    TORQUE,
    TORQUE_INTEGRALS,
    WORK,
    Layout,
)
from presswear.physics.event_time import time_to_event
from presswear.physics.load_transitions import greatest_jump, next_break, settle_loads
from presswear.physics.loads import work_beyond_trapezoid
from presswear.physics.packed import Packed
from presswear.physics.prescribed import Prescribed, subtract_inertia
from presswear.physics.rubbing import add_friction, friction_moment, friction_power
from presswear.physics.step_length import next_step, shorter_step
from presswear.physics.touchdown import LEAST_STEPS, joint_crossing, settle
from presswear.recording.nominal_time import section_at_start, section_value
from presswear.recording.observe import RecorderState, observe, sum_drives
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, all_finite, compiled, copy_to, inlined
from presswear.tools.packing import PackedArguments, unpack

Indices = NDArray[np.int64]

# Smallest relative change of a load at a transition of its law that counts as a jump
JUMP = 1e-3
# Rows of ``Frame.states`` at the start and at the end of a step. Each begins three rows:
# value, rate, and derivative of the rate by the value.
STEP_START, STEP_END = 0, 3
RATE, SLOPE = 1, 2
# Largest time between the end of a step and the angle at which a section ends, s
SECTION_NEAR = 1e-9
# Largest relative difference between a step and the step that was chosen to end there
SECTION_TOL = 1e-3
FORCES, START, ACCEPTED, SHORTER = range(4)
"""Tasks of ``run_task``."""


class Friction(NamedTuple):
    """Friction in rigid joints: joint forces from Exudyn, friction moments to Exudyn."""

    joints: Records  # of RUBBING
    rows: Indices  # index of the first of the two multipliers of each joint
    # indices of bearing and pin in the connector forces, (joints, 2); -1 for the frame
    slots: Indices
    multipliers: Array  # live multipliers of Exudyn


class Frame(NamedTuple):
    """Coordinates of all bodies, and the coordinates for which Exudyn solves.

    If Exudyn solves for all coordinates, ``q``, ``v`` and ``a`` are its live arrays,
    and ``solved_indices`` is empty.
    """

    solved_q: Array  # Exudyn's live coordinates, rates and accelerations
    solved_v: Array
    solved_a: Array
    solved_indices: Indices  # index in q of each coordinate that Exudyn solves for
    prescribed: Prescribed  # bodies that are not in Exudyn's model
    q: Array  # (3 bodies,)
    v: Array
    a: Array
    axes: Array
    # function for the forces of contacts, springs and loads on all bodies
    forces: Written
    model: Model  # arguments of this function, with the contacts of trial states
    y: Array  # its state vector
    rates: Array  # rates of this state vector
    layout: Layout
    scales: Array  # smallest changes that matter of states of interactions, (states,)
    # clearance joint whose touchdown changes the rate of each state; -1: none
    state_joints: Indices
    # states of interactions, see STEP_START, (6, states)
    states: Array
    friction: Friction | None  # None without friction in rigid joints


@compiled
def refresh(frame: Frame, t: float) -> None:
    """Fill the coordinates of all bodies from Exudyn's present state."""
    if frame.solved_indices.shape[0] == 0:
        return
    for i in range(frame.solved_indices.shape[0]):
        index = frame.solved_indices[i]
        frame.q[index] = frame.solved_q[i]
        frame.v[index] = frame.solved_v[i]
        frame.a[index] = frame.solved_a[i]
    place_prescribed(frame.prescribed, t, frame.q, frame.v, frame.a, frame.axes)


@inlined
def fill_forces(frame: Frame, t: float, level: int) -> None:
    """Fill the forces on all bodies, and at level END the contacts, in the present state."""
    n = frame.q.shape[0]
    copy_to(frame.y[:n], frame.q)
    copy_to(frame.y[n : 2 * n], frame.v)
    fill(frame.forces, t, frame.y, frame.rates, level)


@compiled
def exponential_step(value: float, rate: float, slope: float, h: float) -> float:
    """Return the solution z(h) of z' = rate + slope (z - value) with z(0) = value."""
    return value + rate * (math.expm1(slope * h) / slope if slope != 0.0 else h)


@compiled
def next_state(frame: Frame, records: RecorderState, i: int, t: float) -> float:
    """Return state ``i`` at the end of a step, from the rates at both ends of the step.

    The rate is linear in the state. The exponential step does not oscillate for a stiff
    state, as the trapezoidal rule would. A step in which the pin touches down or
    separates is divided at this event.
    """
    joint = frame.state_joints[i]
    contacts = frame.model.contact_records
    start, start_rate, start_slope, end, end_rate, end_slope = frame.states[:, i]
    h = t - records.output[0].now
    fraction = 2.0
    if joint >= 0:
        last = records.memory[joint]
        is_closed = last.penetration > 0.0
        fraction = joint_crossing(last, contacts[joint], is_closed, h)[0]
    if fraction < 1.0:
        value = exponential_step(start, start_rate, start_slope, fraction * h)
        rate = end_rate + end_slope * (value - end)
        return exponential_step(value, rate, end_slope, (1.0 - fraction) * h)
    mean_rate = 0.5 * (start_rate + end_rate + end_slope * (start - end))
    mean_slope = 0.5 * (start_slope + end_slope)
    return exponential_step(start, mean_rate, mean_slope, h)


@compiled
def linearise_states(frame: Frame, t: float, row: int) -> None:
    """Fill states, rates and derivatives of the rates into three rows, from ``row`` on.

    The forces must be filled before the call. They are those of changed states
    afterwards, because the derivatives are finite differences.
    """
    first = frame.layout.first_state
    states = frame.states
    for i in range(frame.scales.shape[0]):
        states[row, i] = frame.y[first + i]
        states[row + RATE, i] = frame.rates[first + i]
        frame.y[first + i] += frame.scales[i]
    fill_forces(frame, t, ACCELERATIONS)
    for i in range(frame.scales.shape[0]):
        change = frame.rates[first + i] - states[row + RATE, i]
        states[row + SLOPE, i] = change / frame.scales[i]
        frame.y[first + i] = states[row, i]


@compiled
def fill_end_forces(frame: Frame, records: RecorderState, t: float, level: int) -> None:
    """Fill the forces at the end of a step, with the states of interactions at that time."""
    count = frame.scales.shape[0]
    if count > 0:
        fill_forces(frame, t, END)
        linearise_states(frame, t, STEP_END)
        for i in range(count):
            frame.y[frame.layout.first_state + i] = next_state(frame, records, i, t)
    fill_forces(frame, t, level)


@compiled
def start_states(frame: Frame, t: float) -> None:
    """Store the states of interactions at the start of a step; forces were filled at level END."""
    if frame.scales.shape[0] > 0:
        linearise_states(frame, t, STEP_START)
        fill_forces(frame, t, END)


@compiled
def note_friction(friction: Friction | None, v: Array) -> float:
    """Fill the friction moments of rigid joints under the present joint forces.

    Returns the friction power, W. During Newton's iteration of Exudyn the joint forces
    are those of the present iterate, so that moments and joint forces converge
    together.
    """
    if friction is None:
        return 0.0
    for k in range(friction.joints.shape[0]):
        row = friction.rows[k]
        x = friction.multipliers[row]
        y = friction.multipliers[row + 1]
        joint = friction.joints[k]
        joint.moment = friction_moment(joint, v, math.sqrt(x * x + y * y))
    return friction_power(friction.joints, v)


@compiled
def add_moments(friction: Friction | None, out: Array) -> None:
    """Add the friction moments of rigid joints to the forces of the connector."""
    if friction is None:
        return
    for k in range(friction.joints.shape[0]):
        moment = friction.joints[k].moment
        i = friction.slots[k, 0]
        if i >= 0:
            out[i + 2] -= moment
        i = friction.slots[k, 1]
        if i >= 0:
            out[i + 2] += moment


@compiled
def connector_forces(address: PackedArguments, t: float) -> None:
    """Fill the generalized forces of joints, springs and loads.

    The last two arrays in ``address`` are the index in q of each coordinate of the
    connector, and the forces, which are filled.
    """
    frame, _, records, _, indices, out = unpack(address)
    refresh(frame, t)
    fill_end_forces(frame, records, t, ACCELERATIONS)
    for i in range(out.shape[0]):
        out[i] = frame.model.bodies[FORCE, indices[i]]
    note_friction(frame.friction, frame.v)
    add_moments(frame.friction, out)


class Drives(NamedTuple):
    """Sources of the torques of the drives."""

    # drives with a motor, whose torque is among the forces on all bodies
    has_motor: NDArray[np.bool_]
    # index of each drive's multiplier; -1 for a drive that is not in Exudyn's model
    multiplier: Indices
    # live multipliers of Exudyn; the torque of a drive is minus its multiplier
    multipliers: Array
    force: Array  # working space, (3 bodies,)
    # Constraints, if a drive turns at an uneven speed or the law of a load has a corner
    # over position; see ``project_state``
    constraints: ConstraintSystem | None


@compiled
def all_forces(frame: Frame, packed: Packed, force: Array) -> None:
    """Fill the sum of all forces on the bodies: weights, constant loads and written forces."""
    for i in range(force.shape[0]):
        force[i] = packed.weight[i] + frame.model.bodies[FORCE, i]


@compiled
def begin_step(address: PackedArguments, t: float) -> None:
    """Fill contacts and forces of the present state, from which a step starts."""
    frame, _, records, _, _, _ = unpack(address)
    refresh(frame, t)
    first_state = frame.layout.first_state
    first_energy = frame.layout.first_energy
    copy_to(frame.y[first_state:first_energy], frame.states[STEP_START])
    fill_forces(frame, t, END)
    start_states(frame, t)
    copy_contacts(records.contacts, frame.model.contact_records)


@compiled
def begin_friction(
    frame: Frame,
    constraints: ConstraintSystem,
    packed: Packed,
    drives: Drives,
    friction: Friction,
) -> None:
    """Fill the joint forces of the initial state: Exudyn needs them for its accelerations."""
    force = drives.force
    all_forces(frame, packed, force)
    evaluate_constraints(constraints, 0.0, frame.q, frame.v)
    factor(constraints)
    multipliers_of(constraints, 0.0, 0.0, force)
    add_friction(constraints, friction.joints, 0.0, 0.0, frame.v, force)
    for k in range(friction.joints.shape[0]):
        row = friction.joints[k].row
        for axis in range(2):
            index = friction.rows[k] + axis
            friction.multipliers[index] = constraints.multipliers[row + axis]


@compiled
def project_state(
    frame: Frame, drives: Drives, constraints: ConstraintSystem | None, t: float
) -> None:
    """Project an accepted state on the constraints of position, velocity and acceleration.

    The trapezoidal rule satisfies joints and drives in velocities only. With an uneven
    speed of a drive, the angle has an error of third order in each step, and the
    acceleration oscillates about the exact one without end. It also oscillates after a
    very short step.
    """
    if constraints is None:
        return
    project(constraints, t, frame.q, frame.v)
    project_acceleration(constraints, t, frame.q, frame.v, frame.a)
    for row in range(constraints.records.shape[0]):
        drive = constraints.records[row].drive
        if drive >= 0 and drives.multiplier[drive] >= 0:
            drives.multipliers[drives.multiplier[drive]] += constraints.multipliers[row]
    for i in range(frame.solved_indices.shape[0]):
        index = frame.solved_indices[i]
        frame.solved_q[i] = frame.q[index]
        frame.solved_v[i] = frame.v[index]
        frame.solved_a[i] = frame.a[index]


@compiled
def drive_power(
    frame: Frame, drives: Drives, records: RecorderState, t: float
) -> float:
    """Fill the torques of the drives; return the power of all drives, W."""
    prescribed = frame.prescribed
    if prescribed.parts.shape[0] > 0:
        all_forces(frame, records.packed, drives.force)
        subtract_inertia(prescribed.parts, frame.a, drives.force)
        drive_torques(prescribed, frame.q, frame.axes, drives.force, records.torque)
    power = 0.0
    for i in range(records.motions.shape[0]):
        if drives.has_motor[i]:
            first = frame.layout.first_torque + TORQUE_INTEGRALS * i
            records.torque[i] = frame.rates[first + TORQUE]
            power += records.torque[i] * frame.v[records.packed.driven[i]]
            continue
        if drives.multiplier[i] >= 0:
            records.torque[i] = -drives.multipliers[drives.multiplier[i]]
        power += records.torque[i] * drive_motion(records.motions[i], t)[1]
    return power


@compiled
def sum_step(
    frame: Frame, records: RecorderState, power: float, t: float, h: float
) -> None:
    """Integrate wear and energies over a step by the trapezoidal rule.

    ``power`` is that of all drives, W. If the joint was open at the start of the step,
    wear is integrated from its touchdown. If it is open at the end, the wear of the
    step is neglected, because the place of the contact is not defined.
    """
    layout = frame.layout
    energies = records.energies
    powers = records.powers
    for i in range(energies.shape[0]):
        energies[i] += 0.5 * h * powers[i]
    copy_to(powers, frame.rates[layout.first_energy : layout.first_dose])
    powers[DRIVE_WORK] = power
    powers[DRIVE_EXCHANGE] = abs(power)
    powers[FRICTION_LOSS] += note_friction(frame.friction, frame.v)
    for i in range(energies.shape[0]):
        energies[i] += 0.5 * h * powers[i]
    for k in range(records.memory.shape[0]):
        doses = frame.rates[layout.first_dose + DOSE_COUNT * k :]
        integrals = records.wear_integrals[k]
        duration = min(h, t - records.memory[k].touchdown_time)
        half = 0.5 * duration if records.contacts[k].penetration > 0.0 else 0.0
        integrals.work = half * (integrals.work_rate + doses[WORK])
        integrals.pressure = half * (integrals.pressure_rate + doses[PRESSURE])
        integrals.work_rate = doses[WORK]
        integrals.pressure_rate = doses[PRESSURE]


@compiled
def accept_joint_step(address: PackedArguments, t: float) -> float:
    """Record an accepted step and return the next step, s; NaN if the state is not finite."""
    frame, drives, records, steps, _, _ = unpack(address)
    h = t - records.output[0].now
    refresh(frame, t)
    project_state(frame, drives, drives.constraints, t)
    if not all_finite(frame.q, frame.v):
        return math.nan
    fill_end_forces(frame, records, t, END)
    copy_contacts(records.contacts, frame.model.contact_records)
    start_states(frame, t)
    if settle(records, t, LEAST_STEPS) > 0:
        fill_forces(frame, t, END)
        copy_contacts(records.contacts, frame.model.contact_records)
    sum_step(frame, records, drive_power(frame, drives, records, t), t, h)
    sum_drives(records, h, frame.v)
    packed = records.packed
    records.energies[LOAD_WORK] += work_beyond_trapezoid(
        packed.loads, t, frame.q, frame.v
    )
    changes = settle_loads(packed.loads, t, frame.q, frame.v, frame.a)
    observe(records, t, h, frame.q, frame.v, frame.a)
    following = next_step(records, steps, frame.a)
    if changes > 0:
        fill_forces(frame, t, RATES)
        records.powers[LOAD_WORK] = frame.rates[frame.layout.first_energy + LOAD_WORK]
        if greatest_jump(packed.loads) > JUMP:
            # The accelerations at the start of the next step are those before the jump.
            following = steps[0].least
    left = next_break(packed.loads) - t
    following = step_to_break(records.motions, t, min(following, left))
    following = step_to_section(records, following)
    return max(following, 0.1 * steps[0].least)


@compiled
def step_to_section(records: RecorderState, h: float) -> float:
    """Return the step, s, of at most ``h``, that does not pass the angle where a section ends."""
    p, r, a, _ = section_at_start(records.nominal, False)
    if p >= 0.0 or math.isinf(p):
        return h
    arrival, speed, _ = time_to_event(p, r, a, 0.0)
    if speed <= 0.0:
        return h
    if arrival <= h:
        return arrival
    # A step that would end shortly before the angle is shortened, so that the next step
    # is not very short.
    return 0.5 * arrival if arrival < 2.0 * h else h


@compiled
def step_back_to_section(frame: Frame, records: RecorderState, h: float) -> float:
    """Return the step, s, that replaces a trial step which misses the end of a section.

    -1 if the trial step need not be repeated: it does not pass that angle, or it was
    not chosen to end at that angle.
    """
    p, r, a, _ = section_at_start(records.nominal, False)
    if p >= 0.0 or math.isinf(p):
        return -1.0
    value, rate = section_value(records.nominal, frame.q, frame.v)
    is_aimed = abs(h - time_to_event(p, r, a, 0.0)[0]) < SECTION_TOL * h
    if rate <= 0.0 or not (value > SECTION_NEAR or (is_aimed and value < 0.0)):
        return -1.0
    return h + (0.5 * SECTION_NEAR - value) / rate


@compiled
def shorter_joint_step(address: PackedArguments, t: float) -> float:
    """Return the step, s, that replaces a trial step, or -1; see ``shorter_step``."""
    frame, _, records, steps, _, _ = unpack(address)
    refresh(frame, t)
    fill_forces(frame, t, END)
    h = t - records.output[0].now
    contacts = frame.model.contact_records
    to_contact = shorter_step(records, steps, contacts, h, frame.q, frame.v, frame.a)
    to_section = step_back_to_section(frame, records, h)
    if to_contact < 0.0 or 0.0 < to_section < to_contact:
        return to_section
    return to_contact


@compiled
def run_task(address: PackedArguments, task: int, t: float) -> float:
    """Call the kernel of a task; return the step, s, that ACCEPTED or SHORTER chooses, else 0.

    The kernels are compiled together, because all of them contain the written
    equations. ``address`` packs Frame, Drives, RecorderState, one record of STEPS, and
    two arrays for ``connector_forces``.
    """
    if task == FORCES:
        connector_forces(address, t)
    elif task == START:
        begin_step(address, t)
    elif task == ACCEPTED:
        return accept_joint_step(address, t)
    elif task == SHORTER:
        return shorter_joint_step(address, t)
    return 0.0
