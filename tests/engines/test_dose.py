"""The dose of wear, integral of F_n ds, of one impact against its impulse."""

from dataclasses import replace

import numpy as np
import pytest

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.elements import WearLaw
from presswear.recording.observe import CYCLE_FIXED
from presswear.validation import reference_problems as references

SPIN = 30.0
"""Of the pin, rad/s: without friction it slides at R_j SPIN throughout the impact."""


def _spinning() -> tuple[references.Impact, Start]:
    impact = references.Impact(0.9)
    velocity = impact.start.velocity.copy()
    velocity[5] = SPIN
    return impact, Start(impact.start.position, velocity)


def _dose_and_impulse(run: Run, impact: references.Impact) -> tuple[float, float]:
    load_distance = float(run.recorder.cycles[0][len(CYCLE_FIXED) + 1])
    ring = impact.linkage.bodies[0]
    return load_distance, abs(ring.mass * float(run.end.velocity[0] - impact.start.velocity[0]))


@pytest.mark.parametrize(("engine", "error"), [("exudyn", 3e-4), ("dae", 1e-8)])
def test_dose_is_impulse_times_sliding(engine: str, error: float) -> None:
    """Exudyn sums by steps, to (pi / 64)^2 / 12 = 2e-4 at the 64 steps that it makes."""
    impact, start = _spinning()
    # An account of wear is kept only where there is a law of wear.
    worn = replace(impact.linkage.clearances[0], wear=WearLaw(1e-15))
    linkage = replace(impact.linkage, clearances=(worn,))
    plan = Plan(0.005, 1)
    if engine == "dae":
        run = InHouse(integration_tolerance=1e-11).simulate(linkage, start, plan)
    else:
        run = ExudynJoints(50, 10, free_step=2e-5).simulate(linkage, start, plan)
    assert run.recorder.records.counters["contacts"][0] == 1
    load_distance, impulse = _dose_and_impulse(run, impact)
    joint = impact.linkage.clearances[0]
    # The arm is R_j - delta / 2, and the penetration is some micrometres.
    deepest = float(np.max(run.recorder.rows[:, 6]))
    sliding = SPIN * joint.pin_radius
    assert impulse > 0.01
    assert load_distance >= sliding * (1.0 - 0.5 * deepest / joint.pin_radius) * impulse * (
        1.0 - error
    )
    assert load_distance <= sliding * impulse * (1.0 + error)
