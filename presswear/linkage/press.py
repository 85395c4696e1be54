"""The hybrid-driven seven-bar press of the paper: parameters, linkage, ideal motion.

Bodies are numbered as in the paper: frame 1, crank 2, rod 3, triangular plate 4,
rod 5, slider 6, crank 7.  The paper does not print enough to fix the mechanism;
each value says whether it is the paper's, chosen or assumed.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.dyads import Line, Point, body_state, crank, dyad, on_guide, slide
from presswear.linkage.elements import (
    GROUND,
    Attachment,
    Body,
    Drive,
    Guide,
    Linkage,
    Probe,
    Revolute,
)
from presswear.linkage.mechanism import Motion, check_masses, motion_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import check_fields, named_set, quantity

Array = NDArray[np.float64]

CRANK_2_START = math.radians(-119.27)
CRANK_7_START = math.radians(-51.18)
RIGHT, LEFT = -1.0, 1.0
BELOW, ABOVE = -1.0, 1.0

_SHORT, _LONG = 1e-3, 10.0
"""Shortest and longest link that is still a press, m."""

_DEAD_POINT = 1e-4
"""Square of the sine at which a pair of links counts as stretched: 0.6 degrees."""


@dataclass(frozen=True)
class Geometry:
    """Where the frame joint O2 is, the plate's sides, and how the linkage is assembled.

    The paper prints none of these unambiguously.  ``side_b`` is the side of the
    line from D to A on which B lies, ``side_c`` that of the line from D to B on
    which C lies (RIGHT or LEFT); ``slider_side`` is BELOW or ABOVE C.
    """

    name: str = "standard"
    hx: float = quantity(0.240, "m", -_LONG, _LONG, "chosen", "O2 to the right of O7")
    hy: float = quantity(0.1345, "m", -_LONG, _LONG, "chosen", "O2 above O7")
    side_bd: float = quantity(
        0.39, "m", _SHORT, _LONG, "paper, reading chosen", "plate side B to D"
    )
    side_bc: float = quantity(
        0.21, "m", _SHORT, _LONG, "paper, reading chosen", "plate side B to C"
    )
    side_cd: float = quantity(
        0.233, "m", _SHORT, _LONG, "paper, reading chosen", "plate side C to D"
    )
    side_b: float = RIGHT
    side_c: float = RIGHT
    slider_side: float = BELOW


GEOMETRIES: dict[str, Geometry] = {
    geometry.name: geometry
    for geometry in (
        Geometry(),
        Geometry(name="swapped", hx=0.210, side_bc=0.233, side_cd=0.21),
        Geometry(
            name="lifted",
            hx=-0.208,
            hy=-0.195,
            side_bd=0.233,
            side_bc=0.39,
            side_cd=0.21,
            side_c=LEFT,
            slider_side=ABOVE,
        ),
    )
}
"""Three choices that meet the two printed peaks about equally well."""


def _mass(default: float, text: str) -> float:
    value: float = quantity(default, "kg", 1e-6, 1e4, "paper", text)
    return value


def _inertia(default: float, text: str) -> float:
    value: float = quantity(default, "kg m^2", 1e-9, 1e4, "paper", text)
    return value


def _length(default: float, text: str) -> float:
    value: float = quantity(default, "m", _SHORT, _LONG, "paper", text)
    return value


@dataclass(frozen=True)
class Press:
    """The seven-bar press: everything but its clearance joints."""

    kind: ClassVar[str] = "press"
    openable: ClassVar[tuple[str, ...]] = ("A", "C")

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
    gravity: float = quantity(9.81, "m/s^2", -100.0, 100.0, "assumed", "gravity along -y")
    speed: float = quantity(
        3.5 * math.pi,
        "rad/s",
        0.1 * math.pi,
        40.0 * math.pi,
        "paper, per study",
        "crank speed w: crank 7 turns at +w, crank 2 at -w",
    )

    def __post_init__(self) -> None:
        check_fields(self)
        check_fields(self.geometry)
        if not isinstance(self.geometry.name, str):
            raise InputError(f"name of a geometry = {self.geometry.name!r}: a text is expected")
        for side in ("side_b", "side_c", "slider_side"):
            value = getattr(self.geometry, side)
            if isinstance(value, bool) or value not in (-1.0, 1.0):
                raise InputError(
                    f"{side} = {getattr(self.geometry, side)!r}: allowed is -1 (right, below) "
                    "or 1 (left, above)"
                )
        plate = sorted((self.geometry.side_bd, self.geometry.side_bc, self.geometry.side_cd))
        if plate[2] >= plate[0] + plate[1]:
            raise InputError(
                f"plate 4 is no triangle: its longest side {plate[2]:g} m must be below the sum "
                f"of the others, {plate[0] + plate[1]:g} m"
            )

        check_masses({f"mass_{k}": getattr(self, f"mass_{k}") for k in range(2, 8)})

    @property
    def period(self) -> float:
        """Time of one cycle, s."""
        return 2.0 * math.pi / self.speed

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""
        return (
            f"The geometry ({self.geometry.name}) and several parameters are chosen, not the "
            "paper's: it does not print enough to fix the mechanism."
        )

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Press":
        """A press from its fields as plain data."""
        plain = dict(data)
        return Press(geometry=Geometry(**plain.pop("geometry")), **plain)

    def plate_corners(self) -> dict[str, tuple[float, float]]:
        """B, C, D in the plate's frame: origin at the centroid, x axis along D to B, m."""
        bd, bc, cd = self.geometry.side_bd, self.geometry.side_bc, self.geometry.side_cd
        along = (bd**2 + cd**2 - bc**2) / (2.0 * bd)
        across = self.geometry.side_c * math.sqrt(cd**2 - along**2)
        centre = ((bd + along) / 3.0, across / 3.0)
        corners = {"D": (0.0, 0.0), "B": (bd, 0.0), "C": (along, across)}
        return {name: (x - centre[0], y - centre[1]) for name, (x, y) in corners.items()}

    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed.

        Rod 3 points from B to A, rod 5 from E to C and the cranks as in equation
        14; the slider's angle of 90 degrees there is its guide's direction.
        """
        geometry = self.geometry
        corner = {n: Attachment("plate 4", x, y) for n, (x, y) in self.plate_corners().items()}
        half_2, half_3 = 0.5 * self.length_2, 0.5 * self.length_3
        half_5, half_7 = 0.5 * self.length_5, 0.5 * self.length_7
        return Linkage(
            name=f"seven-bar press, {geometry.name} geometry",
            bodies=(
                Body("crank 2", self.mass_2, self.inertia_2),
                Body("rod 3", self.mass_3, self.inertia_3),
                Body("plate 4", self.mass_4, self.inertia_4),
                Body("rod 5", self.mass_5, self.inertia_5),
                # The slider does not turn: its inertia never enters.
                Body("slider 6", self.mass_6, 1.0),
                Body("crank 7", self.mass_7, self.inertia_7),
            ),
            revolutes=(
                Revolute(
                    "O2",
                    Attachment(GROUND, geometry.hx, geometry.hy),
                    Attachment("crank 2", half_2, 0.0),
                ),
                Revolute("O7", Attachment(GROUND, 0.0, 0.0), Attachment("crank 7", -half_7, 0.0)),
                Revolute("A", Attachment("rod 3", half_3, 0.0), Attachment("crank 2", -half_2, 0)),
                Revolute("B", Attachment("rod 3", -half_3, 0.0), corner["B"]),
                Revolute("C", Attachment("rod 5", half_5, 0.0), corner["C"]),
                Revolute("D", Attachment("crank 7", half_7, 0.0), corner["D"]),
                Revolute("E", Attachment("rod 5", -half_5, 0.0), Attachment("slider 6", 0, 0)),
            ),
            guides=(
                Guide("guide", "slider 6", geometry.hx, 0.0, 0.5 * math.pi, angle=0.5 * math.pi),
            ),
            drives=(
                Drive("drive 2", "crank 2", CRANK_2_START, -self.speed),
                Drive("drive 7", "crank 7", CRANK_7_START, self.speed),
            ),
            clearances=(),
            probe=Probe("slider 6", 0.5 * math.pi),
            gravity=self.gravity,
        )

    def ideal_motion(self, time: Array) -> Motion:
        """Motion of every body with all joints closed, in closed form.

        Parameters
        ----------
        time : ndarray, shape (n,)
            s.

        Raises
        ------
        AssemblyError
            Where two links cannot meet; says which, and at what crank angle.
        """
        return self._motion(time, 0.0)

    def _motion(self, time: Array, least: float) -> Motion:
        """``ideal_motion``, refused unless each pair of links is bent by ``least``.

        That is the square of the sine of the angle by which it is short of stretched.
        """
        geometry = self.geometry
        time = np.atleast_1d(np.asarray(time, dtype=float))
        theta_2, theta_7 = CRANK_2_START - self.speed * time, CRANK_7_START + self.speed * time
        o2 = Point.fixed(geometry.hx, geometry.hy, time.size)
        o7 = Point.fixed(0.0, 0.0, time.size)
        a = crank(o2, -self.length_2, theta_2, -self.speed)
        d = crank(o7, self.length_7, theta_7, self.speed)
        angle = np.degrees(self.speed * time)
        b = dyad(d, a, geometry.side_bd, self.length_3, geometry.side_b, "B", angle, least)
        c = dyad(d, b, geometry.side_cd, geometry.side_bc, geometry.side_c, "C", angle, least)
        guide = Line((geometry.hx, 0.0), (0.0, 1.0))
        names = ("C", "rod 5", "E")
        e = slide(c, self.length_5, guide, geometry.slider_side, names, angle, least)
        plate = self.plate_corners()
        ends = {
            "crank 2": (a, o2, (-0.5 * self.length_2, 0.0)),
            "rod 3": (b, a, (-0.5 * self.length_3, 0.0)),
            "plate 4": (d, b, plate["D"]),
            "rod 5": (e, c, (-0.5 * self.length_5, 0.0)),
            "crank 7": (o7, d, (-0.5 * self.length_7, 0.0)),
        }
        states = {name: body_state(*given) for name, given in ends.items()}
        states["slider 6"] = on_guide(e, 0.5 * math.pi)
        driven = {"crank 2": theta_2, "crank 7": theta_7}
        return motion_of(self.linkage(), time, states, driven)

    def check_assembly(self) -> None:
        """Raise AssemblyError unless the linkage closes over the whole cycle."""
        self._motion(np.linspace(0.0, self.period, 1441), _DEAD_POINT)
