"""Linkages without a closed loop, and their placing."""

import numpy as np

import presswear as pw
from presswear.physics.contact import CONTACT
from presswear.physics.equations.chain import Chain, open_chain
from presswear.physics.equations.function import END, function_of, model_of
from presswear.physics.equations.text import Text
from presswear.physics.equations.writer import Equations, write_equations
from presswear.physics.packed import pack
from presswear.tools.arrays import Array
from presswear.tools.packing import pack_arguments


def branching() -> pw.linkage.Linkage:
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
            pw.linkage.Revolute(
                "N",
                pw.linkage.Attachment("near", -0.1, 0.01),
                pw.linkage.Attachment("crank", 0.05, 0.02),
            ),
            pw.linkage.Revolute(
                "F",
                pw.linkage.Attachment("near", 0.12, 0.0),
                pw.linkage.Attachment("far", -0.2, 0.03),
            ),
            pw.linkage.Revolute(
                "H",
                pw.linkage.Attachment("crank", -0.04, 0.01),
                pw.linkage.Attachment("frame", 0.3, -0.2),
            ),
            pw.linkage.Revolute(
                "P",
                pw.linkage.Attachment("slider", 0.05, 0.02),
                pw.linkage.Attachment("pendulum", 0.0, 0.1),
            ),
            pw.Guide("guide", "slider", 0.1, 0.2, direction=0.4, angle=-0.9),
        ),
        (pw.Drive("crank", -30.0, 0.7),),
        pw.linkage.OutputPoint("slider", 0.4),
    )


def open_tree(linkage: pw.linkage.Linkage) -> Chain:
    result = open_chain(linkage, Text())
    assert isinstance(result, Chain), result
    return result


def placed(linkage: pw.linkage.Linkage, x: Array, u: Array) -> tuple[Array, Array]:
    """Coordinates and rates of all bodies at t = 0 in a state of the open tree."""
    packed = pack(linkage)
    equations = write_equations(linkage, packed)
    assert isinstance(equations, Equations), equations
    joints = len(packed.joints)
    model = model_of(
        linkage, equations, packed, np.zeros(joints), np.zeros(joints, CONTACT)
    )
    y = np.zeros(equations.layout.size)
    y[: 2 * x.size] = np.concatenate([x, u])
    function_of(equations.text)(pack_arguments(model), 0.0, y, np.zeros(y.size), END)
    return model.bodies[0], model.bodies[1]


def without(linkage: pw.linkage.Linkage, *names: str) -> pw.linkage.Linkage:
    """Return the linkage without some of its joints."""
    return linkage.changed(joints=[j for j in linkage.joints if j.name not in names])
