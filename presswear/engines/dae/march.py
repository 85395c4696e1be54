"""The run loops: error-controlled with located touchdowns, and with equal steps.

Error-controlled: a touchdown or separation inside an accepted step is located by
repeating the step until it ends there, and the integration starts anew from it, so
that no step ever crosses a change of law.  A load's law changes in the same way, with equal
steps too: one of them is cut in two where it does.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import (
    DRIVE_INTEGRALS,
    JOINT_INTEGRALS,
    System,
    note_bristles,
    rates,
)
from presswear.engines.dae.runge_kutta import Integration, classical_step, embedded_step
from presswear.engines.dormand_prince import Tableau
from presswear.physics.applied import settle_modes
from presswear.physics.constraints import DRIVE
from presswear.physics.contact import note_contact, note_contacts
from presswear.physics.forces import PRESSURE, WORK, note_forces
from presswear.physics.loads import Loads, count_ways, next_break, way_out
from presswear.physics.motion import step_to_break
from presswear.physics.multipliers import project
from presswear.physics.steps import contact_step, skim_step, step_after_touchdown
from presswear.physics.touchdown import LEAST_STEPS, crossing, remember, separate, touch_down
from presswear.record.observe import Book, observe, settle_state
from presswear.tools.compiled import Records, compiled, copy_to

Array = NDArray[np.float64]

RUNNING, DONE, BROKEN, STUCK = 0, 1, 2, 3

CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("step", np.float64),  # next, s
        ("due", np.float64),  # time at which an equal step that was cut is to end, s; or 0
        ("longest", np.float64),  # s
        ("shortest", np.float64),  # s
        ("tolerance", np.float64),
        ("projected", np.bool_),
        ("begun", np.bool_),  # the start is accounted for
        ("known", np.bool_),  # ... and the slopes of the state are
        ("steps", np.int64),
        ("rejected", np.int64),
        ("events", np.int64),
        ("evaluations", np.int64),  # of the accelerations
        ("position_error", np.float64),  # greatest |Phi|
        ("velocity_error", np.float64),  # greatest |dPhi/dt|
    ]
)
"""State of an integration."""

POSITION_SCALE = 1e-3
"""The tolerance times this is the error allowed in a position, m or rad, per step."""
FIRST_PARTS = 40.0
"""First step behind a touchdown, as a part of the expected contact."""
SAFETY, LEAST_FACTOR, GREATEST_FACTOR = 0.9, 0.2, 5.0
NEWTON_STEPS = 60
"""Most repetitions that locate an event; four do, halving helps where Newton strays."""
EVENT_DEPTH = 1e-17
"""Penetration at which an event is located, m."""
FOUND_DEPTH = 1e-12
"""Penetration up to which a place that round-off keeps from it is one, m."""
CLASSICAL_STAGES = 4
"""Evaluations in a step of the classical method."""
BEHIND = 1e-13
"""A step that ends on a change of a load's law goes so far behind it, m, rad, m/s or rad/s."""
FOUND_BEHIND = 1e-9
"""... and so far where round-off keeps it from ending sooner."""


@compiled
def penetration_of(system: System, k: int, y: Array) -> tuple[float, float]:
    """Penetration and its rate of joint ``k`` in a state."""
    n = system.held.inverse_mass.shape[0]
    contact = system.contacts[k]
    note_contact(system.packed, k, y[:n], y[n : 2 * n], contact)
    return contact.penetration, contact.rate


@compiled
def event_value(system: System, book: Book, k: int, y: Array, slope: Array) -> tuple[float, float]:
    """Switching function of event ``k`` in a state, and its rate.

    Events are those of the joints, then the ways out of the modes of the loads.
    """
    joints = system.contacts.shape[0]
    if k < joints:
        depth, rate = penetration_of(system, k, y)
        return (-depth, -rate) if book.onset[k] > 0.0 else (depth, rate)
    n = system.held.inverse_mass.shape[0]
    return way_out(system.packed.loads, k - joints, y[:n], y[n : 2 * n], slope[n : 2 * n])


@compiled
def event_count(system: System) -> int:
    """Number of events that are looked for."""
    return system.contacts.shape[0] + count_ways(system.packed.loads)


@compiled
def first_change(
    loads: Loads | None,
    system: System,
    book: Book,
    motion: Integration,
    last: int,
    h: float,
    apart: int,
) -> tuple[int, float]:
    """Change of a load's law that comes first in a trial step, and at which part; or -1.

    Parameters
    ----------
    last : int
        Which of the slopes is that at the end of the trial step.
    apart : int
        Event that is not looked at.
    """
    found = -1
    part = 2.0
    if loads is None:
        return found, part
    for k in range(system.contacts.shape[0], event_count(system)):
        value, rate = event_value(system, book, k, motion.trial, motion.slopes[last])
        if k == apart or value == -math.inf:
            continue
        start, first_rate = event_value(system, book, k, motion.y, motion.slopes[0])
        # What goes no further behind is round-off, or comes with that on which the step ends.
        reach = 2.0 * BEHIND
        s = crossing(min(start, 0.0) - reach, first_rate, value - reach, rate, h)
        if s < part and (s * h > 1e-14 or first_rate > 0.0):
            found, part = k, s
    return found, part


@compiled
def first_event(
    system: System,
    book: Book,
    motion: Integration,
    last: int,
    h: float,
    apart: int,
    joints: int,
) -> tuple[int, float]:
    """Joint that touches down or separates first in a trial step, and at which part; or -1.

    Where a load's law changes sooner, it is that event; see ``first_change``.

    Parameters
    ----------
    joints : int
        Number of joints that are looked at.
    """
    trial = motion.trial
    found = -1
    part = 2.0
    for k in range(joints):
        if k == apart:
            continue
        memory = book.memory[k]
        depth, rate = penetration_of(system, k, trial)
        sign = -1.0 if book.onset[k] > 0.0 else 1.0
        start = min(sign * memory.penetration, 0.0)
        s = crossing(start, sign * memory.rate, sign * depth, sign * rate, h)
        # A state that was just placed on an event moves away from it and does not repeat it.
        if s < part and (s * h > 1e-14 or sign * memory.rate > 0.0):
            found, part = k, s
    k, s = first_change(system.packed.loads, system, book, motion, last, h, apart)
    return (k, s) if s < part else (found, part)


@compiled
def trial_step(
    system: System,
    tableau: Tableau | None,
    book: Book,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
) -> float:
    """Make one trial step, without a tableau a classical one; returns its error, 1 is allowed."""
    # The compiler leaves out the branch that is not taken.
    if tableau is None:
        control[0].evaluations += CLASSICAL_STAGES
        classical_step(system, book.onset, motion, t, h)
        return 0.0
    control[0].evaluations += tableau.b.shape[0]
    return embedded_step(system, tableau, book.onset, motion, t, h)


@compiled
def locate(
    system: System,
    tableau: Tableau | None,
    book: Book,
    control: Records,
    motion: Integration,
    t: float,
    k: int,
    h: float,
    part: float,
) -> tuple[float, bool]:
    """Find the length of the step that ends on event ``k``, if any.

    A joint then has zero penetration, a load is just behind the change of its law.

    Newton's method, held between the ends of a step of length ``h``: where the surface is
    steep it would stray to lengths whose error nobody has looked at.

    Parameters
    ----------
    part : float
        Part of the step to look at first.
    """
    aim, near, found = 0.0, EVENT_DEPTH, FOUND_DEPTH
    if k >= system.contacts.shape[0]:
        aim, near, found = BEHIND, 0.5 * BEHIND, FOUND_BEHIND
    end = motion.slopes[last_slope(tableau)]
    low, high = 0.0, h
    length = part * h
    is_last = False
    for _ in range(NEWTON_STEPS):
        trial_step(system, tableau, book, control, motion, t, length)
        value, rate = event_value(system, book, k, motion.trial, end)
        value -= aim
        if abs(value) <= near or is_last:
            break
        if value > 0.0:
            high = length
        else:
            low = length
        following = length - value / rate if rate != 0.0 else -1.0
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - length) <= 1e-15:
            if aim == 0.0 or value > 0.0:
                break
            # Round-off keeps it from ending just behind: the nearest that is behind.
            following, is_last = high, True
        length = following
    if aim > 0.0:
        return length, -near <= value <= found
    return length, abs(value) <= found


@compiled
def last_slope(tableau: Tableau | None) -> int:
    """Which of the slopes of a step is that at its end."""
    if tableau is None:
        return CLASSICAL_STAGES - 1
    return tableau.b.shape[0]


@compiled
def end_on_event(
    system: System,
    tableau: Tableau | None,
    book: Book,
    control: Records,
    motion: Integration,
    t: float,
    h: float,
    k: int,
    part: float,
    joints: int,
) -> tuple[int, float, bool]:
    """Find the step that ends on the first event of a trial step of length ``h``.

    Parameters
    ----------
    k, part, joints : int, float, int
        The event as ``first_event`` tells it, and the joints that are looked at.

    Returns
    -------
    tuple
        The event, the length of the step, s, and whether it is there.
    """
    located, found, earlier = h, True, k
    # The cubics may see events of two joints in the wrong order.
    for _ in range(1 + event_count(system)):
        if earlier < 0:
            break
        k = earlier
        located, found = locate(system, tableau, book, control, motion, t, k, located, part)
        if not found:
            break
        last = last_slope(tableau)
        earlier, part = first_event(system, book, motion, last, located, k, joints)
    return k, located, found


@compiled
def switch(system: System, book: Book, k: int, t: float, y: Array) -> None:
    """Open or close joint ``k`` in a state placed on the event."""
    rate = penetration_of(system, k, y)[1]
    if book.onset[k] > 0.0:
        separate(book.memory[k], book.tally[k], book.past[k], book.onset[k], t, rate, 0)
        book.onset[k] = 0.0
    else:
        book.onset[k] = max(rate, 1e-300)
        touch_down(book.memory[k], t, False)


@compiled
def note_torques(system: System, book: Book) -> None:
    """Note the torques of the drives in the state whose slopes were evaluated last."""
    drive = 0
    for i in range(system.held.constraints.shape[0]):
        if system.held.constraints[i].kind == DRIVE:
            book.torque[drive] = -system.held.multipliers[system.held.constraints[i].row]
            drive += 1


@compiled
def finish_step(
    system: System, book: Book, control: Records, motion: Integration, t: float, h: float
) -> None:
    """Account for an accepted state in ``motion.y``, whose slopes are in ``slopes[0]``."""
    n = system.held.inverse_mass.shape[0]
    y = motion.y
    note_contacts(book.packed, book.contacts, y[:n], y[n : 2 * n])
    note_bristles(book.contacts, y, n)
    note_forces(book.packed.joints, book.onset, book.contacts)
    for k in range(system.contacts.shape[0]):
        base = 2 * n + DRIVE_INTEGRALS + JOINT_INTEGRALS * k
        # Integrals are emptied into the account, so that they never lose digits.
        book.doses[k].work = y[base + WORK]
        book.doses[k].pressure = y[base + PRESSURE]
        y[base + WORK] = y[base + PRESSURE] = 0.0
        last = book.memory[k]
        remember(last, book.packed.joints[k], book.contacts[k], t)
        if book.onset[k] > 0.0:
            last.steps += 1
    note_torques(system, book)
    observe(book, t, h, y[:n], y[n : 2 * n], motion.slopes[0, n : 2 * n])
    state = control[0]
    state.time = t
    state.steps += 1
    for row in range(system.held.phi.shape[0]):
        state.position_error = max(state.position_error, abs(system.held.phi[row]))
        state.velocity_error = max(state.velocity_error, abs(system.held.phi_t[row]))


@compiled
def begin(system: System, book: Book, control: Records, motion: Integration) -> None:
    """Account for the start, once, and find the slopes of a state where they are not known."""
    n = system.held.inverse_mass.shape[0]
    state, y, slope = control[0], motion.y, motion.slopes[0]
    if not state.known:
        rates(system, book.onset, state.time, y, slope)
        state.known = True
    if not state.begun:
        note_torques(system, book)
        note_contacts(book.packed, book.contacts, y[:n], y[n : 2 * n])
        settle_state(book, 0.0, LEAST_STEPS)
        observe(book, 0.0, 0.0, y[:n], y[n : 2 * n], slope[n : 2 * n])
        state.begun = True


@compiled
def until_break(system: System, t: float) -> float:
    """Time to the next bend over time of a load, s."""
    return next_break(system.packed.loads) - t


@compiled
def settle_state_modes(
    system: System, tableau: Tableau | None, motion: Integration, t: float
) -> int:
    """Bring the loads' modes up to a state just accepted; returns how many have changed."""
    n = system.held.inverse_mass.shape[0]
    y = motion.y
    slope = motion.slopes[last_slope(tableau)]
    return settle_modes(system.packed, t, y[:n], y[n : 2 * n], slope[n : 2 * n])


@compiled
def march_controlled(
    system: System,
    tableau: Tableau,
    book: Book,
    control: Records,
    motion: Integration,
    end: float,
    most: int,
) -> int:
    """Integrate towards ``end`` for at most so many steps; returns how far it got."""
    n = system.held.inverse_mass.shape[0]
    state = control[0]
    begin(system, book, control, motion)
    for _ in range(most):
        t = state.time
        left = end - t
        if left <= 0.0:
            return DONE
        longest = skim_step(system.packed, book.memory, state.longest)
        longest = step_after_touchdown(system.packed.joints, book.onset, book.memory, longest)
        h = min(step_to_break(system.held.motions, t, min(state.step, longest)), left)
        loaded = count_ways(system.packed.loads) > 0
        if loaded:
            h = min(h, until_break(system, t))
        last_step = h >= left
        for i in range(n):
            motion.scale[i] = state.tolerance * POSITION_SCALE
            motion.scale[n + i] = state.tolerance * (1.0 + abs(motion.y[n + i]))
        error = embedded_step(system, tableau, book.onset, motion, t, h)
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
        k, part = first_event(system, book, motion, tableau.b.shape[0], h, -1, joints)
        if k >= 0:
            k, located, found = end_on_event(
                system, tableau, book, control, motion, t, h, k, part, joints
            )
            if not found:
                # The cubic through both ends saw what is not there; a shorter one sees better.
                state.rejected += 1
                state.step = 0.5 * h
                if not state.step > state.shortest:
                    return STUCK
                continue
            h = located
            last_step = False
            state.events += 1
        t = end if last_step else t + h
        copy_to(motion.y, motion.trial)
        changed = settle_state_modes(system, tableau, motion, t) if loaded else 0
        if 0 <= k < joints:
            switch(system, book, k, t, motion.y)
            rate = penetration_of(system, k, motion.y)[1]
            part = contact_step(system.packed.joints[k], 0.0, rate, FIRST_PARTS)
            state.step = min(state.step, part)
        if state.projected:
            project(system.held, t, motion.y[:n], motion.y[n : 2 * n])
        if state.projected or k >= 0 or changed > 0:
            rates(system, book.onset, t, motion.y, motion.slopes[0])
            state.evaluations += 1
        else:
            copy_to(motion.slopes[0], motion.slopes[tableau.b.shape[0]])
        finish_step(system, book, control, motion, t, h)
    return RUNNING


@compiled
def march_fixed(
    system: System,
    book: Book,
    control: Records,
    motion: Integration,
    end: float,
    most: int,
) -> int:
    """Integrate with equal steps of order 4; contact state changes between steps only."""
    n = system.held.inverse_mass.shape[0]
    state = control[0]
    begin(system, book, control, motion)
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
        h = min(step_to_break(system.held.motions, t, h), until_break(system, t))
        trial_step(system, None, book, control, motion, t, h)
        k, part = first_event(system, book, motion, last_slope(None), h, -1, 0)
        if k >= 0:
            k, located, found = end_on_event(system, None, book, control, motion, t, h, k, part, 0)
            if found:
                h = located
                state.events += 1
            else:
                trial_step(system, None, book, control, motion, t, h)
        copy_to(motion.y, motion.trial)
        # What is left of a step that was cut follows by itself.
        state.due = t + whole if h < whole else 0.0
        t = end if h >= left else t + h
        settle_state_modes(system, None, motion, t)
        for i in range(2 * n):
            if not abs(motion.y[i]) < 1e30:
                return BROKEN
        note_contacts(book.packed, book.contacts, motion.y[:n], motion.y[n : 2 * n])
        settle_state(book, t, LEAST_STEPS)
        if state.projected:
            project(system.held, t, motion.y[:n], motion.y[n : 2 * n])
        rates(system, book.onset, t, motion.y, motion.slopes[0])
        finish_step(system, book, control, motion, t, h)
    return RUNNING
