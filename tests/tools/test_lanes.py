"""Numbers of four lanes in kernels against numpy, lane by lane."""

from typing import cast

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.compile import Kernel, compiled
from presswear.tools.lanes import COUNT, anywhere, lane_of, lanes_at, where


@compiled
def calculate(x: Array, y: Array, out: Array) -> None:
    """Write sums, differences, products and choices of four neighbours, lane by lane."""
    one, two = lanes_at(x, 0, 1), lanes_at(y, 0, 2)
    rows = (one + two, one - 0.5 * two, where(one > two, one, two))
    for k in range(COUNT):
        for i in range(3):
            out[i, k] = lane_of(rows[i], k)
    if anywhere(one > 10.0):
        out[0, 0] = 7.0


def test_lanes_are_calculated_like_single_numbers() -> None:
    """Compiled and in plain Python."""
    x, y = np.random.default_rng(3).standard_normal((2, 1, 8))
    one, two = x[0, 1 : 1 + COUNT], y[0, 2 : 2 + COUNT]
    expected = [one + two, one - 0.5 * two, np.maximum(one, two)]
    for function in (calculate, cast(Kernel, calculate).py_func):
        out = np.zeros((3, COUNT))
        function(x, y, out)
        np.testing.assert_array_equal(out, expected)
        function(100.0 + np.abs(x), y, out)
        assert out[0, 0] == 7.0
