"""Andrews' squeezer (IVP test set, IFToMM A03), beside what ``presswear verify`` compares."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from presswear.engines.base import Plan
from presswear.engines.dae.dynamics import evaluate, state_size, system_of
from presswear.engines.settings import InHouse
from presswear.physics.constraints import constraints_of
from presswear.physics.packed import pack
from presswear.validation import reference_problems as references

ANGLES = np.array(references.ANDREWS_ANGLES)
RATES = np.array(references.ANDREWS_RATES)


def test_bodies_join_at_the_start() -> None:
    """The seven angles of the reference close all three loops."""
    start = references.andrews_start()
    constraints = constraints_of(references.andrews())
    phi, phi_t, _, _ = constraints.evaluate(0.0, start.position, start.velocity)
    assert constraints.rows == 20
    assert np.abs(phi).max() < 1e-16
    assert np.abs(phi_t).max() == 0.0
    back = references.andrews_angles(start.position)
    np.testing.assert_allclose(back, references.ANDREWS_START, rtol=0.0, atol=1e-15)


def test_accelerations_at_the_start() -> None:
    """andrews.f: beta'' = 14222.4439199541138, Theta'' = -10666.8329399655854, the rest 0."""
    start = references.andrews_start()
    linkage = references.andrews()
    system = system_of(pack(linkage), constraints_of(linkage), start.position, 20.0, 20.0)
    state = np.zeros(state_size(system))
    state[:21] = start.position
    slope = np.zeros_like(state)
    evaluate(system, system.held, system.tree, np.zeros(0), 0.0, state, slope, True)
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


def test_energy_is_the_work_of_the_moment() -> None:
    """Kinetic and spring energy gained = 0.033 N m times the crank's turn."""
    plan = Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1)
    linkage, start = references.andrews(), references.andrews_start()
    end = InHouse().simulate(linkage, start, plan).end
    spring = linkage.springs[0]
    first, second = spring.ends

    def stored(position: NDArray[np.float64]) -> float:
        i = 3 * linkage.index(first.body)
        x, y, angle = position[i : i + 3]
        c, s = math.cos(angle), math.sin(angle)
        place = (
            x + c * first.x - s * first.y,
            y + s * first.x + c * first.y,
        )
        stretch = math.dist(place, (second.x, second.y)) - spring.length
        return 0.5 * spring.stiffness * stretch**2

    mass = np.array([m for body in linkage.bodies for m in (body.mass, body.mass, body.inertia)])
    kinetic = 0.5 * float(mass @ end.velocity**2)
    work = linkage.dead_loads[0].moment * (end.position[2] - start.position[2])
    assert kinetic + stored(end.position) - stored(start.position) == pytest.approx(work, rel=1e-10)
