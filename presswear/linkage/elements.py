"""Parts of a planar linkage as data: points, bodies, ideal joints and clearance joints."""

import math
from collections.abc import Mapping
from dataclasses import InitVar, dataclass, field, replace
from typing import Annotated, Any, ClassVar, Literal, cast

from presswear.linkage.laws import (
    OILED_WEAR,
    WEAR_PARAMETERS,
    FrictionLaw,
    NormalLaw,
)
from presswear.linkage.surface import Surface
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked, checked_arguments, converted
from presswear.tools.user_function import UserFunction

MapFrame = Literal["fixed", "body"]
Slip = Literal["angle", "sliding"]
WearDistribution = Literal["bin", "arc"]
SurfaceContact = Literal["radial", "foundation"]
WearMaps = Literal["smoothed", "raw"]

GROUND = "frame"
MAX_LENGTH = 1e5  # m: no machine is larger, and a floor is a part of a circle so large
MAX_ANGLE = 1e4  # rad: beyond it a sine has lost four digits
MIN_INERTIA = 1e-18  # of a body that can turn, kg m^2
MIN_STIFFNESS, MAX_STIFFNESS = 1e3, 1e12  # of an elastic joint, N/m
MIN_SLIDE, MAX_SLIDE = 1e-3, 10.0  # length and width of a slide, m
DAMPING = 0.02  # of an elastic joint, part of the critical damping; assumed

# Greatest depth of a worn surface on a foundation, in clearances, and part of the radius
# of the bearing up to which the geometry of nearly equal circles holds
DEEPEST_CLEARANCES, DEEPEST_PART = 10.0, 0.1
DEEPEST_WORDS = (
    f"with wear of {DEEPEST_CLEARANCES:g} clearances or {DEEPEST_PART:g} bearing radii"
)

LENGTH = Quantity("m", -MAX_LENGTH, MAX_LENGTH)
ANGLE = Quantity("rad", -MAX_ANGLE, MAX_ANGLE)
MASS = Quantity("kg", 1e-9, 1e9, "", "mass")
INERTIA = Quantity(
    "kg m^2",
    0.0,
    1e15,
    "",
    "about the mass centre; 0 is allowed for a body that cannot turn",
)
BAR_LENGTH = Quantity("m", 1e-6, MAX_LENGTH, "", "length of a bar, tail to head")

Place = tuple[Annotated[float, LENGTH], Annotated[float, LENGTH]]
"""Coordinates, m."""


def place(text: str = "", default: float | None = 0.0) -> Any:
    """Return a data class field for a coordinate, m."""
    return quantity(default, "m", -MAX_LENGTH, MAX_LENGTH, "", text)


def angle(text: str = "", default: float | None = 0.0) -> Any:
    """Return a data class field for an angle, rad."""
    return quantity(default, "rad", -MAX_ANGLE, MAX_ANGLE, "", text)


def slide_size(text: str) -> Any:
    """Return a data class field for a size of a slide, m."""
    return quantity(None, "m", MIN_SLIDE, MAX_SLIDE, "chosen", text)


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
"""Point: as it is, as ``body.point``, as ``body`` for its mass centre, or as coordinates on the
frame, m."""


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
        left, below = 0.0, 0.0
        if centre is not None:
            left, below = converted(f"centre of {self.name}", centre, Place)
            object.__setattr__(self, "drawn_at", (left, below))
        points = {
            name: (x - left, y - below) for name, (x, y) in dict(self.points).items()
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
    size = BAR_LENGTH.convert(f"length of {name}", length)
    kilograms = MASS.convert(f"mass of {name}", mass)
    rod = kilograms * size**2 / 12.0
    ends = {"tail": (-0.5 * size, 0.0), "head": (0.5 * size, 0.0)}
    total = rod if inertia is None else cast(float, inertia)
    return Body(name, kilograms, total, ends | dict(points or {}))


@dataclass(frozen=True)
class Pin(Checked):
    """Pin joint between two points, as names or coordinates; see ``Revolute``."""

    name: str
    first: End
    second: End
    stiffness: float | None = quantity(
        None,
        unit="N/m",
        low=MIN_STIFFNESS,
        high=MAX_STIFFNESS,
        origin="chosen",
        text="stiffness of pin and rods in any direction; default: rigid",
    )
    damping_ratio: float = quantity(
        DAMPING,
        "",
        0.0,
        1.0,
        "assumed",
        "damping of an elastic pin, part of the critical one",
    )


@dataclass(frozen=True)
class Revolute(Checked):
    """Pin joint between two points, ideal or elastic, or with the friction of a bearing.

    An elastic one is ideal in the ideal motion of its linkage; see
    ``Linkage.released``. Friction is a moment r F_t(r omega, F) against the relative
    spin omega, with the radius r of the bearing, the joint force F and the force F_t of
    the friction law.
    """

    name: str
    first: Attachment
    second: Attachment
    bearing_radius: float = 0.0  # m
    friction: FrictionLaw = field(default_factory=FrictionLaw)
    stiffness: float | None = None  # N/m; None: rigid
    damping_ratio: float = DAMPING

    rows: ClassVar[int] = 2  # number of constraint equations

    @property
    def ends(self) -> tuple[Attachment, Attachment]:
        """Centres of bearing and pin."""
        return self.first, self.second

    @property
    def bearing(self) -> Attachment:
        """Centre of the bearing."""
        return self.first

    @property
    def pin(self) -> Attachment:
        """Centre of the pin."""
        return self.second


@dataclass(frozen=True)
class Guide(Checked):
    """Straight guide: the mass centre of a body stays on a line, and the body keeps its angle.

    Line and angle are those in the frame of the machine, or in that of the body ``on``,
    as a slot in a rocker. By default the line goes through the mass centre as drawn, or
    else through the origin. With a length and a width a guide may have clearance: the
    body, a slide of this size with its mass centre in the middle, then tilts between two
    walls; see ``GuideCorner``. A guide on the frame with a stiffness is a spring along
    its line, without force where the mass centre is at its point: the body stands there
    in the ideal motion of the linkage; see ``Linkage.released``.
    """

    name: str
    body: str
    x: float = place(
        "point of the line, to the right of the origin; default: as drawn", None
    )
    y: float = place("point of the line, above the origin; default: as drawn", None)
    direction: float = angle("angle of the line, from the x axis of frame or body")
    angle: float = angle("fixed angle of the body, from that of frame or body")
    stiffness: float | None = quantity(
        None,
        unit="N/m",
        low=MIN_STIFFNESS,
        high=MAX_STIFFNESS,
        origin="chosen",
        text="stiffness of a spring along the line, as of a frame; default: none",
    )
    damping: float = quantity(
        DAMPING,
        "",
        0.0,
        1.0,
        "assumed",
        "damping of the spring, part of the critical one",
    )
    length: float | None = slide_size(
        "length of the slide along a guide with clearance"
    )
    width: float | None = slide_size("width of the slide between its walls")
    on: str = GROUND  # body that carries the line

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.on == self.body:
            raise InputError(
                f"guide {self.name}: on = {self.on}: must be another body, or {GROUND}"
            )
        if self.is_moving and self.stiffness is not None:
            raise InputError(
                f"guide {self.name}: stiffness = {self.stiffness:g} N/m with on = {self.on}: "
                f"allowed is a stiffness with on = {GROUND}; use a spring between points of both "
                "bodies"
            )

    @property
    def is_moving(self) -> bool:
        """True if a body carries the line, and not the frame."""
        return self.on != GROUND

    @property
    def rows(self) -> int:
        """Number of constraint equations; that of a spring holds its length."""
        return 2 if self.stiffness is None else 3


Joint = Revolute | Guide


def ends_of(joint: Joint) -> tuple[Attachment, Attachment]:
    """Return the two points that a joint holds together; of a guide a point and the mass centre."""
    if isinstance(joint, Guide):
        return Attachment(joint.on, joint.x, joint.y), Attachment(joint.body, 0.0, 0.0)
    return joint.first, joint.second


@dataclass(frozen=True)
class WearLaw(Checked):
    """Archard wear dh = K_d p ds of a clearance joint.

    Attributes
    ----------
    slip : {"angle", "sliding"}
        ``ds = (R_j + delta) |d phi|`` (equation 24), or ``|v_t| dt``.
    wear_distribution : {"bin", "arc"}
        All into the bin of the contact with the mean pressure of equations 25 to 28, or
        over the contact arc in proportion to the pressure there.
    """

    coefficient: float  # K_d, 1/Pa
    slip: Slip = "sliding"
    wear_distribution: WearDistribution = "arc"
    # part of the depth that the bearing loses; the pin loses the rest
    bearing_share: float = 0.5
    angles: int = 360  # number of angular bins
    # wear coefficient of new surfaces over K_d; see ``physics.running_in``
    running_in: float = 1.0
    running_in_depth: float = 0.3e-6  # m
    pressure_exponent: float = 1.0  # m of dh = K_d p (p / p_ref)^(m - 1) ds
    pressure_reference: float = 10e6  # p_ref, Pa
    # K, 1/Pa, as a function of WEAR_PARAMETERS; see ``physics.user_wear``
    user_law: UserFunction | None = None

    @property
    def depends_on_pressure(self) -> bool:
        """True if a user law gives the coefficient as a function of the pressure."""
        law = self.user_law
        return law is not None and "pressure" in law.parameters(
            "wear_law", WEAR_PARAMETERS
        )


def deepest_wear(
    contact: SurfaceContact, clearance: float, bearing_radius: float
) -> float:
    """Return the depth, m, up to which the model of a worn surface holds.

    With radial contact it is the clearance: steep profiles would create energy.
    """
    if contact == "radial":
        return clearance
    most = min(DEEPEST_CLEARANCES * clearance, DEEPEST_PART * bearing_radius)
    return max(clearance, most)


@dataclass(frozen=True)
class Oil:
    """Oil and asperities of a joint whose film acts in the run."""

    viscosity: float  # Pa s
    roughness: float  # sigma of both surfaces together, m
    asperity_pressure: float  # Pa
    films: int = 1  # equal ones side by side, which divide the width
    damping_ratio: float = 0.0  # zeta of the elastic contact


@dataclass(frozen=True)
class ClearanceJoint(Checked):
    """Pin joint with clearance: a pin loose in a bearing.

    Attributes
    ----------
    map_frame : {"fixed", "body"}
        Wear maps stay fixed in direction, or turn with their bodies.
    contact : {"radial", "foundation"}
        Surfaces meet at the pin's nearest point along e by the elasticity of the normal
        law, or over the arc through an elastic foundation, whatever that elasticity is.
    """

    name: str
    bearing: Attachment  # centre of the hole
    pin: Attachment
    bearing_radius: float  # R_i, m
    clearance: float  # c = R_i - R_j, m
    width: float  # axial width b, m
    normal: NormalLaw
    friction: FrictionLaw = field(default_factory=FrictionLaw)
    wear: WearLaw | None = None  # None: no wear is computed
    map_frame: MapFrame = "body"
    contact: SurfaceContact = "radial"
    bearing_surface: Surface = field(default_factory=Surface)
    pin_surface: Surface = field(default_factory=Surface)
    oil: Oil | None = None  # None: dry

    @property
    def pin_radius(self) -> float:
        """R_j = R_i - c, m."""
        return self.bearing_radius - self.clearance

    @property
    def deepest_wear(self) -> float:
        """Depth up to which the model of worn surfaces holds, m."""
        if self.oil is not None:
            return OILED_WEAR * self.clearance
        return deepest_wear(self.contact, self.clearance, self.bearing_radius)

    @property
    def round_normal(self) -> NormalLaw:
        """Normal law while both surfaces are round."""
        if self.contact == "foundation":
            return replace(self.normal, elasticity="foundation")
        return self.normal

    @property
    def map_area(self) -> float:
        """Area of the surface of which the wear maps are, m^2."""
        return self.width * self.bearing_radius * 2.0 * math.pi

    @property
    def bins(self) -> int:
        """Angular bins of the wear maps; without an account those of the surfaces, or one."""
        if self.wear is not None:
            return self.wear.angles
        return max(self.bearing_surface.depth.size, self.pin_surface.depth.size, 1)


# of the map of a wall along its length; those of a press are half a millimetre long
WALL_BINS = 1000
WALLS = ("left", "right")  # of a guide, seen along its direction


@dataclass(frozen=True)
class WallMap:
    """Map of the wear along a wall, which both corners of the slide on its side share."""

    coefficient: float  # K_d, 1/Pa
    start: float  # of the map along the guide, from its point, m
    length: float  # m

    @property
    def bin_length(self) -> float:
        """Length of a bin, m."""
        return self.length / WALL_BINS


@dataclass(frozen=True)
class GuideCorner(ClearanceJoint):
    """Corner of a slide in a guide with clearance, which touches one of the two walls.

    ``pin`` is the corner and ``bearing`` the point beside the guide's at half the width
    of the slide. The clearance lies between this point and the wall. The pin radius is
    half the width. The surface of the bearing is that of the wall, over the bins of its
    map; both corners on a side share it. The slide does not wear.
    """

    guide: Guide = field(kw_only=True)
    side: float = field(kw_only=True)  # of the wall: 1 left of the direction, -1 right
    # None: no wear of the wall is computed
    wall: WallMap | None = field(default=None, kw_only=True)

    @property
    def deepest_wear(self) -> float:
        """Depth up to which the model of a worn wall holds, m."""
        return deepest_wear("foundation", self.clearance, self.pin_radius)

    @property
    def map_area(self) -> float:
        """Area of the map of the wall, m^2; zero without a map."""
        return 0.0 if self.wall is None else self.width * self.wall.length

    @property
    def bins(self) -> int:
        """Bins of the map of the wall; one without a map."""
        return 1 if self.wall is None else WALL_BINS


def slide_inertia(mass: float, guide: Guide) -> float:
    """Return the inertia of a slide, kg m^2, as a block of the size that its guide has."""
    assert guide.length is not None
    assert guide.width is not None
    return mass * (guide.length**2 + guide.width**2) / 12.0


def turning_clearance(guide: Guide) -> float:
    """Return the clearance, m, with which the walls are as far apart as the slide's diagonal."""
    assert guide.length is not None
    assert guide.width is not None
    return 0.5 * (math.hypot(guide.length, guide.width) - guide.width)


def largest_tilt(guide: Guide, clearance: float) -> float:
    """Return the tilt at which two opposite corners touch rigid walls, rad.

    It solves (W / 2) (1 - cos p) = (L / 2) sin p - c.
    """
    assert guide.length is not None
    assert guide.width is not None
    diagonal = math.hypot(guide.length, guide.width)
    slope = math.atan2(guide.width, guide.length)
    return math.asin((guide.width + 2.0 * clearance) / diagonal) - slope


def tilting_clearance(guide: Guide, tilt: float) -> float:
    """Return the clearance, m, with which the largest tilt is ``tilt``, rad."""
    assert guide.length is not None
    assert guide.width is not None
    diagonal = math.hypot(guide.length, guide.width)
    slope = math.atan2(guide.width, guide.length)
    return 0.5 * (diagonal * math.sin(tilt + slope) - guide.width)


CORNERS: Mapping[str, tuple[float, float]] = {
    "left front": (1.0, 1.0),
    "left back": (-1.0, 1.0),
    "right front": (1.0, -1.0),
    "right back": (-1.0, -1.0),
}
"""Corners of a slide by name: place along the guide and side, parts of half its size."""


def corner_ends(
    guide: Guide, along: float, side: float
) -> tuple[Attachment, Attachment]:
    """Return the point beside which a corner of a slide stands, and the corner.

    The point is on the frame, or on the body that carries the walls.
    """
    assert guide.length is not None
    assert guide.width is not None
    c, s = math.cos(guide.direction), math.sin(guide.direction)
    across = 0.5 * side * guide.width
    beside = Attachment(guide.on, guide.x - s * across, guide.y + c * across)
    turn = guide.direction - guide.angle
    c, s = math.cos(turn), math.sin(turn)
    x = 0.5 * along * guide.length
    return beside, Attachment(guide.body, c * x - s * across, s * x + c * across)


Bushing = ClearanceJoint | Revolute
"""Pin joint whose pin may rub in its bearing."""
