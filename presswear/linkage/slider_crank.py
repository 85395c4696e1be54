"""A slider-crank, as the literature on joints with clearance studies it.

The crank turns about O, the origin; the rod joins it in A and the slider in B.  The
slider moves on the x axis, to the right of O.  The values are from memory of the
literature (Flores) and were not checked against a page.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.dyads import Line, Point, body_state, crank, on_guide, slide
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
from presswear.tools.errors import AssemblyError
from presswear.tools.quantities import check_fields, quantity

Array = NDArray[np.float64]

LITERATURE = "literature, from memory"

_LEAST_RATIO = 1.0001
"""Shortest rod over the crank: a rod that stands upright leaves the slider's side open."""


def _length(default: float, text: str) -> float:
    value: float = quantity(default, "m", 1e-3, 10.0, LITERATURE, text)
    return value


def _mass(default: float, text: str) -> float:
    value: float = quantity(default, "kg", 1e-6, 1e4, LITERATURE, text)
    return value


def _inertia(default: float, text: str) -> float:
    value: float = quantity(default, "kg m^2", 1e-9, 1e4, LITERATURE, text)
    return value


@dataclass(frozen=True)
class SliderCrank:
    """A slider-crank: everything but its clearance joints.

    Mass centres are at mid-length and the rod carries the bearings (both assumed).
    """

    kind: ClassVar[str] = "slider-crank"
    openable: ClassVar[tuple[str, ...]] = ("A", "B")

    crank_length: float = _length(0.05, "crank, O to A")
    rod_length: float = _length(0.12, "rod, A to B; longer than the crank")
    crank_mass: float = _mass(0.30, "mass of the crank")
    rod_mass: float = _mass(0.21, "mass of the rod")
    slider_mass: float = _mass(0.14, "mass of the slider")
    crank_inertia: float = _inertia(1e-4, "inertia of the crank (torque only)")
    rod_inertia: float = _inertia(2.5e-4, "inertia of the rod")
    gravity: float = quantity(9.81, "m/s^2", -100.0, 100.0, "assumed", "gravity along -y")
    speed: float = quantity(
        5000.0 * math.pi / 30.0, "rad/s", 1.0, 5000.0, LITERATURE, "crank speed, 5000 rpm"
    )

    def __post_init__(self) -> None:
        check_fields(self)
        check_masses({key: getattr(self, key) for key in ("crank_mass", "rod_mass", "slider_mass")})

    @property
    def period(self) -> float:
        """Time of one cycle, s."""
        return 2.0 * math.pi / self.speed

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""
        return (
            "Dimensions, masses and speed are those of a slider-crank that the literature on "
            "joints with clearance has studied (Flores), from memory and not checked against a "
            "page."
        )

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "SliderCrank":
        """A slider-crank from its fields as plain data."""
        return SliderCrank(**data)

    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed.

        The crank points from O to A, the rod from A to B: both are at angle 0 at the start.
        """
        half_crank, half_rod = 0.5 * self.crank_length, 0.5 * self.rod_length
        return Linkage(
            name="slider-crank",
            bodies=(
                Body("crank", self.crank_mass, self.crank_inertia),
                Body("rod", self.rod_mass, self.rod_inertia),
                # The slider does not turn: its inertia never enters.
                Body("slider", self.slider_mass, 1.0),
            ),
            revolutes=(
                Revolute("O", Attachment(GROUND, 0.0, 0.0), Attachment("crank", -half_crank, 0.0)),
                Revolute(
                    "A", Attachment("rod", -half_rod, 0.0), Attachment("crank", half_crank, 0.0)
                ),
                Revolute("B", Attachment("rod", half_rod, 0.0), Attachment("slider", 0.0, 0.0)),
            ),
            guides=(Guide("guide", "slider", 0.0, 0.0, 0.0),),
            drives=(Drive("drive", "crank", 0.0, self.speed),),
            clearances=(),
            probe=Probe("slider", 0.0),
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
            Where the rod does not reach the guide.
        """
        time = np.atleast_1d(np.asarray(time, dtype=float))
        theta = self.speed * time
        o = Point.fixed(0.0, 0.0, time.size)
        a = crank(o, self.crank_length, theta, self.speed)
        guide = Line((0.0, 0.0), (1.0, 0.0))
        names = ("A", "the rod", "B")
        b = slide(a, self.rod_length, guide, 1.0, names, np.degrees(theta), 0.0)
        states = {
            "crank": body_state(o, a, (-0.5 * self.crank_length, 0.0)),
            "rod": body_state(a, b, (-0.5 * self.rod_length, 0.0)),
            "slider": on_guide(b, 0.0),
        }
        return motion_of(self.linkage(), time, states, {"crank": theta})

    def check_assembly(self) -> None:
        """Raise AssemblyError unless the crank can turn all around."""
        least = _LEAST_RATIO * self.crank_length
        if not self.rod_length >= least:
            raise AssemblyError(
                f"rod_length = {self.rod_length:g} m: with crank_length = {self.crank_length:g} m "
                f"allowed is {least:.6g} m to 10 m; joint B does not close over the whole turn"
            )
