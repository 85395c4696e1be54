"""Exudyn with bodies and joints against closed forms and conservation laws."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from runs import momenta, residual, run_scene

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import Attachment
from presswear.scene.catalog import wear_times
from presswear.validation import reference_problems as references


def at(ring: tuple[float, ...], shaft: tuple[float, ...]) -> Start:
    """Start with both bodies' x, y, theta, then their rates, six numbers each."""
    state = np.array([ring, shaft])
    return Start(state[:, :3].ravel(), state[:, 3:].ravel())


def run_pair(linkage: Linkage, start: Start, duration: float, steps: int = 50) -> Run:
    accuracy = ExudynJoints(steps, 10, free_step=2e-5, newton=1e-10)
    return accuracy.simulate(linkage, start, Plan(duration, 1))


def free_pair(
    friction: float, bearing: tuple[float, float], pin: tuple[float, float]
) -> Linkage:
    """Two free bodies that meet off their mass centres."""
    linkage = references.Impact(0.9).linkage
    ends: dict[str, Any] = {"bearing": Attachment("ring", *bearing)}
    ends["pin"] = Attachment("shaft", *pin)
    joint = replace(linkage.clearances[0], friction=FrictionLaw(friction), **ends)
    return replace(linkage, clearances=(joint,))


def test_free_impact_conserves_momentum():
    """One eccentric impact of two spinning free bodies.

    Linear momentum holds to round-off.  Angular momentum does as far as the forces
    are concerned; the trapezoidal rule adds an error of second order in the step.
    """
    linkage = free_pair(0.3, (0.1, 0.02), (-0.05, 0.03))
    start = at((0.0, 0.0, 0.0, 0.0, 0.0, 2.0), (0.15, -0.01, 0.0, 0.3, 0.4, -30.0))
    before = momenta(linkage, start)
    errors = {}
    for steps in (50, 100, 400):
        run = run_pair(linkage, start, 0.001, steps)
        assert run.recorder.records.counters["contacts"][0] == 1
        change = np.abs(momenta(linkage, run.end) - before)
        assert change[:2].max() < 1e-14 * np.abs(before[:2]).max()
        errors[steps] = change[2]
    assert errors[50] < 1e-10
    assert errors[400] < 1e-10 * abs(before[2])
    assert errors[50] / errors[100] > 3.0
    exact = (
        InHouse(integration_tolerance=1e-11)
        .simulate(linkage, start, Plan(0.001, 1))
        .end
    )
    change = np.abs(exact.velocity - start.velocity).max()
    assert change > 1.0
    assert np.abs(run.end.velocity - exact.velocity).max() < 3e-6 * change


def test_onset_speed_at_the_working_step_under_acceleration():
    """A pin on a spinning arm meets its bearing on an arc: speed and time to 1e-6."""
    arm = 0.05
    spin = 40.0
    linkage = free_pair(0.0, (0.0, 0.0), (arm, 0.0))
    start = at((arm, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, spin))
    run = ExudynJoints(50, 10, free_step=5e-5).simulate(linkage, start, Plan(0.001, 1))
    # |e| is the chord 2 arm sin(spin t / 2).
    half = math.asin(linkage.clearances[0].clearance / (2.0 * arm))
    onset, _, closing = run.recorder.stored_contacts(0)[0, :3]
    assert run.recorder.records.counters["contacts"][0] >= 1
    assert onset == pytest.approx(2.0 * half / spin, rel=1e-6)
    assert closing == pytest.approx(arm * spin * math.cos(half), rel=1e-6)


def test_impacts_at_the_pivot_of_a_driven_crank_are_resolved():
    """A drive holds the angle of its body only: the crank gives way in its bearing."""
    run = run_scene(replace(wear_times(), joints="O2"), ExudynJoints(), 0.2)
    counters = run.recorder.records.counters[0]
    assert counters["contacts"] > 5
    assert counters["fewest_steps"] >= 20
    assert residual(run) < 1e-6


CHAIN = "crank 2, crank 7, plate 4 and rod 3"


@pytest.mark.parametrize(
    ("joints", "omitted"), [("A", "crank 2"), ("AC", "crank 2"), ("C", CHAIN)]
)
def test_bodies_that_are_left_out_move_and_bear_the_same(joints, omitted):
    scene = replace(wear_times(), joints=joints)
    accuracy = scene.numerics.joints.for_cycle(scene.mechanism.period)
    fine = replace(
        accuracy,
        steps_per_contact=200,
        steps_sustained=40,
        free_step=accuracy.longest(0.0) / 4,
        newton=1e-11,
    )
    exact = InHouse(integration_tolerance=1e-11)
    ours, reference = (run_scene(scene, engine, 0.03) for engine in (fine, exact))
    assert f"drives, {omitted} prescribed;" in str(ours.diagnostics["model"])
    assert ours.recorder.records.counters["contacts"].sum() >= 2
    assert ours.end.position == pytest.approx(reference.end.position, abs=2e-7)
    assert ours.recorder.records.torque == pytest.approx(
        reference.recorder.records.torque, abs=2e-3
    )
    for k in range(len(joints)):
        (expected,) = reference.recorder.each_cycle("load_distance", k)
        (load_distance,) = ours.recorder.each_cycle("load_distance", k)
        assert load_distance == pytest.approx(expected, rel=2e-4)
    for name in ("drive_work_J", "contact_loss_J"):
        exchanged = float(reference.diagnostics["drive_exchange_J"])
        expected_work = float(reference.diagnostics[name])
        assert ours.diagnostics[name] == pytest.approx(
            expected_work, abs=5e-6 * exchanged
        )
    rows = ours.recorder.rows
    assert np.ptp(rows[:, -2]) > 0.01  # the torque of drive 2
