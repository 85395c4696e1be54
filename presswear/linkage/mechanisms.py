"""Driven mechanisms made of a few quantities: the press of the paper and three simpler ones.

Bodies of the press are numbered as in the paper: frame 1, crank 2, rod 3, triangular
plate 4, rod 5, slider 6, crank 7. The paper does not print enough to fix the mechanism;
each value tells whether it is the paper's, chosen or assumed. The slider-crank is that
of the literature on joints with clearance (Flores), from memory and not checked against
a page.
"""

import cmath
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, ClassVar, NamedTuple

from presswear.linkage.drives import Drive, torque_limit
from presswear.linkage.elements import (
    DAMPING,
    MAX_STIFFNESS,
    MIN_STIFFNESS,
    Attachment,
    Bar,
    Body,
    End,
    Guide,
    OutputPoint,
    Pin,
    Place,
    slide_size,
)
from presswear.linkage.linkage import Linkage, assemble, gravity, run_up
from presswear.linkage.motor import Motor
from presswear.linkage.servos import SERVOS, ConstantSpeed, Servo
from presswear.tools.errors import InputError
from presswear.tools.quantities import (
    choice,
    named_set,
    one_of,
    optional,
    quantity,
    written,
)
from presswear.tools.serialize import Checked

MIN_LINK, MAX_LINK = 1e-3, 10.0  # length of a link, m
# of a crank, rad/s: 0.1 rpm; heavy presses run at 6 to 8 rpm
MIN_SPEED = 0.1 * math.pi / 30.0
LITERATURE = "literature, from memory"
CRANK_2_START = math.radians(-119.27)
CRANK_7_START = math.radians(-51.18)
RIGHT, LEFT = -1.0, 1.0
BELOW, ABOVE = -1.0, 1.0
CHOSEN = "Dimensions, masses and speed are chosen."
_OF_BAR = "length", "mass", "inertia"
_ROD = "; default: that of a thin rod"
# rod over crank: an upright rod leaves the side of the slider open
_MIN_ROD_RATIO = 1.0001


def _number(
    unit: str, low: float, high: float, origin: str, default: float | None, text: str
) -> Any:
    return quantity(default, unit, low, high, origin, text)


_length = partial(_number, "m", MIN_LINK, MAX_LINK)
_mass = partial(_number, "kg", 1e-6, 1e4)
_inertia = partial(_number, "kg m^2", 1e-9, 1e4)
_side = partial(_length, "paper, reading chosen")
_p_length, _p_mass, _p_inertia = (
    partial(make, "paper") for make in (_length, _mass, _inertia)
)
_l_length, _l_mass = (partial(make, LITERATURE) for make in (_length, _mass))
_c_length, _c_mass, _c_inertia = (
    partial(make, "chosen") for make in (_length, _mass, _inertia)
)
_c_speed = partial(_number, "rad/s", MIN_SPEED, 5000.0, "chosen")
_frame_mass = partial(
    _number,
    "kg",
    1.0,
    1e6,
    "assumed",
    None,
    "reduced mass of crown and bed, which move on a frame with a frame_stiffness",
)
_frame_stiffness = partial(
    _number,
    "N/m",
    MIN_STIFFNESS,
    MAX_STIFFNESS,
    "chosen",
    None,
    "stiffness of the frame along the output direction; default: rigid",
)
_frame_damping = partial(
    _number,
    "",
    0.0,
    1.0,
    "assumed",
    DAMPING,
    "damping of the frame, part of the critical one",
)
_guide_length = partial(
    slide_size, "length of the slide along its guide, for a guide with clearance"
)
_guide_width = partial(
    slide_size, "width of the slide between its walls, for a guide with clearance"
)


_motor = partial(
    optional,
    Motor,
    {"torque": 0.0},
    "motor of the crank; none: the crank turns at its nominal speed",
)


class _Crown(NamedTuple):
    """Part of an elastic frame in which cranks turn; without bodies on a rigid frame."""

    bodies: tuple[Body, ...]
    guides: tuple[Guide, ...]
    ends: Mapping[str, End]  # of the pins on the frame, by joint


class Mechanism(Checked, ABC):
    """Driven mechanism, a data class of its quantities: everything but its clearance joints."""

    kind: ClassVar[str]  # word for it in a stored scene
    allowed_joints: ClassVar[tuple[str, ...]]  # joints that may have clearance
    default_joints: ClassVar[tuple[str, ...]]  # joints that have clearance by default
    origin: ClassVar[str]  # of its values, in a sentence
    speed: float  # of the driven crank, rad/s
    torque_limit: float | None  # N m
    # Elastic frame; None: rigid
    frame_mass: float | None = None  # kg
    frame_stiffness: float | None = None  # N/m
    frame_damping: float = DAMPING
    motor: Motor | None = None  # of the driven crank; None: it turns at its speed
    # Slide in its guide; None: without clearance
    guide_length: float | None = None  # m
    guide_width: float | None = None  # m

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.frame_stiffness is not None and self.frame_mass is None:
            stiffness = written(self.frame_stiffness, "N/m")
            raise InputError(
                f"frame_stiffness = {stiffness}: it needs a frame_mass, such as 600 kg"
            )
        if self.motor is not None and self.motor.is_servo:
            raise InputError(
                "motor: a torque or a user law is expected, not a stiffness, which only a servo "
                "has; 0 N m is a free crank"
            )

    def _crown(self, direction: float, pivots: Mapping[str, Place]) -> _Crown:
        """Return the crown of an elastic frame that moves along a direction, rad.

        ``pivots`` are the places of joints on the frame, m.
        """
        if self.frame_stiffness is None or self.frame_mass is None:
            return _Crown((), (), pivots)
        crown = Body("crown", self.frame_mass, points=pivots)
        guide = Guide(
            "frame",
            crown.name,
            *(0.0, 0.0),
            direction=direction,
            stiffness=self.frame_stiffness,
            damping=self.frame_damping,
        )
        ends = {joint: f"{crown.name}.{joint}" for joint in pivots}
        return _Crown((crown,), (guide,), ends)

    def _slide_inertia(self, mass: float) -> float:
        """Return the inertia of a slide, kg m^2; it enters only where its guide has clearance."""
        if self.guide_length is None or self.guide_width is None:
            return 1.0
        return mass * (self.guide_length**2 + self.guide_width**2) / 12.0

    @property
    def period(self) -> float:
        """Time of one cycle, s."""
        return 2.0 * math.pi / self.speed

    @property
    def unread(self) -> tuple[str, ...]:
        """Settings without effect: of a frame that is rigid, and the limit of a motor."""
        rigid = self.frame_stiffness is None
        frame = ("frame_mass", "frame_damping") if rigid else ()
        return (*frame, *(("torque_limit",) if self.motor else ()))

    def _drive(self, crank: str, start: float = 0.0) -> Drive:
        """Return the drive of the only driven crank, from an angle, rad."""
        limit = None if self.motor else self.torque_limit
        return Drive(crank, self.speed, start, torque_limit=limit, motor=self.motor)

    def linkage(self) -> Linkage:
        """Return the ideal linkage, every joint closed."""
        return _assembled(self)

    @abstractmethod
    def _assemble(self) -> Linkage: ...


@lru_cache(maxsize=64)
def _assembled(mechanism: Mechanism) -> Linkage:
    return mechanism._assemble()  # once: a scene asks for it several times


@dataclass(frozen=True)
class Geometry(Checked):
    """Frame joint O2, sides of the plate, and the branch in which the linkage is assembled.

    The paper prints none of these unambiguously. ``side_b`` is the side of the line
    from D to A on which B lies, ``side_c`` that of the line from D to B on which C lies
    (RIGHT or LEFT); ``slider_side`` is BELOW or ABOVE C.
    """

    hx: float = quantity(
        0.240, "m", -MAX_LINK, MAX_LINK, "chosen", "O2 to the right of O7"
    )
    hy: float = quantity(0.1345, "m", -MAX_LINK, MAX_LINK, "chosen", "O2 above O7")
    side_bd: float = _side(0.39, "plate side B to D")
    side_bc: float = _side(0.21, "plate side B to C")
    side_cd: float = _side(0.233, "plate side C to D")
    side_b: float = RIGHT
    side_c: float = RIGHT
    slider_side: float = BELOW

    def __post_init__(self) -> None:
        super().__post_init__()
        for side in ("side_b", "side_c", "slider_side"):
            value = getattr(self, side)
            if value not in (-1.0, 1.0):
                raise InputError(
                    f"{side} = {value:g}: allowed is -1 (right, below) or 1 (left, above)"
                )
        short, middle, longest = sorted((self.side_bd, self.side_bc, self.side_cd))
        if longest >= short + middle:
            allowed = (
                f"must be below the sum of the others, {written(short + middle, 'm')}"
            )
            fault = f"its longest side {written(longest, 'm')} {allowed}"
            raise InputError(f"plate 4 is not a triangle: {fault}")


# they meet the two printed peaks about equally well
GEOMETRIES: dict[str, Geometry] = {
    "standard": Geometry(),
    "swapped": Geometry(hx=0.210, side_bc=0.233, side_cd=0.21),
    "lifted": Geometry(
        hx=-0.208,
        hy=-0.195,
        side_bd=0.233,
        side_bc=0.39,
        side_cd=0.21,
        side_c=LEFT,
        slider_side=ABOVE,
    ),
}


@dataclass(frozen=True)
class Press(Mechanism):
    """Hybrid-driven seven-bar press of the paper."""

    kind = "press"
    allowed_joints = ("O2", "O7", "A", "B", "C", "D", "E", "guide")
    default_joints = ("A", "C")
    origin = (
        "The geometry and several parameters are chosen, not the paper's: it does not print enough "
        "to fix the mechanism."
    )

    geometry: Geometry = named_set(
        "standard", GEOMETRIES, "named geometry; a choice, the paper does not fix it"
    )
    length_2: float = _p_length(0.07, "crank 2, O2 to A")
    length_3: float = _p_length(0.34, "rod 3, A to B")
    length_5: float = _p_length(0.40, "rod 5, C to E")
    length_7: float = _p_length(0.07, "crank 7, O7 to D")
    mass_2: float = _p_mass(0.0243, "mass of crank 2")
    mass_3: float = _p_mass(0.1085, "mass of rod 3")
    mass_4: float = _p_mass(0.4503, "mass of plate 4")
    mass_5: float = _p_mass(0.1272, "mass of rod 5")
    mass_6: float = _p_mass(0.0288, "mass of slider 6")
    mass_7: float = _p_mass(0.0243, "mass of crank 7")
    inertia_2: float = _p_inertia(
        5.396e-4, "inertia of crank 2 (affects the drive torque only)"
    )
    inertia_3: float = _p_inertia(1.1e-3, "inertia of rod 3")
    inertia_4: float = _p_inertia(3.779e-3, "inertia of plate 4")
    inertia_5: float = _p_inertia(1.771e-3, "inertia of rod 5")
    inertia_7: float = _p_inertia(
        5.396e-4, "inertia of crank 7 (affects the drive torque only)"
    )
    gravity: float = gravity()
    speed: float = quantity(
        3.5 * math.pi,
        "rad/s",
        MIN_SPEED,
        40.0 * math.pi,
        "paper, per study",
        "crank speed omega: crank 7 turns at +omega, crank 2 at -omega",
    )
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = _frame_mass()
    frame_stiffness: float | None = _frame_stiffness()
    frame_damping: float = _frame_damping()
    motor: Motor | None = _motor()
    guide_length: float | None = _guide_length()
    guide_width: float | None = _guide_width()
    servo: Servo | None = one_of(
        SERVOS, "servo motion of crank 7; none: it turns at constant speed, as crank 2"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        has_servo = self.servo is not None and self.servo.motor is not None
        if self.motor is None and has_servo:
            raise InputError(
                "servo.stiffness: the servo follows the angle of crank 2, which has no motor; give "
                "it one, such as motor.torque = 20 N m, or leave out servo.stiffness, and crank 7 "
                "follows the motion exactly"
            )
        if self.motor is not None and not has_servo:
            raise InputError(
                "motor: crank 7 follows the time, but the motor of crank 2 does not; give crank 7 "
                "a servo, which follows the angle of crank 2, such as servo.stiffness = "
                "1e5 N m/rad"
            )

    @property
    def unread(self) -> tuple[str, ...]:
        """Settings without effect; a servo saturates at its limit or at that of the press."""
        names = super().unread
        if self.servo is not None and self.servo.stiffness is None:
            names += ("servo.damping",)
        if self.servo is None or self.servo.torque_limit is None:
            names = tuple(name for name in names if name != "torque_limit")
        return names

    def plate_corners(self) -> dict[str, Attachment]:
        """Return B, C, D in the plate's frame: origin at the centroid, x axis along D to B."""
        bd, bc, cd = self.geometry.side_bd, self.geometry.side_bc, self.geometry.side_cd
        along = (bd**2 + cd**2 - bc**2) / (2.0 * bd)
        across = self.geometry.side_c * math.sqrt(cd**2 - along**2)
        x, y = (bd + along) / 3.0, across / 3.0
        corners = {"D": (0.0, 0.0), "B": (bd, 0.0), "C": (along, across)}
        return {
            name: Attachment("plate 4", a - x, b - y)
            for name, (a, b) in corners.items()
        }

    def _assemble(self) -> Linkage:
        # Rod 3 points from B to A, rod 5 from E to C and the cranks as in equation 14;
        # the slider's angle of 90 degrees there is the direction of its guide.
        geometry, corner = self.geometry, self.plate_corners()
        pivots = {"O2": (geometry.hx, geometry.hy), "O7": (0.0, 0.0)}
        crown = self._crown(0.5 * math.pi, pivots)
        return assemble(
            name="seven-bar press",
            bodies=(
                *crown.bodies,
                Bar("crank 2", self.length_2, self.mass_2, self.inertia_2),
                Bar("rod 3", self.length_3, self.mass_3, self.inertia_3),
                Body("plate 4", self.mass_4, self.inertia_4),
                Bar("rod 5", self.length_5, self.mass_5, self.inertia_5),
                Body("slider 6", self.mass_6, self._slide_inertia(self.mass_6)),
                Bar("crank 7", self.length_7, self.mass_7, self.inertia_7),
            ),
            joints=(
                *crown.guides,
                Pin("O2", crown.ends["O2"], "crank 2.head"),
                Pin("O7", crown.ends["O7"], "crank 7.tail"),
                Pin("A", "rod 3.head", "crank 2.tail"),
                Pin("B", "rod 3.tail", corner["B"]),
                Pin("C", "rod 5.head", corner["C"]),
                Pin("D", "crank 7.head", corner["D"]),
                Pin("E", "rod 5.tail", "slider 6"),
                Guide(
                    "guide",
                    "slider 6",
                    geometry.hx,
                    0.0,
                    0.5 * math.pi,
                    angle=0.5 * math.pi,
                    length=self.guide_length,
                    width=self.guide_width,
                ),
            ),
            drives=(
                Drive(
                    "crank 2",
                    -self.speed,
                    CRANK_2_START,
                    torque_limit=None if self.motor else self.torque_limit,
                    motor=self.motor,
                ),
                self._drive_7,
            ),
            output=OutputPoint("slider 6", 0.5 * math.pi),
            guess=self.guess,
            gravity=self.gravity,
            run_up=self.run_up,
        )

    @property
    def _drive_7(self) -> Drive:
        servo = self.servo or ConstantSpeed()
        drive = servo.drive("crank 7", self.speed, "slider 6.centre")
        limit = servo.torque_limit or self.torque_limit
        return replace(drive, torque_limit=limit, motor=servo.motor)

    @property
    def guess(self) -> Mapping[str, float]:
        """Angles of the rods and the plate at the start, rad, from circles that meet."""
        geometry = self.geometry
        a = complex(geometry.hx, geometry.hy) - cmath.rect(self.length_2, CRANK_2_START)
        d = cmath.rect(self.length_7, self._drive_7.angle)
        b = _meeting(d, a, geometry.side_bd, self.length_3, geometry.side_b)
        c = _meeting(d, b, geometry.side_cd, geometry.side_bc, geometry.side_c)
        across = c.real - geometry.hx
        down = math.sqrt(max(self.length_5**2 - across**2, 0.0))
        rod_5 = complex(across, -geometry.slider_side * down)
        return {
            "rod 3": cmath.phase(a - b),
            "plate 4": cmath.phase(b - d),
            "rod 5": cmath.phase(rod_5),
        }


def _meeting(
    p: complex, q: complex, from_p: float, from_q: float, side: float
) -> complex:
    """Return the point at distances from p and q, on a side of the line p to q, or nearly."""
    length = max(abs(q - p), 1e-12)
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    across = side * math.sqrt(max(from_p**2 - along**2, 0.0))
    return p + complex(along, across) * (q - p) / length


@dataclass(frozen=True)
class SliderCrank(Mechanism):
    """Slider-crank: the crank turns about O, the rod joins it in A and the slider in B.

    The slider moves on a line through O. Mass centres are at mid-length and the rod
    carries the bearings (both assumed).
    """

    kind = "slider-crank"
    allowed_joints = ("O", "A", "B", "guide")
    default_joints = ("B",)
    origin = (
        "The default dimensions, masses and speed are those of a slider-crank that the literature "
        "on joints with clearance has studied (Flores), from memory and not checked against a page."
    )

    crank_length: float = _l_length(0.05, "crank, O to A")
    rod_length: float = _l_length(0.12, "rod, A to B; longer than the crank")
    crank_mass: float = _l_mass(0.30, "mass of the crank")
    rod_mass: float = _l_mass(0.21, "mass of the rod")
    slider_mass: float = _l_mass(0.14, "mass of the slider")
    slide_angle: float = quantity(
        *(-0.5 * math.pi, "rad", -2.0 * math.pi, 2.0 * math.pi, "chosen"),
        "direction from O to the slider, from x; -90 deg: below O",
    )
    crank_inertia: float | None = _c_inertia(
        None, f"inertia of the crank (torque only){_ROD}"
    )
    rod_inertia: float | None = _c_inertia(None, f"inertia of the rod{_ROD}")
    gravity: float = gravity()
    speed: float = quantity(
        5000.0 * math.pi / 30.0,
        "rad/s",
        MIN_SPEED,
        5000.0,
        LITERATURE,
        "crank speed omega",
    )
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = _frame_mass()
    frame_stiffness: float | None = _frame_stiffness()
    frame_damping: float = _frame_damping()
    motor: Motor | None = _motor()
    guide_length: float | None = _guide_length()
    guide_width: float | None = _guide_width()

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_rod(self.rod_length, self.crank_length, "joint B does not close")

    def _assemble(self) -> Linkage:
        # Crank and rod, from O to A and from A to B, begin in the direction of the
        # slide.
        along = self.slide_angle
        upward = along if math.sin(along) >= 0.0 else along + math.pi
        crown = self._crown(upward, {"O": (0.0, 0.0)})
        return assemble(
            name="slider-crank",
            bodies=(
                *crown.bodies,
                *_bars(self, "crank", "rod"),
                Body("slider", self.slider_mass, self._slide_inertia(self.slider_mass)),
            ),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "rod.tail", "crank.head"),
                Pin("B", "rod.head", "slider"),
                Guide(
                    "guide",
                    "slider",
                    direction=upward,
                    length=self.guide_length,
                    width=self.guide_width,
                ),
            ),
            drives=(self._drive("crank", along),),
            guess={"rod": along},
            gravity=self.gravity,
            run_up=self.run_up,
        )


@dataclass(frozen=True)
class FourBar(Mechanism):
    """Four-bar linkage: the crank turns about O, the coupler joins it in A and the rocker in B.

    The rocker turns about P, to the right of O. The output point is B. Mass centres are
    at mid-length.
    """

    kind = "four-bar"
    allowed_joints = ("O", "A", "B", "P")
    default_joints = ("B",)
    origin = CHOSEN

    frame_length: float = _c_length(0.18, "frame, O to P")
    crank_length: float = _c_length(0.05, "crank, O to A")
    coupler_length: float = _c_length(0.20, "coupler, A to B")
    rocker_length: float = _c_length(0.12, "rocker, B to P")
    crank_mass: float = _c_mass(0.3, "mass of the crank")
    coupler_mass: float = _c_mass(0.5, "mass of the coupler")
    rocker_mass: float = _c_mass(0.4, "mass of the rocker")
    crank_inertia: float | None = _c_inertia(
        None, f"inertia of the crank (torque only){_ROD}"
    )
    coupler_inertia: float | None = _c_inertia(None, f"inertia of the coupler{_ROD}")
    rocker_inertia: float | None = _c_inertia(None, f"inertia of the rocker{_ROD}")
    side: str = choice(
        "above", ("above", "below"), "side of the frame on which the rocker begins"
    )
    gravity: float = gravity()
    speed: float = _c_speed(10.0 * math.pi, "crank speed omega")
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = _frame_mass()
    frame_stiffness: float | None = _frame_stiffness()
    frame_damping: float = _frame_damping()
    motor: Motor | None = _motor()

    def _assemble(self) -> Linkage:
        # The crank points from O to A, the coupler from A to B, the rocker from P to B.
        a, p = complex(self.crank_length), complex(self.frame_length)
        side = LEFT if self.side == "above" else RIGHT
        b = _meeting(a, p, self.coupler_length, self.rocker_length, side)
        crown = self._crown(0.0, {"O": (0.0, 0.0), "P": (self.frame_length, 0.0)})
        return assemble(
            name=self.kind,
            bodies=(*crown.bodies, *_bars(self, "crank", "coupler", "rocker")),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "crank.head", "coupler.tail"),
                Pin("B", "coupler.head", "rocker.head"),
                Pin("P", crown.ends["P"], "rocker.tail"),
            ),
            drives=(self._drive("crank"),),
            guess={"coupler": cmath.phase(b - a), "rocker": cmath.phase(b - p)},
            output="rocker.head",
            gravity=self.gravity,
            run_up=self.run_up,
        )


@dataclass(frozen=True)
class SixBar(Mechanism):
    """Knuckle-joint press: a crank and a rod straighten two links, which push the slider down.

    The crank turns about O, the rod joins it in A and the upper link in B. The upper
    link turns about P and joins the lower link in C, at the same place as B; the lower
    link joins the slider in D, below P. Mass centres are at mid-length.
    """

    kind = "six-bar"
    allowed_joints = ("O", "A", "B", "P", "C", "D")
    default_joints = ("B",)
    origin = CHOSEN

    crank_x: float = quantity(
        -0.27, "m", -MAX_LINK, MAX_LINK, "chosen", "O to the right of P"
    )
    crank_y: float = quantity(-0.06, "m", -MAX_LINK, MAX_LINK, "chosen", "O above P")
    crank_length: float = _c_length(0.042, "crank, O to A")
    rod_length: float = _c_length(0.24, "rod, A to B")
    upper_length: float = _c_length(0.15, "upper link, P to B and C")
    lower_length: float = _c_length(0.20, "lower link, C to D")
    crank_mass: float = _c_mass(2.0, "mass of the crank")
    rod_mass: float = _c_mass(3.0, "mass of the rod")
    upper_mass: float = _c_mass(2.5, "mass of the upper link")
    lower_mass: float = _c_mass(3.0, "mass of the lower link")
    slider_mass: float = _c_mass(10.0, "mass of the slider")
    crank_inertia: float | None = _c_inertia(
        None, f"inertia of the crank (torque only){_ROD}"
    )
    rod_inertia: float | None = _c_inertia(None, f"inertia of the rod{_ROD}")
    upper_inertia: float | None = _c_inertia(None, f"inertia of the upper link{_ROD}")
    lower_inertia: float | None = _c_inertia(None, f"inertia of the lower link{_ROD}")
    gravity: float = gravity()
    speed: float = _c_speed(2.0 * math.pi, "crank speed omega")
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = _frame_mass()
    frame_stiffness: float | None = _frame_stiffness()
    frame_damping: float = _frame_damping()
    motor: Motor | None = _motor()

    def _assemble(self) -> Linkage:
        # The crank points from O to A, the rod from A to B, the links from P to B and C
        # to D.
        o = complex(self.crank_x, self.crank_y)
        a = o + self.crank_length
        b = _meeting(
            0j, a, self.upper_length, self.rod_length, LEFT if o.real < 0.0 else RIGHT
        )
        down = math.sqrt(max(self.lower_length**2 - b.real**2, 0.0))
        pivots = {"O": (self.crank_x, self.crank_y), "P": (0.0, 0.0)}
        crown = self._crown(0.5 * math.pi, pivots)
        return assemble(
            name=self.kind,
            bodies=(
                *crown.bodies,
                *_bars(self, "crank", "rod", "upper link", "lower link"),
                Body("slider", self.slider_mass, self._slide_inertia(self.slider_mass)),
            ),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "crank.head", "rod.tail"),
                Pin("B", "rod.head", "upper link.head"),
                Pin("P", crown.ends["P"], "upper link.tail"),
                Pin("C", "upper link.head", "lower link.tail"),
                Pin("D", "lower link.head", "slider"),
                Guide("guide", "slider", direction=0.5 * math.pi),
            ),
            drives=(self._drive("crank"),),
            guess={
                "rod": cmath.phase(b - a),
                "upper link": cmath.phase(b),
                "lower link": cmath.phase(complex(-b.real, -down)),
            },
            gravity=self.gravity,
            run_up=self.run_up,
        )


@dataclass(frozen=True)
class TwoPoint(Mechanism):
    """Two-point press: two geared cranks that mirror each other hold the slide on two rods.

    The cranks turn about O1 and O2, to the left and right of the middle. The rods join
    them in A1 and A2 and the slide in B1 and B2. Crank 2 turns at the given speed,
    crank 1 in the opposite sense. The guide holds the angle of the slide, so that one
    of all constraints repeats the others, unless a joint of a rod has clearance. Mass
    centres are at mid-length.
    """

    kind = "two-point"
    allowed_joints = ("O1", "A1", "B1", "O2", "A2", "B2")
    default_joints = ("B1", "B2")
    origin = CHOSEN

    distance: float = _c_length(1.2, "O1 to O2, and B1 to B2")
    crank_length: float = _c_length(0.1, "cranks, O to A")
    rod_length: float = _c_length(0.8, "rods, A to B; longer than the cranks")
    crank_mass: float = _c_mass(60.0, "mass of a crank")
    rod_mass: float = _c_mass(80.0, "mass of a rod")
    slider_mass: float = _c_mass(500.0, "mass of the slide with the upper tool")
    crank_inertia: float | None = _c_inertia(
        None, f"inertia of a crank (torque only){_ROD}"
    )
    rod_inertia: float | None = _c_inertia(None, f"inertia of a rod{_ROD}")
    gravity: float = gravity()
    speed: float = _c_speed(
        2.0 * math.pi, "speed of crank 2; crank 1 has the opposite one"
    )
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_rod(self.rod_length, self.crank_length, "joints B1 and B2 do not close")

    def _assemble(self) -> Linkage:
        half, up = 0.5 * self.distance, 0.5 * math.pi
        bodies, joints, drives = [], [], []
        for number, side in (("1", -1.0), ("2", 1.0)):
            crank, rod = f"crank {number}", f"rod {number}"
            bodies += _bars(self, crank, rod)
            joints += [
                Pin(f"O{number}", (side * half, 0.0), f"{crank}.tail"),
                Pin(f"A{number}", f"{crank}.head", f"{rod}.tail"),
                Pin(f"B{number}", f"{rod}.head", f"slider.{number}"),
            ]
            drives.append(
                Drive(crank, side * self.speed, up, torque_limit=self.torque_limit)
            )
        # The guide holds the angle of the slide: its inertia never enters.
        places = {"1": (-half, 0.0), "2": (half, 0.0)}
        bodies.append(Body("slider", self.slider_mass, 1.0, places))
        return assemble(
            name=self.kind,
            bodies=bodies,
            joints=(*joints, Guide("guide", "slider", direction=up)),
            drives=drives,
            guess={"rod 1": -up, "rod 2": -up},
            gravity=self.gravity,
            run_up=self.run_up,
        )


def _check_rod(rod: float, crank: float, fault: str) -> None:
    """Raise InputError for a rod, m, that is not longer than its crank."""
    least = _MIN_ROD_RATIO * crank
    if not rod >= least:
        allowed = f"{written(least, 'm')} to {written(MAX_LINK, 'm')}"
        raise InputError(
            f"rod_length = {written(rod, 'm')}: with crank_length = {written(crank, 'm')} allowed "
            f"is {allowed}; {fault} over the whole turn"
        )


def _bars(mechanism: Mechanism, *names: str) -> list[Body]:
    """Return bars of a mechanism whose fields begin with the first words of their names."""
    return [
        Bar(
            name, *(getattr(mechanism, f"{name.split()[0]}_{item}") for item in _OF_BAR)
        )
        for name in names
    ]
