"""One impact: closed forms, and what methods make of them."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from precision.short_study import SHORT
from presswear.engines.settings import InHouse
from presswear.linkage.laws import delivered_restitution
from presswear.physics.tree import Tree, tree_of
from presswear.scene.catalog import scene_named
from presswear.validation.precision.diagram import Diagram
from presswear.validation.precision.impact import (
    IMPACT,
    REDUCED_MASS,
    contact_time,
    deepest,
    guided,
    single,
    turning,
)


def test_contact_time_without_damping_is_hertz() -> None:
    lasts, doubt = contact_time(REDUCED_MASS, IMPACT.speed, IMPACT.stiffness, 1.5, 1e-4)
    assert lasts == pytest.approx(IMPACT.elastic_duration, rel=1e-5)
    assert doubt < 1e-10 * lasts


def test_contact_time_is_that_of_the_integrated_motion() -> None:
    mass, speed, stiffness, damping = 0.1, 0.2, 1e9, 0.4

    def motion(t: float, y: np.ndarray) -> list[float]:
        depth = max(y[0], 0.0)
        return [y[1], -stiffness / mass * depth**1.5 * (1.0 + damping * y[1] / speed)]

    class Apart:
        """The event that ends the contact."""

        terminal, direction = True, -1.0

        def __call__(self, t: float, y: np.ndarray) -> float:
            return float(y[0]) if t > 0.0 else 1.0

    found = solve_ivp(
        motion, (0.0, 1e-2), [0.0, speed], "DOP853", events=Apart(), rtol=1e-12, atol=1e-16
    )
    lasts, _ = contact_time(mass, speed, stiffness, 1.5, damping)
    assert lasts == pytest.approx(found.t_events[0][0], rel=1e-8)
    assert -found.y_events[0][0][1] / speed == pytest.approx(delivered_restitution(damping))


def test_guides_make_the_impact_a_tree_and_change_nothing() -> None:
    linkage, start = guided()
    assert isinstance(tree_of(linkage), Tree)
    task = single(scene_named("wear-times"), SHORT.rungs)
    tight = InHouse(integration_tolerance=1e-12, free_step=1.0)
    runs = [tight.simulate(each, start, task.plan) for each in (linkage, IMPACT.linkage)]
    np.testing.assert_allclose(runs[0].end.velocity, runs[1].end.velocity, atol=1e-12)
    assert deepest(runs[0]) == pytest.approx(IMPACT.deepest, rel=1e-9)


def test_the_top_of_a_quintic_is_found() -> None:
    time = np.array([0.0, 0.3])
    ends = np.column_stack([np.cos(time - 0.1), -np.sin(time - 0.1), -np.cos(time - 0.1)])
    assert turning(time, ends) == pytest.approx(0.1, abs=1e-6)


def test_every_engine_comes_close(impact: Diagram) -> None:
    assert {point.method.engine.word for point in impact.points} == {
        "exudyn-joints",
        "exudyn-tree",
        "dae",
    }
    for family, points in impact.families.items():
        last = points[-1]
        assert not last.failure
        bound = 1e-3 if "equal" in family else 1e-4
        assert last.errors["delivered restitution"] < bound
        assert last.values["steps in the contact"] >= 20.0
        assert last.values["restitution"] == pytest.approx(0.9131766778, abs=1.01 * bound)


def test_the_order_is_that_of_the_trapezoidal_rule(impact: Diagram) -> None:
    for quantity in impact.quantities[:3]:
        order = impact.order("exudyn-joints, trapezoidal rule", quantity)
        assert order == pytest.approx(2.0, abs=0.3)


def test_the_papers_step_makes_energy(impact: Diagram) -> None:
    papers = next(point for point in impact.points if point.method.is_paper)
    assert papers.values["restitution"] > 1.0
    assert papers.errors["energy residual"] > 0.1
    assert math.isfinite(papers.errors["contact time"])
