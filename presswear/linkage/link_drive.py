"""Link-drive press: a crank and a rocker guide a plate, which drives the slide by a rod.

The default dimensions and speed are those of a link drive of 2,500 t in `presslink`
0.0.3 on PyPI.
"""

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from presswear.linkage.bodies import Body
from presswear.linkage.drives import torque_limit
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanism import (
    LEFT,
    MAX_LINK,
    MIN_SPEED,
    RIGHT,
    Mechanism,
    bars_of,
    chosen_inertia,
    chosen_mass,
    frame_damping_field,
    frame_mass_field,
    frame_stiffness_field,
    guide_length_field,
    guide_width_field,
    length_field,
    meeting_point,
    motor_field,
    number_field,
    thin_rod_inertia,
)
from presswear.linkage.motor import Motor
from presswear.linkage.parts import gravity_field, run_up_field
from presswear.tools.fields import quantity

_OF_PRESS = "press of 2,500 t in presslink 0.0.3"
_length = partial(length_field, _OF_PRESS)
_coordinate = partial(number_field, "m", -MAX_LINK, MAX_LINK, _OF_PRESS)


@dataclass(frozen=True)
class LinkDrive(Mechanism):
    """Link-drive press: the crank turns about O and carries a triangular plate in A.

    The rocker turns about P and holds the plate in B; the rod joins the plate in C and
    the slider in D, which moves on the vertical line through O. B begins above the line
    from A to P. Mass centres are at mid-length, and that of the plate at its centroid.
    """

    kind = "link-drive"
    allowed_joints = ("O", "A", "B", "P", "C", "D", "guide")
    default_joints = ("C", "D")
    origin = (
        "The default dimensions and speed are those of a link drive of 2,500 t in the program "
        "presslink 0.0.3; the masses are chosen."
    )

    crank_length: float = _length(0.26, "crank, O to A")
    plate_to_rocker: float = _length(0.8, "side of the plate, A to B")
    plate_to_rod: float = _length(1.175, "side of the plate, A to C")
    plate_angle: float = quantity(
        math.radians(134.0),
        unit="rad",
        low=-math.pi,
        high=math.pi,
        origin=_OF_PRESS,
        text="angle of the plate in A, counterclockwise from B to C",
    )
    rocker_length: float = _length(0.9, "rocker, P to B")
    rocker_x: float = _coordinate(-1.175, "P to the right of O")
    rocker_y: float = _coordinate(-0.375, "P above O")
    rod_length: float = _length(1.175, "rod, C to D")
    crank_mass: float = chosen_mass(2000.0, "mass of the crank")
    plate_mass: float = chosen_mass(4000.0, "mass of the plate")
    rocker_mass: float = chosen_mass(1000.0, "mass of the rocker")
    rod_mass: float = chosen_mass(2000.0, "mass of the rod")
    slider_mass: float = number_field(
        "kg", 1e-6, 1e5, "chosen", 2e4, "mass of the slide with the upper tool"
    )
    crank_inertia: float | None = thin_rod_inertia("the crank (torque only)")
    plate_inertia: float | None = chosen_inertia(
        None, "inertia of the plate; default: that of a triangle of even thickness"
    )
    rocker_inertia: float | None = thin_rod_inertia("the rocker")
    rod_inertia: float | None = thin_rod_inertia("the rod")
    gravity: float = gravity_field()
    speed: float = quantity(
        25.0 * math.pi / 30.0,
        unit="rad/s",
        low=MIN_SPEED,
        high=5000.0,
        origin=_OF_PRESS,
        text="crank speed omega",
    )
    run_up: int = run_up_field()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = frame_mass_field()
    frame_stiffness: float | None = frame_stiffness_field()
    frame_damping: float = frame_damping_field()
    motor: Motor | None = motor_field()
    guide_length: float | None = guide_length_field()
    guide_width: float | None = guide_width_field()

    @property
    def _corners(self) -> Mapping[str, complex]:
        """Corners of the plate from its centroid, m; the x axis points from A to B."""
        a = 0j
        b = complex(self.plate_to_rocker)
        c = cmath.rect(self.plate_to_rod, self.plate_angle)
        centroid = (b + c) / 3.0
        return {"A": a - centroid, "B": b - centroid, "C": c - centroid}

    @property
    def _plate(self) -> Body:
        corners = self._corners
        inertia = self.plate_inertia
        if inertia is None:
            # inertia of a triangle: m / 12 times the sum of the squared distances of its
            # corners from the centroid
            squares = sum(abs(corner) ** 2 for corner in corners.values())
            inertia = self.plate_mass * squares / 12.0
        points = {name: (point.real, point.imag) for name, point in corners.items()}
        return Body("plate", self.plate_mass, inertia, points)

    def _assemble(self) -> Linkage:
        # The crank points from O to A, the rocker from P to B, the rod from C to D.
        a = complex(self.crank_length)
        p = complex(self.rocker_x, self.rocker_y)
        side = RIGHT if self.rocker_x < 0.0 else LEFT
        b = meeting_point(a, p, self.plate_to_rocker, self.rocker_length, side)
        c = a + cmath.rect(self.plate_to_rod, cmath.phase(b - a) + self.plate_angle)
        down = math.sqrt(max(self.rod_length**2 - c.real**2, 0.0))
        pivots = {"O": (0.0, 0.0), "P": (self.rocker_x, self.rocker_y)}
        crown = self._crown(0.5 * math.pi, pivots)
        return assemble(
            name="link drive",
            bodies=(
                *crown.bodies,
                *bars_of(self, "crank", "rocker", "rod"),
                self._plate,
                self._slide("slider", self.slider_mass),
            ),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "crank.head", "plate.A"),
                Pin("B", "plate.B", "rocker.head"),
                Pin("P", crown.ends["P"], "rocker.tail"),
                Pin("C", "plate.C", "rod.tail"),
                Pin("D", "rod.head", "slider"),
                self._guide("slider", 0.5 * math.pi),
            ),
            drives=(self._drive("crank"),),
            guess={
                "plate": cmath.phase(b - a),
                "rocker": cmath.phase(b - p),
                "rod": cmath.phase(complex(-c.real, -down)),
            },
            gravity=self.gravity,
            run_up=self.run_up,
        )
