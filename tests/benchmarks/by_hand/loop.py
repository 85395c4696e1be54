"""Adaptive loop of the press by hand: DOPRI5 whose steps end on touchdowns and separations."""

import time as clock
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from by_hand.accounts import (
    CONTACT_COLUMNS,
    CONTACT_LOSS,
    CONTACTS,
    DEPTH,
    DOSE,
    DRIVES,
    EXCHANGE,
    FRICTION_LOSS,
    JOINTS,
    LOAD,
    RATE,
    WIDTH,
    WORK,
    Accounts,
    accounts_for,
    clear,
    note_contact,
    note_step,
    stored_energy,
    torques,
)
from by_hand.equations import OPEN, SIZE, accelerations, cranks
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

STAGES = 7
NEAR = 1e-14  # m, penetration at which a touchdown or a separation is located
NO_JOINT = -1  # of a step on which no touchdown or separation ends
LOCATING_STEPS = 5  # trial steps, at most, that locate a touchdown or a separation
NEXT_STEP, ATTEMPTED, EVALUATIONS = range(3)  # numbers in ``Loop.steps``


@compiled
def rates(press: Records, t: float, y: Array, onset: Array, out: Array) -> None:
    """Fill the rates of coordinates and velocities."""
    x = (y[0], y[1], y[2], y[3])
    u = (y[4], y[5], y[6], y[7])
    a, _, _, _, _ = accelerations(press, cranks(press, t), onset, x, u)
    for i in range(4):
        out[i] = u[i]
        out[4 + i] = a[i]


@compiled
def all_rates(
    press: Records, t: float, y: Array, onset: Array, out: Array, now: Array
) -> None:
    """Fill the rates of the whole state, and the contacts, shape (2, CONTACT_COLUMNS)."""
    x = (y[0], y[1], y[2], y[3])
    u = (y[4], y[5], y[6], y[7])
    at = cranks(press, t)
    a, _, one, two, levers = accelerations(press, at, onset, x, u)
    for i in range(4):
        out[i] = u[i]
        out[4 + i] = a[i]
    out[LOAD] = one.load
    out[LOAD + 1] = two.load
    out[DOSE] = one.pressure_load
    out[DOSE + 1] = two.pressure_load
    out[CONTACT_LOSS] = one.contact_loss + two.contact_loss
    out[FRICTION_LOSS] = one.friction_loss + two.friction_loss
    torque_2, torque_7 = torques(press, at, u, a, levers, one, two)
    power_2 = -press[0].speed * torque_2
    power_7 = press[0].speed * torque_7
    out[WORK] = power_2 + power_7
    out[EXCHANGE] = abs(power_2 + power_7)
    out[DRIVES] = torque_2
    out[DRIVES + 1] = torque_2 * torque_2
    out[DRIVES + 2] = power_2
    out[DRIVES + 3] = power_2 * power_2
    out[DRIVES + 4] = torque_7
    out[DRIVES + 5] = torque_7 * torque_7
    out[DRIVES + 6] = power_7
    out[DRIVES + 7] = power_7 * power_7
    note_contact(now[0], one)
    note_contact(now[1], two)


@compiled
def step(
    press: Records,
    t: float,
    h: float,
    y: Array,
    onset: Array,
    work: Array,
    now: Array,
    tolerance: float,
) -> float:
    """Step from ``y``, whose rates are ``work[0]``, to the last row; return its relative error."""
    k = work[:STAGES]
    z = work[STAGES]
    for i in range(SIZE):
        z[i] = y[i] + h * 0.2 * k[0, i]
    rates(press, t + 0.2 * h, z, onset, k[1])  # its weight is zero
    for i in range(SIZE):
        z[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    all_rates(press, t + 0.3 * h, z, onset, k[2], now)
    for i in range(SIZE):
        z[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    all_rates(press, t + 0.8 * h, z, onset, k[3], now)
    for i in range(SIZE):
        part = 19372 / 6561 * k[0, i] - 25360 / 2187 * k[1, i]
        z[i] = y[i] + h * (part + 64448 / 6561 * k[2, i] - 212 / 729 * k[3, i])
    all_rates(press, t + 8 / 9 * h, z, onset, k[4], now)
    for i in range(SIZE):
        part = 9017 / 3168 * k[0, i] - 355 / 33 * k[1, i] + 46732 / 5247 * k[2, i]
        z[i] = y[i] + h * (part + 49 / 176 * k[3, i] - 5103 / 18656 * k[4, i])
    all_rates(press, t + h, z, onset, k[5], now)
    for i in range(WIDTH):
        part = 35 / 384 * k[0, i] + 500 / 1113 * k[2, i] + 125 / 192 * k[3, i]
        z[i] = y[i] + h * (part - 2187 / 6784 * k[4, i] + 11 / 84 * k[5, i])
    all_rates(press, t + h, z, onset, k[6], now)
    worst = 0.0
    for i in range(SIZE):
        part = 71 / 57600 * k[0, i] - 71 / 16695 * k[2, i] + 71 / 1920 * k[3, i]
        part += -17253 / 339200 * k[4, i] + 22 / 525 * k[5, i] - 1 / 40 * k[6, i]
        worst = max(worst, abs(h * part) / (tolerance * (1.0 + abs(y[i]))))
    return worst


@compiled
def crossing(h: float, before: Array, after: Array) -> float:
    """Return the part of a step at which a penetration is zero, from a cubic through both ends."""
    low = 0.0
    high = 1.0
    if before[DEPTH] * after[DEPTH] >= 0.0:
        return 1.0
    for _ in range(50):
        s = 0.5 * (low + high)
        rest = 1.0 - s
        depth = rest * rest * ((1.0 + 2.0 * s) * before[DEPTH] + s * h * before[RATE])
        depth += s * s * ((1.0 + 2.0 * rest) * after[DEPTH] - rest * h * after[RATE])
        if depth * before[DEPTH] > 0.0:
            low = s
        else:
            high = s
    return high


class Loop(NamedTuple):
    """Arrays of the loop."""

    y: Array  # state, (WIDTH,)
    onset: Array  # stored closing speeds at A and C, m/s, or OPEN
    work: Array  # slopes of the stages, and the state on trial
    contacts: Array  # at both ends of the step, (2, 2, CONTACT_COLUMNS)
    steps: Array  # next step, s, attempted steps, and evaluations of the accelerations


@compiled
def march(
    press: Records,
    loop: Loop,
    accounts: Accounts,
    t: float,
    end: float,
    tolerance: float,
    longest: float,
) -> None:
    """Integrate to the end; steps end on touchdowns and separations."""
    y, onset, work, contacts, steps = loop
    k = work[:STAGES]
    z = work[STAGES]
    before = contacts[0]
    now = contacts[1]
    h = steps[NEXT_STEP]
    all_rates(press, t, y, onset, k[0], before)
    while t < end:
        h = min(h, longest)
        is_last = h >= end - t
        if is_last:
            h = end - t
        error = step(press, t, h, y, onset, work, now, tolerance)
        steps[ATTEMPTED] += 1.0
        steps[EVALUATIONS] += STAGES - 1
        if error > 1.0:
            h *= max(0.2, 0.9 * error**-0.2)
            continue
        following = h * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
        part = 2.0
        joint = NO_JOINT
        for i in range(2):
            if (now[i, DEPTH] > 0.0) != (onset[i] >= 0.0):
                at = crossing(h, before[i], now[i])
                if at < part:
                    part = at
                    joint = i
        if joint != NO_JOINT and part < 1.0:
            is_last = False
            h *= part
            for trial in range(LOCATING_STEPS):
                step(press, t, h, y, onset, work, now, tolerance)
                steps[EVALUATIONS] += STAGES - 1
                is_located = abs(now[joint, DEPTH]) < NEAR
                if is_located or trial == LOCATING_STEPS - 1:
                    break
                h -= now[joint, DEPTH] / now[joint, RATE]
        t = end if is_last else t + h
        for i in range(WIDTH):
            y[i] = z[i]
            k[0, i] = k[6, i]
        if joint != NO_JOINT:
            accounts.cycle[JOINTS + 3 * joint + CONTACTS] += onset[joint] >= 0.0
            onset[joint] = OPEN if onset[joint] >= 0.0 else max(now[joint, RATE], 0.0)
            all_rates(press, t, y, onset, k[0], now)
            steps[EVALUATIONS] += 1.0
        note_step(press, accounts, t, h, y, k[0], onset, contacts)
        for i in range(2):
            for column in range(CONTACT_COLUMNS):
                before[i, column] = now[i, column]
        h = following
    steps[NEXT_STEP] = h


class Outcome(NamedTuple):
    """Outcome of a run; the wear maps are those of all cycles."""

    states: Array  # at each end, (ends, WIDTH)
    cycles: Array  # rows, (ends, ROW)
    maps: Array  # m, (2, 2, BINS)
    accounts: Accounts
    residual: float  # of the balance of energy, J
    steps: int  # attempted, without those that locate events
    evaluations: int  # of the accelerations
    cpu: float  # s


def run(
    press: Records,
    start: Array,
    ends: Sequence[float],
    tolerance: float,
    longest: float,
    recorded: int = 1,
) -> Outcome:
    """Run to each end, s, with the accounts of each; rows of series in the recorded ones."""
    y = np.append(start, np.zeros(WIDTH - SIZE))
    work = np.zeros((STAGES + 1, WIDTH))
    contacts = np.zeros((2, 2, CONTACT_COLUMNS))
    loop = Loop(y, np.full(2, OPEN), work, contacts, np.array([1e-6, 0.0, 0.0]))
    accounts = accounts_for(ends[0], len(ends), recorded, float(start[2]))
    states = []
    rows = []
    maps = np.zeros_like(accounts.maps)
    t = 0.0
    stored = stored_energy(press, t, y, contacts[0])
    started = clock.process_time()
    for number, end in enumerate(ends):
        if number == recorded:
            accounts.counts[2] = 0
        march(press, loop, accounts, t, end, tolerance, longest)
        states.append(y.copy())
        rows.append(accounts.cycle.copy())
        maps += accounts.maps
        clear(accounts)
        t = end
    cpu = clock.process_time() - started
    stored = stored_energy(press, t, y, contacts[0]) - stored
    residual = float(y[WORK] - stored - y[CONTACT_LOSS] - y[FRICTION_LOSS])
    return Outcome(
        np.array(states),
        np.array(rows),
        maps,
        accounts,
        residual,
        int(loop.steps[ATTEMPTED]),
        int(loop.steps[EVALUATIONS]),
        cpu,
    )
