"""A planar linkage as data, and how it is assembled from its parts.

One description serves every engine. Coordinates of body ``i`` are the position of its
mass centre and its angle, ``q[3 i : 3 i + 3] = x, y, theta``, in the order of
``Linkage.bodies``. The frame is the name ``GROUND``; points on it are global.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from fractions import Fraction
from functools import partial
from itertools import permutations
from typing import Annotated, Any, ClassVar

from presswear.linkage.drives import Drive, Follow
from presswear.linkage.elements import (
    ANGLE,
    GROUND,
    MIN_INERTIA,
    Attachment,
    Bar,
    Body,
    Bushing,
    ClearanceJoint,
    End,
    Guide,
    GuideCorner,
    Joint,
    OutputPoint,
    Pin,
    Revolute,
    angle,
    ends_of,
)
from presswear.linkage.loads import AnyLoad, Force, Load, Moment, OverTime, Spring
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, count, quantity, written
from presswear.tools.serialize import Checked, checked_arguments, make, plain

# Shortest and longest cycle, s. A pin at rest in its bearing takes some 1e4 steps in a
# second of the motion, so that a longer cycle takes too long to compute.
MIN_CYCLE = 1e-5
MAX_CYCLE = 1e3
# distance of the points of a joint in the drawing, relative to its size
DRAWING_TOL = 1e-6
MAX_TURNS = 1000  # of a drive in a cycle
MAX_COMMON_TURNS = 64  # of a drive in the longest cycle that is found
_SIGNS = set(".,:;=/\\'\"")  # by which points, lists and files are separated
_FORMULA = tuple("+-@＋－＠＝")  # first characters of formulas in a spreadsheet
_TABLES = ("bodies", "joints", "drives", "springs", "loads")
_RELEASED = "elastic_pins", "elastic_guides", "is_turned_by_motors"

# Fields of data classes; without a cycle its time follows from the drives.
run_up = partial(
    count, 0, 0, 1000, "chosen", "number of cycles of the run-up from rest"
)
cycle = partial(
    quantity, None, "s", MIN_CYCLE, MAX_CYCLE, "", "time after which the motion repeats"
)
gravity = partial(
    quantity, 9.81, "m/s^2", -100.0, 100.0, "assumed", "acceleration along -y"
)


@dataclass(frozen=True)
class Linkage(Checked):
    """Planar mechanism, driven, with or without clearance joints; see ``assemble`` for its parts.

    Its joints are ideal; those with clearance are in ``clearances``. The output point
    is recorded as ``slider``.
    """

    kind: ClassVar[str] = "linkage"
    default_joints: ClassVar[tuple[str, ...]] = ()
    origin: ClassVar[str] = "Dimensions and masses are the user's."

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    drives: tuple[Drive, ...]
    output: OutputPoint
    guess: tuple[tuple[str, float], ...] = ()
    cycle: float | None = cycle()
    run_up: int = run_up()
    name: str = "linkage"
    gravity: float = gravity()
    springs: tuple[Spring, ...] = ()
    loads: tuple[AnyLoad, ...] = ()
    clearances: tuple[ClearanceJoint, ...] = ()
    # that stretch; see ``released``
    elastic_pins: tuple[Revolute, ...] = ()
    elastic_guides: tuple[Guide, ...] = ()
    # True where motors turn their bodies; see ``released``
    is_turned_by_motors: bool = False

    def changed(self, **changes: Any) -> "Linkage":
        """Return the linkage assembled again with arguments of ``assemble`` changed."""
        arguments = vars(self) | changes
        released = {name: arguments.pop(name) for name in _RELEASED}
        return replace(assemble(**arguments), **released)

    @property
    def ideal(self) -> "Linkage":
        """The linkage without laws: drives prescribe its motion, its joints are ideal.

        Guides with a spring hold their body at their point. The loads stay. It is the
        reference of a scene, with the period, the start and bottom dead centre.
        """
        pins = (
            Revolute(joint.name, joint.bearing, joint.pin)
            for joint in self.with_closed_guides.clearances
        )
        elastic = {guide.name: guide for guide in self.elastic_guides}
        others = (elastic.get(joint.name, joint) for joint in self.joints)
        return replace(
            self,
            joints=(*others, *pins, *self.elastic_pins, *self.loose_guides),
            drives=self.without_motors.drives,
            clearances=(),
            elastic_pins=(),
            elastic_guides=(),
            is_turned_by_motors=False,
        )

    @property
    def corners(self) -> tuple[GuideCorner, ...]:
        """Corners of the slides in guides with clearance."""
        return tuple(one for one in self.clearances if isinstance(one, GuideCorner))

    @property
    def loose_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance."""
        return tuple(dict.fromkeys(corner.guide for corner in self.corners))

    @property
    def without_oil(self) -> "Linkage":
        """The linkage whose joints are dry."""
        if all(joint.oil is None for joint in self.clearances):
            return self
        clearances = tuple(replace(joint, oil=None) for joint in self.clearances)
        return replace(self, clearances=clearances)

    @property
    def worn_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance, the wear of whose walls is computed."""
        corners = (corner for corner in self.corners if corner.wall is not None)
        return tuple(dict.fromkeys(corner.guide for corner in corners))

    @property
    def with_closed_guides(self) -> "Linkage":
        """The linkage whose guides have no clearance."""
        if not self.corners:
            return self
        pins = (one for one in self.clearances if not isinstance(one, GuideCorner))
        return replace(
            self,
            joints=(*self.joints, *self.loose_guides),
            clearances=tuple(pins),
        )

    @property
    def without_motors(self) -> "Linkage":
        """The linkage whose drives all prescribe the motion of their bodies."""
        drives = tuple(replace(drive, motor=None) for drive in self.drives)
        return replace(self, drives=drives, is_turned_by_motors=False)

    @property
    def released(self) -> "Linkage":
        """The linkage for the dynamics, in which joints with a stiffness stretch.

        Elastic pins hold nothing, and guides with a spring only their line and angle.
        Drives with a motor prescribe nothing, and the inertia of the motor turns with
        the body.
        """
        pins = tuple(pin for pin in self.revolutes if pin.stiffness is not None)
        guides = tuple(guide for guide in self.guides if guide.stiffness is not None)
        if not (pins or guides or self.has_motors):
            return self
        joints = tuple(
            replace(joint, stiffness=None) if joint in guides else joint
            for joint in self.joints
            if joint not in pins
        )
        return replace(
            self,
            bodies=self._bodies_with_rotors,
            joints=joints,
            elastic_pins=(*self.elastic_pins, *pins),
            elastic_guides=(*self.elastic_guides, *guides),
            is_turned_by_motors=self.has_motors,
        )

    @property
    def _bodies_with_rotors(self) -> tuple[Body, ...]:
        """Bodies with the inertia of the motors that turn them."""
        if self.is_turned_by_motors or not self.has_motors:
            return self.bodies
        rotors = {
            drive.body: drive.motor.reflected_inertia
            for drive in self.drives
            if drive.motor is not None
        }
        return tuple(
            replace(body, inertia=body.inertia + rotors.get(body.name, 0.0))
            for body in self.bodies
        )

    @property
    def has_motors(self) -> bool:
        """True if a drive has a motor."""
        return any(drive.motor is not None for drive in self.drives)

    @property
    def leader(self) -> Drive | None:
        """First drive with a motor that is no servo; its angle is the clock of the cycles.

        tau = (angle - its start) / nominal speed is the time of the ideal motion at
        which the leader has this angle. Without a leader tau is the time.
        """
        for drive in self.drives:
            if drive.motor is not None and not drive.motor.is_servo:
                return drive
        return None

    @property
    def motor_drives(self) -> tuple[Drive, ...]:
        """Drives whose motors turn their bodies."""
        return tuple(drive for drive in self.drives if not self.prescribes(drive))

    @property
    def prescribed_drives(self) -> tuple[Drive, ...]:
        """Drives that prescribe the motion of their bodies."""
        return tuple(drive for drive in self.drives if self.prescribes(drive))

    def prescribes(self, drive: Drive) -> bool:
        """Return whether a drive prescribes the motion of its body."""
        return drive.motor is None or not self.is_turned_by_motors

    @property
    def elastic_joints(self) -> tuple[Joint, ...]:
        """Pins and guides that stretch in the dynamics."""
        return (*self.elastic_pins, *self.elastic_guides)

    @property
    def revolutes(self) -> tuple[Revolute, ...]:
        """Ideal pin joints."""
        return tuple(joint for joint in self.joints if isinstance(joint, Revolute))

    @property
    def rubbing_pins(self) -> tuple[Revolute, ...]:
        """Ideal pin joints with friction."""
        return tuple(
            joint for joint in self.revolutes if joint.friction.coefficient > 0.0
        )

    @property
    def bushings(self) -> tuple[Bushing, ...]:
        """Pin joints with friction, with and without clearance."""
        pins = (one for one in self.clearances if not isinstance(one, GuideCorner))
        others: tuple[Bushing, ...] = (*pins, *self.elastic_pins)
        rubbing = (joint for joint in others if joint.friction.coefficient > 0.0)
        return (*rubbing, *self.rubbing_pins)

    @property
    def guides(self) -> tuple[Guide, ...]:
        """Guides."""
        return tuple(joint for joint in self.joints if isinstance(joint, Guide))

    @property
    def dead_loads(self) -> tuple[Load, ...]:
        """Constant loads."""
        return tuple(load for load in self.loads if isinstance(load, Load))

    @property
    def live_loads(self) -> tuple[Force | Moment, ...]:
        """Loads with a law."""
        return tuple(load for load in self.loads if not isinstance(load, Load))

    @property
    def allowed_joints(self) -> tuple[str, ...]:
        """Names of the joints that may have clearance."""
        joints: tuple[Joint, ...] = (*self.revolutes, *self.guides)
        return tuple(joint.name for joint in joints if joint.stiffness is None)

    def linkage(self) -> "Linkage":
        """Return the linkage itself, as any mechanism returns its linkage."""
        return self

    @property
    def period(self) -> float:
        """Time of one cycle, s: the shortest in which every drive makes whole turns."""
        label = f"cycle of {self.name}, in which all drives make whole turns,"
        speeds = [
            (drive.name, speed) for drive in self.drives for speed in drive.frequencies
        ]
        period = (
            self._common_period([w for _, w in speeds])
            if self.cycle is None
            else self.cycle
        )
        Quantity("s", MIN_CYCLE, MAX_CYCLE).check(label, period)
        for name, speed in speeds:
            turns = speed * period / (2.0 * math.pi)
            if turns > MAX_TURNS:
                fault = f"{name} turns {turns:.6g} times in it, with {written(speed, 'rad/s')}"
                allowed = f"allowed are {MAX_TURNS} times at most"
                raise InputError(f"{label} = {period:g} s: {fault}; {allowed}")
        return period

    def _common_period(self, speeds: Sequence[float]) -> float:
        if not speeds:
            raise InputError(
                f"cycle of {self.name}: no drive turns; add one, or specify cycle, s"
            )
        turns = 1
        for speed in speeds:
            ratio = Fraction(speed / speeds[0]).limit_denominator(MAX_COMMON_TURNS)
            if abs(float(ratio) * speeds[0] / speed - 1.0) > 1e-9:
                raise InputError(
                    f"cycle of {self.name}: speeds of {written(speeds[0], 'rad/s')} and "
                    f"{written(speed, 'rad/s')} have no common cycle of {MAX_COMMON_TURNS} turns "
                    "or less; specify cycle, s"
                )
            turns = math.lcm(turns, ratio.denominator)
        return 2.0 * math.pi * turns / speeds[0]

    @property
    def phase(self) -> str:
        """Name of the angle that goes through a whole turn in a cycle."""
        turn = 2.0 * math.pi / self.period
        cranks = [
            d
            for d in self.drives
            if not d.repeats and abs(abs(d.speed) / turn - 1.0) < 1e-9
        ]
        return "crank angle" if cranks else "phase of the cycle"

    @property
    def run_up_time(self) -> float:
        """Time in which it runs up, s; with a motor the nominal time."""
        if self.leader is not None:
            return self.run_up * self.period
        return 2.0 * self.run_up * self.period if self.run_up else 0.0

    def index(self, body: str) -> int:
        """Return the position of a body in ``bodies``."""
        return [one.name for one in self.bodies].index(body)

    def as_plain(self) -> dict[str, Any]:
        """Return the arguments of ``assemble`` as plain data, without clearance joints."""
        return {"kind": self.kind, **plain(_parts_of(self))}


@dataclass(frozen=True)
class _Parts(Checked):
    """Arguments of ``assemble``; points are given by name where they have one."""

    output: End | OutputPoint
    name: str
    direction: float | None = angle("of the output point", None)
    guess: Mapping[str, Annotated[float, ANGLE]] = field(default_factory=dict)
    cycle: float | None = cycle()
    run_up: int = run_up()
    gravity: float = gravity()
    bodies: Sequence[Body] = ()
    joints: Sequence[Pin | Revolute | Guide] = ()
    drives: Sequence[Drive] = ()
    springs: Sequence[Spring] = ()
    loads: Sequence[Load | Force | Moment] = ()


@checked_arguments
def assemble(  # noqa: PLR0913 - the tables of a file of a mechanism
    bodies: Sequence[Any],
    joints: Sequence[Any] = (),
    drives: Sequence[Any] = (),
    output: Any = "",
    guess: Mapping[str, Any] | Sequence[tuple[str, Any]] = (),
    cycle: float | str | None = None,
    run_up: int = 0,
    name: str = "linkage",
    gravity: float | str = 9.81,
    springs: Sequence[Any] = (),
    loads: Sequence[Any] = (),
    clearances: Sequence[ClearanceJoint] = (),
    direction: float | str | None = None,
) -> Linkage:
    """Assemble a linkage from bodies, joints and drives, and check it.

    Points are ``body.point``, ``body`` for its mass centre, or coordinates on the
    frame. Every part may be given as plain data, too.

    Parameters
    ----------
    joints : sequence of Pin, Revolute or Guide
    output : str, tuple, Attachment or OutputPoint
        Output point; default: the mass centre of the last body.
    guess : mapping of str to float
        Approximate initial angles, rad, of bodies that are neither driven nor guided.
        They select one of the two assemblies of a loop.
    cycle : float, str or None
        Time after which the motion repeats, s; None: the shortest in which every drive
        makes whole turns.
    run_up : int
        Cycles in which the mechanism runs up from rest, in twice their time; 0: no
        run-up.
    gravity : float or str
        Acceleration along -y, m/s^2.
    loads : sequence of Load, Force or Moment
    direction : float, str or None
        Direction along which the output point is observed, rad; None: along the guide
        of its body, or else x.

    Raises
    ------
    InputError
        Names the body, point, joint or value that does not fit.
    """
    rows = list(bodies)
    for k, body in enumerate(bodies):
        if isinstance(body, Mapping):
            rows[k] = make(f"bodies[{k}]", Bar if "length" in body else Body, body)
    if not rows:
        raise InputError("bodies: at least one is needed")
    end = output or getattr(rows[-1], "name", "")
    tables = rows, joints, drives, springs, loads
    convert: Any = _Parts  # takes texts for numbers
    parts: _Parts = convert(
        end, name, direction, dict(guess), cycle, run_up, gravity, *tables
    )
    placing = _Placing(parts)
    for body in parts.guess:
        placing.check_body(body, "guess")
    linkage = Linkage(
        bodies=tuple(parts.bodies),
        joints=tuple(map(placing.joint, parts.joints)),
        drives=tuple(map(placing.drive, parts.drives)),
        output=placing.output(parts.output, "output", parts.direction),
        guess=tuple(parts.guess.items()),
        cycle=parts.cycle,
        run_up=parts.run_up,
        name=parts.name,
        gravity=parts.gravity,
        springs=tuple(map(placing.spring, parts.springs)),
        loads=tuple(map(placing.load, parts.loads)),
        clearances=tuple(clearances),
    )
    _check(linkage)
    _check_drawing(linkage)
    return linkage


class _Placing:
    """Bodies by name, on which joints, drives, springs and loads get their points."""

    def __init__(self, parts: _Parts) -> None:
        self.bodies = {body.name: body for body in parts.bodies}
        guides = (joint for joint in parts.joints if isinstance(joint, Guide))
        self.guide_directions = {guide.body: guide.direction for guide in guides}

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

    def joint(self, joint: Pin | Revolute | Guide) -> Joint:
        """Return a joint between two points, or a guide through the slide as it is drawn."""
        if isinstance(joint, Guide):
            return self._guide(joint)
        where = f"joint {joint.name}"
        first, second = self.point(joint.first, where), self.point(joint.second, where)
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
        self.check_body(guide.body, f"guide {guide.name}")
        x, y = self.bodies[guide.body].drawn_at or (0.0, 0.0)
        if guide.x is not None:
            x = guide.x
        if guide.y is not None:
            y = guide.y
        return replace(guide, x=x, y=y)

    def drive(self, drive: Drive) -> Drive:
        """Return a drive; the point that follows a curve has a direction."""
        self.check_body(drive.body, "drives")
        follow = drive.follow
        if follow is None:
            return drive
        at = self.output(follow.point, f"follow of {drive.body}", follow.direction)
        return replace(drive, follow=replace(follow, point=at, direction=at.direction))

    def spring(self, spring: Spring) -> Spring:
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


def _check(linkage: Linkage) -> None:
    """Raise InputError for names that stand twice and for bodies without inertia that can turn."""
    joints = [joint.name for joint in (*linkage.joints, *linkage.clearances)]
    names = {
        "body": [GROUND, *(body.name for body in linkage.bodies)],
        "joint": ["none", *joints],
        "spring": [spring.name for spring in linkage.springs],
        "drive of": [drive.body for drive in linkage.drives],
    }
    for what, name in ((what, name) for what, row in names.items() for name in row):
        if (
            not name.isprintable()
            or name != name.strip()
            or not name
            or set(name) & _SIGNS
        ):
            signs = " ".join(sorted(_SIGNS))
            raise InputError(
                f"name of a {what} = {name!r}: a text without {signs} is expected"
            )
        if name.startswith(_FORMULA):
            fault = (
                "must not begin with + - or @, which begin formulas in a spreadsheet"
            )
            raise InputError(f"name of a {what} = {name!r}: {fault}")
        if names[what].count(name) > 1:
            raise InputError(f"{what} {name}: the name is used twice")
    for one, longer in permutations(joints, 2):
        if longer.startswith(f"{one}_"):
            fault = f"must not begin with {one}_, because {one} is a joint too"
            raise InputError(f"name of a joint = {longer!r}: {fault}")
    for load in linkage.live_loads:
        if isinstance(load.law, OverTime) and load.law.period is None:
            load.law.check_period("cycle", linkage.period)
    _check_motors(linkage)
    fixed = {guide.body for guide in linkage.guides}
    fixed |= {
        drive.body
        for drive in linkage.drives
        if drive.is_at_rest and drive.motor is None
    }
    for body in linkage.bodies:
        if body.inertia < MIN_INERTIA and not (
            body.inertia == 0.0 and body.name in fixed
        ):
            holds = "a guide, or a drive at rest, keeps from turning"
            exception = f"0 is allowed for a body that {holds}"
            allowed = f"must be {MIN_INERTIA:g} kg m^2 or more; {exception}"
            raise InputError(
                f"inertia of {body.name} = {body.inertia:g} kg m^2: {allowed}"
            )


def _check_motors(linkage: Linkage) -> None:
    """Raise InputError for a prescribed motion beside a motor, and a leader without a speed."""
    leader = linkage.leader
    moving = [
        drive
        for drive in linkage.drives
        if drive.motor is None and not drive.is_at_rest
    ]
    if leader is None:
        servos = [drive for drive in linkage.drives if drive.motor is not None]
        if servos and moving:
            raise InputError(
                f"motor of {servos[0].body}: a servo follows the angle of a motor, and "
                f"{moving[0].body} has none; give it one, motor = {{torque, inertia}}, or leave "
                f"out the servo, and {servos[0].body} follows its motion exactly"
            )
        return
    if leader.speed == 0.0:
        raise InputError(
            f"speed of {leader.body} = 0 rad/s: cycles are counted by the angle of this drive, the "
            "first with a motor; a nominal speed is needed"
        )
    for drive in moving:
        raise InputError(
            f"{drive.name}: its motion follows the time, but the motor of {leader.body} does "
            "not; give it a servo, motor = {stiffness, damping}, which follows the angle of "
            f"{leader.body}"
        )


def _check_drawing(linkage: Linkage) -> None:
    """Raise InputError where points of a joint do not coincide in the drawing.

    Bodies that are drawn in a frame of their own have another angle at the start.
    """
    angles = dict(linkage.guess) | {one.body: one.angle for one in linkage.guides}
    angles |= {drive.body: drive.angle for drive in linkage.drives}
    places = {GROUND: (0.0, 0.0)}
    for body in linkage.bodies:
        if body.drawn_at is not None and not angles.get(body.name):
            places[body.name] = body.drawn_at
    ends = [ends_of(joint) for joint in linkage.joints]
    size = max((math.hypot(one.x, one.y) for pair in ends for one in pair), default=0.0)
    for joint, pair in zip(linkage.joints, ends, strict=True):
        drawn = [(places[one.body], one) for one in pair if one.body in places]
        if len(drawn) < len(pair):
            continue
        (x0, y0), (x1, y1) = ((x + one.x, y + one.y) for (x, y), one in drawn)
        across, up = x1 - x0, y1 - y0
        if isinstance(joint, Guide):  # along the line any place is allowed
            off = up * math.cos(joint.direction) - across * math.sin(joint.direction)
            across, up = off, 0.0
        distance = math.hypot(across, up)
        if distance > DRAWING_TOL * size:
            first, second = (
                f"{'the line' if isinstance(joint, Guide) and one.body == GROUND else one.body} "
                f"({1e3 * x:.6g}, {1e3 * y:.6g}) mm"
                for one, x, y in ((pair[0], x0, y0), (pair[1], x1, y1))
            )
            raise InputError(
                f"joint {joint.name}: its points lie {written(distance, 'm')} apart in the "
                f"drawing, {first} and {second}; allowed is {written(DRAWING_TOL * size, 'm')}. "
                "Without centre, points are counted from the mass centre of their body"
            )


def _parts_of(linkage: Linkage) -> _Parts:
    """Return the arguments of ``assemble`` that make a linkage."""

    def named(part: Any) -> Any:
        """Return a part with its points by name."""
        if isinstance(part, OutputPoint):
            part = part.attachment
        if isinstance(part, Attachment):
            if part.body == GROUND:
                return part.x, part.y
            points = {"centre": (0.0, 0.0)} | dict(
                linkage.bodies[linkage.index(part.body)].points
            )
            names = [
                name for name, place in points.items() if place == (part.x, part.y)
            ]
            return f"{part.body}.{names[0]}" if names else part
        if isinstance(part, Revolute):
            ends = named(part.first), named(part.second)
            return Pin(part.name, *ends, part.stiffness, part.damping_ratio)
        if not isinstance(part, Spring | Force | Drive | Follow):
            return part
        return type(part)(
            **{item.name: named(getattr(part, item.name)) for item in fields(part)}
        )

    return _Parts(
        named(linkage.output),
        linkage.name,
        linkage.output.direction,
        dict(linkage.guess),
        linkage.cycle,
        linkage.run_up,
        linkage.gravity,
        *(tuple(map(named, getattr(linkage, table))) for table in _TABLES),
    )


def place_of(
    linkage: Linkage, point: Attachment, position: Sequence[float]
) -> tuple[float, float]:
    """Return the place of a point of a body, or of the frame, m, in a position of all bodies."""
    if point.body == GROUND:
        return point.x, point.y
    x, y, angle = position[3 * linkage.index(point.body) :][:3]
    c, s = math.cos(angle), math.sin(angle)
    return x + c * point.x - s * point.y, y + s * point.x + c * point.y


def linkage_from(data: Mapping[str, Any], place: str) -> Linkage:
    """Return a linkage from what ``as_plain`` returned or a file has; messages name the place."""
    return make(
        place, assemble, {key: value for key, value in data.items() if key != "kind"}
    )
