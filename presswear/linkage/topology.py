"""The order in which bodies hang from each other: driven cranks, linkages without a loop."""

from typing import NamedTuple

from presswear.linkage.elements import GROUND, Attachment, Guide, Linkage, Revolute


class Branch(NamedTuple):
    """A free body of an open tree.

    Attributes
    ----------
    joint : Revolute or Guide
        What it hangs by.
    before, own : Attachment
        The joint's end on what it hangs from, and on the body itself.
    parent : int
        Place in the tree of what it hangs from; -1 for the frame or a crank.
    """

    joint: Revolute | Guide
    before: Attachment
    own: Attachment
    parent: int


def hinge_of(linkage: Linkage, body: str) -> Revolute | None:
    """The joint that hinges a body to the frame; None if there is none."""
    for joint in linkage.revolutes:
        if {joint.first.body, joint.second.body} == {GROUND, body}:
            return joint
    return None


def cranks_of(linkage: Linkage) -> frozenset[str]:
    """Bodies that a drive turns about a hinge on the frame."""
    return frozenset(d.body for d in linkage.drives if hinge_of(linkage, d.body) is not None)


def _ends(joint: Revolute | Guide) -> tuple[Attachment, Attachment]:
    """The two points a joint holds together; of a guide its own and the mass centre."""
    if isinstance(joint, Guide):
        return Attachment(GROUND, joint.x, joint.y), Attachment(joint.body, 0.0, 0.0)
    return joint.first, joint.second


def branches_of(linkage: Linkage) -> tuple[Branch, ...] | str:
    """The free bodies of an open tree, parents before children, or in words why it is none.

    Where clearance joints cut every loop, what is left hangs from the frame and from driven
    cranks.
    """
    cranks = cranks_of(linkage)
    for drive in linkage.drives:
        if drive.body not in cranks:
            return f"{drive.name} turns a body that is not hinged to the frame"
    hinges = {id(hinge_of(linkage, name)) for name in cranks}
    waiting: list[Revolute | Guide] = [j for j in linkage.revolutes if id(j) not in hinges]
    waiting += linkage.guides
    reached: dict[str, int] = dict.fromkeys((GROUND, *cranks), -1)
    found: list[Branch] = []
    while waiting:
        for joint in waiting:
            before, own = _ends(joint)
            if before.body in reached and own.body in reached:
                return f"joint {joint.name} closes a loop"
            if before.body not in reached:
                before, own = own, before
            if before.body in reached:
                break
        else:
            return f"joint {waiting[0].name} hangs from nothing"
        waiting.remove(joint)
        found.append(Branch(joint, before, own, reached[before.body]))
        reached[own.body] = len(found) - 1
    loose = [body.name for body in linkage.bodies if body.name not in reached]
    if loose:
        return f"{loose[0]} is not held by any joint"
    return tuple(found)
