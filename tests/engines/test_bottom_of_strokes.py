"""Bottom dead centre of short runs, compared between engines and with the ideal motion."""

import numpy as np
import pytest

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.physics.dead_centre import bottom_of
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def bottoms(scene: Scene, engine: Engine, cycles: int) -> Array:
    """Height, m, and time, s, of the bottom of each stroke, shape (cycles, 2)."""
    plan = RunSpec(cycles).plan(scene)
    run = engine.for_cycle(scene.mechanism.period).simulate(
        scene.linkage(), start_of(scene), plan
    )
    assert run.status == "completed", run.message
    height = run.recorder.each_cycle("bottom_height")
    return np.column_stack([height, run.recorder.each_cycle("bottom_time")])


def test_engines_agree_on_the_bottom_of_the_first_stroke():
    """In the second stroke, after some twenty impacts, their motions differ."""
    scene = wear_times()
    in_house = bottoms(scene, InHouse(integration_tolerance=1e-12), 1)
    tree = bottoms(scene, ExudynTree(tree_tolerance=1e-11), 1)
    height_difference, time_difference = np.abs(in_house[0] - tree[0])
    assert height_difference < 1e-10
    assert time_difference < 1e-7
    ideal = bottom_of(scene.ideal)
    assert ideal is not None
    # The slider hangs below the ideal height, by less than both clearances allow.
    below = ideal.height - in_house[:, 0]
    assert np.all(below > 1e-4)
    assert np.all(below < 2e-3)


def test_the_bottom_of_each_stroke_is_that_of_its_series():
    """The fourth stroke ends higher than the third, and none is as low as both clearances."""
    scene = wear_times()
    period = scene.mechanism.period
    run = (
        InHouse()
        .for_cycle(period)
        .simulate(scene.linkage(), start_of(scene), RunSpec(4).plan(scene))
    )
    assert run.status == "completed", run.message
    start = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    time, place = run.recorder.series("time"), run.recorder.series("displacement")
    heights = run.recorder.each_cycle("bottom_height")
    lowest = []
    for stroke in range(4):
        within = np.abs(time / period - stroke) < 0.4
        k = np.flatnonzero(within)[place[within].argmin()]
        lowest.append((start + place[k], time[k]))
    assert heights == pytest.approx(np.array(lowest)[:, 0], abs=1e-7)
    times = run.recorder.each_cycle("bottom_time")
    assert times == pytest.approx(np.array(lowest)[:, 1], abs=1e-3)
    assert heights[3] > heights[2]
    ideal = bottom_of(scene.ideal)
    assert ideal is not None
    below = ideal.height - heights
    assert np.all((below > 1e-4) & (below < 2e-3))
