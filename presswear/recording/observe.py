"""Compiled recording of a run, step by step: series, contacts, peaks, drives and wear.

Memory does not grow with the number of cycles: series and single contacts are recorded
in the first cycles only; everything else is one row per cycle or a running sum.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import lever
from presswear.physics.load_transitions import last_change
from presswear.physics.packed import Packed
from presswear.physics.pressure_wear import deposit_by_pressure
from presswear.physics.wall_wear import deposit_on_wall
from presswear.physics.wear import deposit_in_bins, deposit_over_arc
from presswear.recording.columns import (
    ACCELERATION,
    ACCELERATION_MAX,
    BOTTOM_HEIGHT,
    BOTTOM_TIME,
    CLOSED_TIME,
    CONTACTS,
    CYCLE_COUNT,
    DISPLACEMENT,
    DISPLACEMENT_MAX,
    DRIVE_CYCLE_COUNT,
    ECCENTRICITY_X,
    ECCENTRICITY_Y,
    FILM_LOSS,
    FORCE_MAX,
    GIVEN,
    JOINT_CYCLE_COUNT,
    JOINT_SERIES_COUNT,
    LEADER_SERIES_COUNT,
    LEADER_SPEED_MAX,
    LEADER_SPEED_MIN,
    LEAST_FILM,
    LOAD_DISTANCE,
    NORMAL,
    PENETRATION,
    POWER_PEAK,
    POWER_SQUARE,
    RETURNED,
    SERIES_COUNT,
    SLIDING,
    STEPS,
    TANGENTIAL,
    TIME,
    TORQUE,
    TORQUE_PEAK,
    TORQUE_SQUARE,
    VELOCITY,
    VELOCITY_MAX,
    VELOCITY_MIN,
)
from presswear.recording.film import take_frame
from presswear.recording.nominal_time import (
    nominal_rate,
    nominal_time,
    nominal_within,
    note_nominal,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

ROWS_AT_LEAST = 2000  # series rows in a cycle without contact
ROWS_AT_MOST = 40_000  # room for series rows, per recorded cycle
ROWS_IN_ALL = 4_000_000  # room for series rows, of all recorded cycles
CONTACTS_AT_MOST = 5000  # room for single contacts, per joint and recorded cycle
BOTTOM_STEPS = 60  # largest number of Newton steps for the lowest position in a step
BOTTOM_NOISE = 1e-14  # round-off of an instant, as a fraction of a step
# Change of a force after which a row is written, as a fraction of its peak so far
FORCE_STEP = 0.02

# Wear integrals of a joint over one step
WEAR_INTEGRALS = np.dtype(
    [
        ("work", np.float64),  # F_n ds, N m
        # p ds, N/m; with wear over the arc see ``physics.pressure_wear``, N m
        ("pressure", np.float64),
        # rates at the end of the step, only filled by exudyn-joints
        ("work_rate", np.float64),  # W
        ("pressure_rate", np.float64),  # W/m^2
    ]
)

# A drive in the recording; engines fill the integrals before they call ``observe``
DRIVE = np.dtype(
    [
        ("torque", np.float64),  # in the last accepted state, N m
        ("power", np.float64),  # W
        ("torque_integral", np.float64),  # over the last step, N m s
        ("torque_square_integral", np.float64),  # (N m)^2 s
        ("work", np.float64),  # J
        ("power_square_integral", np.float64),  # W^2 s
    ]
)

# Output point, its last state, and the sampling of series
OUTPUT = np.dtype(
    [
        ("rows", np.int64),  # series rows written
        ("last_time", np.float64),  # of the last row, s
        ("now", np.float64),  # of the last accepted state, s
        ("interval", np.float64),  # longest time between two rows, s
        ("force_step", np.float64),  # see FORCE_STEP
        ("index", np.int64),  # of the x of the output body in q
        ("cos", np.float64),  # of the direction of the output
        ("sin", np.float64),
        ("x", np.float64),  # output point in the axes of its body, m
        ("y", np.float64),
        ("start", np.float64),  # output coordinate at the start, m
        ("room", np.int64),  # largest number of rows
        ("place", np.float64),  # output coordinate in the last state, m
        ("velocity", np.float64),  # m/s
        ("acceleration", np.float64),  # m/s^2
        ("bottom", np.float64),  # lowest position in the present stroke so far, m
        ("bottom_time", np.float64),  # nominal time of this position, s
        # nominal times between which the bottom is searched for, s
        ("stroke_begin", np.float64),
        ("stroke_end", np.float64),
        ("stroke_length", np.float64),  # s
        ("period", np.float64),  # from one stroke to the next, s
    ]
)


# A guide with a spring. Its stretch is recorded: the coordinate of its body along the
# guide, minus that of the point of the guide.
GUIDE = np.dtype(
    [
        ("index", np.int64),  # of the x of the body in q
        ("cos", np.float64),
        ("sin", np.float64),
        ("point", np.float64),  # m
    ]
)
# An elastic pin, the distance of whose centres is recorded
PIN = np.dtype(
    [
        ("first", np.int64),  # of the x of the body of its bearing in q; -1: ground
        ("first_x", np.float64),  # in the frame of this body, m
        ("first_y", np.float64),
        ("second", np.int64),  # of the x of the body of the pin in q; -1: ground
        ("second_x", np.float64),
        ("second_y", np.float64),
    ]
)
FRAME_ROWS = 40  # of a series, at least, in a period of an elastic frame


class RecorderState(NamedTuple):
    """Recorder state: arrays that the kernels fill during one run."""

    packed: Packed  # the linkage
    motions: Records  # of MOTION, of its drives
    contacts: Records  # of CONTACT, with their forces, in the last accepted state
    onset: Array  # latched closing speeds of the joints, 0 where open, m/s
    memory: Records  # of MEMORY
    counters: Records  # of COUNTERS
    stored_contacts: Records  # of STORED_CONTACT, shape (joints, rows)
    output: Records  # one of OUTPUT
    # Rows of SERIES, of JOINT_SERIES for each joint, of torques where they are stored,
    # and of LEADER_SERIES where a motor turns the linkage
    series: Array
    film: Array  # see ``presswear.recording.film``
    sampler: Records  # one of FRAME_SAMPLER
    nominal: Records  # one of NOMINAL
    cycle: Array  # row of the present cycle, see ``cycle_columns``
    # depth that the present cycle added, m, (joints, 2, m), see ``map_shape``
    depth: Array
    # first columns of FILM_CYCLE in this row, of each joint; -1 without a film
    film_columns: NDArray[np.int64]
    film_losses: Array  # power in the last accepted state, W, of each joint
    wear_integrals: Records  # of WEAR_INTEGRALS, over the last step
    shares: Array  # working space of ``deposit_over_arc``, (2, m)
    torque: Array  # of the drives in the present state, N m
    drives: Records  # of DRIVE
    # Energies in the order of ENERGIES, J, and their rates in the last state, W; only
    # filled by exudyn-joints, which integrates them step by step
    energies: Array
    powers: Array
    guides: Records  # of GUIDE, with a spring
    pins: Records  # of PIN, elastic
    # of the guides, then of the pins, in the rows of the series, m
    stretches: Array
    angle_indices: NDArray[np.int64]  # of the drives in q, with a motor
    # their angles, rad, and speeds, rad/s, in the rows of the series, (rows, 2, drives)
    turns: Array


@inlined
def output_motion(
    state: Records, q: Array, v: Array, a: Array
) -> tuple[float, float, float]:
    """Return position, m, velocity and acceleration of the output along its direction."""
    i = state.index
    nx = state.cos
    ny = state.sin
    position: float = nx * q[i] + ny * q[i + 1]
    velocity: float = nx * v[i] + ny * v[i + 1]
    acceleration: float = nx * a[i] + ny * a[i + 1]
    if state.x != 0.0 or state.y != 0.0:
        rx, ry = lever(i, state.x, state.y, q)
        omega = v[i + 2]
        alpha = a[i + 2]
        position += nx * rx + ny * ry
        velocity += omega * (ny * rx - nx * ry)
        acceleration += alpha * (ny * rx - nx * ry)
        acceleration -= omega * omega * (nx * rx + ny * ry)
    return position, velocity, acceleration


@compiled
def lowest_between(
    h: float, before: tuple[float, float, float], after: tuple[float, float, float]
) -> tuple[float, float]:
    """Return the lowest position in a step, m, and its time after the start of the step, s.

    ``before`` and ``after`` are position, velocity and acceleration at the ends of the
    step. The velocity is negative before and positive after. The result is the minimum
    of the quintic polynomial through these values. Its error is at most h^6 / 46080
    times the greatest sixth derivative; if the acceleration jumps by J at the start of
    the step, at most 0.018 J h^2.
    """
    c1 = h * before[1]
    c2 = 0.5 * h * h * before[2]
    d0 = after[0] - before[0] - c1 - c2
    d1 = h * after[1] - c1 - 2.0 * c2
    d2 = h * h * (after[2] - before[2])
    c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2
    c4 = -15.0 * d0 + 7.0 * d1 - d2
    c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2
    low, high = 0.0, 1.0
    x = before[1] / (before[1] - after[1])
    for _ in range(BOTTOM_STEPS):
        slope = c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))
        if slope <= 0.0:
            low = x
        else:
            high = x
        curvature = 2.0 * c2 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))
        new = x - slope / curvature if curvature > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - x) < BOTTOM_NOISE:
            break
        x = new
    position = before[0] + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5))))
    return position, x * h


@compiled
def note_bottom(
    records: RecorderState,
    t: float,
    h: float,
    nominal: tuple[float, float],
    now: tuple[float, float, float],
) -> None:
    """Update the lowest position of the present stroke, and store it at the end of the stroke.

    ``nominal`` are nominal time and its rate at the end of the step. ``now`` is the
    motion of the output point at that time.
    """
    state = records.output[0]
    cycle = records.cycle
    time = nominal[0]
    if time > state.stroke_begin:
        if now[0] < state.bottom:
            state.bottom = now[0]
            state.bottom_time = time
        if state.velocity <= 0.0 and now[1] > 0.0:
            before = (state.place, state.velocity, state.acceleration)
            lowest, elapsed = lowest_between(h, before, now)
            if lowest < state.bottom:
                state.bottom = lowest
                state.bottom_time = nominal_within(
                    records.nominal, t, h, elapsed, nominal
                )
        if time >= state.stroke_end:
            cycle[BOTTOM_HEIGHT] = state.bottom
            cycle[BOTTOM_TIME] = state.bottom_time
            state.stroke_end += state.period
            state.stroke_begin = state.stroke_end - state.stroke_length
            state.bottom = math.inf
    state.place, state.velocity, state.acceleration = now


@compiled
def note_top(
    state: Records, cycle: Array, h: float, now: tuple[float, float, float]
) -> None:
    """Update the highest position of the cycle.

    Call it before ``note_bottom``, which replaces the stored motion at the start of the
    step.
    """
    highest = now[0]
    if 0.0 <= state.velocity < math.inf and now[1] < 0.0:
        before = (-state.place, -state.velocity, -state.acceleration)
        lowest, _ = lowest_between(h, before, (-now[0], -now[1], -now[2]))
        highest = max(highest, -lowest)
    cycle[DISPLACEMENT_MAX] = max(cycle[DISPLACEMENT_MAX], highest - state.start)


@compiled
def sum_drives(records: RecorderState, h: float, v: Array) -> None:
    """Integrate torque and power of the drives over a step by the trapezoidal rule."""
    half = 0.5 * h
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        torque = records.torque[k]
        power = torque * v[records.packed.driven[k]]
        drive.torque_integral = half * (drive.torque + torque)
        drive.torque_square_integral = half * (drive.torque**2 + torque**2)
        drive.work = half * (drive.power + power)
        drive.power_square_integral = half * (drive.power**2 + power**2)


@compiled
def note_drives(records: RecorderState, h: float, v: Array) -> None:
    """Add the integrals of a step of length ``h``, s, to the cycle, and update the peaks.

    If the power changes sign in the step, the smaller of given and returned work is that
    of a power which is linear over the step. The difference of given and returned work
    is the work of the step.
    """
    first = records.cycle.shape[0] - DRIVE_CYCLE_COUNT * records.drives.shape[0]
    for k in range(records.drives.shape[0]):
        drive = records.drives[k]
        cycle = records.cycle[first + DRIVE_CYCLE_COUNT * k :]
        torque = records.torque[k]
        power = torque * v[records.packed.driven[k]]
        smaller = 0.0
        if power * drive.power < 0.0:
            least = min(abs(power), abs(drive.power))
            smaller = 0.5 * h * least * least / abs(power - drive.power)
        cycle[TORQUE] += drive.torque_integral
        cycle[TORQUE_SQUARE] += drive.torque_square_integral
        cycle[POWER_SQUARE] += drive.power_square_integral
        cycle[GIVEN] += max(drive.work, 0.0) + smaller
        cycle[RETURNED] += max(-drive.work, 0.0) + smaller
        if abs(torque) > abs(cycle[TORQUE_PEAK]):
            cycle[TORQUE_PEAK] = torque
        if abs(power) > abs(cycle[POWER_PEAK]):
            cycle[POWER_PEAK] = power
        drive.torque = torque
        drive.power = power


@inlined
def note_output(
    records: RecorderState, t: float, h: float, q: Array, v: Array, a: Array
) -> None:
    """Add the motion of output point and leader in a step of length ``h``, s, to the cycle."""
    cycle = records.cycle
    state = records.output[0]
    motion = output_motion(state, q, v, a)
    _, velocity, acceleration = motion
    cycle[VELOCITY_MIN] = min(cycle[VELOCITY_MIN], velocity)
    cycle[VELOCITY_MAX] = max(cycle[VELOCITY_MAX], velocity)
    cycle[ACCELERATION_MAX] = max(cycle[ACCELERATION_MAX], abs(acceleration))
    cycle[STEPS] += 1
    note_top(state, cycle, h, motion)
    nominal = nominal_time(records.nominal, t, q), nominal_rate(records.nominal, v)
    note_bottom(records, t, h, nominal, motion)
    note_leader(records, nominal[1])
    note_nominal(records.nominal, h, nominal, a)
    state.now = t


@inlined
def note_leader(records: RecorderState, rate: float) -> None:
    """Update the smallest and the largest speed of the leader in the cycle.

    ``rate`` is the rate of the nominal time: the speed over the nominal speed.
    """
    leader = records.nominal[0]
    if leader.column >= 0:
        joints = records.contacts.shape[0]
        speed = rate * abs(leader.speed)
        row = records.cycle[CYCLE_COUNT + JOINT_CYCLE_COUNT * joints :]
        row[LEADER_SPEED_MIN] = min(row[LEADER_SPEED_MIN], speed)
        row[LEADER_SPEED_MAX] = max(row[LEADER_SPEED_MAX], speed)


@inlined
def note_joint(records: RecorderState, k: int, t: float, h: float) -> None:
    """Add the force, the load distance and the contacts of a joint in a step to the cycle."""
    contact = records.contacts[k]
    counts = records.counters[k]
    last = records.memory[k]
    row = records.cycle[CYCLE_COUNT + JOINT_CYCLE_COUNT * k :]
    peak = max(contact.normal, last.step_peak)
    if peak > 0.0:
        counts.peak_force = max(counts.peak_force, peak)
        last.peak_force = max(last.peak_force, peak)
        row[FORCE_MAX] = max(row[FORCE_MAX], peak)
    if contact.normal > 0.0:
        counts.deepest = max(counts.deepest, contact.penetration)
    closed_until = t if records.onset[k] > 0.0 else last.separation_time
    closed_from = max(last.touchdown_time, t - h)
    row[CLOSED_TIME] += max(closed_until - closed_from, 0.0)
    row[LOAD_DISTANCE] += records.wear_integrals[k].work
    row[CONTACTS] = counts.contacts - counts.contacts_before


@inlined
def note_film(records: RecorderState, k: int, h: float) -> None:
    """Add the film of a joint in a step of length ``h``, s, to the cycle.

    The loss is integrated by the trapezoidal rule.
    """
    column = records.film_columns[k]
    if column < 0:
        return
    contact = records.contacts[k]
    row = records.cycle[column:]
    place = math.hypot(contact.eccentricity_x, contact.eccentricity_y)
    row[LEAST_FILM] = min(row[LEAST_FILM], records.packed.joints[k].clearance - place)
    row[FILM_LOSS] += 0.5 * h * (records.film_losses[k] + contact.film_loss)
    records.film_losses[k] = contact.film_loss


@inlined
def note_wear(records: RecorderState, k: int, h: float) -> None:
    """Add the wear of a joint in a step to the maps of the cycle."""
    integrals = records.wear_integrals[k]
    joint = records.packed.joints[k]
    if not integrals.work > 0.0:
        return
    if joint.is_flat:
        depths = records.depth[:, :, : joint.map_bins]
        deposit_on_wall(depths, k, joint, records.contacts[k], integrals.work, h)
        return
    depth = records.depth[k, :, : joint.map_bins]
    if joint.over_arc:
        surfaces = records.packed.surfaces[k]
        shares = records.shares[:, : joint.map_bins]
        contact = records.contacts[k]
        if joint.pressure_exponent != 1.0:
            deposit_by_pressure(
                depth, joint, surfaces, contact, integrals.pressure, shares
            )
        else:
            deposit_over_arc(depth, joint, surfaces, contact, integrals.work, shares)
    else:
        deposit_in_bins(depth, joint, records.contacts[k], integrals.pressure, h)


@inlined
def is_row_due(records: RecorderState, t: float) -> bool:
    """Return whether the present state is a row of the series.

    It is one if the longest time between two rows has passed, if a force has changed
    sufficiently since the last row, or if the law of a load has changed.
    """
    state = records.output[0]
    series = records.series
    row = state.rows
    if row >= min(state.room, series.shape[0]):
        return False
    if row == 0 or t - state.last_time >= state.interval:
        return True
    for k in range(records.contacts.shape[0]):
        written = series[row - 1, SERIES_COUNT + JOINT_SERIES_COUNT * k + NORMAL]
        change = abs(records.contacts[k].normal - written)
        if change > state.force_step * records.counters[k].peak_force:
            return True
    return last_change(records.packed.loads) == t


@compiled
def write_row(records: RecorderState) -> None:
    """Write the present state as a row of the series."""
    state = records.output[0]
    series = records.series
    contacts = records.contacts
    row = series[state.rows]
    row[TIME] = state.now
    row[DISPLACEMENT] = state.place - state.start
    row[VELOCITY] = state.velocity
    row[ACCELERATION] = state.acceleration
    for k in range(contacts.shape[0]):
        contact = contacts[k]
        joint = row[SERIES_COUNT + JOINT_SERIES_COUNT * k :]
        joint[ECCENTRICITY_X] = contact.eccentricity_x
        joint[ECCENTRICITY_Y] = contact.eccentricity_y
        joint[PENETRATION] = contact.penetration
        joint[NORMAL] = contact.normal
        joint[TANGENTIAL] = contact.tangential
        joint[SLIDING] = contact.sliding
    first = SERIES_COUNT + JOINT_SERIES_COUNT * contacts.shape[0]
    last = row.shape[0]
    if records.nominal[0].column >= 0:
        last -= LEADER_SERIES_COUNT
        row[last] = records.nominal[0].now
        row[last + 1] = records.nominal[0].rate
    for column in range(first, last):
        row[column] = records.torque[column - first]
    state.rows += 1
    state.last_time = state.now


@compiled
def note_stretches(
    guides: Records, pins: Records, stretches: Array, row: int, q: Array
) -> None:
    """Write the stretches of guides with a spring and of elastic pins into a row."""
    for k in range(guides.shape[0]):
        guide = guides[k]
        i = guide.index
        stretches[row, k] = guide.cos * q[i] + guide.sin * q[i + 1] - guide.point
    first = guides.shape[0]
    for k in range(pins.shape[0]):
        pin = pins[k]
        x, y = place_in(pin.second, pin.second_x, pin.second_y, q)
        bearing_x, bearing_y = place_in(pin.first, pin.first_x, pin.first_y, q)
        stretches[row, first + k] = math.hypot(x - bearing_x, y - bearing_y)


@inlined
def place_in(body: int, x: float, y: float, q: Array) -> tuple[float, float]:
    """Return the place of a point of a body, m; ``body`` is the place of its x in q."""
    dx, dy = lever(body, x, y, q)
    if body < 0:
        return dx, dy
    return q[body] + dx, q[body + 1] + dy


@compiled
def note_turns(
    angle_indices: NDArray[np.int64], turns: Array, row: int, q: Array, v: Array
) -> None:
    """Write angles and speeds of the drives of a linkage with a motor into a row."""
    for k in range(angle_indices.shape[0]):
        turns[row, 0, k] = q[angle_indices[k]]
        turns[row, 1, k] = v[angle_indices[k]]


@inlined
def observe(
    records: RecorderState, t: float, h: float, q: Array, v: Array, a: Array
) -> None:
    """Record one accepted step of length ``h``, s, whose contacts and loads are settled."""
    note_output(records, t, h, q, v, a)
    note_drives(records, h, v)
    for k in range(records.contacts.shape[0]):
        note_joint(records, k, t, h)
        note_film(records, k, h)
        note_wear(records, k, h)
    time = records.nominal[0].now
    take_frame(records.film, records.sampler, records.contacts, records.memory, time, q)
    if is_row_due(records, t):
        row = records.output[0].rows
        note_stretches(records.guides, records.pins, records.stretches, row, q)
        note_turns(records.angle_indices, records.turns, row, q, v)
        write_row(records)
