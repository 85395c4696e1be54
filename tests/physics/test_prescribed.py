"""Bodies without freedom: which they are, how they move, and what their drives must do."""

import math
from itertools import combinations

import numpy as np
import pytest
from branches import without
from numpy.typing import NDArray
from scipy.linalg import null_space
from sub_chains import ARM, PUMP, STEPHENSON

from presswear.linkage.linkage import Linkage, prescribed_of
from presswear.linkage.mechanisms import FOUR_BAR, GEOMETRIES, Press, SliderCrank
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
)

Array = NDArray[np.float64]

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
    for names in [(), *combinations(linkage.openable, 1), *combinations(linkage.openable, 2)]:
        opened = without(linkage, *names)
        rows = constraints_of(opened).evaluate(0.123, motion.position[0], motion.velocity[0])[3]
        free = np.abs(null_space(rows, rcond=1e-9)).reshape(len(linkage.bodies), -1)
        held = free.max(axis=1, initial=0.0) < 1e-9
        expected = {body.name for body, item in zip(linkage.bodies, held, strict=True) if item}
        assert prescribed_of(opened) == expected, names
        moving += len(linkage.bodies) - len(expected)
    assert moving > 0


def followed(prescribed: Prescribed, motion: Motion) -> list[Array]:
    """q, v and a of all bodies at the times of a motion, from its first place on."""
    levels: list[list[Array]] = [[], [], []]
    count = motion.position.shape[1]
    q, v, a, axes = np.zeros((4, count))
    begin_motion(prescribed, float(motion.time[0]), motion.position[0])
    for time in motion.time:
        place_prescribed(prescribed, float(time), q, v, a, axes)
        for level, item in zip(levels, (q, v, a), strict=True):
            level.append(item.copy())
    return [np.array(level) for level in levels]


def times_of(linkage: Linkage) -> Array:
    """Forwards and back over a cycle, in steps up to that of a run, and standing still."""
    steps = np.random.default_rng(1).uniform(-0.001, 0.002, 2000)
    steps[::7] *= 1e-4
    steps[::11] = 0.0
    return np.cumsum(steps) * linkage.period


@each_mechanism
def test_a_linkage_without_freedom_follows_its_ideal_motion(linkage: Linkage) -> None:
    everything = frozenset(body.name for body in linkage.bodies)
    ideal = motion_of(linkage).at(times_of(linkage))
    q, v, a = followed(pack_prescribed(linkage, everything), ideal)
    assert np.abs(q - ideal.position).max() < 1e-12
    for item, exact in ((v, ideal.velocity), (a, ideal.acceleration)):
        assert np.abs(item - exact).max() < 1e-10 * np.abs(exact).max()


@each_mechanism
def test_torques_are_the_multipliers_of_the_drives(linkage: Linkage) -> None:
    """Forces on every body against all rows at once, M a + J^T lambda = g."""
    prescribed = pack_prescribed(linkage, prescribed_of(linkage))
    ideal = motion_of(linkage).at(np.array([0.31 * linkage.period]))
    q, v, a, axes = np.zeros((4, 3 * len(linkage.bodies)))
    begin_motion(prescribed, float(ideal.time[0]), ideal.position[0])
    place_prescribed(prescribed, float(ideal.time[0]), q, v, a, axes)
    applied = np.random.default_rng(4).normal(size=q.size)
    jacobian = constraints_of(linkage).evaluate(float(ideal.time[0]), q, v)[3]
    multipliers = np.linalg.solve(jacobian.T, applied - mass_of(linkage) * a)
    expected = -multipliers[-len(linkage.drives) :]
    torque = np.zeros(len(linkage.drives))
    force = applied.copy()
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
    everything = frozenset(body.name for body in linkage.bodies)
    prescribed = pack_prescribed(linkage, everything)
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
