"""A planar linkage as data, how it is assembled from its parts, and its topology.

One description serves every engine. Coordinates of body ``i`` are the position of its mass centre
and its angle, ``q[3 i : 3 i + 3] = x, y, theta``, in the order of ``Linkage.bodies``. The frame is
the name ``GROUND``; points on it are global.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from itertools import permutations
from typing import Annotated, Any, ClassVar, NamedTuple, cast

from presswear.linkage.drives import Drive
from presswear.linkage.elements import (
    ANGLE,
    BAR_LENGTH,
    GROUND,
    MIN_INERTIA,
    Attachment,
    Bar,
    Body,
    ClearanceJoint,
    End,
    Guide,
    OutputPoint,
    Pin,
    Place,
    Revolute,
)
from presswear.linkage.loads import AnyLoad, Force, Load, Moment, OverTime, Spring
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, count, meaning_of, quantity
from presswear.tools.serialize import converted, make, plain, to_toml, toml_items

MIN_CYCLE, MAX_CYCLE = 1e-5, 1e3  # s: a pin at rest in its bearing takes some 1e4 steps a second
MAX_TURNS = 1000  # of a drive in a cycle
MAX_COMMON_TURNS = 64  # of a drive in the longest cycle that is found
_SIGNS = set(".,:;=/\\'\"")  # by which points, lists and files are separated
_TABLES = ("bodies", "joints", "drives", "springs", "loads")

Joint = Revolute | Guide


def run_up() -> Any:
    """Return a data class field for the cycles of a run-up."""
    return count(0, 0, 1000, "chosen", "cycles through which it runs up from rest")


def gravity() -> Any:
    """Return a data class field for the acceleration along -y, m/s^2."""
    return quantity(9.81, "m/s^2", -100.0, 100.0, "assumed", "acceleration along -y")


@dataclass(frozen=True)
class Linkage:
    """Planar mechanism, driven, with or without clearance joints; see ``assemble``.

    Attributes
    ----------
    bodies : tuple of Body
    joints : tuple of Revolute or Guide
        Ideal joints.
    drives : tuple of Drive
    output : OutputPoint
        Recorded as ``slider``.
    guess : tuple of (str, float)
        Rough angles at the start, rad, of bodies that are neither driven nor guided.
    cycle : float or None
        Time after which the motion repeats, s; None: from the speeds of the drives.
    run_up : int
        Cycles through which it runs up from rest, all drives in step, in the time of twice as
        many; 0: it starts at speed.
    gravity : float
        Acceleration along -y, m/s^2.
    springs, loads, clearances : tuple
    """

    kind: ClassVar[str] = "linkage"
    loose: ClassVar[tuple[str, ...]] = ()

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    drives: tuple[Drive, ...]
    output: OutputPoint
    guess: tuple[tuple[str, float], ...] = ()
    cycle: float | None = quantity(
        None, "s", MIN_CYCLE, MAX_CYCLE, "", "time after which the motion repeats"
    )
    run_up: int = run_up()
    name: str = "linkage"
    gravity: float = gravity()
    springs: tuple[Spring, ...] = ()
    loads: tuple[AnyLoad, ...] = ()
    clearances: tuple[ClearanceJoint, ...] = ()

    def changed(self, **changes: Any) -> "Linkage":
        """Return the linkage assembled again with arguments of ``assemble`` changed."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return assemble(**{**values, **changes})

    @property
    def revolutes(self) -> tuple[Revolute, ...]:
        """Ideal pin joints."""
        return tuple(joint for joint in self.joints if isinstance(joint, Revolute))

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
    def openable(self) -> tuple[str, ...]:
        """Names of the joints that may have clearance."""
        return tuple(joint.name for joint in self.revolutes)

    @property
    def origin(self) -> str:
        """Origin of its values, in a sentence."""
        return "Dimensions and masses are the user's."

    def linkage(self) -> "Linkage":
        """Return the linkage itself, as any mechanism returns its linkage."""
        return self

    @property
    def period(self) -> float:
        """Time of one cycle, s: the shortest in which every drive makes whole turns."""
        period = self._common_period if self.cycle is None else self.cycle
        label = f"cycle of {self.name}, in which all drives make whole turns,"
        Quantity("s", MIN_CYCLE, MAX_CYCLE).check(label, period)
        for drive in self.drives:
            for speed in drive.frequencies:
                turns = speed * period / (2.0 * math.pi)
                if turns > MAX_TURNS:
                    raise InputError(
                        f"{label} = {period:g} s: {drive.name} turns {turns:.6g} times in it, "
                        f"with {speed:g} rad/s; allowed are {MAX_TURNS} times at most"
                    )
        return period

    @property
    def _common_period(self) -> float:
        speeds = [speed for drive in self.drives for speed in drive.frequencies]
        if not speeds:
            raise InputError(f"cycle of {self.name}: no drive turns, so that it is needed, s")
        turns = 1
        for speed in speeds:
            ratio = Fraction(speed / speeds[0]).limit_denominator(MAX_COMMON_TURNS)
            if abs(float(ratio) * speeds[0] / speed - 1.0) > 1e-9:
                raise InputError(
                    f"cycle of {self.name}: speeds of {speeds[0]:g} and {speed:g} rad/s have no "
                    f"common cycle of {MAX_COMMON_TURNS} turns or less, so that it is needed, s"
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
        """Return the position of a body in ``bodies``."""
        for position, candidate in enumerate(self.bodies):
            if candidate.name == body:
                return position
        raise KeyError(f"no body {body!r} in linkage {self.name!r}")

    def opened(self, joints: tuple[ClearanceJoint, ...]) -> "Linkage":
        """Return the linkage with clearance joints in place of revolutes of the same name."""
        names = {joint.name for joint in joints}
        rest = tuple(joint for joint in self.joints if joint.name not in names)
        return replace(self, joints=rest, clearances=(*self.clearances, *joints))

    def as_plain(self) -> dict[str, Any]:
        """Return the arguments of ``assemble`` as plain data, without clearance joints."""
        data: dict[str, Any] = plain(self._described())
        return {"kind": self.kind, **data}

    def _described(self) -> dict[str, Any]:
        """Return the arguments of ``assemble``, points as text where they have a name."""

        def end(at: Attachment) -> Any:
            if at.body == GROUND:
                return at.x, at.y
            points = {"centre": (0.0, 0.0)} | dict(self.bodies[self.index(at.body)].points)
            names = [name for name, place in points.items() if place == (at.x, at.y)]
            return f"{at.body}.{names[0]}" if names else at

        def joint(one: Joint) -> Any:
            return one if isinstance(one, Guide) else Pin(one.name, end(one.first), end(one.second))

        def drive(one: Drive) -> Drive:
            if one.follow is None or not isinstance(one.follow.point, OutputPoint):
                return one
            return replace(one, follow=replace(one.follow, point=end(one.follow.point.attachment)))

        def load(one: AnyLoad) -> AnyLoad:
            is_force = isinstance(one, Force) and isinstance(one.point, Attachment)
            return replace(one, point=end(cast(Any, one).point)) if is_force else one

        def spring(one: Spring) -> Spring:
            first, second = map(end, one.ends)
            return replace(one, first=first, second=second)

        return {
            "name": self.name,
            "output": end(self.output.attachment),
            "direction": self.output.direction,
            "guess": dict(self.guess),
            "cycle": self.cycle,
            "run_up": self.run_up,
            "gravity": self.gravity,
            "bodies": list(self.bodies),
            "joints": list(map(joint, self.joints)),
            "drives": list(map(drive, self.drives)),
            "springs": list(map(spring, self.springs)),
            "loads": list(map(load, self.loads)),
        }


def assemble(
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
    """Return a linkage, its points found by name and its parts checked together.

    Points are ``body.point``, ``body`` for its mass centre, or coordinates on the frame. Every part
    may be given as plain data, too.

    Parameters
    ----------
    bodies : sequence of Body
    joints : sequence of Pin, Revolute or Guide
    drives : sequence of Drive
    output : str, tuple, Attachment or OutputPoint
        Output point; default: the mass centre of the last body.
    guess : mapping of str to float
        Rough angles at the start, rad, of bodies that are neither driven nor guided, which tell
        the two ways apart in which a loop closes.
    cycle : float, str or None
        Time after which the motion repeats, s; None: the shortest in which every drive makes whole
        turns.
    run_up : int
        Cycles through which it runs up from rest; 0: it starts at speed.
    gravity : float or str
        Acceleration along -y, m/s^2.
    springs : sequence of Spring
    loads : sequence of Load, Force or Moment
    clearances : sequence of ClearanceJoint
    direction : float, str or None
        Direction along which the output point is observed, rad; None: along the guide of its body,
        or else x.

    Returns
    -------
    Linkage

    Raises
    ------
    InputError
        With the body, point, joint or value that does not fit.
    """
    text = converted("name", name, str)
    parts = _Points(tuple(_body(f"bodies[{k}]", body) for k, body in enumerate(bodies)))
    if not parts.bodies:
        raise InputError("bodies: at least one is needed")
    pairs = [
        parts.joint(joint)
        for joint in converted("joints", joints, Sequence[Pin | Revolute | Guide])
    ]
    guides = {joint.body: joint.direction for joint in pairs if isinstance(joint, Guide)}
    if not isinstance(output, OutputPoint):
        end = converted("output", output or parts.bodies[-1].name, End)
        output = _output_point(parts.point(end, "output"), guides, direction)
    angles = converted("guess", dict(guess), Mapping[str, Annotated[float, ANGLE]])
    scalars = {"cycle": cycle, "run_up": run_up, "gravity": gravity}
    linkage = Linkage(
        parts.bodies,
        tuple(pairs),
        tuple(parts.drive(one, guides) for one in converted("drives", drives, Sequence[Drive])),
        output,
        tuple(angles.items()),
        name=text,
        springs=tuple(map(parts.spring, converted("springs", springs, Sequence[Spring]))),
        loads=tuple(map(parts.load, converted("loads", loads, Sequence[Load | Force | Moment]))),
        clearances=tuple(clearances),
        **{
            key: cast(Quantity, _MEANINGS[key]).convert(key, value)
            for key, value in scalars.items()
            if value is not None
        },
    )
    _check(linkage)
    return linkage


_MEANINGS = {item.name: meaning_of(item) for item in fields(Linkage)}


def _body(place: str, value: Any) -> Body:
    if isinstance(value, Mapping):
        return make(place, Bar if "length" in value else Body, value)
    body: Body = converted(place, value, Body)
    return body


def _output_point(
    end: Attachment, guides: Mapping[str, float], direction: Any = None
) -> OutputPoint:
    """Return a point with a direction: along the guide of its body, where it has one, else x."""
    if direction is None:
        direction = guides.get(end.body, 0.0)
    return OutputPoint(end.body, direction, end.x, end.y)


class _Points(NamedTuple):
    """Bodies of a linkage whose points are found by name."""

    bodies: tuple[Body, ...]

    def check_body(self, name: str, where: str) -> None:
        names = [body.name for body in self.bodies]
        if name not in names:
            raise unknown(f"body in {where}", name, names)

    def point(self, end: End, where: str) -> Attachment:
        if isinstance(end, str):
            name, dot, point = end.partition(".")
            point = point if dot else "centre"
            self.check_body(name, where)
            body = next(body for body in self.bodies if body.name == name)
            points = dict(body.points) | {"centre": (0.0, 0.0)}
            if point not in points:
                raise unknown(f"point of {name} in {where}", point, points)
            return Attachment(name, *points[point])
        if isinstance(end, Attachment):
            if end.body != GROUND:
                self.check_body(end.body, where)
            return end
        return Attachment(GROUND, *end)

    def joint(self, joint: Pin | Revolute | Guide) -> Joint:
        if isinstance(joint, Guide):
            self.check_body(joint.body, f"guide {joint.name}")
            return joint
        ends = (self.point(end, f"joint {joint.name}") for end in (joint.first, joint.second))
        return Revolute(joint.name, *ends)

    def load(self, load: AnyLoad) -> AnyLoad:
        self.check_body(load.body, "loads")
        return (
            replace(load, point=self.point(load.point, "loads"))
            if isinstance(load, Force)
            else load
        )

    def spring(self, spring: Spring) -> Spring:
        where = f"spring {spring.name}"
        ends = [self.point(end, where) for end in (spring.first, spring.second)]
        return replace(spring, first=ends[0], second=ends[1])

    def drive(self, drive: Drive, guides: Mapping[str, float]) -> Drive:
        """Return a drive with the point found that follows its curve, if there is one."""
        follow = drive.follow
        if follow is None or isinstance(follow.point, OutputPoint):
            return drive
        end = self.point(follow.point, f"follow of {drive.body}")
        self.check_body(end.body, f"follow of {drive.body}")
        point = _output_point(end, guides, follow.direction)
        return replace(drive, follow=replace(follow, point=point, direction=point.direction))


def _check(linkage: Linkage) -> None:
    """Raise InputError for names that stand twice, unknown bodies, and bodies without inertia."""
    names = [GROUND, *(body.name for body in linkage.bodies)]
    _check_names("body", names)
    joints = [joint.name for joint in (*linkage.joints, *linkage.clearances)]
    _check_names("joint", ["none", *joints])
    for one, longer in permutations(joints, 2):
        if longer.startswith(f"{one}_"):
            raise InputError(
                f"name of a joint = {longer!r}: must not begin with {one}_, because {one} is a "
                "joint too"
            )
    _check_names("spring", [spring.name for spring in linkage.springs])
    _check_names("drive of", [drive.body for drive in linkage.drives])
    for where, name in (
        *(("drives", drive.body) for drive in linkage.drives),
        *(("guess", name) for name, _ in linkage.guess),
        ("output", linkage.output.body),
    ):
        if name not in names[1:]:
            raise unknown(f"body in {where}", name, names[1:])
    for load in linkage.live_loads:
        if isinstance(load.law, OverTime) and load.law.period is None:
            load.law.check_period("cycle", linkage.period)
    fixed = {guide.body for guide in linkage.guides}
    fixed |= {drive.body for drive in linkage.drives if drive.speed == 0.0 and not drive.repeats}
    for body in linkage.bodies:
        if body.inertia < MIN_INERTIA and not (body.inertia == 0.0 and body.name in fixed):
            raise InputError(
                f"inertia of {body.name} = {body.inertia:g} kg m^2: must be {MIN_INERTIA:g} kg m^2 "
                "or more; 0 is allowed for a body that a guide, or a drive at rest, keeps from "
                "turning"
            )


def _check_names(what: str, names: Sequence[str]) -> None:
    for name in names:
        if not name.isprintable() or name != name.strip() or not name or set(name) & _SIGNS:
            signs = " ".join(sorted(_SIGNS))
            raise InputError(f"name of a {what} = {name!r}: a text without {signs} is expected")
        if list(names).count(name) > 1:
            raise InputError(f"{what} {name}: the name stands twice")


def linkage_from(data: Mapping[str, Any], place: str) -> Linkage:
    """Return a linkage from the arguments of ``assemble`` as plain data; see ``as_plain``.

    Parameters
    ----------
    place : str
        Place of the data, for messages.
    """
    return make(place, assemble, {key: value for key, value in data.items() if key != "kind"})


def toml_of(linkage: Linkage) -> str:
    """Return a linkage as the tables of a TOML file, numbers with units and keys explained."""
    lines, texts = [], set[str]()
    for table, items in _rows_of(linkage):
        lines += ["", f"[[mechanism.{table}]]"] if table else ["[mechanism]"]
        for key, value, text in items:
            lines.append(f"{key} = {value}{f'  # {text}' if text and text not in texts else ''}")
            texts.add(text)
    return "\n".join(lines) + "\n"


def values_of(linkage: Linkage) -> Iterator[tuple[str, str, str]]:
    """Yield key, value with its unit, and meaning of every value of a linkage."""
    numbers: dict[str, int] = dict.fromkeys(_TABLES, 0)
    for table, items in _rows_of(linkage):
        prefix = f"{table}[{numbers[table]}]." if table else ""
        for key, value, text in items:
            yield f"{prefix}{key}", value.replace('"', ""), text
        if table:
            numbers[table] += 1


def _rows_of(linkage: Linkage) -> Iterator[tuple[str, list[tuple[str, str, str]]]]:
    """Yield each table of a linkage with its keys, values as TOML, and meanings."""
    data = linkage._described()
    yield "", list(_scalar_items(data))
    for table in _TABLES:
        for row in data[table]:
            yield table, list(_body_items(row) if isinstance(row, Body) else toml_items(row))


def _scalar_items(data: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    angles = Mapping[str, Annotated[float, ANGLE]]
    direction = Annotated[float, ANGLE]
    yield "name", to_toml(data["name"]), ""
    yield "output", to_toml(data["output"], End), ""
    yield "direction", to_toml(data["direction"], direction), "of the output point"
    if data["guess"]:
        yield "guess", to_toml(data["guess"], angles), ""
    for key in ("cycle", "run_up", "gravity"):
        meaning = cast(Quantity, _MEANINGS[key])
        if data[key] is not None:
            yield key, to_toml(data[key], Annotated[float, meaning]), meaning.text


def _body_items(body: Body) -> Iterator[tuple[str, str, str]]:
    points = dict(body.points)
    head = points.get("head", (0.0, 0.0))
    yield "name", to_toml(body.name), ""
    if list(points.items()) == [("tail", (-head[0], 0.0)), ("head", (head[0], 0.0))]:
        length = Annotated[float, BAR_LENGTH]
        yield "length", to_toml(2.0 * head[0], length), BAR_LENGTH.text
        points = {}
    for item in fields(body)[1:3]:
        meaning = cast(Quantity, meaning_of(item))
        yield item.name, to_toml(getattr(body, item.name), item.type), meaning.text
    if points:
        yield "points", to_toml(points, Mapping[str, Place]), ""


class Branch(NamedTuple):
    """Body of an open tree.

    Attributes
    ----------
    joint : Revolute, Guide or None
        Joint to the parent; None for a body that no ideal joint holds.
    before, end : Attachment
        End of the joint on the parent, and on the body itself.
    parent : int
        Position of the parent in the tree; -1 for the frame or a body with prescribed motion.
    """

    joint: Joint | None
    before: Attachment
    end: Attachment
    parent: int


def _ends(joint: Joint) -> tuple[Attachment, Attachment]:
    """Return the two points that a joint holds together; of a guide a point and the mass centre."""
    if isinstance(joint, Guide):
        return Attachment(GROUND, joint.x, joint.y), Attachment(joint.body, 0.0, 0.0)
    return joint.first, joint.second


def joints_of(linkage: Linkage) -> tuple[Joint, ...]:
    """Return the ideal joints: pins, then guides."""
    return (*linkage.revolutes, *linkage.guides)


def bodies_of(joint: Joint) -> set[str]:
    """Return the bodies that a joint holds, without the frame."""
    return {end.body for end in _ends(joint)} - {GROUND}


def prescribed_of(linkage: Linkage) -> frozenset[str]:
    """Return the bodies whose motion ideal joints, guides and drives prescribe fully.

    The largest set with as many rows of constraints inside it as coordinates. Each row is assigned
    to one of its bodies, which has room for three. A body with room left can move, and so can one
    that could pass a row on to it; all others are prescribed. The rows of a linkage that closes
    away from its dead points are independent, so that counting them is enough.
    """
    rows = [bodies_of(joint) for joint in joints_of(linkage) for _ in range(2)]
    rows += [{drive.body} for drive in linkage.drives]
    assigned: dict[str, list[set[str]]] = {body.name: [] for body in linkage.bodies}

    def assign(row: set[str], visited: set[str]) -> bool:
        """Find room for a row, passing others on where need be."""
        for name in sorted(row - visited):
            visited.add(name)
            if len(assigned[name]) < 3:
                assigned[name].append(row)
                return True
            for held in assigned[name]:
                if assign(held, visited):
                    # By position: equal rows are interchangeable.
                    assigned[name][assigned[name].index(held)] = row
                    return True
        return False

    for row in rows:
        assign(row, set())
    free = {name for name, held in assigned.items() if len(held) < 3}
    while True:
        more = {name for name, held in assigned.items() if any(row & free for row in held)} - free
        if not more:
            return frozenset(assigned.keys() - free)
        free |= more


class _Tree:
    """Tree of bodies that grows joint by joint.

    Attributes
    ----------
    waiting : list of Revolute or Guide
        Joints that do not touch the tree so far.
    closing : list of Revolute or Guide
        Joints between two bodies of the tree.
    positions : dict of str to int
        Positions of bodies in ``branches``; -1 for the roots.
    """

    def __init__(self, joints: Sequence[Joint], roots: Sequence[str]) -> None:
        self.waiting, self.closing = list(joints), list[Joint]()
        self.positions = dict.fromkeys(roots, -1)
        self.branches: list[Branch] = []

    def add(self, joint: Joint | None, before: Attachment, end: Attachment) -> None:
        self.branches.append(Branch(joint, before, end, self.positions[before.body]))
        self.positions[end.body] = len(self.branches) - 1

    def grow(self) -> None:
        """Add all bodies that joints reach, parents before children."""
        while True:
            for joint in self.waiting:
                before, end = _ends(joint)
                if before.body not in self.positions:
                    before, end = end, before
                if before.body in self.positions:
                    break
            else:
                return
            self.waiting.remove(joint)
            if end.body in self.positions:
                self.closing.append(joint)
            else:
                self.add(joint, before, end)


def branches_of(linkage: Linkage) -> tuple[Branch, ...] | str:
    """Return the free bodies as an open tree, parents before children, or why there is none.

    Where clearance joints cut every loop that has a freedom, the rest hangs from the frame, from
    bodies with prescribed motion, or from nothing.
    """
    prescribed = prescribed_of(linkage)
    for drive in linkage.drives:
        if drive.body not in prescribed:
            return f"{drive.name} turns a body that is free to move"
    if len(prescribed) == len(linkage.bodies):
        return "the drives hold every body"
    joints = [joint for joint in joints_of(linkage) if not bodies_of(joint) <= prescribed]
    tree = _Tree(joints, (GROUND, *prescribed))
    tree.grow()
    for body in linkage.bodies:
        if body.name not in tree.positions:
            tree.add(None, Attachment(GROUND, 0.0, 0.0), Attachment(body.name, 0.0, 0.0))
            tree.grow()
    if tree.closing:
        return f"joint {tree.closing[0].name} closes a loop"
    return tuple(tree.branches)


def chain_of(linkage: Linkage, bodies: frozenset[str]) -> tuple[list[Branch], list[Revolute]]:
    """Return bodies with prescribed motion as a tree, and the pins that close it.

    ValueError where they are no such chain.
    """
    # Guides first: what slides does so by its coordinate, and pins close the loops.
    joints: tuple[Joint, ...] = (*linkage.guides, *linkage.revolutes)
    tree = _Tree([joint for joint in joints if bodies_of(joint) <= bodies], (GROUND,))
    tree.grow()
    pins = [joint for joint in tree.closing if isinstance(joint, Revolute)]
    drives = [drive for drive in linkage.drives if drive.body in bodies]
    rows = 2 * len(tree.branches) + 2 * len(pins) + len(drives)
    if tree.waiting or len(pins) < len(tree.closing) or rows != 3 * len(bodies):
        raise ValueError(f"{', '.join(sorted(bodies))} are no chain without freedom")
    return tree.branches, pins
