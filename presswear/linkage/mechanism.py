"""Driven mechanisms that a scene studies: what a scene needs to know of one, and what all share."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

from presswear.linkage.linkage import Linkage
from presswear.tools.quantities import quantity
from presswear.tools.serialize import check_fields

SHORT, LONG = 1e-3, 10.0
"""Shortest and longest link that is still one of a machine, m."""


def length(status: str, default: float, text: str) -> Any:
    """A dataclass field: length of a link, m."""
    return quantity(default, "m", SHORT, LONG, status, text)


def mass(status: str, default: float, text: str) -> Any:
    """A dataclass field: mass of a body, kg."""
    return quantity(default, "kg", 1e-6, 1e4, status, text)


def inertia(status: str, default: float, text: str) -> Any:
    """A dataclass field: moment of inertia of a body, kg m^2."""
    return quantity(default, "kg m^2", 1e-9, 1e4, status, text)


@dataclass(frozen=True)
class Mechanism(ABC):
    """A driven mechanism, a data class of its quantities: everything but its clearance joints.

    Attributes
    ----------
    kind : str
        The word by which a stored scene names it.
    openable : tuple of str
        Names, one letter each, of the joints that may have clearance, in order.
    loose : tuple of str
        Those that have clearance where a scene does not say which.
    """

    kind: ClassVar[str]
    openable: ClassVar[tuple[str, ...]]
    loose: ClassVar[tuple[str, ...]]

    def __post_init__(self) -> None:
        """InputError where a quantity is out of range."""
        check_fields(self)

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
        """The ideal linkage, every joint closed, with a guess of how it is put together."""
