"""The open tree as Exudyn has it: one kinematic tree in minimal coordinates."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.engines.exudyn import add_node, add_object
from presswear.linkage.linkage import Linkage
from presswear.physics.prescribed import Tree
from presswear.physics.tree import COORDINATES, GUIDED, LOOSE
from presswear.tools.exudyn import exudyn_module

Array = NDArray[np.float64]

exu = exudyn_module()


@dataclass
class TreeModel:
    """An assembled tree; the views of its coordinates stay live during the solve."""

    container: Any
    system: Any
    x: Any
    u: Any
    u_t: Any
    bristles: Any  # deflections of the bristles of friction, m; none where it has no bristles

    def state(self) -> dict[str, Array]:
        """The live state between two solves, by the names that Exudyn gives it."""
        arrays = {"ODE2Coordinates": self.x, "ODE2Coordinates_t": self.u}
        if len(self.bristles):
            arrays["ODE1Coordinates"] = self.bristles
        return {name: np.asarray(array) for name, array in arrays.items()}


def _turned(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def assemble(
    tree: Tree,
    linkage: Linkage,
    start: Start,
    force: Callable[..., Array],
    bristle_rates: Callable[..., Array] | None = None,
) -> TreeModel:
    """Build and assemble the tree with a user function for the forces on its coordinates.

    Parameters
    ----------
    bristle_rates : callable or None
        User function for the rates of the bristles of friction; Exudyn calls it before
        the one for the forces.
    """
    container = exu.SystemContainer()
    system = container.AddSystem()
    x, u = tree.coordinates(start.position, start.velocity)
    count = tree.size
    node = add_node(
        system,
        "GenericODE2",
        referenceCoordinates=[0.0] * count,
        initialCoordinates=list(x),
        initialCoordinates_t=list(u),
        numberOfODE2Coordinates=count,
    )
    types, parents, turns, offsets, centres, masses, inertias = [], [], [], [], [], [], []

    def add(kind: Any, parent: int, turn: float, offset: Array, joint: Array, body: Any) -> None:
        types.append(kind)
        parents.append(parent)
        turns.append(_turned(turn))
        offsets.append([*offset, 0.0])
        centres.append([*-joint, 0.0])
        masses.append(body.mass if body else 0.0)
        inertias.append(np.diag([0.0, 0.0, body.effective_inertia if body else 0.0]))

    kinds, still = exu.JointType, np.zeros(2)
    last = [int(link["place"]) + COORDINATES[link["kind"]] - 1 for link in tree.links]
    for link, name in zip(tree.links, tree.names, strict=True):
        # A link's frame sits in its joint, along the body's axes or along its guide.
        kind, parent, turn, offset = kinds.RevoluteZ, -1, 0.0, still
        if link["kind"] == GUIDED:
            kind, turn = kinds.PrismaticX, math.atan2(link["sine"], link["cosine"])
        elif link["kind"] == LOOSE:
            # Two links without mass carry it across the plane.
            add(kinds.PrismaticX, -1, 0.0, still, still, None)
            add(kinds.PrismaticY, len(types) - 1, 0.0, still, still, None)
            parent = len(types) - 1
        elif link["parent"] >= 0:
            before, parent = tree.links[link["parent"]], last[link["parent"]]
            offset = np.array([link["before_x"], link["before_y"]])
            offset -= [before["own_x"], before["own_y"]]
            if before["kind"] == GUIDED:
                turn = before["angle"] - math.atan2(before["sine"], before["cosine"])
                offset = _turned(turn)[:2, :2] @ offset
        joint = np.array([link["own_x"], link["own_y"]])
        add(kind, parent, turn, offset, joint, linkage.bodies[linkage.index(name)])
    add_object(
        system,
        "KinematicTree",
        nodeNumber=node,
        jointTypes=types,
        linkParents=parents,
        jointTransformations=exu.Matrix3DList(turns),
        jointOffsets=exu.Vector3DList(offsets),
        linkInertiasCOM=exu.Matrix3DList(inertias),
        linkCOMs=exu.Vector3DList(centres),
        linkMasses=masses,
        forceUserFunction=force,
    )
    if bristle_rates is not None:
        joints = len(linkage.clearances)
        states = add_node(
            system,
            "GenericODE1",
            referenceCoordinates=[0.0] * joints,
            initialCoordinates=[0.0] * joints,
            numberOfODE1Coordinates=joints,
        )
        add_object(system, "GenericODE1", nodeNumbers=[states], rhsUserFunction=bristle_rates)
    system.Assemble()
    data = system.systemData
    return TreeModel(
        container,
        system,
        data.GetODE2Coordinates(copy=False),
        data.GetODE2Coordinates_t(copy=False),
        data.GetODE2Coordinates_tt(copy=False),
        data.GetODE1Coordinates(copy=False),
    )
