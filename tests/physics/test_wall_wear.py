"""Wear of the walls of a guide: closed forms of a slide pressed on a wall."""

import math
from dataclasses import replace

import numpy as np
import pytest
from marks import slow
from swinging_slide import (
    AMPLITUDE,
    COEFFICIENT,
    FORCE,
    PERIOD,
    WALL,
    WIDTH,
    C,
    L,
    swinging_slide,
)

import presswear as pw
from presswear.engines.base import Plan, Start, recorder_of
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.guide_corner import WALL_BINS
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.packed import pack
from presswear.physics.wall_wear import (
    bin_centres_of,
    deposit_on_wall,
    spread_along,
    wall_volume,
    walls_of,
)
from presswear.validation.cases import finished


@pytest.mark.parametrize(
    ("engine", "within"),
    [
        (InHouse(integration_tolerance=1e-9), 1e-5),
        (ExudynTree(), 1e-5),
        (ExudynJoints(), 1e-3),
    ],
)
def test_a_constant_force_wears_both_ends_of_the_way_evenly(engine: Engine, within):
    """Each corner bears F / 2 and passes each place twice a period: h = K F / b there."""
    linkage, start = swinging_slide()
    run = finished(engine.for_cycle(PERIOD).simulate(linkage, start, Plan(PERIOD, 1)))
    left, right = walls_of(linkage, run.recorder.maps.sampled)["guide"]
    assert not right.any()
    place = bin_centres_of(WALL)
    half = 0.5 * WALL.bin_length
    off = np.abs(np.abs(place) - 0.5 * L)  # from the middles of the two worn parts
    within_way = off < AMPLITUDE - half
    assert within_way.sum() > 0.9 * 4.0 * AMPLITUDE / WALL.bin_length
    even = COEFFICIENT * FORCE / WIDTH
    # A bin holds the wear of few steps, whose ways end within 1e-3 of a bin.
    assert left[within_way] == pytest.approx(even, rel=5e-3)
    assert not left[off > AMPLITUDE + half].any()
    distance = 8.0 * AMPLITUDE  # of both corners in a period
    volume = COEFFICIENT * 0.5 * FORCE * distance
    worn = wall_volume(linkage.corners[0], left)
    assert worn == pytest.approx(volume, rel=within)
    load = sum(run.recorder.each_cycle("load_distance", k)[0] for k in range(4))
    assert worn == pytest.approx(COEFFICIENT * load, rel=1e-12)


def test_the_way_of_a_step_is_that_of_the_corner():
    """The sense of the sliding speed of each corner gives its speed along the guide."""
    linkage, start = swinging_slide()
    start = replace(start, velocity=np.array([0.0, 0.7, 0.0]))
    engine = InHouse(integration_tolerance=1e-9)
    run = engine.for_cycle(PERIOD).simulate(linkage, start, Plan(0.13 * PERIOD, 1))
    records = run.recorder.records
    speed = records.packed.joints["wall_sense"] * records.contacts["sliding"]
    assert speed == pytest.approx([run.end.velocity[1]] * 4, rel=1e-9)
    place = records.contacts["place"]
    ends = run.end.position[1] + 0.5 * L * np.array([1.0, -1.0, 1.0, -1.0])
    assert place == pytest.approx(ends, abs=1e-12)


def test_a_step_wears_the_wall_behind_the_corner():
    """A corner that moves up ends its way at its place: no bin beyond it wears.

    A full cycle wears the same bins for both signs, because its ways are symmetric.
    """
    linkage, start = swinging_slide()
    speed = 0.7
    packed = pack(linkage)
    forces = BodyForces(linkage, packed)
    forces(0.0, start.position, np.array([0.0, speed, 0.0]))
    joints = packed.joints.view(np.recarray)
    bin_length = WALL.bin_length
    bins = 20.5  # that a corner passes in the step
    step = bins * bin_length / speed
    for k, contact in enumerate(forces.contacts.view(np.recarray)):
        depth = np.zeros((4, 2, WALL_BINS))
        deposit_on_wall(depth, k, joints[k], contact, 3.0, step)
        place = bin_centres_of(WALL)[depth[k, 0] > 0.0]
        assert place.max() == pytest.approx(contact.place, abs=bin_length)
        assert place.min() == pytest.approx(
            contact.place - speed * step, abs=bin_length
        )
        partner = joints[k]["wall_partner"]
        assert not depth[:, 1].any()
        assert set(np.flatnonzero(depth.any(axis=(1, 2)))) == {k, partner}


@pytest.mark.parametrize(
    ("engine", "within"),
    [
        (InHouse(integration_tolerance=1e-9), 2e-3),
        (ExudynTree(), 2e-3),
        slow(ExudynJoints(), 1e-2),
    ],
)
def test_the_slide_sinks_into_the_wall_that_it_wears(engine: Engine, within):
    """Each of four cycles stands for 5: the depth is the wear rate times 20 cycles."""
    linkage, start = swinging_slide()
    speed = 2.0 * math.pi / PERIOD * AMPLITUDE
    start = Start(start.position * [1.0, 0.0, 1.0], np.array([0.0, speed, 0.0]))
    share, cycles = 5.0, 4
    plan = Plan(PERIOD, cycles, wear=lambda cycle, added, depth: share * added)
    run = finished(engine.for_cycle(PERIOD).simulate(linkage, start, plan))
    left, right = walls_of(linkage, run.recorder.surface_depth)["guide"]
    assert not right.any()
    loads = [run.recorder.each_cycle("load_distance", k).sum() for k in range(4)]
    volume = wall_volume(linkage.corners[0], left)
    assert volume == pytest.approx(share * COEFFICIENT * sum(loads), rel=1e-12)
    off = np.abs(np.abs(bin_centres_of(WALL)) - 0.5 * L)
    wanted = share * cycles * COEFFICIENT * FORCE / WIDTH
    assert left[off < 0.9 * AMPLITUDE].mean() == pytest.approx(wanted, rel=within)
    # The slide swings about the wall that three cycles have worn.
    time, away = (
        run.recorder.series(*one) for one in (("time",), ("eccentricity_x", 0))
    )
    last = time > 3.0 * PERIOD
    mean = np.trapezoid(-away[last], time[last]) / np.ptp(time[last])
    sink = -start.position[0] - C
    assert mean - C - sink == pytest.approx(0.75 * wanted, rel=0.05)


@pytest.mark.parametrize(
    ("start", "end", "parts"),
    [
        (1.25, 3.5, {1: 0.75, 2: 1.0, 3: 0.5}),
        (3.5, 1.25, {1: 0.75, 2: 1.0, 3: 0.5}),
        (2.25, 2.5, {2: 1.0}),
        (2.0, 2.0, {2: 1.0}),
        (-3.0, -1.0, {0: 1.0}),
        (7.0, 9.0, {4: 1.0}),
        (3.5, 8.0, {3: 0.5, 4: 1.0}),
    ],
)
def test_a_depth_is_spread_over_the_bins_of_a_way(start, end, parts):
    depth = np.zeros(5)
    spread_along(depth, start, end, 6.0)
    wanted = np.zeros(5)
    for k, part in parts.items():
        wanted[k] = 6.0 * part / sum(parts.values())
    assert depth == pytest.approx(wanted, rel=1e-14)


def test_walls_without_wear_or_clearance_have_no_map():
    press = pw.scenes.press_off_centre()
    materials = replace(press.bearings.materials, wear_coefficient=0.0)
    hard = replace(press, bearings=replace(press.bearings, materials=materials))
    for scene in (hard, pw.scenes.wear_times()):
        linkage = scene.linkage()
        bodies = np.zeros(3 * len(linkage.bodies))
        recorder = recorder_of(linkage, Start(bodies, bodies), Plan(1.0, 1))
        assert not walls_of(linkage, recorder.records.depth)
        assert not linkage.worn_guides
        assert not scene.worn_guides
