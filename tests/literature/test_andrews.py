"""Andrews' squeezer (IVP test set, IFToMM A03), beside what ``presswear verify`` compares."""

import math

import numpy as np

from presswear.engines.base import Plan
from presswear.engines.dae.dynamics import evaluate, state_size, system_of
from presswear.engines.settings import InHouse
from presswear.physics.constraints import constraints_of
from presswear.physics.packed import pack
from presswear.validation import reference_problems as references

ANGLES = np.array(references.ANDREWS_ANGLES)
RATES = np.array(references.ANDREWS_RATES)


def test_accelerations_at_the_start() -> None:
    """andrews.f: beta'' = 14222.4439199541138, Theta'' = -10666.8329399655854, the rest 0."""
    start = references.andrews_start()
    linkage = references.andrews()
    system = system_of(pack(linkage), constraints_of(linkage), start.position, 20.0, 20.0)
    state = np.zeros(state_size(system))
    state[:21] = start.position
    slope = np.zeros_like(state)
    evaluate(system, system.held, system.tree, system.alone, None, 0.0, state, slope, True)
    found = references.andrews_angles(slope[21:42])
    np.testing.assert_allclose(
        found, [14222.4439199541138, -10666.8329399655854, 0, 0, 0, 0, 0], rtol=1e-12, atol=1e-7
    )


def test_projection_reaches_the_reference() -> None:
    """Angles to 1e-8 rad; rates, three powers of ten larger, to 1e-5 rad/s.

    What is left, 1.4e-9 rad, is the same at any tolerance and step of either
    integrator: it is the reference's.
    """
    plan = Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1)
    engine = InHouse(projection="on")
    run = engine.simulate(references.andrews(), references.andrews_start(), plan)
    angles = references.andrews_angles(run.end.position)
    assert np.abs(angles - ANGLES).max() < 1e-8
    assert np.abs(references.andrews_angles(run.end.velocity) - RATES).max() < 1e-5
    # Several turns, not an angle of one turn.
    assert angles[0] > 5.0 * math.pi
