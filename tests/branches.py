"""Linkages without a closed loop, and their placing."""

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import (
    GROUND,
    Attachment,
    Body,
    Drive,
    Guide,
    Linkage,
    Probe,
    Revolute,
)
from presswear.physics.prescribed import place_cranks
from presswear.physics.tree import Tree, place_links, tree_of

Array = NDArray[np.float64]


def branching() -> Linkage:
    """A driven crank with two rods in a row, and an inclined slider with a pendulum."""
    return Linkage(
        "branches",
        (
            Body("crank", 0.1, 1e-4),
            Body("pendulum", 0.4, 2e-3),
            Body("near", 0.2, 5e-4),
            Body("far", 0.3, 7e-4),
            Body("slider", 0.5, 1.0),
        ),
        (
            # The ends are given in both orders.
            Revolute("N", Attachment("near", -0.1, 0.01), Attachment("crank", 0.05, 0.02)),
            Revolute("F", Attachment("near", 0.12, 0.0), Attachment("far", -0.2, 0.03)),
            Revolute("H", Attachment("crank", -0.04, 0.01), Attachment(GROUND, 0.3, -0.2)),
            Revolute("P", Attachment("slider", 0.05, 0.02), Attachment("pendulum", 0.0, 0.1)),
        ),
        (Guide("guide", "slider", 0.1, 0.2, direction=0.4, angle=-0.9),),
        (Drive("drive", "crank", 0.7, -30.0),),
        (),
        Probe("slider", 0.4),
    )


def placed(
    tree: Tree, bodies: int, t: float, x: Array, u: Array
) -> tuple[Array, Array, Array, Array]:
    """q, v, a of the cranks, and axes, with all free bodies placed."""
    q, v, a, axes = np.zeros((4, 3 * bodies))
    place_cranks(tree.cranks, t, q, v, a, axes)
    place_links(tree.links, x, u, q, v, axes)
    return q, v, a, axes


def tree(linkage: Linkage) -> Tree:
    found = tree_of(linkage)
    assert isinstance(found, Tree), found
    return found
