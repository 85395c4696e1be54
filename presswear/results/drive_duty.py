"""Duty of a drive: mean, root mean square and peak of torque and power; energy of a cycle."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.physics.ideal import Motion
from presswear.tools.arrays import Array


class Duty(NamedTuple):
    """Mean, root mean square and peak of a quantity of a drive over a cycle."""

    mean: float
    rms: float
    peak: float  # farthest from zero, with its sign


@dataclass(frozen=True)
class DriveDuty:
    """Duty of torque and power of a drive, and energy that it exchanges in a cycle."""

    torque: Duty  # N m; force of a drive along a guide, N
    power: Duty  # W
    supplied: float  # energy that the drive supplies in a cycle, J
    returned: float  # energy that the linkage returns to the drive in a cycle, J

    @property
    def work(self) -> float:
        """Net work in a cycle, J."""
        return self.supplied - self.returned


class DriveCurve(NamedTuple):
    """Motion and torque of a drive over time, arrays of shape (n,).

    Torque and power are empty if they were not stored.
    """

    time: Array  # s
    angle: Array  # angle of its body, rad; distance along its guide, m
    torque: Array  # on its body, N m; force of a drive along a guide, N
    power: Array  # W
    speed: Array  # speed of its body, rad/s; along its guide, m/s


def farthest_from_zero(values: Array) -> float:
    """Return the value of the largest magnitude, with its sign."""
    return float(values[np.abs(values).argmax()])


def duties_of(
    numbers: Mapping[str, Mapping[str, float]], period: float
) -> dict[str, DriveDuty]:
    """Return the duties of drives from integrals and peaks of a cycle, by driven body.

    Parameters
    ----------
    numbers : mapping of str to mapping of str to float
        Columns of ``DRIVE_CYCLE``, by driven body.
    period : float
        Duration of the cycle, s.
    """
    duties = {}
    for body, columns in numbers.items():
        supplied = columns["work_given"]
        returned = columns["work_returned"]
        torque = Duty(
            mean=columns["torque_integral"] / period,
            rms=math.sqrt(columns["torque_square_integral"] / period),
            peak=columns["torque_peak"],
        )
        power = Duty(
            mean=(supplied - returned) / period,
            rms=math.sqrt(columns["power_square_integral"] / period),
            peak=columns["power_peak"],
        )
        duties[body] = DriveDuty(torque, power, supplied, returned)
    return duties


def drive_curves(
    linkage: Linkage, motion: Motion, torque: Array | None
) -> dict[str, DriveCurve]:
    """Return the curves of drives in a motion, by driven body.

    ``torque`` has the shape (n, drives), N m. It is None if it was not stored.
    """
    curves = {}
    for k, drive in enumerate(linkage.drives):
        angle, speed = _coordinate(linkage, drive, motion)
        stored = np.zeros(0) if torque is None else torque[:, k]
        power = stored * speed[: stored.size]
        if isinstance(drive, GearedDrive):
            # The leading drive supplies the power.
            power = np.zeros_like(power)
        curves[drive.body] = DriveCurve(motion.time, angle, stored, power, speed)
    return curves


def _coordinate(linkage: Linkage, drive: Drive, motion: Motion) -> tuple[Array, Array]:
    """Return angle and angular velocity of a driven body, or distance and speed along a guide."""
    if isinstance(drive, LinearDrive):
        return _along(linkage, linkage.guide_of(drive), motion)
    column = 3 * linkage.index(drive.body) + 2
    return motion.position[:, column], motion.velocity[:, column]


def _along(linkage: Linkage, guide: Guide, motion: Motion) -> tuple[Array, Array]:
    """Return distance, m, and speed, m/s, of a body along its guide."""
    x, y, angle = _body(linkage, guide.on, motion.position)
    vx, vy, omega = _body(linkage, guide.on, motion.velocity)
    slide_x, slide_y, _ = _body(linkage, guide.body, motion.position)
    slide_vx, slide_vy, _ = _body(linkage, guide.body, motion.velocity)
    cosine = np.cos(angle + guide.direction)
    sine = np.sin(angle + guide.direction)
    along = (slide_x - x) * cosine + (slide_y - y) * sine
    across = (slide_y - y) * cosine - (slide_x - x) * sine
    speed = (slide_vx - vx) * cosine + (slide_vy - vy) * sine + omega * across
    # Distance of the point of the guide, in the axes of the body that carries the guide
    zero = guide.x * math.cos(guide.direction) + guide.y * math.sin(guide.direction)
    return along - zero, speed


def _body(linkage: Linkage, body: str, level: Array) -> Array:
    """Return the coordinates of a body, or their rates; zeros for the frame; shape (3, n)."""
    if body == GROUND:
        return np.zeros((3, len(level)))
    first = 3 * linkage.index(body)
    return level[:, first : first + 3].T
