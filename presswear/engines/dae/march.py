"""The run loops: error-controlled with located touchdowns, and with equal steps.

Error-controlled: a touchdown or separation inside an accepted step is located, and the
integration starts anew from it.  A load's law changes in the same way, with equal
steps too: one of them is cut in two where it does.
"""

import numpy as np

from presswear.engines.dae.dynamics import (
    DRIVE_INTEGRALS,
    JOINT_INTEGRALS,
    POWER,
    POWER_SQUARE,
    TORQUE,
    TORQUE_INTEGRALS,
    TORQUE_SQUARE,
    System,
    accelerate,
    drift,
    keep_constraints,
    place,
    rates,
)
from presswear.engines.dae.events import (
    HELD_OPEN,
    end_on_event,
    first_event,
    first_of_corners,
    last_slope,
    switch,
    trial_step,
)
from presswear.engines.dae.runge_kutta import POSITION_SCALE, Integration, embedded_step
from presswear.engines.dormand_prince import Tableau
from presswear.physics.contact import note_contacts
from presswear.physics.drive_motion import step_to_break
from presswear.physics.forces import PRESSURE, WORK, note_forces
from presswear.physics.loads import count_transitions, next_break
from presswear.physics.packed import settle_modes
from presswear.physics.touchdown import (
    LEAST_STEPS,
    contact_step,
    remember,
    skim_step,
    step_after_touchdown,
)
from presswear.recording.observe import RecorderState, observe, settle_state
from presswear.tools.compile import Records, compiled, copy_to, inlined

RUNNING, DONE, BROKEN, STUCK = 0, 1, 2, 3

FIRST_PARTS = 40.0  # first step behind a touchdown, as a part of the expected contact
SAFETY, LEAST_FACTOR, GREATEST_FACTOR = 0.9, 0.2, 5.0


@inlined
def finish_step(
    system: System,
    records: RecorderState,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
) -> None:
    """Account for an accepted state in ``motion.y``, the one that slopes were evaluated in last."""
    n = system.size
    y = motion.y
    for k in range(system.contacts.shape[0]):
        records.contacts[k] = system.contacts[k]
    note_forces(records.packed.joints, records.onset, records.contacts)
    for k in range(system.contacts.shape[0]):
        base = 2 * n + DRIVE_INTEGRALS + JOINT_INTEGRALS * k
        # Integrals are emptied into the account, so that they never lose digits.
        records.wear_integrals[k].work = y[base + WORK]
        records.wear_integrals[k].pressure = y[base + PRESSURE]
        y[base + WORK] = y[base + PRESSURE] = 0.0
        last = records.memory[k]
        remember(last, records.packed.joints[k], records.onset[k], records.contacts[k], t)
        if records.onset[k] > 0.0:
            last.steps += 1
    accelerate(system, motion.slopes[0])
    for k in range(records.drives.shape[0]):
        base = system.first_torque + TORQUE_INTEGRALS * k
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
    position, velocity = drift(system.held)
    state.position_error = max(state.position_error, position)
    state.velocity_error = max(state.velocity_error, velocity)


@compiled
def start_march(
    system: System, records: RecorderState, control: Records, motion: Integration, most: int
) -> None:
    """Evaluate the slopes of the state if necessary, and record the initial state once.

    Without steps to follow, only place all bodies in the state.
    """
    state, y, slope = control[0], motion.y, motion.slopes[0]
    if most > 0 and not state.has_slope:
        rates(system, records.onset, state.time, y, slope)
        state.has_slope = True
    if most == 0 or not state.has_started:
        place(system, state.time, y)
    if not state.has_started:
        accelerate(system, slope)
        copy_to(records.torque, system.torque)
        q, v, a, _, _ = system.state
        note_contacts(records.packed, records.contacts, q, v)
        settle_state(records, 0.0, LEAST_STEPS)
        observe(records, 0.0, 0.0, q, v, a)
        state.has_started = True


@compiled
def settle_state_modes(system: System, t: float) -> int:
    """Bring the loads' modes up to the state placed last; returns how many have changed."""
    q, v, a, _, _ = system.state
    return settle_modes(system.packed, t, q, v, a)


@compiled
def march_controlled(
    system: System,
    tableau: Tableau,
    records: RecorderState,
    control: Records,
    motion: Integration,
    end: float,
    most: int,
) -> int:
    """Integrate towards ``end`` for at most so many steps; returns how far it got."""
    n = system.size
    state = control[0]
    start_march(system, records, control, motion, most)
    # No step feels a contact before its touchdown, because steps end there.
    for k in range(records.onset.shape[0]):
        if records.onset[k] == 0.0:
            records.onset[k] = HELD_OPEN
    for _ in range(most):
        t = state.time
        left = end - t
        if left <= 0.0:
            return DONE
        longest = skim_step(system.packed, records.memory, state.longest)
        longest = step_after_touchdown(system.packed.joints, records.onset, records.memory, longest)
        h = min(step_to_break(records.motions, t, min(state.step, longest)), left)
        loaded = count_transitions(system.packed.loads) > 0
        if loaded:
            h = min(h, next_break(system.packed.loads) - t)
        last_step = h >= left
        for i in range(n):
            motion.scale[i] = state.tolerance * POSITION_SCALE
            motion.scale[n + i] = state.tolerance * (1.0 + abs(motion.y[n + i]))
        error = embedded_step(system, tableau, records.onset, motion, t, h)
        state.evaluations += tableau.b.shape[0]
        if not error <= 1.0:
            state.rejected += 1
            factor = LEAST_FACTOR
            if error < 1e30:
                factor = max(LEAST_FACTOR, SAFETY * error**tableau.exponent)
            state.step = h * factor
            if not state.step > state.shortest:
                return BROKEN if not error < 1e30 else STUCK
            continue
        factor = GREATEST_FACTOR if error == 0.0 else SAFETY * error**tableau.exponent
        state.step = h * min(max(factor, LEAST_FACTOR), GREATEST_FACTOR)
        joints = system.contacts.shape[0]
        # Not a literal, for which numba would compile the search for events twice.
        no_event = np.int64(-1)
        k, part = first_event(system, tableau, records, control, motion, t, h, no_event, joints)
        if k >= 0:
            k, located, is_located = end_on_event(
                system, tableau, records, control, motion, t, h, k, part, joints
            )
            if not is_located:
                # The cubic through both ends saw what is not there; a shorter one sees better.
                # The sliding of a pin that hardly presses on a worn arc is round-off.
                state.past_corners = k >= first_of_corners(system)
                state.rejected += 1
                state.step = h if state.past_corners else 0.5 * h
                if not state.step > state.shortest:
                    return STUCK
                continue
            h = located
            last_step = False
            state.events += 1
        state.past_corners = False
        t = end if last_step else t + h
        copy_to(motion.y, motion.trial)
        changed = settle_state_modes(system, t) if loaded else 0
        if 0 <= k < joints:
            rate = switch(system, records, k, t)
            part = contact_step(system.packed.joints[k], 0.0, rate, FIRST_PARTS)
            state.step = min(state.step, part)
        if state.projected:
            keep_constraints(system.held, t, motion.y)
        if state.projected or k >= 0 or changed > 0:
            rates(system, records.onset, t, motion.y, motion.slopes[0])
            state.evaluations += 1
        else:
            copy_to(motion.slopes[0], motion.slopes[tableau.b.shape[0]])
        finish_step(system, records, control, motion, t, h)
    return RUNNING


@compiled
def march_fixed(
    system: System,
    records: RecorderState,
    control: Records,
    motion: Integration,
    end: float,
    most: int,
) -> int:
    """Integrate with equal steps of order 4; contact state changes between steps only."""
    n = system.size
    state = control[0]
    start_march(system, records, control, motion, most)
    for _ in range(most):
        t = state.time
        left = end - t
        # A remainder of round-off is no step.
        if left <= 1e-9 * state.step:
            return DONE
        h = min(state.step, left)
        if state.due > t:
            h = min(state.due - t, left)
        whole = h
        h = min(step_to_break(records.motions, t, h), next_break(system.packed.loads) - t)
        trial_step(system, None, records, control, motion, t, h)
        k, part = first_event(system, None, records, control, motion, t, h, -1, 0)
        if k >= 0:
            k, located, is_located = end_on_event(
                system, None, records, control, motion, t, h, k, part, 0
            )
            if is_located:
                h = located
                state.events += 1
            else:
                trial_step(system, None, records, control, motion, t, h)
        copy_to(motion.y, motion.trial)
        # What is left of a step that was cut follows by itself.
        state.due = t + whole if h < whole else 0.0
        t = end if h >= left else t + h
        place(system, t, motion.y)
        accelerate(system, motion.slopes[last_slope(None)])
        settle_state_modes(system, t)
        for i in range(2 * n):
            if not abs(motion.y[i]) < 1e30:
                return BROKEN
        place(system, t, motion.y)
        q, v, _, _, _ = system.state
        note_contacts(records.packed, records.contacts, q, v)
        settle_state(records, t, LEAST_STEPS)
        if state.projected:
            keep_constraints(system.held, t, motion.y)
        rates(system, records.onset, t, motion.y, motion.slopes[0])
        finish_step(system, records, control, motion, t, h)
    return RUNNING
