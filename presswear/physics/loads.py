"""Loads with a law of their own as generalized forces.

Within a step every law is smooth: which piece of it holds is a mode that changes between
steps only; see ``load_modes``.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import lever
from presswear.tools.compile import Records, call, compiled, inlined

Array = NDArray[np.float64]

SERIES, TIME, POSITION, OWN = range(4)
"""Kinds of laws."""
OFF, RISING, WHOLE, ELASTIC = range(4)
"""Gate of a load in one sense of motion: none, growing with the speed, all of it; or the elastic
line back from the deepest place, of one that unloads, whose OFF is behind the end of that line."""

LOAD = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("turns", np.bool_),  # a moment over the body's angle, and no force at a point
        ("x", np.float64),  # the point in the body's frame, m
        ("y", np.float64),
        ("cosine", np.float64),  # of the direction
        ("sine", np.float64),
        ("kind", np.int64),
        ("first", np.int64),  # of its nodes
        ("count", np.int64),
        ("period", np.float64),  # s, m or rad; 0: the table does not repeat
        ("zero", np.float64),  # position of the table's zero, m or rad
        ("held", np.bool_),  # beyond the table its ends are held
        ("sense", np.float64),  # of motion in which it acts, 1 or -1; 0: both
        ("rise", np.float64),  # speed from which it is whole, m/s or rad/s
        ("release", np.bool_),
        ("unloading", np.float64),  # slope of the elastic line, N/m or N m/rad; 0: none
        ("mean", np.float64),  # of a series, N or N m
        ("frequency", np.float64),  # rad/s
        ("own", np.int64),  # address of a function of one's own
    ]
)
"""A load as the kernels see it."""

MODE = np.dtype(
    [
        ("piece", np.int64),  # of the table: 0 before its first node, count behind its last
        ("turn", np.int64),  # periods that have passed
        ("gate", np.int64),
        ("released", np.bool_),
        ("deepest", np.float64),  # where the motion turned back last, m or rad
        ("borne", np.float64),  # size there, N or N m
        ("place", np.float64),  # in the last accepted state, m or rad
        ("speed", np.float64),
        ("faster", np.float64),
        ("change", np.float64),  # of the acceleration, over the last step
        ("jump", np.float64),  # of the size on leaving that state, part of the greater one
        ("time", np.float64),  # of that state, s
        ("changed", np.float64),  # time at which the mode has changed last, s
    ]
)
"""What holds of a load through a step, and its motion at the start of it."""


class Loads(NamedTuple):
    """Loads with a law as the kernels see them.

    Where a linkage has none there is None instead, and no kernel holds any code for them.

    Attributes
    ----------
    records : records of LOAD
    nodes : ndarray, shape (nodes, 2)
        Of their tables: position or time and size, or the two terms of a series.
    modes : records of MODE
        What holds of them through the present step.
    """

    records: Records
    nodes: Array
    modes: Records


@inlined
def load_size(load: Records, nodes: Array, mode: Records, t: float, s: float, v: float) -> float:
    """Size of a load, N or N m, in its present mode, at a position and speed."""
    if load.kind == SERIES:
        total: float = load.mean
        for k in range(load.count):
            phase = (k + 1) * load.frequency * t
            row = load.first + k
            total += nodes[row, 0] * math.cos(phase) + nodes[row, 1] * math.sin(phase)
        return total
    if load.kind == OWN:
        return call(load.own, (t, s, v))
    if mode.released or mode.gate == OFF:
        return 0.0
    if mode.gate == ELASTIC:
        line: float = mode.borne - load.unloading * (s - mode.deepest)
        return line
    piece = mode.piece
    behind = load.first + piece
    if piece == 0 or piece == load.count:
        size: float = 0.0
        if load.held:
            size = nodes[behind if piece == 0 else behind - 1, 1]
    else:
        at = t if load.kind == TIME else s
        x0 = nodes[behind - 1, 0]
        y0 = nodes[behind - 1, 1]
        part = (at - mode.turn * load.period - x0) / (nodes[behind, 0] - x0)
        size = y0 + part * (nodes[behind, 1] - y0)
    if mode.gate == RISING:
        size *= load.sense * v / load.rise
    return size


@compiled
def arm(load: Records, q: Array) -> tuple[float, float]:
    """From the mass centre to the point at which a load acts, m."""
    if load.x == 0.0 and load.y == 0.0:
        return 0.0, 0.0
    return lever(load.body, load.x, load.y, q)


@inlined
def load_motion(load: Records, q: Array, v: Array, a: Array) -> tuple[float, float, float]:
    """Position in the table, m or rad, speed and acceleration of what a load acts on."""
    b = load.body
    if load.turns:
        return q[b + 2] - load.zero, v[b + 2], a[b + 2]
    rx, ry = arm(load, q)
    along = load.cosine
    across = load.sine
    spin = v[b + 2]
    turned = across * rx - along * ry
    place = along * (q[b] + rx) + across * (q[b + 1] + ry) - load.zero
    speed = along * v[b] + across * v[b + 1] + spin * turned
    faster = along * a[b] + across * a[b + 1] + a[b + 2] * turned
    faster -= spin * spin * (along * rx + across * ry)
    return place, speed, faster


@inlined
def load_forces(loads: Loads | None, t: float, q: Array, v: Array, force: Array) -> float:
    """Add the loads to the generalized forces; returns their power, W."""
    if loads is None:
        return 0.0
    power = 0.0
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        b = load.body
        s, speed, _ = load_motion(load, q, v, v)
        size = load_size(load, loads.nodes, loads.modes[k], t, s, speed)
        power += size * speed
        if load.turns:
            force[b + 2] += size
            continue
        rx, ry = arm(load, q)
        fx = size * load.cosine
        fy = size * load.sine
        force[b] += fx
        force[b + 1] += fy
        force[b + 2] += rx * fy - ry * fx
    return power


@compiled
def work_beyond_trapezoid(loads: Loads | None, t: float, q: Array, v: Array) -> float:
    """Work of tables over position in a step, J, less that of their power by the trapezoidal rule.

    Within a piece a load is linear over the way, so that its work is known from both ends, however
    few steps an elastic load gets: what the trapezoidal rule moves keeps that energy.

    Parameters
    ----------
    t, q, v : float, ndarray
        The state at the end of the step, before the modes are brought up to it.
    """
    if loads is None:
        return 0.0
    total = 0.0
    for k in range(loads.records.shape[0]):
        load = loads.records[k]
        mode = loads.modes[k]
        if load.kind != POSITION or mode.gate == RISING:
            continue
        s, speed, _ = load_motion(load, q, v, v)
        before = load_size(load, loads.nodes, mode, mode.time, mode.place, mode.speed)
        after = load_size(load, loads.nodes, mode, t, s, speed)
        half = 0.5 * (t - mode.time)
        total += 0.5 * (before + after) * (s - mode.place)
        total -= half * (before * mode.speed + after * speed)
    return total
