"""Nominal time, by which the cycles of a linkage with a motor are counted.

Without a motor it is the time. With a motor the speed varies. The nominal time is then
(angle - initial angle) / nominal speed of the leader: the time at which the leader
would have its present angle at its nominal speed. The leader is the first drive with a
motor that is no servo. Phases of a cycle, strokes and the ideal motion are functions of
the nominal time. Durations, energies and frequencies refer to the time.
"""

import math

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.event_time import crossing, hermite
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, floats, inlined

# A section has ended if the nominal time left is shorter, s; more than the round-off
SECTION_TOL = 1e-11

# Speed over nominal speed below which a motor that has run is stalled
STALLED = 0.05
# Rotation after which a starting motor is not stalled, turns
ADVANCE = 1e-3
_ADVANCE_ANGLE = 2.0 * math.pi * ADVANCE

# Leader and nominal time of a run
NOMINAL = np.dtype(
    [
        ("column", np.int64),  # index of the leader's angle in q; -1: no motor
        ("start", np.float64),  # initial angle of the leader, rad
        ("speed", np.float64),  # nominal speed of the leader, rad/s
        # nominal time in the last accepted state, s, and two derivatives by time
        *floats("now", "rate", "rise"),
        # third derivative, from a difference over the last step, 1/s^2
        ("jerk", np.float64),
        # nominal time at which the present section ends, s; infinite: it ends at a time
        ("end", np.float64),
        ("cycle_start", np.float64),  # time at which the cycle began, s
        ("cycle_begin", np.float64),  # nominal time at which the cycle began, s
        ("runs", np.bool_),  # the rate has been above STALLED
        # nominal time at which the rate fell below STALLED, s; infinite: not yet
        ("stall", np.float64),
        # While the motor starts: nominal time after the last rotation by ADVANCE, s, and
        # the time since that rotation, s
        *floats("furthest", "idle"),
    ]
)


def nominal_of(linkage: Linkage) -> Records:
    """Return the record of the leader of a linkage, as one of NOMINAL."""
    nominal = np.zeros(1, NOMINAL)
    leader = linkage.leader
    nominal["column"] = -1
    nominal["end"] = math.inf
    nominal["stall"] = math.inf
    if leader is not None:
        nominal["column"] = 3 * linkage.index(leader.body) + 2
        nominal["start"] = leader.angle
        nominal["speed"] = leader.speed
    return nominal


@inlined
def nominal_time(nominal: Records, t: float, q: Array) -> float:
    """Return the nominal time of a state at a time, s."""
    state = nominal[0]
    if state.column < 0:
        return t
    time: float = (q[state.column] - state.start) / state.speed
    return time


@inlined
def nominal_within(
    nominal: Records, t: float, h: float, elapsed: float, now: tuple[float, float]
) -> float:
    """Return the nominal time at a time ``elapsed`` after the start of a step, s.

    The step has the length ``h`` and ends at ``t``, s. ``now`` has the nominal time and
    its rate at the end of the step. The record has both at its start.
    """
    state = nominal[0]
    if state.column < 0:
        return t - h + elapsed
    return hermite(state.now, state.rate, now[0], now[1], h, elapsed / h)[0]


@inlined
def nominal_rate(nominal: Records, v: Array) -> float:
    """Return the rate of the nominal time: the speed of the leader over its nominal speed."""
    state = nominal[0]
    if state.column < 0:
        return 1.0
    rate: float = v[state.column] / state.speed
    return rate


@inlined
def note_nominal(
    nominal: Records, h: float, now: tuple[float, float], a: Array
) -> None:
    """Store nominal time and rate, and derivatives, of an accepted state."""
    state = nominal[0]
    state.now, state.rate = now
    if state.column >= 0:
        speed = abs(state.speed)
        rise = a[state.column] / state.speed
        state.jerk = (rise - state.rise) / h if h > 0.0 else 0.0
        state.rise = rise
        if now[1] >= STALLED:
            state.runs = True
        elif state.runs:
            if math.isinf(state.stall):
                state.stall = now[0]
        elif now[0] * speed > state.furthest * speed + _ADVANCE_ANGLE:
            state.furthest = now[0]
            state.idle = 0.0
        else:
            state.idle += h


@inlined
def time_left(nominal: Records, t: float, end: float) -> float:
    """Return the time until the end of a march, s.

    If the section ends at an angle, the time is infinite before that angle and zero
    from it on.
    """
    state = nominal[0]
    if math.isinf(state.end):
        return end - t
    return 0.0 if state.now >= state.end - SECTION_TOL else math.inf


@inlined
def section_at_start(
    nominal: Records, smooth: bool
) -> tuple[float, float, float, float]:
    """Return the nominal time minus the end of the section, s, and three derivatives by time.

    The values are those of the last accepted state. The difference is minus infinity if
    the section has no end in nominal time. The third derivative is 0 unless the motion
    is ``smooth``.
    """
    state = nominal[0]
    jerk = state.jerk if smooth else 0.0
    return state.now - state.end, state.rate, state.rise, jerk


@compiled
def section_value(nominal: Records, q: Array, v: Array) -> tuple[float, float]:
    """Return the nominal time of a state minus the end of the section, s, and its rate."""
    return nominal_time(nominal, 0.0, q) - nominal[0].end, nominal_rate(nominal, v)


@compiled
def section_crossing(
    nominal: Records, q: Array, v: Array, h: float, behind: float
) -> float:
    """Return the fraction of a step at which the section ends, or 2 if it does not end in it.

    ``behind`` is the time by which the nominal time exceeds the end of the section, s.
    """
    state = nominal[0]
    if math.isinf(state.end):
        return 2.0
    value, rate = section_value(nominal, q, v)
    start = min(state.now - state.end, 0.0) - behind
    return crossing(start, state.rate, value - behind, rate, h)
