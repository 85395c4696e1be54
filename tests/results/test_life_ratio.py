"""Two lives beside each other."""

import math
from dataclasses import replace

import pytest

from presswear.results.life import LifeResult, life_ratio

LIFE = LifeResult("limit", "", 1e6, 0.04, 0.0, 0.9, (), (), ())


def test_a_ratio_has_the_errors_of_both_lives() -> None:
    longer = replace(LIFE, strokes=2e6, sampling=0.03)
    low, high = 2.0 * math.exp(-0.05), 2.0 * math.exp(0.05)
    assert life_ratio(longer, LIFE) == (f"2.00 ({low:.2f} to {high:.2f})", "1")
    assert life_ratio(replace(LIFE, sampling=0.1), replace(LIFE, sampling=0.0))[1] == "0.5"


def test_half_a_standard_deviation_has_the_probability_of_the_normal_distribution() -> None:
    half = 0.1
    exact = replace(LIFE, sampling=0.0)
    beside = replace(LIFE, strokes=1e6 * math.exp(0.5 * half / 1.959964), sampling=half)
    assert float(life_ratio(beside, exact)[1]) == pytest.approx(0.691462, abs=0.005)


def test_a_life_without_limit_or_interval_is_not_compared() -> None:
    for other in (replace(LIFE, ended="at_most"), replace(LIFE, sampling=None)):
        assert life_ratio(LIFE, other) == ("", "")
