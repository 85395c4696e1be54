"""Kernels that call each other: linked once, compiled apart, at once, and told of."""

import gc
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core.errors import NumbaError
from numpy.typing import NDArray

from presswear.tools.compiled import apart, compiled, fused, specialised, told_of_compiling

Array = NDArray[np.float64]


@compiled
def _leaf(x: float) -> float:
    return x * x + 1.0


@compiled
def _left(x: float) -> float:
    return 2.0 * _leaf(x)


@compiled
def _right(x: float) -> float:
    return _leaf(x) - x


@compiled
def _both(x: float) -> float:
    return _left(x) + _right(x) + _leaf(-x)


def signatures(kernel: Any) -> list[Any]:
    """Types of arguments that a kernel was compiled for as a whole."""
    return list(kernel.whole.overloads)


def test_a_kernel_takes_all_that_it_calls_with_it_and_none_of_it_is_compiled_alone() -> None:
    assert _both(3.0) == 2.0 * 10.0 + (10.0 - 3.0) + 10.0
    for part in (_leaf, _left, _right):
        assert not signatures(part)
    assert _left(3.0) == 20.0


class _Inner(NamedTuple):
    numbers: Array
    is_odd: bool
    nothing: Array | None


class _Outer(NamedTuple):
    inner: _Inner
    columns: Array
    factor: float


@compiled
def _inner_sum(inner: _Inner, from_place: int) -> float:
    total = 0.0 if inner.nothing is None else 1e3
    for x in inner.numbers[from_place:]:
        total += x
    return -total if inner.is_odd else total


@compiled
def _outer_sum(outer: _Outer, k: int) -> float:
    cut = _Inner(outer.columns[:, k], not outer.inner.is_odd, None)
    return outer.factor * (_inner_sum(outer.inner, 1) + _inner_sum(cut, 0))


def test_named_tuples_within_each_other_are_handed_over_whole() -> None:
    columns = np.arange(6.0).reshape(3, 2)
    for is_odd, sign in ((True, -1.0), (False, 1.0)):
        bare = _Outer(_Inner(np.array([1.0, 2.0, 4.0]), is_odd, None), columns, 2.0)
        assert _outer_sum(bare, 1) == 2.0 * sign * (6.0 - 9.0)
        full = bare._replace(inner=bare.inner._replace(nothing=columns[0]))
        assert _outer_sum(full, 0) == 2.0 * sign * (1006.0 - 6.0)


def test_garbage_is_collected_again_behind_the_compiler() -> None:
    @compiled
    def twice(x: float) -> float:
        return 2.0 * _leaf(x)

    @compiled
    def nonsense(x: float) -> float:
        return _leaf(x).no_attribute  # type: ignore[attr-defined]  # wrong on purpose

    with pytest.raises(NumbaError):
        nonsense(1.0)
    assert gc.isenabled()
    gc.disable()
    try:
        assert twice(1.0) == 4.0
        assert not gc.isenabled()
    finally:
        gc.enable()


PAIR = np.dtype([("one", np.float64), ("other", np.int64)])


@apart((0.0, 0), PAIR, 1, 0)
def _rare(pair: Any, numbers: Array, x: float) -> tuple[float, int]:
    pair.other += 1
    return pair.one * x + numbers[numbers.shape[0] - 1], numbers.shape[0]


@compiled
def _seldom(pairs: NDArray[np.void], numbers: Array, x: float) -> float:
    total = 0.0
    for k in range(pairs.shape[0]):
        if x > 0.0:
            value, count = _rare(pairs[k], numbers[:, k], x)
            total += value * count
    return total


def test_a_kernel_apart_is_compiled_when_it_is_called_first() -> None:
    pairs, numbers = np.zeros(2, PAIR), np.arange(6.0).reshape(3, 2)
    pairs["one"] = 10.0, 100.0
    assert _seldom(pairs, numbers, -1.0) == 0.0
    assert not signatures(_rare)
    # Columns have gaps, whole arrays none.
    assert _seldom(pairs, numbers, 2.0) == 3.0 * (20.0 + 4.0) + 3.0 * (200.0 + 5.0)
    assert len(signatures(_rare)) == 1
    assert pairs["other"].tolist() == [1, 1]


def test_compiling_is_told_with_its_time_and_loading_is_not() -> None:
    @compiled
    def half(x: float) -> float:
        return 0.5 * _leaf(x)

    heard: list[float] = []
    with told_of_compiling(heard.append):
        assert half(1.0) == 1.0
        assert half(3.0) == 5.0
    start, took = heard
    assert start == 0.0 < took
    specialised(half, 1)
    assert len(heard) == 2


def _told(tmp_path: Path, script: str) -> list[str]:
    """What a script prints that finds no compiled code."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-c", script]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return ran.stdout.split()


COUNTED = """
from numba.core import event
import presswear as pw
from presswear.physics.contact import note_foundation
from presswear.physics.wear import deposit_over_arc

class Count(event.Listener):
    compiled = 0
    def on_start(self, told): Count.compiled += 1
    def on_end(self, told): pass

event.register("numba:compile", Count())
pw.run(pw.scenes.wear_times(cycles=1, wear_updates=0), engine="%s")
print(Count.compiled, len(note_foundation.whole.overloads) + len(deposit_over_arc.whole.overloads))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "most"), [("exudyn-tree", 95), ("dae", 120)])
def test_a_first_start_compiles_few_kernels(tmp_path: Path, engine: str, most: int) -> None:
    """In-house some thirty belong to the recursion over the bodies of any linkage."""
    compiled, unused = map(int, _told(tmp_path, COUNTED % engine))
    assert 20 < compiled <= most
    assert unused == 0


def _product_and_sum(a: float, b: float, c: float) -> float:
    return a * b + c


def test_a_fused_kernel_rounds_once_or_as_others_do() -> None:
    plain, quick = compiled(_product_and_sum), fused(_product_and_sum)
    for n in range(1, 50):
        a, b, c = 1.0 + 1.0 / (3.0 * n), 1.0 - 1.0 / (7.0 * n), -1.0 - 0.1 / n
        assert plain(a, b, c) == a * b + c
        once = float(Fraction(a) * Fraction(b) + Fraction(c))
        assert quick(a, b, c) in (once, a * b + c)
