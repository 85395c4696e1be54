"""The run loops: error-controlled with located touchdowns, and with equal steps.

Error-controlled: a touchdown or separation inside an accepted step is located by
repeating the step until it ends there, and the integration starts anew from it, so
that no step ever crosses a change of law.
"""

import numpy as np
from numpy.typing import NDArray

from presswear.engines.dae.dynamics import (
    DRIVE_INTEGRALS,
    JOINT_INTEGRALS,
    System,
    project,
    rates,
)
from presswear.engines.dae.runge_kutta import Integration, classical_step, embedded_step
from presswear.engines.dormand_prince import Tableau
from presswear.physics.constraints import DRIVE
from presswear.physics.contact import note_contact, note_contacts
from presswear.physics.forces import PRESSURE, WORK, note_forces
from presswear.physics.motion import step_to_break
from presswear.physics.touchdown import (
    LEAST_STEPS,
    contact_step,
    crossing,
    remember,
    separate,
    skim_step,
    step_after_touchdown,
    touch_down,
)
from presswear.record.observe import Book, observe, settle_state
from presswear.tools.compiled import Records, compiled, copy_to

Array = NDArray[np.float64]

RUNNING, DONE, BROKEN, STUCK = 0, 1, 2, 3

CONTROL = np.dtype(
    [
        ("time", np.float64),
        ("step", np.float64),  # next, s
        ("longest", np.float64),  # s
        ("shortest", np.float64),  # s
        ("tolerance", np.float64),
        ("projected", np.bool_),
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


@compiled
def penetration_of(system: System, k: int, y: Array) -> tuple[float, float]:
    """Penetration and its rate of joint ``k`` in a state."""
    n = system.inverse_mass.shape[0]
    contact = system.contacts[k]
    note_contact(system.packed, k, y[:n], y[n : 2 * n], contact)
    return contact.penetration, contact.rate


@compiled
def first_event(
    system: System, book: Book, trial: Array, h: float, apart: int
) -> tuple[int, float]:
    """Joint that touches down or separates first in a trial step, and at which part; or -1.

    Joint ``apart`` is not looked at.
    """
    found = -1
    part = 2.0
    for k in range(system.contacts.shape[0]):
        if k == apart:
            continue
        last = book.memory[k]
        depth, rate = penetration_of(system, k, trial)
        sign = -1.0 if book.onset[k] > 0.0 else 1.0
        start = min(sign * last.penetration, 0.0)
        s = crossing(start, sign * last.rate, sign * depth, sign * rate, h)
        # A state that was just placed on an event moves away from it and does not repeat it.
        if s < part and (s * h > 1e-14 or sign * last.rate > 0.0):
            found, part = k, s
    return found, part


@compiled
def locate(
    system: System,
    tableau: Tableau,
    book: Book,
    control: Records,
    motion: Integration,
    t: float,
    k: int,
    h: float,
    part: float,
) -> tuple[float, bool]:
    """Find the length of the step that ends where joint ``k`` has zero penetration, if any.

    Newton's method, held between the ends of a step of length ``h``: where the surface is
    steep it would stray to lengths whose error nobody has looked at.

    Parameters
    ----------
    part : float
        Part of the step to look at first.
    """
    sign = -1.0 if book.onset[k] > 0.0 else 1.0
    low, high = 0.0, h
    length = part * h
    for _ in range(NEWTON_STEPS):
        embedded_step(system, tableau, book.onset, motion, t, length)
        control[0].evaluations += tableau.b.shape[0]
        depth, rate = penetration_of(system, k, motion.trial)
        if abs(depth) <= EVENT_DEPTH:
            return length, True
        if sign * depth > 0.0:
            high = length
        else:
            low = length
        following = length - depth / rate if rate != 0.0 else -1.0
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - length) <= 1e-15:
            break
        length = following
    return length, abs(depth) <= FOUND_DEPTH


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
    for i in range(system.constraints.shape[0]):
        if system.constraints[i].kind == DRIVE:
            book.torque[drive] = -system.multipliers[system.constraints[i].row]
            drive += 1


@compiled
def finish_step(
    system: System, book: Book, control: Records, motion: Integration, t: float, h: float
) -> None:
    """Account for an accepted state in ``motion.y``, whose slopes are in ``slopes[0]``."""
    n = system.inverse_mass.shape[0]
    y = motion.y
    note_contacts(book.packed, book.contacts, y[:n], y[n : 2 * n])
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
    for row in range(system.phi.shape[0]):
        state.position_error = max(state.position_error, abs(system.phi[row]))
        state.velocity_error = max(state.velocity_error, abs(system.phi_t[row]))


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
    n = system.inverse_mass.shape[0]
    state = control[0]
    for _ in range(most):
        t = state.time
        left = end - t
        if left <= 0.0:
            return DONE
        longest = skim_step(system.packed, book.memory, state.longest)
        longest = step_after_touchdown(system.packed.joints, book.onset, book.memory, longest)
        h = min(step_to_break(system.motions, t, min(state.step, longest)), left)
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
        k, part = first_event(system, book, motion.trial, h, -1)
        factor = GREATEST_FACTOR if error == 0.0 else SAFETY * error**tableau.exponent
        state.step = h * min(max(factor, LEAST_FACTOR), GREATEST_FACTOR)
        if k >= 0:
            located, found = locate(system, tableau, book, control, motion, t, k, h, part)
            for _ in range(system.contacts.shape[0]):
                # The cubics may have seen events of two joints in the wrong order.
                earlier, part = first_event(system, book, motion.trial, located, k)
                if not found or earlier < 0:
                    break
                k = earlier
                located, found = locate(system, tableau, book, control, motion, t, k, located, part)
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
        if k >= 0:
            switch(system, book, k, t, motion.y)
            rate = penetration_of(system, k, motion.y)[1]
            part = contact_step(system.packed.joints[k], 0.0, rate, FIRST_PARTS)
            state.step = min(state.step, part)
        if state.projected:
            project(system, t, motion.y)
        if state.projected or k >= 0:
            rates(system, book.onset, t, motion.y, motion.slopes[0])
            state.evaluations += 1
        else:
            copy_to(motion.slopes[0], motion.slopes[tableau.b.shape[0]])
        finish_step(system, book, control, motion, t, h)
    return RUNNING


@compiled
def march_fixed(
    system: System, book: Book, control: Records, motion: Integration, end: float, most: int
) -> int:
    """Integrate with equal steps of order 4; contact state changes between steps only."""
    n = system.inverse_mass.shape[0]
    state = control[0]
    for _ in range(most):
        t = state.time
        left = end - t
        # A remainder of round-off is no step.
        if left <= 1e-9 * state.step:
            return DONE
        h = min(step_to_break(system.motions, t, state.step), left)
        classical_step(system, book.onset, motion, t, h)
        state.evaluations += 4
        copy_to(motion.y, motion.trial)
        t = end if h >= left else t + h
        for i in range(2 * n):
            if not abs(motion.y[i]) < 1e30:
                return BROKEN
        note_contacts(book.packed, book.contacts, motion.y[:n], motion.y[n : 2 * n])
        settle_state(book, t, LEAST_STEPS)
        if state.projected:
            project(system, t, motion.y)
        rates(system, book.onset, t, motion.y, motion.slopes[0])
        finish_step(system, book, control, motion, t, h)
    return RUNNING
