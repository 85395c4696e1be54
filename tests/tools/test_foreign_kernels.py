"""Numba functions of a user in the process in which kernels were compiled."""

from typing import Any

import numba
import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.compile import compiled


@compiled
def _first(numbers: Array) -> float:
    return float(numbers[0])


def test_a_row_that_a_function_returns_keeps_its_array():
    assert _first(np.array([3.0])) == 3.0  # compiled here, or in an earlier test

    def second_row(columns: int) -> Any:
        table = np.arange(2.0 * columns).reshape(2, columns)
        return table[1]

    row = numba.njit(second_row)(3)
    assert row.tolist() == [3.0, 4.0, 5.0]
    assert row.base is not None  # else the memory of the row is free
