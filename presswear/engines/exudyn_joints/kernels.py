"""Compiled part of the model with bodies and joints: connector forces, accepted steps."""

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
from presswear.physics.loads import (
    greatest_jump,
    next_break,
    settle_loads,
    work_beyond_trapezoid,
)
from presswear.physics.packed import Packed
from presswear.physics.prescribed import Prescribed, subtract_inertia
from presswear.physics.rubbing import add_friction, friction_moment, friction_power
from presswear.physics.step_length import next_step, shorter_step
from presswear.physics.touchdown import (
    LEAST_STEPS,
    joint_crossing,
    settle,
    time_to_event,
)
from presswear.recording.nominal_time import section_at_start, section_value
from presswear.recording.observe import RecorderState, observe, sum_drives
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, all_finite, compiled, copy_to, inlined
from presswear.tools.packing import PackedArguments, unpack

Indices = NDArray[np.int64]

# Change of a load on passing from one piece of its law to the next that is a jump, part
# of it.
JUMP = 1e-3
# Rows of ``Frame.states``: from STEP_START and from STEP_END a value, its rate, and the
# slope of the rate over the value
STEP_START, STEP_END = 0, 3
RATE, SLOPE = 1, 2
# A section that ends at an angle ends within this of its end, s
SECTION_NEAR = 1e-9
SECTION_PART = 1e-3  # change of a step, part of it, that puts its end on that section
FORCES, START, ACCEPTED, SHORTER = range(4)
"""Tasks of ``run_task``."""


class Friction(NamedTuple):
    """Friction in rigid joints, and where Exudyn has its joint forces and takes its moments."""

    joints: Records  # of RUBBING
    rows: Indices  # index of the first of the two multipliers of each joint
    slots: Indices  # of bearing and pin, as in ``connector_forces``
    multipliers: Array  # Exudyn's live ones


class Frame(NamedTuple):
    """Coordinates of all bodies from those that Exudyn solves for.

    If Exudyn solves for all, ``q``, ``v`` and ``a`` are its live arrays, and ``places``
    is empty.
    """

    solved_q: Array  # Exudyn's live coordinates, rates and accelerations
    solved_v: Array
    solved_a: Array
    places: Indices  # where each of them belongs in q
    prescribed: Prescribed  # bodies that are left out
    q: Array  # (3 bodies,)
    v: Array
    a: Array
    axes: Array
    forces: Written  # of contacts, springs and loads on all bodies
    # the arrays that they read and fill, with the contacts of states on trial
    model: Model
    y: Array  # state for them, and rates of its integrals
    rates: Array
    layout: Layout  # places of their parts
    scales: Array  # changes of the states of interactions that matter, (states,)
    state_joints: Indices  # whose contact changes their rates; -1 for none
    # Values, rates and slopes of the rates where a step starts and ends, (6, states)
    states: Array
    friction: Friction | None  # None without friction in rigid joints


@compiled
def refresh(frame: Frame, t: float) -> None:
    """Bring the coordinates of all bodies up to Exudyn's present state."""
    if frame.places.shape[0] == 0:
        return
    for i in range(frame.places.shape[0]):
        place = frame.places[i]
        frame.q[place] = frame.solved_q[i]
        frame.v[place] = frame.solved_v[i]
        frame.a[place] = frame.solved_a[i]
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
    """Return the value after a time ``h``, s, of z' = rate + slope (z - value)."""
    return value + rate * (math.expm1(slope * h) / slope if slope != 0.0 else h)


@compiled
def next_state(frame: Frame, records: RecorderState, i: int, t: float) -> float:
    """Return state ``i`` at the end of a step, from the rates at both ends of the step.

    The trapezoidal rule would swing where a state is stiff. A step in which the pin
    touches down or separates is divided there.
    """
    joint, contacts = frame.state_joints[i], frame.model.contact_records
    start, rate, slope, end, end_rate, end_slope = frame.states[:, i]
    h = t - records.output[0].now
    part = 2.0
    if joint >= 0:
        last = records.memory[joint]
        is_closed = last.penetration > 0.0
        part = joint_crossing(last, contacts[joint], is_closed, h)[0]
    if part < 1.0:
        value = exponential_step(start, rate, slope, part * h)
        behind = end_rate + end_slope * (value - end)
        return exponential_step(value, behind, end_slope, (1.0 - part) * h)
    mean = 0.5 * (rate + end_rate + end_slope * (start - end))
    return exponential_step(start, mean, 0.5 * (slope + end_slope), h)


@compiled
def linearise_states(frame: Frame, t: float, row: int) -> None:
    """Fill the states, their rates and the slopes of these into three rows.

    The rates are those of the forces that were filled last; the forces change.
    """
    first, states = frame.layout.first_state, frame.states
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
def place_forces(frame: Frame, records: RecorderState, t: float, level: int) -> None:
    """Fill forces at the end of a step of the trapezoidal rule, with states of interactions."""
    count = frame.scales.shape[0]
    if count > 0:
        fill_forces(frame, t, END)
        linearise_states(frame, t, STEP_END)
        for i in range(count):
            frame.y[frame.layout.first_state + i] = next_state(frame, records, i, t)
    fill_forces(frame, t, level)


@compiled
def start_states(frame: Frame, t: float) -> None:
    """Begin a step with the states whose forces were filled last, at level END."""
    if frame.scales.shape[0] > 0:
        linearise_states(frame, t, STEP_START)
        fill_forces(frame, t, END)


@compiled
def note_friction(friction: Friction | None, v: Array) -> float:
    """Fill the friction moments of rigid joints under the present joint forces.

    Returns the power that they turn into heat, W. In Newton's method the joint forces
    are those of the present iterate, so that moments and joint forces converge
    together.
    """
    if friction is None:
        return 0.0
    for k in range(friction.joints.shape[0]):
        row = friction.rows[k]
        x, y = friction.multipliers[row], friction.multipliers[row + 1]
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

    The last two parts of ``address`` are where each of the connector's coordinates
    belongs in q, and the forces.
    """
    frame, _, records, _, places, out = unpack(address)
    refresh(frame, t)
    place_forces(frame, records, t, ACCELERATIONS)
    for i in range(out.shape[0]):
        out[i] = frame.model.bodies[FORCE, places[i]]
    note_friction(frame.friction, frame.v)
    add_moments(frame.friction, out)


class Drives(NamedTuple):
    """Sources of the torques of the drives."""

    has_motor: NDArray[np.bool_]  # whose torque is among the forces on all bodies
    # index of each drive's multiplier; -1 for that of a body that is left out
    multiplier: Indices
    multipliers: Array  # Exudyn's live ones; the torque of a drive is minus its own
    force: Array  # working space, (3 bodies,)
    # Constraints, where a drive of Exudyn's turns unevenly or a load bends over
    # position: see ``hold``
    constraints: ConstraintSystem | None


@compiled
def all_forces(frame: Frame, packed: Packed, force: Array) -> None:
    """Fill the forces on all bodies with weights and constant loads."""
    for i in range(force.shape[0]):
        force[i] = packed.weight[i] + frame.model.bodies[FORCE, i]


@compiled
def place_start(address: PackedArguments, t: float) -> None:
    """Fill contacts and forces in the present state."""
    frame, _, records, _, _, _ = unpack(address)
    refresh(frame, t)
    first, energies = frame.layout.first_state, frame.layout.first_energy
    copy_to(frame.y[first:energies], frame.states[STEP_START])
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
    """Fill the joint forces in the initial state, from which Exudyn finds its accelerations."""
    force = drives.force
    all_forces(frame, packed, force)
    evaluate_constraints(constraints, 0.0, frame.q, frame.v)
    factor(constraints)
    multipliers_of(constraints, 0.0, 0.0, force)
    add_friction(constraints, friction.joints, 0.0, 0.0, frame.v, force)
    for k in range(friction.joints.shape[0]):
        row = friction.joints[k].row
        for c in range(2):
            place = friction.rows[k] + c
            friction.multipliers[place] = constraints.multipliers[row + c]


@compiled
def hold(
    frame: Frame, drives: Drives, constraints: ConstraintSystem | None, t: float
) -> None:
    """Move an accepted state onto joints and drives: to round-off in all levels.

    The trapezoidal rule holds them in velocities alone.  Of an uneven speed it makes an
    angle with an error of third order in each step, and an acceleration that swings
    about the right one for ever, as it does behind a very short step.
    """
    if constraints is None:
        return
    project(constraints, t, frame.q, frame.v)
    project_acceleration(constraints, t, frame.q, frame.v, frame.a)
    for row in range(constraints.records.shape[0]):
        drive = constraints.records[row].drive
        if drive >= 0 and drives.multiplier[drive] >= 0:
            drives.multipliers[drives.multiplier[drive]] += constraints.multipliers[row]
    for i in range(frame.places.shape[0]):
        place = frame.places[i]
        frame.solved_q[i] = frame.q[place]
        frame.solved_v[i] = frame.v[place]
        frame.solved_a[i] = frame.a[place]


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
            place = frame.layout.first_torque + TORQUE_INTEGRALS * i
            records.torque[i] = frame.rates[place + TORQUE]
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
    """Fill the wear integrals of a step, and add to the ledger of energy, by the trapezoidal rule.

    ``power`` is that of the drives. A step that began open has force only since its
    touchdown. The wear of a step that ends open, which has no place any more, is left
    out.
    """
    layout = frame.layout
    energies, powers = records.energies, records.powers
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
    """Settle contact, account for an accepted step and choose the next; NaN if it is broken."""
    frame, drives, records, steps, _, _ = unpack(address)
    h = t - records.output[0].now
    refresh(frame, t)
    hold(frame, drives, drives.constraints, t)
    if not all_finite(frame.q, frame.v):
        return math.nan
    place_forces(frame, records, t, END)
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
            # The rule begins from accelerations that no longer hold.
            following = steps[0].least
    left = next_break(packed.loads) - t
    following = step_to_break(records.motions, t, min(following, left))
    following = step_to_section(records, following)
    return max(following, 0.1 * steps[0].least)


@compiled
def step_to_section(records: RecorderState, h: float) -> float:
    """Return the step, s, no longer than ``h``, to the end of a section that ends at an angle."""
    p, r, a, _ = section_at_start(records.nominal, False)
    if p >= 0.0 or math.isinf(p):
        return h
    arrival, speed, _ = time_to_event(p, r, a, 0.0)
    if speed <= 0.0:
        return h
    # One that would end shortly before it is halved, so that no tiny one follows.
    if arrival <= h:
        return arrival
    return 0.5 * arrival if arrival < 2.0 * h else h


@compiled
def step_back_to_section(frame: Frame, records: RecorderState, h: float) -> float:
    """Return the step, s, with which a trial step that misses the end of a section is repeated.

    -1 if it does not, or is not the one that was to end there.
    """
    p, r, a, _ = section_at_start(records.nominal, False)
    if p >= 0.0 or math.isinf(p):
        return -1.0
    value, rate = section_value(records.nominal, frame.q, frame.v)
    is_aimed = abs(h - time_to_event(p, r, a, 0.0)[0]) < SECTION_PART * h
    if rate <= 0.0 or not (value > SECTION_NEAR or (is_aimed and value < 0.0)):
        return -1.0
    return h + (0.5 * SECTION_NEAR - value) / rate


@compiled
def shorter_joint_step(address: PackedArguments, t: float) -> float:
    """Return the step with which a trial step has to be repeated; see ``shorter_step``."""
    frame, _, records, steps, _, _ = unpack(address)
    refresh(frame, t)
    fill_forces(frame, t, END)
    h = t - records.output[0].now
    contacts = frame.model.contact_records
    wanted = shorter_step(records, steps, contacts, h, frame.q, frame.v, frame.a)
    back = step_back_to_section(frame, records, h)
    return back if wanted < 0.0 or 0.0 < back < wanted else wanted


@compiled
def run_task(address: PackedArguments, task: int, t: float) -> float:
    """Call one of the kernels above; returns a step, s, for those that choose one.

    They are compiled together, because they share what places the bodies. ``address``
    packs Frame, Drives, RecorderState, one record of STEPS, and two arrays for
    ``connector_forces``.
    """
    if task == FORCES:
        connector_forces(address, t)
    elif task == START:
        place_start(address, t)
    elif task == ACCEPTED:
        return accept_joint_step(address, t)
    elif task == SHORTER:
        return shorter_joint_step(address, t)
    return 0.0
