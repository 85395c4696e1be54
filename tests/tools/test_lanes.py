"""Numbers of several lanes in kernels against numpy, lane by lane."""

import math
from typing import Any, cast

import numpy as np
import pytest

from presswear.physics.tree import cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import Kernel, compiled, lazily_compiled, specialised
from presswear.tools.errors import RunFailed
from presswear.tools.lanes import COUNTS, anywhere, lane_zeros, lanes_of, where

PAIR = np.dtype([("sum", np.float64), ("ratio", np.float64)])


@lazily_compiled((0.0, 0.0), 0, 0)
def polar(x: float, y: float) -> tuple[float, float]:
    return math.hypot(x, y), math.atan2(y, x)


@compiled
def calculate(x: Array, y: Array, pairs: Any, out: Array) -> None:
    total = 0.0
    for i in range(x.shape[0]):
        total += x[i]
        pairs[i].sum = total + 1.0
        pairs[i].ratio = x[i] / y[i]
        out[0, i] = where((x[i] > y[i]) & (y[i] != 0.0), math.sqrt(abs(x[i])), -pairs[i].sum)
        out[1, i] = max(min(x[i], y[i]), 0.25) - math.copysign(x[i], y[i])
        out[2, i], out[3, i] = polar(x[i], y[i])
        out[4, i] = abs(x[i]) ** 1.3
    if not anywhere(x[0] > 10.0):
        out[5, 0] = 7.0


@pytest.mark.parametrize("count", COUNTS)
def test_lanes_are_calculated_like_single_numbers(count: int) -> None:
    generator = np.random.default_rng(3)
    x, y = lane_zeros(5, count), lane_zeros(5, count)
    pairs, out = lane_zeros(5, count, PAIR), lane_zeros((6, 5), count)
    for lanes in (x, y):
        lanes_of(lanes)[:] = generator.standard_normal((5, count))
    calculate(x, y, pairs, out)
    found, rows = lanes_of(out), np.asarray(pairs).view(np.float64).reshape(5, 2, count)
    for k in range(count):
        single, one, two = np.zeros((6, 5)), lanes_of(x)[:, k].copy(), lanes_of(y)[:, k].copy()
        records = np.zeros(5, PAIR)
        calculate(one, two, records, single)
        np.testing.assert_array_equal(found[:, :, k], single)
        np.testing.assert_array_equal(rows[:, 0, k], records["sum"])
        np.testing.assert_allclose(records["sum"], 1.0 + np.cumsum(one), rtol=1e-15)
        chosen = np.where(one > two, np.sqrt(np.abs(one)), -records["sum"])
        np.testing.assert_array_equal(single[0], chosen)


FUNCTIONS = (
    *(math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.sinh, math.cosh),
    *(math.tanh, math.exp, math.expm1, math.log, math.log1p, math.log10, math.sqrt),
)


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: str(function.__name__))
def test_functions_of_the_math_module_take_lanes(function: Any) -> None:
    """A law written for one replicate then runs with several, with the same bits."""

    @compiled
    def apply(x: Array, out: Array) -> None:
        for i in range(x.shape[0]):
            out[i] = function(x[i])

    x, out = lane_zeros(3, 4), lane_zeros(3, 4)
    lanes_of(x)[:] = np.linspace(0.05, 0.95, 12).reshape(3, 4)
    apply(x, out)
    single = np.zeros(12)
    apply(lanes_of(x).ravel(), single)
    np.testing.assert_array_equal(lanes_of(out).ravel(), single)
    np.testing.assert_allclose(single, [function(one) for one in lanes_of(x).flat], rtol=1e-14)


@compiled
def branch(x: Array, out: Array) -> None:
    if x[0] > 1.0:
        out[0] = 1.0


def test_branch_on_lanes_is_one_line() -> None:
    line = cast(Kernel, branch).py_func.__code__.co_firstlineno + 2
    words = rf"^test_lanes\.py, line {line}: bool\(4 conditions\) cannot be compiled; .* where\(\)"
    with pytest.raises(RunFailed, match=words) as raised:
        specialised(branch, lane_zeros(1, 4), lane_zeros(1, 4))
    assert "\n" not in f"{raised.value}"


@compiled
def rotate(angle: Array, cosine: Array, sine: Array) -> None:
    for i in range(angle.shape[0]):
        cosine[i], sine[i] = cos_sin(angle[i])


def test_cosine_and_sine_are_exact_to_round_off() -> None:
    """Against 80 bits, over a million turns; on other processors long double has 64 bits."""
    generator = np.random.default_rng(5)
    for reach in (1.0, 1e3, 6e6):
        angle = generator.uniform(-reach, reach, 100_000)
        found = np.zeros((2, angle.size))
        rotate(angle, *found)
        exact = angle.astype(np.longdouble)
        assert np.abs(found[0] - np.cos(exact)).max() < 2.3e-16
        assert np.abs(found[1] - np.sin(exact)).max() < 2.3e-16
