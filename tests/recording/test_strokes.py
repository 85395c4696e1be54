"""Lowest place in a step, and one bottom of each stroke, wherever cycles end."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, recorder_of
from presswear.physics.dead_centre import bottom_of
from presswear.recording.columns import BOTTOM_HEIGHT, BOTTOM_TIME
from presswear.recording.output_point import lowest_between, note_bottom
from presswear.scene.catalog import ideal

SPEED = 11.0
PERIOD = math.tau / SPEED
Level = tuple[float, float, float]


def swing(time: float, bottom: float) -> Level:
    """Return place, velocity and acceleration of -cos and a harmonic, lowest at ``bottom``."""
    angle = SPEED * (time - bottom)
    return (
        -math.cos(angle) - 0.05 * math.cos(3.0 * angle),
        SPEED * (math.sin(angle) + 0.15 * math.sin(3.0 * angle)),
        SPEED**2 * (math.cos(angle) + 0.45 * math.cos(3.0 * angle)),
    )


@given(st.floats(1e-7, 3e-3), st.floats(0.0, 1.0))
def test_lowest_place_in_a_step_is_that_of_the_motion(length, part):
    """The error is within the bound of the interpolation, which is below 1e-10 m."""
    begin = -part * length
    place, since = lowest_between(length, swing(begin, 0.0), swing(begin + length, 0.0))
    bound = length**6 / 46080.0 * SPEED**6 * (1.0 + 0.05 * 3.0**6)
    assert bound < 1e-10
    assert abs(place + 1.05) <= bound + 4e-16
    # Near its bottom the motion is flat: round-off of the place gives 1e-8 in time.
    assert abs(begin + since) <= 1e-8


def twice_down(time: float, bottom: float) -> Level:
    """Return a motion with bottoms of -1.2 at ``bottom`` and -0.8 half a period later."""
    angle = SPEED * (time - bottom)
    return (
        -math.cos(2.0 * angle) - 0.2 * math.cos(angle),
        SPEED * (2.0 * math.sin(2.0 * angle) + 0.2 * math.sin(angle)),
        SPEED**2 * (4.0 * math.cos(2.0 * angle) + 0.2 * math.cos(angle)),
    )


def recorded(
    bottom: float,
    stroke: tuple[float, float],
    cycles: int,
    seed: int,
    motion_at: Callable[[float, float], Level] = swing,
) -> np.ndarray:
    """Return height and time of the bottom of each cycle, from steps of random lengths."""
    scene = ideal()
    plan = Plan(PERIOD, cycles, stroke=stroke)
    recorder = recorder_of(scene.linkage(), start_of(scene), plan)
    records = recorder.records
    draw = np.random.default_rng(seed)
    note_bottom(records, 0.0, 0.0, (0.0, 1.0), motion_at(0.0, bottom))
    for cycle in range(cycles):
        times = (np.arange(100) + draw.uniform(0.0, 1.0, 100)) / 100.0
        times = PERIOD * (cycle + np.concatenate([[0.0], times, [1.0]]))
        for before, time in pairwise(times):
            motion = motion_at(float(time), bottom)
            note_bottom(records, time, time - before, (time, 1.0), motion)
        recorder.end_cycle()
    return recorder.cycles[:, [BOTTOM_HEIGHT, BOTTOM_TIME]]


@settings(max_examples=30, deadline=None)
@given(st.floats(-0.249, 0.75), st.floats(-1e-3, 1e-3), st.integers(0, 1000))
def test_every_stroke_has_one_bottom(place, shift, seed):
    """The bottom is searched for within a quarter of a period of the ideal bottom."""
    ideal_bottom = PERIOD * place
    bottom = PERIOD * (place + shift)
    window = ideal_bottom - 0.25 * PERIOD, ideal_bottom + 0.25 * PERIOD
    rows = recorded(bottom, window, 5, seed)
    # A bottom before the start is not recorded.
    first = 1 if place <= max(0.0, -shift) else 0
    strokes = np.arange(5)[first:]
    assert rows[first:, 0] == pytest.approx(-1.05, abs=1e-8)
    assert rows[first:, 1] == pytest.approx(bottom + PERIOD * strokes, abs=1e-6)


@pytest.mark.parametrize("bottom", [0.25, 0.75])
def test_the_deeper_of_two_bottoms_of_a_stroke_is_stored(bottom):
    at = PERIOD * bottom
    rows = recorded(at, (0.0, PERIOD), 3, 2, twice_down)
    assert rows[:, 0] == pytest.approx(-1.2, abs=1e-8)
    assert rows[:, 1] == pytest.approx(at + PERIOD * np.arange(3.0), abs=1e-6)


@pytest.mark.parametrize(("begin", "end"), [(0.6, 0.9), (0.1, 0.4)])
def test_a_place_out_of_the_window_is_no_bottom(begin, end):
    """The motion is lowest at 0.5; in the window it is lowest at the nearer end."""
    bottom = 0.5 * PERIOD
    window = PERIOD * begin, PERIOD * end
    heights = recorded(bottom, window, 4, 3)[:, 0]
    nearer = min(window, key=lambda time: abs(time - bottom))
    # A step is at most 0.02 of a period.
    outward = math.copysign(0.02 * PERIOD, nearer - bottom)
    assert np.all(heights >= swing(nearer - outward, bottom)[0])
    assert np.all(heights <= swing(nearer + outward, bottom)[0])


@pytest.mark.parametrize("engine", ["dae", "exudyn"])
def test_highest_place_of_a_rigid_four_bar_lies_between_steps(engine):
    scene = pw.Scene(
        pw.FourBar(), joints="none", engine=engine, wear_updates=0, cycles=4
    )
    ideal = bottom_of(scene.ideal)
    start = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)
    highest = pw.run(scene).stages[0].each_cycle("displacement_max")
    expected = ideal.height + ideal.stroke - float(start[0, 0])
    assert highest == pytest.approx(np.full(4, expected), abs=1e-9)
