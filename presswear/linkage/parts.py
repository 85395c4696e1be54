"""Parts of a linkage as a user or a file names them, and the places of their points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Annotated, Any

from presswear.linkage.bodies import Body
from presswear.linkage.cycle import MAX_CYCLE, MIN_CYCLE
from presswear.linkage.drives import Drive, Follow, GearedDrive, LinearDrive
from presswear.linkage.joints import AnyPin, Guide, Joint, Pin, Revolute
from presswear.linkage.loads import AnyLoad, Force, Load, Moment
from presswear.linkage.points import (
    ANGLE,
    GROUND,
    Attachment,
    End,
    OutputPoint,
    Place,
    angle,
)
from presswear.linkage.spring import AnySpring
from presswear.tools.errors import InputError, unknown
from presswear.tools.fields import count, quantity
from presswear.tools.serialize import Checked

# Fields of data classes; without a cycle its time follows from the drives.
run_up_field = partial(
    count, 0, 0, 1000, "chosen", "number of cycles of the run-up from rest"
)
cycle_field = partial(
    quantity, None, "s", MIN_CYCLE, MAX_CYCLE, "", "time after which the motion repeats"
)
gravity_field = partial(
    quantity, 9.81, "m/s^2", -100.0, 100.0, "assumed", "acceleration along -y"
)


@dataclass(frozen=True)
class Parts(Checked):
    """Arguments of ``assemble``; points are given by name where they have one."""

    output: End | OutputPoint
    name: str
    direction: float | None = angle("of the output point", None)
    guess: Mapping[str, Annotated[float, ANGLE]] = field(default_factory=dict)
    cycle: float | None = cycle_field()
    run_up: int = run_up_field()
    gravity: float = gravity_field()
    bodies: Sequence[Body] = ()
    joints: Sequence[AnyPin | Guide] = ()
    drives: Sequence[Drive | LinearDrive | GearedDrive] = ()
    springs: Sequence[AnySpring] = ()
    loads: Sequence[Load | Force | Moment] = ()


class Placing:
    """Bodies by name, on which joints, drives, springs and loads get their points."""

    def __init__(self, parts: Parts) -> None:
        self.bodies = {body.name: body for body in parts.bodies}
        guides = [joint for joint in parts.joints if isinstance(joint, Guide)]
        self.guides = {guide.name: guide for guide in guides}
        self.drives = {drive.body: drive for drive in parts.drives}
        self.guide_directions = {
            guide.body: guide.direction for guide in guides if not guide.is_moving
        }

    def check_body(self, body: str, where: str) -> None:
        """Raise InputError where no body has a name."""
        if body not in self.bodies:
            raise unknown(f"body in {where}", body, self.bodies)

    def point(self, end: End, where: str) -> Attachment:
        """Return a point by its name or its place."""
        if isinstance(end, tuple):
            return Attachment(GROUND, *end)
        if isinstance(end, Attachment):
            if end.body != GROUND:
                self.check_body(end.body, where)
            return end
        body, dot, name = end.partition(".")
        self.check_body(body, where)
        points = dict(self.bodies[body].points) | {"centre": (0.0, 0.0)}
        name = name if dot else "centre"
        if name not in points:
            raise unknown(f"point of {body} in {where}", name, points)
        return Attachment(body, *points[name])

    def output(
        self, end: OutputPoint | End, where: str, direction: float | None
    ) -> OutputPoint:
        """Return a point that is observed along a direction, by default that of its guide."""
        at = end if isinstance(end, OutputPoint) else self.point(end, where)
        self.check_body(at.body, where)
        if isinstance(at, OutputPoint):
            return at
        if direction is None:
            direction = self.guide_directions.get(at.body, 0.0)
        return OutputPoint(at.body, direction, at.x, at.y)

    def joint(self, joint: AnyPin | Guide) -> Joint:
        """Return a joint between two points, or a guide through the slide as it is drawn."""
        if isinstance(joint, Guide):
            return self._guide(joint)
        where = f"joint {joint.name}"
        first = self.point(joint.first, where)
        second = self.point(joint.second, where)
        if isinstance(joint, Revolute):
            return replace(joint, first=first, second=second)
        return Revolute(
            joint.name,
            first,
            second,
            stiffness=joint.stiffness,
            damping_ratio=joint.damping_ratio,
        )

    def _guide(self, guide: Guide) -> Guide:
        where = f"guide {guide.name}"
        self.check_body(guide.body, where)
        origin: Place | None = (0.0, 0.0)
        if guide.is_moving:
            self.check_body(guide.on, f"on of {where}")
            origin = self.bodies[guide.on].drawn_at
        slide = self.bodies[guide.body].drawn_at
        if slide is None or origin is None:
            slide = (0.0, 0.0)
            origin = slide
        x = slide[0] - origin[0] if guide.x is None else guide.x
        y = slide[1] - origin[1] if guide.y is None else guide.y
        return replace(guide, x=x, y=y)

    def drive(self, drive: Drive) -> Drive:
        """Return a drive; the point that follows a curve has a direction."""
        self.check_body(drive.body, "drives")
        if isinstance(drive, LinearDrive):
            self._check_along(drive)
        if isinstance(drive, GearedDrive):
            return self._geared(drive)
        follow = drive.follow
        if follow is None:
            return drive
        at = self.output(follow.point, f"follow of {drive.body}", follow.direction)
        return replace(drive, follow=replace(follow, point=at, direction=at.direction))

    def _geared(self, drive: GearedDrive) -> GearedDrive:
        """Return a drive with the motion of its leader."""
        where = f"{drive.name}: leader = {drive.leader}"
        if drive.leader not in self.drives:
            raise unknown(f"driven body in {drive.name}", drive.leader, self.drives)
        leader = self.drives[drive.leader]
        if isinstance(leader, LinearDrive | GearedDrive) or leader.follow is not None:
            raise InputError(
                f"{where}: allowed is a body with a drive that turns it, without along, leader or "
                "follow"
            )
        return drive.placed(leader)

    def _check_along(self, drive: LinearDrive) -> None:
        """Raise InputError if the guide of a drive does not fit."""
        where = f"{drive.name}: along = {drive.along}"
        if drive.along not in self.guides:
            raise unknown(f"guide in {drive.name}", drive.along, self.guides)
        guide = self.guides[drive.along]
        if guide.body != drive.body:
            raise InputError(f"{where}: this guide is of {guide.body}")
        if guide.stiffness is not None:
            raise InputError(f"{where}: this guide has a stiffness; allowed is none")

    def spring(self, spring: AnySpring) -> AnySpring:
        """Return a spring between points of two bodies."""
        where = f"spring {spring.name}"
        first = self.point(spring.first, where)
        second = self.point(spring.second, where)
        if first.body == second.body:
            raise InputError(
                f"{where}: both ends are on {first.body}, allowed are two bodies"
            )
        return replace(spring, first=first, second=second)

    def load(self, load: AnyLoad) -> AnyLoad:
        """Return a load; a force acts on a point, the others on a body."""
        if isinstance(load, Force):
            return replace(load, point=self.point(load.point, "loads"))
        self.check_body(load.body, "loads")
        return load


def part_with_names(bodies: Sequence[Body], element: Any) -> Any:
    """Return an element of a linkage with its points by name, as in a file."""
    if isinstance(element, OutputPoint):
        return _name_of(bodies, element.attachment)
    if isinstance(element, Attachment):
        return _name_of(bodies, element)
    if type(element) is Revolute:
        ends = _name_of(bodies, element.first), _name_of(bodies, element.second)
        return Pin(element.name, *ends, element.stiffness, element.damping_ratio)
    if not isinstance(element, AnySpring | Revolute | Force | Drive | Follow):
        return element
    values = {
        item.name: part_with_names(bodies, getattr(element, item.name))
        for item in fields(element)
    }
    return type(element)(**values)


def _name_of(bodies: Sequence[Body], point: Attachment) -> End:
    """Return ``body.point``, or the point if it has no name; coordinates on the frame."""
    if point.body == GROUND:
        return point.x, point.y
    body = next(body for body in bodies if body.name == point.body)
    points = {"centre": (0.0, 0.0)} | dict(body.points)
    for name, place in points.items():
        if place == (point.x, point.y):
            return f"{body.name}.{name}"
    return point
