"""The in-house motion as a map, and the exponent of a linkage."""

import math

import numpy as np
import pytest

import presswear as pw
from presswear.bifurcation import flow
from presswear.bifurcation.flow import ENGINE, Flow, exponent, scene_exponent
from presswear.campaign.starts import APART, start_of, turned_back
from presswear.engines.base import Plan
from presswear.trials.precision.growth import HIGH, measure_growth

SCENE = pw.scenes.slider_crank()
LINKAGE, START, PERIOD = SCENE.linkage(), start_of(SCENE), SCENE.mechanism.period


def test_a_map_of_parts_ends_where_the_run_does() -> None:
    """Up to the first contacts; behind them differences of the steps grow as all others."""
    own = Flow.of(LINKAGE, START, PERIOD, 50)
    state = own.state()
    for _ in range(5):
        state = own.step(*state)
    run = ENGINE.simulate(LINKAGE, START, Plan(0.1 * PERIOD, 1))
    assert len(run.recorder.episodes(0)) > 0
    _, position, velocity = own.running.state()
    np.testing.assert_allclose(position, run.end.position, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(velocity, run.end.velocity, rtol=0.0, atol=1e-6)


def test_a_step_forgets_what_was_asked_before() -> None:
    """States are maps of states, bit for bit, whatever the solver did in between."""
    own = Flow.of(LINKAGE, START, PERIOD, 20)
    state, carried = own.step(*own.step(*own.state()))
    first, _ = own.step(state, carried)
    own.step(state + 1e-6, carried)
    again, _ = own.step(state, carried)
    np.testing.assert_array_equal(again, first)


def test_the_exponent_does_not_depend_on_the_distance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor on how often twins are moved together: within the intervals, whose cycles are others."""
    one = scene_exponent(SCENE, 40)
    monkeypatch.setattr(flow, "APART", 1e-4)
    far = scene_exponent(SCENE, 40)
    rare = exponent(LINKAGE, START, PERIOD, 40, 10)
    assert one.is_chaotic
    for other in (far, rare):
        assert one.half_width is not None
        assert other.half_width is not None
        assert abs(one.value - other.value) < np.hypot(one.half_width, other.half_width)


@pytest.mark.slow
def test_pairs_that_are_left_alone_part_as_fast() -> None:
    """Growth of single pairs up to a hundredth of the clearance, as ``precision`` has it."""
    start, found = START, []
    for _ in range(4):
        end = ENGINE.simulate(LINKAGE, start, Plan(2.0 * PERIOD, 1)).end
        start = turned_back(end, start)
        pair = measure_growth(LINKAGE, start, PERIOD, 1, lambda word, part: None)
        until = next((k for k, apart in enumerate(pair.distance) if apart >= HIGH), -1)
        found.append(math.log(pair.distance[until] / APART) / pair.time[until])
    rates = np.array(found)
    told = scene_exponent(SCENE, 100)
    assert told.half_width is not None
    half = 3.2 * rates.std(ddof=1) / np.sqrt(rates.size)
    assert abs(told.value - rates.mean()) < np.hypot(half, told.half_width)


def test_what_has_no_exponent_is_refused() -> None:
    ideal = pw.scenes.ideal()
    with pytest.raises(pw.InputError, match="without one nothing is free"):
        scene_exponent(ideal, 1)
    with pytest.raises(pw.InputError, match="without free loops"):
        scene_exponent(pw.scenes.clearance_a(), 1)
