"""Functions that scripts call: a linkage alone."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import presswear as pw
from presswear.physics.curve_following import motion_of

FOUR_BAR = pw.FourBar()


def test_a_linkage_without_clearance_follows_its_ideal_motion():
    run = pw.simulate(FOUR_BAR.linkage(), duration="0.2 s")
    assert (run.status, run.time) == ("completed", 0.2)
    ideal = motion_of(FOUR_BAR).at(np.array([0.2])).position[0]
    assert_allclose(run.end.position, ideal, atol=1e-7)


def test_a_run_begins_in_the_ideal_motion_and_lasts_a_cycle():
    linkage = pw.scenes.slider_crank().linkage()
    whole = pw.simulate(linkage)
    assert whole.time == linkage.period
    assert whole.recorder.series("penetration", 0).max() > 0.0
    ideal = motion_of(linkage.ideal).at(np.zeros(1))
    start = pw.engines.Start(ideal.position[0], ideal.velocity[0])
    again = pw.simulate(linkage, start)
    assert_array_equal(again.end.position, whole.end.position)


def test_a_long_run_has_the_steps_of_its_cycles():
    linkage = FOUR_BAR.linkage()
    run = pw.simulate(linkage, duration=5.0 * linkage.period)
    time = run.recorder.series("time")
    assert np.diff(time).max() < linkage.period / 490
    ideal = motion_of(FOUR_BAR).at(np.array([5.0 * linkage.period])).position[0]
    assert_allclose(run.end.position, ideal, atol=1e-6)


def test_a_linkage_without_drives_needs_a_duration_and_no_cycle():
    bar = pw.assemble([pw.Bar("bar", length="0.5 m", mass="1 kg")])
    start = pw.engines.Start(np.zeros(3), np.zeros(3))
    fallen = pw.simulate(bar, start, duration="0.5 s").end.position
    expected = [0.0, -0.5 * 9.81 * 0.5**2, 0.0]
    assert_allclose(fallen, expected, atol=1e-12)
    with pytest.raises(pw.InputError, match="no drive turns"):
        pw.simulate(bar, start)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"engine": "da"}, "unknown engine 'da'; did you mean dae"),
        ({"duration": "0 s"}, "duration = .* above 0"),
        ({"duration": 1e7}, "duration = 1e.* up to 1e"),
        (
            {"start": pw.engines.Start(np.zeros(3), np.zeros(3))},
            r"position .* \(9,\), three",
        ),
        ({"begin": 0.0}, "unknown argument of simulate 'begin'"),
    ],
)
def test_bad_input_is_refused(options, message):
    with pytest.raises(pw.InputError, match=message):
        pw.simulate(FOUR_BAR.linkage(), **options)
