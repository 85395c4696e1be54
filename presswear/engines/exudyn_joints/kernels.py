"""Kernels of the model with bodies and joints: connector forces and accepted steps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.engines.exudyn_joints.body_state import (
    BodyState,
    Friction,
    Indices,
    fill_forces,
    refresh,
)
from presswear.engines.exudyn_joints.interaction_states import (
    STEP_START,
    fill_end_forces,
    start_states,
)
from presswear.physics.closed_loops import drive_torques
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
from presswear.physics.equations.function import ACCELERATIONS, END, FORCE, RATES
from presswear.physics.equations.layout import (
    DRIVE_EXCHANGE,
    DRIVE_WORK,
    FRICTION_LOSS,
    LOAD_WORK,
    PRESSURE,
    TORQUE,
    TORQUE_INTEGRALS,
    WEAR_INTEGRAL_COUNT,
    WORK,
)
from presswear.physics.event_time import time_to_event
from presswear.physics.load_transitions import greatest_jump, next_break, settle_loads
from presswear.physics.loads import work_beyond_trapezoid
from presswear.physics.packed import Packed, drive_rate
from presswear.physics.prescribed import subtract_inertia
from presswear.physics.rubbing import add_friction, friction_moment, friction_power
from presswear.physics.step_length import next_step, shorter_step
from presswear.physics.touchdown import LEAST_STEPS, settle
from presswear.recording.nominal_time import section_at_start, section_value
from presswear.recording.observe import observe, sum_drives
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import all_finite, compiled, copy_to
from presswear.tools.packing import PackedArguments, unpack

# Smallest relative change of a load at a transition of its law that counts as a jump
MIN_JUMP = 1e-3
# Largest time between the end of a step and the angle at which a section ends, s
SECTION_TIME_TOL = 1e-9
# Largest relative difference between a step and the step that was chosen to end there
SECTION_STEP_TOL = 1e-3
# A step may be shorter than the least step, down to this part, to end at an event.
MIN_STEP_PART = 0.1
FORCES, START, ACCEPTED, SHORTER = range(4)  # tasks of ``run_task``


@compiled
def note_friction(friction: Friction, v: Array) -> float:
    """Fill the friction moments of rigid joints under the present joint forces.

    Returns the friction power, W. During Newton's iteration of Exudyn the joint forces
    are those of the present iterate, so that moments and joint forces converge
    together.
    """
    for k in range(friction.joints.shape[0]):
        row = friction.rows[k]
        x = friction.multipliers[row]
        y = friction.multipliers[row + 1]
        joint = friction.joints[k]
        joint.moment = friction_moment(joint, v, math.sqrt(x * x + y * y))
    return friction_power(friction.joints, v)


@compiled
def add_moments(friction: Friction, out: Array) -> None:
    """Add the friction moments of rigid joints to the forces of the connector."""
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
    body_state, _, records, _, indices, out = unpack(address)
    refresh(body_state, t)
    fill_end_forces(body_state, records, t, ACCELERATIONS)
    for i in range(out.shape[0]):
        out[i] = body_state.model.bodies[FORCE, indices[i]]
    note_friction(body_state.friction, body_state.v)
    add_moments(body_state.friction, out)


class Drives(NamedTuple):
    """Sources of the torques of the drives."""

    # drives with a motor, whose torque is among the forces on all bodies
    has_motor: NDArray[np.bool_]
    # index of each drive's multiplier; -1 for a drive that is not in Exudyn's model
    multiplier: Indices
    # live multipliers of Exudyn; the torque of a drive is minus its multiplier
    multipliers: Array
    force: Array  # working space, (3 bodies,)
    constraints: ConstraintSystem
    # True if a drive turns at an uneven speed or the law of a load has a corner over
    # position; see ``project_state``
    projects_states: bool


@compiled
def all_forces(body_state: BodyState, packed: Packed, force: Array) -> None:
    """Fill the sum of all forces on the bodies: weights, constant loads and written forces."""
    for i in range(force.shape[0]):
        force[i] = packed.weight[i] + body_state.model.bodies[FORCE, i]


@compiled
def begin_step(address: PackedArguments, t: float) -> None:
    """Fill contacts and forces of the present state, from which a step starts."""
    body_state, _, records, _, _, _ = unpack(address)
    refresh(body_state, t)
    first_state = body_state.layout.first_state
    first_energy = body_state.layout.first_energy
    copy_to(body_state.y[first_state:first_energy], body_state.states[STEP_START])
    # The deepest place is searched from the last one, in a resumed run as well.
    copy_contacts(body_state.model.contact_records, records.contacts)
    fill_forces(body_state, t, END)
    start_states(body_state, t)
    copy_contacts(records.contacts, body_state.model.contact_records)


@compiled
def begin_friction(
    body_state: BodyState, packed: Packed, drives: Drives, friction: Friction
) -> None:
    """Fill the joint forces of the initial state: Exudyn needs them for its accelerations."""
    constraints = drives.constraints
    force = drives.force
    all_forces(body_state, packed, force)
    evaluate_constraints(constraints, 0.0, body_state.q, body_state.v)
    factor(constraints)
    multipliers_of(constraints, 0.0, 0.0, force)
    add_friction(constraints, friction.joints, 0.0, 0.0, body_state.v, force)
    for k in range(friction.joints.shape[0]):
        row = friction.joints[k].row
        for axis in range(2):
            index = friction.rows[k] + axis
            friction.multipliers[index] = constraints.multipliers[row + axis]


@compiled
def project_state(body_state: BodyState, drives: Drives, t: float) -> None:
    """Project an accepted state on the constraints of position, velocity and acceleration.

    The trapezoidal rule satisfies joints and drives in velocities only. With an uneven
    speed of a drive, the angle has an error of third order in each step, and the
    acceleration oscillates about the exact one without end. It also oscillates after a
    very short step.
    """
    if not drives.projects_states:
        return
    constraints = drives.constraints
    project(constraints, t, body_state.q, body_state.v)
    project_acceleration(constraints, t, body_state.q, body_state.v, body_state.a)
    for row in range(constraints.records.shape[0]):
        drive = constraints.records[row].drive
        if drive >= 0 and drives.multiplier[drive] >= 0:
            change = constraints.multipliers[row]
            if constraints.records[row].geared:
                change = -change  # see ``pass_on_torques``
            drives.multipliers[drives.multiplier[drive]] += change
    for i in range(body_state.solved_indices.shape[0]):
        index = body_state.solved_indices[i]
        body_state.solved_q[i] = body_state.q[index]
        body_state.solved_v[i] = body_state.v[index]
        body_state.solved_a[i] = body_state.a[index]


@compiled
def drive_power(
    body_state: BodyState, drives: Drives, records: RecorderState, t: float
) -> float:
    """Fill the torques of the drives; return the power of all drives, W."""
    prescribed = body_state.prescribed
    if prescribed.parts.shape[0] > 0:
        all_forces(body_state, records.packed, drives.force)
        subtract_inertia(prescribed.parts, body_state.a, drives.force)
        drive_torques(
            prescribed, body_state.q, body_state.axes, drives.force, records.torque
        )
    power = 0.0
    for i in range(records.motions.shape[0]):
        if drives.has_motor[i]:
            first = body_state.layout.first_torque + TORQUE_INTEGRALS * i
            records.torque[i] = body_state.rates[first + TORQUE]
            power += records.torque[i] * drive_rate(
                records.packed.driven, records.motions, i, t, body_state.v
            )
            continue
        if drives.multiplier[i] >= 0:
            records.torque[i] = -drives.multipliers[drives.multiplier[i]]
        power += records.torque[i] * drive_motion(records.motions[i], t)[1]
    return power


@compiled
def pass_on_torques(
    drives: Drives, records: RecorderState, power: float, t: float
) -> float:
    """Correct the torques of gears and their leaders; return the power of all drives, W.

    Exudyn has the body of gears first in their constraint. Torques of bodies that are not
    in its model are those of drives of their own. Power of gears is that of the leader.
    """
    driven = records.packed.driven
    for i in range(driven.shape[0]):
        if not driven[i].is_geared:
            continue
        rate = drive_motion(records.motions[i], t)[1]
        if drives.multiplier[i] >= 0:
            power -= records.torque[i] * rate
            records.torque[i] = -records.torque[i]
        else:
            records.torque[driven[i].leader] += driven[i].ratio * records.torque[i]
    return power


@compiled
def sum_step(
    body_state: BodyState, records: RecorderState, power: float, t: float, h: float
) -> None:
    """Integrate wear and energies over a step by the trapezoidal rule.

    ``power`` is that of all drives, W. If the joint was open at the start of the step,
    wear is integrated from its touchdown. If it is open at the end, the wear of the
    step is neglected, because the place of the contact is not defined.
    """
    layout = body_state.layout
    energies = records.energies
    powers = records.powers
    for i in range(energies.shape[0]):
        energies[i] += 0.5 * h * powers[i]
    copy_to(powers, body_state.rates[layout.first_energy : layout.first_wear_integral])
    powers[DRIVE_WORK] = power
    powers[DRIVE_EXCHANGE] = abs(power)
    powers[FRICTION_LOSS] += note_friction(body_state.friction, body_state.v)
    for i in range(energies.shape[0]):
        energies[i] += 0.5 * h * powers[i]
    for k in range(records.memory.shape[0]):
        rates = body_state.rates[layout.first_wear_integral + WEAR_INTEGRAL_COUNT * k :]
        integrals = records.wear_integrals[k]
        duration = min(h, t - records.memory[k].touchdown_time)
        half = 0.5 * duration if records.contacts[k].penetration > 0.0 else 0.0
        integrals.work = half * (integrals.work_rate + rates[WORK])
        integrals.pressure = half * (integrals.pressure_rate + rates[PRESSURE])
        integrals.work_rate = rates[WORK]
        integrals.pressure_rate = rates[PRESSURE]


@compiled
def accept_joint_step(address: PackedArguments, t: float) -> float:
    """Record an accepted step and return the next step, s; NaN if the state is not finite."""
    body_state, drives, records, steps, _, _ = unpack(address)
    h = t - records.output[0].now
    refresh(body_state, t)
    project_state(body_state, drives, t)
    if not all_finite(body_state.q, body_state.v):
        return math.nan
    fill_end_forces(body_state, records, t, END)
    copy_contacts(records.contacts, body_state.model.contact_records)
    start_states(body_state, t)
    if settle(records, t, LEAST_STEPS) > 0:
        fill_forces(body_state, t, END)
        copy_contacts(records.contacts, body_state.model.contact_records)
    power = drive_power(body_state, drives, records, t)
    power = pass_on_torques(drives, records, power, t)
    sum_step(body_state, records, power, t, h)
    sum_drives(records, t, h, body_state.v)
    packed = records.packed
    records.energies[LOAD_WORK] += work_beyond_trapezoid(
        packed.loads, t, body_state.q, body_state.v
    )
    changes = settle_loads(packed.loads, t, body_state.q, body_state.v, body_state.a)
    observe(body_state.observer, t, h)
    following = next_step(records, steps, body_state.a)
    if changes > 0:
        fill_forces(body_state, t, RATES)
        records.powers[LOAD_WORK] = body_state.rates[
            body_state.layout.first_energy + LOAD_WORK
        ]
        if greatest_jump(packed.loads) > MIN_JUMP:
            # The accelerations at the start of the next step are those before the jump.
            following = steps[0].least
    to_break = next_break(packed.loads) - t
    following = step_to_break(records.motions, t, min(following, to_break))
    following = step_to_section(records, following)
    return max(following, MIN_STEP_PART * steps[0].least)


@compiled
def step_to_section(records: RecorderState, h: float) -> float:
    """Return the step, s, of at most ``h``, that does not pass the angle where a section ends."""
    value, rate, acceleration, _ = section_at_start(records.nominal, False)
    if value >= 0.0 or math.isinf(value):
        return h
    arrival, arrival_rate, _ = time_to_event(value, rate, acceleration, 0.0)
    if arrival_rate <= 0.0:
        return h
    if arrival <= h:
        return arrival
    # A step that would end shortly before the angle is shortened, so that the next step
    # is not very short.
    return 0.5 * arrival if arrival < 2.0 * h else h


@compiled
def step_back_to_section(
    body_state: BodyState, records: RecorderState, h: float
) -> float:
    """Return the step, s, that replaces a trial step which misses the end of a section.

    -1 if the trial step need not be repeated: it ends before or at the angle of the
    section, and was not chosen to end beyond it. ``value`` is negative before the angle.
    """
    value, rate, acceleration, _ = section_at_start(records.nominal, False)
    if value >= 0.0 or math.isinf(value):
        return -1.0
    arrival, _, _ = time_to_event(value, rate, acceleration, 0.0)
    is_aimed = abs(h - arrival) < SECTION_STEP_TOL * h
    value, rate = section_value(records.nominal, body_state.q, body_state.v)
    is_missed = value > SECTION_TIME_TOL or (is_aimed and value < 0.0)
    if rate <= 0.0 or not is_missed:
        return -1.0
    return h + (0.5 * SECTION_TIME_TOL - value) / rate


@compiled
def shorter_joint_step(address: PackedArguments, t: float) -> float:
    """Return the step, s, that replaces a trial step, or -1; see ``shorter_step``."""
    body_state, _, records, steps, _, _ = unpack(address)
    refresh(body_state, t)
    fill_forces(body_state, t, END)
    h = t - records.output[0].now
    contacts = body_state.model.contact_records
    to_contact = shorter_step(
        records, steps, contacts, h, body_state.q, body_state.v, body_state.a
    )
    to_section = step_back_to_section(body_state, records, h)
    if to_contact < 0.0 or 0.0 < to_section < to_contact:
        return to_section
    return to_contact


@compiled
def run_task(address: PackedArguments, task: int, t: float) -> float:
    """Call the kernel of a task; return the step, s, that ACCEPTED or SHORTER chooses, else 0.

    The kernels are compiled together, because all of them contain the written
    equations. ``address`` packs BodyState, Drives, RecorderState, one record of STEPS, and
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
