"""Closed-form motion of planar linkages that are made of dyads.

Two links that meet in a joint are solved from their other ends alone: positions by
intersecting circles, velocities and accelerations by two linear equations.
"""

from dataclasses import dataclass

import numpy as np

from presswear.linkage.elements import Attachment
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError


@dataclass(frozen=True)
class Point:
    """A moving point: position, velocity, acceleration, each (n, 2)."""

    position: Array
    velocity: Array
    acceleration: Array

    @staticmethod
    def fixed(x: float, y: float, count: int) -> "Point":
        """A point at rest, at ``count`` times."""
        still = np.zeros((count, 2))
        return Point(still + np.array([x, y]), still, still)


@dataclass(frozen=True)
class Line:
    """A line on the frame: a point of it, m, and the unit vector along it.

    The vector and no angle: an upright line then keeps x exactly.
    """

    point: tuple[float, float]
    direction: tuple[float, float]


def _direction(angle: Array) -> Array:
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _left(vector: Array) -> Array:
    """The vector turned by +90 degrees."""
    return np.column_stack([-vector[:, 1], vector[:, 0]])


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=1))


def crank(centre: Point, length: float, angle: Array, speed: float) -> Point:
    """Tip of a crank turning at constant speed about a fixed point."""
    arm = length * _direction(angle)
    return Point(centre.position + arm, speed * _left(arm), -(speed**2) * arm)


@dataclass(frozen=True)
class Course:
    """Where a linkage must close.

    Attributes
    ----------
    angle : ndarray, shape (n,)
        Crank angles by which a message names the place, degrees.
    least : float
        Square of the sine of the angle by which each pair of links must be short of stretched.
    """

    angle: Array
    least: float

    def check(self, joint: str, square: Array, needed: str) -> None:
        """Raise AssemblyError where the square of the sine of a pair is not above the least."""
        if np.all(square > self.least):
            return
        worst = self.angle[int(np.argmin(square))]
        raise AssemblyError(
            f"the linkage cannot be assembled over the cycle: at crank angle {worst:.1f} deg "
            f"joint {joint} does not close or is at a dead point; {needed}"
        )


def dyad(
    p: Point, q: Point, from_p: float, from_q: float, side: float, joint: str, course: Course
) -> Point:
    """The point at given distances from two moving points, on a given side of p to q."""
    base = q.position - p.position
    length = np.sqrt(_dot(base, base))
    # Ends that coincide leave the direction open: a zero length is refused below.
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * np.maximum(length, 1e-12))
    square = from_p**2 - along**2
    reach = f"the distance {length[int(np.argmin(square))]:.4g} m between its links' other ends"
    allowed = f"must stay between {abs(from_p - from_q):.4g} and {from_p + from_q:.4g} m"
    course.check(joint, square / from_p**2, f"{reach} {allowed}")
    unit = base / length[:, None]
    height = side * np.sqrt(square)
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
    c: Point, length: float, line: Line, side: float, names: tuple[str, str, str], course: Course
) -> Point:
    """The end on a line of a rod from a moving point, ahead of it on the line or behind.

    Parameters
    ----------
    side : float
        1 ahead of the foot of ``c`` on the line, -1 behind.
    names : tuple of str
        Moving point, rod and joint on the line, for the message.
    """
    unit = np.array(line.direction)
    across = np.array([-unit[1], unit[0]])
    away = c.position - np.array(line.point)
    offset = away @ across
    square = length**2 - offset**2
    far = abs(offset[int(np.argmin(square))])
    point, rod, joint = names
    needed = f"{point} is {far:.4g} m from the guide, {rod} is {length:.4g} m long"
    course.check(joint, square / length**2, needed)
    reach = side * np.sqrt(square)
    offset_t, offset_tt = c.velocity @ across, c.acceleration @ across
    reach_t = -offset * offset_t / reach
    reach_tt = -(offset_t**2 + offset * offset_tt + reach_t**2) / reach

    def along(value: Array) -> Array:
        return value[:, None] * unit

    return Point(
        np.array(line.point) + along(away @ unit + reach),
        along(c.velocity @ unit + reach_t),
        along(c.acceleration @ unit + reach_tt),
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


def bar_state(own: Attachment, tail: Point, head: Point) -> BodyState:
    """Motion of a body whose x axis points from one of its points, ``own``, to another."""
    arm = head.position - tail.position
    square = _dot(arm, arm)
    theta = np.arctan2(arm[:, 1], arm[:, 0])
    omega = _dot(_left(arm), head.velocity - tail.velocity) / square
    alpha = _dot(_left(arm), head.acceleration - tail.acceleration) / square
    axis = _direction(theta)
    # From the tail to the mass centre, in global directions.
    lever = -(own.x * axis + own.y * _left(axis))
    position = tail.position + lever
    velocity = tail.velocity + omega[:, None] * _left(lever)
    acceleration = tail.acceleration + alpha[:, None] * _left(lever) - (omega**2)[:, None] * lever
    return (
        np.column_stack([position, theta]),
        np.column_stack([velocity, omega]),
        np.column_stack([acceleration, alpha]),
    )
