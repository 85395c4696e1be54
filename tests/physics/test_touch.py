"""Touches found between two states, and the step that divides a contact."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from two_bodies import JOINT, placed

from presswear.physics.packed import JOINT as JOINT_RECORD
from presswear.physics.touchdown import (
    LEAST_STEPS,
    STEPS,
    TOUCH,
    contact_step,
    crossing,
    early_separation,
    hermite,
)
from presswear.tools.compiled import Records

NO_TOUCH = 2.0
MASS = 0.1
PARTS = 50.0


def _cubic(a: float, b: float, c: float, d: float, s: float) -> tuple[float, float]:
    """Value and slope of a + b s + c s^2 + d s^3."""
    return a + s * (b + s * (c + s * d)), b + s * (2.0 * c + s * 3.0 * d)


def _meeting(stiffness: float, exponent: float = 1.5, mass: float = MASS) -> Records:
    """A joint whose pin and bearing meet with a mass, kg."""
    joint = np.zeros(1, JOINT_RECORD)
    joint["stiffness"], joint["exponent"], joint["effective_mass"] = stiffness, exponent, mass
    return joint[0]


coefficients = st.floats(-10.0, 10.0)


@given(
    coefficients,
    coefficients,
    coefficients,
    coefficients,
    st.floats(1e-3, 10.0),
    st.floats(0.0, 1.0),
)
def test_hermite_reproduces_any_cubic(
    a: float, b: float, c: float, d: float, h: float, s: float
) -> None:
    p0, slope0 = _cubic(a, b, c, d, 0.0)
    p1, slope1 = _cubic(a, b, c, d, 1.0)
    value, rate = hermite(p0, slope0 / h, p1, slope1 / h, h, s)
    exact, slope = _cubic(a, b, c, d, s)
    assert value == pytest.approx(exact, abs=1e-13)
    assert rate == pytest.approx(slope / h, abs=1e-12 / h)


@given(st.floats(0.01, 0.99), st.floats(0.1, 5.0), st.floats(0.0, 5.0), st.floats(1e-7, 1e-3))
def test_crossing_finds_the_root_of_a_rising_cubic(
    root: float, slope: float, bend: float, h: float
) -> None:
    # (s - r)(k + w (s - r)^2) rises throughout and is zero at r alone.
    def value(s: float) -> tuple[float, float]:
        x = s - root
        return 1e-6 * x * (slope + bend * x * x), 1e-6 * (slope + 3.0 * bend * x * x)

    (p0, slope0), (p1, slope1) = value(0.0), value(1.0)
    # The two states are rounded numbers: some ulp of their size over the slope at the root.
    rounding = 32.0 * np.finfo(float).eps * (slope + 3.0 * bend) / slope
    assert crossing(p0, slope0 / h, p1, slope1 / h, h) == pytest.approx(root, abs=rounding)


@given(st.floats(0.05, 0.9), st.floats(0.02, 0.5), st.floats(-1.0, 3.0))
def test_crossing_finds_touch_and_go(root: float, length: float, lean: float) -> None:
    leaves = root + length
    if leaves >= 0.999:
        return

    # Positive between the two roots only: the third factor keeps its sign.
    def value(s: float) -> tuple[float, float]:
        third = 1.5 + 0.25 * lean * s
        p = (s - root) * (leaves - s)
        return p * third, (leaves + root - 2.0 * s) * third + p * 0.25 * lean

    (p0, r0), (p1, r1) = value(0.0), value(1.0)
    assert p0 < 0.0
    assert p1 < 0.0
    assert crossing(p0, r0, p1, r1, 1.0) == pytest.approx(root, abs=1e-12)


@pytest.mark.parametrize(
    ("p0", "r0", "p1", "r1"),
    [
        (-1.0, 0.5, -0.5, 0.5),  # still approaching
        (-1.0, -1.0, -2.0, -1.0),  # leaving
        (-1.0, 1.0, -1.0, -1.0),  # comes to 3/4 of the way and turns
        (-1.0, -1.0, -1.0, 1.0),  # turns away from it
        (-1.0, 0.0, -1.0, 0.0),
    ],
)
def test_no_crossing(p0: float, r0: float, p1: float, r1: float) -> None:
    assert crossing(p0, r0, p1, r1, 1.0) == NO_TOUCH


def test_crossing_at_the_end_of_a_step_is_in_the_step() -> None:
    assert crossing(-1.0, 1.0, 1e-300, 1.0, 1.0) == pytest.approx(1.0, abs=1e-15)
    assert crossing(0.0, 1.0, 1.0, 1.0, 1.0) == pytest.approx(0.0, abs=1e-15)


def test_crossing_of_three_roots_is_the_first() -> None:
    # (s - 0.1)(s - 0.5)(s - 0.7): touches at 0.1, opens at 0.5, touches again at 0.7.
    a, b, c, d = -0.035, 0.47, -1.3, 1.0
    (p0, r0), (p1, r1) = _cubic(a, b, c, d, 0.0), _cubic(a, b, c, d, 1.0)
    assert crossing(p0, r0, p1, r1, 1.0) == pytest.approx(0.1, abs=1e-12)


@pytest.mark.parametrize("speed", [1e-4, 0.01, 0.3, 5.0])
def test_contact_step_divides_a_hertz_impact(speed: float) -> None:
    stiffness = 1.25e10
    deepest = (5.0 * MASS * speed**2 / (4.0 * stiffness)) ** 0.4
    duration = 2.9432751843 * deepest / speed
    step = contact_step(_meeting(stiffness), 0.0, speed, PARTS)
    # Half a period at the deepest point's tangent stiffness: pi sqrt(8 / 15) against 2.943.
    assert step * PARTS / duration == pytest.approx(
        math.pi * math.sqrt(8.0 / 15.0) / 2.9432751843, rel=1e-9
    )
    assert 0.75 < step * PARTS / duration <= 1.0


def test_contact_step_of_a_linear_spring_is_exact() -> None:
    half_period = math.pi * math.sqrt(MASS / 1e6)
    for depth, rate in ((0.0, 0.3), (1e-4, 0.0), (5e-5, -0.1)):
        step = contact_step(_meeting(1e6, 1.0), depth, rate, PARTS)
        assert step == pytest.approx(half_period / PARTS, rel=1e-12)


@given(st.floats(1e-9, 1e-5), st.floats(-1.0, 1.0), st.floats(1.0, 2.5))
def test_contact_step_depends_on_energy_alone(depth: float, rate: float, exponent: float) -> None:
    stiffness = 1e10
    energy = 0.5 * MASS * rate**2 + stiffness * depth ** (exponent + 1.0) / (exponent + 1.0)
    deepest = ((exponent + 1.0) * energy / stiffness) ** (1.0 / (exponent + 1.0))
    here = contact_step(_meeting(stiffness, exponent), depth, rate, PARTS)
    turned = contact_step(_meeting(stiffness, exponent), deepest, 0.0, PARTS)
    assert here == pytest.approx(turned, rel=1e-9)


def test_contact_step_without_energy_sets_no_limit() -> None:
    assert contact_step(_meeting(1e10), 0.0, 0.0, PARTS) == math.inf
    assert contact_step(_meeting(1e10), -1e-3, 0.0, PARTS) == math.inf


@pytest.mark.parametrize("rate", [0.0, 0.3])
def test_contact_step_of_a_body_that_does_not_give_way_is_no_limit(rate: float) -> None:
    """Two driven bodies meet with infinite mass; a step that is no number helps nobody."""
    assert contact_step(_meeting(1e10, mass=math.inf), 1e-6, rate, PARTS) > 0.0


def _closed(penetration: float, rate: float, taken: int) -> Records:
    """A joint that has been closed for some steps."""
    last = np.zeros(1, TOUCH)
    last["penetration"], last["rate"], last["steps"] = penetration, rate, taken
    last["longest_step"] = math.inf
    return last[0]


def _steps() -> Records:
    steps = np.zeros(1, STEPS)
    steps["free"], steps["per_contact"], steps["sustained"] = 1e-4, PARTS, 10.0
    steps["least"] = 1e-9
    return steps[0]


def _opened(gap: float, rate: float) -> Records:
    """Contact of a round joint that leaves straight along the x axis."""
    rates = np.zeros(6)
    rates[3] = rate
    return placed(JOINT, -gap, 0.0, angles=(0.0, 0.0), rates=rates).contact()


def test_a_contact_that_ends_after_a_few_steps_is_divided() -> None:
    # Leaves at constant speed: open after half the step.
    h, speed = 1e-5, 0.1
    last = _closed(0.5 * h * speed, -speed, 3)
    wanted = early_separation(last, _steps(), _opened(0.5 * h * speed, -speed), h)
    assert wanted == pytest.approx(0.5 * h / (LEAST_STEPS - 3 + 1), rel=1e-6)
    assert last["longest_step"] == wanted


def test_a_contact_of_enough_steps_may_end() -> None:
    h, speed = 1e-5, 0.1
    opened = _opened(0.5 * h * speed, -speed)
    for taken, accepted in ((LEAST_STEPS - 1, False), (LEAST_STEPS, True), (60, True)):
        last = _closed(0.5 * h * speed, -speed, taken)
        assert (early_separation(last, _steps(), opened, h) < 0.0) == accepted
    begun_inside = _closed(0.5 * h * speed, -speed, 3)
    begun_inside["started_closed"] = True
    assert early_separation(begun_inside, _steps(), opened, h) == -1.0


def test_a_contact_that_goes_on_is_not_divided() -> None:
    last = _closed(1e-6, -0.1, 3)
    assert early_separation(last, _steps(), _opened(-1e-9, -0.1), 1e-5) == -1.0
    assert last["longest_step"] == math.inf


def test_the_shortest_step_is_not_divided() -> None:
    last = _closed(1e-11, -0.1, 3)
    assert early_separation(last, _steps(), _opened(1e-11, -0.1), 1.2e-9) == -1.0
