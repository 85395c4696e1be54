"""The driven mechanism that a scene studies, as far as the scene needs to know it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import Linkage
from presswear.tools.errors import InputError

Array = NDArray[np.float64]
BodyState = tuple[Array, Array, Array]
"""Position, velocity and acceleration of a body, each (n, 3): mass centre and angle."""


@dataclass(frozen=True)
class Motion:
    """Coordinates of all bodies over time, shapes (n,) and (n, 3 bodies), SI and rad."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array


class Mechanism(Protocol):
    """A driven mechanism: everything but its clearance joints."""

    @property
    def kind(self) -> str:
        """The word by which a stored scene names it."""

    @property
    def openable(self) -> tuple[str, ...]:
        """Names, one letter each, of the joints that may have clearance, in order."""

    @property
    def speed(self) -> float:
        """Speed of the driven crank, rad/s."""

    @property
    def period(self) -> float:
        """Time of one cycle, s."""

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""

    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed."""

    def ideal_motion(self, time: Array) -> Motion:
        """Motion of every body with all joints closed, at times (n,), s."""

    def check_assembly(self) -> None:
        """Raise AssemblyError unless the linkage closes over the whole cycle."""


HEAVIER = 1e6
"""Mass of the heaviest body over that of the lightest, at most.

Beyond it the accelerations of the light body are round-off of the forces on the heavy one:
runs crawl at the shortest step, or end there.
"""


def check_masses(masses: Mapping[str, float]) -> None:
    """InputError unless all bodies, kg by the names of their settings, can move together."""
    light, heavy = min(masses, key=masses.__getitem__), max(masses, key=masses.__getitem__)
    if masses[heavy] > HEAVIER * masses[light]:
        raise InputError(
            f"{heavy} = {masses[heavy]:g} kg beside {light} = {masses[light]:g} kg: allowed is "
            f"{HEAVIER:g} times as much"
        )


def motion_of(
    linkage: Linkage, time: Array, states: Mapping[str, BodyState], driven: Mapping[str, Array]
) -> Motion:
    """Put the states of single bodies together in the order of a linkage.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.
    states : mapping of str to BodyState
        By name of the body.
    driven : mapping of str to ndarray, shape (n,)
        Exact angles of the driven bodies, rad.  Angles of the others are made
        continuous in time.
    """
    order = [body.name for body in linkage.bodies]
    position, velocity, acceleration = (
        np.hstack([states[name][level] for name in order]) for level in range(3)
    )
    position[:, 2::3] = np.unwrap(position[:, 2::3], axis=0)
    for body, exact in driven.items():
        position[:, 3 * order.index(body) + 2] = exact
    return Motion(time, position, velocity, acceleration)
