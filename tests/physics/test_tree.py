"""Open trees: topology, coordinates, virtual work, and motion as with Lagrange multipliers."""

import math

import numpy as np
import pytest
from branches import branching, placed, tree, without
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.mechanisms import GEOMETRIES, Press
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import motion_of
from presswear.physics.packed import mass_of
from presswear.physics.prescribed import begin_motion, tree_of
from presswear.physics.tree import (
    ARTICULATED,
    CARRIED,
    accelerate_links,
    articulate,
    carry_branches,
    gather_forces,
    release,
)

PRESS = Press().linkage()
PARENTS = {
    "A C": {"plate 4": None, "rod 3": "plate 4", "slider 6": None, "rod 5": "slider 6"},
    "C": {"slider 6": None, "rod 5": "slider 6"},
    "E": {"rod 5": None, "slider 6": None},
    "C E": {"slider 6": None, "rod 5": None},
    "A C D": {"slider 6": None, "rod 5": "slider 6", "rod 3": None, "plate 4": "rod 3"},
    "A B C": {"plate 4": None, "slider 6": None, "rod 5": "slider 6", "rod 3": None},
}
"""Body that each body of the press hangs from (None: frame or crank), by the open joints."""


@pytest.mark.parametrize("opened", PARENTS)
def test_bodies_hang_from_frame_crank_or_each_other(opened: str) -> None:
    result = tree(without(PRESS, *opened.split()))
    parents = [
        result.names[link["parent"]] if link["parent"] >= 0 else None for link in result.links
    ]
    assert dict(zip(result.names, parents, strict=True)) == PARENTS[opened]
    # A body that nothing holds has three coordinates.
    assert result.size == {"A C": 4, "C": 2, "E": 2, "C E": 4, "A C D": 6, "A B C": 6}[opened]


@pytest.mark.parametrize(
    ("taken_out", "reason"),
    [
        ("", "the drives hold every body"),
        ("A", "closes a loop"),
        ("A C O7", "drive of crank 7 turns a body that is free to move"),
    ],
)
def test_a_linkage_that_is_no_tree_is_explained(taken_out: str, reason: str) -> None:
    explanation = tree_of(without(PRESS, *taken_out.split()))
    assert isinstance(explanation, str)
    assert reason in explanation


@pytest.mark.parametrize("opened", PARENTS)
@pytest.mark.parametrize("name", sorted(GEOMETRIES))
def test_coordinates_give_back_the_ideal_motion(name: str, opened: str) -> None:
    press = Press(geometry=GEOMETRIES[name])
    system = tree(without(press.linkage(), *opened.split()))
    for time in (0.0, 0.13, 0.41):
        motion = motion_of(press).at(np.array([time]))
        exact_q, exact_v, exact_a = motion.position[0], motion.velocity[0], motion.acceleration[0]
        begin_motion(system.prescribed, time, exact_q)
        q, v, a, axes = placed(system, 6, time, *system.coordinates(exact_q, exact_v))
        turns = np.round((q - exact_q)[2::3] / (2.0 * math.pi))
        q[2::3] -= 2.0 * math.pi * turns
        assert q == pytest.approx(exact_q, abs=2e-14)
        assert v == pytest.approx(exact_v, abs=2e-13)
        # Rates and accelerations of relative coordinates are the same differences.
        accelerate_links(system.links, system.coordinates(exact_q, exact_a)[1], v, axes, a)
        assert a == pytest.approx(exact_a, abs=2e-11)


numbers = st.floats(-3.0, 3.0)
TREES = (branching(), without(branching(), "N"))
"""In the second, near and far hang from nothing."""
START = motion_of(Press()).at(np.array([0.02])).position[0]


def drawn(data: st.DataObject, count: int) -> NDArray[np.float64]:
    return np.array(data.draw(st.lists(numbers, min_size=count, max_size=count)))


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_forces_are_gathered_by_virtual_work(data: st.DataObject) -> None:
    system = tree(data.draw(st.sampled_from(TREES)))
    count = system.size
    x, direction, force = drawn(data, count), drawn(data, count), drawn(data, 15)
    t, h = 0.02, 1e-6
    rest = np.zeros(count)
    ahead = placed(system, 5, t, x + h * direction, rest)[0]
    behind = placed(system, 5, t, x - h * direction, rest)[0]
    q, _, _, axes = placed(system, 5, t, x, rest)
    out = np.zeros(count)
    gather_forces(system.links, q, axes, force.copy(), out)
    work = force @ (ahead - behind) / (2.0 * h)
    assert out @ direction == pytest.approx(work, abs=2e-8)


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_a_tree_moves_under_forces_as_with_multipliers(data: st.DataObject) -> None:
    """Articulated bodies against the saddle-point system (equation 18)."""
    linkage = data.draw(st.sampled_from([*TREES, *(without(PRESS, *n.split()) for n in PARENTS)]))
    system, bodies, time = tree(linkage), len(linkage.bodies), 0.02
    force = drawn(data, 3 * bodies)
    if bodies == START.size // 3:
        begin_motion(system.prescribed, time, START)  # where its loops close
    x, u = drawn(data, system.size), drawn(data, system.size)
    q, v, a, axes = placed(system, bodies, time, x, u)
    carried, u_t = np.zeros((len(system.links), CARRIED)), np.zeros(system.size)
    work = np.zeros(len(system.links), ARTICULATED)
    carry_branches(system.links, v, a, axes, carried)
    articulate(system.links, v, axes, carried, force, work)
    release(system.links, work, u_t, a)
    constraints = constraints_of(linkage)
    _, _, gamma, jacobian = constraints.evaluate(time, q, v)
    empty = np.zeros((constraints.rows, constraints.rows))
    matrix = np.block([[np.diag(mass_of(linkage)), jacobian.T], [jacobian, empty]])
    exact = np.linalg.solve(matrix, np.concatenate([force, gamma]))[: a.size]
    scale = np.abs(exact).max()
    assert a == pytest.approx(exact, abs=1e-9 * scale)
    accelerate_links(system.links, u_t, v, axes, a)
    assert a == pytest.approx(exact, abs=1e-9 * scale)
