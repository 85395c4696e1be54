"""Accepted states: changes of contact, integrals, and the account of the step."""

from presswear.engines.dae.runge_kutta import SPARE, START, rates
from presswear.physics.constraints import ConstraintSystem, project
from presswear.physics.contact import copy_contacts
from presswear.physics.equations.layout import (
    POWER,
    POWER_SQUARE,
    PRESSURE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    WEAR_INTEGRAL_COUNT,
    WORK,
)
from presswear.physics.step_length import contact_step
from presswear.physics.touchdown import (
    HELD_OPEN,
    LEAST_STEPS,
    remember,
    separate,
    settle,
    touch_down,
)
from presswear.recording.observe import observe
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled
from presswear.tools.packing import PackedArguments, unpack

FIRST_PARTS = 40.0  # expected duration of a contact over the first step after touchdown


@compiled
def start_march(address: PackedArguments) -> None:
    """Record the initial state once."""
    (run,) = unpack(address)
    system = run.system
    records = run.records
    motion = run.motion
    state = run.control[0]
    # The deepest place is searched from the last one, in a resumed run as well.
    copy_contacts(system.contacts, records.contacts)
    if not state.has_slope:
        rates(address, state.time, motion.y, START)
        state.has_slope = True
    if not state.has_started:
        for k in range(records.torque.shape[0]):
            base = system.layout.first_torque + TORQUE_INTEGRALS * k
            records.torque[k] = motion.slopes[0, base + TORQUE]
        copy_contacts(records.contacts, system.contacts)
        settle(records, 0.0, LEAST_STEPS)
        observe(run.observer, 0.0, 0.0)
        state.has_started = True


@compiled
def place_state(address: PackedArguments, t: float) -> None:
    """Fill the motion of all bodies, and the contacts, in the present state."""
    (run,) = unpack(address)
    rates(address, t, run.motion.y, SPARE)
    copy_contacts(run.records.contacts, run.system.contacts)


@compiled
def settle_joints(address: PackedArguments, event: int, t: float) -> int:
    """Begin and end the contacts whose events come with the end of a step; return their number.

    Those are joint ``event`` and each joint nearer to its event than the resolution of
    its coordinates, m, on its way there: handled one after the other, they would need
    steps in which no coordinate changes.
    """
    (run,) = unpack(address)
    system = run.system
    records = run.records
    state = run.control[0]
    events = 0
    for k in range(system.contacts.shape[0]):
        contact = system.contacts[k]
        is_closed = records.onset[k] > 0.0
        rate = contact.rate
        if system.packed.joints[k].always_closed:
            continue
        if k != event:
            is_near = abs(contact.penetration) <= state.resolution
            moves_on = rate < 0.0 if is_closed else rate > 0.0
            if not (is_near and moves_on):
                continue
        if is_closed:
            separate(records, k, t, rate, 0)
            records.onset[k] = HELD_OPEN
        else:
            touch_down(records, k, t, rate, False)
        first_step = contact_step(system.packed.joints[k], 0.0, rate, FIRST_PARTS)
        state.step = min(state.step, first_step)
        events += 1
    return events


@compiled
def hold_open(onset: Array) -> None:
    """Mark open joints, so that no force acts before a located touchdown."""
    for k in range(onset.shape[0]):
        if onset[k] == 0.0:
            onset[k] = HELD_OPEN


@compiled
def keep_constraints(
    constraints: ConstraintSystem | None, is_projected: bool, t: float, y: Array
) -> None:
    """Move a state onto the constraints where that is requested."""
    if constraints is not None and is_projected:
        n = constraints.inverse_mass.shape[0]
        project(constraints, t, y[:n], y[n : 2 * n])


@compiled
def finish_step(
    address: PackedArguments, constraints: ConstraintSystem | None, t: float, h: float
) -> None:
    """Account for an accepted state in ``motion.y``, in which slopes were evaluated last."""
    (run,) = unpack(address)
    system = run.system
    state = run.control[0]
    copy_contacts(run.records.contacts, system.contacts)
    take_wear_integrals(address, t)
    empty_drives(address)
    observe(run.observer, t, h)
    state.time = t
    state.steps += 1
    if constraints is not None:
        for row in range(constraints.phi.shape[0]):
            position_error = abs(constraints.phi[row])
            velocity_error = abs(constraints.phi_t[row])
            state.position_error = max(state.position_error, position_error)
            state.velocity_error = max(state.velocity_error, velocity_error)


@compiled
def take_wear_integrals(address: PackedArguments, t: float) -> None:
    """Move the integrals of wear from the state vector into the account of each joint.

    They begin at zero in each step, so that they never lose digits.
    """
    (run,) = unpack(address)
    records = run.records
    y = run.motion.y
    for k in range(run.system.contacts.shape[0]):
        base = run.system.layout.first_wear_integral + WEAR_INTEGRAL_COUNT * k
        records.wear_integrals[k].work = y[base + WORK]
        records.wear_integrals[k].pressure = y[base + PRESSURE]
        y[base + WORK] = 0.0
        y[base + PRESSURE] = 0.0
        joint = records.packed.joints[k]
        contact = records.contacts[k]
        remember(records.memory[k], joint, records.onset[k], contact, t)


@compiled
def empty_drives(address: PackedArguments) -> None:
    """Move the integrals of torque and power from the state vector into each drive."""
    (run,) = unpack(address)
    records = run.records
    y = run.motion.y
    for k in range(records.drives.shape[0]):
        base = run.system.layout.first_torque + TORQUE_INTEGRALS * k
        drive = records.drives[k]
        drive.torque_integral = y[base + TORQUE]
        drive.torque_square_integral = y[base + TORQUE_SQUARE]
        drive.work = y[base + POWER]
        drive.power_square_integral = y[base + POWER_SQUARE]
        y[base : base + TORQUE_INTEGRALS] = 0.0
        records.torque[k] = run.motion.slopes[0, base + TORQUE]
