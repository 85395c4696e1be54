"""Ratios of intervals and the verdicts drawn from them."""

import math

import numpy as np
import pytest

from presswear.studies.paper.claims import Comparison, Expected, turned
from presswear.studies.paper.evidence import Ends, Measured
from presswear.studies.paper.printed import PRINTED, Place, Printed
from presswear.studies.paper.verdicts import (
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
    ("interval", "expected", "word"),
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
    interval: Measured | None, expected: Expected, word: Verdict
) -> None:
    assert verdict(interval, Comparison("force", (B,), (A,), expected)) is word


def test_differences_are_held_against_zero() -> None:
    part = Comparison("angle", (B,), (A,))
    assert verdict(Measured(0.2, (0.1, 0.3)), part) is Verdict.HOLDS
    assert verdict(Measured(-0.2, (-0.3, -0.1)), part) is Verdict.FAILS


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
    assert agreement(2.0, Measured(1.9, (1.5, 2.5))) is Standing.AGREES
    assert agreement(3.0, Measured(1.9, (1.5, 2.5))) is Standing.DIFFERS
    assert agreement(3.0, Measured(1.9, None)) is Standing.OPEN


def test_a_comparison_knows_what_the_paper_prints() -> None:
    second, first = Place("wear-times", 2, "A"), Place("wear-times", 1, "A")
    assert Comparison("depth", (second,), (first,)).printed == pytest.approx(1.178e-3 / 1.221e-6)
    angle = Comparison("angle", (second,), (first,)).printed
    assert angle == pytest.approx(math.radians(132.7 - 100.7))
    assert Comparison("velocity_off", (second,), (first,)).printed is None
    assert len({(item.place, item.quantity) for item in PRINTED}) == len(PRINTED) == 56
