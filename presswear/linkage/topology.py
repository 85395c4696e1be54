"""Topology of a linkage: bodies with prescribed motion, and open trees of the others."""

from collections.abc import Sequence
from typing import NamedTuple

from presswear.linkage.elements import (
    GROUND,
    Attachment,
    Body,
    Joint,
    Revolute,
    ends_of,
)
from presswear.linkage.linkage import Linkage


class Branch(NamedTuple):
    """Body of an open tree."""

    joint: Joint | None  # to the parent; None for a body that no ideal joint holds
    before: Attachment  # end of the joint on the parent
    end: Attachment  # end of the joint on the body itself
    # position in the tree; -1 for the frame or a body with prescribed motion
    parent: int


def bodies_of(joint: Joint) -> set[str]:
    """Return the bodies that a joint holds, without the frame."""
    return {end.body for end in ends_of(joint)} - {GROUND}


def prescribed_of(linkage: Linkage) -> frozenset[str]:
    """Return the bodies whose motion ideal joints, guides and drives prescribe fully.

    The largest set with as many rows of constraints inside it as coordinates. Each row
    is assigned to one of its bodies, which has room for three. A body with room left
    can move, and so can one that could pass a row on to it; all others are prescribed.
    The rows of a linkage that closes away from its dead points are independent, so that
    counting them is enough.
    """
    rows = [bodies_of(joint) for joint in linkage.joints for _ in range(joint.rows)]
    rows += [{drive.body} for drive in linkage.prescribed_drives]
    assigned: dict[str, list[set[str]]] = {body.name: [] for body in linkage.bodies}

    def assign(row: set[str], visited: set[str]) -> bool:
        """Find room for a row, passing others on where need be."""
        for name in sorted(row - visited):
            visited.add(name)
            if len(assigned[name]) < 3:
                assigned[name].append(row)
                return True
            for earlier in assigned[name]:
                if assign(earlier, visited):
                    # By position: equal rows are interchangeable.
                    assigned[name][assigned[name].index(earlier)] = row
                    return True
        return False

    for row in rows:
        assign(row, set())
    free = {name for name, rows in assigned.items() if len(rows) < 3}
    while True:
        more = {
            name for name, rows in assigned.items() if any(row & free for row in rows)
        } - free
        if not more:
            return frozenset(assigned.keys() - free)
        free |= more


def _tree_of(
    joints: Sequence[Joint], roots: Sequence[str], bodies: Sequence[Body] = ()
) -> tuple[list[Branch], list[Joint], list[Joint]]:
    """Return a tree that grows from roots joint by joint, parents before children.

    Bodies that no joint reaches hang from nothing. The joints between two bodies of the
    tree, and those that do not touch it, are returned behind it.
    """
    branches, closing, waiting = list[Branch](), list[Joint](), list(joints)
    positions = dict.fromkeys(roots, -1)  # in ``branches``
    while True:
        touching = (
            one for one in waiting if any(at.body in positions for at in ends_of(one))
        )
        joint = next(touching, None)
        if joint is not None:
            waiting.remove(joint)
            before, end = ends_of(joint)
            if before.body not in positions:
                before, end = end, before
            if end.body in positions:
                closing.append(joint)
                continue
        else:
            name = next(
                (body.name for body in bodies if body.name not in positions), None
            )
            if name is None:
                return branches, closing, waiting
            before, end = Attachment(GROUND, 0.0, 0.0), Attachment(name, 0.0, 0.0)
        positions[end.body] = len(branches)
        branches.append(Branch(joint, before, end, positions[before.body]))


def branches_of(linkage: Linkage) -> tuple[Branch, ...] | str:
    """Return the free bodies as an open tree, parents before children, or why there is none.

    Where clearance joints cut every loop that has a freedom, the rest hangs from the
    frame, from bodies with prescribed motion, or from nothing. An open tree has no
    forces of its joints, which the friction of rigid joints needs.
    """
    prescribed = prescribed_of(linkage)
    for drive in linkage.prescribed_drives:
        if drive.body not in prescribed:
            return f"{drive.name} turns a body that is free to move"
    return free_branches(linkage)


def free_branches(linkage: Linkage) -> tuple[Branch, ...] | str:
    """Return the result of ``branches_of`` for a linkage whose drives may turn free bodies."""
    for joint in linkage.rubbing_pins:
        return f"joint {joint.name} rubs without clearance, and its friction needs the joint force"
    prescribed = prescribed_of(linkage)
    if len(prescribed) == len(linkage.bodies):
        return "the drives hold every body"
    joints: list[Joint] = [*linkage.revolutes, *linkage.guides]
    joints = [joint for joint in joints if not bodies_of(joint) <= prescribed]
    branches, closing, _ = _tree_of(joints, (GROUND, *prescribed), linkage.bodies)
    return f"joint {closing[0].name} closes a loop" if closing else tuple(branches)


def chain_of(
    linkage: Linkage, bodies: frozenset[str]
) -> tuple[list[Branch], list[Revolute]]:
    """Return prescribed bodies as a tree, and the pins that close it; ValueError for no chain."""
    # Guides first: what slides does so by its coordinate, and pins close the loops.
    joints: tuple[Joint, ...] = (*linkage.guides, *linkage.revolutes)
    inner = [joint for joint in joints if bodies_of(joint) <= bodies]
    branches, closing, waiting = _tree_of(inner, (GROUND,))
    pins = [joint for joint in closing if isinstance(joint, Revolute)]
    drives = [drive for drive in linkage.prescribed_drives if drive.body in bodies]
    rows = 2 * len(branches) + 2 * len(pins) + len(drives)
    if waiting or len(pins) < len(closing) or rows != 3 * len(bodies):
        raise ValueError(f"{', '.join(sorted(bodies))} are no chain without freedom")
    return branches, pins
