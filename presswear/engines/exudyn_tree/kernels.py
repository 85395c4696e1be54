"""Compiled part of the open tree: forces of a stage, and one call per accepted step.

Exudyn's DOPRI5 evaluates seven stages a step, the last in the state that the step
ends in.  Each leaves its powers in a row, so that work, losses and wear integrals are
integrated with the weights of the method and at its order.

The law of force changes where a pin touches down or leaves, and where the law of a load does.
Steps end there: the moment is predicted from penetration, rate, acceleration and its change, a
first step goes as near as the prediction can be trusted, a second one ends just behind.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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
from presswear.physics.loads import (
    count_transitions,
    next_break,
    settle_loads,
    transition_at_start,
)
from presswear.physics.packed import applied_forces
from presswear.physics.prescribed import Prescribed, drive_torques, forced_power, place_prescribed
from presswear.physics.touchdown import LEAST_PARTS, contact_step, skim_step, step_after_touchdown
from presswear.physics.tree import accelerate_links, carry_branches, gather_forces, place_links
from presswear.recording.observe import RecorderState, observe, settle_state
from presswear.tools.compile import PackedArguments, Records, all_finite, compiled, copy_to, unpack

Array = NDArray[np.float64]

WEIGHTS = np.append(DOPRI5.b, 0.0)  # weights of the seven stages of DOPRI5
STAGES = WEIGHTS.size

GROWTH = 5.0  # a step is at most so many times the one before
LEAST_STEPS = 5
"""A contact of fewer steps counts as unresolved: its peak could be missed.  A free impact gets
LEAST_PARTS; a bump of a worn surface can cut a contact short that began like one, and
there the error control decides."""
LANDING_DEPTH = 1e-11
"""A step that ends on a touchdown or separation goes this far behind it, m; on a change of a
load's law, m, rad, m/s or rad/s."""
LANDING_PART = 1e-3  # ... but no further than this part of the contact's duration
# Part of a predicted time that is in doubt while the change of acceleration is unknown.
PREDICTION_TOL = 0.05

PACE = np.dtype(
    [
        ("longest", np.float64),  # step, s
        ("shortest", np.float64),  # s
        ("reach", np.float64),  # last step that was not cut short, s
        ("asked", np.float64),  # limit that was set to the step, s
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
"""State of the choice of steps."""


class TreeSystem(NamedTuple):
    """An open tree as the kernels see it, with working space.

    Attributes
    ----------
    links : records of LINK
    prescribed : Prescribed
    expected : ndarray, shape (joints,)
        Closing speed that the next step uses: latched, or predicted while open, m/s.
    pace : one record of PACE
    stages : ndarray, shape (STAGES, 2 + JOINT_RATES joints)
        Powers of the stages of a step: drives (see ``stage_forces``), the joints', the loads'.
    state : ndarray, shape (5, 3 bodies)
        q, v, a and generalized forces of all bodies, and their axes: cosine and sine of
        a body's angle in the places of its x and y.
    carried : ndarray, shape (links, CARRIED)
    balance : ndarray, shape (coordinates,)
    """

    links: Records
    prescribed: Prescribed
    expected: Array
    pace: Records
    stages: Array
    state: Array
    carried: Array
    balance: Array


class Inside(NamedTuple):
    """Working space for the states inside a step, at which torques are evaluated.

    Attributes
    ----------
    system, records : TreeSystem and RecorderState
        With contacts, torques and states of their own.
    start : ndarray, shape (3, coordinates)
        Coordinates of the tree, rates and accelerations at the start of the step.
    state : ndarray, shape (3, coordinates)
        The same inside the step.
    bristles : ndarray, shape (joints,)
        Deflections of the bristles at the start of the step, m.
    """

    system: TreeSystem
    records: RecorderState
    start: Array
    state: Array
    bristles: Array


@compiled
def stage_forces(run: PackedArguments, t: float) -> int:
    """Fill the forces on the coordinates of the tree in a stage, without those of inertia.

    The contacts hold the deflections of the bristles of friction, where it has some.

    The drives' power is that against the forces on the prescribed bodies: what is applied
    there, and dP/dt - F of each branch times the velocity of its hinge.  The part
    dP/dt . v is the end value of P . v less the integral of P . a; the end values are
    added after the run, so that no acceleration is needed here.

    Parameters
    ----------
    run : PackedArguments
        TreeSystem, RecorderState, coordinates of the tree, rates, accelerations, and the forces.

    Returns
    -------
    int
        Stages since the last accepted step.
    """
    system, records, x, u, _, out = unpack(run)
    packed, contacts = records.packed, records.contacts
    q, v, a, force, axes = system.state
    place_prescribed(system.prescribed, t, q, v, a, axes)
    place_links(system.links, x, u, q, v, axes)
    load_power = applied_forces(packed, t, q, v, force)
    pace = system.pace[0]
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
        ax = link.mass * system.carried[i, 2]
        ay = link.mass * system.carried[i, 3]
        power -= force[b] * system.carried[i, 0] + force[b + 1] * system.carried[i, 1]
        power -= v[b] * ax + v[b + 1] * ay
        force[b] -= ax
        force[b + 1] -= ay
    row[0] = power
    gather_forces(system.links, q, axes, force, out)
    return pace.evaluations - pace.accepted


@compiled
def stage_bristles(run: PackedArguments, t: float) -> None:
    """Fill the rates of the bristles of friction in a stage, m/s.

    Parameters
    ----------
    run : PackedArguments
        TreeSystem, Packed, records of CONTACT as working space, coordinates of the tree, rates,
        deflections of the bristles, m, and their rates, each shape (joints,).
    """
    system, packed, contacts, x, u, bristles, out = unpack(run)
    q, v, a, _, axes = system.state
    place_prescribed(system.prescribed, t, q, v, a, axes)
    place_links(system.links, x, u, q, v, axes)
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
def time_to_event(p: float, r: float, a: float, j: float) -> tuple[float, float]:
    """Time, s, at which a quantity below zero reaches it, and how far that is in doubt.

    Parameters
    ----------
    p, r, a, j : float
        Value and three time derivatives; the doubt is what the third one changes.

    Returns
    -------
    tuple
        Infinite where it is not reached.
    """
    root = r * r - 2.0 * a * p
    if root < 0.0:
        return math.inf, 0.0
    denominator = r + math.sqrt(root)
    if denominator <= 0.0:
        return math.inf, 0.0
    first = -2.0 * p / denominator
    arrival = first
    for _ in range(2):
        slope = r + arrival * (a + 0.5 * j * arrival)
        if slope <= 0.0:
            return first, first
        change = -(p + arrival * (r + arrival * (0.5 * a + j * arrival / 6.0))) / slope
        arrival = min(max(arrival + change, 0.5 * first), 2.0 * first)
    return arrival, abs(arrival - first)


@compiled
def step_to_changes(records: RecorderState, system: TreeSystem, t: float, h: float) -> float:
    """Step, s, no longer than ``h``, that does not run past the next change of a load's law."""
    loads = records.packed.loads
    h = min(h, next_break(loads) - t)
    smooth = system.pace[0].smooth
    for k in range(count_transitions(loads)):
        p, r, a, j = transition_at_start(loads, k, 1.0 if smooth else 0.0)
        if p == -math.inf:
            continue
        # To just behind it: what does not come so far is round-off.
        arrival, doubt = time_to_event(min(p, 0.0) - LANDING_DEPTH, r, a, j)
        speed = r + arrival * (a + 0.5 * j * arrival)
        if arrival > h or not speed > 0.0:
            continue
        if not smooth:
            doubt = max(doubt, PREDICTION_TOL * arrival)
        near = doubt * speed <= 0.5 * LANDING_DEPTH
        h = min(h, arrival if near else max(arrival - 2.0 * doubt, 0.5 * arrival))
    return h


@compiled
def step_to_events(records: RecorderState, system: TreeSystem, h: float) -> float:
    """Step, s, no longer than ``h``, that does not run past the next change of law.

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
            last.longest_step = 2.0 * last.rate / -acceleration / LEAST_PARTS
            h = min(h, last.longest_step)
        system.expected[k] = records.onset[k]
        sign = -1.0 if closed else 1.0
        jerk = sign * jerk if pace.smooth else 0.0
        p, r, a_n = sign * last.penetration, sign * last.rate, sign * acceleration
        if p >= 0.0:
            continue
        arrival, doubt = time_to_event(p, r, a_n, jerk)
        if not arrival < 2.0 * h:
            continue
        speed = r + arrival * (a_n + 0.5 * jerk * arrival)
        if not closed:
            system.expected[k] = max(speed, 0.0)
        if arrival > h or not speed > 0.0:
            continue
        if not pace.smooth:
            doubt = max(doubt, PREDICTION_TOL * arrival)
        if doubt * speed <= LANDING_DEPTH:
            behind = min(LANDING_DEPTH / speed, LANDING_PART * contact_step(joint, 0.0, speed, 1.0))
            # A law that begins with a jump gets its touchdown in a short step of its own.
            if joint.normal.abrupt and not closed and arrival > 2.0 * behind:
                behind = -behind
            h = min(h, arrival + behind)
        else:
            h = min(h, max(arrival - 2.0 * doubt, 0.5 * arrival))
    return max(h, pace.shortest)


@compiled
def sum_stages(records: RecorderState, system: TreeSystem, h: float) -> None:
    """Sum wear integrals and energies of a step of length ``h`` from the powers of its stages."""
    ledger = records.ledger[0]
    count = records.memory.shape[0]
    for k in range(count):
        records.wear_integrals[k].work = records.wear_integrals[k].pressure = 0.0
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
            records.wear_integrals[k].work += weight * row[base + WORK]
            records.wear_integrals[k].pressure += weight * row[base + PRESSURE]
    for k in range(count):
        # One weight is negative: a step at the end of a contact may sum to less than nothing.
        records.wear_integrals[k].work = max(records.wear_integrals[k].work, 0.0)
        records.wear_integrals[k].pressure = max(records.wear_integrals[k].pressure, 0.0)


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
    rates = system.stages[0, 1:]
    if t != system.pace[0].noted:
        note_contacts(records.packed, records.contacts, q, v, axes)
        system.pace[0].noted = t
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
def interpolate(inside: Inside, s: float, h: float, x: Array, u: Array, u_t: Array) -> None:
    """Fill the state at a part ``s`` of a step of length ``h``, s, that ends in the given state.

    Coordinates follow the quintic through both ends, rates the cubic, and accelerations its
    derivative: by it the rates change by as much as in the step.
    """
    # Rows by index are contiguous for the compiler; rows of an unpacked array are not.
    x0, u0, a0 = inside.start[0], inside.start[1], inside.start[2]
    xs, us, accelerations = inside.state[0], inside.state[1], inside.state[2]
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
def sum_torques(
    inside: Inside,
    system: TreeSystem,
    records: RecorderState,
    t: float,
    h: float,
    x: Array,
    u: Array,
    u_t: Array,
) -> None:
    """Integrate torque and power of the drives over a step by Gauss's rule with two points.

    Both lie inside the step, so that a load that jumps at an end has the force of the step.
    """
    work = system.prescribed.work
    for i in range(work.shape[0]):
        copy_to(inside.system.prescribed.work[i], work[i])
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        drive.torque_integral = drive.torque_square_integral = 0.0
        drive.work = drive.power_square_integral = 0.0
    if h > 0.0:
        for side in range(2):
            s = 0.5 + (side - 0.5) / math.sqrt(3.0)
            interpolate(inside, s, h, x, u, u_t)
            for k in range(inside.bristles.shape[0]):
                first = inside.bristles[k]
                inside.records.contacts[k].bristle = first + s * (
                    records.contacts[k].bristle - first
                )
            xs, us, accelerations = inside.state[0], inside.state[1], inside.state[2]
            tree_state(inside.system, inside.records, t - h + s * h, xs, us, accelerations)
            v = inside.system.state[1]
            for k in range(records.drives.shape[0]):
                drive = records.drives[k]
                torque = inside.records.torque[k]
                power = torque * v[records.packed.driven[k]]
                drive.torque_integral += 0.5 * h * torque
                drive.torque_square_integral += 0.5 * h * torque * torque
                drive.work += 0.5 * h * power
                drive.power_square_integral += 0.5 * h * power * power
    copy_to(inside.start[0], x)
    copy_to(inside.start[1], u)
    copy_to(inside.start[2], u_t)
    for k in range(inside.bristles.shape[0]):
        inside.bristles[k] = records.contacts[k].bristle


@compiled
def next_tree_step(
    records: RecorderState, system: TreeSystem, t: float, h: float, events: int
) -> float:
    """Limit of the step from a time, s, after one of length ``h``; error control may go below."""
    pace = system.pace[0]
    if not (pace.cut and h >= 0.999 * pace.asked):
        # A step cut short says little: what was reached before it still holds.
        pace.reach = max(h, pace.shortest)
    for k in range(records.memory.shape[0]):
        if records.onset[k] > 0.0 and records.memory[k].steps == 1:
            pace.deepest_touch = max(pace.deepest_touch, records.memory[k].penetration)
    pace.events += events
    # A break changes the third derivatives by which events are foreseen.
    pace.smooth = events == 0 and not (pace.to_break and h >= 0.999 * pace.asked)
    limit = min(
        step_after_touchdown(
            records.packed.joints, records.onset, records.memory, GROWTH * pace.reach
        ),
        skim_step(records.packed, records.memory, pace.longest),
    )
    broken = step_to_break(records.motions, t, limit)
    pace.asked = step_to_events(records, system, step_to_changes(records, system, t, broken))
    pace.cut = pace.asked < limit
    pace.to_break = broken < limit and pace.asked == broken
    return pace.asked


@compiled
def accept_tree_step(run: PackedArguments, t: float) -> float:
    """Account for an accepted step and choose the next, s; NaN for a broken state.

    Parameters
    ----------
    run : PackedArguments
        TreeSystem, RecorderState, Inside, coordinates of the tree, rates, and accelerations.
    """
    system, records, inside, x, u, u_t = unpack(run)
    system.pace[0].accepted = system.pace[0].evaluations
    if not all_finite(x, u) or not all_finite(u, u_t):
        return math.nan
    h = t - records.output[0].now
    sum_stages(records, system, h)
    sum_torques(inside, system, records, t, h, x, u, u_t)
    power = tree_state(system, records, t, x, u, u_t)
    ledger = records.ledger[0]
    ledger.drive_exchange += 0.5 * h * (abs(ledger.drive_power) + abs(power))
    ledger.drive_power = power
    q, v, a, _, _ = system.state
    events = settle_state(records, t, LEAST_STEPS)
    events += settle_loads(records.packed.loads, t, q, v, a)
    observe(records, t, h, q, v, a)
    return next_tree_step(records, system, t, h, events)
