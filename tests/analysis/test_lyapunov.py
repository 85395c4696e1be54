"""Lyapunov exponents against published values and closed forms, and of a linkage."""
# mypy: disable-error-code="operator,arg-type"

import math
from collections.abc import Callable

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.analysis import lyapunov
from presswear.analysis.lyapunov import (
    ENGINE,
    Flow,
    exponent_from_growth,
    growth_logarithms,
    largest_exponent,
)
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.recording.statistics import Estimate
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import Array


def exponent_of_map(
    step: Callable[[Array], Array], start: Array, intervals: int
) -> Estimate:
    distances = np.full(start.size, 1e-9)
    growth = growth_logarithms(
        lambda x, _: (step(x), None), start, None, intervals, distances
    )
    return exponent_from_growth(growth, 1.0)


def is_chaotic(exponent: Estimate) -> bool:
    """Return whether the whole interval lies above 0."""
    return exponent.low is not None and exponent.low > 0.0


def assert_close(exponent: Estimate, expected: float) -> None:
    """Within 3 % and within the confidence interval."""
    assert exponent.mean == pytest.approx(expected, rel=0.03)
    assert abs(exponent.mean - expected) <= exponent.half_width


def test_maps_of_the_literature():
    """Henon 0.41922 (Sprott, Chaos and Time-Series Analysis, 2003), logistic map ln 2."""

    def henon(x: Array) -> Array:
        return np.array([1.0 - 1.4 * x[0] ** 2 + x[1], 0.3 * x[0]])

    logistic = exponent_of_map(
        lambda x: 4.0 * x * (1.0 - x), np.array([0.3123]), 20_000
    )
    cases = {
        0.41922: exponent_of_map(henon, np.array([0.1, 0.1]), 20_000),
        math.log(2.0): logistic,
    }
    for expected, exponent in cases.items():
        assert_close(exponent, expected)
        assert exponent.half_width <= 0.03 * expected
        assert is_chaotic(exponent)


def test_bad_input_is_refused():
    with refused("interval 0: the distance of the pair is 0"):
        exponent_of_map(lambda x: 0.0 * x, np.zeros(2), 3)
    with refused("no motion is free"):
        scene_exponent(pw.scenes.ideal(), 1)
    with refused("without free loops"):
        scene_exponent(pw.scenes.clearance_a(), 1)


SCENE = pw.scenes.slider_crank()
CYCLE = SCENE.mechanism.period
SUSTAINED = changed(SCENE, {"clearance": "20 um"})


def scene_exponent(scene: Scene, cycles: int) -> Estimate:
    return largest_exponent(
        scene.linkage(), start_of(scene), scene.mechanism.period, cycles
    )


def test_exponent_of_a_periodic_motion_in_sustained_contact_is_zero():
    """The force keeps the closing speed at touchdown, so that its difference never decays.

    Two runs without rescaling keep their distance as well.
    """
    linkage = SUSTAINED.linkage()
    period = SUSTAINED.mechanism.period
    cycles = 60
    exponent = scene_exponent(SUSTAINED, cycles)
    assert abs(exponent.mean) < exponent.half_width < 1.0
    plan = Plan(period, cycles, 1, sections=(1.0,))
    runs = [
        ENGINE.simulate(linkage, start_of(SUSTAINED, k), plan).recorder
        for k in range(2)
    ]
    assert all(np.ptp(run.each_cycle("contacts", 0)[20:]) == 0.0 for run in runs)
    distance = np.linalg.norm(
        runs[1].sections[:, 0, 2:4] - runs[0].sections[:, 0, 2:4], axis=1
    )
    rate = math.log(distance[-1] / distance[20]) / ((cycles - 21) * period)
    assert abs(rate - exponent.mean) < 1.0


def test_bristles_and_closing_speed_are_part_of_the_state():
    scene = changed(SUSTAINED, {"friction": "0.1", "friction_law": "lugre"})
    flow = Flow(scene.linkage(), start_of(scene), CYCLE, 20)
    state, context = flow.state()
    for _ in range(40):
        state, context = flow.step(state, context)
    assert flow.distance.shape == state.shape == (6,)
    assert np.all(np.isfinite(state))
    reference, _ = flow.step(state, context)
    for k in (4, 5):  # bristle deflection, closing speed at touchdown
        neighbour = state.copy()
        neighbour[k] += flow.distance[k]
        moved, _ = flow.step(neighbour, context)
        assert np.linalg.norm(((moved - reference) / flow.distance)[:4]) > 1e-3
    elastic = changed(SUSTAINED, {"restitution": "1"})
    flow = Flow(elastic.linkage(), start_of(elastic), CYCLE, 20)
    state, _ = flow.step(*flow.state())
    assert flow.records.onset[0] > 0.0
    assert np.isnan(state[-1])


def test_exponent_does_not_depend_on_distance_or_interval(monkeypatch):
    reference = scene_exponent(SCENE, 40)
    assert is_chaotic(reference)
    for name, value in (("DISTANCE", 1e-4), ("INTERVALS", 10)):
        monkeypatch.setattr(lyapunov, name, value)
        exponent = scene_exponent(SCENE, 40)
        width = np.hypot(reference.half_width, exponent.half_width)
        assert abs(reference.mean - exponent.mean) < width
