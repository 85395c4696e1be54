"""Loads on bodies: constant loads, forces at a point and moments with a law."""

from dataclasses import dataclass
from typing import Annotated, cast

from presswear.linkage.load_laws import Law, LawOf
from presswear.linkage.points import ANGLE, Attachment
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.serialize import Checked

MAX_LOAD = 1e12  # N or N m; the strongest press has 1e9


@dataclass(frozen=True)
class Load(Checked):
    """Constant force, N, at the mass centre of a body and moment, N m, on it."""

    body: str
    x: float = quantity(
        0.0, "N", -MAX_LOAD, MAX_LOAD, "", "force to the right, at the mass centre"
    )
    y: float = quantity(0.0, "N", -MAX_LOAD, MAX_LOAD, "", "force upwards")
    moment: float = quantity(
        0.0, "N m", -MAX_LOAD, MAX_LOAD, "", "moment, counterclockwise"
    )


@dataclass(frozen=True)
class Force(Checked):
    """Force at a point of a body, along a direction that stays fixed on the frame, rad.

    Reports show its name.

    Attributes
    ----------
    point : Attachment or str
        As ``body.point``, or as ``body`` for its mass centre.
    law : float, Harmonics, OverTime, OverPosition, callable or str
        Size along the direction, N; a constant, a law, or a user function of
        LOAD_PARAMETERS, also as ``FILE.py:NAME``. The position of a table is that of
        the point along the direction, measured from the origin of the frame.
    """

    point: Attachment | str
    direction: Annotated[float, ANGLE]
    law: Annotated[Law, LawOf("N")]
    name: str = ""

    @property
    def attachment(self) -> Attachment:
        """Point of the force, in an assembled linkage."""
        return cast(Attachment, self.point)

    @property
    def body(self) -> str:
        """Name of the body that it acts on."""
        if isinstance(self.point, str):
            return self.point.partition(".")[0]
        return self.point.body


@dataclass(frozen=True)
class Moment(Checked):
    """Moment on a body, counterclockwise, with a law of its size, N m, as a Force has.

    The position of a table is the angle of the body, continuous over several turns.
    """

    body: str
    law: Annotated[Law, LawOf("N m")]

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.law, float):
            raise InputError(f"law = {self.law:g} N m: use Load for a constant moment")


AnyLoad = Load | Force | Moment
