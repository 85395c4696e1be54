"""Spread of measures whose distributions are known."""

import math

import numpy as np
import pytest
from made_up_sweep import swept
from numpy.typing import NDArray
from scipy import stats

from presswear.recording.statistics import Estimate
from presswear.sweeps.designs import design
from presswear.sweeps.distributions import Distribution, parse
from presswear.sweeps.responses import responses
from presswear.sweeps.spread import (
    Required,
    Spread,
    parse_required,
    requirements,
    spread_of_rows,
    spread_of_surface,
)
from presswear.sweeps.surface import surface
from presswear.sweeps.table import Column, Table
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity

FREE = Quantity("", -math.inf, math.inf, "", "")
NORMAL = parse("normal(0, 1)", "x", FREE)
CHAOS = 0.25
LIFE = stats.lognorm(math.hypot(0.5, 0.3, CHAOS), scale=100.0)
MEAN_LIFE = stats.lognorm(math.hypot(0.5, 0.3), scale=100.0)
"""Of a life that is 100 exp(0.5 x + 0.3 y + 0.25 e), all normal: lognormal itself."""


def lives(size: int, seed: int, kind: str = "sobol") -> Table:
    cube = design(kind, size, 2, seed)
    points = np.asarray(NORMAL.at(cube))
    chaos = np.random.default_rng(seed + 1).standard_normal(size)
    found = 100.0 * np.exp(0.5 * points[:, 0] + 0.3 * points[:, 1] + CHAOS * chaos)
    return swept(points, found, unit="")


def holds(own: Estimate, truth: float) -> bool:
    assert own.low is not None
    assert own.high is not None
    return own.low <= truth <= own.high


def of_surface(size: int, seed: int, *, chaos: bool = True) -> Spread:
    found = surface(responses(lives(size, seed), "y"))
    return spread_of_surface(found, [NORMAL, NORMAL], Required(40.0, True), chaos=chaos, seed=seed)


def test_a_life_is_as_long_as_it_is() -> None:
    found = of_surface(128, seed=3)
    for percent in (5, 50, 95):
        own = found.quantile(percent)
        assert own.mean == pytest.approx(LIFE.ppf(percent / 100.0), rel=0.15)
        assert holds(own, LIFE.ppf(percent / 100.0))
    assert found.misses is not None
    assert found.misses.mean == pytest.approx(LIFE.cdf(40.0), abs=0.02)
    assert holds(found.misses, LIFE.cdf(40.0))


def test_without_chaos_it_spreads_less() -> None:
    found = of_surface(128, seed=3, chaos=False)
    assert holds(found.quantile(5), MEAN_LIFE.ppf(0.05))
    assert found.quantile(5).mean > of_surface(128, seed=3).quantile(5).mean


def test_where_more_is_a_miss_the_other_end_counts() -> None:
    found = surface(responses(lives(128, seed=3), "y"))
    own = spread_of_surface(found, [NORMAL, NORMAL], Required(200.0, False))
    assert own.misses is not None
    assert own.misses.mean == pytest.approx(LIFE.sf(200.0), abs=0.03)


@pytest.mark.slow
def test_intervals_of_the_surface_hold() -> None:
    held = []
    for seed in range(60):
        found = of_surface(64, seed)
        assert found.misses is not None
        told = [holds(found.quantile(p), LIFE.ppf(p / 100.0)) for p in (5, 50, 95)]
        held.append([*told, holds(found.misses, LIFE.cdf(40.0))])
    # Of 60 intervals of 95 % fewer than 50 hold with a probability of 1e-3.
    assert np.mean(held, axis=0).min() >= 50.0 / 60.0


def test_intervals_of_rows_hold() -> None:
    held = []
    for seed in range(200):
        random = np.random.default_rng(seed)
        found = spread_of_rows(
            swept(random.random((200, 1)), LIFE.rvs(200, random_state=random)),
            "y",
            Required(40.0, True),
        )
        assert found is not None
        assert found.misses is not None
        told = [holds(found.quantile(p), LIFE.ppf(p / 100.0)) for p in (5, 50, 95)]
        held.append([*told, holds(found.misses, LIFE.cdf(40.0))])
    assert np.mean(held, axis=0).min() >= 0.90


def ranked(values: Array, beyond: NDArray[np.bool_] | None = None) -> Table:
    return swept(np.arange(len(values))[:, None].astype(float), values, is_beyond=beyond)


def test_few_rows_tell_no_lower_end() -> None:
    found = spread_of_rows(ranked(np.arange(60.0)), "y")
    assert found is not None
    assert found.quantile(5).low is None
    enough = spread_of_rows(ranked(np.arange(80.0)), "y")
    assert enough is not None
    assert enough.quantile(5).low == 0.0


def test_quantiles_below_all_lower_bounds_do_not_mind_them() -> None:
    values = np.minimum(np.arange(200.0), 100.0)
    found = spread_of_rows(ranked(values, values == 100.0), "y", Required(50.0, True))
    whole = spread_of_rows(ranked(np.arange(200.0)), "y", Required(50.0, True))
    assert found is not None
    assert whole is not None
    assert found.quantile(5) == whole.quantile(5)
    assert found.misses == whole.misses
    assert math.isnan(found.quantile(60).mean)
    assert found.quantile(60).high is None


@pytest.mark.parametrize(
    ("required", "ends"),
    [
        (Required(50.0, True), (0, 100)),  # bounds of 20 may be lives of 60
        (Required(10.0, True), (0, 0)),
        (Required(10.0, False), (200, 200)),
        (Required(50.0, False), (100, 200)),
    ],
)
def test_a_miss_beyond_a_bound_is_not_known(required: Required, ends: tuple[int, int]) -> None:
    values = np.repeat([20.0, 60.0], 100)
    found = spread_of_rows(ranked(values, values == 20.0), "y", required)
    assert found is not None
    surely, perhaps = (stats.binomtest(k, 200).proportion_ci(0.95) for k in ends)
    assert found.misses == Estimate(sum(ends) / 400.0, surely.low, perhaps.high)


def test_only_first_draws_are_a_sample() -> None:
    table = swept(np.arange(100.0)[:, None], np.arange(100.0), draws=3, noise=0.1)
    found = spread_of_rows(table, "y")
    assert found is not None
    assert found.used == 100


def test_rows_without_values_have_no_spread() -> None:
    assert spread_of_rows(ranked(np.full(5, np.nan)), "y") is None


def test_cut_distributions_are_read_as_such() -> None:
    half = Distribution("half", stats.norm.ppf, 0.5, 1.0)
    points = np.asarray(half.at(design("sobol", 32, 1, 1)))
    found = spread_of_surface(surface(responses(swept(points, 3.0 * points[:, 0]), "y")), [half])
    known = 3.0 * stats.halfnorm.ppf([0.05, 0.5, 0.95])
    assert [found.quantile(p).mean for p in (5, 50, 95)] == pytest.approx(known, rel=0.03)


MEASURES = (Column("life", "", "strokes"), Column("A.force_max", "N", "peak"))


def test_what_is_required_is_read_with_its_unit() -> None:
    assert parse_required("life >= 2e6", MEASURES) == ("life", Required(2e6, True))
    assert parse_required("A.force_max<=15kN", MEASURES) == ("A.force_max", Required(15e3, False))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("life", "MEASURE>=VALUE or MEASURE<=VALUE is expected"),
        ("life=2e6", "MEASURE>=VALUE"),
        ("lif>=2e6", "unknown measure 'lif'; did you mean life"),
        ("A.force_max<=15", "has no unit"),
    ],
)
def test_what_requires_nothing_is_refused(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        parse_required(text, MEASURES)


def test_a_measure_is_required_once() -> None:
    texts = ("life>=2e6", "A.force_max<=15kN")
    assert requirements(texts, MEASURES) == {
        "life": Required(2e6, True),
        "A.force_max": Required(15e3, False),
    }
    with pytest.raises(InputError, match="something is required of life already"):
        requirements(("life>=2e6", "life<=3e6"), MEASURES)
