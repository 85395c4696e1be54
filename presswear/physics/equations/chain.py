"""Bodies of an open tree, each after the body from whose motion its motion follows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from presswear.linkage.bodies import Body
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.topology import Branch, chain_of, free_branches, prescribed_of
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Text,
    Vector,
    difference,
    product,
    total,
)
from presswear.tools.arrays import Array


@dataclass
class Link:
    """Body of an open tree, or the frame, with the names of its variables in a text."""

    body: Body
    prefix: str  # prefix of the variables of the body
    joint: str  # prefix of the joint to the parent
    index: int  # index of the x of the body in q; below zero for the frame
    branch: Branch
    parent: "Link | None"  # None for a body that no ideal joint holds
    drive: int | None = None  # number of the drive that prescribes its angle
    is_prescribed: bool = True  # drives prescribe its whole motion
    coordinate: int = 0  # index of its first coordinate among those of the tree
    position: Vector = Vector()
    velocity: Vector = Vector()
    acceleration: Vector = Vector()
    angle: str = ZERO
    omega: str = ZERO
    alpha: str = ZERO
    axis: Vector = Vector(ONE, ZERO)  # its x axis
    forces: list[Vector] = field(default_factory=list)
    moments: list[str] = field(default_factory=list)  # about the mass centre
    arms: dict[tuple[float, float], Vector] = field(default_factory=dict)
    guide: Vector = Vector()  # direction of its guide
    speed: str = ZERO  # along a guide on the frame, or along that of its drive
    acceleration_along: str = ZERO  # the same, if a drive prescribes it
    # from the mass centre of the parent, on a moving guide
    from_parent: Vector = Vector()

    @property
    def is_loose(self) -> bool:
        """True if no ideal joint holds it."""
        return self.branch.joint is None

    @property
    def is_guided(self) -> bool:
        """True if it slides along a guide."""
        return isinstance(self.branch.joint, Guide)

    @property
    def is_on_moving_guide(self) -> bool:
        """True if it slides along a guide on another body."""
        return self.is_guided and self.parent is not None and self.parent.index >= 0

    @property
    def size(self) -> int:
        """Number of coordinates."""
        if self.is_prescribed:
            return 0
        size = 3 if self.is_loose else 1
        return size if self.drive is None else size - 1

    def arm(self, text: Text, point: Attachment, name: str) -> Vector:
        """Return the vector from the mass centre to a point of the body, in global directions.

        For the frame it starts at the origin.
        """
        key = point.x, point.y
        if key not in self.arms:
            label = f"{self.prefix}_{name}"
            names = ("xi", "eta") if self.index >= 0 else ("x", "y")
            xi = text.parameter(f"{label}_{names[0]}", point.x)
            eta = text.parameter(f"{label}_{names[1]}", point.y)
            x = difference(product(self.axis.x, xi), product(self.axis.y, eta))
            y = total(product(self.axis.y, xi), product(self.axis.x, eta))
            self.arms[key] = text.let_vector(f"{label}_arm", Vector(x, y))
        return self.arms[key]

    def velocity_at(self, arm: Vector) -> Vector:
        """Return the velocity of the end of an arm."""
        return self.velocity.plus(arm.rotated_at(self.omega))

    def add_force(self, arm: Vector, force: Vector) -> None:
        """Add a force at the end of an arm to those on the body."""
        self.forces.append(force)
        self.moments.append(arm.cross(force))


@dataclass(frozen=True)
class Chain:
    """Open tree of a linkage: prescribed bodies first, parents before children."""

    linkage: Linkage
    frame: Link
    links: tuple[Link, ...]
    # The prescribed bodies form closed loops, or slide on each other: kernels place them.
    has_loops: bool

    @property
    def prescribed(self) -> tuple[Link, ...]:
        """Bodies whose whole motion drives prescribe."""
        return tuple(link for link in self.links if link.is_prescribed)

    @property
    def free(self) -> tuple[Link, ...]:
        """Bodies of which at least one coordinate is free."""
        return tuple(link for link in self.links if not link.is_prescribed)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(link.size for link in self.links)

    def coordinates(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Return coordinates and rates of the tree in a state of all bodies, each (size,)."""
        coordinates, rates = np.zeros((2, self.size))
        for link in self.free:
            i = link.coordinate
            xy = slice(link.index, link.index + 2)
            angle = link.index + 2
            if link.is_guided:
                coordinates[i], rates[i] = _sliding(link, q, v)
                continue
            if link.is_loose:
                coordinates[i : i + 2] = q[xy]
                rates[i : i + 2] = v[xy]
                i += 2
            if link.drive is None:
                coordinates[i] = q[angle]
                rates[i] = v[angle]
                if link.parent is not None and not link.parent.is_prescribed:
                    coordinates[i] -= q[link.parent.index + 2]
                    rates[i] -= v[link.parent.index + 2]
        return coordinates, rates

    def relative_motion(
        self, text: Text, ends: tuple[Attachment, Attachment], prefix: str
    ) -> tuple[Vector, Vector]:
        """Write position, m, and velocity, m/s, of the second end relative to the first."""
        first, second = (self.of(end.body) for end in ends)
        first_arm = first.arm(text, ends[0], prefix)
        second_arm = second.arm(text, ends[1], prefix)
        start = first.position.plus(first_arm)
        position = second.position.plus(second_arm).minus(start)
        velocity = second.velocity_at(second_arm).minus(first.velocity_at(first_arm))
        position = text.let_vector(f"{prefix}_relative_position", position)
        velocity = text.let_vector(f"{prefix}_relative_velocity", velocity)
        return position, velocity

    def of(self, body: str) -> Link:
        """Return a body, or the frame, by its name."""
        return next((link for link in self.links if link.body.name == body), self.frame)


def _sliding(link: Link, q: Array, v: Array) -> tuple[float, float]:
    """Return distance, m, and speed, m/s, of a body along its guide."""
    start, start_velocity = _point_motion(link.parent, link.branch.before, q, v)
    end, end_velocity = _point_motion(link, link.branch.end, q, v)
    direction = link.branch.slope
    if link.is_on_moving_guide:
        assert link.parent is not None
        direction += q[link.parent.index + 2]
    unit_vector = np.array([math.cos(direction), math.sin(direction)])
    # The distance is along the line: its turning does not change it.
    distance = unit_vector @ (end - start)
    return float(distance), float(unit_vector @ (end_velocity - start_velocity))


def _point_motion(
    link: Link | None, point: Attachment, q: Array, v: Array
) -> tuple[Array, Array]:
    """Return position, m, and velocity, m/s, of a point of a body or of the frame."""
    if link is None or link.index < 0:
        return np.array([point.x, point.y]), np.zeros(2)
    i = link.index
    c = math.cos(q[i + 2])
    s = math.sin(q[i + 2])
    x = c * point.x - s * point.y
    y = s * point.x + c * point.y
    velocity = v[i : i + 2] + v[i + 2] * np.array([-y, x])
    return q[i : i + 2] + np.array([x, y]), velocity


def open_chain(linkage: Linkage, text: Text) -> Chain | str:
    """Return the open tree of a linkage, or a text that says why there is none.

    The bodies get the names of their variables in ``text``.
    """
    branches = free_branches(linkage)
    if isinstance(branches, str):
        return branches
    prescribed, pins = chain_of(linkage, prescribed_of(linkage))
    frame = _frame()
    links = [*_links(linkage, prescribed, text, frame)]
    links += _links(linkage, branches, text, frame, links)
    coordinate = 0
    for link in links[len(prescribed) :]:
        link.is_prescribed = False
        link.coordinate = coordinate
        coordinate += link.size
    on_moving_guides = any(link.is_on_moving_guide for link in links[: len(prescribed)])
    return Chain(linkage, frame, tuple(links), bool(pins) or on_moving_guides)


def loose_chain(linkage: Linkage, text: Text) -> Chain:
    """Return all bodies in their order without ideal joints and drives: three coordinates each."""
    frame = _frame()
    origin = Attachment(GROUND, 0.0, 0.0)
    links = [
        Link(
            body,
            text.prefix(body.name),
            joint="",
            index=3 * k,
            branch=Branch(None, origin, Attachment(body.name, 0.0, 0.0), -1),
            parent=None,
            is_prescribed=False,
            coordinate=3 * k,
        )
        for k, body in enumerate(linkage.bodies)
    ]
    return Chain(linkage, frame, tuple(links), has_loops=False)


def _frame() -> Link:
    """Return the frame as a link, at the origin."""
    origin = Attachment(GROUND, 0.0, 0.0)
    return Link(
        Body(GROUND, 1.0),
        prefix="frame",
        joint="",
        index=-1,
        branch=Branch(None, origin, origin, -1),
        parent=None,
    )


def _links(
    linkage: Linkage,
    branches: Sequence[Branch],
    text: Text,
    frame: Link,
    before: Sequence[Link] = (),
) -> list[Link]:
    """Return the bodies of a tree whose roots are the frame and the links ``before``."""
    drives = {
        drive.body: number
        for number, drive in enumerate(linkage.drives)
        if linkage.prescribes(drive)
    }
    links = {GROUND: frame} | {link.body.name: link for link in before}
    new_links = []
    for branch in branches:
        name = branch.end.body
        number = linkage.index(name)
        links[name] = Link(
            linkage.bodies[number],
            text.prefix(name),
            joint=text.prefix(branch.joint.name) if branch.joint else "",
            index=3 * number,
            branch=branch,
            parent=links[branch.before.body] if branch.joint else None,
            drive=drives.get(name),
        )
        new_links.append(links[name])
    return new_links
