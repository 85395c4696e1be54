"""Wear of a scotch yoke coupled with its motion (Blanchet 1997), derived from Archard's law.

A block on a crank of radius r moves a yoke of mass m by x = r cos wt and slides by
y = r sin wt along the slot, so that the depth of a wall grows in each pass by F / b times
K_d at every place, whatever the speed is. Under inertia alone F = m w^2 sqrt(r^2 - y^2).
Wear h shortens the stroke of a pin in a slot, and the force with it: dh/dN = k m w^2
(r - h) in the middle, with k = K_d / b, hence h = r (1 - exp(-k m w^2 N)). This needs wear
of the size of the crank. A spring of rate c with the preload Q couples them at small wear:
dh/dN = k (Q - c h), as the force of both passes of a turn is Q - c h in the mean.

Here two corners of a block of the length L, longer than 2 r, bear the force, each a half.
"""

import math
from typing import Any

import numpy as np
import pytest

import presswear as pw
from presswear.linkage import Materials
from presswear.linkage.guide_corner import WALL_BINS
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface
from presswear.tools.arrays import Array

RADIUS = 0.01  # of the crank, m
LENGTH = 0.06  # of the block, m
SLOT = 0.04  # width of the slot, m
WIDTH = 0.02  # of the contact, b, m
COEFFICIENT = 1e-13  # K_d, 1/Pa
RATE = COEFFICIENT / WIDTH  # k, m of depth for 1 N in a pass
FAR = 5.0  # length of the spring, m
STIFFNESS, PRELOAD = 1e6, 100.0  # c, N/m, and Q, N
CLEARANCE = 0.05e-3  # of the preloaded yoke, m


def _yoke(mass: float, speed: float, **more: Any) -> Linkage:
    """Return a scotch yoke whose block may tilt in its slot."""
    slot = pw.Guide(
        "slot",
        "block",
        direction=0.5 * math.pi,
        on="yoke",
        length=LENGTH,
        width=SLOT,
    )
    return pw.assemble(
        bodies=[
            pw.Bar("crank", RADIUS, 1.0),
            pw.Body("block", 0.05, 1e-4),
            pw.Body("yoke", mass),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "block"),
            pw.Guide("ways", "yoke"),
            slot,
        ],
        drives=[pw.Drive("crank", speed)],
        output="yoke",
        gravity=0.0,
        name="scotch yoke",
        **more,
    )


def _wear_per_turn(
    linkage: Linkage, clearance: float, cycles: int, **more: Any
) -> tuple[Array, Array]:
    """Return places along the slot, m, and the depth per turn of both walls there, m."""
    bearing = pw.Bearing(
        clearance=clearance,
        width=WIDTH,
        friction=0.0,
        restitution=0.02,
        materials=Materials(wear_coefficient=COEFFICIENT),
    )
    scene = pw.Scene(
        linkage,
        joints="slot",
        bearings={"slot": bearing},
        wear_updates=0,
        cycles=cycles,
        replicates=1,
        engine="dae",
        **more,
    )
    return pw.run(scene).stages[0].wall_wear("slot")


@pytest.mark.parametrize(("clearance", "within"), [(2e-6, 5e-4), (10e-6, 2e-3)])
def test_wear_under_the_inertia_of_the_yoke(clearance, within):
    """A wall loses V = K_d m w^2 pi r^2 / 2 in a turn, as deep as F / 2 presses it.

    Where the force changes its sign the block crosses the clearance in a short flight,
    but there it does not slide.
    """
    mass, speed = 2.0, 100.0
    place, depth = _wear_per_turn(_yoke(mass, speed), clearance, cycles=12)
    force = mass * speed**2  # over the arm of the crank, N/m
    volume = WIDTH * (place[1] - place[0]) * depth.sum(axis=1)
    expected = COEFFICIENT * force * math.pi * RADIUS**2 / 2.0
    assert volume == pytest.approx([expected, expected], rel=within)
    for corner in (-0.5 * LENGTH, 0.5 * LENGTH):
        across = place - corner
        swept = np.abs(across) < 0.8 * RADIUS
        arm = np.sqrt(RADIUS**2 - across[swept] ** 2)
        profile = depth[:, swept] / (0.5 * RATE * force * arm)
        assert profile.mean(axis=1) == pytest.approx([1.0, 1.0], abs=2e-3)


@pytest.mark.parametrize(("worn", "tuned"), [(0.0, 1.0), (20e-6, 0.995), (50e-6, 1.0)])
def test_wear_relieves_the_load_that_causes_it(worn, tuned):
    """dh/dN = k (Q - c h): the two passes of a turn over a place have Q - c h in the mean.

    With m w^2 = c, spring and inertia cancel, and each pass has it.
    """
    speed = 200.0
    mass = tuned * STIFFNESS / speed**2
    free_length = FAR + PRELOAD / STIFFNESS + CLEARANCE
    spring = pw.Spring("load", (-FAR, 0.0), "yoke", STIFFNESS, free_length)
    walls = Surface(np.full(WALL_BINS, worn)), Surface(np.zeros(WALL_BINS))
    surfaces = {"slot": walls} if worn > 0.0 else {}
    linkage = _yoke(mass, speed, springs=[spring])
    place, (left, right) = _wear_per_turn(linkage, CLEARANCE, 20, surfaces=surfaces)
    assert not right.any()
    swept = np.abs(np.abs(place) - 0.5 * LENGTH) < 0.8 * RADIUS
    expected = RATE * (PRELOAD - STIFFNESS * worn)
    assert left[swept].mean() == pytest.approx(expected, rel=1e-3)
