"""Open trees and bodies without freedom: topology, and jumps in time."""

import math
from itertools import combinations

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from scipy.linalg import null_space
from sub_chains import ARM, PUMP, STEPHENSON

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.topology import branches_of, prescribed_of
from presswear.physics.closed_loops import place_prescribed
from presswear.physics.constraints import constraints_of
from presswear.physics.curve_following import motion_of
from presswear.physics.prescribed import begin_motion, pack_prescribed

PRESS = Press().linkage()


def without(linkage: Linkage, *names: str) -> Linkage:
    """Return the linkage without some of its joints."""
    return linkage.changed(joints=[j for j in linkage.joints if j.name not in names])


@pytest.mark.parametrize(
    ("taken_out", "reason"),
    [
        ("", "the drives hold every body"),
        ("A", "closes a loop"),
        ("A C O7", "drive of crank 7 turns a body that is free to move"),
    ],
)
def test_a_linkage_that_is_no_tree_is_explained(taken_out, reason):
    explanation = branches_of(without(PRESS, *taken_out.split()))
    assert isinstance(explanation, str)
    assert reason in explanation


MECHANISMS = {
    **{
        name: Press(geometry=geometry).linkage()
        for name, geometry in GEOMETRIES.items()
    },
    "slider-crank": SliderCrank(slide_angle=0.0).linkage(),
    "four-bar": FOUR_BAR,
    "pump": PUMP,
    "six-bar": STEPHENSON,
    "arm": ARM,
}


@pytest.mark.parametrize("linkage", MECHANISMS.values(), ids=MECHANISMS)
def test_bodies_without_freedom_are_those_that_the_jacobian_holds(
    linkage: Linkage,
):
    """Every pair of joints opened, against the null space of all rows at an instant."""
    motion = motion_of(linkage).at(np.array([0.123]))
    moving = 0
    allowed = linkage.allowed_joints
    for names in [(), *combinations(allowed, 1), *combinations(allowed, 2)]:
        opened = without(linkage, *names)
        rows = constraints_of(opened).evaluate(
            0.123, motion.position[0], motion.velocity[0]
        )[3]
        free = np.abs(null_space(rows, rcond=1e-9)).reshape(len(linkage.bodies), -1)
        held = free.max(axis=1, initial=0.0) < 1e-9
        expected = {
            body.name for body, item in zip(linkage.bodies, held, strict=True) if item
        }
        assert prescribed_of(opened) == expected, names
        moving += len(linkage.bodies) - len(expected)
    assert moving > 0


@pytest.mark.parametrize("name", ["four-bar", "six-bar", "standard"])
def test_jumps_in_time_are_closed_as_before_or_refused(name):
    """Links that Newton's method put on their other side would be wrong without a word."""
    linkage = MECHANISMS[name]
    prescribed = pack_prescribed(
        linkage, frozenset(body.name for body in linkage.bodies)
    )
    generator = np.random.default_rng(2)
    begins = generator.uniform(0.0, 1.0, 300)
    sizes = 10.0 ** generator.uniform(-3.0, -0.3, 300)
    refused = 0
    for begin, size in zip(begins, sizes, strict=True):
        ideal = motion_of(linkage).at(linkage.period * np.array([begin, begin + size]))
        q, v, a, axes = np.zeros((4, 3 * len(linkage.bodies)))
        begin_motion(prescribed, begin * linkage.period, ideal.position[0])
        for time in ideal.time:
            place_prescribed(prescribed, time, q, v, a, axes)
        if not np.isfinite(q).all():
            refused += 1
            # Twice the longest step of a run, and more.
            assert size > 0.005
            continue
        turns = np.round((q - ideal.position[1])[2::3] / (2.0 * math.pi))
        q[2::3] -= 2.0 * math.pi * turns
        assert np.abs(q - ideal.position[1]).max() < 1e-11
    assert 0 < refused < 250
