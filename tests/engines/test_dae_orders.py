"""Order of each integrator, observed on motions that are known."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import DOP853 as SCIPY_8
from scipy.integrate import RK45

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.dormand_prince import DOP853, DOPRI5
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.elements import GROUND, Attachment, Body, OutputPoint
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Spring
from presswear.linkage.mechanisms import GEOMETRIES, Press
from presswear.scene.catalog import ideal
from presswear.tools.arrays import Array
from presswear.validation import reference_problems as references
from presswear.validation.cases import order_of

FREQUENCY, AMPLITUDE, DURATION = 1000.0, 0.01, 0.5


def oscillator() -> Linkage:
    """A mass on a spring along x: x = A cos(w t)."""
    spring = Spring(
        "spring", Attachment(GROUND, -1.0, 0.0), Attachment("mass", 0.0, 0.0), FREQUENCY**2, 1.0
    )
    return assemble(
        (Body("mass", 1.0, 1.0),), output=OutputPoint("mass"), gravity=0.0, springs=(spring,)
    )


def oscillator_error(accuracy: Engine, duration: float = DURATION) -> tuple[float, int]:
    """Error at the end, in amplitudes, and steps made."""
    start = Start(np.array([AMPLITUDE, 0.0, 0.0]), np.zeros(3))
    run = accuracy.simulate(oscillator(), start, Plan(duration, 1, recorded_cycles=1))
    phase = FREQUENCY * duration
    x = run.end.position[0] / AMPLITUDE - math.cos(phase)
    v = run.end.velocity[0] / (AMPLITUDE * FREQUENCY) + math.sin(phase)
    steps = run.diagnostics["steps"]
    assert isinstance(steps, int)
    return math.hypot(x, v), steps


def rk4(step: float) -> Engine:
    return InHouse("rk4", equal_step=step)


def trapezoidal(step: float) -> Engine:
    return ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=1e-12)


Stepped = Callable[[float], Engine]


@pytest.mark.parametrize(
    ("engine", "duration", "counts", "order"),
    [(rk4, DURATION, (5000, 10000, 20000), 4.0), (trapezoidal, 0.1, (1000, 2000, 4000), 2.0)],
)
def test_orders(engine: Stepped, duration: float, counts: tuple[int, ...], order: float) -> None:
    steps = [duration / n for n in counts]
    errors = [oscillator_error(engine(step), duration)[0] for step in steps]
    assert order_of(steps, errors) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(
    ("engine", "geometry", "counts", "order", "within"),
    [
        *((rk4, geometry, (100, 200, 400, 800), 4.0, 0.2) for geometry in GEOMETRIES),
        (trapezoidal, "standard", (500, 1000, 2000), 2.0, 0.1),
    ],
)
def test_order_on_the_ideal_press(
    engine: Stepped, geometry: str, counts: tuple[int, ...], order: float, within: float
) -> None:
    scene = replace(ideal(), mechanism=Press(geometry=GEOMETRIES[geometry]))
    period = scene.mechanism.period
    exact = scene.ideal.at(np.array([period])).position[0]
    steps = [period / n for n in counts]
    errors = []
    for step in steps:
        run = engine(step).simulate(scene.linkage(), start_of(scene), Plan(period, 1))
        errors.append(float(np.abs(run.end.position - exact).max()))
    assert order_of(steps, errors) == pytest.approx(order, abs=within)


def test_rk4_is_of_fourth_order_on_andrews() -> None:
    """Against the same equations solved to round-off: the reference ends at 1.4e-9."""
    plan = Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1)

    def end(engine: InHouse) -> Array:
        run = engine.simulate(references.andrews(), references.andrews_start(), plan)
        return run.end.position[2::3]

    exact = end(InHouse(integration_tolerance=1e-12))
    steps = [references.ANDREWS_DURATION / n for n in (750, 1500, 3000)]
    errors = [float(np.abs(end(InHouse("rk4", equal_step=step)) - exact).max()) for step in steps]
    assert 3.8 < order_of(steps, errors) < 4.2


def test_dop853_is_of_eighth_order_and_follows_its_tolerance() -> None:
    """The error goes with the tolerance, and with the eighth power of the mean step."""
    tolerances = [1e-8, 1e-9, 1e-10, 1e-11]
    found = [oscillator_error(InHouse(integration_tolerance=tolerance)) for tolerance in tolerances]
    errors = [error for error, _ in found]
    assert 0.85 < order_of(tolerances, errors) < 1.1
    assert 7.3 < order_of([DURATION / steps for _, steps in found], errors) < 8.7


def test_coefficients_are_those_of_scipy() -> None:
    """To the last bit."""
    five, eight = (DOPRI5.a[:, :5], *DOPRI5[1:4]), (*DOP853[:5],)
    scipy_5 = RK45.A, RK45.B, RK45.C, RK45.E
    scipy_8 = SCIPY_8.A[:12, :12], SCIPY_8.B, SCIPY_8.C[:12], SCIPY_8.E5, SCIPY_8.E3
    for values, expected in zip((*five, *eight), (*scipy_5, *scipy_8), strict=True):
        assert np.array_equal(values, expected)
