"""Exudyn's kinematic tree of a linkage without free loops."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.base import Start
from presswear.engines.exudyn import add
from presswear.linkage.bodies import Body
from presswear.physics.equations.chain import Chain, Link
from presswear.tools.arrays import Array
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()


class TreeLink(NamedTuple):
    """Link of Exudyn's kinematic tree.

    The origin of its axes is its joint. Their x direction is that of the body, or of the
    guide.
    """

    joint: Any  # exudyn.JointType
    parent: int = -1  # number of the parent; -1: the frame, or a prescribed body
    turn: float = 0.0  # angle of its joint in the axes of the parent, rad
    offset: tuple[float, float] = (0.0, 0.0)  # place of its joint in these axes, m
    centre: tuple[float, float] = (0.0, 0.0)  # mass centre in the axes of the link, m
    body: Body | None = None  # None: without mass

    @property
    def inertia(self) -> float:
        """Inertia about the mass centre, kg m^2."""
        return self.body.effective_inertia if self.body else 0.0


def _rotation(angle: float) -> Array:
    c = math.cos(angle)
    s = math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def tree_links(chain: Chain) -> list[TreeLink]:
    """Return the links of an open tree for Exudyn, parents before children."""
    links = list[TreeLink]()
    numbers = dict[str, int]()
    for link in chain.free:
        end = link.branch.end
        revolute = TreeLink(
            exu.JointType.RevoluteZ, centre=(-end.x, -end.y), body=link.body
        )
        if link.is_loose:
            # Two sliding links without mass give the body its translation.
            links.append(TreeLink(exu.JointType.PrismaticX))
            links.append(TreeLink(exu.JointType.PrismaticY, len(links) - 1))
            links.append(revolute._replace(parent=len(links) - 1))
        elif link.is_guided:
            links.append(_guided(link, numbers))
        elif link.parent is not None and link.parent.prefix in numbers:
            revolute = revolute._replace(parent=numbers[link.parent.prefix])
            turn, offset = _on_parent(link, link.parent)
            links.append(revolute._replace(turn=turn, offset=offset))
        else:
            links.append(revolute)
        numbers[link.prefix] = len(links) - 1
    return links


def _guided(link: Link, numbers: dict[str, int]) -> TreeLink:
    """Return a link that slides along a guide on the frame or on a body."""
    end = link.branch.end
    x, y = _rotation(_turn_of_axes(link))[:2, :2] @ (-end.x, -end.y)
    slide = TreeLink(
        exu.JointType.PrismaticX,
        turn=link.branch.slope,
        centre=(x, y),
        body=link.body,
    )
    parent = link.parent
    if parent is None or parent.prefix not in numbers:
        return slide
    turn, offset = _on_parent(link, parent)
    turn += link.branch.slope
    return slide._replace(parent=numbers[parent.prefix], turn=turn, offset=offset)


def _turn_of_axes(link: Link) -> float:
    """Return the angle of a body in the axes of its link, rad."""
    return link.branch.turn - link.branch.slope if link.is_guided else 0.0


def _on_parent(link: Link, parent: Link) -> tuple[float, tuple[float, float]]:
    """Return the angle of the parent in the axes of its link, and the joint on it, m."""
    x = link.branch.before.x - parent.branch.end.x
    y = link.branch.before.y - parent.branch.end.y
    turn = _turn_of_axes(parent)
    if turn:
        x, y = _rotation(turn)[:2, :2] @ (x, y)
    return turn, (x, y)


def add_tree(
    system: Any, chain: Chain, start: Start, forces: Callable[..., Any]
) -> None:
    """Add a kinematic tree to a system, with a user function for the forces on its coordinates."""
    x, u = chain.coordinates(start.position, start.velocity)
    node = add(
        system,
        "Node",
        "GenericODE2",
        referenceCoordinates=[0.0] * chain.size,
        initialCoordinates=list(x),
        initialCoordinates_t=list(u),
        numberOfODE2Coordinates=chain.size,
    )
    links = tree_links(chain)
    add(
        system,
        "Object",
        "KinematicTree",
        nodeNumber=node,
        jointTypes=[link.joint for link in links],
        linkParents=[link.parent for link in links],
        jointTransformations=exu.Matrix3DList([_rotation(link.turn) for link in links]),
        jointOffsets=exu.Vector3DList([[*link.offset, 0.0] for link in links]),
        linkInertiasCOM=exu.Matrix3DList(
            [np.diag([0.0, 0.0, link.inertia]) for link in links]
        ),
        linkCOMs=exu.Vector3DList([[*link.centre, 0.0] for link in links]),
        linkMasses=[link.body.mass if link.body else 0.0 for link in links],
        forceUserFunction=forces,
    )
