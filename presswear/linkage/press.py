"""The hybrid-driven seven-bar press of the paper: parameters, linkage, ideal motion.

Bodies are numbered as in the paper: frame 1, crank 2, rod 3, triangular plate 4,
rod 5, slider 6, crank 7.  The paper does not print enough to fix the mechanism;
each value says whether it is the paper's, chosen or assumed.
"""

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial

from presswear.linkage.elements import Body, Guide, Revolute, bar_ends
from presswear.linkage.linkage import Linkage, gravity, run_up
from presswear.linkage.mechanism import (
    LONG,
    Mechanism,
    inertia,
    length,
    mass,
)
from presswear.linkage.motions import Drive, torque_limit
from presswear.linkage.points import GROUND, Attachment, Probe
from presswear.linkage.servo import SERVOS, Servo
from presswear.tools.errors import InputError
from presswear.tools.quantities import named_set, one_of, quantity
from presswear.tools.serialize import check_fields

CRANK_2_START = math.radians(-119.27)
CRANK_7_START = math.radians(-51.18)
RIGHT, LEFT = -1.0, 1.0
BELOW, ABOVE = -1.0, 1.0

_length, _mass, _inertia = (partial(make, "paper") for make in (length, mass, inertia))
_side = partial(length, "paper, reading chosen")


@dataclass(frozen=True)
class Geometry:
    """Where the frame joint O2 is, the plate's sides, and how the linkage is assembled.

    The paper prints none of these unambiguously.  ``side_b`` is the side of the
    line from D to A on which B lies, ``side_c`` that of the line from D to B on
    which C lies (RIGHT or LEFT); ``slider_side`` is BELOW or ABOVE C.
    """

    hx: float = quantity(0.240, "m", -LONG, LONG, "chosen", "O2 to the right of O7")
    hy: float = quantity(0.1345, "m", -LONG, LONG, "chosen", "O2 above O7")
    side_bd: float = _side(0.39, "plate side B to D")
    side_bc: float = _side(0.21, "plate side B to C")
    side_cd: float = _side(0.233, "plate side C to D")
    side_b: float = RIGHT
    side_c: float = RIGHT
    slider_side: float = BELOW

    @property
    def name(self) -> str:
        """Name of the geometry, or ``custom`` for one that has none."""
        return next((name for name, preset in GEOMETRIES.items() if self == preset), "custom")

    def __post_init__(self) -> None:
        check_fields(self)
        for side in ("side_b", "side_c", "slider_side"):
            value = getattr(self, side)
            if value not in (-1.0, 1.0):
                raise InputError(
                    f"{side} = {value:g}: allowed is -1 (right, below) or 1 (left, above)"
                )
        short, middle, longest = sorted((self.side_bd, self.side_bc, self.side_cd))
        if longest >= short + middle:
            raise InputError(
                f"plate 4 is no triangle: its longest side {longest:g} m must be below the sum "
                f"of the others, {short + middle:g} m"
            )


GEOMETRIES: dict[str, Geometry] = {  # they meet the two printed peaks about equally well
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
    """The seven-bar press: everything but its clearance joints."""

    kind = "press"
    openable = ("A", "C")
    loose = ("A", "C")

    geometry: Geometry = named_set(
        "standard", GEOMETRIES, "named geometry; a choice, the paper does not fix it"
    )
    length_2: float = _length(0.07, "crank 2, O2 to A")
    length_3: float = _length(0.34, "rod 3, A to B")
    length_5: float = _length(0.40, "rod 5, C to E")
    length_7: float = _length(0.07, "crank 7, O7 to D")
    mass_2: float = _mass(0.0243, "mass of crank 2")
    mass_3: float = _mass(0.1085, "mass of rod 3")
    mass_4: float = _mass(0.4503, "mass of plate 4")
    mass_5: float = _mass(0.1272, "mass of rod 5")
    mass_6: float = _mass(0.0288, "mass of slider 6")
    mass_7: float = _mass(0.0243, "mass of crank 7")
    inertia_2: float = _inertia(5.396e-4, "inertia of crank 2 (too large for it; torque only)")
    inertia_3: float = _inertia(1.1e-3, "inertia of rod 3")
    inertia_4: float = _inertia(3.779e-3, "inertia of plate 4")
    inertia_5: float = _inertia(1.771e-3, "inertia of rod 5")
    inertia_7: float = _inertia(5.396e-4, "inertia of crank 7 (too large for it; torque only)")
    gravity: float = gravity()
    speed: float = quantity(
        3.5 * math.pi,
        "rad/s",
        0.1 * math.pi,
        40.0 * math.pi,
        "paper, per study",
        "crank speed w: crank 7 turns at +w, crank 2 at -w",
    )
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()
    servo: Servo | None = one_of(
        SERVOS, "what crank 7 does while crank 2 turns evenly; none: it turns evenly as well"
    )

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""
        return (
            f"The geometry ({self.geometry.name}) and several parameters are chosen, not the "
            "paper's: it does not print enough to fix the mechanism."
        )

    def plate_corners(self) -> dict[str, Attachment]:
        """B, C, D in the plate's frame: origin at the centroid, x axis along D to B."""
        bd, bc, cd = self.geometry.side_bd, self.geometry.side_bc, self.geometry.side_cd
        along = (bd**2 + cd**2 - bc**2) / (2.0 * bd)
        across = self.geometry.side_c * math.sqrt(cd**2 - along**2)
        x, y = (bd + along) / 3.0, across / 3.0
        corners = {"D": (0.0, 0.0), "B": (bd, 0.0), "C": (along, across)}
        return {name: Attachment("plate 4", a - x, b - y) for name, (a, b) in corners.items()}

    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed.

        Rod 3 points from B to A, rod 5 from E to C and the cranks as in equation
        14; the slider's angle of 90 degrees there is its guide's direction.
        """
        return _linkage(self)

    @property
    def _drive_7(self) -> Drive:
        if self.servo is None:
            return Drive("crank 7", self.speed, CRANK_7_START)
        return self.servo.drive("crank 7", self.speed, "slider 6.centre")

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


@lru_cache(maxsize=64)
def _linkage(press: Press) -> Linkage:
    """The linkage, made once: a scene asks for it several times."""
    geometry = press.geometry
    corner = press.plate_corners()
    tail_2, head_2 = bar_ends("crank 2", press.length_2)
    tail_3, head_3 = bar_ends("rod 3", press.length_3)
    tail_5, head_5 = bar_ends("rod 5", press.length_5)
    tail_7, head_7 = bar_ends("crank 7", press.length_7)
    return Linkage(
        name=f"seven-bar press, {geometry.name} geometry",
        bodies=(
            Body("crank 2", press.mass_2, press.inertia_2),
            Body("rod 3", press.mass_3, press.inertia_3),
            Body("plate 4", press.mass_4, press.inertia_4),
            Body("rod 5", press.mass_5, press.inertia_5),
            # The slider does not turn: its inertia never enters.
            Body("slider 6", press.mass_6, 1.0),
            Body("crank 7", press.mass_7, press.inertia_7),
        ),
        joints=(
            Revolute("O2", Attachment(GROUND, geometry.hx, geometry.hy), head_2),
            Revolute("O7", Attachment(GROUND, 0.0, 0.0), tail_7),
            Revolute("A", head_3, tail_2),
            Revolute("B", tail_3, corner["B"]),
            Revolute("C", head_5, corner["C"]),
            Revolute("D", head_7, corner["D"]),
            Revolute("E", tail_5, Attachment("slider 6", 0.0, 0.0)),
            Guide("guide", "slider 6", geometry.hx, 0.0, 0.5 * math.pi, angle=0.5 * math.pi),
        ),
        drives=(
            Drive("crank 2", -press.speed, CRANK_2_START, torque_limit=press.torque_limit),
            replace(press._drive_7, torque_limit=press.torque_limit),
        ),
        watch=Probe("slider 6", 0.5 * math.pi),
        guess=press.guess,
        gravity=press.gravity,
        run_up=press.run_up,
    )


def _meeting(p: complex, q: complex, from_p: float, from_q: float, side: float) -> complex:
    """The point at given distances from two others, on a given side of p to q, or nearly."""
    length = max(abs(q - p), 1e-12)
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    across = side * math.sqrt(max(from_p**2 - along**2, 0.0))
    return p + complex(along, across) * (q - p) / length
