"""Packed arguments: kernels read stored tuples and bound arguments."""

import gc
from typing import Any, NamedTuple

import numpy as np
import pytest

from presswear.tools.arrays import Array
from presswear.tools.compile import (
    compiled,
)
from presswear.tools.packing import PackedArguments, bind, pack_arguments, unpack

PAIR = np.dtype([("factor", np.float64), ("calls", np.int64)])


class Spring(NamedTuple):
    """A named tuple within another."""

    stiffness: float
    is_loose: bool
    lengths: Array


class Springs(NamedTuple):
    """Parts of all types."""

    number: int
    nothing: None
    spring: Spring
    pair: tuple[float, Array]


@compiled
def _spring_force(spring: Spring, i: int) -> float:
    return 0.0 if spring.is_loose else spring.stiffness * spring.lengths[i]


@compiled
def _sum_springs(packed: PackedArguments, x: float) -> float:
    springs, rest = unpack(packed)
    first, others = springs.pair
    total = x + first + others[0] + rest
    if springs.nothing is None:
        for i in range(springs.number):
            total += _spring_force(springs.spring, i)
    return total


@pytest.mark.parametrize("is_loose", [False, True])
def test_kernels_read_the_parts_of_stored_tuples(is_loose):
    spring = Spring(2.0, is_loose, np.array([[1.0, 9.0], [3.0, 9.0], [5.0, 9.0]])[:, 0])
    springs = Springs(2, None, spring, (0.25, np.full(1, 0.5)))
    total = bind(_sum_springs, pack_arguments(springs, 100.0))
    assert total(10.0) == 110.75 + (0.0 if is_loose else 8.0)
    spring.lengths[1] = 4.0
    assert total(10.0) == 110.75 + (0.0 if is_loose else 10.0)


@compiled
def _gather(packed: PackedArguments, x: float) -> float:
    """Add up the arguments, and store the sum."""
    (pairs, rows, _nothing, single), out = unpack(packed)
    total = x
    for i in range(single.shape[0]):
        total += single[i]
        if pairs[i].calls:
            total += pairs[i].factor
        for j in range(rows.shape[1]):
            total += rows[i, j]
    out[0] = total
    return total


def _gathered(count: int) -> tuple[Any, Array, float]:
    """Return a bound call whose arrays are not kept here, its output, and the sum of them."""
    random = np.random.default_rng(count)
    pairs = np.zeros(count, PAIR)
    single = random.random(count)
    rows = random.random((count, 2))
    pairs["calls"] = random.random(count) < 0.5
    pairs["factor"] = random.random(count)
    out = np.zeros(1)
    call = bind(_gather, pack_arguments((pairs, rows, None, single), out))
    expected = single.sum() + rows.sum() + pairs["factor"][pairs["calls"] > 0].sum()
    assert call(0.5) == pytest.approx(0.5 + expected, abs=1e-12)
    single += 1.0
    return call, out, expected + count


def test_bound_arguments_are_read_may_change_and_stay_alive():
    calls = [_gathered(count) for count in (0, 1, 3)]
    gc.collect()
    # They would take the memory of arrays that were freed.
    others = [np.full(2, 1e9) for _ in range(1000)]
    for call, out, expected in calls:
        assert call(0.0) == out[0] == pytest.approx(expected, abs=1e-12)
    assert len(others) == 1000
