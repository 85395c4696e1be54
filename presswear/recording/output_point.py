"""Motion of the output point in each cycle: extremes and bottom dead centre."""

import math

from presswear.physics.constraints import lever
from presswear.recording.columns import (
    ACCELERATION_MAX,
    BOTTOM_HEIGHT,
    BOTTOM_TIME,
    CYCLE_COUNT,
    DISPLACEMENT_MAX,
    JOINT_CYCLE_COUNT,
    LEADER_SPEED_MAX,
    LEADER_SPEED_MIN,
    STEPS,
    VELOCITY_MAX,
    VELOCITY_MIN,
)
from presswear.recording.nominal_time import (
    nominal_rate,
    nominal_time,
    nominal_within,
    note_nominal,
)
from presswear.recording.recorder_state import RecorderState
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined

BOTTOM_STEPS = 60  # largest number of Newton steps for the lowest position in a step
BOTTOM_NOISE = 1e-14  # round-off of an instant, as a fraction of a step


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
