"""Parts that the trials share: checks, orders, shares of progress."""

import math

import pytest

from presswear.tools.errors import RunFailed
from presswear.validation.runs import Check, guarded, order_of, parts_of


def test_a_check_passes_up_to_its_bound_in_size() -> None:
    assert Check("order", 0.3, 0.3).passed
    assert Check("order", -0.3, 0.3).passed
    assert not Check("order", -0.4, 0.3).passed
    assert not Check("order", math.nan, 0.3).passed
    assert Check("reported", math.inf, None).passed


def test_the_order_is_the_slope() -> None:
    assert order_of([0.1, 0.05, 0.01], [3e-2, 0.75e-2, 3e-4]) == pytest.approx(2.0)
    assert order_of((4, 2, 1), [1.6e-5, 8e-6, 4e-6]) == pytest.approx(1.0)
    assert math.isnan(order_of((1, 2), [math.inf, 1e-6]))
    assert math.isnan(order_of((1, 2), [0.0, 1e-6]))
    assert math.isnan(order_of((1, 1), [1e-6, 1e-6]))
    assert math.isnan(order_of((), []))


def test_sections_share_the_whole() -> None:
    told: list[tuple[str, float]] = []
    sections = parts_of(lambda word, part: told.append((word, part)), {"one": 1, "two": 3})
    for part in (0.0, 1.0):
        sections["one"]("a", part)
    sections["two"]("b", 0.5)
    assert told == [("one: a", 0.0), ("one: a", 0.25), ("two: b", 0.625)]


def test_a_run_that_goes_on_and_on_is_stopped() -> None:
    plan = guarded(1.0, patience=-1.0)
    with pytest.raises(RunFailed, match=r"stopped after -1 s of CPU time at 20 %"):
        plan.advanced(0.2)
    guarded(1.0, patience=60.0).advanced(0.2)
