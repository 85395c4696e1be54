"""Topology of a linkage: bodies with prescribed motion, and open trees of the others."""

from collections.abc import Sequence
from typing import NamedTuple

from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import (
    Guide,
    Joint,
    Revolute,
    closing_guides,
    ends_of,
    rows_of_joints,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment


class Branch(NamedTuple):
    """Body of an open tree."""

    joint: Joint | None  # joint to the parent; None if no ideal joint holds the body
    before: Attachment  # end of the joint on the parent
    end: Attachment  # end of the joint on the body itself
    # position in the tree; -1 for the frame or a body with prescribed motion
    parent: int

    @property
    def turn(self) -> float:
        """Fixed angle of a guided body in the axes of its parent, rad."""
        assert isinstance(self.joint, Guide)
        is_slide = self.end.body == self.joint.body
        return self.joint.angle if is_slide else -self.joint.angle

    @property
    def slope(self) -> float:
        """Angle of the line of a guided body in the axes of its parent, rad."""
        assert isinstance(self.joint, Guide)
        is_slide = self.end.body == self.joint.body
        direction = self.joint.direction
        return direction if is_slide else direction - self.joint.angle


def bodies_of(joint: Joint) -> set[str]:
    """Return the bodies that a joint holds, without the frame."""
    if isinstance(joint, Guide):
        return {joint.on, joint.body} - {GROUND}
    return {joint.first.body, joint.second.body} - {GROUND}


def bodies_of_drive(linkage: Linkage, drive: Drive) -> set[str]:
    """Return the bodies whose coordinates are in the constraint equation of a drive."""
    if isinstance(drive, LinearDrive):
        return bodies_of(linkage.guide_of(drive))
    return drive.coupled_bodies


def prescribed_of(linkage: Linkage) -> frozenset[str]:
    """Return the bodies whose motion ideal joints, guides and drives prescribe fully.

    They are the largest set of bodies with as many constraint equations between them as
    coordinates. Each equation, given by the set of its bodies, is assigned to one of
    these bodies; a body can take three. A body with fewer than three can move. So can a
    body that could give one of its equations to a body that can move. All others are
    prescribed. It is sufficient to count equations, because away from dead points the
    equations of a linkage are independent.
    """
    rows = list[set[str]]()
    counts = rows_of_joints(linkage.joints)
    for joint, count in zip(linkage.joints, counts, strict=True):
        rows += [bodies_of(joint)] * count
    rows += [bodies_of_drive(linkage, drive) for drive in linkage.prescribed_drives]
    assigned: dict[str, list[set[str]]] = {body.name: [] for body in linkage.bodies}
    for row in rows:
        _assign(row, assigned, set())
    free = {name for name, body_rows in assigned.items() if len(body_rows) < 3}
    while True:
        newly_free = set[str]()
        for name, body_rows in assigned.items():
            if name not in free and any(row & free for row in body_rows):
                newly_free.add(name)
        if not newly_free:
            return frozenset(assigned.keys() - free)
        free |= newly_free


def _assign(
    row: set[str], assigned: dict[str, list[set[str]]], visited: set[str]
) -> bool:
    """Assign an equation to one of its bodies; return whether a body could take it.

    A body that has three equations gives one of them to another body if it can.
    """
    for name in sorted(row - visited):
        visited.add(name)
        if len(assigned[name]) < 3:
            assigned[name].append(row)
            return True
        for i, earlier in enumerate(assigned[name]):
            if _assign(earlier, assigned, visited):
                assigned[name][i] = row
                return True
    return False


def _tree_of(
    joints: Sequence[Joint], roots: Sequence[str], bodies: Sequence[Body] = ()
) -> tuple[list[Branch], list[Joint], list[Joint]]:
    """Return a tree that grows from roots joint by joint, parents before children.

    If no joint of the tree remains, the first of ``bodies`` that is not in it is added
    without a joint. The second list has the joints that close a loop of the tree, the
    third the joints that have no body of the tree.
    """
    branches = list[Branch]()
    closing = list[Joint]()
    remaining = list(joints)
    positions = dict.fromkeys(roots, -1)  # in ``branches``
    while True:
        joint = _first_of_tree(remaining, positions)
        if joint is not None:
            remaining.remove(joint)
            before, end = ends_of(joint)
            if before.body not in positions:
                before, end = end, before
            if end.body in positions:
                closing.append(joint)
                continue
        else:
            outside = [body.name for body in bodies if body.name not in positions]
            if not outside:
                return branches, closing, remaining
            before = Attachment(GROUND, 0.0, 0.0)
            end = Attachment(outside[0], 0.0, 0.0)
        positions[end.body] = len(branches)
        branches.append(Branch(joint, before, end, positions[before.body]))


def _first_of_tree(joints: Sequence[Joint], positions: dict[str, int]) -> Joint | None:
    """Return the first joint that has a body of the tree, or None."""
    for joint in joints:
        if any(end.body in positions for end in ends_of(joint)):
            return joint
    return None


def branches_of(linkage: Linkage) -> tuple[Branch, ...] | str:
    """Return the free bodies as an open tree, parents before children.

    A text that says why there is no tree is returned if ideal joints close a loop that
    can move, and if a rigid joint has friction: the equations of an open tree do not
    contain the joint forces, on which this friction depends. Exudyn's tree has no driven
    bodies, so that its guides are on the frame or on free bodies.
    """
    prescribed = prescribed_of(linkage)
    if geared := linkage.free_gears:
        return _coupled(geared[0])
    for drive in linkage.prescribed_drives:
        if not bodies_of_drive(linkage, drive) <= prescribed:
            return _on_free_body(drive)
    branches = free_branches(linkage)
    if isinstance(branches, str):
        return branches
    for branch in branches:
        if isinstance(branch.joint, Guide) and branch.before.body in prescribed:
            return (
                f"{branch.joint.name} is on {branch.before.body}, whose motion drives "
                "prescribe"
            )
    return branches


def _on_free_body(drive: Drive) -> str:
    """Return why a drive is not in an open tree without drives."""
    verb = "moves" if isinstance(drive, LinearDrive) else "turns"
    return f"{drive.name} {verb} a body that is free to move"


def _coupled(gears: GearedDrive) -> str:
    """Return why gears are not in an open tree."""
    return f"gears couple {gears.leader} and {gears.body}"


def free_branches(linkage: Linkage) -> tuple[Branch, ...] | str:
    """Return the result of ``branches_of`` for a linkage whose drives may turn free bodies."""
    for joint in linkage.rubbing_pins:
        return f"joint {joint.name} rubs without clearance, and its friction needs the joint force"
    prescribed = prescribed_of(linkage)
    if len(prescribed) == len(linkage.bodies):
        return "the drives hold every body"
    for drive in linkage.prescribed_drives:
        is_linear = isinstance(drive, LinearDrive)
        if is_linear and not bodies_of_drive(linkage, drive) <= prescribed:
            return _on_free_body(drive)
    for name in closing_guides(linkage.joints):
        return f"joint {name} closes a loop of guides"
    joints: list[Joint] = [*linkage.revolutes, *linkage.guides]
    joints = [joint for joint in joints if not bodies_of(joint) <= prescribed]
    branches, closing, _ = _tree_of(joints, (GROUND, *prescribed), linkage.bodies)
    if closing:
        return f"joint {closing[0].name} closes a loop"
    if geared := linkage.free_gears:
        return _coupled(geared[0])
    driven = {drive.body: drive.name for drive in linkage.prescribed_drives}
    for branch in branches:
        if isinstance(branch.joint, Guide) and branch.end.body in driven:
            drive_name = driven[branch.end.body]
            return f"{drive_name} turns a body on {branch.joint.name}"
    return tuple(branches)


def chain_of(
    linkage: Linkage, bodies: frozenset[str]
) -> tuple[list[Branch], list[Revolute]]:
    """Return prescribed bodies as a tree, and the pins that close its loops.

    Raises
    ------
    ValueError
        If the bodies are no chain, or have a freedom.
    """
    # Guides come first, so that they are in the tree and only pins close its loops.
    joints: tuple[Joint, ...] = (*linkage.guides, *linkage.revolutes)
    inner = [joint for joint in joints if bodies_of(joint) <= bodies]
    branches, closing, remaining = _tree_of(inner, (GROUND,))
    pins = [joint for joint in closing if isinstance(joint, Revolute)]
    drives = [
        drive
        for drive in linkage.prescribed_drives
        if bodies_of_drive(linkage, drive) <= bodies
    ]
    rows = 2 * len(branches) + 2 * len(pins) + len(drives)
    if remaining or len(pins) < len(closing) or rows != 3 * len(bodies):
        raise ValueError(f"{', '.join(sorted(bodies))} are no chain without freedom")
    return branches, pins
