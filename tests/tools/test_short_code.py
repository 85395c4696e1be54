"""Short code of elements, loops, ``max`` and ``min`` against plain Python."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

from presswear.tools.arrays import Array
from presswear.tools.compile import Kernel, compiled

PAIR = np.dtype([("calls", np.int64), ("factor", np.float64)])


def in_python(kernel: Any) -> Callable[..., Any]:
    """Return the function of a kernel."""
    return cast(Kernel, kernel).py_func


@compiled
def _shift(numbers: Array, table: Array, pairs: Any, k: int) -> float:
    numbers[k] += table[k, -1] + table[-1][k]
    table[k - 2, 0] = numbers[-k]
    row = table[k]
    row[0] += 1.0
    pairs[-k].factor = pairs[k - 1].factor + pairs[0].calls
    return numbers[k] + row.shape[0]


@pytest.mark.parametrize("step", [1, 2])
def test_elements_at_computed_places(step: int) -> None:
    results = []
    for kernel in (_shift, in_python(_shift)):
        numbers = np.arange(3.0 * step)[::step]
        table = np.arange(9.0 * step).reshape(3, -1)[:, ::step]
        pairs = np.zeros(2 * step, PAIR)[::step]
        pairs["factor"] = 3.0, 5.0
        pairs["calls"] = 7
        value = kernel(numbers, table, pairs.view(np.recarray), 1)
        results.append((value, numbers.tolist(), table.tolist(), pairs.tolist()))
    assert results[0] == results[1]


@compiled
def _loops(start: int, end: int) -> int:
    seen = 0
    for k in range(end):
        seen = 10 * seen + k
    for k in range(start, end):
        seen = 10 * seen + k
    for k in range(end, start, -1):
        seen = 10 * seen + k
    for k in range(start, end, 3):
        if k == 4:
            continue
        seen = 10 * seen + k
    for k in range(end, start, -2):
        seen = 10 * seen + k
    return seen


@pytest.mark.parametrize("ends", [(0, 0), (1, 5), (2, 3), (5, 1), (-2, 2), (0, 4)])
def test_loops_over_ranges(ends: tuple[int, int]) -> None:
    assert _loops(*ends) == in_python(_loops)(*ends)


@compiled
def _extremes(x: float, y: float, k: int) -> tuple[float, float, float, float, int]:
    return max(x, y), min(x, y), max(x, k), min(k, x, y), max(k, 3)


@pytest.mark.parametrize("y", [-1.0, 0.5, 2.0, np.nan])
@pytest.mark.parametrize("x", [-2.0, -0.0, 2.0, np.nan])
def test_larger_and_smaller_of_numbers(x: float, y: float) -> None:
    for k in (-1, 0, 5):
        *numbers, integer = in_python(_extremes)(x, y, k)
        expected = *map(float, numbers), integer
        assert repr(_extremes(x, y, k)) == repr(expected)
