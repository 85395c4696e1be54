"""A clearance joint as the kernels see it, and what its contact is described by.

e = pin centre - bearing centre, n = e / |e|, phi its direction, t = n turned by
+90 degrees.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.tools.compiled import compiled

Array = NDArray[np.float64]


class Pose(NamedTuple):
    """Position, angle and rates of one joint end: centre (m, m/s), body angle (rad, rad/s)."""

    x: float
    y: float
    vx: float
    vy: float
    lever_x: float
    lever_y: float
    angle: float
    spin: float


class Contact(NamedTuple):
    """The pin in its bearing at one instant; SI units.

    Attributes
    ----------
    penetration, rate : float
        Greatest overlap of the surfaces, and its rate.
    sliding, turning : float
        v_t at the contact point; rate of the direction of e, rad/s.
    normal_x, normal_y : float
        Direction in which the pin presses on the bearing.
    eccentricity, eccentricity_x, eccentricity_y : float
        e and its length.
    pin_arm, bearing_arm : float
        Distances of the contact point from the two centres, along the normal.
    approach : float
        Speed on which the normal force works.
    elastic, closing : float
        Elastic force, N, and the rate that damps it.
    energy : float
        Elastic energy, J.
    place : float
        On a foundation the direction of the greatest overlap, rad.
    couple : float
        Moment of the elastic pressure on the pin about the contact point, N m; the bearing
        bears the opposite.  A worn surface is not round.
    """

    penetration: float
    rate: float
    sliding: float
    turning: float
    normal_x: float
    normal_y: float
    eccentricity: float
    eccentricity_x: float
    eccentricity_y: float
    pin_arm: float
    bearing_arm: float
    approach: float
    elastic: float
    closing: float
    energy: float
    place: float
    couple: float


class Load(NamedTuple):
    """Forces of a joint: magnitudes normal and tangential, force on the pin, moments.

    The bearing gets the opposite force; both moments are about the mass centres.
    """

    normal: float
    tangential: float
    x: float
    y: float
    pin_moment: float
    bearing_moment: float


@compiled
def joint_end(body: int, local_x: float, local_y: float, q: Array, v: Array) -> Pose:
    """Where a point of a body is and how it moves; the frame for body -1."""
    if body < 0:
        return Pose(local_x, local_y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    angle = q[body + 2]
    spin = v[body + 2]
    cosine = math.cos(angle)
    sine = math.sin(angle)
    lever_x = cosine * local_x - sine * local_y
    lever_y = sine * local_x + cosine * local_y
    return Pose(
        q[body] + lever_x,
        q[body + 1] + lever_y,
        v[body] - spin * lever_y,
        v[body + 1] + spin * lever_x,
        lever_x,
        lever_y,
        angle,
        spin,
    )


@compiled
def direction_of(contact: Contact) -> float:
    """Direction phi of the eccentricity, rad."""
    return math.atan2(contact.eccentricity_y, contact.eccentricity_x)
