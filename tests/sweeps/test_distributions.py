"""Distributions as they are typed, against closed forms and scipy's own truncated ones."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from presswear.sweeps.distributions import parse
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity

LENGTH = Quantity("m", 0.0, 1.0, "", "")
PURE = Quantity("", 0.0, 1.0, "", "", open_low=True)
U = np.linspace(0.01, 0.99, 99)


@pytest.mark.parametrize("text", ["0.2mm:1mm", "uniform(0.2mm, 1mm)", "uniform( 200um,0.1cm )"])
def test_a_range_is_uniform(text: str) -> None:
    assert parse(text, "clearance", LENGTH).at(U) == pytest.approx(
        0.2e-3 + 0.8e-3 * U, rel=1e-12, abs=0
    )


def test_normal_has_its_mean_and_deviation() -> None:
    found = parse("normal(0.8mm, 0.05mm)", "clearance", LENGTH)
    one = float(stats.norm.cdf(1.0))
    assert found.at(np.array([1.0 - one, 0.5, one])) == pytest.approx(
        [0.75e-3, 0.8e-3, 0.85e-3], rel=1e-9, abs=0
    )


def test_what_is_not_allowed_is_cut_off_and_said() -> None:
    found = parse("normal(0.5, 0.2)", "friction", PURE)
    ends = (-0.5 / 0.2, 0.5 / 0.2)
    assert found.cut == pytest.approx(2.0 * stats.norm.cdf(ends[0]), rel=1e-9, abs=0)
    assert "0.0124 of it" in found.described
    known = stats.truncnorm(*ends, loc=0.5, scale=0.2)
    assert found.at(U) == pytest.approx(known.ppf(U), rel=1e-9, abs=0)


def test_a_coefficient_of_variation_is_that_of_the_values() -> None:
    wide = Quantity("1/Pa", 0.0, math.inf, "", "")
    found = parse("lognormal(1.2e-15/Pa, 50%)", "wear_coefficient", wide)
    draws = found.at((np.arange(200_000) + 0.5) / 200_000)
    assert np.median(draws) == pytest.approx(1.2e-15, rel=1e-4, abs=0)
    assert draws.std() / draws.mean() == pytest.approx(0.5, rel=2e-3, abs=0)


def test_a_factor_lies_about_the_median() -> None:
    wide = Quantity("1/Pa", 0.0, math.inf, "", "")
    found = parse("lognormal(1e-15/Pa, x1.6)", "wear_coefficient", wide)
    assert found.at(stats.norm.cdf([-1.0, 1.0])) == pytest.approx(
        [1e-15 / 1.6, 1.6e-15], rel=1e-9, abs=0
    )


def test_values_of_a_file_come_with_their_weights(tmp_path: Path) -> None:
    file = tmp_path / "measured.csv"
    file.write_text("# bushes\n0.4mm, 1\n\n0.2mm, 3\n")
    found = parse(f"table({file})", "clearance", LENGTH)
    draws = found.at((np.arange(400) + 0.5) / 400)
    assert np.count_nonzero(draws == 0.2e-3) == 300
    assert np.count_nonzero(draws == 0.4e-3) == 100


def test_a_distribution_goes_to_another_process(tmp_path: Path) -> None:
    (tmp_path / "v.csv").write_text("0.1\n0.3\n")
    for text in ("0.1:0.2", "normal(0.5, 0.1)", "lognormal(0.05, 40%)", f"table({tmp_path}/v.csv)"):
        found = parse(text, "friction", PURE)
        assert np.array_equal(pickle.loads(pickle.dumps(found)).at(U), found.at(U))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("nromal(0.8mm, 0.05mm)", "did you mean normal"),
        ("0.8mm", "a distribution is expected"),
        ("normal(0.8mm)", r"normal\(MEAN, DEVIATION\) is expected"),
        ("normal(0.8, 0.05mm)", "has no unit"),
        ("normal(0.8mm, 0mm)", "above 0"),
        ("normal(0.8mm, 0.5mm)", "5.48 % of it lies outside what is allowed, 0 to 1 m"),
        ("0.2mm:2m", "allowed is 0 to 1 m"),
        ("1mm:0.2mm", "the first end is to be below the second"),
        ("0.2mm:1mm:9", r"uniform\(LOW, HIGH\) is expected"),
        ("lognormal(0.8mm, 0.5)", "a factor such as x1.6"),
        ("lognormal(0.8mm, x0.5)", "above 1"),
        ("lognormal(0m, 50%)", "a median above 0"),
        ("table(nowhere.csv)", "no such file"),
    ],
)
def test_what_is_none_is_refused(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        parse(text, "clearance", LENGTH)


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ("0.2mm\nred\n", "line 2: clearance = 'red'"),
        ("0.2mm\n5m\n", "line 2: clearance = 5 m: allowed is 0 to 1 m"),
        ("0.2mm,-1\n0.3mm\n", "line 1: weight"),
        ("0.2mm\n", "two values at least"),
        ("", "two values at least"),
        ("0.2mm,0\n0.3mm,0", "two values at least"),
    ],
)
def test_a_file_that_does_not_fit_is_refused(tmp_path: Path, lines: str, told: str) -> None:
    file = tmp_path / "v.csv"
    file.write_text(lines)
    with pytest.raises(InputError, match=told):
        parse(f"table({file})", "clearance", LENGTH)


def test_a_whole_number_has_no_density() -> None:
    with pytest.raises(InputError, match="a whole number takes table"):
        parse("1:5", "cycles", Quantity("", 1, 10, "", "", whole=True))
