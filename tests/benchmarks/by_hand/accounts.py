"""Accounts of the hand-written loop: wear maps, peaks, energies, drives, film and series.

They hold what the engines record in each step, and share no kernel with them. The wear
is that of the conventions ``paper``: mean pressure times slip, in the bins that the
contact crosses in a step, in maps that do not turn with the bodies.
"""

import math
from typing import NamedTuple

import numpy as np

from by_hand.equations import Cranks, Four, Levers, Push, cranks
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

BINS = 360  # of a wear map
FRAMES = 500  # of the film in a cycle
ROWS = 2000  # of the series in a cycle, at least
ROOM = 40_000  # of the series in a cycle, at most
FORCE_STEP = 0.02  # change of a force, of its peak so far, at which a row is written
PEAK_STEPS = 12  # of the search for a peak

# Columns of a contact at the end of a step
DEPTH, RATE, NORMAL, TANGENTIAL, SLIDING, TURNING, EX, EY = range(8)
CONTACT_COLUMNS = 8
# Integrals in the state, behind coordinates and rates; load and pressure dose of each
# joint, and of each drive torque and power with their squares
LOAD = 8
DOSE = 10
CONTACT_LOSS = 12
FRICTION_LOSS = 13
WORK = 14
EXCHANGE = 15
DRIVES = 16
WIDTH = DRIVES + 8
# Row of a cycle; of each joint the peak force, load distance and contacts that ended
HIGHEST, SLOWEST, FASTEST, ACCELERATION, STEPS, JOINTS = range(6)
PEAK, DISTANCE, CONTACTS = range(3)
ROW = JOINTS + 6
BODIES = 6
FILM_JOINT = 6
SERIES_JOINT = 6


class Accounts(NamedTuple):
    """Arrays that the loop fills."""

    maps: Array  # depths of bearing and pin at A and C, m, (2, 2, BINS)
    cycle: Array  # (ROW,)
    film: Array  # time, places of the bodies, and columns of each joint
    # time, place, velocity and acceleration of the slider, and of each joint
    series: Array
    counts: Array  # frames, rows, and rows that may be written
    # times of the next frame and of the last row, s, their intervals, and start
    due: Array
    largest: Array  # force so far, N, (2,)


def accounts_for(period: float, cycles: int, recorded: int, start: float) -> Accounts:
    """Return empty accounts; ``start`` is the initial height of the slider, m."""
    film = np.zeros((cycles * FRAMES + 2, 1 + 3 * BODIES + 2 * FILM_JOINT))
    series = np.empty((recorded * ROOM, 4 + 2 * SERIES_JOINT))
    due = np.array([0.0, -math.inf, period / FRAMES, period / ROWS, start])
    counts = np.array([0, 0, len(series)])
    largest = np.zeros(2)
    accounts = Accounts(
        np.zeros((2, 2, BINS)), np.zeros(ROW), film, series, counts, due, largest
    )
    clear(accounts)
    return accounts


def clear(accounts: Accounts) -> None:
    """Begin a cycle."""
    accounts.maps[:] = 0.0
    accounts.cycle[:] = 0.0
    accounts.cycle[[HIGHEST, FASTEST]] = -math.inf
    accounts.cycle[SLOWEST] = math.inf


def stored_energy(press: Records, t: float, y: Array, contacts: Array) -> float:
    """Return kinetic, potential and elastic energy of plate, rods and slider, J."""
    p = press.view(np.recarray)[0]
    frame = np.zeros(1 + 3 * BODIES + 2 * FILM_JOINT)
    take_frame(press, frame[np.newaxis], 0, t, y, contacts)
    at = cranks(press, t)
    rod_3 = frame[4:6]
    plate = frame[7:9]
    rod_5 = frame[10:12]
    b = rod_3 - 0.5 * p.length_3 * np.array([math.cos(y[1]), math.sin(y[1])])
    d = np.array([at.x, at.y])
    d_t = np.array([at.vx, at.vy])
    plate_t = d_t + y[4] * perpendicular_to(plate - d)
    rod_3_t = d_t + y[4] * perpendicular_to(b - d) + y[5] * perpendicular_to(rod_3 - b)
    rod_5_t = np.array([0.0, y[6]]) + y[7] * perpendicular_to(rod_5 - [p.o2_x, y[2]])
    masses = p.mass_4, p.mass_3, p.mass_5, p.mass_6
    speeds = plate_t, rod_3_t, rod_5_t, np.array([0.0, y[6]])
    kinetic = sum(0.5 * m * float(v @ v) for m, v in zip(masses, speeds, strict=True))
    plate_inertia = p.plate_inertia - p.mass_4 * float((plate - d) @ (plate - d))
    plate_inertia -= p.mass_3 * float((b - d) @ (b - d))
    kinetic += 0.5 * plate_inertia * y[4] ** 2
    kinetic += 0.5 * (p.rod_3_inertia - 0.25 * p.mass_3 * p.length_3**2) * y[5] ** 2
    kinetic += 0.5 * (p.rod_5_inertia - 0.25 * p.mass_5 * p.length_5**2) * y[7] ** 2
    heights = plate[1], rod_3[1], rod_5[1], y[2], frame[2], frame[17]
    weights = np.array([*masses, p.mass_2, p.mass_7]) * p.gravity
    stiffness = np.array([p.a.stiffness, p.c.stiffness])
    elastic = 0.4 * stiffness * np.maximum(contacts[:, DEPTH], 0.0) ** 2.5
    return float(kinetic + weights @ heights + elastic.sum())


def perpendicular_to(vector: Array) -> Array:
    """Return a vector rotated by +90 degrees."""
    return np.array([-vector[1], vector[0]])


@compiled
def torques(
    press: Records, at: Cranks, u: Four, a: Four, levers: Levers, one: Push, two: Push
) -> tuple[float, float]:
    """Return the torques of cranks 2 and 7, N m, at constant speed."""
    p = press[0]
    square = p.speed * p.speed
    # Plate 4 and rod 3 hang from D, whose force is their mass times acceleration less
    # all others.
    bx = -square * at.x - a[0] * levers.by - u[0] * u[0] * levers.bx
    by = -square * at.y + a[0] * levers.bx - u[0] * u[0] * levers.by
    gx = -square * at.x - a[0] * levers.gy - u[0] * u[0] * levers.gx
    gy = -square * at.y + a[0] * levers.gx - u[0] * u[0] * levers.gy
    rx = bx - 0.5 * (a[1] * levers.ry + u[1] * u[1] * levers.rx)
    ry = by + 0.5 * (a[1] * levers.rx - u[1] * u[1] * levers.ry)
    force_x = p.mass_4 * gx + p.mass_3 * rx - one.x + two.x
    force_y = p.mass_4 * (gy + p.gravity) + p.mass_3 * (ry + p.gravity) - one.y + two.y
    seven = at.x * force_y - at.y * force_x + 0.5 * p.mass_7 * p.gravity * at.x
    x = one.at_x - p.o2_x
    y = one.at_y - p.o2_y
    two_ = x * one.y - y * one.x + 0.5 * p.mass_2 * p.gravity * (at.pin_x - p.o2_x)
    return two_, seven


@compiled
def note_contact(row: Array, push: Push) -> None:
    """Fill the row of a contact."""
    row[DEPTH] = push.depth
    row[RATE] = push.rate
    row[NORMAL] = push.normal
    row[TANGENTIAL] = push.tangential
    row[SLIDING] = push.sliding
    row[TURNING] = push.turning
    row[EX] = push.ex
    row[EY] = push.ey


@compiled
def deposit(maps: Array, joint: Records, contact: Array, dose: float, h: float) -> None:
    """Spread the depth of a dose, N/m, over the bins that the contact crosses in a step."""
    end = math.atan2(contact[EY], contact[EX]) * (BINS / (2.0 * math.pi))
    start = end - h * contact[TURNING] * (BINS / (2.0 * math.pi))
    low = min(start, end)
    high = max(start, end)
    first = math.floor(low)
    last = math.floor(high)
    depth = joint.wear_coefficient * dose
    bearing = joint.bearing_share * depth
    pin = (1.0 - joint.bearing_share) * depth
    if first == last:
        maps[0, first % BINS] += bearing
        maps[1, first % BINS] += pin
        return
    for k in range(first, last + 1):
        part = (min(high, k + 1.0) - max(low, float(k))) / (high - low)
        maps[0, k % BINS] += bearing * part
        maps[1, k % BINS] += pin * part


@compiled
def force_and_slope(
    joint: Records, onset: float, h: float, before: Array, now: Array, s: float
) -> tuple[float, float]:
    """Return the normal force, N, and its slope's sign at a part of a step, on a cubic."""
    rise = now[DEPTH] - before[DEPTH]
    a = h * before[RATE]
    b = h * now[RATE]
    curve = 3.0 * rise - 2.0 * a - b
    twist = a + b - 2.0 * rise
    depth = before[DEPTH] + s * (a + s * (curve + s * twist))
    rate = a + s * (2.0 * curve + s * 3.0 * twist)
    curvature = 2.0 * curve + 6.0 * s * twist
    factor = joint.damping / (h * onset)
    root = math.sqrt(max(depth, 0.0))
    force = joint.stiffness * depth * root * (1.0 + factor * rate)
    return force, 1.5 * rate * (1.0 + factor * rate) + depth * factor * curvature


@compiled
def peak_within(
    joint: Records, onset: float, h: float, before: Array, now: Array
) -> float:
    """Return the largest normal force in a step, N, if it is not at an end; else 0."""
    if not (onset >= 0.0 and before[DEPTH] > 0.0 and now[DEPTH] > 0.0):
        return 0.0
    closing = max(onset, 1e-6)
    if force_and_slope(joint, closing, h, before, now, 0.0)[1] <= 0.0:
        return 0.0
    if force_and_slope(joint, closing, h, before, now, 1.0)[1] >= 0.0:
        return 0.0
    low = 0.0
    high = 1.0
    force = 0.0
    for _ in range(PEAK_STEPS):
        middle = 0.5 * (low + high)
        force, slope = force_and_slope(joint, closing, h, before, now, middle)
        if slope > 0.0:
            low = middle
        else:
            high = middle
    return force


@compiled
def take_frame(
    press: Records, film: Array, frame: int, t: float, y: Array, now: Array
) -> None:
    """Fill the frame of a film: mass centres and angles of the bodies, and the contacts."""
    p = press[0]
    row = film[frame]
    at = cranks(press, t)
    cosine = math.cos(y[0])
    sine = math.sin(y[0])
    bx = cosine * p.b_x - sine * p.b_y
    by = sine * p.b_x + cosine * p.b_y
    rx = p.length_3 * math.cos(y[1])
    ry = p.length_3 * math.sin(y[1])
    row[0] = t
    row[1] = 0.5 * (at.pin_x + p.o2_x)
    row[2] = 0.5 * (at.pin_y + p.o2_y)
    row[3] = p.start_2 - p.speed * t
    row[4] = at.x + bx + 0.5 * rx
    row[5] = at.y + by + 0.5 * ry
    row[6] = y[1]
    row[7] = at.x + cosine * p.centre_x - sine * p.centre_y
    row[8] = at.y + sine * p.centre_x + cosine * p.centre_y
    row[9] = y[0]
    row[10] = p.o2_x + 0.5 * p.length_5 * math.cos(y[3])
    row[11] = y[2] + 0.5 * p.length_5 * math.sin(y[3])
    row[12] = y[3]
    row[13] = p.o2_x
    row[14] = y[2]
    row[15] = 0.5 * math.pi
    row[16] = 0.5 * at.x
    row[17] = 0.5 * at.y
    row[18] = p.start_7 + p.speed * t
    for k in range(2):
        base = 1 + 3 * BODIES + FILM_JOINT * k
        length = math.sqrt(now[k, EX] * now[k, EX] + now[k, EY] * now[k, EY])
        row[base] = now[k, NORMAL]
        row[base + 1] = now[k, TANGENTIAL]
        if length > 0.0:
            row[base + 2] = now[k, EX] / length
            row[base + 3] = now[k, EY] / length
        row[base + 4] = now[k, DEPTH]


@compiled
def write_row(
    accounts: Accounts, t: float, y: Array, slopes: Array, now: Array
) -> None:
    """Write a row of the series if one is due."""
    due = accounts.due
    counts = accounts.counts
    row = accounts.counts[1]
    is_due = t - due[1] >= due[3]
    if not is_due:
        for k in range(2):
            last = accounts.series[row - 1, 4 + SERIES_JOINT * k + 3]
            is_due |= abs(now[k, NORMAL] - last) > FORCE_STEP * accounts.largest[k]
    if not is_due:
        return
    target = accounts.series[row]
    target[0] = t
    target[1] = y[2] - due[4]
    target[2] = y[6]
    target[3] = slopes[6]
    for k in range(2):
        base = 4 + SERIES_JOINT * k
        target[base] = now[k, EX]
        target[base + 1] = now[k, EY]
        target[base + 2] = now[k, DEPTH]
        target[base + 3] = now[k, NORMAL]
        target[base + 4] = now[k, TANGENTIAL]
        target[base + 5] = now[k, SLIDING]
    counts[1] += 1
    due[1] = t


@compiled
def note_step(
    press: Records,
    accounts: Accounts,
    t: float,
    h: float,
    y: Array,
    slopes: Array,
    onset: Array,
    contacts: Array,
) -> None:
    """Account for a step; ``contacts`` are those at both ends, (2, 2, CONTACT_COLUMNS)."""
    cycle = accounts.cycle
    due = accounts.due
    counts = accounts.counts
    before = contacts[0]
    now = contacts[1]
    cycle[HIGHEST] = max(cycle[HIGHEST], y[2] - due[4])
    cycle[SLOWEST] = min(cycle[SLOWEST], y[6])
    cycle[FASTEST] = max(cycle[FASTEST], y[6])
    cycle[ACCELERATION] = max(cycle[ACCELERATION], abs(slopes[6]))
    cycle[STEPS] += 1.0
    frame = counts[0]
    for k in range(2):
        joint = press[0].a if k == 0 else press[0].c
        base = JOINTS + 3 * k
        peak = max(now[k, NORMAL], peak_within(joint, onset[k], h, before[k], now[k]))
        cycle[base + PEAK] = max(cycle[base + PEAK], peak)
        accounts.largest[k] = max(accounts.largest[k], peak)
        place = 1 + 3 * BODIES + FILM_JOINT * k + 5
        accounts.film[frame, place] = max(accounts.film[frame, place], peak)
        cycle[base + DISTANCE] += y[LOAD + k]
        if y[DOSE + k] > 0.0:
            deposit(accounts.maps[k], joint, now[k], y[DOSE + k], h)
        y[LOAD + k] = 0.0
        y[DOSE + k] = 0.0
    if t >= due[0]:
        take_frame(press, accounts.film, frame, t, y, now)
        while due[0] <= t:
            due[0] += due[2]
        counts[0] = min(frame + 1, accounts.film.shape[0] - 1)
    if counts[1] < counts[2]:
        write_row(accounts, t, y, slopes, now)
