"""Bodies of an open tree in the order in which their motion follows from that before."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from presswear.linkage.elements import GROUND, Attachment, Body, Guide
from presswear.linkage.linkage import Linkage
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
    prefix: str
    joint: str  # prefix of the joint that it hangs from
    place: int  # index of its x in q; below zero for the frame
    branch: Branch
    parent: "Link | None"  # body that it hangs from; None for a body that nothing holds
    drive: int | None = None
    is_prescribed: bool = True  # drives prescribe its whole motion
    coordinate: int = 0  # place of its first coordinate among those of the tree
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

    @property
    def is_loose(self) -> bool:
        """True if no ideal joint holds it."""
        return self.branch.joint is None

    @property
    def is_guided(self) -> bool:
        """True if it slides along a guide."""
        return isinstance(self.branch.joint, Guide)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return (
            0
            if self.is_prescribed
            else (3 if self.is_loose else 1) - (self.drive is not None)
        )

    def arm(self, text: Text, point: Attachment, name: str) -> Vector:
        """Return the vector from the mass centre to a point of the body, in global directions.

        For the frame it starts at the origin.
        """
        place = point.x, point.y
        if place not in self.arms:
            label = f"{self.prefix}_{name}"
            axes = ("xi", "eta") if self.place >= 0 else ("x", "y")
            xi = text.parameter(f"{label}_{axes[0]}", point.x)
            eta = text.parameter(f"{label}_{axes[1]}", point.y)
            along = difference(product(self.axis.x, xi), product(self.axis.y, eta))
            across = total(product(self.axis.y, xi), product(self.axis.x, eta))
            self.arms[place] = text.let_vector(f"{label}_arm", Vector(along, across))
        return self.arms[place]

    def velocity_at(self, arm: Vector) -> Vector:
        """Return the velocity of the end of an arm."""
        return self.velocity.plus(arm.swept(self.omega))

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
    has_loops: bool  # drives prescribe bodies in closed loops

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
        x, u = np.zeros((2, self.size))
        for link in self.free:
            place, first = link.place, link.coordinate
            if isinstance(link.branch.joint, Guide):
                direction = link.branch.joint.direction
                along = np.array([math.cos(direction), math.sin(direction)])
                x[first] = along @ (
                    q[place : place + 2] - [link.branch.before.x, link.branch.before.y]
                )
                u[first] = along @ v[place : place + 2]
                continue
            if link.is_loose:
                x[first : first + 2], u[first : first + 2] = (
                    q[place : place + 2],
                    v[place : place + 2],
                )
                first += 2
            if link.drive is None:
                x[first], u[first] = q[place + 2], v[place + 2]
                if link.parent is not None and not link.parent.is_prescribed:
                    x[first] -= q[link.parent.place + 2]
                    u[first] -= v[link.parent.place + 2]
        return x, u

    def way(
        self, text: Text, ends: tuple[Attachment, Attachment], prefix: str
    ) -> tuple[Vector, Vector]:
        """Write the way from one point of a body to another, m, and its rate, m/s."""
        first, second = (self.of(end.body) for end in ends)
        first_arm = first.arm(text, ends[0], prefix)
        second_arm = second.arm(text, ends[1], prefix)
        way = second.position.plus(second_arm).minus(first.position.plus(first_arm))
        rate = second.velocity_at(second_arm).minus(first.velocity_at(first_arm))
        way = text.let_vector(f"{prefix}_way", way)
        return way, text.let_vector(f"{prefix}_way_rate", rate)

    def of(self, body: str) -> Link:
        """Return a body, or the frame, by its name."""
        return next((link for link in self.links if link.body.name == body), self.frame)


def open_chain(linkage: Linkage, text: Text) -> Chain | str:
    """Return the open tree of a linkage with names for a text, or why it has none."""
    branches = free_branches(linkage)
    if isinstance(branches, str):
        return branches
    prescribed, pins = chain_of(linkage, prescribed_of(linkage))
    centre = Attachment(GROUND, 0.0, 0.0)
    frame = Link(
        Body(GROUND, 1.0), "frame", "", -1, Branch(None, centre, centre, -1), None
    )
    links = [*_links(linkage, prescribed, text, frame)]
    links += _links(linkage, branches, text, frame, links)
    place = 0
    for link in links[len(prescribed) :]:
        link.is_prescribed, link.coordinate = False, place
        place += link.size
    return Chain(linkage, frame, tuple(links), bool(pins))


def loose_chain(linkage: Linkage, text: Text) -> Chain:
    """Return all bodies in their order, as if no ideal joint and no drive held them."""
    centre = Attachment(GROUND, 0.0, 0.0)
    frame = Link(
        Body(GROUND, 1.0), "frame", "", -1, Branch(None, centre, centre, -1), None
    )
    links = [
        Link(
            body,
            text.prefix(body.name),
            joint="",
            place=3 * k,
            branch=Branch(None, centre, Attachment(body.name, 0.0, 0.0), -1),
            parent=None,
            is_prescribed=False,
            coordinate=3 * k,
        )
        for k, body in enumerate(linkage.bodies)
    ]
    return Chain(linkage, frame, tuple(links), has_loops=False)


def _links(
    linkage: Linkage,
    branches: Sequence[Branch],
    text: Text,
    frame: Link,
    before: Sequence[Link] = (),
) -> list[Link]:
    """Return the bodies of a tree that hangs from the frame and from other bodies."""
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
        parent = links[branch.before.body] if branch.joint else None
        names = (
            text.prefix(name),
            text.prefix(branch.joint.name) if branch.joint else "",
        )
        drive, body = drives.get(name), linkage.bodies[number]
        links[name] = Link(body, *names, 3 * number, branch, parent, drive)
        new_links.append(links[name])
    return new_links
