"""Closed-form motion of the press and the slider-crank, which are made of dyads.

Two links that meet in a joint are solved from their other ends alone: positions by
intersecting circles, velocities and accelerations by two linear equations.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.points import Attachment
from presswear.linkage.press import CRANK_2_START, CRANK_7_START, Press
from presswear.physics.ideal import Motion
from presswear.tools.arrays import Array

Complex = NDArray[Any]


class Point(NamedTuple):
    """Moving point: position, velocity, acceleration, each (n,), complex numbers x + i y."""

    position: Complex
    velocity: Complex
    acceleration: Complex


def fixed(x: float, y: float, count: int) -> Point:
    """Return a point at rest, at ``count`` times."""
    still = np.zeros(count, complex)
    return Point(still + complex(x, y), still, still)


def _dot(a: Complex, b: Complex) -> Array:
    return np.asarray((a.conjugate() * b).real)


Turning = tuple[Array, Array | float, Array | float]
"""Angle of a crank, rad, its speed and its acceleration."""


def crank(centre: Point, length: float, turning: Turning) -> Point:
    """Return the tip of a crank that turns about a fixed point."""
    angle, speed, faster = turning
    arm = length * np.exp(1j * angle)
    return Point(
        centre.position + arm, 1j * speed * arm, (1j * faster - np.square(speed)) * arm
    )


def dyad(p: Point, q: Point, from_p: float, from_q: float, side: float) -> Point:
    """Return the point at distances from two moving points, on a side of p to q."""
    base = q.position - p.position
    length = np.abs(base)
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    position = (
        p.position + (along + 1j * side * np.sqrt(from_p**2 - along**2)) * base / length
    )
    a = position - p.position
    b = position - q.position

    def solve(of_a: Array, of_b: Array) -> Complex:
        """Return the vectors whose scalar products with both links are these."""
        return np.asarray(1j * (a * of_b - b * of_a) / (a.conjugate() * b).imag)

    velocity = solve(_dot(a, p.velocity), _dot(b, q.velocity))
    spin_p = np.abs(velocity - p.velocity) ** 2
    spin_q = np.abs(velocity - q.velocity) ** 2
    acceleration = solve(
        _dot(a, p.acceleration) - spin_p, _dot(b, q.acceleration) - spin_q
    )
    return Point(position, velocity, acceleration)


def slide(c: Point, length: float, start: complex, unit: complex, side: float) -> Point:
    """Return the end of a rod from a moving point on a line, 1 ahead of its foot or -1 behind."""
    away, speed, faster = (level / unit for level in (c.position - start, *c[1:]))
    reach = side * np.sqrt(length**2 - away.imag**2)
    reach_t = -away.imag * speed.imag / reach
    reach_tt = -(speed.imag**2 + away.imag * faster.imag + reach_t**2) / reach
    return Point(
        start + (away.real + reach) * unit,
        (speed.real + reach_t) * unit,
        (faster.real + reach_tt) * unit,
    )


BodyState = list[Array]
"""Position, velocity and acceleration of a body, each (n, 3): mass centre and angle."""


def _state(centre: Point, *angles: Array) -> BodyState:
    levels = zip(centre, angles, strict=True)
    return [np.column_stack([level.real, level.imag, angle]) for level, angle in levels]


def bar_state(origin: Attachment, tail: Point, head: Point) -> BodyState:
    """Return the motion of a body whose x axis points from its point ``origin`` to another one."""
    arm = head.position - tail.position
    omega, alpha = (((head[k] - tail[k]) / arm).imag for k in (1, 2))
    # from the tail to the mass centre
    lever = -complex(origin.x, origin.y) * arm / np.abs(arm)
    centre = Point(
        tail.position + lever,
        tail.velocity + 1j * omega * lever,
        tail.acceleration + (1j * alpha - omega**2) * lever,
    )
    return _state(centre, np.angle(arm), omega, alpha)


def _together(
    linkage: Linkage,
    time: Array,
    joints: dict[str, Point],
    axes: dict[str, tuple[str, str]],
    driven: dict[str, Array],
) -> Motion:
    """Put the motions of single bodies together in the order of a linkage.

    ``axes`` holds the joints from and to which the x axis of a body points, but of
    those on guides.
    """
    ends = {
        (end.body, joint.name): end
        for joint in linkage.revolutes
        for end in (joint.first, joint.second)
    }
    states = {
        body: bar_state(ends[body, tail], joints[tail], joints[head])
        for body, (tail, head) in axes.items()
    }
    still = np.zeros(time.size)
    for guide in linkage.guides:
        (name,) = (name for body, name in ends if body == guide.body)
        states[guide.body] = _state(joints[name], still + guide.angle, still, still)
    position, velocity, acceleration = (
        np.hstack([states[body.name][level] for body in linkage.bodies])
        for level in range(3)
    )
    position[:, 2::3] = np.unwrap(position[:, 2::3], axis=0)
    for body, angle in driven.items():
        position[:, 3 * linkage.index(body) + 2] = angle
    return Motion(time, position, velocity, acceleration)


def press_motion(
    press: Press,
    time: Array,
    rates: tuple[float, float] | None = None,
    turning_7: Turning | None = None,
) -> Motion:
    """Motion of the press with all joints closed; without ``turning_7`` crank 7 turns evenly.

    ``rates`` are speeds of cranks 2 and 7, rad/s, in place of their own: velocities by
    them are partial derivatives.
    """
    geometry = press.geometry
    turn = press.speed * time
    turning_2: Turning = (CRANK_2_START - turn, -press.speed, 0.0)
    turning_7 = turning_7 or (CRANK_7_START + turn, press.speed, 0.0)
    if rates is not None:
        turning_2 = (turning_2[0], rates[0], 0.0)
        turning_7 = (turning_7[0], rates[1], 0.0)
    o2 = fixed(geometry.hx, geometry.hy, time.size)
    o7 = fixed(0.0, 0.0, time.size)
    a = crank(o2, -press.length_2, turning_2)
    d = crank(o7, press.length_7, turning_7)
    b = dyad(d, a, geometry.side_bd, press.length_3, geometry.side_b)
    c = dyad(d, b, geometry.side_cd, geometry.side_bc, geometry.side_c)
    e = slide(c, press.length_5, geometry.hx, 1j, geometry.slider_side)
    joints = {"O2": o2, "O7": o7, "A": a, "B": b, "C": c, "D": d, "E": e}
    axes = {
        "crank 2": ("A", "O2"),
        "rod 3": ("B", "A"),
        "plate 4": ("D", "B"),
        "rod 5": ("E", "C"),
        "crank 7": ("O7", "D"),
    }
    driven = {"crank 2": turning_2[0], "crank 7": turning_7[0]}
    return _together(press.linkage(), time, joints, axes, driven)


def needed_by_virtual_work(
    press: Press, time: Array, upwards: Array, turning_7: Turning | None = None
) -> Array:
    """Torques of cranks 2 and 7 under a force on the slider, N, joints closed, (n, 2), N m."""
    linkage = press.linkage()
    motion = press_motion(press, time, None, turning_7)
    mass = np.array(
        [[body.mass, body.mass, body.inertia] for body in linkage.bodies]
    ).ravel()
    force = -mass * motion.acceleration
    force[:, 1::3] -= press.gravity * mass[1::3]
    force[:, 3 * linkage.index("slider 6") + 1] += upwards
    ways = [
        press_motion(press, time, rates, turning_7).velocity
        for rates in ((1.0, 0.0), (0.0, 1.0))
    ]
    return -np.column_stack([np.sum(force * way, axis=1) for way in ways])


def slider_crank_motion(mechanism: SliderCrank, time: Array) -> Motion:
    """Motion of the slider-crank with all joints closed; the crank turns evenly."""
    o = fixed(0.0, 0.0, time.size)
    turning = mechanism.speed * time, mechanism.speed, 0.0
    a = crank(o, mechanism.crank_length, turning)
    b = slide(a, mechanism.rod_length, 0.0, 1.0, 1.0)
    axes = {"crank": ("O", "A"), "rod": ("A", "B")}
    return _together(
        mechanism.linkage(), time, {"O": o, "A": a, "B": b}, axes, {"crank": turning[0]}
    )


def needed_power(linkage: Linkage, motion: Motion) -> Array:
    """Return the rate of the kinetic energy less the power of the weights, W, shape (n,)."""
    shape = motion.time.size, -1, 3
    v = motion.velocity.reshape(shape)
    a = motion.acceleration.reshape(shape)
    masses = np.array([body.mass for body in linkage.bodies])
    inertias = np.array([body.inertia for body in linkage.bodies])
    power = (v[..., :2] * a[..., :2]).sum(axis=2) @ masses
    power += (v[..., 2] * a[..., 2]) @ inertias
    return np.asarray(power + linkage.gravity * v[..., 1] @ masses)
