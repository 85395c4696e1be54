"""A planar linkage as data: bodies, joints, drives and clearance joints.

One description serves every engine.  Coordinates of body ``i`` are the position
of its mass centre and its angle, ``q[3 i : 3 i + 3] = x, y, theta``, in the order
of ``Linkage.bodies``.  The frame is the name ``GROUND``; points on it are global.
"""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from presswear.linkage.laws import FrictionLaw, NormalLaw
from presswear.linkage.surface import Surface
from presswear.tools.arrays import Array

GROUND = "frame"

MapFrame = Literal["fixed", "body"]
Slip = Literal["angle", "sliding"]
Footprint = Literal["bin", "arc"]
SurfaceContact = Literal["radial", "foundation"]


@dataclass(frozen=True)
class Body:
    """A rigid body: mass, kg, and moment of inertia about its mass centre, kg m^2."""

    name: str
    mass: float
    inertia: float


@dataclass(frozen=True)
class Attachment:
    """A point of a body, in the body's frame with origin at the mass centre, m."""

    body: str
    x: float
    y: float


def bar_ends(body: str, length: float) -> tuple[Attachment, Attachment]:
    """Tail and head of a bar along its x axis, its mass centre halfway between them."""
    return Attachment(body, -0.5 * length, 0.0), Attachment(body, 0.5 * length, 0.0)


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
    x: float
    y: float
    direction: float
    angle: float = 0.0


@dataclass(frozen=True)
class Drive:
    """A body turned at constant speed: theta = angle + speed t, rad and rad/s."""

    name: str
    body: str
    angle: float
    speed: float

    def motion(self, time: Array) -> tuple[Array, Array, Array]:
        """Angle, rad, speed, rad/s, and acceleration, rad/s^2, at some instants, s."""
        return self.angle + self.speed * time, np.full_like(time, self.speed), np.zeros_like(time)


@dataclass(frozen=True)
class Spring:
    """A linear spring and damper between two points.

    Attributes
    ----------
    stiffness, damping : float
        N/m, N s/m.
    length : float
        Length without force, m.
    """

    name: str
    first: Attachment
    second: Attachment
    stiffness: float
    length: float
    damping: float = 0.0


@dataclass(frozen=True)
class Load:
    """A constant force, N, at the mass centre of a body and moment, N m, on it."""

    body: str
    x: float = 0.0
    y: float = 0.0
    moment: float = 0.0


@dataclass(frozen=True)
class WearLaw:
    """Archard wear dh = K_d p ds of a clearance joint.

    Attributes
    ----------
    coefficient : float
        K_d, 1/Pa.
    slip : {"angle", "sliding"}
        ds = (R_j + delta) |d phi| (equation 24), or |v_t| dt.
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
    footprint: Footprint = "arc"
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


@dataclass(frozen=True)
class Probe:
    """The coordinate that a study watches: a mass centre along a direction, rad."""

    body: str
    direction: float


@dataclass(frozen=True)
class Linkage:
    """A planar mechanism, driven, with or without clearance joints.

    Attributes
    ----------
    name : str
    bodies, revolutes, guides, drives, clearances : tuple
    probe : Probe
        What is recorded as ``slider``.
    gravity : float
        Acceleration along -y, m/s^2.
    springs, loads : tuple
    """

    name: str
    bodies: tuple[Body, ...]
    revolutes: tuple[Revolute, ...]
    guides: tuple[Guide, ...]
    drives: tuple[Drive, ...]
    clearances: tuple[ClearanceJoint, ...]
    probe: Probe
    gravity: float = 9.81
    springs: tuple[Spring, ...] = ()
    loads: tuple[Load, ...] = ()

    def index(self, body: str) -> int:
        """Position of a body in ``bodies``."""
        for position, candidate in enumerate(self.bodies):
            if candidate.name == body:
                return position
        raise KeyError(f"no body {body!r} in linkage {self.name!r}")

    def opened(self, joints: tuple[ClearanceJoint, ...]) -> "Linkage":
        """The same linkage with clearance joints in place of revolutes of the same name."""
        names = {joint.name for joint in joints}
        kept = tuple(joint for joint in self.revolutes if joint.name not in names)
        return replace(self, revolutes=kept, clearances=self.clearances + joints)
