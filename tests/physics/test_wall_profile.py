"""Worn walls of a guide: closed forms of a slide that rests on a wall or runs along it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from swinging_slide import (
    AMPLITUDE,
    FORCE,
    PERIOD,
    WALL,
    C,
    swinging_slide,
)

import presswear as pw
from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.guide_corner import WALL_BINS, WallMap
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface
from presswear.physics.packed import pack
from presswear.physics.wall_wear import bin_centres_of, wall_profile
from presswear.tools.arrays import Array
from presswear.validation.cases import finished

WEDGE = 20e-6  # slope of a wall
ENGINES = [InHouse(integration_tolerance=1e-9), ExudynTree(), ExudynJoints()]


def on_wall(depth: Array) -> tuple[Linkage, float]:
    """Return the swinging slide with a worn left wall, and half the force over the stiffness."""
    linkage, _ = swinging_slide()
    corners = tuple(
        replace(
            corner, bearing_surface=Surface(depth) if corner.side > 0.0 else Surface()
        )
        for corner in linkage.corners
    )
    sink = 0.5 * FORCE / corners[0].normal.stiffness
    return replace(linkage, clearances=corners), sink


def wedge(place: Array) -> Array:
    """Return the depth of a wall with a constant slope, m."""
    return WEDGE * (place - WALL.start)


@pytest.mark.parametrize("engine", ENGINES, ids=lambda one: one.word)
def test_a_slide_follows_a_wall_with_a_constant_slope(engine: Engine):
    """Both corners of a side touch, so that the tilt is that of the wall at every place."""
    linkage, sink = on_wall(wedge(bin_centres_of(WALL)))

    def across(along: float) -> float:
        return -C - sink - float(wedge(np.array(along)))

    start = Start(np.array([across(AMPLITUDE), AMPLITUDE, WEDGE]), np.zeros(3))
    run = finished(
        engine.for_cycle(PERIOD).simulate(linkage, start, Plan(0.5 * PERIOD, 1))
    )
    x, y, tilt = run.end.position
    assert y == pytest.approx(-AMPLITUDE, abs=1e-6)
    assert x == pytest.approx(across(y), abs=1e-9)
    assert tilt == pytest.approx(WEDGE, rel=1e-3)


def test_a_flat_map_changes_no_digit():
    """A run whose walls may wear has a map of depth 0, and the same numbers as without one."""
    linkage, start = swinging_slide()
    engine = InHouse().for_cycle(PERIOD)
    plan = Plan(PERIOD, 1)
    flat = engine.simulate(linkage, start, plan)
    wearing = replace(plan, wear=lambda cycle, added, depth: np.zeros_like(added))
    worn = engine.simulate(linkage, start, wearing)
    assert np.array_equal(flat.end.position, worn.end.position)
    assert np.array_equal(flat.recorder.rows, worn.recorder.rows)
    assert flat.diagnostics["steps"] == worn.diagnostics["steps"]


def test_the_profile_of_a_wall_is_smooth_and_flat_beyond_its_ends():
    place = bin_centres_of(WALL)
    linkage, _ = on_wall(1e-5 * np.exp(-((place / 0.03) ** 2)))
    packed = pack(linkage)
    joint, surfaces = packed.joints[0], packed.surfaces[0]
    assert joint["surface_bins"] == WALL_BINS
    for s in (-0.2, -0.0312, 0.01, 0.0571):
        depth, slope, _ = wall_profile(joint, surfaces, s)
        wanted = 1e-5 * math.exp(-((s / 0.03) ** 2))
        assert depth == pytest.approx(wanted, abs=1e-10)
        assert slope == pytest.approx(-2.0 * s / 0.03**2 * wanted, abs=2e-7)
    for s, k in ((WALL.start - 1.0, 0), (WALL.start + WALL.length + 1.0, -1)):
        depth = float(linkage.corners[0].bearing_surface.depth[k])
        assert wall_profile(joint, surfaces, s) == (depth, 0.0, 0.0)
    assert wall_profile(joint, surfaces, math.nan)[1:] == (0.0, 0.0)


def test_the_walls_of_a_scene_are_the_surfaces_of_its_guide():
    scene = pw.scenes.press_off_centre()
    left, right = Surface(np.full(WALL_BINS, 1e-6)), Surface()
    for corner in scene.linkage({"guide": (left, right)}).corners:
        assert corner.bearing_surface == (left if corner.side > 0.0 else right)
        assert isinstance(corner.wall, WallMap)
        assert corner.bins == WALL_BINS
        assert not corner.pin_surface.is_worn
