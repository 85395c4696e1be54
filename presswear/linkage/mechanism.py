"""Driven mechanisms that a scene studies: what a scene needs to know of one, and what all share."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np

from presswear.linkage.dyads import Point, bar_state, slider_state
from presswear.linkage.elements import Linkage
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.quantities import check_fields, quantity

SHORT, LONG = 1e-3, 10.0
"""Shortest and longest link that is still one of a machine, m."""

HEAVIER = 1e6
"""Mass of the heaviest body over that of the lightest, at most.

Beyond it the accelerations of the light body are round-off of the forces on the heavy one:
runs crawl at the shortest step, or end there.
"""


def length(status: str, default: float, text: str) -> Any:
    """A dataclass field: length of a link, m."""
    return quantity(default, "m", SHORT, LONG, status, text)


def mass(status: str, default: float, text: str) -> Any:
    """A dataclass field: mass of a body, kg."""
    return quantity(default, "kg", 1e-6, 1e4, status, text)


def inertia(status: str, default: float, text: str) -> Any:
    """A dataclass field: moment of inertia of a body, kg m^2."""
    return quantity(default, "kg m^2", 1e-9, 1e4, status, text)


def gravity() -> Any:
    """A dataclass field: acceleration along -y, m/s^2."""
    return quantity(9.81, "m/s^2", -100.0, 100.0, "assumed", "gravity along -y")


@dataclass(frozen=True)
class Motion:
    """Coordinates of all bodies over time, shapes (n,) and (n, 3 bodies), SI and rad."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class Mechanism(ABC):
    """A driven mechanism: everything but its clearance joints.

    A data class of its quantities; those whose names hold ``mass`` are masses of bodies.

    Attributes
    ----------
    kind : str
        The word by which a stored scene names it.
    openable : tuple of str
        Names, one letter each, of the joints that may have clearance, in order.
    """

    kind: ClassVar[str]
    openable: ClassVar[tuple[str, ...]]

    def __post_init__(self) -> None:
        """InputError where a quantity is out of range, or bodies cannot move together."""
        check_fields(self)
        names = [item.name for item in fields(self) if "mass" in item.name]
        masses = {name: getattr(self, name) for name in names}
        light, heavy = min(masses, key=masses.__getitem__), max(masses, key=masses.__getitem__)
        if masses[heavy] > HEAVIER * masses[light]:
            raise InputError(
                f"{heavy} = {masses[heavy]:g} kg beside {light} = {masses[light]:g} kg: allowed is "
                f"{HEAVIER:g} times as much"
            )

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """A mechanism from its fields as plain data."""
        return cls(**data)

    @property
    @abstractmethod
    def speed(self) -> float:
        """Speed of the driven crank, rad/s."""

    @property
    @abstractmethod
    def origin(self) -> str:
        """Where its values come from, in a sentence."""

    @property
    def period(self) -> float:
        """Time of one cycle, s."""
        return 2.0 * math.pi / self.speed

    @abstractmethod
    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed."""

    def ideal_motion(self, time: Array) -> Motion:
        """Motion of every body with all joints closed, in closed form.

        Parameters
        ----------
        time : ndarray, shape (n,)
            s.

        Raises
        ------
        AssemblyError
            Where two links cannot meet; says which, and at what crank angle.
        """
        return self._motion(np.atleast_1d(np.asarray(time, dtype=float)), 0.0)

    @abstractmethod
    def _motion(self, time: Array, least: float) -> Motion:
        """``ideal_motion``, refused unless each pair of links is bent by ``least``.

        That is the square of the sine of the angle by which it is short of stretched.
        """

    @abstractmethod
    def check_assembly(self) -> None:
        """Raise AssemblyError unless the linkage closes over the whole cycle."""


def motion_of(
    linkage: Linkage, time: Array, joints: Mapping[str, Point], axes: Mapping[str, tuple[str, str]]
) -> Motion:
    """Put the motions of single bodies together in the order of a linkage.

    Angles of driven bodies are exact; those of the others are made continuous in time.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    joints : mapping of str to Point
        Motions of the revolute joints by their names; a body on a guide has one, in its mass
        centre.
    axes : mapping of str to tuple of str
        Joints by name of the body that its x axis points from and to; none of bodies on guides.
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
    for drive in linkage.drives:
        position[:, 3 * linkage.index(drive.body) + 2] = drive.angle + drive.speed * time
    return Motion(time, position, velocity, acceleration)
