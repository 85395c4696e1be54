"""Order of each integrator, observed on motions that are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.elements import GROUND, Attachment, Body, Linkage, Probe, Spring
from presswear.linkage.press import GEOMETRIES, Press
from presswear.scene.catalog import ideal
from presswear.trials.runs import order_of
from presswear.trials.verify import references

FREQUENCY, AMPLITUDE, DURATION = 1000.0, 0.01, 0.5


def oscillator() -> Linkage:
    """A mass on a spring along x: x = A cos(w t)."""
    spring = Spring(
        "spring",
        Attachment(GROUND, -1.0, 0.0),
        Attachment("mass", 0.0, 0.0),
        FREQUENCY**2,
        1.0,
    )
    return Linkage(
        "oscillator",
        (Body("mass", 1.0, 1.0),),
        (),
        (),
        (),
        (),
        Probe("mass", 0.0),
        gravity=0.0,
        springs=(spring,),
    )


def oscillator_error(accuracy: InHouse) -> tuple[float, int]:
    """Error at the end, in amplitudes, and steps made."""
    start = Start(np.array([AMPLITUDE, 0.0, 0.0]), np.zeros(3))
    run = accuracy.simulate(oscillator(), start, Plan(DURATION, 1, recorded_cycles=1))
    phase = FREQUENCY * DURATION
    x = run.end.position[0] / AMPLITUDE - math.cos(phase)
    v = run.end.velocity[0] / (AMPLITUDE * FREQUENCY) + math.sin(phase)
    steps = run.diagnostics["steps"]
    assert isinstance(steps, int)
    return math.hypot(x, v), steps


def test_rk4_is_of_fourth_order_on_an_oscillator() -> None:
    steps = [DURATION / n for n in (5000, 10000, 20000)]
    errors = [oscillator_error(InHouse("rk4", equal_step=step))[0] for step in steps]
    assert 3.9 < order_of(steps, errors) < 4.1


def test_rk4_is_of_fourth_order_on_andrews() -> None:
    """Against the same equations solved to round-off: the reference ends at 1.4e-9."""
    plan = Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1)
    linkage, start = references.andrews(), references.andrews_start()
    exact = InHouse(integration_tolerance=1e-12).simulate(linkage, start, plan).end.position
    steps = [references.ANDREWS_DURATION / n for n in (750, 1500, 3000)]
    errors = []
    for step in steps:
        end = InHouse("rk4", equal_step=step).simulate(linkage, start, plan).end
        errors.append(float(np.abs(end.position[2::3] - exact[2::3]).max()))
    assert 3.8 < order_of(steps, errors) < 4.2


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
def test_rk4_is_of_fourth_order_on_the_ideal_press(geometry: str) -> None:
    scene = replace(ideal(), mechanism=Press(geometry=GEOMETRIES[geometry]))
    period = scene.mechanism.period
    exact = scene.mechanism.ideal_motion(np.array([period]))
    steps = [period / n for n in (100, 200, 400, 800)]
    errors = []
    for step in steps:
        accuracy = InHouse("rk4", equal_step=step)
        run = accuracy.simulate(scene.linkage(), start_of(scene), Plan(period, 1))
        errors.append(float(np.abs(run.end.position - exact.position[0]).max()))
    assert 3.8 < order_of(steps, errors) < 4.2


def test_dop853_is_of_eighth_order_and_follows_its_tolerance() -> None:
    """The error goes with the tolerance, and with the eighth power of the mean step."""
    tolerances = [1e-8, 1e-9, 1e-10, 1e-11]
    found = [oscillator_error(InHouse(integration_tolerance=tolerance)) for tolerance in tolerances]
    errors = [error for error, _ in found]
    assert 0.85 < order_of(tolerances, errors) < 1.1
    assert 7.3 < order_of([DURATION / steps for _, steps in found], errors) < 8.7


def test_exudyn_is_of_second_order_on_the_ideal_press() -> None:
    scene = ideal()
    period = scene.mechanism.period
    exact = scene.mechanism.ideal_motion(np.array([period])).position[0]
    steps = [period / n for n in (500, 1000, 2000)]
    errors = []
    for step in steps:
        accuracy = ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=1e-12)
        run = accuracy.simulate(scene.linkage(), start_of(scene), Plan(period, 1))
        errors.append(float(np.abs(run.end.position - exact).max()))
    assert 1.9 < order_of(steps, errors) < 2.1


def test_exudyn_is_of_second_order_on_an_oscillator() -> None:
    start = Start(np.array([AMPLITUDE, 0.0, 0.0]), np.zeros(3))
    duration = 0.1
    steps = [1e-4, 5e-5, 2.5e-5]
    errors = []
    for step in steps:
        accuracy = ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=1e-12)
        plan = Plan(duration, 1, recorded_cycles=1)
        end = accuracy.simulate(oscillator(), start, plan).end
        errors.append(abs(end.position[0] / AMPLITUDE - math.cos(FREQUENCY * duration)))
    assert 1.9 < order_of(steps, errors) < 2.1
