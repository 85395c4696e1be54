"""Linear springs with dampers as generalized forces on the bodies."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import lever
from presswear.tools.compile import Records, compiled, lazily_compiled

Array = NDArray[np.float64]

SPRING = np.dtype(
    [
        ("first", np.int64),
        ("second", np.int64),
        ("x1", np.float64),
        ("y1", np.float64),
        ("x2", np.float64),
        ("y2", np.float64),
        ("stiffness", np.float64),
        ("damping", np.float64),
        ("length", np.float64),
    ]
)
"""A spring as the kernels see it."""


@compiled
def reach(
    spring: Records, x1: float, y1: float, x2: float, y2: float, q: Array
) -> tuple[float, float]:
    """Vector from end to end, m, from the ends' places relative to their bodies'."""
    dx, dy = x2 - x1, y2 - y1
    if spring.first >= 0:
        dx -= q[spring.first]
        dy -= q[spring.first + 1]
    if spring.second >= 0:
        dx += q[spring.second]
        dy += q[spring.second + 1]
    return dx, dy


@compiled
def spring_energy(springs: Records, q: Array) -> float:
    """Energy of all springs, J."""
    energy = 0.0
    for i in range(springs.shape[0]):
        spring = springs[i]
        x1, y1 = lever(spring.first, spring.x1, spring.y1, q)
        x2, y2 = lever(spring.second, spring.x2, spring.y2, q)
        dx, dy = reach(spring, x1, y1, x2, y2, q)
        stretch = math.sqrt(dx * dx + dy * dy) - spring.length
        energy += 0.5 * spring.stiffness * stretch * stretch
    return energy


@lazily_compiled(0, np.zeros(0, SPRING), 1, 1, 1)
def spring_forces(springs: Records, q: Array, v: Array, force: Array) -> float:
    """Add the forces of the springs to the generalized forces; returns their dampers' power, W."""
    power = 0.0
    for i in range(springs.shape[0]):
        spring = springs[i]
        x1, y1 = lever(spring.first, spring.x1, spring.y1, q)
        x2, y2 = lever(spring.second, spring.x2, spring.y2, q)
        dx, dy = reach(spring, x1, y1, x2, y2, q)
        dvx = dvy = 0.0
        if spring.first >= 0:
            dvx -= v[spring.first] - v[spring.first + 2] * y1
            dvy -= v[spring.first + 1] + v[spring.first + 2] * x1
        if spring.second >= 0:
            dvx += v[spring.second] - v[spring.second + 2] * y2
            dvy += v[spring.second + 1] + v[spring.second + 2] * x2
        length = math.sqrt(dx * dx + dy * dy)
        rate = (dx * dvx + dy * dvy) / length
        pull = spring.stiffness * (length - spring.length) + spring.damping * rate
        power -= spring.damping * rate * rate
        fx = pull * dx / length
        fy = pull * dy / length
        if spring.first >= 0:
            force[spring.first] += fx
            force[spring.first + 1] += fy
            force[spring.first + 2] += x1 * fy - y1 * fx
        if spring.second >= 0:
            force[spring.second] -= fx
            force[spring.second + 1] -= fy
            force[spring.second + 2] -= x2 * fy - y2 * fx
    return power


def pack_springs(linkage: Linkage) -> Records:
    """The springs of a linkage as records of SPRING."""
    springs = np.zeros(len(linkage.springs), SPRING)
    for record, spring in zip(springs, linkage.springs, strict=True):
        for end, point in zip("12", spring.ends, strict=True):
            record["first" if end == "1" else "second"] = (
                -1 if point.body == GROUND else 3 * linkage.index(point.body)
            )
            record["x" + end], record["y" + end] = point.x, point.y
        record["stiffness"], record["damping"] = spring.stiffness, spring.damping
        record["length"] = spring.length
    return springs
