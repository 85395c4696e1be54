"""Dry friction in a mechanism: a block pressed on a floor, with the in-house engine.

The floor is a bearing so large that it is flat; the force law is that of any joint.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from presswear.engines.base import Plan, Run
from presswear.engines.settings import InHouse
from presswear.trials.verify import references
from presswear.trials.verify.verify import FRICTION, GRAVITY, creep, slowed, turning_points

INTERVAL = references.SDND100_INTERVAL
EXTREMA = references.SDND100_EXTREMA


def released(upper: float, intervals: float = 4.5) -> Run:
    """SDND100 from its release, for so many intervals."""
    linkage, start = references.sdnd100(upper)
    plan = Plan(intervals * INTERVAL, 1, recorded_cycles=1)
    return InHouse(integration_tolerance=1e-11).simulate(linkage, start, plan)


@pytest.mark.parametrize("upper", [1e-5, 1e-6])
def test_mass_on_a_spring_turns_where_code_aster_says(upper: float) -> None:
    """0.85, -0.65, 0.45, -0.25, 0.05 mm at intervals of pi/100 s, then no more turn.

    On the ramp friction is missing for about v1 / (mu g) at each turn, which shifts
    the turning points in proportion to v1; the arc of the floor adds less than 1e-10.
    """
    times, places = turning_points(released(upper), EXTREMA[0])
    assert len(times) == 4
    np.testing.assert_allclose(places, EXTREMA[1:], rtol=0.0, atol=1e-8 * (upper / 1e-6))
    np.testing.assert_allclose(times, INTERVAL * np.arange(1, 5), rtol=0.0, atol=2.0 * upper)


def test_what_sticks_creeps_back() -> None:
    """With v0 = 0 the ramp never holds: x decays at v1 k / (mu m g), 0.01 per second here."""
    upper = 1e-6
    decay = upper * references.SDND100_STIFFNESS / (0.1 * references.SDND100_GRAVITY)
    before, after = released(upper, 4.5), released(upper, 5.5)
    ratio = after.end.position[0] / before.end.position[0]
    assert ratio == pytest.approx(math.exp(-decay * INTERVAL), rel=1e-7)
    # The block still bobs on the elastic floor, and friction with it.
    assert after.end.velocity[0] == pytest.approx(-decay * after.end.position[0], rel=1e-4)
    assert before.end.position[0] == pytest.approx(EXTREMA[-1], abs=1e-7)


def test_friction_takes_the_energy_that_is_missing() -> None:
    """From 0.85 to 0.05 mm: mu m g over the path of 3.6 mm, less what the ramp spares."""
    run = released(1e-6)
    lost = run.diagnostics["friction_loss_J"]
    path = sum(abs(b - a) for a, b in pairwise(EXTREMA))
    assert isinstance(lost, float)
    assert lost == pytest.approx(0.1 * references.SDND100_GRAVITY * path, rel=1e-5)
    residual = run.diagnostics["energy_residual_J"]
    assert isinstance(residual, float)
    assert abs(residual) < 1e-9 * lost


@pytest.mark.parametrize("slope", [0.01, 0.05, 0.09])
def test_block_creeps_down_an_incline(slope: float) -> None:
    """v0 + (v1 - v0) tan(theta) / mu, to what the arc of the floor turns the slope."""
    assert creep(slope) == pytest.approx(references.creep_speed(FRICTION, slope), rel=1e-6)


@pytest.mark.parametrize("time", [0.002, 0.005, 0.009, 0.0097, 0.011, 0.0125])
def test_block_slows_on_the_flat(time: float) -> None:
    """V - mu g t, below v1 an exponential approach to v0; v1 is reached at 9.17 ms."""
    assert slowed(0.01, time) == pytest.approx(
        references.slowed_speed(FRICTION, 0.01, GRAVITY, time), abs=1e-9
    )
