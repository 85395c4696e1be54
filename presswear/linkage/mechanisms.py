"""Simple mechanisms made of a few quantities: slider-crank, four-bar, six-bar, two-point press.

The slider-crank is that of the literature on joints with clearance (Flores), from
memory and not checked against a page.
"""

import cmath
import math
from dataclasses import dataclass

from presswear.linkage.bodies import Body
from presswear.linkage.drives import torque_limit
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanism import (
    CHOSEN,
    LEFT,
    LITERATURE,
    MAX_LINK,
    MIN_SPEED,
    RIGHT,
    Mechanism,
    bars_of,
    check_rod,
    chosen_length,
    chosen_mass,
    chosen_speed,
    frame_damping_field,
    frame_mass_field,
    frame_stiffness_field,
    guide_length_field,
    guide_width_field,
    literature_length,
    literature_mass,
    meeting_point,
    motor_field,
    thin_rod_inertia,
)
from presswear.linkage.motor import Motor
from presswear.linkage.parts import gravity_field, run_up_field
from presswear.tools.fields import choice, quantity


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

    crank_length: float = literature_length(0.05, "crank, O to A")
    rod_length: float = literature_length(0.12, "rod, A to B; longer than the crank")
    crank_mass: float = literature_mass(0.30, "mass of the crank")
    rod_mass: float = literature_mass(0.21, "mass of the rod")
    slider_mass: float = literature_mass(0.14, "mass of the slider")
    slide_angle: float = quantity(
        -0.5 * math.pi,
        unit="rad",
        low=-2.0 * math.pi,
        high=2.0 * math.pi,
        origin="chosen",
        text="direction from O to the slider, from x; -90 deg: below O",
    )
    crank_inertia: float | None = thin_rod_inertia("the crank (torque only)")
    rod_inertia: float | None = thin_rod_inertia("the rod")
    gravity: float = gravity_field()
    speed: float = quantity(
        5000.0 * math.pi / 30.0,
        unit="rad/s",
        low=MIN_SPEED,
        high=5000.0,
        origin=LITERATURE,
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

    def __post_init__(self) -> None:
        super().__post_init__()
        check_rod(self.rod_length, self.crank_length, "joint B does not close")

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
                *bars_of(self, "crank", "rod"),
                self._slide("slider", self.slider_mass),
            ),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "rod.tail", "crank.head"),
                Pin("B", "rod.head", "slider"),
                self._guide("slider", upward),
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

    frame_length: float = chosen_length(0.18, "frame, O to P")
    crank_length: float = chosen_length(0.05, "crank, O to A")
    coupler_length: float = chosen_length(0.20, "coupler, A to B")
    rocker_length: float = chosen_length(0.12, "rocker, B to P")
    crank_mass: float = chosen_mass(0.3, "mass of the crank")
    coupler_mass: float = chosen_mass(0.5, "mass of the coupler")
    rocker_mass: float = chosen_mass(0.4, "mass of the rocker")
    crank_inertia: float | None = thin_rod_inertia("the crank (torque only)")
    coupler_inertia: float | None = thin_rod_inertia("the coupler")
    rocker_inertia: float | None = thin_rod_inertia("the rocker")
    side: str = choice(
        "above", ("above", "below"), "side of the frame on which the rocker begins"
    )
    gravity: float = gravity_field()
    speed: float = chosen_speed(10.0 * math.pi, "crank speed omega")
    run_up: int = run_up_field()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = frame_mass_field()
    frame_stiffness: float | None = frame_stiffness_field()
    frame_damping: float = frame_damping_field()
    motor: Motor | None = motor_field()

    def _assemble(self) -> Linkage:
        # The crank points from O to A, the coupler from A to B, the rocker from P to B.
        a = complex(self.crank_length)
        p = complex(self.frame_length)
        side = LEFT if self.side == "above" else RIGHT
        b = meeting_point(a, p, self.coupler_length, self.rocker_length, side)
        crown = self._crown(0.0, {"O": (0.0, 0.0), "P": (self.frame_length, 0.0)})
        return assemble(
            name=self.kind,
            bodies=(*crown.bodies, *bars_of(self, "crank", "coupler", "rocker")),
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
    crank_length: float = chosen_length(0.042, "crank, O to A")
    rod_length: float = chosen_length(0.24, "rod, A to B")
    upper_length: float = chosen_length(0.15, "upper link, P to B and C")
    lower_length: float = chosen_length(0.20, "lower link, C to D")
    crank_mass: float = chosen_mass(2.0, "mass of the crank")
    rod_mass: float = chosen_mass(3.0, "mass of the rod")
    upper_mass: float = chosen_mass(2.5, "mass of the upper link")
    lower_mass: float = chosen_mass(3.0, "mass of the lower link")
    slider_mass: float = chosen_mass(10.0, "mass of the slider")
    crank_inertia: float | None = thin_rod_inertia("the crank (torque only)")
    rod_inertia: float | None = thin_rod_inertia("the rod")
    upper_inertia: float | None = thin_rod_inertia("the upper link")
    lower_inertia: float | None = thin_rod_inertia("the lower link")
    gravity: float = gravity_field()
    speed: float = chosen_speed(2.0 * math.pi, "crank speed omega")
    run_up: int = run_up_field()
    torque_limit: float | None = torque_limit()
    frame_mass: float | None = frame_mass_field()
    frame_stiffness: float | None = frame_stiffness_field()
    frame_damping: float = frame_damping_field()
    motor: Motor | None = motor_field()

    def _assemble(self) -> Linkage:
        # The crank points from O to A, the rod from A to B, the links from P to B and C
        # to D.
        o = complex(self.crank_x, self.crank_y)
        a = o + self.crank_length
        side = LEFT if o.real < 0.0 else RIGHT
        b = meeting_point(0j, a, self.upper_length, self.rod_length, side)
        down = math.sqrt(max(self.lower_length**2 - b.real**2, 0.0))
        pivots = {"O": (self.crank_x, self.crank_y), "P": (0.0, 0.0)}
        crown = self._crown(0.5 * math.pi, pivots)
        return assemble(
            name=self.kind,
            bodies=(
                *crown.bodies,
                *bars_of(self, "crank", "rod", "upper link", "lower link"),
                self._slide("slider", self.slider_mass),
            ),
            joints=(
                *crown.guides,
                Pin("O", crown.ends["O"], "crank.tail"),
                Pin("A", "crank.head", "rod.tail"),
                Pin("B", "rod.head", "upper link.head"),
                Pin("P", crown.ends["P"], "upper link.tail"),
                Pin("C", "upper link.head", "lower link.tail"),
                Pin("D", "lower link.head", "slider"),
                self._guide("slider", 0.5 * math.pi),
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

    distance: float = chosen_length(1.2, "O1 to O2, and B1 to B2")
    crank_length: float = chosen_length(0.1, "cranks, O to A")
    rod_length: float = chosen_length(0.8, "rods, A to B; longer than the cranks")
    crank_mass: float = chosen_mass(60.0, "mass of a crank")
    rod_mass: float = chosen_mass(80.0, "mass of a rod")
    slider_mass: float = chosen_mass(500.0, "mass of the slide with the upper tool")
    crank_inertia: float | None = thin_rod_inertia("a crank (torque only)")
    rod_inertia: float | None = thin_rod_inertia("a rod")
    gravity: float = gravity_field()
    speed: float = chosen_speed(
        2.0 * math.pi, "speed of crank 2; crank 1 has the opposite one"
    )
    run_up: int = run_up_field()
    torque_limit: float | None = torque_limit()

    def __post_init__(self) -> None:
        super().__post_init__()
        check_rod(self.rod_length, self.crank_length, "joints B1 and B2 do not close")

    def _assemble(self) -> Linkage:
        half = 0.5 * self.distance
        up = 0.5 * math.pi
        bodies = []
        joints = []
        drives = []
        for number, side in (("1", -1.0), ("2", 1.0)):
            crank = f"crank {number}"
            rod = f"rod {number}"
            bodies += bars_of(self, crank, rod)
            joints += [
                Pin(f"O{number}", (side * half, 0.0), f"{crank}.tail"),
                Pin(f"A{number}", f"{crank}.head", f"{rod}.tail"),
                Pin(f"B{number}", f"{rod}.head", f"slider.{number}"),
            ]
            drives.append(self._drive(crank, up, side))
        # The guide holds the angle of the slide, so that its inertia has no effect.
        points = {"1": (-half, 0.0), "2": (half, 0.0)}
        bodies.append(Body("slider", self.slider_mass, 1.0, points))
        return assemble(
            name=self.kind,
            bodies=bodies,
            joints=(*joints, self._guide("slider", up)),
            drives=drives,
            guess={"rod 1": -up, "rod 2": -up},
            gravity=self.gravity,
            run_up=self.run_up,
        )
