"""The in-house motion as a map, and the exponent of a linkage."""

import math
from dataclasses import replace

import numpy as np
import pytest

import presswear as pw
from presswear.bifurcation import flow
from presswear.bifurcation.flow import ENGINE, Flow, exponent, scene_exponent
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.linkage.loads import Force, OverPosition
from presswear.scene.settings import changed

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


SUSTAINED = changed(SCENE, {"clearance": "20 um"})


def test_a_step_restores_the_state_of_a_load() -> None:
    """The load vanishes once the slider has passed the end of its table."""
    place = float(START.position[3 * LINKAGE.index("slider")])
    table = [(place - 0.02, 400.0), (place - 0.001, 400.0), (place, 0.0)]
    law = OverPosition(table, "against", release=True)
    linkage = replace(LINKAGE, loads=[Force("slider", 0.0, law)])
    own = Flow.of(linkage, START, PERIOD, 20)
    state, carried = own.step(*own.state())
    first = [own.step(state, carried)]
    for _ in range(9):
        first.append(own.step(*first[-1]))
    again, _ = own.step(state, carried)
    np.testing.assert_array_equal(again, first[0][0])


def test_exponent_of_a_periodic_motion_in_sustained_contact_is_zero() -> None:
    """The force keeps the closing speed at touchdown, so that its difference never decays.

    Two runs that are never moved together keep their distance as well.
    """
    linkage, period, cycles = SUSTAINED.linkage(), SUSTAINED.mechanism.period, 60
    found = exponent(linkage, start_of(SUSTAINED), period, cycles)
    assert found.half_width is not None
    assert abs(found.value) < found.half_width < 1.0
    plan = Plan(period, cycles, 1, sections=(1.0,))
    runs = [ENGINE.simulate(linkage, start_of(SUSTAINED, k), plan).recorder for k in range(2)]
    assert all(np.ptp(run.each_cycle("contacts", 0)[20:]) == 0.0 for run in runs)
    distance = np.linalg.norm(runs[1].sections[:, 0, 2:4] - runs[0].sections[:, 0, 2:4], axis=1)
    rate = math.log(distance[-1] / distance[20]) / ((cycles - 21) * period)
    assert abs(rate - found.value) < 1.0


def test_friction_bristles_are_part_of_the_state() -> None:
    scene = changed(SUSTAINED, {"friction": "0.1", "friction_law": "lugre"})
    own = Flow.of(scene.linkage(), start_of(scene), PERIOD, 20)
    numbers, carried = own.state()
    for _ in range(40):
        numbers, carried = own.step(numbers, carried)
    assert own.apart.shape == numbers.shape == (6,)
    assert np.all(np.isfinite(numbers))
    straight, _ = own.step(numbers, carried)
    for k in (4, 5):  # bristle deflection, closing speed at touchdown
        twin = numbers.copy()
        twin[k] += own.apart[k]
        moved, _ = own.step(twin, carried)
        assert np.linalg.norm(((moved - straight) / own.apart)[:4]) > 1e-3


def test_closing_speed_is_no_state_where_the_force_does_not_depend_on_it() -> None:
    scene = changed(SUSTAINED, {"restitution": "1"})
    own = Flow.of(scene.linkage(), start_of(scene), PERIOD, 20)
    numbers, _ = own.step(*own.state())
    assert own.book.onset[0] > 0.0
    assert np.isnan(numbers[-1])


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
    """Without restarts, distances grow from 2 nm to 2 um at the rate of the exponent.

    The pairs start from states of a flow.  These include the closing speed at touchdown, because
    the pin is in contact at most of these times.
    """
    small, large, pairs = 0.4, 400.0, 60  # distances as multiples of flow.APART
    own = Flow.of(LINKAGE, START, PERIOD, 200)
    state, carried = own.state()
    for _ in range(400):
        state, carried = own.step(state, carried)
    growth, time = np.empty(pairs), np.empty(pairs)
    for k in range(pairs):
        twin, beside = state + 0.01 * own.apart, carried
        distance = [0.0]
        while distance[-1] < large:
            assert len(distance) < 4000
            state, carried = own.step(state, carried)
            twin, beside = own.step(twin, beside)
            distance.append(float(np.linalg.norm(((twin - state) / own.apart)[:4])))
        first = next(i for i, apart in enumerate(distance) if apart >= small)
        growth[k] = math.log(distance[-1] / distance[first])
        time[k] = (len(distance) - 1 - first) * own.interval
    rate = growth.sum() / time.sum()
    half = 2.0 * math.sqrt(pairs) * (growth - rate * time).std(ddof=1) / time.sum()
    found = scene_exponent(SCENE, 400)
    assert found.half_width is not None
    assert abs(found.value - rate) < np.hypot(half, found.half_width) < 0.2 * rate


def test_what_has_no_exponent_is_refused() -> None:
    ideal = pw.scenes.ideal()
    with pytest.raises(pw.InputError, match="without one nothing is free"):
        scene_exponent(ideal, 1)
    with pytest.raises(pw.InputError, match="without free loops"):
        scene_exponent(pw.scenes.clearance_a(), 1)
