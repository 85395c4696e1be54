"""Points of bodies and of the frame, and the units and limits of their coordinates."""

from dataclasses import dataclass
from typing import Annotated, Any

from presswear.tools.fields import quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked

GROUND = "frame"
# Largest length, m. No machine is larger, and a circle of this radius stands for a floor.
MAX_LENGTH = 1e5
MAX_ANGLE = 1e4  # rad: beyond it a sine has lost four digits

LENGTH = Quantity("m", -MAX_LENGTH, MAX_LENGTH)
ANGLE = Quantity("rad", -MAX_ANGLE, MAX_ANGLE)

Place = tuple[Annotated[float, LENGTH], Annotated[float, LENGTH]]
"""Coordinates, m."""


def place(text: str = "", default: float | None = 0.0) -> Any:
    """Return a data class field for a coordinate, m."""
    return quantity(default, "m", -MAX_LENGTH, MAX_LENGTH, "", text)


def angle(text: str = "", default: float | None = 0.0) -> Any:
    """Return a data class field for an angle, rad."""
    return quantity(default, "rad", -MAX_ANGLE, MAX_ANGLE, "", text)


@dataclass(frozen=True)
class Attachment(Checked):
    """Point of a body, in the frame of the body with origin at the mass centre, m."""

    body: str
    x: Annotated[float, LENGTH]
    y: Annotated[float, LENGTH]


@dataclass(frozen=True)
class OutputPoint(Checked):
    """Recorded coordinate: a point of a body along a direction."""

    body: str
    direction: float = angle("direction along which the output point is observed")
    x: float = place()
    y: float = place()

    @property
    def attachment(self) -> Attachment:
        """Point without the direction."""
        return Attachment(self.body, self.x, self.y)


End = Attachment | str | Place
"""Point: an attachment, ``body.point``, ``body`` for its mass centre, or coordinates on the
frame, m."""
