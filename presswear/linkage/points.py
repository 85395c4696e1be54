"""Points of a linkage: on its bodies, on the frame, and what is watched."""

from dataclasses import dataclass
from typing import Annotated, Any

from presswear.tools.quantities import Quantity, quantity
from presswear.tools.serialize import check_fields

GROUND = "frame"

Place = tuple[float, float]
"""Coordinates, m."""

LARGE = 1e5
"""Of a length, m: no machine is larger, and a floor is a part of a round so large."""
TURNED = 1e4
"""Of an angle, rad: beyond it a sine has lost four digits."""


LENGTH = Quantity("m", -LARGE, LARGE, "", "")
ANGLE = Quantity("rad", -TURNED, TURNED, "", "")


def place(text: str = "") -> Any:
    """A dataclass field: a coordinate, m."""
    return quantity(0.0, "m", -LARGE, LARGE, "", text)


def angle(text: str = "", default: float | None = 0.0) -> Any:
    """A dataclass field: an angle, rad."""
    return quantity(default, "rad", -TURNED, TURNED, "", text)


@dataclass(frozen=True)
class Attachment:
    """A point of a body, in the body's frame with origin at the mass centre, m."""

    body: str
    x: Annotated[float, LENGTH]
    y: Annotated[float, LENGTH]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Probe:
    """The coordinate that a study watches: a point of a body along a direction, rad.

    Attributes
    ----------
    x, y : float
        The point in the body's frame with origin at the mass centre, m.
    """

    body: str
    direction: float = angle()
    x: float = place()
    y: float = place()

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)


End = Attachment | str | Place
"""A point: as it is, as ``body.point``, as ``body`` for its mass centre, or as coordinates on the
frame, m."""
