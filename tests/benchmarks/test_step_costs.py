"""Cost of a step beside the loop by hand."""

import pytest
from step_costs import LOOP, step_costs


def test_steps_of_dae_are_timed_beside_those_of_the_loop():
    loop, radial, foundation, worn = step_costs(repeats=1, cycles=1)
    assert loop["method"] == LOOP
    assert loop["relative"] == loop["relative_trial"] == 1.0
    # Both end their steps at the same events, at one tolerance by two norms.
    steps = [row["steps_per_cycle"] for row in (loop, radial)]
    assert steps[1] == pytest.approx(steps[0], rel=0.3)
    costs = [row["cpu_s_per_step"] for row in (radial, foundation, worn)]
    assert costs[2] > 1.5 * max(costs[:2])
