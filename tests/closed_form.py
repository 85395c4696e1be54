"""Closed-form motion of the press and the slider-crank, which are made of dyads.

Two links that meet in a joint are solved from their other ends alone: positions by
intersecting circles, velocities and accelerations by two linear equations.
"""

from typing import NamedTuple

import numpy as np

from presswear.linkage.elements import Attachment
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import CRANK_2_START, CRANK_7_START, Press, SliderCrank
from presswear.physics.ideal import Motion
from presswear.tools.arrays import Array


class Point(NamedTuple):
    """A moving point: position, velocity, acceleration, each (n, 2)."""

    position: Array
    velocity: Array
    acceleration: Array


def fixed(x: float, y: float, count: int) -> Point:
    """A point at rest, at ``count`` times."""
    still = np.zeros((count, 2))
    return Point(still + np.array([x, y]), still, still)


def _direction(angle: Array) -> Array:
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _left(vector: Array) -> Array:
    """The vector turned by +90 degrees."""
    return np.column_stack([-vector[:, 1], vector[:, 0]])


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=1))


Turning = tuple[Array, Array | float, Array | float]
"""Angle of a crank, rad, its speed and its acceleration."""


def crank(centre: Point, length: float, turning: Turning) -> Point:
    """Tip of a crank that turns about a fixed point."""
    angle, speed, faster = (np.broadcast_to(x, turning[0].shape)[:, None] for x in turning)
    arm = length * _direction(angle[:, 0])
    return Point(centre.position + arm, speed * _left(arm), faster * _left(arm) - speed**2 * arm)


def dyad(p: Point, q: Point, from_p: float, from_q: float, side: float) -> Point:
    """The point at given distances from two moving points, on a given side of p to q."""
    base = q.position - p.position
    length = np.sqrt(_dot(base, base))
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    unit = base / length[:, None]
    height = side * np.sqrt(from_p**2 - along**2)
    position = p.position + along[:, None] * unit + height[:, None] * _left(unit)
    arm_p, arm_q = position - p.position, position - q.position
    velocity = _solve_two(arm_p, arm_q, _dot(arm_p, p.velocity), _dot(arm_q, q.velocity))
    spin_p, spin_q = velocity - p.velocity, velocity - q.velocity
    acceleration = _solve_two(
        arm_p,
        arm_q,
        _dot(arm_p, p.acceleration) - _dot(spin_p, spin_p),
        _dot(arm_q, q.acceleration) - _dot(spin_q, spin_q),
    )
    return Point(position, velocity, acceleration)


def _solve_two(row_1: Array, row_2: Array, right_1: Array, right_2: Array) -> Array:
    """Vectors x with row_1 . x = right_1 and row_2 . x = right_2, row by row."""
    determinant = row_1[:, 0] * row_2[:, 1] - row_1[:, 1] * row_2[:, 0]
    x = (right_1 * row_2[:, 1] - row_1[:, 1] * right_2) / determinant
    y = (row_1[:, 0] * right_2 - right_1 * row_2[:, 0]) / determinant
    return np.column_stack([x, y])


def slide(
    c: Point, length: float, start: tuple[float, float], along: tuple[float, float], side: float
) -> Point:
    """The end of a rod from a moving point on a line, 1 ahead of its foot there or -1 behind."""
    unit = np.array(along)
    across = np.array([-unit[1], unit[0]])
    away = c.position - np.array(start)
    offset = away @ across
    reach = side * np.sqrt(length**2 - offset**2)
    offset_t, offset_tt = c.velocity @ across, c.acceleration @ across
    reach_t = -offset * offset_t / reach
    reach_tt = -(offset_t**2 + offset * offset_tt + reach_t**2) / reach

    return Point(
        np.array(start) + (away @ unit + reach)[:, None] * unit,
        (c.velocity @ unit + reach_t)[:, None] * unit,
        (c.acceleration @ unit + reach_tt)[:, None] * unit,
    )


BodyState = tuple[Array, Array, Array]
"""Position, velocity and acceleration of a body, each (n, 3): mass centre and angle."""


def slider_state(c: Point, angle: float) -> BodyState:
    """Motion of a body that slides with its mass centre at ``c`` and does not turn."""
    still = np.zeros((len(c.position), 1))
    return (
        np.hstack([c.position, still + angle]),
        np.hstack([c.velocity, still]),
        np.hstack([c.acceleration, still]),
    )


def bar_state(origin: Attachment, tail: Point, head: Point) -> BodyState:
    """Motion of a body whose x axis points from its point ``origin`` to another point."""
    arm = head.position - tail.position
    square = _dot(arm, arm)
    theta = np.arctan2(arm[:, 1], arm[:, 0])
    omega = _dot(_left(arm), head.velocity - tail.velocity) / square
    alpha = _dot(_left(arm), head.acceleration - tail.acceleration) / square
    axis = _direction(theta)
    # From the tail to the mass centre, in global directions.
    lever = -(origin.x * axis + origin.y * _left(axis))
    position = tail.position + lever
    velocity = tail.velocity + omega[:, None] * _left(lever)
    acceleration = tail.acceleration + alpha[:, None] * _left(lever) - (omega**2)[:, None] * lever
    return (
        np.column_stack([position, theta]),
        np.column_stack([velocity, omega]),
        np.column_stack([acceleration, alpha]),
    )


def _together(
    linkage: Linkage,
    time: Array,
    joints: dict[str, Point],
    axes: dict[str, tuple[str, str]],
    driven: dict[str, Array],
) -> Motion:
    """Put the motions of single bodies together in the order of a linkage.

    ``axes`` holds the joints from and to which the x axis of a body points, but of those on guides.
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
    for guide in linkage.guides:
        (name,) = (name for body, name in ends if body == guide.body)
        states[guide.body] = slider_state(joints[name], guide.angle)
    position, velocity, acceleration = (
        np.hstack([states[body.name][level] for body in linkage.bodies]) for level in range(3)
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

    ``rates`` are speeds of cranks 2 and 7, rad/s, in place of their own: velocities by them are
    partial derivatives.
    """
    geometry = press.geometry
    turn = press.speed * time
    turning_2: Turning = (CRANK_2_START - turn, -press.speed, 0.0)
    turning_7 = turning_7 or (CRANK_7_START + turn, press.speed, 0.0)
    if rates is not None:
        turning_2, turning_7 = (turning_2[0], rates[0], 0.0), (turning_7[0], rates[1], 0.0)
    o2 = fixed(geometry.hx, geometry.hy, time.size)
    o7 = fixed(0.0, 0.0, time.size)
    a = crank(o2, -press.length_2, turning_2)
    d = crank(o7, press.length_7, turning_7)
    b = dyad(d, a, geometry.side_bd, press.length_3, geometry.side_b)
    c = dyad(d, b, geometry.side_cd, geometry.side_bc, geometry.side_c)
    e = slide(c, press.length_5, (geometry.hx, 0.0), (0.0, 1.0), geometry.slider_side)
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


def servo_turning(press: Press, time: Array, slider: Array, guess: float) -> Turning:
    """What crank 7 does that gives the slider a motion, (n, 3), while crank 2 turns evenly.

    No dead point lies between ``guess``, rad, and the motion.
    """
    linkage, angle, still = press.linkage(), np.full(time.size, guess), np.zeros(time.size)

    def moved(rates: tuple[float, float]) -> Array:
        return press_motion(press, time, rates, (angle, still, still)).output(linkage)

    for _ in range(30):
        place, influence, _ = moved((0.0, 1.0)).T
        angle = angle - np.clip((place - slider[:, 0]) / influence, -0.2, 0.2)
    influence, driven = moved((0.0, 1.0))[:, 1], moved((-press.speed, 0.0))[:, 1]
    speed = (slider[:, 1] - driven) / influence
    bare = press_motion(press, time, None, (angle, speed, still)).output(linkage)[:, 2]
    return angle, speed, (slider[:, 2] - bare) / influence


def needed_by_virtual_work(
    press: Press, time: Array, upwards: Array, turning_7: Turning | None = None
) -> Array:
    """Torques of cranks 2 and 7 under a force on the slider, N, joints closed, (n, 2), N m."""
    linkage, motion = press.linkage(), press_motion(press, time, None, turning_7)
    mass = np.array([[body.mass, body.mass, body.inertia] for body in linkage.bodies]).ravel()
    force = -mass * motion.acceleration
    force[:, 1::3] -= press.gravity * mass[1::3]
    force[:, 3 * linkage.index("slider 6") + 1] += upwards
    ways = [
        press_motion(press, time, rates, turning_7).velocity for rates in ((1.0, 0.0), (0.0, 1.0))
    ]
    return -np.column_stack([_dot(force, way) for way in ways])


def slider_crank_motion(mechanism: SliderCrank, time: Array) -> Motion:
    """Motion of the slider-crank with all joints closed."""
    o = fixed(0.0, 0.0, time.size)
    turn = mechanism.speed * time
    a = crank(o, mechanism.crank_length, (turn, mechanism.speed, 0.0))
    b = slide(a, mechanism.rod_length, (0.0, 0.0), (1.0, 0.0), 1.0)
    axes = {"crank": ("O", "A"), "rod": ("A", "B")}
    return _together(mechanism.linkage(), time, {"O": o, "A": a, "B": b}, axes, {"crank": turn})
