"""Guides with clearance on moving bodies: walls that move and turn, in every engine.

Reference values are closed forms in the frame of the walls, and the integration of the
equations there.
"""

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from marks import slow, slow_in
from runs import compare_engines, momenta, residual, run_scene, simulated, touches
from scipy.integrate import solve_ivp
from slotted import (
    scotch_yoke,
    shaper,
    sized,
    skew_quick_return,
    slotted_crank,
    swinging_block,
)
from two_bodies import contacts_in

import presswear as pw
from presswear.engines.base import Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.guide_corner import WallMap
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface
from presswear.physics.contact import corner_acceleration
from presswear.physics.packed import pack
from presswear.physics.wall_wear import bin_centres_of
from presswear.tools.arrays import Array
from presswear.tools.compile import Records

L, W, C = 0.06, 0.04, 0.2e-3  # of the block and its slot, m
MASS = 0.5  # of the block, kg
INERTIA = MASS * (L**2 + W**2) / 12.0
STIFFNESS = 2e8  # of a corner, N/m
HEAVY = 1e12  # inertia of a disc that no block turns, kg m^2
TURN = 30.0  # of the disc, rad/s
FIRST = 0.1  # initial position of a block in its slot, m
DURATION = 0.04  # s
STIFF = 100.0 * STIFFNESS
WALL = WallMap(2e-13, 0.05, 0.2)
FINE = InHouse(integrator="dop853", integration_tolerance=1e-12)
ENGINES: list[tuple[Engine, float]] = [
    (FINE, 1e-9),
    (ExudynTree(tree_tolerance=1e-11), 1e-9),
    (ExudynJoints(steps_per_contact=200, free_steps=10_000), 1e-6),
]
PLAY: dict[str, Any] = {"clearance": C, "contact_stiffness": STIFFNESS, "exponent": 1.0}
SCENES = {
    "Scotch yoke": (scotch_yoke(), "slot"),
    "quick return": (skew_quick_return(), "slot"),
    "swinging block": (swinging_block(), "bore"),
    "slotted crank": (slotted_crank(), "slot"),
    "shaper, a loop is left": (shaper(), "slot"),
}


def scene_of(name: str, **bearing: Any) -> pw.Scene:
    """Return a mechanism whose slot has clearance."""
    mechanism, slot = SCENES[name]
    return pw.Scene(
        sized(mechanism, slot, L, W),
        joints=slot,
        bearings=pw.Bearing(**(PLAY | bearing)),
        wear_updates=0,
        replicates=1,
    )


# A slot on a crank, as the Scotch yoke has, and a bore that runs without loss, too.
SLOW = ("quick return", "slotted crank")
NAMES = slow_in(SLOW, SCENES)


@pytest.mark.parametrize("name", [NAMES[0], slow("swinging block"), NAMES[4]])
def test_engines_agree_and_keep_the_energy(name):
    """With friction and damping, over more than 8 touches of the corners."""
    scene = scene_of(name, friction=0.05, restitution=0.8)
    finer = ExudynJoints(steps_per_contact=200, free_steps=20_000)
    *runs, _ = compare_engines(scene, 0.02, finer, joints=(1e-5, 1e-6, 3e-5))
    counts = [[len(run.recorder.stored_contacts(k)) for k in range(4)] for run in runs]
    assert sum(counts[0]) > 8
    assert all(each == counts[0] for each in counts)


def on_disc(direction: float = 0.0, **bearing: Any) -> Linkage:
    """Return a heavy disc about the origin, with a block in a slot beside its middle."""
    linkage = pw.assemble(
        [pw.Body("disc", 1.0, HEAVY), pw.Body("block", MASS, INERTIA)],
        [
            pw.Pin("O", (0.0, 0.0), "disc"),
            pw.Guide("slot", "block", 0.0, 0.0, direction, on="disc"),
        ],
        output="block",
        gravity=0.0,
        cycle=0.1,
    )
    play = pw.Bearing(**(PLAY | {"friction": 0.0} | bearing))
    return pw.Scene(sized(linkage, "slot", L, W), bearings={"slot": play}).linkage()


def across(vector: Array) -> Array:
    """Turn a vector by a right angle."""
    return np.array([-vector[1], vector[0]])


def from_disc(linkage: Linkage, place: Array, rates: Array, angle: float) -> Start:
    """Return the start of a block from place and rates in the frame of the turning disc."""
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    velocity = turn @ (rates[:2] + TURN * across(place[:2]))
    position = np.array([0.0, 0.0, angle, *(turn @ place[:2]), angle + place[2]])
    spins = np.array([0.0, 0.0, TURN, *velocity, TURN + rates[2]])
    return Start(position, spins)


def in_disc(run: Run) -> Array:
    """Return place and tilt of the block at the end in the frame of the disc."""
    _, _, angle, x, y, block = run.end.position
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * x + s * y, c * y - s * x, block - angle])


@cache
def turning_evenly(engine: Engine) -> tuple[Linkage, Run]:
    """Run a block that goes out in a slot of the disc, with one face on a wall."""
    linkage = on_disc(
        normal_law="kelvin-voigt", viscous_damping=1e4, contact_stiffness=STIFF
    )
    corners = tuple(replace(corner, wall=WALL) for corner in linkage.corners)
    linkage = replace(linkage, clearances=corners)
    still = 0.5 * MASS * TURN**2 * C / STIFF  # penetration by the centrifugal force
    place = np.array([FIRST, -C - still, 0.0])
    start = from_disc(linkage, place, np.zeros(3), 0.3)
    return linkage, simulated(engine, linkage, start, DURATION)


# The other tests of walls that turn run in the tree, too.
TURNING = pytest.mark.parametrize(
    ("engine", "within"), [ENGINES[0], slow(*ENGINES[1]), ENGINES[2]]
)


@TURNING
def test_a_block_in_a_slot_that_turns_evenly(engine: Engine, within):
    """The block goes out by cosh and presses by the force of Coriolis, 2 m W^2 r sinh."""
    _, run = turning_evenly(engine)
    x, y, tilt = in_disc(run)
    phase = TURN * DURATION
    assert x == pytest.approx(FIRST * math.cosh(phase), rel=1e-6)
    force = 2.0 * MASS * TURN**2 * FIRST * math.sinh(phase)
    force += MASS * TURN**2 * C
    forces = run.recorder.records.contacts["normal"]
    assert forces[2:] == pytest.approx([0.5 * force] * 2, rel=1e-5)
    assert list(forces[:2]) == [0.0, 0.0]
    assert y == pytest.approx(-C - 0.5 * force / STIFF, abs=1e-12)
    assert abs(tilt) < within


def relative_rates(_: float, state: Array) -> Array:
    """Return the rates of place and tilt of the block in the frame of the disc."""
    x, y, tilt, vx, vy, spin = state
    c, s = math.cos(tilt), math.sin(tilt)
    force = np.array([0.0, 0.0, 0.0])
    for along in (0.5 * L, -0.5 * L):
        for side in (1.0, -1.0):
            arm_x = c * along - s * 0.5 * side * W
            arm_y = s * along + c * 0.5 * side * W
            depth = side * (y + arm_y) - (0.5 * W + C)
            normal = 1e10 * max(depth, 0.0) ** 1.5
            contact = arm_x, -side * normal
            force += [0.0, contact[1], contact[0] * contact[1]]
    acceleration = force / [MASS, MASS, INERTIA]
    acceleration[0] += TURN**2 * x + 2.0 * TURN * vy
    acceleration[1] += TURN**2 * y - 2.0 * TURN * vx
    return np.array([vx, vy, spin, *acceleration])


@pytest.mark.parametrize(("engine", "within"), ENGINES)
def test_walls_that_turn_are_those_of_a_turning_frame(engine: Engine, within):
    """A block that tilts and rattles between walls without friction and damping."""
    linkage = on_disc(restitution=1.0, contact_stiffness=1e10, exponent=1.5)
    place = np.array([0.1, 0.05e-3, 1e-3])
    rates = np.array([-1.0, 0.2, 3.0])
    duration = 0.02
    start = from_disc(linkage, place, rates, 0.7)
    run = simulated(engine, linkage, start, duration)
    counts = [len(run.recorder.stored_contacts(k)) for k in range(4)]
    assert sum(counts) > 8
    assert min(counts[0] + counts[1], counts[2] + counts[3]) > 1
    exact = solve_ivp(
        relative_rates,
        (0.0, duration),
        np.concatenate([place, rates]),
        "DOP853",
        rtol=1e-12,
        atol=1e-14,
        max_step=1e-5,
    ).y[:, -1]
    assert in_disc(run)[:2] == pytest.approx(exact[:2], abs=10.0 * within)
    assert in_disc(run)[2] == pytest.approx(exact[2], abs=500.0 * within)


@pytest.mark.parametrize(("engine", "within"), ENGINES[::2])
def test_both_bodies_together_keep_their_momentum(engine: Engine, within):
    """Two free bodies with friction and damping: forces and moments are equal and opposite."""
    linkage = pw.assemble(
        [pw.Body("carrier", 2.0, 0.02), pw.Body("block", MASS, INERTIA)],
        [pw.Guide("slot", "block", 0.03, -0.02, 0.4, 0.1, on="carrier")],
        output="block",
        gravity=0.0,
        cycle=0.1,
    )
    play = pw.Bearing(**(PLAY | {"friction": 0.2, "restitution": 0.5}))
    linkage = pw.Scene(sized(linkage, "slot", L, W), bearings={"slot": play}).linkage()
    turned = 0.8  # of the carrier
    c, s = math.cos(turned), math.sin(turned)
    x, y = 0.03 + 0.05 * math.cos(0.4), -0.02 + 0.05 * math.sin(0.4)
    block = [c * x - s * y, s * x + c * y, turned + 0.1]
    start = Start(
        np.array([0.0, 0.0, turned, *block]),
        np.array([0.1, -0.2, 3.0, -0.4, 0.3, -2.0]),
    )
    run = simulated(engine, linkage, start, 0.02)
    assert touches(run) > 5
    before, after = (momenta(linkage, state) for state in (start, run.end))
    change = np.abs(run.end.velocity - start.velocity)
    assert change.min() > 1e-3
    assert after == pytest.approx(before, abs=10.0 * within)


@pytest.mark.parametrize("clearance", [1e-5, 1e-7])
@pytest.mark.parametrize("name", NAMES[:2] + NAMES[3:4])
def test_a_slot_with_a_vanishing_clearance_is_ideal(name, clearance):
    """All bodies leave their ideal places by a few clearances and contacts."""
    scene = scene_of(name, clearance=clearance, restitution=0.1, contact_stiffness=1e10)
    duration = 0.4 * scene.mechanism.period
    run = run_scene(scene, InHouse(), duration)
    assert touches(run) > 4
    ideal = scene.ideal.at(np.array([duration])).position[0]
    off = np.abs(run.end.position - ideal).reshape(-1, 3)
    forces = run.recorder.records.contacts["normal"]
    play = clearance + forces.max() / 1e10
    assert off[:, :2].max() < 4.0 * play
    assert off[:, 2].max() < 2.0 * play / (0.5 * L)


@pytest.mark.parametrize("name", [slow("Scotch yoke"), *NAMES[1:]])
def test_no_energy_is_lost_without_friction_and_damping(name):
    scene = scene_of(name, friction=0.0, restitution=1.0)
    run = run_scene(scene, FINE, 0.5 * scene.mechanism.period)
    assert touches(run) > 40
    assert residual(run) < 1e-9
    assert float(run.diagnostics["contact_loss_J"]) == 0.0


@pytest.mark.slow
def test_energy_is_conserved_over_200_turns_of_a_crank():
    scene = scene_of("quick return", friction=0.0, restitution=1.0)
    run = run_scene(scene, FINE, 200.0 * scene.mechanism.period)
    assert residual(run) < 1e-9


@pytest.mark.parametrize(
    ("engine", "within"),
    [
        (InHouse(integration_tolerance=1e-10), 1e-7),
        slow(ExudynTree(tree_tolerance=1e-10), 1e-7),
        slow(ExudynJoints(), 1e-5),
    ],
)
def test_worn_walls_that_move_create_no_energy(engine: Engine, within):
    """Waves of 10 um over 20 mm along both walls, without friction and damping."""
    scene = scene_of("quick return", friction=0.0, restitution=1.0)
    wall = scene.linkage().corners[0].wall
    assert wall is not None
    waves = np.cos(2.0 * math.pi * bin_centres_of(wall) / 0.02)
    worn = {"slot": (Surface(5e-6 * (1.0 + waves)), Surface(5e-6 * (1.0 - waves)))}
    run = run_scene(scene, engine, 0.05, linkage=scene.linkage(worn))
    assert touches(run) > 8
    assert residual(run) < within


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_speeds_of_a_corner_are_those_of_both_bodies_at_the_contact(side):
    """Difference of the velocities of the block and of the wall at the point of contact."""
    linkage = on_disc(0.4)
    turned = 0.7  # of the disc
    c, s = math.cos(0.4 + turned), math.sin(0.4 + turned)
    normal = side * np.array([-s, c])
    centre = np.array([0.1 * c, 0.1 * s]) + 1.5 * C * normal
    q = np.array([0.0, 0.0, turned, *centre, turned + 1e-3])
    v = np.array([0.3, -0.4, 20.0, 1.1, -0.7, 25.0])
    contacts = contacts_in(linkage, pack(linkage), q, v)
    closed = contacts[contacts.penetration > 0.0]
    assert len(closed) == 2
    for contact in closed:
        arm = np.array([contact.pin_lever_x, contact.pin_lever_y])
        point = centre + arm - 0.5 * contact.penetration * normal
        disc, block = (
            v[i : i + 2] + v[i + 2] * across(point - q[i : i + 2]) for i in (0, 3)
        )
        assert contact.rate == pytest.approx(normal @ (block - disc), rel=1e-9)
        sliding = across(normal) @ (block - disc)
        assert contact.sliding == pytest.approx(sliding, rel=1e-9)


def test_the_rate_of_a_corner_is_a_derivative():
    """First and second derivative of the penetration, with a worn wall and two spins."""
    linkage = on_disc(0.4)
    place = bin_centres_of(WALL)
    worn = Surface(2e-6 * (1.0 + np.cos(2.0 * math.pi * place / 0.05)))
    corners = tuple(
        replace(corner, wall=WALL, bearing_surface=worn) for corner in linkage.corners
    )
    linkage = replace(linkage, clearances=corners)
    packed = pack(linkage)
    turned = 0.7  # of the disc, whose centre lies beside the origin
    x = 0.02 + 0.1 * math.cos(0.4 + turned)
    y = -0.01 + 0.1 * math.sin(0.4 + turned)
    start = np.array([0.02, -0.01, turned, x, y, turned + 1e-3])
    rates = np.array([0.3, -0.4, 20.0, 1.1, -0.7, 25.0])
    a = np.array([30.0, -20.0, 200.0, 50.0, 80.0, -300.0])

    def contacts(time: float) -> Records:
        q = start + time * rates + 0.5 * time**2 * a
        return contacts_in(linkage, packed, q, rates + time * a)

    h = 1e-6
    before, now, after = (contacts(time) for time in (-h, 0.0, h))
    for k in range(4):
        depths = before[k].penetration, after[k].penetration
        rate = (depths[1] - depths[0]) / (2.0 * h)
        assert now[k].rate == pytest.approx(rate, rel=1e-7)
        acceleration = corner_acceleration(
            packed.joints[k], packed.surfaces[k], now[k], a
        )
        change = (after[k].rate - before[k].rate) / (2.0 * h)
        assert acceleration == pytest.approx(change, rel=1e-6)
