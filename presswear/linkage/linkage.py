"""A planar linkage as data: its parts, found by their names and checked together.

One description serves every engine.  Coordinates of body ``i`` are the position
of its mass centre and its angle, ``q[3 i : 3 i + 3] = x, y, theta``, in the order
of ``Linkage.bodies``.  The frame is the name ``GROUND``; points on it are global.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations
from typing import Any, ClassVar

from presswear.linkage.elements import (
    LEAST_INERTIA,
    Body,
    ClearanceJoint,
    Guide,
    Pin,
    Revolute,
)
from presswear.linkage.loads import AnyLoad, Force, Load, Moment, OverTime, Spring
from presswear.linkage.motions import Drive
from presswear.linkage.points import GROUND, Attachment, End, Probe
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, count, quantity
from presswear.tools.serialize import check_fields

CYCLE = 1e-5, 1e3
"""Shortest and longest time of a cycle, s: a pin at rest in its bearing takes some 1e4 steps a
second."""
MOST_TURNS = 1000
"""Turns of a drive in a cycle."""
COMMON_TURNS = 64
"""Turns of a drive in the longest cycle that is found by itself."""


def run_up() -> Any:
    """A dataclass field: cycles of a run-up."""
    return count(0, 0, 1000, "chosen", "cycles through which it runs up from rest")


def gravity() -> Any:
    """A dataclass field: acceleration along -y, m/s^2."""
    return quantity(9.81, "m/s^2", -100.0, 100.0, "assumed", "acceleration along -y")


@dataclass(frozen=True)
class Linkage:
    """A planar mechanism, driven, with or without clearance joints.

    Points may be given as text, ``body.point`` or ``body`` for its mass centre, and those on the
    frame as coordinates; sequences become tuples.

    Attributes
    ----------
    bodies : tuple of Body
    joints : tuple of Revolute or Guide
        Ideal joints; a Pin is made a Revolute.
    drives : tuple of Drive
    watch : Probe
        What is recorded as ``slider``; a point given as text is watched along the guide of its
        body, or else along x; without one it is the mass centre of the last body.
    guess : tuple of (str, float)
        Rough angles at the start, rad, of bodies that are neither driven nor guided: which way
        the linkage is put together.  A mapping may be given.
    cycle : float or None
        Time after which the motion repeats, s; None: as the speeds of the drives say.
    run_up : int
        Cycles through which it runs up from rest, all drives in step, in the time of twice as
        many; 0: it starts at speed.
    name : str
    gravity : float
        Acceleration along -y, m/s^2.
    springs, loads, clearances : tuple
    """

    kind: ClassVar[str] = "linkage"
    loose: ClassVar[tuple[str, ...]] = ()

    bodies: Sequence[Body]
    joints: Sequence[Pin | Revolute | Guide] = ()
    drives: Sequence[Drive] = ()
    watch: Probe | str = ""
    guess: Mapping[str, float] | tuple[tuple[str, float], ...] = ()
    cycle: float | None = quantity(None, "s", *CYCLE, "", "time after which the motion repeats")
    run_up: int = run_up()
    name: str = "linkage"
    gravity: float = gravity()
    springs: Sequence[Spring] = ()
    loads: Sequence[AnyLoad] = ()
    clearances: Sequence[ClearanceJoint] = ()

    def __post_init__(self) -> None:
        """InputError naming a body, point or joint that is none, or stands twice."""

        def put(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        check_fields(self)
        if not self.bodies:
            raise InputError("bodies: at least one is needed")
        _check_names("body", [GROUND, *(body.name for body in self.bodies)])
        put("joints", tuple(self._joined(joint) for joint in self.joints))
        _check_names("joint", ["none", *(own.name for own in (*self.joints, *self.clearances))])
        for one, other in permutations(self.joints, 2):
            if other.name.startswith(f"{one.name}_"):
                raise InputError(
                    f"name of a joint = {other.name!r}: must not begin with {one.name}_, "
                    f"because {one.name} is a joint too"
                )
        _check_names("spring", [spring.name for spring in self.springs])
        _check_names("drive of", [drive.body for drive in self.drives])
        if isinstance(self.watch, str):
            end = self.point(self.watch or self.bodies[-1].name, "watch")
            put("watch", self.watching(end))
        put("loads", tuple(self._loaded(load) for load in self.loads))
        put("springs", tuple(self._hung(spring) for spring in self.springs))
        put("drives", tuple(self._following(drive) for drive in self.drives))
        put("guess", tuple(dict(self.guess).items()))
        for where, name in (
            *(("drives", drive.body) for drive in self.drives),
            *(("guess", name) for name in dict(self.guess)),
            ("watch", self.probe.body),
        ):
            self._check_body(name, where)
        self._check_inertia()

    def _check_inertia(self) -> None:
        """Raise InputError for a body that can turn and has no inertia."""
        held = {guide.body for guide in self.guides}
        held |= {drive.body for drive in self.drives if drive.speed == 0.0 and not drive.repeats}
        for body in self.bodies:
            if body.inertia < LEAST_INERTIA and not (body.inertia == 0.0 and body.name in held):
                raise InputError(
                    f"inertia of {body.name} = {body.inertia:g} kg m^2: must be "
                    f"{LEAST_INERTIA:g} kg m^2 or more; 0 is allowed for a body that a guide, or "
                    "a drive at rest, keeps from turning"
                )

    def _check_body(self, name: str, where: str) -> None:
        names = [body.name for body in self.bodies]
        if name not in names:
            raise unknown(f"body in {where}", name, names)

    def _joined(self, joint: Any) -> Revolute | Guide:
        """A joint with its points found."""
        if isinstance(joint, Guide):
            self._check_body(joint.body, f"guide {joint.name}")
            return joint
        ends = (self.point(end, f"joint {joint.name}") for end in (joint.first, joint.second))
        return Revolute(joint.name, *ends)

    def _loaded(self, load: AnyLoad) -> AnyLoad:
        """A load with its point found."""
        self._check_body(load.body, "loads")
        law = None if isinstance(load, Load) else load.law
        if isinstance(law, OverTime) and law.period is None:
            law.check("cycle", self.period)
        if not isinstance(load, Force):
            return load
        return replace(load, point=self.point(load.point, "loads"))

    def _hung(self, spring: Spring) -> Spring:
        """A spring with its points found."""
        where = f"spring {spring.name}"
        first, second = self.point(spring.first, where), self.point(spring.second, where)
        return replace(spring, first=first, second=second)

    def _following(self, drive: Drive) -> Drive:
        """A drive with the point found that follows its curve, if there is one."""
        follow = drive.follow
        if follow is None or isinstance(follow.point, Probe):
            return drive
        end = self.point(follow.point, f"follow of {drive.body}")
        self._check_body(end.body, f"follow of {drive.body}")
        probe = self.watching(end, follow.direction)
        return replace(drive, follow=replace(follow, point=probe, direction=probe.direction))

    def point(self, end: End, where: str) -> Attachment:
        """A point that is given in any way; InputError names it and where it stands."""
        if isinstance(end, str):
            body, dot, name = end.partition(".")
            name = name if dot else "centre"
            self._check_body(body, where)
            points = dict(self.bodies[self.index(body)].points) | {"centre": (0.0, 0.0)}
            if name not in points:
                raise unknown(f"point of {body} in {where}", name, points)
            return Attachment(body, *points[name])
        if isinstance(end, Attachment):
            if end.body != GROUND:
                self._check_body(end.body, where)
            return end
        try:
            return Attachment(GROUND, *end)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None

    def watching(self, end: Attachment, direction: float | None = None) -> Probe:
        """A point as what is watched: along its body's guide, where it has one, else along x."""
        if direction is None:
            along = (guide.direction for guide in self.guides if guide.body == end.body)
            direction = next(along, 0.0)
        return Probe(end.body, direction, end.x, end.y)

    @property
    def probe(self) -> Probe:
        """What is watched."""
        assert isinstance(self.watch, Probe), "a text is replaced at the start"
        return self.watch

    @property
    def revolutes(self) -> tuple[Revolute, ...]:
        """The ideal pin joints."""
        return tuple(joint for joint in self.joints if isinstance(joint, Revolute))

    @property
    def guides(self) -> tuple[Guide, ...]:
        """The guides."""
        return tuple(joint for joint in self.joints if isinstance(joint, Guide))

    @property
    def dead_loads(self) -> tuple[Load, ...]:
        """The loads that are constant."""
        return tuple(load for load in self.loads if isinstance(load, Load))

    @property
    def live_loads(self) -> tuple[Force | Moment, ...]:
        """The loads with a law of their own."""
        return tuple(load for load in self.loads if not isinstance(load, Load))

    @property
    def openable(self) -> tuple[str, ...]:
        """Names of the joints that may have clearance."""
        return tuple(joint.name for joint in self.revolutes)

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""
        return "Dimensions and masses are the user's own."

    def linkage(self) -> "Linkage":
        """The linkage, as any mechanism gives its own."""
        return self

    @property
    def period(self) -> float:
        """Time of one cycle, s: the shortest in which every drive makes whole turns."""
        found = self._common if self.cycle is None else self.cycle
        told = f"cycle of {self.name}, in which all drives make whole turns,"
        Quantity("s", *CYCLE, "", "").check(told, found)
        for drive in self.drives:
            for speed in drive.frequencies:
                turns = speed * found / (2.0 * math.pi)
                if turns > MOST_TURNS:
                    raise InputError(
                        f"{told} = {found:g} s: {drive.name} turns {turns:.6g} times in it, with "
                        f"{speed:g} rad/s; allowed are {MOST_TURNS} times at most"
                    )
        return found

    @property
    def _common(self) -> float:
        """The shortest time in which every drive makes whole turns, s."""
        speeds = [speed for drive in self.drives for speed in drive.frequencies]
        if not speeds:
            raise InputError(f"cycle of {self.name}: no drive turns, so that it has to be given, s")
        turns = 1
        for speed in speeds:
            ratio = Fraction(speed / speeds[0]).limit_denominator(COMMON_TURNS)
            if abs(float(ratio) * speeds[0] / speed - 1.0) > 1e-9:
                raise InputError(
                    f"cycle of {self.name}: speeds of {speeds[0]:g} and {speed:g} rad/s have no "
                    f"common cycle of {COMMON_TURNS} turns or less; it has to be given, s"
                )
            turns = math.lcm(turns, ratio.denominator)
        return 2.0 * math.pi * turns / speeds[0]

    @property
    def phase(self) -> str:
        """Name of the angle that goes through a whole turn in a cycle."""
        turn = 2.0 * math.pi / self.period
        cranks = [d for d in self.drives if not d.repeats and abs(abs(d.speed) / turn - 1.0) < 1e-9]
        return "crank angle" if cranks else "phase of the cycle"

    @property
    def run_up_time(self) -> float:
        """Time in which it runs up, s."""
        return 2.0 * self.run_up * self.period if self.run_up else 0.0

    def index(self, body: str) -> int:
        """Position of a body in ``bodies``."""
        for position, candidate in enumerate(self.bodies):
            if candidate.name == body:
                return position
        raise KeyError(f"no body {body!r} in linkage {self.name!r}")

    def as_plain(self) -> dict[str, Any]:
        """Return the linkage as plain data."""
        from presswear.linkage.written import written

        return {"kind": self.kind, **written(self)}

    def opened(self, joints: tuple[ClearanceJoint, ...]) -> "Linkage":
        """The same linkage with clearance joints in place of revolutes of the same name."""
        names = {joint.name for joint in joints}
        kept = tuple(joint for joint in self.joints if joint.name not in names)
        return replace(self, joints=kept, clearances=(*self.clearances, *joints))


def _check_names(what: str, names: Sequence[str]) -> None:
    """InputError where a name stands twice, or holds what points, lists and files are told by."""
    for name in names:
        if not name.isprintable() or name != name.strip() or not name or set(name) & _SIGNS:
            signs = " ".join(sorted(_SIGNS))
            raise InputError(f"name of a {what} = {name!r}: a text without {signs} is expected")
        if list(names).count(name) > 1:
            raise InputError(f"{what} {name}: the name stands twice")


_SIGNS = set(".,:;=/\\'\"")
