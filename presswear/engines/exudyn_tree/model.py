"""The open tree as Exudyn has it: one kinematic tree in minimal coordinates."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.engines.exudyn import add_node, add_object
from presswear.linkage.elements import Linkage
from presswear.physics.tree import Tree

Array = NDArray[np.float64]

_EXUDYN: Any = exu  # its type hints do not know the arguments of its lists


@dataclass
class TreeModel:
    """An assembled tree; the three views of its coordinates stay live during the solve."""

    container: Any
    system: Any
    x: Any
    u: Any
    u_t: Any


def _turned(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def assemble(tree: Tree, linkage: Linkage, start: Start, force: Callable[..., Array]) -> TreeModel:
    """Build and assemble the tree with a user function for the forces on its coordinates."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    x, u = tree.coordinates(start.position, start.velocity)
    count = len(tree.links)
    node = add_node(
        system,
        "GenericODE2",
        referenceCoordinates=[0.0] * count,
        initialCoordinates=list(x),
        initialCoordinates_t=list(u),
        numberOfODE2Coordinates=count,
    )
    types, turns, offsets, centres, masses, inertias = [], [], [], [], [], []
    for link, name in zip(tree.links, tree.names, strict=True):
        body = linkage.bodies[linkage.index(name)]
        # A link's frame sits in its joint, along the body's axes or along its guide.
        turn, offset = 0.0, np.zeros(2)
        if link["slides"]:
            turn = math.atan2(link["sine"], link["cosine"])
        elif link["parent"] >= 0:
            parent = tree.links[link["parent"]]
            offset = np.array([link["before_x"], link["before_y"]])
            offset -= [parent["own_x"], parent["own_y"]]
            if parent["slides"]:
                turn = parent["angle"] - math.atan2(parent["sine"], parent["cosine"])
                offset = _turned(turn)[:2, :2] @ offset
        own = np.array([link["own_x"], link["own_y"]])
        types.append(exu.JointType.PrismaticX if link["slides"] else exu.JointType.RevoluteZ)
        turns.append(_turned(turn))
        offsets.append([*offset, 0.0])
        centres.append([*-own, 0.0])
        masses.append(body.mass)
        inertias.append(np.diag([0.0, 0.0, body.inertia]))
    add_object(
        system,
        "KinematicTree",
        nodeNumber=node,
        jointTypes=types,
        linkParents=[int(parent) for parent in tree.links["parent"]],
        jointTransformations=_EXUDYN.Matrix3DList(turns),
        jointOffsets=_EXUDYN.Vector3DList(offsets),
        linkInertiasCOM=_EXUDYN.Matrix3DList(inertias),
        linkCOMs=_EXUDYN.Vector3DList(centres),
        linkMasses=masses,
        forceUserFunction=force,
    )
    system.Assemble()
    data = system.systemData
    return TreeModel(
        container,
        system,
        data.GetODE2Coordinates(copy=False),
        data.GetODE2Coordinates_t(copy=False),
        data.GetODE2Coordinates_tt(copy=False),
    )
