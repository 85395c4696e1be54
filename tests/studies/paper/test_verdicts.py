"""Ratios of intervals and the verdicts drawn from them."""

import math

import numpy as np
import pytest

from presswear.record.sampling import Interval
from presswear.studies.paper.evidence import Measured, Place
from presswear.studies.paper.printed import PRINTED, Printed
from presswear.studies.paper.verdicts import (
    Comparison,
    Expected,
    Standing,
    Verdict,
    difference,
    ratio,
    ratio_standing,
    standing,
    together,
    turned,
    verdict,
)

A, B = Place("speed-4pi", 0, "A"), Place("speed-8pi", 0, "A")


def known(
    value: float,
    half: float,
    draws: tuple[float, float] | None = None,
    first: tuple[float, float] | None = None,
) -> Measured:
    return Measured(value, value - half, value + half, draws, first, 30, 3)


def test_the_interval_of_a_ratio_covers_it() -> None:
    generator = np.random.default_rng(2)
    inside, draws = 0, 400
    for _ in range(draws):
        over, under = (generator.normal(mean, 0.3 * mean, 40) for mean in (3.0, 2.0))
        estimates = [
            known(float(s.mean()), 2.02 * float(s.std(ddof=1)) / math.sqrt(40))
            for s in (over, under)
        ]
        found = ratio([estimates[0]], [estimates[1]])
        assert found.low is not None
        assert found.high is not None
        inside += found.low <= 1.5 <= found.high
    assert 0.92 <= inside / draws <= 0.98


def test_an_interval_that_reaches_zero_bounds_no_ratio_from_above() -> None:
    found = ratio([known(2.0, 0.1)], [known(1.0, 1.5)])
    assert found.high == math.inf
    found = ratio([known(1.0, 1.5)], [known(2.0, 0.1)])
    assert found.low == 0.0


def test_differences_of_angles_go_the_short_way() -> None:
    found = difference(known(math.radians(5.0), 0.01), known(math.radians(355.0), 0.01), True)
    assert found.value == pytest.approx(math.radians(10.0))
    assert found.low == pytest.approx(math.radians(10.0) - 0.01 * math.sqrt(2.0))
    assert turned(math.pi + 0.1) == pytest.approx(0.1 - math.pi)


@pytest.mark.parametrize(
    ("interval", "expected", "word"),
    [
        (Interval(2.0, 1.5, 3.0), "more", Verdict.HOLDS),
        (Interval(2.0, 1.5, 3.0), "less", Verdict.FAILS),
        (Interval(2.0, 0.9, 3.0), "more", Verdict.OPEN),
        (Interval(0.5, 0.3, 0.9), "less", Verdict.HOLDS),
        (Interval(0.5, 0.3, 0.9), "more", Verdict.FAILS),
        (Interval(1.0, 0.99, 1.01), "same", Verdict.HOLDS),
        (Interval(1.0, 0.9, 1.1), "same", Verdict.OPEN),
        (Interval(1.3, 1.2, 1.4), "same", Verdict.FAILS),
        (Interval(2.0, None, None), "more", Verdict.OPEN),
        (None, "more", Verdict.MISSING),
    ],
)
def test_a_verdict_needs_the_whole_interval(
    interval: Interval | None, expected: Expected, word: Verdict
) -> None:
    assert verdict(interval, Comparison("force", (B,), (A,), expected)) is word


def test_differences_are_held_against_zero() -> None:
    part = Comparison("angle", (B,), (A,))
    assert verdict(Interval(0.2, 0.1, 0.3), part) is Verdict.HOLDS
    assert verdict(Interval(-0.2, -0.3, -0.1), part) is Verdict.FAILS


@pytest.mark.parametrize(
    ("parts", "word"),
    [
        ("hh", Verdict.HOLDS),
        ("hf", Verdict.IN_PART),
        ("ff", Verdict.FAILS),
        ("fo", Verdict.FAILS),
        ("ho", Verdict.OPEN),
        ("oo", Verdict.OPEN),
        ("hm", Verdict.HOLDS),
        ("mm", Verdict.MISSING),
    ],
)
def test_a_claim_holds_where_all_its_parts_do(parts: str, word: Verdict) -> None:
    words = {"h": Verdict.HOLDS, "f": Verdict.FAILS, "o": Verdict.OPEN, "m": Verdict.MISSING}
    assert together(words[letter] for letter in parts) is word


def printed(quantity: str, value: float) -> Printed:
    return Printed("5", "1", Place("speed-4pi", 1, "A"), quantity, value)


def test_a_printed_peak_is_held_against_single_cycles() -> None:
    ours = known(100.0, 5.0, draws=(60.0, 150.0), first=(100.0, 110.0))
    assert standing(printed("force", 140.0), ours) is Standing.INSIDE
    assert standing(printed("force", 151.0), ours) is Standing.ABOVE
    assert standing(printed("force", 59.0), ours) is Standing.BELOW
    assert standing(printed("force", 100.0), known(100.0, 5.0)) is Standing.OPEN
    first = known(100.0, 5.0, draws=(60.0, 150.0), first=(300.0, 320.0))
    assert standing(printed("force", 310.0), first) is Standing.INSIDE
    assert standing(printed("force", 100.0), None) is Standing.MISSING


def test_a_printed_depth_is_not_compared_and_an_angle_is_across_zero() -> None:
    assert standing(printed("depth", 1e-6), known(1e-5, 1e-7)) is Standing.FREE
    ours = known(math.radians(359.0), math.radians(5.0))
    assert standing(printed("angle", math.radians(2.0)), ours) is Standing.AGREES
    assert standing(printed("angle", math.radians(6.0)), ours) is Standing.DIFFERS


def test_printed_ratios_are_held_against_the_interval() -> None:
    assert ratio_standing(2.0, Interval(1.9, 1.5, 2.5)) is Standing.AGREES
    assert ratio_standing(3.0, Interval(1.9, 1.5, 2.5)) is Standing.DIFFERS
    assert ratio_standing(3.0, Interval(1.9, None, None)) is Standing.OPEN


def test_a_comparison_knows_what_the_paper_prints() -> None:
    second, first = Place("wear-times", 2, "A"), Place("wear-times", 1, "A")
    assert Comparison("depth", (second,), (first,)).printed == pytest.approx(1.178e-3 / 1.221e-6)
    angle = Comparison("angle", (second,), (first,)).printed
    assert angle == pytest.approx(math.radians(132.7 - 100.7))
    assert Comparison("velocity_off", (second,), (first,)).printed is None
    assert len({(item.place, item.quantity) for item in PRINTED}) == len(PRINTED) == 56
