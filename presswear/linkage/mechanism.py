"""Mechanisms made of a few quantities: base class and common fields."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any, ClassVar, NamedTuple

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive
from presswear.linkage.joints import (
    ELASTIC_JOINT_DAMPING,
    Guide,
    elastic_damping,
    elastic_stiffness,
    slide_size,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.motor import Motor
from presswear.linkage.points import End, Place
from presswear.tools.errors import InputError
from presswear.tools.fields import optional, quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

# Length of a link, m
MIN_LINK = 1e-3
MAX_LINK = 10.0
# speed of a crank, rad/s: 0.1 rpm; heavy presses run at 6 to 8 rpm
MIN_SPEED = 0.1 * math.pi / 30.0
LITERATURE = "literature, from memory"
# Side of a directed line
RIGHT = -1.0
LEFT = 1.0
CHOSEN = "Dimensions, masses and speed are chosen."
_BAR_NUMBERS = "length", "mass", "inertia"
# length of a rod over its crank; with equal lengths the rod does not determine on
# which side of the crank the slider is
_MIN_ROD_RATIO = 1.0001


def number_field(
    unit: str, low: float, high: float, origin: str, default: float | None, text: str
) -> Any:
    """Return a data class field of a number with its limits and origin."""
    return quantity(default, unit, low, high, origin, text)


length_field = partial(number_field, "m", MIN_LINK, MAX_LINK)
mass_field = partial(number_field, "kg", 1e-6, 1e4)
inertia_field = partial(number_field, "kg m^2", 1e-9, 1e4)
paper_length = partial(length_field, "paper")
paper_mass = partial(mass_field, "paper")
paper_inertia = partial(inertia_field, "paper")
literature_length = partial(length_field, LITERATURE)
literature_mass = partial(mass_field, LITERATURE)
chosen_length = partial(length_field, "chosen")
chosen_mass = partial(mass_field, "chosen")
chosen_inertia = partial(inertia_field, "chosen")


def thin_rod_inertia(body: str) -> Any:
    """Return a data class field for the inertia of a body that is a thin rod by default."""
    text = f"inertia of {body}; default: that of a thin rod"
    return chosen_inertia(None, text)


chosen_speed = partial(number_field, "rad/s", MIN_SPEED, 5000.0, "chosen")
frame_mass_field = partial(
    number_field,
    "kg",
    1.0,
    1e6,
    "assumed",
    None,
    "reduced mass of crown and bed, which move on a frame with a frame_stiffness",
)
frame_stiffness_field = partial(
    elastic_stiffness,
    "stiffness of the frame along the output direction; default: rigid",
)
frame_damping_field = partial(
    elastic_damping, "damping of the frame, part of the critical one"
)
guide_length_field = partial(
    slide_size, "length of the slide along its guide, for a guide with clearance"
)
guide_width_field = partial(
    slide_size, "width of the slide between its walls, for a guide with clearance"
)
motor_field = partial(
    optional,
    Motor,
    {"torque": 0.0},
    "motor of the crank; none: the crank turns at its nominal speed",
)


class _Crown(NamedTuple):
    """Part of an elastic frame in which cranks turn; without bodies on a rigid frame."""

    bodies: tuple[Body, ...]
    guides: tuple[Guide, ...]
    ends: Mapping[str, End]  # ends of the pins on the frame, by joint


class Mechanism(Checked, ABC):
    """Driven mechanism with ideal joints; subclasses are data classes of its quantities."""

    kind: ClassVar[str]  # name of the mechanism in a stored scene
    allowed_joints: ClassVar[tuple[str, ...]]  # joints that may have clearance
    default_joints: ClassVar[tuple[str, ...]]  # joints that have clearance by default
    origin: ClassVar[str]  # origin of its values, in a sentence
    speed: float  # speed of the driven crank, rad/s
    torque_limit: float | None  # N m
    # Elastic frame; None: rigid
    frame_mass: float | None = None  # kg
    frame_stiffness: float | None = None  # N/m
    frame_damping: float = ELASTIC_JOINT_DAMPING
    # motor of the driven crank; None: the crank turns at its speed
    motor: Motor | None = None
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

        ``pivots`` are the points of the frame at which joints are, by joint, m.
        """
        if self.frame_stiffness is None or self.frame_mass is None:
            return _Crown((), (), pivots)
        crown = Body("crown", self.frame_mass, points=pivots)
        guide = Guide(
            "frame",
            crown.name,
            x=0.0,
            y=0.0,
            direction=direction,
            stiffness=self.frame_stiffness,
            damping=self.frame_damping,
        )
        ends = {joint: f"{crown.name}.{joint}" for joint in pivots}
        return _Crown((crown,), (guide,), ends)

    def _slide(self, name: str, mass: float) -> Body:
        """Return a slide as a block of the size in its guide; ``mass`` in kg."""
        if self.guide_length is None or self.guide_width is None:
            # The inertia has no effect: without clearance the slide cannot turn.
            return Body(name, mass, 1.0)
        squares = self.guide_length**2 + self.guide_width**2
        return Body(name, mass, mass * squares / 12.0)

    def _guide(self, slide: str, direction: float, **values: Any) -> Guide:
        """Return the guide of a slide along a direction, rad."""
        return Guide(
            "guide",
            slide,
            direction=direction,
            length=self.guide_length,
            width=self.guide_width,
            **values,
        )

    @property
    def period(self) -> float:
        """Time of one cycle, s."""
        return 2.0 * math.pi / self.speed

    @property
    def unread(self) -> tuple[str, ...]:
        """Settings without effect: those of a rigid frame, and the torque limit of a motor."""
        unread: list[str] = []
        if self.frame_stiffness is None:
            unread += ["frame_mass", "frame_damping"]
        if self.motor:
            unread.append("torque_limit")
        return tuple(unread)

    def _drive(self, crank: str, start: float = 0.0, sense: float = 1.0) -> Drive:
        """Return the drive of a crank from an angle, rad; ``sense`` -1 is clockwise."""
        limit = None if self.motor else self.torque_limit
        speed = sense * self.speed
        return Drive(crank, speed, start, torque_limit=limit, motor=self.motor)

    def linkage(self) -> Linkage:
        """Return the ideal linkage, every joint closed."""
        return _assembled(self)

    @abstractmethod
    def _assemble(self) -> Linkage: ...


@lru_cache(maxsize=64)
def _assembled(mechanism: Mechanism) -> Linkage:
    return mechanism._assemble()


def check_rod(rod: float, crank: float, fault: str) -> None:
    """Raise InputError for a rod, m, that is not longer than its crank."""
    least = _MIN_ROD_RATIO * crank
    if not rod >= least:
        allowed = f"{written(least, 'm')} to {written(MAX_LINK, 'm')}"
        raise InputError(
            f"rod_length = {written(rod, 'm')}: with crank_length = {written(crank, 'm')} allowed "
            f"is {allowed}; {fault} over the whole turn"
        )


def bars_of(mechanism: Mechanism, *names: str) -> list[Body]:
    """Return the bars of a mechanism; its fields begin with the first words of their names."""
    bars = []
    for name in names:
        prefix = name.split()[0]
        numbers = [getattr(mechanism, f"{prefix}_{number}") for number in _BAR_NUMBERS]
        bars.append(Bar(name, *numbers))
    return bars


def meeting_point(
    p: complex, q: complex, from_p: float, from_q: float, side: float
) -> complex:
    """Return the point at distances from p and q, on a side of the line p to q.

    If no point has these distances, a point of the line p to q is returned.
    """
    length = max(abs(q - p), 1e-12)
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    across = side * math.sqrt(max(from_p**2 - along**2, 0.0))
    return p + complex(along, across) * (q - p) / length
