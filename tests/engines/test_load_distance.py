"""The load distance, integral of F_n ds, of one impact against its impulse."""

from dataclasses import replace

import pytest

from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.wear_law import WearLaw
from presswear.validation import reference_problems as references

# Angular velocity of the pin, rad/s. Without friction it slides at R_j SPIN throughout
# the impact.
SPIN = 30.0


@pytest.mark.parametrize(("engine", "error"), [("exudyn", 3e-4), ("dae", 1e-8)])
def test_load_distance_is_impulse_times_sliding(engine, error):
    """Exudyn sums by steps, to (pi / 64)^2 / 12 = 2e-4 at the 64 steps that it makes."""
    impact = references.Impact(0.9)
    velocity = impact.start.velocity.copy()
    velocity[5] = SPIN
    start = Start(impact.start.position, velocity)
    # The load distance is integrated only for a joint with a wear law.
    joint = replace(impact.linkage.clearances[0], wear=WearLaw(1e-15))
    linkage = replace(impact.linkage, clearances=(joint,))
    solver: Engine = InHouse(integration_tolerance=1e-11)
    if engine == "exudyn":
        solver = ExudynJoints(50, 10, free_step=2e-5)
    run = solver.simulate(linkage, start, Plan(0.005, 1))
    assert run.recorder.records.counters["contacts"][0] == 1
    load_distance = float(run.recorder.each_cycle("load_distance", 0)[0])
    change = float(run.end.velocity[0] - impact.start.velocity[0])
    impulse = abs(linkage.bodies[0].mass * change)
    sliding = SPIN * joint.pin_radius
    # The arm is R_j - delta / 2, and the penetration is some micrometres.
    deepest = float(run.recorder.series("penetration", 0).max())
    least = 1.0 - 0.5 * deepest / joint.pin_radius
    assert impulse > 0.01
    assert load_distance >= sliding * least * impulse * (1.0 - error)
    assert load_distance <= sliding * impulse * (1.0 + error)
