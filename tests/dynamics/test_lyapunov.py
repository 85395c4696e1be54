"""The estimator of exponents against published values and closed forms."""

import math
from collections.abc import Callable
from typing import cast

import numba
import numpy as np
import pytest
from bouncing_table import BouncingTable
from impact_oscillator import ImpactOscillator
from numpy.typing import NDArray

import presswear as pw
from presswear.dynamics.lyapunov import Exponent, exponent_of, growths

Array = NDArray[np.float64]


def exponent(
    step: Callable[[Array], Array], start: Array, restarts: int, duration: float, apart: float
) -> Exponent:
    """The exponent of a map that carries nothing."""
    found = growths(lambda x, _: (step(x), None), start, None, restarts, np.full(start.size, apart))
    return exponent_of(found, duration)


def held(found: Exponent, expected: float) -> None:
    """The value within 3 %, and in an interval that is no wider."""
    assert found.value == pytest.approx(expected, rel=0.03)
    assert found.half_width is not None
    assert abs(found.value - expected) <= found.half_width <= 0.03 * abs(expected)


def _lorenz(x: Array, steps: int) -> Array:
    """RK4 of Lorenz's equations at sigma = 10, r = 28, b = 8/3."""
    h = 0.005
    for _ in range(steps):
        y = x
        total = np.zeros(3)
        for weight, reach in ((1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)):
            slope = np.array(
                [
                    10.0 * (y[1] - y[0]),
                    y[0] * (28.0 - y[2]) - y[1],
                    y[0] * y[1] - 8.0 / 3.0 * y[2],
                ]
            )
            total += weight * slope
            y = x + reach * h * slope
        x = x + h / 6.0 * total
    return x


lorenz = cast(Callable[[Array, int], Array], numba.njit(_lorenz))


def test_lorenz() -> None:
    """0.9056 (Sprott, Chaos and Time-Series Analysis, 2003)."""
    start = lorenz(np.array([1.0, 2.0, 20.0]), 10_000)
    held(exponent(lambda x: lorenz(x, 40), start, 15_000, 0.2, 1e-7), 0.9056)


def test_logistic_map() -> None:
    """ln 2 at r = 4."""
    found = exponent(lambda x: 4.0 * x * (1.0 - x), np.array([0.3123]), 20_000, 1.0, 1e-9)
    held(found, math.log(2.0))


def test_henon_map() -> None:
    """0.41922 at a = 1.4, b = 0.3 (Sprott)."""
    found = exponent(
        lambda x: np.array([1.0 - 1.4 * x[0] ** 2 + x[1], 0.3 * x[0]]),
        np.array([0.1, 0.1]),
        20_000,
        1.0,
        1e-9,
    )
    held(found, 0.41922)
    assert found.is_chaotic


@pytest.mark.parametrize("part", [0.3, 0.6])
def test_ball_on_a_table_that_repeats_itself(part: float) -> None:
    """Both multipliers of a period have the size e, so that the exponent is ln(e) omega / (2 pi).

    Between impacts the flow is seen, whose twins bounce at different moments.
    """
    ball = BouncingTable(0.8)
    low, high = ball.existence, ball.doubling
    ball = ball.driven(low + part * (high - low))
    found = growths(
        lambda x, t: (ball.after(x, t, 0.9 * ball.period), t + 0.9 * ball.period),
        *ball.period_one(0.15 * ball.period),
        1000,
        np.array([1e-7, 1e-7 * ball.frequency]),
    )
    told = exponent_of(found, 0.9 * ball.period)
    expected = math.log(0.8) / ball.period
    assert told.value == pytest.approx(expected, rel=0.03)
    assert told.half_width is not None
    assert abs(told.value - expected) <= told.half_width
    assert not told.is_chaotic


@pytest.mark.parametrize(("damping", "frequency"), [(0.0, 2.6), (0.05, 2.4), (0.05, 2.0)])
def test_oscillator_beside_a_wall_that_repeats_itself(damping: float, frequency: float) -> None:
    """The greater multiplier of the orbit tells its exponent: a pair of complex ones, or real."""
    own = ImpactOscillator(0.8, frequency, damping)
    t, v, motion = own.periodic(1)
    multipliers = np.linalg.eigvals(motion)
    assert np.prod(multipliers).real == pytest.approx(
        0.8**2 * math.exp(-2.0 * damping * own.period), rel=1e-9
    )
    begun, _ = own.after(np.array([0.0, -0.8 * v]), t, 0.35 * own.period)
    interval = 0.9 * own.period
    found = growths(
        lambda x, t: (own.after(x, t, interval)[0], t + interval),
        begun,
        t + 0.35 * own.period,
        400,
        np.full(2, 1e-7),
    )
    told = exponent_of(found, interval)
    expected = math.log(np.abs(multipliers).max()) / own.period
    assert told.value == pytest.approx(expected, rel=0.03)
    assert told.half_width is not None
    assert abs(told.value - expected) <= told.half_width


def test_twins_part_as_the_tangent_flow_does() -> None:
    """Chaos beside a wall: the exponent by closed forms, with saltation, along the same motion."""
    own = ImpactOscillator(0.8, 2.8)
    t, v, _ = own.periodic(1)
    state = own.after(np.array([0.0, -0.801 * v]), t, 0.35 * own.period)[0]
    t += 0.35 * own.period
    count = 1500
    twins = growths(
        lambda x, t: (own.after(x, t, own.period)[0], t + own.period),
        state,
        t,
        count,
        np.full(2, 1e-8),
    )
    direction, tangent = np.full(2, math.sqrt(0.5)), np.zeros(count)
    for k in range(count):
        state, moved = own.after(state, t, own.period)
        t += own.period
        direction = moved @ direction
        size = float(np.linalg.norm(direction))
        tangent[k], direction = math.log(size), direction / size
    told, expected = (exponent_of(found, own.period) for found in (twins, tangent))
    assert told.is_chaotic
    assert told.value == pytest.approx(expected.value, rel=3e-3)


def test_a_sum_of_logarithms_is_what_grows() -> None:
    """A linear map's exponent is the logarithm of its greater eigenvalue, whatever the scales."""
    turn = np.array([[2.0, 1.0], [1.0, 1.0]])
    found = growths(
        lambda x, _: (np.mod(turn @ x, 1e6), None),
        np.array([0.1, 0.2]),
        None,
        25,
        np.array([1e-3, 1e-2]),
    )
    golden = 0.5 * (3.0 + math.sqrt(5.0))
    assert exponent_of(found[-10:], 1.0).value == pytest.approx(math.log(golden), rel=1e-6)


def test_bad_distances_are_refused() -> None:
    with pytest.raises(pw.InputError, match="apart"):
        exponent(lambda x: x, np.zeros(2), 5, 1.0, 0.0)
    with pytest.raises(pw.InputError, match="restarts = 0"):
        exponent(lambda x: x, np.zeros(2), 0, 1.0, 1e-9)
    with pytest.raises(pw.InputError, match="restart 0: twins 0 times"):
        exponent(lambda x: 0.0 * x, np.zeros(2), 3, 1.0, 1e-9)
