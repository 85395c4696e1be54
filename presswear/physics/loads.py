"""Laws of loads: their sizes, and the modes that change between steps.

Within a step every law is smooth: the piece of the law that holds is a mode that
changes between steps only. Switching functions rise through zero where the next piece
begins; an engine ends a step there, and at ``next_break`` where a table over time
bends.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import (
    LOAD_PARAMETERS,
    Harmonics,
    OverPosition,
    OverTime,
)
from presswear.linkage.loads import Force, Moment
from presswear.physics.constraints import lever
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, address_of, call, compiled, floats, inlined
from presswear.tools.user_function import UserFunction, compile_function

SERIES, TIME, POSITION, USER = range(4)  # kinds of laws
# Branches of a load in one sense of motion: none, growing with the speed, all of it;
# the elastic line back from the deepest place, OFF behind its end; none until the table
# begins again.
OFF, RISING, WHOLE, ELASTIC, RELEASED = range(5)
RAMP_SPEED = 1e-3  # m/s or rad/s, from which a load in one sense acts fully

# A load as the kernels see it. One that acts against its direction is turned round: its
# direction, positions and sizes have the other sign, so that it acts where the position
# grows.
LOAD = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("turns", np.bool_),  # a moment over the body's angle, and no force at a point
        *floats("x", "y"),  # the point in the body's frame, m
        *floats("cosine", "sine"),  # of the direction; of a moment 1 or -1
        ("kind", np.int64),
        ("first", np.int64),  # of its nodes
        ("count", np.int64),
        ("period", np.float64),  # of a table over time, s; 0: it does not repeat
        ("zero", np.float64),  # position of the table's zero, m or rad
        ("is_constant_outside", np.bool_),  # beyond the table its ends are held
        ("sense", np.float64),  # 0: of both senses of motion; 1; -1: turned round
        ("release", np.bool_),
        ("unloading", np.float64),  # slope of the elastic line, N/m or N m/rad; 0: none
        ("mean", np.float64),  # of a series, N or N m
        ("frequency", np.float64),  # rad/s
        ("address", np.int64),  # of a user function
    ]
)

# Mode of a load through a step, and its motion at the start of the step
MODE = np.dtype(
    [
        # piece of the table: 0 before the first node, count after the last node
        ("piece", np.int64),
        ("turn", np.int64),  # periods that have passed
        ("branch", np.int64),
        # limits of position, m or rad, or of time, s, of this mode
        *floats("low", "high"),
        *floats("slow", "fast"),  # limits of speed of this mode
        (
            "deepest",
            np.float64,
        ),  # position of the last reversal of the motion, m or rad
        ("deepest_size", np.float64),  # size of the load at this position, N or N m
        # in the last accepted state; position in m or rad
        *floats("place", "speed", "acceleration"),
        ("change", np.float64),  # of the acceleration, over the last step
        # change of the size at the last change of mode, over the larger size
        ("jump", np.float64),
        ("time", np.float64),  # of the last accepted state, s
        ("changed", np.float64),  # time of the last change of mode, s
    ]
)


class Loads(NamedTuple):
    """Loads with a law as the kernels see them; None where a linkage has none."""

    records: Records  # of LOAD
    # of their tables, (n, 2): position or time and size, or two terms of a series
    nodes: Array
    modes: Records  # of MODE, through the present step


@inlined
def load_size(
    load: Records, nodes: Array, mode: Records, t: float, s: float, v: float
) -> float:
    """Return the size of a load, N or N m, in its present mode, at a position and speed."""
    if load.kind == SERIES:
        total: float = load.mean
        for k in range(load.count):
            phase = (k + 1) * load.frequency * t
            row = load.first + k
            total += nodes[row, 0] * math.cos(phase) + nodes[row, 1] * math.sin(phase)
        return total
    if load.kind == USER:
        return call(load.address, (t, s, v))
    if mode.branch == OFF or mode.branch == RELEASED:
        return 0.0
    if mode.branch == ELASTIC:
        line: float = mode.deepest_size - load.unloading * (s - mode.deepest)
        return line
    after = load.first + mode.piece
    if mode.piece == 0 or mode.piece == load.count:
        size: float = 0.0
        if load.is_constant_outside:
            size = nodes[after if mode.piece == 0 else after - 1, 1]
    else:
        at = (t if load.kind == TIME else s) - mode.turn * load.period
        # Interpolation starts at the node that comes first in the table of the user.
        first = after if load.sense < 0.0 else after - 1
        second = after - 1 if load.sense < 0.0 else after
        fraction = (at - nodes[first, 0]) / (nodes[second, 0] - nodes[first, 0])
        size = nodes[first, 1] + fraction * (nodes[second, 1] - nodes[first, 1])
    if mode.branch == RISING:
        size *= v / RAMP_SPEED
    return size


@inlined
def load_motion(
    load: Records, q: Array, v: Array, a: Array
) -> tuple[float, float, float]:
    """Return the position in the table, m or rad, speed and acceleration of what a load acts on."""
    b = load.body
    along, across = load.cosine, load.sine
    if load.turns:
        return along * q[b + 2] - load.zero, along * v[b + 2], along * a[b + 2]
    rx, ry = lever(b, load.x, load.y, q)
    spin = v[b + 2]
    arm = across * rx - along * ry
    place = along * (q[b] + rx) + across * (q[b + 1] + ry) - load.zero
    speed = along * v[b] + across * v[b + 1] + spin * arm
    acceleration = along * a[b] + across * a[b + 1] + a[b + 2] * arm
    acceleration -= spin * spin * (along * rx + across * ry)
    return place, speed, acceleration


@compiled
def work_beyond_trapezoid(loads: Loads | None, t: float, q: Array, v: Array) -> float:
    """Return the work of tables over position in a step, J, less that by the trapezoidal rule.

    Within a piece a load is linear over the position. Its work follows from both ends,
    however few steps an elastic load gets. The state is that at the end of the step,
    before ``settle_loads``.
    """
    if loads is None:
        return 0.0
    total = 0.0
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        mode = loads.modes[k]
        if load.kind != POSITION or mode.branch == RISING:
            continue
        s, speed, _ = load_motion(load, q, v, v)
        before = load_size(load, loads.nodes, mode, mode.time, mode.place, mode.speed)
        after = load_size(load, loads.nodes, mode, t, s, speed)
        half = 0.5 * (t - mode.time)
        total += 0.5 * (before + after) * (s - mode.place)
        total -= half * (before * mode.speed + after * speed)
    return total


# Transitions from a mode: beyond its high and low position, its high and low speed
TRANSITIONS = 4
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
    if transition == 0:
        return s - mode.high, v, a, j
    if transition == 1:
        return mode.low - s, -v, -a, -j
    if transition == 2:
        return v - mode.fast, a, j, 0.0
    return mode.slow - v, -a, -j, 0.0


@inlined
def is_past(value: float, rate: float) -> bool:
    """Return whether a switching function has risen through zero."""
    return value > 0.0 or (value == 0.0 and rate > 0.0)


@compiled
def set_limits(load: Records, nodes: Array, mode: Records) -> None:
    """Set the limits of a mode: positions, or times, and speeds."""
    mode.low = mode.slow = -math.inf
    mode.high = mode.fast = math.inf
    if load.kind == SERIES or load.kind == USER:
        return
    piece = mode.piece
    branch = mode.branch
    after = load.first + mode.piece
    high = mode.turn * load.period + nodes[after, 0] if piece < load.count else math.inf
    if branch == RELEASED:
        mode.low = nodes[load.first, 0]
    elif load.unloading > 0.0:
        free = mode.deepest + mode.deepest_size / load.unloading
        if branch == OFF:
            mode.low, mode.high = nodes[load.first, 0], free
        elif branch == ELASTIC:
            mode.low, mode.high = free, mode.deepest
        else:
            mode.high = high
            mode.slow = 0.0 if piece > 0 else -math.inf
    else:
        if branch != OFF:
            mode.high = high
            if piece > 0:
                mode.low = mode.turn * load.period + nodes[after - 1, 0]
        if load.sense != 0.0:
            mode.fast = (0.0, RAMP_SPEED, math.inf)[branch]
            mode.slow = (-math.inf, 0.0, RAMP_SPEED)[branch]


@compiled
def place_mode(
    load: Records,
    nodes: Array,
    mode: Records,
    at: float,
    onward: float,
    v: float,
    a: float,
) -> None:
    """Set the piece of a table from a position or time, and the branch from the motion.

    A position exactly at a node is in the next piece if ``onward`` is positive.
    """
    mode.turn = 0
    if load.period > 0.0:
        mode.turn = math.floor(at / load.period)
        at -= mode.turn * load.period
    mode.piece = 0
    while mode.piece < load.count and is_past(
        at - nodes[load.first + mode.piece, 0], onward
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
def settle_loads(loads: Loads | None, t: float, q: Array, v: Array, a: Array) -> int:
    """Update the modes after an accepted step; return the number of changes."""
    if loads is None:
        return 0
    changes = 0
    nodes = loads.nodes
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        mode = loads.modes[k]
        changes_before = changes
        s, speed, acceleration = load_motion(load, q, v, a)
        before = load_size(load, nodes, mode, t, s, speed)
        while load.kind == TIME and mode.high <= t + TIME_NOISE:
            mode.piece += 1
            if mode.piece == load.count and load.period > 0.0:
                mode.turn += 1
                mode.piece = 1
            set_limits(load, nodes, mode)
            changes += 1
        mode.change = (
            (acceleration - mode.acceleration) / (t - mode.time)
            if t > mode.time
            else 0.0
        )
        mode.time = t
        mode.place = s
        mode.speed = speed
        mode.acceleration = acceleration
        for _ in range(MAX_CHANGES):
            past = False
            for transition in range(TRANSITIONS):
                value, rate, _, _ = switching(
                    load, mode, transition, s, speed, acceleration, 0.0
                )
                past = past or is_past(value, rate)
            if not past:
                break
            change_mode(load, nodes, mode, s, speed, acceleration)
            changes += 1
        after = load_size(load, nodes, mode, t, s, speed)
        if changes > changes_before:
            mode.changed = t
        greater = max(abs(before), abs(after))
        mode.jump = abs(after - before) / greater if greater > 0.0 else 0.0
    return changes


@compiled
def next_break(loads: Loads | None) -> float:
    """Return the time of the next bend or jump over time of any load, s."""
    earliest = math.inf
    if loads is not None:
        for k in range(loads.records.shape[0]):
            if loads.records[k].kind == TIME:
                earliest = min(earliest, loads.modes[k].high)
    return earliest


@compiled
def count_transitions(loads: Loads | None) -> int:
    """Return the number of possible transitions of all loads."""
    return 0 if loads is None else TRANSITIONS * loads.records.shape[0]


@compiled
def transition_value(
    loads: Loads | None, k: int, q: Array, v: Array, a: Array
) -> tuple[float, float]:
    """Return a switching function in a state, and its rate."""
    if loads is None:
        return -math.inf, 0.0
    load = loads.records[k // TRANSITIONS]
    mode = loads.modes[k // TRANSITIONS]
    s, speed, acceleration = load_motion(load, q, v, a)
    value, rate, _, _ = switching(
        load, mode, k % TRANSITIONS, s, speed, acceleration, 0.0
    )
    return value, rate


@compiled
def transition_at_start(
    loads: Loads | None, k: int, change: float
) -> tuple[float, float, float, float]:
    """Return a switching function in the last accepted state, and its derivatives.

    ``change`` is the part of the change of the acceleration that is counted on.
    """
    if loads is None:
        return -math.inf, 0.0, 0.0, 0.0
    load = loads.records[k // TRANSITIONS]
    mode = loads.modes[k // TRANSITIONS]
    jerk = change * mode.change
    return switching(
        load, mode, k % TRANSITIONS, mode.place, mode.speed, mode.acceleration, jerk
    )


@compiled
def last_change(loads: Loads | None) -> float:
    """Return the time at which the mode of any load has changed last, s."""
    last = -math.inf
    if loads is not None:
        for k in range(loads.modes.shape[0]):
            last = max(last, loads.modes[k].changed)
    return last


@compiled
def greatest_jump(loads: Loads | None) -> float:
    """Return the greatest jump of a load that settled last, part of the greater size."""
    jump = 0.0
    if loads is not None:
        for k in range(loads.modes.shape[0]):
            jump = max(jump, loads.modes[k].jump)
    return jump


@compiled
def place_loads(loads: Loads, q: Array, v: Array) -> None:
    """Set all modes in an initial state, at t = 0."""
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        mode = loads.modes[k]
        s, speed, _ = load_motion(load, q, v, v)
        mode.place = s
        mode.speed = speed
        place_mode(
            load, loads.nodes, mode, 0.0 if load.kind == TIME else s, 1.0, speed, 0.0
        )
        set_limits(load, loads.nodes, mode)
        # A motion out of the table begins at its deepest place.
        if load.unloading > 0.0 and speed < mode.slow:
            change_mode(load, loads.nodes, mode, s, speed, 0.0)


@compiled
def _follow_sizes(loads: Loads, motion: Array, sizes: Array, levels: Array) -> None:
    """Fill the sizes of ``sizes_over``; ``levels`` is room for the motion of one body."""
    q, v, a = levels
    q[0], v[0] = motion[0, 1], motion[0, 2]
    place_loads(loads, q, v)
    for i in range(motion.shape[0]):
        t = motion[i, 0]
        q[0], v[0], a[0] = motion[i, 1], motion[i, 2], motion[i, 3]
        settle_loads(loads, t, q, v, a)
        for k in range(loads.records.shape[0]):
            load = loads.records[k]
            s, speed, _ = load_motion(load, q, v, a)
            sizes[i, k] = load.cosine * load_size(
                load, loads.nodes, loads.modes[k], t, s, speed
            )


def sizes_over(laws: Iterable[OverPosition], linkage: Linkage, motion: Array) -> Array:
    """Return the sizes of loads over one coordinate in a recorded motion, shape (n, loads), N.

    They are in the modes of the run that recorded it: a row stands at every change of
    them. Columns of ``motion`` are time, s, and place, m, velocity and acceleration
    along the loads' direction.
    """
    chosen = tuple(laws)
    records = np.zeros(len(chosen), LOAD)
    records["cosine"] = 1.0
    loads = _pack_laws(records, chosen, linkage)
    sizes = np.zeros((len(motion), len(chosen)))
    if sizes.size:
        _follow_sizes(loads, np.ascontiguousarray(motion), sizes, np.zeros((3, 3)))
    return sizes


def pack_loads(linkage: Linkage) -> Loads | None:
    """Return the loads of a linkage that have a law."""
    if not linkage.live_loads:
        return None
    loads = np.zeros(len(linkage.live_loads), LOAD)
    loads["cosine"] = 1.0
    for record, load in zip(loads, linkage.live_loads, strict=True):
        record["body"] = 3 * linkage.index(load.body)
        record["turns"] = isinstance(load, Moment)
        if isinstance(load, Force):
            point = load.attachment
            record["x"], record["y"] = point.x, point.y
            record["cosine"] = math.cos(load.direction)
            record["sine"] = math.sin(load.direction)
    return _pack_laws(loads, [load.law for load in linkage.live_loads], linkage)


def _pack_laws(records: Records, laws: Sequence[object], linkage: Linkage) -> Loads:
    """Return loads from their laws and from records of where they act, which are filled."""
    nodes: list[tuple[float, float]] = []
    for record, law in zip(records, laws, strict=True):
        table: Sequence[tuple[float, float]] = ()
        if isinstance(law, OverTime):
            period = linkage.period if law.period is None else law.period
            record["kind"] = TIME
            record["is_constant_outside"] = True
            record["period"] = period
            table = _whole_period(law, period)
        elif isinstance(law, OverPosition):
            record["kind"] = POSITION
            record["is_constant_outside"] = law.outside == "hold"
            record["sense"] = {"both": 0.0, "along": 1.0, "against": -1.0}[law.sense]
            record["zero"] = law.zero
            record["release"] = law.release
            record["unloading"] = law.unloading
            table = law.table
            if law.sense == "against":
                for name in ("cosine", "sine", "zero"):
                    record[name] *= -1.0
                table = [(-place, -size) for place, size in reversed(table)]
        elif isinstance(law, UserFunction):
            kernel = compile_function(law, LOAD_PARAMETERS)
            record["kind"] = USER
            record["address"] = address_of(kernel, len(LOAD_PARAMETERS))
        elif isinstance(law, Harmonics):
            record["kind"] = SERIES
            table = law.harmonics
            record["mean"] = law.mean
            record["frequency"] = law.frequency
        else:
            record["kind"] = SERIES
            record["mean"] = law
        record["first"] = len(nodes)
        record["count"] = len(table)
        nodes += table
    points = np.array(nodes, dtype=np.float64).reshape(-1, 2)
    return Loads(records, points, np.zeros(len(records), MODE))


def _whole_period(law: OverTime, period: float) -> list[tuple[float, float]]:
    """Return a table from 0 to its period, with what lies between its last node and its first."""
    nodes = list(law.table)
    if period == 0.0:
        return nodes
    (x0, y0), (x1, y1) = nodes[0], nodes[-1]
    gap = x0 + period - x1
    edge = y1 + (y0 - y1) * (period - x1) / gap if gap > 0.0 else y1
    if x0 > 0.0:
        nodes.insert(0, (0.0, edge))
    if x1 < period:
        nodes.append((period, edge))
    return nodes
