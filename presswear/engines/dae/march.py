"""The run loops: error-controlled with located events, and with equal steps.

Events are touchdowns, separations, corners of friction and changes of the laws of
loads.  A trial step that holds one is repeated until it ends there, so that no step
crosses a change of law.  Equal steps are cut in two where a load's law changes;
contacts change between them only.
"""

from presswear.engines.dae.dynamics import place_held
from presswear.engines.dae.runge_kutta import (
    SPARE,
    START,
    classical_step,
    embedded_step,
    rates,
)
from presswear.physics.constraints import ConstraintSystem, project
from presswear.physics.contact import copy_contacts
from presswear.physics.dormand_prince import Tableau
from presswear.physics.drive_motion import step_to_break
from presswear.physics.equations.function import END
from presswear.physics.equations.layout import (
    DOSE_COUNT,
    POWER,
    POWER_SQUARE,
    PRESSURE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    WORK,
)
from presswear.physics.friction_and_normal import corner_ahead
from presswear.physics.load_transitions import (
    count_transitions,
    next_break,
    settle_loads,
    transition_value,
)
from presswear.physics.step_length import contact_step, longest_step
from presswear.physics.touchdown import (
    HELD_OPEN,
    LEAST_STEPS,
    is_reversed,
    joint_crossing,
    load_crossing,
    remember,
    seen_from_opposite,
    separate,
    settle,
    touch_down,
)
from presswear.recording.nominal_time import section_crossing, section_value, time_left
from presswear.recording.observe import observe
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, copy_to
from presswear.tools.packing import PackedArguments, unpack

RUNNING, DONE, BROKEN, STUCK, TRYING = range(5)

FIRST_PARTS = 40.0  # expected duration of a contact over the first step after touchdown
SAFETY = 0.9
LEAST_FACTOR = 0.2
GREATEST_FACTOR = 5.0
# Most repetitions that locate an event; four do, halving helps where Newton strays.
NEWTON_STEPS = 60
SHORTEST_MOVE = 1e-15  # change of a step, s, below which Newton's method stands still
EVENT_DEPTH = 1e-17  # penetration at which an event is located, m
# that of a corner, as a part of the resolution of the coordinates: their round-off, below
# which Newton's method meets nothing but noise
CORNER_EVENT = 0.125
# penetration up to which a place that round-off keeps from it is one, m
DEPTH_TOL = 1e-12
# s; a later event differs from the one on which the last step ended
MIN_SEPARATION = 1e-14
# A step that ends on a change of a load's law goes so far behind it, m, rad, m/s or
# rad/s.
BEHIND = 1e-13
MAX_BEHIND = 1e-9  # ... and so far where round-off keeps it from ending sooner


@compiled
def reach_end(
    address: PackedArguments, classical: int | None, t: float, h: float
) -> None:
    """Fill the state of all bodies at the end of a trial step, with accelerations."""
    # An embedded method evaluates its last slopes there.
    if classical is not None:
        (run,) = unpack(address)
        rates(address, t + h, run.motion.trial, SPARE)


@compiled
def event_value(
    address: PackedArguments, classical: int | None, k: int, t: float, h: float
) -> tuple[float, float]:
    """Return the switching function of event ``k`` at the end of a trial step, and its rate.

    Events are those of the joints, for which slopes were evaluated last in that state,
    then the ways out of the modes of the loads, then the corners of friction: of each
    joint the next one upwards and the next one downwards.  The last is the end of a
    section of a cycle that ends at an angle.
    """
    (run,) = unpack(address)
    system = run.system
    records = run.records
    joints = system.contacts.shape[0]
    if k < joints:
        contact = system.contacts[k]
        if records.onset[k] <= 0.0:
            return contact.penetration, contact.rate
        if is_reversed(records.memory[k], contact):
            return -seen_from_opposite(
                contact.penetration, contact.eccentricity
            ), contact.rate
        return -contact.penetration, -contact.rate
    k -= joints
    transitions = count_transitions(system.packed.loads)
    if k < transitions:
        reach_end(address, classical, t, h)
        q, v, a, _, _ = system.state
        return transition_value(system.packed.loads, k, q, v, a)
    if k == transitions + 2 * joints:
        reach_end(address, classical, t, h)
        q, v, _, _, _ = system.state
        return section_value(records.nominal, q, v)
    sense = 1.0 - 2.0 * ((k - transitions) & 1)
    k = (k - transitions) >> 1
    start, end = records.contacts[k].sliding, system.contacts[k].sliding
    corner = corner_ahead(start, sense, system.packed.joints[k].friction)
    # The mean rate over the step: sliding bends little in one.
    return sense * (end - corner), sense * (end - start) / h


@compiled
def is_repeated(
    last: Records,
    is_closed: bool,
    after: float,
    value: float,
    rate: float,
    resolution: float,
) -> bool:
    """Return whether a crossing is the event on which the last step ended, seen once more.

    A joint that was just placed on an event moves away from it. Round-off alone brings
    it back, by less than the resolution of its coordinates, m. ``value`` and ``rate``
    are those of ``joint_crossing``; ``after`` is the time from the start of the step,
    s.
    """
    if rate > 0.0:
        return False
    if value <= 0.0:
        return after <= MIN_SEPARATION
    start = -last.penetration if is_closed else last.penetration
    return value <= max(start, 0.0) + resolution


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
def first_event(
    address: PackedArguments,
    tableau: Tableau | None,
    t: float,
    h: float,
    excluded: int,
    joints: int,
) -> tuple[int, float]:
    """Return the first event in a trial step, or -1, and the fraction of the step before it.

    The slopes must have been evaluated at the end of the step. Only the first
    ``joints`` joints are searched. ``excluded`` is the event on which the step ends.
    Numbers of events are those of ``event_value``.
    """
    (run,) = unpack(address)
    system = run.system
    classical = run.classical
    records = run.records
    control = run.control
    loads = system.packed.loads
    count = system.contacts.shape[0]
    transitions = count_transitions(loads)
    event = -1
    fraction = 2.0
    for k in range(joints):
        if k == excluded or system.packed.joints[k].always_closed:
            continue
        last = records.memory[k]
        is_closed = records.onset[k] > 0.0
        s, value, rate, _ = joint_crossing(last, system.contacts[k], is_closed, h)
        if s < fraction and not is_repeated(
            last, is_closed, s * h, value, rate, control[0].resolution
        ):
            event = k
            fraction = s
    has_leader = records.nominal[0].column >= 0
    if transitions > 0 or has_leader:
        reach_end(address, classical, t, h)
    q, v, a, _, _ = system.state
    section = count + transitions + 2 * count
    if has_leader and excluded != section:
        s = section_crossing(records.nominal, q, v, h, 2.0 * BEHIND)
        if s < fraction:
            event = section
            fraction = s
    for k in range(transitions):
        if count + k == excluded:
            continue
        # A smaller value is round-off, or belongs to the event on which the step ends.
        s, value, rate = load_crossing(loads, k, q, v, a, h, 2.0 * BEHIND)
        if s < fraction and (
            s * h > MIN_SEPARATION or rate > 0.0 or value > MAX_BEHIND
        ):
            event = count + k
            fraction = s
    if tableau is None or not tableau.ends_at_corners or control[0].ignores_corners:
        return event, fraction
    for k in range(2 * joints):
        number = count + transitions + k
        joint = k >> 1
        if records.onset[joint] > 0.0 and number != excluded:
            start, end = records.contacts[joint].sliding, system.contacts[joint].sliding
            sense = 1.0 - 2.0 * (k & 1)
            law = system.packed.joints[joint].friction
            ahead = sense * (corner_ahead(start, sense, law) - start)
            way = sense * (end - start)
            if way > ahead + 2.0 * BEHIND and ahead < fraction * way:
                event = number
                fraction = ahead / way
    return event, fraction


@compiled
def start_search(control: Records, h: float) -> None:
    """Start to search for the event that ends a trial step of length ``h``."""
    state = control[0]
    state.whole = state.length = h
    state.searches = 0
    state.moves = 0
    state.event = -1
    state.is_located = True


@compiled
def is_abrupt_touchdown(joints: Records, onset: Array, k: int) -> bool:
    """Return whether the force of a joint jumps at the event that ends its open state.

    Such a step must end with the pin in the wall. A step from the open side of the
    touchdown starts without the force, and no step is short enough for the jump within
    it.
    """
    return bool(onset[k] <= 0.0 and joints[k].normal.abrupt)


@compiled
def search_event(
    address: PackedArguments,
    tableau: Tableau | None,
    classical: int | None,
    t: float,
    joints: int,
) -> bool:
    """Search in a trial step for the first event; return whether a trial of another length follows.

    At the end of the step that is found a joint has zero penetration, or is just closed
    if its force begins with a jump, and a load is just behind the change of its law.
    Newton's method, held between the ends of the trial step: where a surface is steep
    it would stray.
    """
    (run,) = unpack(address)
    state = run.control[0]
    contacts = run.system.contacts.shape[0]
    if state.moves > 0:
        aim = 0.0
        near = EVENT_DEPTH
        accepted = max(DEPTH_TOL, state.resolution)
        if state.event >= contacts:
            aim = BEHIND
            near = 0.5 * BEHIND
            accepted = MAX_BEHIND
        else:
            joint_records = run.system.packed.joints
            if joint_records[state.event].is_flat:
                near = CORNER_EVENT * state.resolution
            if is_abrupt_touchdown(joint_records, run.records.onset, state.event):
                aim = 2.0 * near
        value, rate = event_value(address, classical, state.event, t, state.length)
        value -= aim
        following = state.length
        is_found = abs(value) <= near or state.is_last
        if not is_found:
            if value > 0.0:
                state.high = state.length
            else:
                state.low = state.length
            following = state.length - value / rate if rate != 0.0 else -1.0
            if not state.low < following < state.high:
                following = 0.5 * (state.low + state.high)
            if abs(following - state.length) <= SHORTEST_MOVE:
                if aim == 0.0 or value > 0.0:
                    is_found = True
                else:
                    # Round-off keeps it from ending just behind: the nearest that is
                    # behind.
                    following = min(state.length + state.extension, state.high)
                    state.extension *= 4.0
                    state.is_last = following == state.high
        if not is_found and state.moves < NEWTON_STEPS:
            state.length = following
            state.moves += 1
            return True
        state.moves = 0
        state.is_located = (
            abs(value) <= accepted if aim == 0.0 else -near <= value <= accepted
        )
        if not state.is_located:
            return False
    # The cubics may see events of two joints in the wrong order.
    events = 3 * contacts + count_transitions(run.system.packed.loads)
    if state.searches > events + (run.records.nominal[0].column >= 0):
        return False
    state.searches += 1
    earlier, fraction = first_event(
        address, tableau, t, state.length, state.event, joints
    )
    if earlier < 0:
        return False
    state.event = earlier
    state.moves = 1
    state.low = 0.0
    state.high = state.length
    state.extension = SHORTEST_MOVE
    state.is_last = False
    state.length *= fraction
    return True


@compiled
def keep_constraints(
    constraints: ConstraintSystem | None, is_projected: bool, t: float, y: Array
) -> None:
    """Move a state onto the constraints where that is requested."""
    if constraints is not None and is_projected:
        n = constraints.inverse_mass.shape[0]
        project(constraints, t, y[:n], y[n : 2 * n])


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
            records.torque[k] = motion.slopes[
                0, system.layout.first_torque + TORQUE_INTEGRALS * k + TORQUE
            ]
        q, v, a, _, _ = system.state
        copy_contacts(records.contacts, system.contacts)
        settle(records, 0.0, LEAST_STEPS)
        observe(records, 0.0, 0.0, q, v, a)
        state.has_started = True


@compiled
def place_state(address: PackedArguments, t: float) -> None:
    """Fill the motion of all bodies, and the contacts, in the present state."""
    (run,) = unpack(address)
    rates(address, t, run.motion.y, SPARE)
    copy_contacts(run.records.contacts, run.system.contacts)


@compiled
def finish_step(
    address: PackedArguments, constraints: ConstraintSystem | None, t: float, h: float
) -> None:
    """Account for an accepted state in ``motion.y``, the one that slopes were evaluated in last."""
    (run,) = unpack(address)
    system = run.system
    records = run.records
    control = run.control
    motion = run.motion
    layout = system.layout
    y = motion.y
    copy_contacts(records.contacts, system.contacts)
    for k in range(system.contacts.shape[0]):
        base = layout.first_dose + DOSE_COUNT * k
        # Integrals are emptied into the account, so that they never lose digits.
        records.wear_integrals[k].work = y[base + WORK]
        records.wear_integrals[k].pressure = y[base + PRESSURE]
        y[base + WORK] = y[base + PRESSURE] = 0.0
        joint = records.packed.joints[k]
        contact = records.contacts[k]
        remember(records.memory[k], joint, records.onset[k], contact, t)
    for k in range(records.drives.shape[0]):
        base = layout.first_torque + TORQUE_INTEGRALS * k
        drive = records.drives[k]
        drive.torque_integral = y[base + TORQUE]
        drive.torque_square_integral = y[base + TORQUE_SQUARE]
        drive.work = y[base + POWER]
        drive.power_square_integral = y[base + POWER_SQUARE]
        y[base : base + TORQUE_INTEGRALS] = 0.0
        records.torque[k] = motion.slopes[0, base + TORQUE]
    q, v, a, _, _ = system.state
    observe(records, t, h, q, v, a)
    state = control[0]
    state.time = t
    state.steps += 1
    if constraints is not None:
        for row in range(constraints.phi.shape[0]):
            state.position_error = max(state.position_error, abs(constraints.phi[row]))
            state.velocity_error = max(
                state.velocity_error, abs(constraints.phi_t[row])
            )


@compiled
def propose_step(address: PackedArguments, end: float) -> bool:
    """Choose the next trial step towards ``end``; return False at the end."""
    (run,) = unpack(address)
    records = run.records
    state = run.control[0]
    t = state.time
    left = time_left(records.nominal, t, end)
    if left <= 0.0:
        return False
    longest = longest_step(records, state.longest, state.parts)
    h = min(step_to_break(records.motions, t, min(state.step, longest)), left)
    h = min(h, next_break(run.system.packed.loads) - t)
    state.reaches_end = h >= left
    start_search(run.control, h)
    return True


@compiled
def judge_step(
    address: PackedArguments,
    tableau: Tableau,
    classical: int | None,
    error: float,
    end: float,
) -> int:
    """Accept a trial step, shorten it, or search for the event that ends it.

    Returns TRYING if the step is to be repeated with another length, and RUNNING if a
    new one is to be proposed.
    """
    (run,) = unpack(address)
    system = run.system
    motion = run.motion
    last = run.last
    joints = system.contacts.shape[0]
    state = run.control[0]
    t = state.time
    state.evaluations += last
    if state.searches == 0:
        if not error <= 1.0:
            state.rejected += 1
            factor = LEAST_FACTOR
            if error < 1e30:
                factor = max(LEAST_FACTOR, SAFETY * error**tableau.exponent)
            state.step = state.whole * factor
            if state.step > state.shortest:
                return RUNNING
            return BROKEN if not error < 1e30 else STUCK
        factor = GREATEST_FACTOR if error == 0.0 else SAFETY * error**tableau.exponent
        state.step = state.whole * min(max(factor, LEAST_FACTOR), GREATEST_FACTOR)
    if search_event(address, tableau, classical, t, joints):
        return TRYING
    k = state.event
    if not state.is_located:
        # The cubic through both ends saw what is not there; a shorter one sees better.
        # The sliding of a pin that hardly presses on a worn arc is round-off.
        corners = joints + count_transitions(system.packed.loads)
        state.ignores_corners = corners <= k < corners + 2 * joints
        state.rejected += 1
        state.step = state.whole if state.ignores_corners else 0.5 * state.whole
        return RUNNING if state.step > state.shortest else STUCK
    h = state.length
    if k >= 0:
        state.events += 1
    state.ignores_corners = False
    t = end if state.reaches_end and k < 0 else t + h
    copy_to(motion.y, motion.trial)
    q, v, a, _, _ = system.state
    changed = settle_loads(system.packed.loads, t, q, v, a)
    changed += settle_joints(address, k, t)
    if state.projected or k >= 0 or changed > 0:
        keep_constraints(system.constraints, state.projected, t, motion.y)
        rates(address, t, motion.y, START)
        state.evaluations += 1
    else:
        copy_to(motion.slopes[0], motion.slopes[last])
    finish_step(address, system.constraints, t, h)
    return RUNNING


@compiled
def hold_open(onset: Array) -> None:
    """Keep steps from feeling a contact before its touchdown, because they end there."""
    for k in range(onset.shape[0]):
        if onset[k] == 0.0:
            onset[k] = HELD_OPEN


@compiled
def march_controlled(address: PackedArguments, end: float) -> int:
    """Integrate towards ``end`` for at most ``most`` steps; returns how far it got."""
    (run,) = unpack(address)
    tableau = run.tableau
    classical = run.classical
    state = run.control[0]
    start_march(address)
    hold_open(run.records.onset)
    for _ in range(state.most):
        if not propose_step(address, end):
            return DONE
        status = TRYING
        while status == TRYING:
            error = embedded_step(address, tableau, state.time, state.length)
            status = judge_step(address, tableau, classical, error, end)
        if status != RUNNING:
            return status
    return RUNNING


@compiled
def march_fixed(address: PackedArguments, end: float) -> int:
    """Integrate with equal steps of order 4; contact state changes between steps only."""
    (run,) = unpack(address)
    system = run.system
    tableau = run.tableau
    classical = run.classical
    records = run.records
    control = run.control
    motion = run.motion
    n = system.layout.coordinates
    state = control[0]
    start_march(address)
    for _ in range(state.most):
        t = state.time
        left = time_left(records.nominal, t, end)
        # A remainder of round-off is no step.
        if left <= 1e-9 * state.step:
            return DONE
        h = min(state.due - t if state.due > t else state.step, left)
        whole = h
        h = min(
            step_to_break(records.motions, t, h), next_break(system.packed.loads) - t
        )
        classical_step(address, t, h)
        start_search(control, h)
        while search_event(address, tableau, classical, t, 0):
            classical_step(address, t, state.length)
        if not state.is_located:
            classical_step(address, t, h)
        elif state.event >= 0:
            h = state.length
            state.events += 1
        for i in range(2 * n):
            if not abs(motion.trial[i]) < 1e30:
                return BROKEN
        copy_to(motion.y, motion.trial)
        # What is left of a step that was cut follows by itself.
        state.due = t + whole if h < whole else 0.0
        t = end if h >= left else t + h
        q, v, a, _, _ = system.state
        if system.constraints is None:
            rates(address, t, motion.y, SPARE)
        else:
            # Multipliers are dear: the accelerations stay those of the last stage.
            place_held(system, t, motion.y, motion.slopes[SPARE], END)
        settle_loads(system.packed.loads, t, q, v, a)
        copy_contacts(records.contacts, system.contacts)
        settle(records, t, LEAST_STEPS)
        keep_constraints(system.constraints, state.projected, t, motion.y)
        rates(address, t, motion.y, START)
        finish_step(address, system.constraints, t, h)
    return RUNNING
