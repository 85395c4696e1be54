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
    of the quintic Hermite polynomial x_0 + c_1 s + ... + c_5 s^5 through these values,
    with the part s of the step. Its error is at most h^6 / 46080 times the greatest sixth
    derivative. If the acceleration jumps by J at the start of the step, it is at most
    0.018 J h^2.
    """
    x0, v0, a0 = before
    x1, v1, a1 = after
    c1 = h * v0
    c2 = 0.5 * h * h * a0
    d0 = x1 - x0 - c1 - c2
    d1 = h * v1 - c1 - 2.0 * c2
    d2 = h * h * (a1 - a0)
    c3 = 10.0 * d0 - 4.0 * d1 + 0.5 * d2
    c4 = -15.0 * d0 + 7.0 * d1 - d2
    c5 = 6.0 * d0 - 3.0 * d1 + 0.5 * d2
    low = 0.0
    high = 1.0
    s = v0 / (v0 - v1)
    for _ in range(BOTTOM_STEPS):
        slope = c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))
        if slope <= 0.0:
            low = s
        else:
            high = s
        curvature = 2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))
        new = s - slope / curvature if curvature > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - s) < BOTTOM_NOISE:
            break
        s = new
    position = x0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))))
    return position, s * h


@compiled
def note_bottom(
    records: RecorderState,
    t: float,
    h: float,
    nominal: tuple[float, float],
    now: tuple[float, float, float],
) -> None:
    """Update the lowest position of the present stroke, and store it at the end of the stroke.

    ``nominal`` are the nominal time, s, and its rate at the end of the step. ``now`` are
    position, velocity and acceleration of the output point at the end of the step.
    """
    state = records.output[0]
    cycle = records.cycle
    time, _ = nominal
    place, velocity, _ = now
    if time > state.stroke_begin:
        if place < state.bottom:
            state.bottom = place
            state.bottom_time = time
        if state.velocity <= 0.0 and velocity > 0.0:
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
    highest, velocity, acceleration = now
    if 0.0 <= state.velocity < math.inf and velocity < 0.0:
        # The highest position is the lowest one of the motion with the opposite sign.
        before = (-state.place, -state.velocity, -state.acceleration)
        after = (-highest, -velocity, -acceleration)
        lowest, _ = lowest_between(h, before, after)
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
