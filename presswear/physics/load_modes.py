"""Moments at which the law of a load changes.

Switching functions rise through zero where the next piece of a law begins; an engine
ends a step there, and at ``next_break`` where a table over time bends.
"""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import OverPosition
from presswear.physics.load_packing import pack_laws
from presswear.physics.loads import (
    ELASTIC,
    LOAD,
    OFF,
    POSITION,
    RISING,
    TIME,
    WHOLE,
    Loads,
    load_motion,
    load_size,
)
from presswear.tools.compile import Records, compiled, inlined

Array = NDArray[np.float64]

WAYS = 4
"""Ways out of a mode: up over position, down, gate further open, and shut.

Over position they lead to the next piece of the table, or along the elastic line and off its ends;
what unloads has one gate alone, which shuts where the motion turns back."""
MOST_WAYS = 8
"""Taken one by one after a step."""
TIME_NOISE = 1e-12
"""A step that ends so close to a bend over time ends there, s."""


@compiled
def switching(
    load: Records, nodes: Array, mode: Records, way: int, s: float, v: float, a: float, j: float
) -> tuple[float, float, float, float]:
    """Switching function of a way out of a mode, and three time derivatives.

    It is below zero until the way is to be taken; minus infinity where there is none.

    Parameters
    ----------
    s, v, a, j : float
        Position and three derivatives; see ``load_motion``.
    """
    none = (-math.inf, 0.0, 0.0, 0.0)
    if load.kind != POSITION:
        return none
    if way < 2:
        sign = 1.0 if way == 0 else -1.0
        inwards = sign * load.sense > 0.0
        unloads = load.unloading > 0.0
        if mode.released or (unloads and mode.gate == OFF and not inwards):
            # Back where the table begins.
            row = 0 if load.sense > 0.0 else load.count - 1
            if inwards:
                return none
        elif unloads and mode.gate != WHOLE:
            # The deepest place, or where the elastic line comes to zero.
            end = mode.deepest
            if inwards == (mode.gate == OFF):
                end += mode.borne / load.unloading
            return sign * (s - end), sign * v, sign * a, sign * j
        else:
            row = mode.piece if way == 0 else mode.piece - 1
            is_shut = mode.gate == OFF or (unloads and not inwards)
            if is_shut or row < 0 or row == load.count:
                return none
        end = mode.turn * load.period + nodes[load.first + row, 0]
        return sign * (s - end), sign * v, sign * a, sign * j
    if mode.released or load.sense == 0.0:
        return none
    sign = load.sense
    if load.unloading > 0.0:
        if way == 2 or mode.gate != WHOLE or mode.piece == beginning(load):
            return none
        return -sign * v, -sign * a, -sign * j, 0.0
    if way == 2 and mode.gate != WHOLE:
        return sign * v - (load.rise if mode.gate == RISING else 0.0), sign * a, sign * j, 0.0
    if way == 3 and mode.gate != OFF:
        return (load.rise if mode.gate == WHOLE else 0.0) - sign * v, -sign * a, -sign * j, 0.0
    return none


@inlined
def beginning(load: Records) -> int:
    """Piece before that in which the table of a load in one sense begins."""
    return 0 if load.sense > 0.0 else load.count


@compiled
def place_mode(load: Records, nodes: Array, mode: Records, at: float) -> None:
    """Find the piece of a table at a position or time."""
    mode.turn = 0
    if load.period > 0.0:
        mode.turn = math.floor(at / load.period)
        at -= mode.turn * load.period
    mode.piece = 0
    while mode.piece < load.count and nodes[load.first + mode.piece, 0] <= at:
        mode.piece += 1
    if load.period > 0.0:
        mode.piece = min(max(mode.piece, 1), load.count - 1)
    mode.released = load.release and mode.piece == load.count - beginning(load)


@compiled
def open_gate(load: Records, mode: Records, v: float) -> None:
    """Set the gate of a load as a speed asks for."""
    mode.gate = WHOLE
    if load.sense != 0.0 and load.unloading == 0.0 and load.sense * v <= load.rise:
        mode.gate = RISING if load.sense * v > 0.0 else OFF


@compiled
def take_way(load: Records, nodes: Array, mode: Records, way: int, s: float, v: float) -> None:
    """Go into the next mode."""
    if load.unloading > 0.0 and not mode.released:
        inwards = (load.sense > 0.0) == (way == 0)
        if way > 1:
            # A step may have gone back over a node since it turned.
            place_mode(load, nodes, mode, s)
            mode.borne = load_size(load, nodes, mode, 0.0, s, v)
            mode.deepest = s
            mode.gate = ELASTIC
            return
        if mode.gate == ELASTIC:
            mode.gate = WHOLE if inwards else OFF
            return
        if mode.gate == OFF:
            mode.gate = ELASTIC if inwards else WHOLE
            if not inwards:
                mode.piece = beginning(load)
            return
    if way > 1:
        mode.gate += 1 if way == 2 else -1
        if way == 2 and mode.gate == RISING:
            place_mode(load, nodes, mode, s)  # it was not followed while the gate was shut
        return
    if mode.released:
        mode.released = False
        mode.piece = beginning(load)
        open_gate(load, mode, v)
        return
    mode.piece += 1 if way == 0 else -1
    last = load.count if way == 0 else 0
    if mode.piece == last:
        if load.period > 0.0:
            mode.turn += 1 if way == 0 else -1
            mode.piece = 1 if way == 0 else load.count - 1
        elif load.release and (load.sense > 0.0) == (way == 0):
            mode.released = True


@compiled
def settle_loads(loads: Loads | None, t: float, q: Array, v: Array, a: Array) -> int:
    """Bring the modes up to an accepted state; returns how many have changed."""
    if loads is None:
        return 0
    changes = 0
    nodes = loads.nodes
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        mode = loads.modes[k]
        changes_before = changes
        s, speed, faster = load_motion(load, q, v, a)
        before = load_size(load, nodes, mode, t, s, speed)
        if load.kind == TIME:
            while break_of(load, nodes, mode) <= t + TIME_NOISE:
                take_way(load, nodes, mode, 0, t, 0.0)
                changes += 1
        mode.change = (faster - mode.faster) / (t - mode.time) if t > mode.time else 0.0
        mode.time = t
        mode.place = s
        mode.speed = speed
        mode.faster = faster
        for _ in range(MOST_WAYS):
            taken = -1
            for way in range(WAYS):
                value, rate, _, _ = switching(load, nodes, mode, way, s, speed, faster, 0.0)
                if value > 0.0 or (value == 0.0 and rate > 0.0):
                    taken = way
            if taken < 0:
                break
            take_way(load, nodes, mode, taken, s, speed)
            changes += 1
        else:
            place_mode(load, nodes, mode, s)  # a step went over many pieces
            open_gate(load, mode, speed)
        after = load_size(load, nodes, mode, t, s, speed)
        if changes > changes_before:
            mode.changed = t
        greater = max(abs(before), abs(after))
        mode.jump = abs(after - before) / greater if greater > 0.0 else 0.0
    return changes


@compiled
def break_of(load: Records, nodes: Array, mode: Records) -> float:
    """Time at which a table over time bends next, s."""
    if load.kind != TIME or mode.piece == load.count:
        return math.inf
    return mode.turn * load.period + nodes[load.first + mode.piece, 0]


@compiled
def next_break(loads: Loads | None) -> float:
    """Time of the next bend or jump over time of any load, s."""
    if loads is None:
        return math.inf
    earliest = math.inf
    for k in range(loads.records.shape[0]):
        earliest = min(earliest, break_of(loads.records[k], loads.nodes, loads.modes[k]))
    return earliest


@compiled
def count_ways(loads: Loads | None) -> int:
    """Number of ways out of the modes of all loads."""
    if loads is None:
        return 0
    return WAYS * loads.records.shape[0]


@compiled
def way_out(loads: Loads | None, k: int, q: Array, v: Array, a: Array) -> tuple[float, float]:
    """Switching function of a way out of a mode in a state, and its rate."""
    if loads is None:
        return -math.inf, 0.0
    load = loads.records[k // WAYS]
    s, speed, faster = load_motion(load, q, v, a)
    mode = loads.modes[k // WAYS]
    value, rate, _, _ = switching(load, loads.nodes, mode, k % WAYS, s, speed, faster, 0.0)
    return value, rate


@compiled
def way_at_start(loads: Loads | None, k: int, change: float) -> tuple[float, float, float, float]:
    """Switching function of a way out of a mode in the last accepted state, and its derivatives.

    Parameters
    ----------
    change : float
        Part of the change of the acceleration that is counted on.
    """
    if loads is None:
        return -math.inf, 0.0, 0.0, 0.0
    mode = loads.modes[k // WAYS]
    return switching(
        loads.records[k // WAYS],
        loads.nodes,
        mode,
        k % WAYS,
        mode.place,
        mode.speed,
        mode.faster,
        change * mode.change,
    )


@compiled
def last_change(loads: Loads | None) -> float:
    """Time at which the mode of any load has changed last, s."""
    last = -math.inf
    if loads is not None:
        for k in range(loads.modes.shape[0]):
            last = max(last, loads.modes[k].changed)
    return last


@compiled
def greatest_jump(loads: Loads | None) -> float:
    """Greatest jump of a load that settled last, part of the greater size."""
    jump = 0.0
    if loads is not None:
        for k in range(loads.modes.shape[0]):
            jump = max(jump, loads.modes[k].jump)
    return jump


def place_loads(loads: Loads, q: Array, v: Array) -> None:
    """Set all modes in an initial state, at t = 0."""
    for load, mode in zip(loads.records, loads.modes, strict=True):
        s, speed, _ = load_motion(load, q, v, v)
        mode["place"], mode["speed"] = s, speed
        place_mode(load, loads.nodes, mode, 0.0 if load["kind"] == TIME else s)
        open_gate(load, mode, speed)
        turned = load["unloading"] > 0.0 and load["sense"] * speed < 0.0
        if turned and not mode["released"] and mode["piece"] != beginning(load):
            take_way(load, loads.nodes, mode, WAYS - 1, s, speed)


@compiled
def _follow_sizes(loads: Loads, motion: Array, sizes: Array, work: Array) -> None:
    """Fill sizes, shape (n, loads), of loads over a coordinate; see ``sizes_over``.

    Parameters
    ----------
    motion : ndarray, shape (n, 4)
    work : ndarray, shape (3, 3)
        Room for coordinates, rates and accelerations of one body.
    """
    q, v, a = work
    for i in range(motion.shape[0]):
        t = motion[i, 0]
        q[0], v[0], a[0] = motion[i, 1], motion[i, 2], motion[i, 3]
        settle_loads(loads, t, q, v, a)
        for k in range(loads.records.shape[0]):
            load = loads.records[k]
            s, speed, _ = load_motion(load, q, v, a)
            sizes[i, k] = load_size(load, loads.nodes, loads.modes[k], t, s, speed)


def sizes_over(laws: Iterable[OverPosition], linkage: Linkage, motion: Array) -> Array:
    """Sizes of loads over one coordinate in a recorded motion, shape (n, loads), N.

    They are in the modes of the run that recorded it: a row stands at every change of them.

    Parameters
    ----------
    linkage : Linkage
        What they act on.
    motion : ndarray, shape (n, 4)
        Time, s, place, m, velocity and acceleration along the direction in which they act.
    """
    chosen = tuple(laws)
    records = np.zeros(len(chosen), LOAD)
    records["cosine"] = 1.0
    loads = pack_laws(records, chosen, linkage)
    sizes, work = np.zeros((len(motion), len(chosen))), np.zeros((3, 3))
    if sizes.size:
        work[:, 0] = motion[0, 1:]
        place_loads(loads, work[0], work[1])
        _follow_sizes(loads, np.ascontiguousarray(motion), sizes, work)
    return sizes
