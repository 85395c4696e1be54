"""Linkages without a closed loop, and their placing."""

import numpy as np

import presswear as pw
from presswear.physics.prescribed import Tree, place_prescribed, tree_of
from presswear.physics.tree import place_links
from presswear.tools.arrays import Array


def branching() -> pw.Linkage:
    """A driven crank with two rods in a row, and an inclined slider with a pendulum."""
    return pw.assemble(
        (
            pw.Body("crank", 0.1, 1e-4),
            pw.Body("pendulum", 0.4, 2e-3),
            pw.Body("near", 0.2, 5e-4),
            pw.Body("far", 0.3, 7e-4),
            pw.Body("slider", 0.5, 1.0),
        ),
        (
            # The ends are written in both orders.
            pw.Revolute("N", pw.Attachment("near", -0.1, 0.01), pw.Attachment("crank", 0.05, 0.02)),
            pw.Revolute("F", pw.Attachment("near", 0.12, 0.0), pw.Attachment("far", -0.2, 0.03)),
            pw.Revolute(
                "H", pw.Attachment("crank", -0.04, 0.01), pw.Attachment("frame", 0.3, -0.2)
            ),
            pw.Revolute(
                "P", pw.Attachment("slider", 0.05, 0.02), pw.Attachment("pendulum", 0.0, 0.1)
            ),
            pw.Guide("guide", "slider", 0.1, 0.2, direction=0.4, angle=-0.9),
        ),
        (pw.Drive("crank", -30.0, 0.7),),
        pw.OutputPoint("slider", 0.4),
    )


def placed(
    tree: Tree, bodies: int, t: float, x: Array, u: Array
) -> tuple[Array, Array, Array, Array]:
    """q, v, a of the prescribed bodies, and axes, with all free bodies placed."""
    q, v, a, axes = np.zeros((4, 3 * bodies))
    place_prescribed(tree.prescribed, t, q, v, a, axes)
    place_links(tree.links, x, u, q, v, axes)
    return q, v, a, axes


def tree(linkage: pw.Linkage) -> Tree:
    result = tree_of(linkage)
    assert isinstance(result, Tree), result
    return result


def without(linkage: pw.Linkage, *names: str) -> pw.Linkage:
    """Return the linkage without some of its joints."""
    return linkage.changed(joints=[j for j in linkage.joints if j.name not in names])
