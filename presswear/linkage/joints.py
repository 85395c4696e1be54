"""Pin joints and guides without clearance."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.points import GROUND, Attachment, End, angle, place
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.serialize import Checked

# Stiffness of an elastic joint, N/m
MIN_STIFFNESS = 1e3
MAX_STIFFNESS = 1e12
# Length and width of a slide, m
MIN_SLIDE = 1e-3
MAX_SLIDE = 10.0
ELASTIC_JOINT_DAMPING = 0.02  # damping ratio of an elastic joint; assumed


def elastic_stiffness(text: str) -> Any:
    """Return a data class field for the stiffness of an elastic joint, N/m."""
    return quantity(None, "N/m", MIN_STIFFNESS, MAX_STIFFNESS, "chosen", text)


def elastic_damping(text: str) -> Any:
    """Return a data class field for the damping ratio of an elastic joint."""
    return quantity(ELASTIC_JOINT_DAMPING, "", 0.0, 1.0, "assumed", text)


def slide_size(text: str) -> Any:
    """Return a data class field for a size of a slide, m."""
    return quantity(None, "m", MIN_SLIDE, MAX_SLIDE, "chosen", text)


@dataclass(frozen=True)
class Pin(Checked):
    """Pin joint between two points, as names or coordinates; see ``Revolute``."""

    name: str
    first: End
    second: End
    stiffness: float | None = elastic_stiffness(
        "stiffness of pin and rods in any direction; default: rigid"
    )
    damping_ratio: float = elastic_damping(
        "damping of an elastic pin, part of the critical one"
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
    damping_ratio: float = ELASTIC_JOINT_DAMPING

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
    stiffness: float | None = elastic_stiffness(
        "stiffness of a spring along the line, as of a frame; default: none"
    )
    damping: float = elastic_damping("damping of the spring, part of the critical one")
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
    def size(self) -> tuple[float, float]:
        """Length and width of the slide, m, which a guide with clearance has."""
        assert self.length is not None
        assert self.width is not None
        return self.length, self.width

    @property
    def rows(self) -> int:
        """Number of constraint equations; that of a spring holds its length."""
        return 2 if self.stiffness is None else 3


# Pin joints of the table ``joints``. Further kinds that stretch are derived from both. A
# table of a file is of the kind whose fields it has.
AnyPin = Pin | Revolute
Joint = Revolute | Guide


def closing_guides(joints: Iterable[Joint]) -> dict[str, float]:
    """Return guides on bodies that close a loop of guides alone, as the face of a wedge.

    The other guides hold the angle of such a body on its carrier already: the value is
    this angle by the name of the guide, rad.
    """
    closing = {}
    # The bodies that guides connect, with their angles from one of them, by body
    groups: dict[str, dict[str, float]] = {}
    guides = [joint for joint in joints if isinstance(joint, Guide)]
    for guide in sorted(guides, key=lambda guide: guide.is_moving):
        carriers = groups.setdefault(guide.on, {guide.on: 0.0})
        slides = groups.setdefault(guide.body, {guide.body: 0.0})
        if slides is carriers:
            if guide.is_moving:
                closing[guide.name] = slides[guide.body] - slides[guide.on]
            continue
        turn = carriers[guide.on] + guide.angle - slides[guide.body]
        for body, body_angle in slides.items():
            carriers[body] = body_angle + turn
            groups[body] = carriers
    return closing


def rows_of_joints(joints: Sequence[Joint]) -> list[int]:
    """Return the numbers of constraint equations; a guide that closes a loop holds no angle."""
    closing = closing_guides(joints)
    return [joint.rows - (joint.name in closing) for joint in joints]


def ends_of(joint: Joint) -> tuple[Attachment, Attachment]:
    """Return the two points that a joint holds together; of a guide a point and the mass centre."""
    if isinstance(joint, Guide):
        return Attachment(joint.on, joint.x, joint.y), Attachment(joint.body, 0.0, 0.0)
    return joint.first, joint.second
