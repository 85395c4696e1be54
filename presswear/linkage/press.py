"""Press of the paper: a hybrid-driven seven-bar linkage.

Bodies are numbered as in the paper: frame 1, crank 2, rod 3, triangular plate 4, rod 5,
slider 6, crank 7. The paper does not print enough to determine the mechanism. The origin
of each value is the paper, a choice or an assumption.
"""

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive, torque_limit
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanism import (
    LEFT,
    MAX_LINK,
    MIN_SPEED,
    RIGHT,
    Mechanism,
    frame_damping_field,
    frame_mass_field,
    frame_stiffness_field,
    guide_length_field,
    guide_width_field,
    length_field,
    meeting_point,
    motor_field,
    paper_inertia,
    paper_length,
    paper_mass,
)
from presswear.linkage.motor import Motor
from presswear.linkage.parts import gravity_field, run_up_field
from presswear.linkage.points import Attachment, End, OutputPoint
from presswear.linkage.servos import SERVOS, ConstantSpeed, Servo
from presswear.tools.errors import InputError
from presswear.tools.fields import named_set, one_of, quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

CRANK_2_START = math.radians(-119.27)
CRANK_7_START = math.radians(-51.18)
BELOW = -1.0  # sides of a point on which the slider lies
ABOVE = 1.0
_side = partial(length_field, "paper, reading chosen")


@dataclass(frozen=True)
class Geometry(Checked):
    """Frame joint O2, sides of the plate, and the branch in which the linkage is assembled.

    The paper prints none of these unambiguously. B lies on the ``side_b``, RIGHT or LEFT,
    of the line from D to A. C lies on the ``side_c`` of the line from D to B. The slider
    lies on the ``slider_side``, BELOW or ABOVE, of C.
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
        *shorter_sides, longest = sorted((self.side_bd, self.side_bc, self.side_cd))
        if longest >= sum(shorter_sides):
            raise InputError(
                f"plate 4 is not a triangle: its longest side {written(longest, 'm')} must be "
                f"below the sum of the others, {written(sum(shorter_sides), 'm')}"
            )


# Geometries with nearly the two peak values that the paper prints
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
    length_2: float = paper_length(0.07, "crank 2, O2 to A")
    length_3: float = paper_length(0.34, "rod 3, A to B")
    length_5: float = paper_length(0.40, "rod 5, C to E")
    length_7: float = paper_length(0.07, "crank 7, O7 to D")
    mass_2: float = paper_mass(0.0243, "mass of crank 2")
    mass_3: float = paper_mass(0.1085, "mass of rod 3")
    mass_4: float = paper_mass(0.4503, "mass of plate 4")
    mass_5: float = paper_mass(0.1272, "mass of rod 5")
    mass_6: float = paper_mass(0.0288, "mass of slider 6")
    mass_7: float = paper_mass(0.0243, "mass of crank 7")
    inertia_2: float = paper_inertia(
        5.396e-4, "inertia of crank 2 (affects the drive torque only)"
    )
    inertia_3: float = paper_inertia(1.1e-3, "inertia of rod 3")
    inertia_4: float = paper_inertia(3.779e-3, "inertia of plate 4")
    inertia_5: float = paper_inertia(1.771e-3, "inertia of rod 5")
    inertia_7: float = paper_inertia(
        5.396e-4, "inertia of crank 7 (affects the drive torque only)"
    )
    gravity: float = gravity_field()
    speed: float = quantity(
        3.5 * math.pi,
        unit="rad/s",
        low=MIN_SPEED,
        high=40.0 * math.pi,
        origin="paper, per study",
        text="crank speed omega: crank 7 turns at +omega, crank 2 at -omega",
    )
    run_up: int = run_up_field()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = frame_mass_field()
    frame_stiffness: float | None = frame_stiffness_field()
    frame_damping: float = frame_damping_field()
    motor: Motor | None = motor_field()
    guide_length: float | None = guide_length_field()
    guide_width: float | None = guide_width_field()
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
        """Settings without effect."""
        names = super().unread
        if self.servo is not None and self.servo.stiffness is None:
            names += ("servo.damping",)
        # The torque limit of the press also limits crank 7, unless its servo has a limit.
        if self.servo is None or self.servo.torque_limit is None:
            names = tuple(name for name in names if name != "torque_limit")
        return names

    def plate_corners(self) -> dict[str, Attachment]:
        """Return B, C, D in the plate's frame: origin at the centroid, x axis along D to B."""
        bd = self.geometry.side_bd
        bc = self.geometry.side_bc
        cd = self.geometry.side_cd
        along = (bd**2 + cd**2 - bc**2) / (2.0 * bd)
        across = self.geometry.side_c * math.sqrt(cd**2 - along**2)
        centroid_x = (bd + along) / 3.0
        centroid_y = across / 3.0
        corners = {"D": (0.0, 0.0), "B": (bd, 0.0), "C": (along, across)}
        return {
            name: Attachment("plate 4", x - centroid_x, y - centroid_y)
            for name, (x, y) in corners.items()
        }

    def _assemble(self) -> Linkage:
        geometry = self.geometry
        pivots = {"O2": (geometry.hx, geometry.hy), "O7": (0.0, 0.0)}
        crown = self._crown(0.5 * math.pi, pivots)
        bodies = (
            Bar("crank 2", self.length_2, self.mass_2, self.inertia_2),
            Bar("rod 3", self.length_3, self.mass_3, self.inertia_3),
            Body("plate 4", self.mass_4, self.inertia_4),
            Bar("rod 5", self.length_5, self.mass_5, self.inertia_5),
            self._slide("slider 6", self.mass_6),
            Bar("crank 7", self.length_7, self.mass_7, self.inertia_7),
        )
        return assemble(
            name="seven-bar press",
            bodies=(*crown.bodies, *bodies),
            joints=(*crown.guides, *self._joints(crown.ends)),
            drives=(self._drive("crank 2", CRANK_2_START, -1.0), self._drive_7),
            output=OutputPoint("slider 6", 0.5 * math.pi),
            guess=self.guess,
            gravity=self.gravity,
            run_up=self.run_up,
        )

    def _joints(self, ends: Mapping[str, End]) -> tuple[Pin | Guide, ...]:
        """Return the joints; ``ends`` are the ends of O2 and O7 on the frame.

        Rod 3 points from B to A, rod 5 from E to C. The directions of the cranks and the
        angle of the slider, 90 degrees, are those of equation 14 of the paper.
        """
        corner = self.plate_corners()
        return (
            Pin("O2", ends["O2"], "crank 2.head"),
            Pin("O7", ends["O7"], "crank 7.tail"),
            Pin("A", "rod 3.head", "crank 2.tail"),
            Pin("B", "rod 3.tail", corner["B"]),
            Pin("C", "rod 5.head", corner["C"]),
            Pin("D", "crank 7.head", corner["D"]),
            Pin("E", "rod 5.tail", "slider 6"),
            self._guide(
                "slider 6",
                0.5 * math.pi,
                x=self.geometry.hx,
                y=0.0,
                angle=0.5 * math.pi,
            ),
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
        b = meeting_point(d, a, geometry.side_bd, self.length_3, geometry.side_b)
        c = meeting_point(d, b, geometry.side_cd, geometry.side_bc, geometry.side_c)
        across = c.real - geometry.hx
        down = math.sqrt(max(self.length_5**2 - across**2, 0.0))
        rod_5 = complex(across, -geometry.slider_side * down)
        return {
            "rod 3": cmath.phase(a - b),
            "plate 4": cmath.phase(b - d),
            "rod 5": cmath.phase(rod_5),
        }
