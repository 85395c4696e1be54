"""Ratios of intervals and the verdicts drawn from them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from presswear.paper.claims import Comparison, Expected, turned
from presswear.paper.evidence import Ends, Measured
from presswear.paper.printed import PRINTED, Place, Printed
from presswear.paper.verdicts import (
    Standing,
    Verdict,
    agreement,
    difference,
    ratio,
    standing,
    together,
    verdict,
)

A, B = Place("speed-4pi", 0, "A"), Place("speed-8pi", 0, "A")


def known(
    value: float, half: float, draws: Ends | None = None, first: Ends | None = None
) -> Measured:
    return Measured(value, (value - half, value + half), draws, first)


def test_the_interval_of_a_ratio_covers_it() -> None:
    generator = np.random.default_rng(2)
    inside, draws = 0, 400
    for _ in range(draws):
        samples = [generator.normal(mean, 0.3 * mean, 40) for mean in (3.0, 2.0)]
        over, under = (
            known(float(s.mean()), 2.02 * float(s.std(ddof=1)) / math.sqrt(40)) for s in samples
        )
        ends = ratio([over], [under]).ends
        assert ends is not None
        inside += ends[0] <= 1.5 <= ends[1]
    assert 0.92 <= inside / draws <= 0.98


@pytest.mark.parametrize(("over", "under", "end"), [(0.1, 1.5, math.inf), (1.5, 0.1, 0.0)])
def test_an_interval_that_reaches_zero_leaves_a_side_open(
    over: float, under: float, end: float
) -> None:
    ends = ratio([known(1.0, over)], [known(1.0, under)]).ends
    assert ends is not None
    assert end in ends


def test_differences_of_angles_go_the_short_way() -> None:
    found = difference(known(math.radians(5.0), 0.01), known(math.radians(355.0), 0.01), True)
    assert found.value == pytest.approx(math.radians(10.0))
    half = 0.01 * math.sqrt(2.0)
    assert found.ends == pytest.approx((math.radians(10.0) - half, math.radians(10.0) + half))
    assert turned(math.pi + 0.1) == pytest.approx(0.1 - math.pi)


@pytest.mark.parametrize(
    ("ours", "expected", "word"),
    [
        (Measured(2.0, (1.5, 3.0)), "more", Verdict.HOLDS),
        (Measured(2.0, (1.5, 3.0)), "less", Verdict.FAILS),
        (Measured(2.0, (0.9, 3.0)), "more", Verdict.OPEN),
        (Measured(0.5, (0.3, 0.9)), "less", Verdict.HOLDS),
        (Measured(0.5, (0.3, 0.9)), "more", Verdict.FAILS),
        (Measured(1.0, (0.99, 1.01)), "same", Verdict.HOLDS),
        (Measured(1.0, (0.9, 1.1)), "same", Verdict.OPEN),
        (Measured(1.3, (1.2, 1.4)), "same", Verdict.FAILS),
        (Measured(2.0, None), "more", Verdict.OPEN),
        (None, "more", Verdict.MISSING),
    ],
)
def test_a_verdict_needs_the_whole_interval(
    ours: Measured | None, expected: Expected, word: Verdict
) -> None:
    """Ratios are held against one, differences against zero."""
    assert verdict(ours, Comparison("force", (B,), (A,), expected)) is word
    if ours and ours.ends:
        less_one = Measured(ours.value - 1.0, (ours.ends[0] - 1.0, ours.ends[1] - 1.0))
        assert verdict(less_one, Comparison("angle", (B,), (A,), expected)) is word


@pytest.mark.parametrize(
    ("parts", "word"),
    list(zip(("h", "hh", "hf", "ff", "fo", "ho", "oo", "hm", "mm"), "hhpffoohm", strict=True)),
)
def test_a_claim_holds_where_all_its_parts_do(parts: str, word: str) -> None:
    words = dict(zip("hpfom", Verdict, strict=True))
    assert together(words[letter] for letter in parts) is words[word]


def stands(quantity: str, value: float, ours: Measured | None) -> Standing:
    return standing(Printed("5", "1", Place("speed-4pi", 1, "A"), quantity, value), ours)


def test_a_printed_peak_is_held_against_single_cycles() -> None:
    ours = known(100.0, 5.0, draws=(60.0, 150.0), first=(100.0, 110.0))
    assert stands("force", 140.0, ours) is Standing.INSIDE
    assert stands("force", 151.0, ours) is Standing.ABOVE
    assert stands("force", 59.0, ours) is Standing.BELOW
    assert stands("force", 310.0, replace(ours, first=(300.0, 320.0))) is Standing.INSIDE
    assert stands("force", 100.0, known(100.0, 5.0)) is Standing.OPEN
    assert stands("force", 100.0, None) is Standing.MISSING


def test_a_printed_depth_is_not_compared_and_an_angle_is_across_zero() -> None:
    assert stands("depth", 1e-6, known(1e-5, 1e-7)) is Standing.FREE
    ours = known(math.radians(359.0), math.radians(5.0))
    assert stands("angle", math.radians(2.0), ours) is Standing.AGREES
    assert stands("angle", math.radians(6.0), ours) is Standing.DIFFERS


def test_printed_ratios_are_held_against_the_interval() -> None:
    assert agreement(2.0, Measured(1.9, (1.5, 2.5))) is Standing.AGREES
    assert agreement(3.0, Measured(1.9, (1.5, 2.5))) is Standing.DIFFERS
    assert agreement(3.0, Measured(1.9, None)) is Standing.OPEN
    assert agreement(3.0, None) is Standing.MISSING


def test_a_comparison_knows_what_the_paper_prints() -> None:
    second, first = Place("wear-times", 2, "A"), Place("wear-times", 1, "A")
    assert Comparison("depth", (second,), (first,)).printed == pytest.approx(1.178e-3 / 1.221e-6)
    angle = Comparison("angle", (second,), (first,)).printed
    assert angle == pytest.approx(math.radians(132.7 - 100.7))
    assert Comparison("velocity_off", (second,), (first,)).printed is None
    assert len({(item.place, item.quantity) for item in PRINTED}) == len(PRINTED) == 56
