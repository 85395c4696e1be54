"""Parts of a planar linkage as data: bodies, ideal joints and clearance joints."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal, cast

from presswear.linkage.laws import FrictionLaw, NormalLaw
from presswear.linkage.points import LARGE, Attachment, End, Place, angle, place
from presswear.linkage.surface import Surface
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import check_fields

MapFrame = Literal["fixed", "body"]
Slip = Literal["angle", "sliding"]
WearDistribution = Literal["bin", "arc"]
SurfaceContact = Literal["radial", "foundation"]


MASS = Quantity("kg", 1e-9, 1e9, "", "mass")
INERTIA = Quantity(
    "kg m^2",
    0.0,
    1e15,
    "",
    "about the mass centre; of a bar m l^2 / 12 if not given; 0 for a body that cannot turn",
)
LEAST_INERTIA = 1e-18
"""Of a body that can turn, kg m^2."""


@dataclass(frozen=True)
class Body:
    """A rigid body.

    Attributes
    ----------
    mass, inertia : float
        kg; about its mass centre, kg m^2.  It may be 0 where the body cannot turn.
    points : tuple of (str, (float, float))
        Names for some of its points, in its frame with origin at the mass centre, m; a mapping
        may be given.
    """

    name: str
    mass: Annotated[float, MASS]
    inertia: Annotated[float, INERTIA] = 0.0
    points: Mapping[str, Place] | tuple[tuple[str, Place], ...] = ()

    def __post_init__(self) -> None:
        """InputError where a point is out of range."""
        check_fields(self)
        points = dict(self.points)
        for name, ends in points.items():
            Attachment(f"{self.name}.{name}", *ends)
        if points.get("centre", (0.0, 0.0)) != (0.0, 0.0):
            raise InputError(f"points.centre of {self.name}: this is the name of the mass centre")
        object.__setattr__(self, "points", tuple(points.items()))

    @property
    def effective_inertia(self) -> float:
        """Inertia in the equations of motion, kg m^2.

        A body without inertia cannot turn, so that any value gives the same motion.
        """
        return self.inertia or self.mass  # mass times 1 m^2


BAR = Quantity("m", 1e-6, LARGE, "", "of a bar: from its tail to its head, its mass centre halfway")
"""The length of a bar."""


def Bar(  # noqa: N802 - to whoever writes a linkage it is a kind of body
    name: str,
    length: float | str,
    mass: float | str,
    inertia: float | str | None = None,
) -> Body:
    """A bar: a body with the points ``tail`` and ``head`` at its ends.

    Its x axis points from tail to head, its mass centre is halfway.

    Parameters
    ----------
    length, mass : float
        m, kg.
    inertia : float or None
        About its mass centre, kg m^2; None: that of a thin rod, m l^2 / 12.
    """
    size = BAR.convert(f"length of {name}", length)
    m = MASS.convert(f"mass of {name}", mass)
    half = 0.5 * size
    ends = (("tail", (-half, 0.0)), ("head", (half, 0.0)))
    rod = m * size**2 / 12.0
    return Body(name, m, rod if inertia is None else cast(float, inertia), ends)


def bar_ends(body: str, length: float) -> tuple[Attachment, Attachment]:
    """Tail and head of a bar along its x axis, its mass centre halfway between them."""
    return Attachment(body, -0.5 * length, 0.0), Attachment(body, 0.5 * length, 0.0)


@dataclass(frozen=True)
class Pin:
    """A pin joint between two points as a person writes them; a linkage makes a Revolute of it."""

    name: str
    first: End
    second: End


@dataclass(frozen=True)
class Revolute:
    """An ideal pin joint between two points."""

    name: str
    first: Attachment
    second: Attachment


@dataclass(frozen=True)
class Guide:
    """A straight guide on the frame: the body slides along a line and does not turn.

    Attributes
    ----------
    body : str
        The body whose mass centre stays on the line.
    x, y : float
        A point of the line, m.
    direction : float
        Angle of the line, rad.
    angle : float
        Fixed angle of the body, rad.
    """

    name: str
    body: str
    x: float = place("a point of the line, to the right of the origin")
    y: float = place("a point of the line, above the origin")
    direction: float = angle("angle of the line")
    angle: float = angle("fixed angle of the body")

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)


@dataclass(frozen=True)
class WearLaw:
    """Archard wear dh = K_d p ds of a clearance joint.

    Attributes
    ----------
    coefficient : float
        K_d, 1/Pa.
    slip : {"angle", "sliding"}
        ``ds = (R_j + delta) |d phi|`` (equation 24), or ``|v_t| dt``.
    footprint : {"bin", "arc"}
        All into the bin of the contact with the mean pressure of equations 25 to
        28, or over the contact arc in proportion to the pressure there.
    bearing_share : float
        Part of the depth that the bearing loses; the pin loses the rest.
    angles : int
        Number of angular bins.
    """

    coefficient: float
    slip: Slip = "sliding"
    wear_distribution: WearDistribution = "arc"
    bearing_share: float = 0.5
    angles: int = 360


@dataclass(frozen=True)
class ClearanceJoint:
    """A pin joint with clearance: a pin loose in a bearing.

    Attributes
    ----------
    bearing, pin : Attachment
        Centres of the hole and of the pin.
    bearing_radius, clearance, width : float
        R_i, c = R_i - R_j and axial width b, m.
    normal, friction : NormalLaw, FrictionLaw
    wear : WearLaw or None
        None keeps no wear account.
    map_frame : {"fixed", "body"}
        Whether the wear maps stay fixed in direction or turn with their bodies.
    contact : {"radial", "foundation"}
        How worn surfaces meet: the pin's nearest point alone along e, or all of the arc
        through an elastic foundation.  Round ones meet by the normal law in both.
    bearing_surface, pin_surface : Surface
    """

    name: str
    bearing: Attachment
    pin: Attachment
    bearing_radius: float
    clearance: float
    width: float
    normal: NormalLaw
    friction: FrictionLaw = field(default_factory=FrictionLaw)
    wear: WearLaw | None = None
    map_frame: MapFrame = "body"
    contact: SurfaceContact = "radial"
    bearing_surface: Surface = field(default_factory=Surface)
    pin_surface: Surface = field(default_factory=Surface)

    @property
    def pin_radius(self) -> float:
        """R_j = R_i - c, m."""
        return self.bearing_radius - self.clearance

    @property
    def bins(self) -> int:
        """Angular bins of its wear maps; without an account those of its surfaces, or one."""
        if self.wear is not None:
            return self.wear.angles
        return max(self.bearing_surface.depth.size, self.pin_surface.depth.size, 1)
