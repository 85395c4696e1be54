"""Smooth motion: every integrator comes out with its order, against references of others."""

import numpy as np
import pytest

from precision.short_study import SHORT
from presswear.engines.base import Plan
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.scene.catalog import scene_named
from presswear.validation.precision.diagram import Diagram
from presswear.validation.precision.methods import smooth_methods
from presswear.validation.precision.smooth import HELD, constraint_errors
from presswear.validation.verify.references import andrews, andrews_start

TRAPEZOIDAL, RK4 = "exudyn-joints, trapezoidal rule", "dae, RK4"


def test_orders_come_out_on_the_ideal_press(ideal: Diagram) -> None:
    for quantity in ideal.quantities[:3]:
        assert ideal.order(TRAPEZOIDAL, quantity) == pytest.approx(2.0, abs=0.05)
        assert ideal.order(RK4, quantity) == pytest.approx(4.0, abs=0.15)


def test_orders_come_out_on_the_squeezer(squeezer: Diagram) -> None:
    for quantity in squeezer.quantities[:2]:
        assert squeezer.order(TRAPEZOIDAL, quantity) == pytest.approx(2.0, abs=0.1)
        assert squeezer.order(RK4, quantity) == pytest.approx(4.0, abs=0.5)


def test_printed_values_are_known_no_better_than_they_were_computed(squeezer: Diagram) -> None:
    angles, rates, *_ = squeezer.quantities
    assert 1e-10 < angles.known < 5e-9
    assert 1e-8 < rates.known < 2e-6


def test_a_smaller_tolerance_is_a_smaller_error(ideal: Diagram) -> None:
    for family in ("dae, DOP853", "dae, DOPRI5"):
        errors = [point.errors["slider position"] for point in ideal.families[family]]
        assert errors == sorted(errors, reverse=True)
        assert errors[-1] < 1e-2 * errors[0]


def test_the_papers_setting_and_the_defaults_are_in_it(ideal: Diagram) -> None:
    (papers,) = (point for point in ideal.points if point.method.is_paper)
    assert papers.method.label == "dae, RK4, step 0.0001"
    assert papers.errors["slider position"] < 1e-12
    defaults = {point.method.family: point for point in ideal.points if point.method.is_default}
    assert set(defaults) == {TRAPEZOIDAL, "dae, DOP853"}
    scene = scene_named("wear-times")
    own = scene.numerics.joints.over(scene.mechanism.period)
    assert defaults[TRAPEZOIDAL].method.engine == own


def test_times_steps_and_evaluations_are_complete(ideal: Diagram) -> None:
    for point in ideal.points:
        timing = point.timing
        assert timing is not None
        assert point.warm_up is not None
        assert len(timing.walls) == SHORT.repeats
        assert min(timing.walls) > 0.0 <= point.warm_up
        assert timing.steps > 0
        assert (timing.evaluations is None) == isinstance(point.method.engine, ExudynJoints)
    rk4 = ideal.families[RK4][0].timing
    assert rk4 is not None
    assert rk4.evaluations == 4 * rk4.steps


def test_steps_of_a_ladder_are_as_many_as_asked(ideal: Diagram) -> None:
    counts = [p.timing.steps for p in ideal.families[TRAPEZOIDAL] if p.timing is not None]
    assert np.all(np.abs(np.array(counts[:3]) - SHORT.rungs.free_steps) <= 1)


def test_constraints_of_the_start_are_kept() -> None:
    run = InHouse().simulate(andrews(), andrews_start(), Plan(1e-6, 1))
    errors = constraint_errors(andrews(), run)
    assert set(errors) == {own.name for own in HELD}
    assert max(errors.values()) < 1e-9


def test_ladders_run_from_coarse_to_fine() -> None:
    methods = smooth_methods(SHORT.rungs, 0.5, scene_named("wear-times").numerics, 0.57)
    families: dict[str, list[float]] = {}
    for method in methods:
        families.setdefault(method.family, []).append(method.value)
    assert len(families) == 4
    for values in families.values():
        assert values == sorted(values, reverse=True)
    assert any(isinstance(method.engine, ExudynJoints) for method in methods)
