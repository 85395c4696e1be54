"""Rigid bodies of a linkage."""

from collections.abc import Mapping
from dataclasses import InitVar, dataclass, field
from typing import Annotated, Any, cast

from presswear.linkage.points import MAX_LENGTH, Place
from presswear.tools.arguments import checked_arguments
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked, converted

MIN_INERTIA = 1e-18  # smallest moment of inertia of a body that can turn, kg m^2

MASS = Quantity("kg", 1e-9, 1e9, "", "mass")
INERTIA = Quantity(
    "kg m^2",
    0.0,
    1e15,
    "",
    "about the mass centre; 0 is allowed for a body that cannot turn",
)
BAR_LENGTH = Quantity("m", 1e-6, MAX_LENGTH, "", "length of a bar, tail to head")


@dataclass(frozen=True)
class Body(Checked):
    """Rigid body: mass, kg, inertia about the mass centre, kg m^2, and points by name, m.

    Points are in the frame of the body with origin at the mass centre, or in a drawing
    in which ``centre`` is the mass centre, m. All bodies with a ``centre`` are in one
    drawing, in which the points of a joint coincide. The inertia may be 0 where the
    body cannot turn.
    """

    name: str
    mass: Annotated[float, MASS]
    inertia: Annotated[float, INERTIA] = 0.0
    points: Mapping[str, Place] | tuple[tuple[str, Place], ...] = ()
    centre: InitVar[Any] = None
    # Mass centre in the drawing, m; None: points are counted from the mass centre
    drawn_at: Place | None = field(default=None, init=False, compare=False, repr=False)

    def __post_init__(self, centre: Any) -> None:
        super().__post_init__()
        origin = (0.0, 0.0)
        if centre is not None:
            origin = converted(f"centre of {self.name}", centre, Place)
            object.__setattr__(self, "drawn_at", origin)
        points = {
            name: (x - origin[0], y - origin[1])
            for name, (x, y) in dict(self.points).items()
        }
        if points.get("centre", (0.0, 0.0)) != (0.0, 0.0):
            raise InputError(
                f"points.centre of {self.name}: this is the name of the mass centre"
            )
        object.__setattr__(self, "points", tuple(points.items()))

    def as_plain(self) -> dict[str, Any]:
        """Return the body as plain data, its points by name."""
        points = {name: list(place) for name, place in dict(self.points).items()}
        return {
            "name": self.name,
            "mass": self.mass,
            "inertia": self.inertia,
            "points": points,
        }

    @property
    def effective_inertia(self) -> float:
        """Inertia in the equations, kg m^2; any value where the body cannot turn."""
        return self.inertia or self.mass  # mass times 1 m^2


@checked_arguments
def Bar(  # noqa: N802 - in a linkage it is a kind of body
    name: str,
    length: float | str,
    mass: float | str,
    inertia: float | str | None = None,
    points: Mapping[str, Place] | None = None,
) -> Body:
    """Return a bar: a body with the points ``tail`` and ``head`` at its ends.

    Its x axis points from tail to head, its mass centre is halfway. Numbers are in m,
    kg and kg m^2, or texts with units. ``points`` names more points.

    Parameters
    ----------
    inertia : float, str or None
        About its mass centre; None: that of a thin rod, m l^2 / 12.
    """
    metres = BAR_LENGTH.convert(f"length of {name}", length)
    kilograms = MASS.convert(f"mass of {name}", mass)
    if inertia is None:
        inertia = kilograms * metres**2 / 12.0
    ends = {"tail": (-0.5 * metres, 0.0), "head": (0.5 * metres, 0.0)}
    all_points = ends | dict(points or {})
    return Body(name, kilograms, cast(float, inertia), all_points)
