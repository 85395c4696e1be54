"""Bottom dead centre of short runs, compared between engines and with the ideal motion."""

import numpy as np
import pytest

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.settings import InHouse
from presswear.physics.dead_centre import bottom_of
from presswear.scene.catalog import wear_times


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
