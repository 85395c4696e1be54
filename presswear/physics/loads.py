"""Sizes of loads from their laws.

A law consists of smooth pieces. The mode of a load is the piece that holds. It changes
only between steps, so that the law is smooth within a step; see ``load_transitions``.
"""

import math
from typing import NamedTuple

import numpy as np

from presswear.physics.constraints import lever
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, call, compiled, floats, inlined

SERIES, TIME, POSITION, USER = range(4)  # kinds of laws
# Branches of a load that acts in one sense of motion.
# OFF: no load. RISING: the load grows with the speed. WHOLE: the whole load acts.
# ELASTIC: unloading along a line from the deepest position, at whose end OFF begins.
# RELEASED: no load until the table begins again.
OFF, RISING, WHOLE, ELASTIC, RELEASED = range(5)
# m/s or rad/s, above which the whole of a load in one sense of motion acts
RAMP_SPEED = 1e-3

# Load in the form that kernels read. If a load acts against its direction, then
# direction, positions and sizes are stored with the opposite sign. Every load in one sense
# then acts while its position grows.
LOAD = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        # True: a moment over the angle of the body; False: a force
        ("turns", np.bool_),
        *floats("x", "y"),  # point of the force in the frame of the body, m
        # direction of a force; for a moment the cosine is 1 or -1
        *floats("cosine", "sine"),
        ("kind", np.int64),
        ("first", np.int64),  # row of its first node
        ("count", np.int64),  # number of its nodes
        ("period", np.float64),  # period of a table over time, s; 0: it does not repeat
        ("zero", np.float64),  # position of the table's zero, m or rad
        ("is_constant_outside", np.bool_),  # outside of the table its end values hold
        # 0: acts in both senses of motion; 1: in one sense; -1: in one sense, and direction,
        # positions and sizes have the opposite sign
        ("sense", np.float64),
        # behind the last node no load until the table begins again
        ("release", np.bool_),
        ("unloading", np.float64),  # slope of the elastic line, N/m or N m/rad; 0: none
        ("mean", np.float64),  # mean of a series, N or N m
        ("frequency", np.float64),  # rad/s
        ("address", np.int64),  # address of a user function
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
        # position of the last reversal of the motion, m or rad
        ("deepest", np.float64),
        ("deepest_size", np.float64),  # size of the load at this position, N or N m
        # in the last accepted state; position in m or rad
        *floats("place", "speed", "acceleration"),
        ("change", np.float64),  # change of the acceleration over the last step
        # change of the size at the last change of mode, over the larger size
        ("jump", np.float64),
        ("time", np.float64),  # time of the last accepted state, s
        ("changed", np.float64),  # time of the last change of mode, s
    ]
)


class Loads(NamedTuple):
    """Loads with a law, in the form that kernels read."""

    records: Records  # dtype LOAD
    # Nodes of all tables, (n, 2): position or time, and size; or two terms of a series
    nodes: Array
    modes: Records  # dtype MODE, during the present step


@inlined
def load_size(
    load: Records, nodes: Array, mode: Records, t: float, s: float, v: float
) -> float:
    """Return the size of a load, N or N m, in its present mode, at a position and speed."""
    if load.kind == SERIES:
        total: float = load["mean"]  # load.mean is a method in plain Python
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
        elastic: float = mode.deepest_size - load.unloading * (s - mode.deepest)
        return elastic
    after = load.first + mode.piece
    size: float = 0.0
    if mode.piece == 0:
        if load.is_constant_outside:
            size = nodes[after, 1]
    elif mode.piece == load.count:
        if load.is_constant_outside:
            size = nodes[after - 1, 1]
    else:
        position = t if load.kind == TIME else s
        argument = position - mode.turn * load.period
        # Interpolation starts at the node that comes first in the table of the user.
        first = after if load.sense < 0.0 else after - 1
        second = after - 1 if load.sense < 0.0 else after
        width = nodes[second, 0] - nodes[first, 0]
        fraction = (argument - nodes[first, 0]) / width
        size = nodes[first, 1] + fraction * (nodes[second, 1] - nodes[first, 1])
    if mode.branch == RISING:
        size *= v / RAMP_SPEED
    return size


@inlined
def load_motion(
    load: Records, q: Array, v: Array, a: Array
) -> tuple[float, float, float]:
    """Return position, speed and acceleration along a load, m or rad.

    The position counts from the zero of the table.
    """
    b = load.body
    cosine = load.cosine
    sine = load.sine
    if load.turns:
        return cosine * q[b + 2] - load.zero, cosine * v[b + 2], cosine * a[b + 2]
    rx, ry = lever(b, load.x, load.y, q)
    omega = v[b + 2]
    arm = sine * rx - cosine * ry
    place = cosine * (q[b] + rx) + sine * (q[b + 1] + ry) - load.zero
    speed = cosine * v[b] + sine * v[b + 1] + omega * arm
    acceleration = cosine * a[b] + sine * a[b + 1] + a[b + 2] * arm
    acceleration -= omega * omega * (cosine * rx + sine * ry)
    return place, speed, acceleration


@compiled
def work_beyond_trapezoid(loads: Loads, t: float, q: Array, v: Array) -> float:
    """Return the work of tables over position in a step, J, less that by the trapezoidal rule.

    Within a piece a load is linear over the position. Its work follows from both ends,
    however few steps an elastic load gets. The state is that at the end of the step,
    before ``settle_loads``.
    """
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
