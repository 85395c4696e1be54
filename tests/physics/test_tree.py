"""Open trees and bodies without freedom: topology, motion, and forces by virtual work."""

import math
from itertools import combinations

import numpy as np
import pytest
from branches import branching, placed, tree, without
from four_bar_linkage import FOUR_BAR
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import null_space
from sub_chains import ARM, PUMP, STEPHENSON

from presswear.linkage.linkage import Linkage, prescribed_of
from presswear.linkage.mechanisms import GEOMETRIES, Press, SliderCrank
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import Motion, motion_of
from presswear.physics.packed import mass_of
from presswear.physics.prescribed import (
    Prescribed,
    begin_motion,
    drive_torques,
    forced_power,
    pack_prescribed,
    place_prescribed,
    subtract_inertia,
    tree_of,
)
from presswear.physics.tree import (
    ARTICULATED,
    CARRIED,
    accelerate_links,
    articulate,
    carry_branches,
    gather_forces,
    release,
)
from presswear.tools.arrays import Array

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


MECHANISMS = {
    **{name: Press(geometry=geometry).linkage() for name, geometry in GEOMETRIES.items()},
    "slider-crank": SliderCrank().linkage(),
    "four-bar": FOUR_BAR,
    "pump": PUMP,
    "six-bar": STEPHENSON,
    "arm": ARM,
}
each_mechanism = pytest.mark.parametrize("linkage", MECHANISMS.values(), ids=MECHANISMS)


@each_mechanism
def test_bodies_without_freedom_are_those_that_the_jacobian_holds(linkage: Linkage) -> None:
    """Every pair of joints opened, against the null space of all rows at an instant."""
    motion = motion_of(linkage).at(np.array([0.123]))
    moving = 0
    allowed = linkage.allowed_joints
    for names in [(), *combinations(allowed, 1), *combinations(allowed, 2)]:
        opened = without(linkage, *names)
        rows = constraints_of(opened).evaluate(0.123, motion.position[0], motion.velocity[0])[3]
        free = np.abs(null_space(rows, rcond=1e-9)).reshape(len(linkage.bodies), -1)
        held = free.max(axis=1, initial=0.0) < 1e-9
        expected = {body.name for body, item in zip(linkage.bodies, held, strict=True) if item}
        assert prescribed_of(opened) == expected, names
        moving += len(linkage.bodies) - len(expected)
    assert moving > 0


def followed(prescribed: Prescribed, motion: Motion) -> Array:
    """q, v and a of all bodies at the times of a motion, from its first place on."""
    levels = np.zeros((len(motion.time), 3, motion.position.shape[1]))
    axes = np.zeros(motion.position.shape[1])
    begin_motion(prescribed, float(motion.time[0]), motion.position[0])
    for time, (q, v, a) in zip(motion.time, levels, strict=True):
        place_prescribed(prescribed, float(time), q, v, a, axes)
    return levels.transpose(1, 0, 2)


@each_mechanism
def test_a_linkage_without_freedom_follows_its_ideal_motion(linkage: Linkage) -> None:
    """Forwards and back over a cycle, in steps up to that of a run, and standing still."""
    steps = np.random.default_rng(1).uniform(-0.001, 0.002, 2000)
    steps[::7] *= 1e-4
    steps[::11] = 0.0
    ideal = motion_of(linkage).at(np.cumsum(steps) * linkage.period)
    everything = frozenset(body.name for body in linkage.bodies)
    q, v, a = followed(pack_prescribed(linkage, everything), ideal)
    assert np.abs(q - ideal.position).max() < 1e-12
    for item, exact in ((v, ideal.velocity), (a, ideal.acceleration)):
        assert np.abs(item - exact).max() < 1e-10 * np.abs(exact).max()


@each_mechanism
def test_torques_are_the_multipliers_of_the_drives(linkage: Linkage) -> None:
    """Forces on every body against all rows at once, M a + J^T lambda = g."""
    prescribed = pack_prescribed(linkage, prescribed_of(linkage))
    time = 0.31 * linkage.period
    ideal = motion_of(linkage).at(np.array([time]))
    q, v, a, axes = np.zeros((4, 3 * len(linkage.bodies)))
    begin_motion(prescribed, time, ideal.position[0])
    place_prescribed(prescribed, time, q, v, a, axes)
    applied = np.random.default_rng(4).normal(size=q.size)
    jacobian = constraints_of(linkage).evaluate(time, q, v)[3]
    multipliers = np.linalg.solve(jacobian.T, applied - mass_of(linkage) * a)
    expected = -multipliers[-len(linkage.drives) :]
    torque, force = np.zeros(len(linkage.drives)), applied.copy()
    subtract_inertia(prescribed.parts, a, force)
    drive_torques(prescribed, q, axes, force, torque)
    assert torque == pytest.approx(expected, rel=1e-10)
    # All the power of the drives goes into the bodies.
    speeds = np.array([drive.motion(ideal.time)[1][0] for drive in linkage.drives])
    assert -forced_power(prescribed, v, a, applied) == pytest.approx(torque @ speeds, rel=1e-9)


@pytest.mark.parametrize("name", ["four-bar", "six-bar", "standard"])
def test_jumps_in_time_are_closed_as_before_or_refused(name: str) -> None:
    """Links that Newton's method put on their other side would be wrong without a word."""
    linkage = MECHANISMS[name]
    prescribed = pack_prescribed(linkage, frozenset(body.name for body in linkage.bodies))
    generator = np.random.default_rng(2)
    begins, sizes = generator.uniform(0.0, 1.0, 300), 10.0 ** generator.uniform(-3.0, -0.3, 300)
    refused = 0
    for begin, size in zip(begins, sizes, strict=True):
        ideal = motion_of(linkage).at(linkage.period * np.array([begin, begin + size]))
        q = followed(prescribed, ideal)[0][1]
        if not np.isfinite(q).all():
            refused += 1
            # Twice the longest step of a run, and more.
            assert size > 0.005
            continue
        turns = np.round((q - ideal.position[1])[2::3] / (2.0 * math.pi))
        q[2::3] -= 2.0 * math.pi * turns
        assert np.abs(q - ideal.position[1]).max() < 1e-11
    assert 0 < refused < 250
