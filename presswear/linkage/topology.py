"""Which bodies are held without freedom, and in what order bodies hang from each other."""

from collections.abc import Sequence
from typing import NamedTuple

from presswear.linkage.elements import Guide, Revolute
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment

Joint = Revolute | Guide


class Branch(NamedTuple):
    """A body of an open tree.

    Attributes
    ----------
    joint : Revolute, Guide or None
        What it hangs by; None for a body that no ideal joint holds.
    before, own : Attachment
        The joint's end on what it hangs from, and on the body itself.
    parent : int
        Place in the tree of what it hangs from; -1 for the frame or a body whose motion is known.
    """

    joint: Joint | None
    before: Attachment
    own: Attachment
    parent: int


def _ends(joint: Joint) -> tuple[Attachment, Attachment]:
    """The two points a joint holds together; of a guide its own and the mass centre."""
    if isinstance(joint, Guide):
        return Attachment(GROUND, joint.x, joint.y), Attachment(joint.body, 0.0, 0.0)
    return joint.first, joint.second


def joints_of(linkage: Linkage) -> tuple[Joint, ...]:
    """The ideal joints: pins, then guides."""
    return (*linkage.revolutes, *linkage.guides)


def bodies_of(joint: Joint) -> set[str]:
    """The bodies that a joint holds, without the frame."""
    return {end.body for end in _ends(joint)} - {GROUND}


def prescribed_of(linkage: Linkage) -> frozenset[str]:
    """Bodies that ideal joints, guides and drives hold without freedom: their motion is known.

    The largest set with as many rows of constraints inside it as coordinates.  Each row is
    given to one of its bodies, which has room for three.  A body with room left can move, and
    so can one that could pass a row on to it; all others are held.  The rows of a linkage that
    closes away from its dead points are independent, so that counting them is enough.
    """
    rows = [bodies_of(joint) for joint in joints_of(linkage) for _ in range(2)]
    rows += [{drive.body} for drive in linkage.drives]
    given: dict[str, list[set[str]]] = {body.name: [] for body in linkage.bodies}

    def take(row: set[str], asked: set[str]) -> bool:
        """Find room for a row, passing others on where need be."""
        for name in sorted(row - asked):
            asked.add(name)
            if len(given[name]) < 3:
                given[name].append(row)
                return True
            for other in given[name]:
                if take(other, asked):
                    # By place: equal rows are one as good as the other.
                    given[name][given[name].index(other)] = row
                    return True
        return False

    for row in rows:
        take(row, set())
    free = {name for name, own in given.items() if len(own) < 3}
    while True:
        more = {name for name, own in given.items() if any(row & free for row in own)} - free
        if not more:
            return frozenset(given.keys() - free)
        free |= more


class _Hanging:
    """Bodies as they are hung from each other, joint by joint.

    Attributes
    ----------
    waiting : list of Revolute or Guide
        Joints that hang from nothing so far.
    closing : list of Revolute or Guide
        Joints between two bodies that hang already.
    reached : dict of str to int
        Places of bodies in ``found``; -1 for what stood at the start.
    """

    def __init__(self, waiting: Sequence[Joint], standing: Sequence[str]) -> None:
        self.waiting, self.closing = list(waiting), list[Joint]()
        self.reached = dict.fromkeys(standing, -1)
        self.found: list[Branch] = []

    def add(self, joint: Joint | None, before: Attachment, own: Attachment) -> None:
        """Hang a body by a joint, or by none."""
        self.found.append(Branch(joint, before, own, self.reached[before.body]))
        self.reached[own.body] = len(self.found) - 1

    def hang(self) -> None:
        """Hang all bodies that joints reach, parents before children."""
        while True:
            for joint in self.waiting:
                before, own = _ends(joint)
                if before.body not in self.reached:
                    before, own = own, before
                if before.body in self.reached:
                    break
            else:
                return
            self.waiting.remove(joint)
            if own.body in self.reached:
                self.closing.append(joint)
            else:
                self.add(joint, before, own)


def branches_of(linkage: Linkage) -> tuple[Branch, ...] | str:
    """The free bodies of an open tree, parents before children, or in words why it is none.

    Where clearance joints cut every loop that has a freedom, what is left hangs from the frame,
    from bodies whose motion is known, or from nothing.
    """
    known = prescribed_of(linkage)
    for drive in linkage.drives:
        if drive.body not in known:
            return f"{drive.name} turns a body that is free to move"
    if len(known) == len(linkage.bodies):
        return "the drives hold every body"
    joints = [joint for joint in joints_of(linkage) if not bodies_of(joint) <= known]
    tree = _Hanging(joints, (GROUND, *known))
    tree.hang()
    for body in linkage.bodies:
        if body.name not in tree.reached:
            tree.add(None, Attachment(GROUND, 0.0, 0.0), Attachment(body.name, 0.0, 0.0))
            tree.hang()
    if tree.closing:
        return f"joint {tree.closing[0].name} closes a loop"
    return tuple(tree.found)


def chain_of(linkage: Linkage, bodies: frozenset[str]) -> tuple[list[Branch], list[Revolute]]:
    """Bodies without freedom as a tree that hangs from the frame, and the pins that close it.

    ValueError where they are no such chain.
    """
    # Guides first: what slides does so by its coordinate, and pins close the loops.
    joints: tuple[Joint, ...] = (*linkage.guides, *linkage.revolutes)
    chain = _Hanging([joint for joint in joints if bodies_of(joint) <= bodies], (GROUND,))
    chain.hang()
    pins = [joint for joint in chain.closing if isinstance(joint, Revolute)]
    drives = [drive for drive in linkage.drives if drive.body in bodies]
    rows = 2 * len(chain.found) + 2 * len(pins) + len(drives)
    if chain.waiting or len(pins) < len(chain.closing) or rows != 3 * len(bodies):
        raise ValueError(f"{', '.join(sorted(bodies))} are no chain without freedom")
    return chain.found, pins
