"""Transitions between the modes of loads.

A switching function rises through zero where the next piece of a law begins. An engine
ends a step there, and at ``next_break``, where a table over time bends.
"""

import math

import numpy as np

from presswear.physics.loads import (
    ELASTIC,
    LOAD,
    MODE,
    OFF,
    POSITION,
    RAMP_SPEED,
    RELEASED,
    RISING,
    SERIES,
    TIME,
    USER,
    WHOLE,
    Loads,
    load_motion,
    load_size,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# Transitions from a mode: position above mode.high or below mode.low, speed above
# mode.fast or below mode.slow
ABOVE, BELOW, FASTER, SLOWER, TRANSITIONS = range(5)
MAX_CHANGES = 8  # largest number of changes of a mode after a step
# Time between the end of a step and a node of a table, within which they coincide, s
TIME_NOISE = 1e-12


@inlined
def switching(
    load: Records,
    mode: Records,
    transition: int,
    s: float,
    v: float,
    a: float,
    j: float,
) -> tuple[float, float, float, float]:
    """Return the switching function of a transition, and three time derivatives.

    It is negative before the transition, and minus infinity if the mode has no such
    transition. ``s`` to ``j`` are the position and three derivatives; see
    ``load_motion``.
    """
    if load.kind != POSITION:
        return -math.inf, 0.0, 0.0, 0.0
    if transition == ABOVE:
        return s - mode.high, v, a, j
    if transition == BELOW:
        return mode.low - s, -v, -a, -j
    if transition == FASTER:
        return v - mode.fast, a, j, 0.0
    return mode.slow - v, -a, -j, 0.0


@inlined
def is_past(value: float, rate: float) -> bool:
    """Return whether a switching function has risen through zero."""
    return value > 0.0 or (value == 0.0 and rate > 0.0)


@compiled
def set_limits(load: Records, nodes: Array, mode: Records) -> None:
    """Set the limits of a mode: low and high positions, or times, and slow and fast speeds."""
    mode.low = -math.inf
    mode.slow = -math.inf
    mode.high = math.inf
    mode.fast = math.inf
    if load.kind == SERIES or load.kind == USER:
        return
    branch = mode.branch
    next_node = math.inf
    if mode.piece < load.count:
        next_node = mode.turn * load.period + nodes[load.first + mode.piece, 0]
    if branch == RELEASED:
        mode.low = nodes[load.first, 0]
    elif load.unloading > 0.0:
        free = mode.deepest + mode.deepest_size / load.unloading
        if branch == OFF:
            mode.low = nodes[load.first, 0]
            mode.high = free
        elif branch == ELASTIC:
            mode.low = free
            mode.high = mode.deepest
        else:
            mode.high = next_node
            # A motion that turns back inside the table unloads.
            mode.slow = 0.0 if mode.piece > 0 else -math.inf
    else:
        if branch != OFF:
            mode.high = next_node
            if mode.piece > 0:
                before = load.first + mode.piece - 1
                mode.low = mode.turn * load.period + nodes[before, 0]
        if load.sense != 0.0:
            # Highest and lowest speeds of the branches OFF, RISING and WHOLE
            mode.fast = (0.0, RAMP_SPEED, math.inf)[branch]
            mode.slow = (-math.inf, 0.0, RAMP_SPEED)[branch]


@compiled
def place_mode(
    load: Records,
    nodes: Array,
    mode: Records,
    place: float,
    rate: float,
    v: float,
    a: float,
) -> None:
    """Set the piece of a table from a position or time, and the branch from the motion.

    ``place`` is the position or the time. Exactly at a node it is in the next piece if
    its ``rate`` is positive.
    """
    mode.turn = 0
    if load.period > 0.0:
        mode.turn = math.floor(place / load.period)
        place -= mode.turn * load.period
    mode.piece = 0
    while mode.piece < load.count and is_past(
        place - nodes[load.first + mode.piece, 0], rate
    ):
        mode.piece += 1
    if load.period > 0.0:
        mode.piece = min(max(mode.piece, 1), load.count - 1)
    mode.branch = WHOLE
    if load.release and mode.piece == load.count:
        mode.branch = RELEASED
    elif load.sense != 0.0 and load.unloading == 0.0 and not is_past(v - RAMP_SPEED, a):
        mode.branch = RISING if is_past(v, a) else OFF


@compiled
def change_mode(
    load: Records, nodes: Array, mode: Records, s: float, v: float, a: float
) -> None:
    """Change the mode of a load over position after a state beyond the limits of its mode."""
    unloads = load.unloading > 0.0
    before = mode.branch
    if unloads and before in (OFF, ELASTIC) and not is_past(s - mode.deepest, v):
        free = mode.deepest + mode.deepest_size / load.unloading
        if not is_past(s - nodes[load.first, 0], v):
            mode.branch = WHOLE
            mode.piece = 0
        else:
            mode.branch = ELASTIC if is_past(s - free, v) else OFF
    else:
        place_mode(load, nodes, mode, s, v, v, a)
        if (
            unloads
            and before == mode.branch == WHOLE
            and mode.piece > 0
            and is_past(-v, -a)
        ):
            # The motion has turned back: the load follows the elastic line from here.
            mode.deepest_size = load_size(load, nodes, mode, 0.0, s, v)
            mode.deepest = s
            mode.branch = ELASTIC
    set_limits(load, nodes, mode)


@compiled
def pass_nodes(load: Records, nodes: Array, mode: Records, t: float) -> int:
    """Set the piece of a table over time at the time ``t``; return the number of nodes passed."""
    count = 0
    while load.kind == TIME and mode.high <= t + TIME_NOISE:
        mode.piece += 1
        if mode.piece == load.count and load.period > 0.0:
            mode.turn += 1
            mode.piece = 1
        set_limits(load, nodes, mode)
        count += 1
    return count


@compiled
def is_beyond_limits(
    load: Records, mode: Records, s: float, v: float, a: float
) -> bool:
    """Return whether a state of a load is beyond a limit of its mode."""
    for transition in range(TRANSITIONS):
        value, rate, _, _ = switching(load, mode, transition, s, v, a, 0.0)
        if is_past(value, rate):
            return True
    return False


@lazily_compiled(np.int64(0), LOAD, 2, MODE, 0, 1, 1, 1)
def settle_load(
    load: Records,
    nodes: Array,
    mode: Records,
    t: float,
    q: Array,
    v: Array,
    a: Array,
) -> int:
    """Update the mode of a load after an accepted step; return the number of changes."""
    s, speed, acceleration = load_motion(load, q, v, a)
    # Size in the same state with the mode before this step
    size_before = load_size(load, nodes, mode, t, s, speed)
    changes = pass_nodes(load, nodes, mode, t)
    mode.change = 0.0
    if t > mode.time:
        mode.change = (acceleration - mode.acceleration) / (t - mode.time)
    mode.time = t
    mode.place = s
    mode.speed = speed
    mode.acceleration = acceleration
    while changes < MAX_CHANGES and is_beyond_limits(
        load, mode, s, speed, acceleration
    ):
        change_mode(load, nodes, mode, s, speed, acceleration)
        changes += 1
    if changes > 0:
        mode.changed = t
    size = load_size(load, nodes, mode, t, s, speed)
    greater = max(abs(size_before), abs(size))
    mode.jump = abs(size - size_before) / greater if greater > 0.0 else 0.0
    return changes


@compiled
def settle_loads(loads: Loads, t: float, q: Array, v: Array, a: Array) -> int:
    """Update the modes after an accepted step; return the number of changes."""
    changes = 0
    for k in range(loads.records.shape[0]):
        changes += settle_load(
            loads.records[k], loads.nodes, loads.modes[k], t, q, v, a
        )
    return changes


@compiled
def next_break(loads: Loads) -> float:
    """Return the time of the next bend or jump over time of any load, s."""
    earliest = math.inf
    for k in range(loads.records.shape[0]):
        if loads.records[k].kind == TIME:
            earliest = min(earliest, loads.modes[k].high)
    return earliest


@compiled
def count_transitions(loads: Loads) -> int:
    """Return the number of possible transitions of all loads."""
    return TRANSITIONS * loads.records.shape[0]


@inlined
def transition_of(k: int) -> tuple[int, int]:
    """Return the load and its transition with the switching function ``k``."""
    return k // TRANSITIONS, k % TRANSITIONS


@lazily_compiled((0.0, 0.0), LOAD, MODE, np.int64(0), 1, 1, 1)
def transition_value(
    load: Records, mode: Records, transition: int, q: Array, v: Array, a: Array
) -> tuple[float, float]:
    """Return a switching function in a state, and its rate."""
    s, speed, acceleration = load_motion(load, q, v, a)
    value, rate, _, _ = switching(load, mode, transition, s, speed, acceleration, 0.0)
    return value, rate


@compiled
def transition_at_start(
    load: Records, mode: Records, transition: int, change: float
) -> tuple[float, float, float, float]:
    """Return a switching function in the last accepted state, and its derivatives.

    ``change`` is 1 to use the rate of the acceleration over the last step, and 0 to assume
    a constant acceleration.
    """
    jerk = change * mode.change
    return switching(
        load, mode, transition, mode.place, mode.speed, mode.acceleration, jerk
    )


@compiled
def last_change(loads: Loads) -> float:
    """Return the time at which the mode of any load has changed last, s."""
    last = -math.inf
    for k in range(loads.modes.shape[0]):
        last = max(last, loads.modes[k].changed)
    return last


@compiled
def greatest_jump(loads: Loads) -> float:
    """Return the greatest jump of a load after the last step.

    It is the change over the greater size before and after.
    """
    jump = 0.0
    for k in range(loads.modes.shape[0]):
        jump = max(jump, loads.modes[k].jump)
    return jump


@lazily_compiled(None, LOAD, 2, MODE, 1, 1)
def place_load(load: Records, nodes: Array, mode: Records, q: Array, v: Array) -> None:
    """Set the mode of a load in an initial state, at t = 0."""
    s, speed, _ = load_motion(load, q, v, v)
    mode.place = s
    mode.speed = speed
    place = 0.0 if load.kind == TIME else s
    place_mode(load, nodes, mode, place, 1.0, speed, 0.0)
    set_limits(load, nodes, mode)
    # A motion that starts backwards unloads from its first position.
    if load.unloading > 0.0 and speed < mode.slow:
        change_mode(load, nodes, mode, s, speed, 0.0)


@compiled
def place_loads(loads: Loads, q: Array, v: Array) -> None:
    """Set all modes in an initial state, at t = 0."""
    for k in range(loads.records.shape[0]):
        place_load(loads.records[k], loads.nodes, loads.modes[k], q, v)
