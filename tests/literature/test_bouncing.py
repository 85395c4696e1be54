"""Impacts in the engines: delivered restitution, duration, depth, and a bouncing ball."""

import numpy as np
import pytest

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.laws import delivered_restitution, lankarani_nikravesh_damping
from presswear.validation import reference_problems as references
from presswear.validation.cases import first_contact, order_of

PLAN = Plan(0.005, 1)
DELIVERED = references.DELIVERED["lankarani-nikravesh"]


def rebound(run: Run) -> float:
    return float(run.end.velocity[0] - run.end.velocity[3])


@pytest.mark.parametrize(("tolerance", "bound"), [(1e-9, 5e-8), (1e-11, 1e-8)])
def test_a_run_that_starts_on_the_touch_does_not_miss_it(tolerance: float, bound: float) -> None:
    impact = references.Impact(0.9)
    position = impact.start.position.copy()
    position[3] = impact.linkage.clearances[0].clearance
    start = Start(position, impact.start.velocity)
    run = InHouse(integration_tolerance=tolerance).simulate(impact.linkage, start, PLAN)
    assert rebound(run) / impact.speed == pytest.approx(DELIVERED[0.9], abs=bound)


def test_exudyn_delivers_to_second_order_in_the_step() -> None:
    impact = references.Impact(0.9)
    exact = delivered_restitution(lankarani_nikravesh_damping(0.9))
    parts = (50, 100, 200, 400)
    errors = []
    for steps in parts:
        accuracy = ExudynJoints(steps, 10, free_step=2e-5, newton=1e-12)
        run = accuracy.simulate(impact.linkage, impact.start, PLAN)
        errors.append(abs(references.delivered(run, impact.speed) - exact))
    assert order_of([1.0 / steps for steps in parts], errors) == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("speed", [0.01, 0.25, 2.0])
def test_elastic_impact_lasts_as_hertz_says(speed: float) -> None:
    """2.9432751843 delta_max / v."""
    impact = references.Impact(1.0, speed=speed)
    plan = Plan(2.0 * impact.clearance / speed, 1)
    run = references.TIGHT.simulate(impact.linkage, impact.start, plan)
    contact = first_contact(run)
    assert contact["touchdown"] == pytest.approx(impact.clearance / speed, rel=1e-12)
    assert contact["separation"] - contact["touchdown"] == pytest.approx(
        impact.elastic_duration, rel=1e-8
    )
    # The tolerance in velocity is one of 1 m/s, not of the closing speed.
    assert references.delivered(run, speed) == pytest.approx(1.0, abs=2.5e-9 / speed)


@pytest.mark.parametrize("nominal", [0.5, 0.8, 0.9, 1.0])
def test_depth_is_the_closed_form(nominal: float) -> None:
    impact = references.Impact(nominal, clearance=1e-5)
    run = references.TIGHT.simulate(impact.linkage, impact.start, Plan(2.2e-4, 1))
    assert references.deepest_penetration(run, impact.speed) == pytest.approx(
        impact.deepest, rel=1e-8
    )


@pytest.mark.parametrize("nominal", [0.9, 0.8, 0.5])
def test_ball_rebounds_with_the_delivered_restitution(nominal: float) -> None:
    """Each bounce in the limit of short contacts; gravity's part goes with K^(-2/5)."""
    expected = delivered_restitution(lankarani_nikravesh_damping(nominal))
    ratios = []
    for stiffness in (1e12, 1e13, 1e14):
        ball = references.Ball(nominal, stiffness)
        rebounds = references.bounced(ball, 2.5)[1][:4]
        ratios.append(rebounds / np.concatenate([[ball.speed], rebounds[:-1]]))
    np.testing.assert_allclose((ratios[0] - expected) / (ratios[1] - expected), 10**0.4, rtol=5e-3)
    for bounce in range(4):
        limit = references.stiff_limit(ratios[1][bounce], ratios[2][bounce], 10.0)
        assert limit == pytest.approx(expected, abs=5e-9)
