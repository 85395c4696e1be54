"""Normal force, friction ramp and stiffness against values and motions known in closed form."""

import math
from decimal import Decimal, localcontext
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from presswear.linkage.laws import (
    FrictionLaw,
    NormalLaw,
    delivered_restitution,
    greatest_penetration,
    hertz_stiffness,
    lankarani_nikravesh_damping,
)
from presswear.physics.laws import FRICTION, friction_force, friction_ramp, normal_force

GRAVITY = 9.81
LOWER, UPPER = 1e-4, 1e-3

penetrations = st.floats(0.0, 1e-3)
rates = st.floats(-20.0, 20.0)
onsets = st.floats(1e-6, 20.0)
exponents = st.sampled_from([1.0, 1.5, 2.0, 2.2, 2.5])
dampings = st.floats(0.0, 30.0)


@given(penetrations, rates, onsets, exponents, dampings)
def test_normal_force_never_pulls(
    depth: float, rate: float, onset: float, exponent: float, damping: float
) -> None:
    force = normal_force(depth, rate, onset, 1e10, exponent, damping)
    assert math.isfinite(force)
    assert force >= 0.0


@given(st.floats(-1.0, 0.0), rates, onsets, exponents, dampings)
def test_no_force_while_open(
    gap: float, rate: float, onset: float, exponent: float, damping: float
) -> None:
    assert normal_force(gap, rate, onset, 1e10, exponent, damping) == 0.0


def friction_law(*numbers: float) -> Any:
    return np.array([numbers], FRICTION)[0]


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 2.2])
def test_normal_force_is_equation_8(exponent: float) -> None:
    depth, rate, onset, stiffness, damping = 3e-6, 0.07, 0.2, 1.25e10, 0.1425
    by_hand = stiffness * depth**exponent + damping * stiffness * depth**exponent * rate / onset
    assert normal_force(depth, rate, onset, stiffness, exponent, damping) == pytest.approx(
        by_hand, rel=1e-14
    )


@given(rates, onsets, exponents, dampings)
def test_normal_force_is_continuous_at_touch(
    rate: float, onset: float, exponent: float, damping: float
) -> None:
    # With n >= 1 the force at depth d is below K d (1 + chi |rate| / onset) for d < 1.
    depth, stiffness = 1e-30, 1e10
    bound = stiffness * depth * (1.0 + damping * abs(rate) / onset)
    assert normal_force(depth, rate, onset, stiffness, exponent, damping) <= bound * (1.0 + 1e-12)


def test_general_power_agrees_with_the_square_root() -> None:
    near = math.nextafter(1.5, 2.0)
    for depth in (1e-12, 1e-8, 1e-5, 1e-3):
        fast = normal_force(depth, 0.1, 0.1, 1.25e10, 1.5, 0.1)
        general = normal_force(depth, 0.1, 0.1, 1.25e10, near, 0.1)
        # d ln F / dn = ln d, and n differs by 2.2e-16; a power costs a few ulp more.
        assert general == pytest.approx(fast, rel=2e-14)


@pytest.mark.parametrize(
    ("speed", "part"),
    [
        (0.0, 0.0),
        (5e-5, 0.0),
        (1e-4, 0.0),
        (3.25e-4, 0.25),
        (5.5e-4, 0.5),
        (7.75e-4, 0.75),
        (1e-3, 1.0),
        (1.0, 1.0),
    ],
)
def test_friction_ramp_piecewise(speed: float, part: float) -> None:
    assert friction_ramp(speed, LOWER, UPPER) == pytest.approx(part, abs=1e-15)
    assert friction_ramp(-speed, LOWER, UPPER) == friction_ramp(speed, LOWER, UPPER)


@given(st.floats(-1.0, 1.0), st.floats(0.0, 1e4), st.floats(0.0, 0.8))
def test_friction_is_odd_opposes_sliding_and_is_bounded(
    speed: float, normal: float, coefficient: float
) -> None:
    force = friction_force(speed, normal, friction_law(coefficient, LOWER, UPPER))
    assert force == -friction_force(-speed, normal, friction_law(coefficient, LOWER, UPPER))
    assert force * speed <= 0.0
    assert abs(force) <= coefficient * normal
    if abs(speed) >= UPPER:
        assert abs(force) == coefficient * normal


@given(st.floats(-2e-3, 2e-3), st.floats(1e-9, 1e-6))
def test_friction_is_continuous_in_speed(speed: float, change: float) -> None:
    here = friction_force(speed, 100.0, friction_law(0.1, LOWER, UPPER))
    there = friction_force(speed + change, 100.0, friction_law(0.1, LOWER, UPPER))
    steepest = 0.1 * 100.0 / (UPPER - LOWER)
    assert abs(there - here) <= steepest * change * (1.0 + 1e-6)


def test_friction_without_a_dead_band_is_a_plain_ramp() -> None:
    assert friction_ramp(0.0, 0.0, 1e-3) == 0.0
    assert friction_ramp(2e-4, 0.0, 1e-3) == pytest.approx(0.2, rel=1e-14)


def test_stiffness_as_printed() -> None:
    # (1 - 0.09) / 200e9 = 4.55e-12; 4 / (3 * 9.1e-12) = 1.465201465e11;
    # 0.015 * 0.0142 / 0.0292 = 7.294520548e-3, root 8.540796540e-2.
    printed = hertz_stiffness(0.015, 0.0142, 200e9, 0.3, "paper")
    assert printed == pytest.approx(1.2513987e10, rel=1e-7)


def test_stiffness_of_a_pin_in_a_hole() -> None:
    # 0.015 * 0.0142 / 0.0008 = 0.26625, root 0.515994186.
    conforming = hertz_stiffness(0.015, 0.0142, 200e9, 0.3, "refined")
    assert conforming == pytest.approx(7.5603544e10, rel=1e-7)
    for clearance in (0.8e-3, 0.6e-3):
        pin = 0.015 - clearance
        ratio = hertz_stiffness(0.015, pin, 200e9, 0.3, "refined") / hertz_stiffness(
            0.015, pin, 200e9, 0.3, "paper"
        )
        assert ratio == pytest.approx(math.sqrt((0.015 + pin) / clearance), rel=1e-12)
        assert 6.0 < ratio < 7.01


def test_stiffness_scales_with_the_material() -> None:
    base = hertz_stiffness(0.015, 0.0142, 200e9, 0.3, "paper")
    assert hertz_stiffness(0.015, 0.0142, 100e9, 0.3, "paper") == pytest.approx(0.5 * base)
    stiffer = hertz_stiffness(0.015, 0.0142, 200e9, 0.5, "paper")
    assert stiffer / base == pytest.approx(0.91 / 0.75, rel=1e-14)


@pytest.mark.parametrize(("nominal", "factor"), [(0.9, 0.1425), (0.5, 0.5625), (1.0, 0.0)])
def test_lankarani_nikravesh_factor(nominal: float, factor: float) -> None:
    assert lankarani_nikravesh_damping(nominal) == pytest.approx(factor, rel=1e-14)


def _restitution_to_fifty_digits(damping: float) -> float:
    """Root of (1 + e') chi = ln[(1 + chi) / (1 - chi e')] by bisection in y = 1 - chi e'.

    There the equation reads ln y - y = ln(1 + chi) - (1 + chi), whose left side rises
    from y = 0 to 1.
    """
    with localcontext() as context:
        context.prec = 50
        whole = 1 + Decimal(damping)
        wanted = whole.ln() - whole
        # Without the small term y, y = exp(wanted): the root lies between this and e times it.
        low, high = wanted.exp(), min(Decimal(1), (wanted + 1).exp())
        for _ in range(120):
            middle = (low + high) / 2
            low, high = (middle, high) if middle.ln() - middle < wanted else (low, middle)
        return float((1 - low) / Decimal(damping))


@given(st.floats(1e-10, 100.0) | st.floats(1e-10, 1e-3))
@example(1e-10)
@example(1e-7)
@example(1e-5)
@example(0.1425)
@example(8.0)
@example(38.4)
@example(100.0)
def test_delivered_restitution_for_any_damping(damping: float) -> None:
    exact = _restitution_to_fifty_digits(damping)
    assert delivered_restitution(damping) == pytest.approx(exact, rel=1e-8)


@given(st.floats(0.0, 10.0), exponents)
def test_greatest_penetration_falls_with_damping(damping: float, exponent: float) -> None:
    deep = greatest_penetration(0.1, 0.3, 1.25e10, exponent, damping)
    elastic = greatest_penetration(0.1, 0.3, 1.25e10, exponent, 0.0)
    assert 0.0 < deep <= elastic


def test_greatest_penetration_is_smooth_where_its_formula_changes() -> None:
    below = greatest_penetration(0.1, 0.3, 1.25e10, 1.5, 1e-5)
    above = greatest_penetration(0.1, 0.3, 1.25e10, 1.5, math.nextafter(1e-5, 1.0))
    assert above == pytest.approx(below, rel=1e-10)


def test_laws_are_data() -> None:
    assert NormalLaw(1e10) == NormalLaw(1e10, 1.5, 0.0)
    assert FrictionLaw() == FrictionLaw(0.0, 1e-4, 1e-3)


def _slide(pull: float, start: float, coefficient: float, duration: float) -> float:
    """Speed of a block of 1 kg after a time, pulled by a force per mass, on the ramp law."""
    normal = math.sqrt(GRAVITY**2 - pull**2)

    def rate(_: float, speed: NDArray[np.float64]) -> list[float]:
        friction = friction_force(float(speed[0]), normal, friction_law(coefficient, LOWER, UPPER))
        return [pull + friction]

    motion = solve_ivp(rate, (0.0, duration), [start], method="DOP853", rtol=1e-10, atol=1e-14)
    return float(motion.y[0, -1])


@pytest.mark.parametrize("slope", [0.01, 0.05, 0.09])
def test_block_on_an_incline_creeps(slope: float) -> None:
    coefficient = 0.1
    pull = GRAVITY * math.sin(math.atan(slope))
    creep = LOWER + (UPPER - LOWER) * slope / coefficient
    # The approach decays with mu g cos / (v1 - v0) = 1090 per second: 0.05 s is e^-54.
    assert _slide(pull, 0.0, coefficient, 0.05) == pytest.approx(creep, rel=1e-8)
    assert _slide(pull, 5e-3, coefficient, 0.2) == pytest.approx(creep, rel=1e-8)


def test_block_slows_on_the_flat() -> None:
    coefficient, start = 0.1, 0.01
    slowing = coefficient * GRAVITY
    reached = (start - UPPER) / slowing
    half = _slide(0.0, start, coefficient, 0.5 * reached)
    assert half == pytest.approx(start - slowing * 0.5 * reached, rel=1e-10)
    for later in (5e-4, 1e-3, 3e-3):
        ramp = LOWER + (UPPER - LOWER) * math.exp(-slowing * later / (UPPER - LOWER))
        assert _slide(0.0, start, coefficient, reached + later) == pytest.approx(ramp, rel=1e-8)


def test_mass_on_a_spring_with_dry_friction() -> None:
    """SDND100 (code_aster V5.01.100): extrema 0.85, -0.65, 0.45, -0.25, 0.05 mm."""
    stiffness, coefficient, gravity, sharp = 1e4, 0.1, 10.0, 1e-7

    def rate(_: float, state: NDArray[np.float64]) -> list[float]:
        friction = friction_force(float(state[1]), gravity, friction_law(coefficient, 0.0, sharp))
        return [float(state[1]), -stiffness * float(state[0]) + friction]

    def standing(_: float, state: NDArray[np.float64]) -> float:
        return float(state[1])

    motion = solve_ivp(
        rate,
        (0.0, 4.5 * math.pi / 100.0),
        [0.85e-3, 0.0],
        method="Radau",
        rtol=1e-9,
        atol=1e-13,
        events=standing,
    )
    times, places = motion.t_events[0], motion.y_events[0][:, 0]
    turns = times > 1e-3
    times, places = times[turns][:4], places[turns][:4]
    # The ramp leaves friction out for about v1 / (mu g) = 1e-7 s at each turn.
    np.testing.assert_allclose(places, [-0.65e-3, 0.45e-3, -0.25e-3, 0.05e-3], atol=1e-8)
    np.testing.assert_allclose(times, np.arange(1, 5) * math.pi / 100.0, atol=2e-6)
