"""Compiled part of the model with bodies and joints: connector forces, accepted steps."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.closed_loops import drive_torques, place_prescribed
from presswear.physics.constraints import (
    Held,
    evaluate_constraints,
    factor,
    multipliers_of,
    project,
    project_acceleration,
)
from presswear.physics.contact import note_contacts
from presswear.physics.drive_motion import drive_motion, step_to_break
from presswear.physics.forces import add_contacts, load_of, loss_powers
from presswear.physics.loads import (
    count_transitions,
    greatest_jump,
    load_forces,
    next_break,
    settle_loads,
    work_beyond_trapezoid,
)
from presswear.physics.packed import applied_forces
from presswear.physics.prescribed import Prescribed, subtract_inertia
from presswear.physics.rubbing import add_friction, friction_moment, friction_power
from presswear.physics.step_length import next_step, shorter_step
from presswear.physics.touchdown import LEAST_STEPS, advance_bristles, settle
from presswear.physics.wear import wear_rates
from presswear.recording.observe import RecorderState, observe, sum_drives
from presswear.tools.arrays import Array
from presswear.tools.compile import PackedArguments, Records, all_finite, compiled, unpack

Indices = NDArray[np.int64]

# Change of a load on passing from one piece of its law to the next that is a jump, part of it.
JUMP = 1e-3


class Friction(NamedTuple):
    """Friction in rigid joints, and where Exudyn has its joint forces and takes its moments."""

    joints: Records  # of RUBBING
    rows: Indices  # index of the first of the two multipliers of each joint
    slots: Indices  # of bearing and pin, as in ``connector_forces``
    multipliers: Array  # Exudyn's live ones


class Frame(NamedTuple):
    """Coordinates of all bodies from those that Exudyn solves for.

    If Exudyn solves for all, ``q``, ``v`` and ``a`` are its live arrays, and ``places`` is empty.
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
    contacts: Records  # working space of states on trial
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


@compiled
def note_friction(friction: Friction | None, v: Array) -> float:
    """Fill the friction moments of rigid joints under the present joint forces.

    Returns the power that they turn into heat, W. In Newton's method the joint forces are those of
    the present iterate, so that moments and joint forces converge together.
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
    """Fill the generalized forces of clearance joints, rigid joints with friction, and loads.

    ``address`` packs Frame; RecorderState; where the forces on bearing and pin belong among those
    of the connector, shape (joints, 2), -1 for a body that Exudyn does not solve for; where each
    of the connector's coordinates belongs in q; working space, shape (3 bodies,); the forces.
    """
    frame, records, slots, places, force, out = unpack(address)
    packed = records.packed
    refresh(frame, t)
    for i in range(out.shape[0]):
        out[i] = 0.0
    note_contacts(packed, frame.contacts, frame.q, frame.v)
    advance_bristles(packed.joints, records.memory, frame.contacts, t)
    for k in range(slots.shape[0]):
        load = load_of(packed.joints[k], records.onset[k], frame.contacts[k])
        if load.normal == 0.0:
            continue
        i = slots[k, 0]
        if i >= 0:
            out[i] -= load.x
            out[i + 1] -= load.y
            out[i + 2] += load.bearing_moment
        i = slots[k, 1]
        if i >= 0:
            out[i] += load.x
            out[i + 1] += load.y
            out[i + 2] += load.pin_moment
    note_friction(frame.friction, frame.v)
    add_moments(frame.friction, out)
    if count_transitions(packed.loads) > 0:
        for i in range(force.shape[0]):
            force[i] = 0.0
        load_forces(packed.loads, t, frame.q, frame.v, force)
        for i in range(out.shape[0]):
            out[i] += force[places[i]]


class Drives(NamedTuple):
    """Sources of the torques of the drives."""

    multiplier: Indices  # index of each drive's multiplier; -1 for that of a body that is left out
    multipliers: Array  # Exudyn's live ones; the torque of a drive is minus its own
    force: Array  # working space, (3 bodies,)
    rates: Array  # working space, (JOINT_RATES joints,)
    # Constraints, where a drive of Exudyn's turns unevenly or a load bends over position: see
    # ``hold``
    held: Held | None


@compiled
def begin_friction(
    friction: Friction, held: Held, records: RecorderState, drives: Drives, q: Array, v: Array
) -> None:
    """Fill the joint forces in the initial state, from which Exudyn finds its accelerations."""
    force, rates = drives.force, drives.rates
    applied_forces(records.packed, 0.0, q, v, force)
    add_contacts(records.packed.joints, records.onset, records.contacts, force, rates)
    evaluate_constraints(held, 0.0, q, v)
    factor(held)
    multipliers_of(held, 0.0, 0.0, force)
    add_friction(held, friction.joints, 0.0, 0.0, v, force)
    for k in range(friction.joints.shape[0]):
        row = friction.joints[k].row
        for c in range(2):
            friction.multipliers[friction.rows[k] + c] = held.multipliers[row + c]


@compiled
def hold(frame: Frame, drives: Drives, held: Held | None, t: float) -> None:
    """Move an accepted state onto joints and drives: to round-off in all levels.

    The trapezoidal rule holds them in velocities alone.  Of an uneven speed it makes an angle with
    an error of third order in each step, and an acceleration that swings about the right one for
    ever, as it does behind a very short step.
    """
    if held is None:
        return
    project(held, t, frame.q, frame.v)
    project_acceleration(held, t, frame.q, frame.v, frame.a)
    for row in range(held.constraints.shape[0]):
        drive = held.constraints[row].drive
        if drive >= 0 and drives.multiplier[drive] >= 0:
            drives.multipliers[drives.multiplier[drive]] += held.multipliers[row]
    for i in range(frame.places.shape[0]):
        place = frame.places[i]
        frame.solved_q[i] = frame.q[place]
        frame.solved_v[i] = frame.v[place]
        frame.solved_a[i] = frame.a[place]


@compiled
def powers(frame: Frame, drives: Drives, records: RecorderState, t: float) -> tuple[float, float]:
    """Fill the torques of the drives; return the power of drives, and of loads and dampers, W."""
    prescribed = frame.prescribed
    load_power = applied_forces(records.packed, t, frame.q, frame.v, drives.force)
    if prescribed.parts.shape[0] > 0:
        add_contacts(
            records.packed.joints, records.onset, records.contacts, drives.force, drives.rates
        )
        subtract_inertia(prescribed.parts, frame.a, drives.force)
        drive_torques(prescribed, frame.q, frame.axes, drives.force, records.torque)
    power = 0.0
    for i in range(records.motions.shape[0]):
        if drives.multiplier[i] >= 0:
            records.torque[i] = -drives.multipliers[drives.multiplier[i]]
        power += records.torque[i] * drive_motion(records.motions[i], t)[1]
    return power, load_power


@compiled
def sum_step(
    records: RecorderState,
    drive_power: float,
    load_power: float,
    rubbed_power: float,
    t: float,
    h: float,
) -> None:
    """Fill the wear integrals of a step, and add to the ledger of energy, by the trapezoidal rule.

    A step that began open has force only since its touchdown. The wear of a step that ends open,
    which has no place any more, is left out.
    """
    ledger = records.ledger[0]
    contact_power, heat, made_power = 0.0, rubbed_power, 0.0
    for k in range(records.memory.shape[0]):
        contact, integrals = records.contacts[k], records.wear_integrals[k]
        work, pressure = wear_rates(records.packed.joints[k], contact, contact.normal)
        duration = min(h, t - records.memory[k].touchdown_time)
        half = 0.5 * duration if contact.penetration > 0.0 else 0.0
        integrals.work = half * (integrals.work_rate + work)
        integrals.pressure = half * (integrals.pressure_rate + pressure)
        integrals.work_rate, integrals.pressure_rate = work, pressure
        lost, rubbed, made = loss_powers(contact, contact.normal, contact.tangential)
        contact_power += lost
        heat += rubbed
        made_power += made
    half = 0.5 * h
    ledger.drive_exchange += half * (abs(ledger.drive_power) + abs(drive_power))
    ledger.drive_work += half * (ledger.drive_power + drive_power)
    ledger.load_work += half * (ledger.load_power + load_power)
    ledger.contact_loss += half * (ledger.contact_power + contact_power)
    ledger.friction_loss += half * (ledger.friction_power + heat)
    ledger.made += half * (ledger.made_power + made_power)
    ledger.drive_power, ledger.load_power = drive_power, load_power
    ledger.contact_power, ledger.friction_power = contact_power, heat
    ledger.made_power = made_power


@compiled
def accept_joint_step(address: PackedArguments, t: float) -> float:
    """Settle contact, account for an accepted step and choose the next; NaN if it is broken.

    ``address`` packs Frame, Drives, RecorderState and one record of STEPS.
    """
    frame, drives, records, steps = unpack(address)
    h = t - records.output[0].now
    refresh(frame, t)
    hold(frame, drives, drives.held, t)
    note_contacts(records.packed, records.contacts, frame.q, frame.v)
    advance_bristles(records.packed.joints, records.memory, records.contacts, t)
    power, load_power = powers(frame, drives, records, t)
    if not all_finite(frame.q, frame.v):
        return math.nan
    settle(records, t, LEAST_STEPS)
    sum_step(records, power, load_power, note_friction(frame.friction, frame.v), t, h)
    sum_drives(records, h, frame.v)
    packed = records.packed
    records.ledger[0].load_work += work_beyond_trapezoid(packed.loads, t, frame.q, frame.v)
    changes = settle_loads(packed.loads, t, frame.q, frame.v, frame.a)
    observe(records, t, h, frame.q, frame.v, frame.a)
    following = next_step(records, steps, frame.a)
    if changes > 0:
        records.ledger[0].load_power = applied_forces(packed, t, frame.q, frame.v, drives.force)
        if greatest_jump(packed.loads) > JUMP:
            # The rule begins from accelerations that no longer hold.
            following = steps[0].least
    left = next_break(packed.loads) - t
    following = step_to_break(records.motions, t, min(following, left))
    return max(following, 0.1 * steps[0].least)


@compiled
def shorter_joint_step(address: PackedArguments, t: float) -> float:
    """Return the step with which a trial step has to be repeated; see ``shorter_step``.

    ``address`` packs Frame, RecorderState and one record of STEPS.
    """
    frame, records, steps = unpack(address)
    refresh(frame, t)
    h = t - records.output[0].now
    return shorter_step(records, steps, frame.contacts, h, frame.q, frame.v, frame.a)
