"""Articulated bodies against the saddle-point system with Lagrange multipliers (equation 18)."""

from dataclasses import replace

import numpy as np
import pytest
from branches import branching, placed, tree
from hypothesis import given, settings
from hypothesis import strategies as st

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import Press
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import motion_of
from presswear.physics.packed import mass_of
from presswear.physics.prescribed import begin_motion
from presswear.physics.tree import (
    ARTICULATED,
    CARRIED,
    accelerate_links,
    articulate,
    carry_branches,
    release,
)


def without(linkage: Linkage, *names: str) -> Linkage:
    """The linkage with revolute joints taken out."""
    return replace(linkage, joints=tuple(j for j in linkage.joints if j.name not in names))


PRESS = Press().linkage()
START = motion_of(Press()).at(np.array([0.02])).position[0]
LINKAGES = (
    *(branching(), without(branching(), "N")),
    *(without(PRESS, *names.split()) for names in ("A C", "C", "E", "C E", "A B C", "A C D")),
)
"""Links on cranks, on the frame, on a slider, on each other, and on nothing."""
numbers = st.floats(-3.0, 3.0)


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_a_tree_moves_under_forces_as_with_multipliers(data: st.DataObject) -> None:
    linkage = data.draw(st.sampled_from(LINKAGES))
    found, bodies = tree(linkage), len(linkage.bodies)
    draw = st.lists(numbers, min_size=found.size, max_size=found.size).map(np.array)
    force = np.array(data.draw(st.lists(numbers, min_size=3 * bodies, max_size=3 * bodies)))
    time = 0.02
    if bodies == START.size // 3:
        begin_motion(found.prescribed, time, START)  # where its loops close
    q, v, a, axes = placed(found, bodies, time, data.draw(draw), data.draw(draw))
    carried, u_t = np.zeros((len(found.links), CARRIED)), np.zeros(found.size)
    work = np.zeros(len(found.links), ARTICULATED)
    carry_branches(found.links, v, a, axes, carried)
    articulate(found.links, v, axes, carried, force, work)
    release(found.links, work, u_t, a)

    constraints, mass = constraints_of(linkage), mass_of(linkage)
    _, _, gamma, jacobian = constraints.evaluate(time, q, v)
    rows = constraints.rows
    matrix = np.block([[np.diag(mass), jacobian.T], [jacobian, np.zeros((rows, rows))]])
    exact = np.linalg.solve(matrix, np.concatenate([force, gamma]))[: a.size]
    scale = np.abs(exact).max()
    assert a == pytest.approx(exact, abs=1e-9 * scale)
    accelerate_links(found.links, u_t, v, axes, a)
    assert a == pytest.approx(exact, abs=1e-9 * scale)
