"""Open trees: topology, coordinates, accelerations and virtual work."""

import math
from dataclasses import replace

import numpy as np
import pytest
from branches import branching, placed, tree
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import GEOMETRIES, Press
from presswear.physics.ideal import motion_of
from presswear.physics.prescribed import begin_motion, forced_power, tree_of
from presswear.physics.tree import CARRIED, accelerate_links, carry_branches, gather_forces

Array = NDArray[np.float64]


def without(linkage: Linkage, *names: str) -> Linkage:
    """The linkage with revolute joints taken out."""
    return replace(linkage, joints=tuple(j for j in linkage.joints if j.name not in names))


@pytest.mark.parametrize("name", sorted(GEOMETRIES))
def test_the_press_hangs_from_its_crank_and_its_guide(name: str) -> None:
    found = tree(without(Press(geometry=GEOMETRIES[name]).linkage(), "A", "C"))
    before = [found.names[link["parent"]] if link["parent"] >= 0 else None for link in found.links]
    hung = dict(zip(found.names, before, strict=True))
    assert hung == {"plate 4": None, "rod 3": "plate 4", "slider 6": None, "rod 5": "slider 6"}
    assert len(found.prescribed.parts) == 2


@pytest.mark.parametrize(
    ("taken_out", "reason"),
    [
        ("", "the drives hold every body"),
        ("A", "closes a loop"),
        ("A C O7", "drive of crank 7 turns a body that is free to move"),
    ],
)
def test_what_is_no_tree_is_told_in_words(taken_out: str, reason: str) -> None:
    found = tree_of(without(Press().linkage(), *taken_out.split()))
    assert isinstance(found, str)
    assert reason in found


def test_what_hangs_from_a_moving_body_or_from_nothing() -> None:
    """Bodies behind those they hang from; a body that nothing holds has three coordinates."""

    def hung(*names: str) -> tuple[dict[str, str | None], int]:
        found = tree(without(Press().linkage(), *names))
        parents = [int(link["parent"]) for link in found.links]
        before = (found.names[parent] if parent >= 0 else None for parent in parents)
        return dict(zip(found.names, before, strict=True)), found.size

    assert hung("C") == ({"slider 6": None, "rod 5": "slider 6"}, 2)
    assert hung("E") == ({"rod 5": None, "slider 6": None}, 2)
    assert hung("C", "E") == ({"slider 6": None, "rod 5": None}, 4)
    assert hung("A", "C", "D") == (
        {"slider 6": None, "rod 5": "slider 6", "rod 3": None, "plate 4": "rod 3"},
        6,
    )
    assert hung("A", "B", "C") == (
        {"plate 4": None, "slider 6": None, "rod 5": "slider 6", "rod 3": None},
        6,
    )


@pytest.mark.parametrize("opened", ["A C", "C", "E", "C E", "A B C", "A C D"])
@pytest.mark.parametrize("name", sorted(GEOMETRIES))
def test_coordinates_give_back_the_ideal_motion(name: str, opened: str) -> None:
    press = Press(geometry=GEOMETRIES[name])
    found = tree(without(press.linkage(), *opened.split()))
    for time in (0.0, 0.13, 0.41):
        motion = motion_of(press).at(np.array([time]))
        exact_q, exact_v, exact_a = motion.position[0], motion.velocity[0], motion.acceleration[0]
        begin_motion(found.prescribed, time, exact_q)
        q, v, a, axes = placed(found, 6, time, *found.coordinates(exact_q, exact_v))
        turns = np.round((q - exact_q)[2::3] / (2.0 * math.pi))
        q[2::3] -= 2.0 * math.pi * turns
        assert q == pytest.approx(exact_q, abs=2e-14)
        assert v == pytest.approx(exact_v, abs=2e-13)
        # Rates and accelerations of relative coordinates are the same differences.
        accelerate_links(found.links, found.coordinates(exact_q, exact_a)[1], v, axes, a)
        assert a == pytest.approx(exact_a, abs=2e-11)


numbers = st.floats(-3.0, 3.0)
TREES = (branching(), without(branching(), "N"))
"""In the second, near and far hang from nothing."""


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_forces_are_gathered_by_virtual_work(data: st.DataObject) -> None:
    found = tree(data.draw(st.sampled_from(TREES)))
    count = found.size
    draw = st.lists(numbers, min_size=count, max_size=count).map(np.array)
    x, direction = data.draw(draw), data.draw(draw)
    force = np.array(data.draw(st.lists(numbers, min_size=15, max_size=15)))
    t, h = 0.02, 1e-6
    rest = np.zeros(count)
    ahead = placed(found, 5, t, x + h * direction, rest)[0]
    behind = placed(found, 5, t, x - h * direction, rest)[0]
    q, _, _, axes = placed(found, 5, t, x, rest)
    out = np.zeros(count)
    gather_forces(found.links, q, axes, force.copy(), out)
    work = force @ (ahead - behind) / (2.0 * h)
    assert out @ direction == pytest.approx(work, abs=2e-8)


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_rates_and_accelerations_are_derivatives(data: st.DataObject) -> None:
    found = tree(data.draw(st.sampled_from(TREES)))
    count = found.size
    draw = st.lists(numbers, min_size=count, max_size=count).map(np.array)
    x, u, u_t = data.draw(draw), data.draw(draw), data.draw(draw)
    t, h = 0.01, 1e-5
    _, v, a, axes = placed(found, 5, t, x, u)
    accelerate_links(found.links, u_t, v, axes, a)

    def at(time: float) -> tuple[Array, Array]:
        moved = x + u * time + 0.5 * u_t * time**2
        return placed(found, 5, t + time, moved, u + u_t * time)[:2]

    (ahead_q, ahead_v), (behind_q, behind_v) = at(h), at(-h)
    assert v == pytest.approx((ahead_q - behind_q) / (2.0 * h), abs=1e-5)
    assert a == pytest.approx((ahead_v - behind_v) / (2.0 * h), abs=1e-3)


def test_branches_are_carried_by_the_hinge_of_their_crank() -> None:
    linkage = branching()
    found = tree(linkage)
    count = len(found.links)
    _, v, a, axes = placed(found, 5, 0.03, np.zeros(count), np.zeros(count))
    carried = np.zeros((count, CARRIED))
    carry_branches(found.links, v, a, axes, carried)
    theta = 0.7 - 30.0 * 0.03
    # The crank turns about H; N is (0.09, 0.01) from it in the crank's frame.
    rx = 0.09 * math.cos(theta) - 0.01 * math.sin(theta)
    ry = 0.09 * math.sin(theta) + 0.01 * math.cos(theta)
    expected = [30.0 * ry, -30.0 * rx, -900.0 * rx, -900.0 * ry]
    for name, row in zip(found.names, carried, strict=True):
        hung = name in ("near", "far")
        assert row == pytest.approx(expected if hung else [0.0] * 4, abs=1e-12)


def test_forced_power_is_force_times_velocity_of_the_cranks_only() -> None:
    found = tree(branching())
    force, v = np.arange(15.0), np.arange(15.0) - 7.0
    assert forced_power(found.prescribed, v, 0.0 * v, force) == pytest.approx(
        float(force[:3] @ v[:3])
    )
