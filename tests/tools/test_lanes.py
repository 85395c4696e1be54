"""Numbers of several lanes in kernels against numpy, lane by lane."""

import math
from typing import Any

import numpy as np
import pytest

from presswear.physics.tree import cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled, lazily_compiled
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
