"""Order of each integrator, observed on motions that are known."""

import math

import numpy as np
from scipy.integrate import DOP853 as SCIPY_8
from scipy.integrate import RK45

from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.spring import Spring
from presswear.physics.dormand_prince import DOP853, DOPRI5
from presswear.validation.cases import order_of

FREQUENCY = 1000.0
AMPLITUDE = 0.01
DURATION = 0.5


def oscillator() -> Linkage:
    """A mass on a spring along x: x = A cos(w t)."""
    spring = Spring(
        "spring",
        Attachment(GROUND, -1.0, 0.0),
        Attachment("mass", 0.0, 0.0),
        FREQUENCY**2,
        1.0,
    )
    return assemble(
        (Body("mass", 1.0, 1.0),),
        output=OutputPoint("mass"),
        gravity=0.0,
        springs=(spring,),
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


def test_dop853_is_of_eighth_order_and_follows_its_tolerance():
    """The error goes with the tolerance, and with the eighth power of the mean step."""
    tolerances = [1e-8, 1e-9, 1e-10, 1e-11]
    found = [
        oscillator_error(InHouse(integration_tolerance=tolerance))
        for tolerance in tolerances
    ]
    errors = [error for error, _ in found]
    assert 0.85 < order_of(tolerances, errors) < 1.1
    assert 7.3 < order_of([DURATION / steps for _, steps in found], errors) < 8.7


def test_coefficients_are_those_of_scipy():
    """To the last bit."""
    five = (DOPRI5.a[:, :5], *DOPRI5[1:4])
    eight = (*DOP853[:5],)
    scipy_5 = RK45.A, RK45.B, RK45.C, RK45.E
    scipy_8 = SCIPY_8.A[:12, :12], SCIPY_8.B, SCIPY_8.C[:12], SCIPY_8.E5, SCIPY_8.E3
    for values, expected in zip((*five, *eight), (*scipy_5, *scipy_8), strict=True):
        assert np.array_equal(values, expected)
