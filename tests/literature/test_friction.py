"""SDND100, a block that slides on a floor and sticks, beside what ``presswear verify`` compares.

The floor is a bearing so large that it is flat; the force law is that of any joint.
"""

import math
from itertools import pairwise

import pytest

from presswear.engines.base import Plan, Run
from presswear.engines.settings import InHouse
from presswear.validation import reference_problems as references

INTERVAL = references.SDND100_INTERVAL
EXTREMA = references.SDND100_EXTREMA


UPPER = 1e-6  # Speed above which friction is full, m/s


def released(intervals: float = 4.5) -> Run:
    linkage, start = references.sdnd100(UPPER)
    plan = Plan(intervals * INTERVAL, 1, recorded_cycles=1)
    return InHouse(integration_tolerance=1e-11).simulate(linkage, start, plan)


def test_what_sticks_creeps_back() -> None:
    """With v0 = 0 the ramp never holds: x decays at v1 k / (mu m g), 0.01 per second here."""
    decay = UPPER * references.SDND100_STIFFNESS / (0.1 * references.SDND100_GRAVITY)
    before, after = released(4.5), released(5.5)
    ratio = after.end.position[0] / before.end.position[0]
    assert ratio == pytest.approx(math.exp(-decay * INTERVAL), rel=1e-7)
    # The block still bobs on the elastic floor, and friction with it.
    assert after.end.velocity[0] == pytest.approx(-decay * after.end.position[0], rel=1e-4)
    assert before.end.position[0] == pytest.approx(EXTREMA[-1], abs=1e-7)


def test_friction_takes_the_energy_that_is_missing() -> None:
    """From 0.85 to 0.05 mm: mu m g over the path of 3.6 mm, less what the ramp spares."""
    run = released()
    lost = run.diagnostics["friction_loss_J"]
    path = sum(abs(b - a) for a, b in pairwise(EXTREMA))
    assert isinstance(lost, float)
    assert lost == pytest.approx(0.1 * references.SDND100_GRAVITY * path, rel=1e-5)
    residual = run.diagnostics["energy_residual_J"]
    assert isinstance(residual, float)
    # At every tolerance: the weight times the last digit of the way to the middle of the floor.
    weight = lost / (0.1 * path)
    assert abs(residual) < weight * math.ulp(references.sdnd100(UPPER)[0].clearances[0].clearance)
