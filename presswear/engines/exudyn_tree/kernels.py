"""Compiled part of the open tree: forces of a stage, and one call per accepted step.

Exudyn's DOPRI5 evaluates seven stages a step, the last in the state that the step ends in.  Each
leaves its powers in a row, so that work, losses and wear integrals are integrated with the weights
of the method and at its order.  Steps end where a law of force changes: at predicted touchdowns,
separations and changes of the laws of loads.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.engines.dormand_prince import DOPRI5
from presswear.physics.contact import note_contacts, penetration_acceleration
from presswear.physics.drive_motion import step_to_break
from presswear.physics.forces import (
    CONTACT_LOSS,
    FRICTION_LOSS,
    JOINT_RATES,
    MADE,
    PRESSURE,
    WORK,
    add_contacts,
)
from presswear.physics.friction_and_normal import bristle_rate
from presswear.physics.loads import count_transitions, next_break, settle_loads, transition_at_start
from presswear.physics.packed import Packed, applied_forces
from presswear.physics.prescribed import Prescribed, drive_torques, forced_power, place_prescribed
from presswear.physics.step_length import contact_step, longest_step
from presswear.physics.touchdown import settle, step_to_event, time_across, time_to_event
from presswear.physics.tree import accelerate_links, carry_branches, gather_forces, place_links
from presswear.recording.observe import RecorderState, observe
from presswear.tools.arrays import Array
from presswear.tools.compile import PackedArguments, Records, all_finite, compiled, copy_to, unpack

WEIGHTS = np.append(DOPRI5.b, 0.0)  # weights of the seven stages of DOPRI5
STAGES = WEIGHTS.size
GROWTH = 5.0  # a step is at most so many times the one before
# A contact with fewer than this part of the steps of a free impact counts as unresolved: its peak
# could be missed.  A bump of a worn surface can cut a contact short, and there the error control
# decides.
RESOLVED = 1.0 / 3.0
# A step that ends on a touchdown or separation goes this far behind it, m; on a change of a load's
# law, m, rad, m/s or rad/s
LANDING_DEPTH = 1e-11
LANDING_PART = 1e-3  # ... but no further than this part of the contact's duration
# Part of a predicted time that is in doubt while the change of acceleration is unknown
PREDICTION_TOL = 0.05

# State of the choice of steps
PACE = np.dtype(
    [
        ("longest", np.float64),  # step, s
        ("shortest", np.float64),  # s
        ("parts", np.float64),  # steps in a free impact, at least
        ("reach", np.float64),  # last step that was not cut short, s
        ("limit", np.float64),  # of the step, s
        ("cut", np.bool_),  # an event set that limit
        ("to_break", np.bool_),  # ... of a drive's motion
        ("smooth", np.bool_),  # no pin has touched down or left in the last step
        ("evaluations", np.int64),
        ("accepted", np.int64),  # evaluations up to the last accepted step
        ("noted", np.float64),  # time of the state whose contacts are noted, s
        ("events", np.int64),
        ("deepest_touch", np.float64),  # penetration of the first state in a contact, m
    ]
)


class TreeSystem(NamedTuple):
    """Open tree as the kernels see it, with Exudyn's live state and working space."""

    links: Records
    prescribed: Prescribed
    x: Array  # Exudyn's live coordinates, rates and accelerations, (coordinates,)
    u: Array
    u_t: Array
    force: Array  # forces that Exudyn is handed, (coordinates,)
    expected: Array  # closing speed of the next step: latched, or predicted while open, m/s
    pace: Records  # one of PACE
    # Powers of the stages: drives (see ``stage_forces``), the joints', the loads'
    stages: Array
    state: Array  # q, v, a, generalized forces, axes: see ``place_links``; (5, 3 bodies)
    carried: Array  # (links, CARRIED)
    balance: Array  # (coordinates,)
    start: Array  # coordinates, rates and accelerations at the start of a step, (3, coordinates)
    inside: Array  # and inside it
    bristles: Array  # their deflections at the start and end of a step, m, (2, joints)


@compiled
def stage_forces(address: PackedArguments, t: float) -> int:
    """Fill the forces on the coordinates of the tree in a stage, without those of inertia.

    The drives' power is that against the forces on the prescribed bodies: what is applied there,
    and dP/dt - F of each branch times the velocity of its hinge.  The integral of dP/dt . v is the
    change of P . v, added after the run, less that of P . a: no acceleration is needed here.

    ``address`` packs TreeSystem and RecorderState; the contacts hold the deflections of bristles.

    Returns the number of stages since the last accepted step.
    """
    system, records = unpack(address)
    packed, contacts, pace = records.packed, records.contacts, system.pace[0]
    q, v, a, force, axes = system.state
    place_prescribed(system.prescribed, t, q, v, a, axes)
    place_links(system.links, system.x, system.u, q, v, axes)
    load_power = applied_forces(packed, t, q, v, force)
    stage = pace.evaluations % STAGES
    row = system.stages[stage]
    row[row.shape[0] - 1] = load_power
    pace.evaluations += 1
    # The first stage is in the state that the last step ended in.
    if stage > 0 or t != pace.noted:
        note_contacts(packed, contacts, q, v, axes)
        pace.noted = t
    add_contacts(packed.joints, system.expected, contacts, force, row[1:])
    carry_branches(system.links, v, a, axes, system.carried)
    power = -forced_power(system.prescribed, v, a, force)
    for i in range(system.links.shape[0]):
        link = system.links[i]
        b = link.body
        ax, ay = link.mass * system.carried[i, 2], link.mass * system.carried[i, 3]
        power -= force[b] * system.carried[i, 0] + force[b + 1] * system.carried[i, 1]
        power -= v[b] * ax + v[b + 1] * ay
        force[b] -= ax
        force[b + 1] -= ay
    row[0] = power
    gather_forces(system.links, q, axes, force, system.force)
    return pace.evaluations - pace.accepted


@compiled
def stage_bristles(address: PackedArguments, t: float) -> None:
    """Fill the rates of the bristles of friction in a stage, m/s.

    ``address`` packs TreeSystem, Packed, records of CONTACT as working space, deflections of the
    bristles, m, and their rates, each shape (joints,).
    """
    system, packed, contacts, bristles, out = unpack(address)
    q, v, a, _, axes = system.state
    place_prescribed(system.prescribed, t, q, v, a, axes)
    place_links(system.links, system.x, system.u, q, v, axes)
    note_contacts(packed, contacts, q, v, axes)
    for k in range(contacts.shape[0]):
        law = packed.joints[k].friction
        out[k] = 0.0
        if law.bristle_stiffness > 0.0:
            is_closed = contacts[k].penetration > 0.0
            out[k] = bristle_rate(contacts[k].sliding, bristles[k], is_closed, law)


@compiled
def hinge_power_integral(system: TreeSystem) -> float:
    """Sum of each branch's momentum times the velocity of its hinge, J: see ``stage_forces``."""
    _, v, a, _, axes = system.state
    carry_branches(system.links, v, a, axes, system.carried)
    total = 0.0
    for i in range(system.links.shape[0]):
        b = system.links[i].body
        along = v[b] * system.carried[i, 0] + v[b + 1] * system.carried[i, 1]
        total += system.links[i].mass * along
    return total


@compiled
def step_to_changes(packed: Packed, smooth: bool, t: float, h: float) -> float:
    """Return the step, s, no longer than ``h``, that ends on the next change of a load's law."""
    h = min(h, next_break(packed.loads) - t)
    for k in range(count_transitions(packed.loads)):
        p, r, a, j = transition_at_start(packed.loads, k, 1.0 if smooth else 0.0)
        if p == -math.inf:
            continue
        # To just behind it: what does not come so far is round-off.
        arrival, speed, doubt = time_to_event(min(p, 0.0) - LANDING_DEPTH, r, a, j)
        if arrival <= h and speed > 0.0:
            if not smooth:
                doubt = max(doubt, PREDICTION_TOL * arrival)
            is_near = doubt * speed <= 0.5 * LANDING_DEPTH
            h = min(h, step_to_event(arrival, doubt, is_near, 0.0, False))
    return h


@compiled
def step_to_contacts(records: RecorderState, system: TreeSystem, h: float) -> float:
    """Return the step, s, no longer than ``h``, that ends on the next touchdown or separation.

    Leaves the closing speeds that the stages of that step use in ``expected``.
    """
    pace = system.pace[0]
    a = system.state[2]
    for k in range(records.memory.shape[0]):
        joint = records.packed.joints[k]
        last = records.memory[k]
        closed = records.onset[k] > 0.0
        acceleration = penetration_acceleration(
            joint, records.packed.surfaces[k, :, : joint.surface_bins], records.contacts[k], a
        )
        jerk = (acceleration - last.acceleration) / last.step if last.step > 0.0 else 0.0
        last.acceleration = acceleration
        if closed and last.steps == 1 and last.rate > 0.0 and acceleration < 0.0:
            last.longest_step = 2.0 * last.rate / -acceleration / pace.parts
            h = min(h, last.longest_step)
        system.expected[k] = records.onset[k]
        sign = -1.0 if closed else 1.0
        jerk = sign * jerk if pace.smooth else 0.0
        if sign * last.penetration >= 0.0:
            continue
        arrival, speed, doubt = time_to_event(
            sign * last.penetration, sign * last.rate, sign * acceleration, jerk
        )
        if not closed:
            across, closing = time_across(records.contacts[k], joint.clearance)
            if across < arrival:
                arrival, speed, doubt = across, closing, PREDICTION_TOL * across
        if not arrival < 2.0 * h:
            continue
        if not closed:
            system.expected[k] = max(speed, 0.0)
        if arrival <= h and speed > 0.0:
            if not pace.smooth:
                doubt = max(doubt, PREDICTION_TOL * arrival)
            is_near = doubt * speed <= LANDING_DEPTH
            duration = contact_step(joint, 0.0, speed, 1.0)
            behind = min(LANDING_DEPTH / speed, LANDING_PART * duration)
            is_abrupt = joint.normal.abrupt and not closed
            h = min(h, step_to_event(arrival, doubt, is_near, behind, is_abrupt))
    return max(h, pace.shortest)


@compiled
def next_tree_step(
    records: RecorderState, system: TreeSystem, t: float, h: float, events: int
) -> float:
    """Limit of the step from a time, s, after one of length ``h``; error control may go below."""
    pace = system.pace[0]
    if not (pace.cut and h >= 0.999 * pace.limit):
        # A step cut short says little: what was reached before it still holds.
        pace.reach = max(h, pace.shortest)
    for k in range(records.memory.shape[0]):
        if records.onset[k] > 0.0 and records.memory[k].steps == 1:
            pace.deepest_touch = max(pace.deepest_touch, records.memory[k].penetration)
    pace.events += events
    # A break changes the third derivatives by which events are foreseen.
    pace.smooth = events == 0 and not (pace.to_break and h >= 0.999 * pace.limit)
    limit = longest_step(records, min(GROWTH * pace.reach, pace.longest), pace.parts)
    to_break = step_to_break(records.motions, t, limit)
    to_change = step_to_changes(records.packed, pace.smooth, t, to_break)
    pace.limit = step_to_contacts(records, system, to_change)
    pace.cut = pace.limit < limit
    pace.to_break = to_break < limit and pace.limit == to_break
    return pace.limit


@compiled
def sum_stages(records: RecorderState, system: TreeSystem, h: float) -> None:
    """Sum wear integrals and energies of a step of length ``h`` from the powers of its stages."""
    ledger, doses = records.ledger[0], records.wear_integrals
    count = records.memory.shape[0]
    for k in range(count):
        doses[k].work = doses[k].pressure = 0.0
    for j in range(STAGES):
        weight = h * WEIGHTS[j]
        row = system.stages[j]
        ledger.drive_work += weight * row[0]
        ledger.load_work += weight * row[row.shape[0] - 1]
        for k in range(count):
            base = 1 + JOINT_RATES * k
            ledger.contact_loss += weight * row[base + CONTACT_LOSS]
            ledger.friction_loss += weight * row[base + FRICTION_LOSS]
            ledger.made += weight * row[base + MADE]
            doses[k].work += weight * row[base + WORK]
            doses[k].pressure += weight * row[base + PRESSURE]
    for k in range(count):
        # One weight is negative: a step at the end of a contact may sum to less than nothing.
        doses[k].work = max(doses[k].work, 0.0)
        doses[k].pressure = max(doses[k].pressure, 0.0)


@compiled
def tree_state(
    system: TreeSystem, records: RecorderState, t: float, x: Array, u: Array, u_t: Array
) -> float:
    """Place all bodies with rates and accelerations; returns the power of the drives, W.

    Leaves the drives' torques in the records, and in the forces of each body what it and
    all that hangs from it bear.
    """
    q, v, a, force, axes = system.state
    place_prescribed(system.prescribed, t, q, v, a, axes)
    place_links(system.links, x, u, q, v, axes)
    accelerate_links(system.links, u_t, v, axes, a)
    applied_forces(records.packed, t, q, v, force)
    note_contacts(records.packed, records.contacts, q, v, axes)
    rates = system.stages[0, 1:]
    add_contacts(records.packed.joints, system.expected, records.contacts, force, rates)
    for c in range(force.shape[0]):
        force[c] -= records.packed.mass[c] * a[c]
    gather_forces(system.links, q, axes, force, system.balance)
    drive_torques(system.prescribed, q, axes, force, records.torque)
    parts = system.prescribed.parts
    power = 0.0
    for i in range(parts.shape[0]):
        if parts[i].drive >= 0:
            power += records.torque[parts[i].drive] * v[parts[i].body + 2]
    return power


@compiled
def interpolate(system: TreeSystem, s: float, h: float) -> None:
    """Fill the state inside a step of length ``h``, s, at a part ``s`` of it.

    Coordinates follow the quintic through both ends, rates the cubic, and accelerations its
    derivative: by it the rates change by as much as in the step.
    """
    x, u, u_t = system.x, system.u, system.u_t
    # Rows by index are contiguous for the compiler; rows of an unpacked array are not.
    x0, u0, a0 = system.start[0], system.start[1], system.start[2]
    xs, us, accelerations = system.inside[0], system.inside[1], system.inside[2]
    for i in range(x.shape[0]):
        c1 = h * u0[i]
        c2 = 0.5 * h * h * a0[i]
        d0 = x[i] - x0[i] - c1 - c2
        d1 = h * u[i] - c1 - 2.0 * c2
        d2 = h * h * u_t[i] - 2.0 * c2
        c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2
        c4 = -15.0 * d0 + 7.0 * d1 - d2
        c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2
        xs[i] = x0[i] + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))))
        change = u[i] - u0[i]
        bend = 3.0 * change - h * (2.0 * a0[i] + u_t[i])
        rest = h * (a0[i] + u_t[i]) - 2.0 * change
        us[i] = u0[i] + s * (h * a0[i] + s * (bend + s * rest))
        accelerations[i] = a0[i] + s * (2.0 * bend + s * 3.0 * rest) / h


@compiled
def end_step(system: TreeSystem, records: RecorderState, t: float, h: float) -> float:
    """Place all bodies at the end of a step; return the power of the drives there, W.

    Integrates their torque and power by Gauss's rule with two points.  Both lie inside the step, so
    that a load that jumps at an end has the force of the step.
    """
    contacts, drives, inside = records.contacts, records.drives, system.inside
    v = system.state[1]
    for k in range(contacts.shape[0]):
        system.bristles[1, k] = contacts[k].bristle
    for k in range(drives.shape[0]):
        drive = drives[k]
        drive.torque_integral = drive.torque_square_integral = 0.0
        drive.work = drive.power_square_integral = 0.0
    power = 0.0
    for point in range(3):
        if point < 2 and h == 0.0:
            continue
        s, time = 1.0, t
        xs, us, accelerations = system.x, system.u, system.u_t
        if point < 2:
            s = 0.5 + (point - 0.5) / math.sqrt(3.0)
            time = t - h + s * h
            interpolate(system, s, h)
            xs, us, accelerations = inside[0], inside[1], inside[2]
        for k in range(contacts.shape[0]):
            first, last = system.bristles[0, k], system.bristles[1, k]
            contacts[k].bristle = first + s * (last - first) if point < 2 else last
        power = tree_state(system, records, time, xs, us, accelerations)
        for k in range(drives.shape[0] if point < 2 else 0):
            drive, torque = drives[k], records.torque[k]
            work = torque * v[records.packed.driven[k]]
            drive.torque_integral += 0.5 * h * torque
            drive.torque_square_integral += 0.5 * h * torque * torque
            drive.work += 0.5 * h * work
            drive.power_square_integral += 0.5 * h * work * work
    system.pace[0].noted = t
    copy_to(system.start[0], system.x)
    copy_to(system.start[1], system.u)
    copy_to(system.start[2], system.u_t)
    for k in range(contacts.shape[0]):
        system.bristles[0, k] = contacts[k].bristle
    return power


@compiled
def accept_tree_step(address: PackedArguments, t: float) -> float:
    """Account for an accepted step and choose the next, s; NaN for a broken state.

    ``address`` packs TreeSystem and RecorderState.
    """
    system, records = unpack(address)
    system.pace[0].accepted = system.pace[0].evaluations
    x, u, u_t = system.x, system.u, system.u_t
    if not all_finite(x, u) or not all_finite(u, u_t):
        return math.nan
    h = t - records.output[0].now
    sum_stages(records, system, h)
    power = end_step(system, records, t, h)
    ledger = records.ledger[0]
    ledger.drive_exchange += 0.5 * h * (abs(ledger.drive_power) + abs(power))
    ledger.drive_power = power
    q, v, a, _, _ = system.state
    events = settle(records, t, int(RESOLVED * system.pace[0].parts + 0.5))
    events += settle_loads(records.packed.loads, t, q, v, a)
    observe(records, t, h, q, v, a)
    return next_tree_step(records, system, t, h, events)
