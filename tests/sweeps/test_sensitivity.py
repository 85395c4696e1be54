"""Sensitivity of functions with known indices, the coverage of its intervals, and surrogates.

The tests require that 50 of 60 intervals of 95 % contain the value. By chance, fewer do so
with a probability below 1e-3.
"""
# mypy: disable-error-code="union-attr,operator,index"

import math
import sys
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from made_up_sweep import (
    ISHIGAMI_FIRST,
    ISHIGAMI_TOTAL,
    ISHIGAMI_VARIANCE,
    ishigami,
    table_of,
)
from numpy.typing import NDArray
from refusals import refused
from scipy import stats

from presswear.sweeps.parameters import (
    MORRIS_JUMP,
    design,
    parse_distribution,
)
from presswear.sweeps.plan import Table
from presswear.sweeps.response_distribution import PROBABILITIES, spread_of_rows
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.response_points import Points, points_of
from presswear.sweeps.sensitivity import chaotic_share, sensitivity
from presswear.sweeps.surrogate import fit
from presswear.tools.arrays import Array
from presswear.tools.quantities import Quantity

SEEDS = range(1, 61)
MIN_COVERAGE = 50 / 60
NOISE = 0.8 * math.sqrt(ISHIGAMI_VARIANCE)
INDICES = np.array([ISHIGAMI_FIRST, ISHIGAMI_TOTAL])
SLOPES = np.array([1.0, -4.0, 0.0])


def result_of(table: Table, kind: str) -> Any:
    return sensitivity(points_of(table, "y"), kind)


def ishigami_of(
    kind: str, size: int, seed: int, replicates: int = 1, noise: float = 0.0
) -> Table:
    points = design(kind, size, 3, seed)
    return table_of(points, ishigami(points), replicates, noise, seed + 1000)


def test_indices_of_known_functions():
    indices = result_of(ishigami_of("saltelli", 4096, 1), "saltelli").values
    assert indices == pytest.approx(INDICES, abs=0.015)


@pytest.mark.parametrize(
    ("kind", "seeds", "least"),
    [
        ("saltelli", SEEDS, MIN_COVERAGE),
        ("sobol", range(1, 21), 0.7),
        ("latin", range(1, 21), 0.7),
    ],
)
def test_intervals_contain_the_indices_in_spite_of_chaos(kind, seeds, least):
    truth = INDICES if kind == "saltelli" else INDICES[:1]
    hits = np.zeros(3)
    for seed in seeds:
        result = result_of(ishigami_of(kind, 256, seed, 2, NOISE), kind)
        hits = hits + (np.abs(result.values - truth) <= result.half_widths)
    assert hits.min() / len(seeds) >= least


def test_chaos_is_subtracted_only_if_it_is_known():
    points = design("saltelli", 2048, 3, seed=1)
    for half_width, is_known in ((1.959964 * NOISE, True), (np.nan, False)):
        table = table_of(points, ishigami(points), noise=NOISE, half_widths=half_width)
        error = np.abs(result_of(table, "saltelli").values[1] - ISHIGAMI_TOTAL)
        assert (error.max() < 0.08) == is_known


@pytest.mark.parametrize("power", [0.0, 1.0])
def test_scatter_of_replicates_may_grow_with_the_mean(power):
    """Intervals hold at small and at large means; one variance fits only one of both."""
    generator = np.random.default_rng(7)
    points = np.linspace(0.0, 1.0, 200)[:, None]
    truth = 100.0 ** points[:, 0]
    scatter = 0.2 * truth**power
    table = table_of(points, truth, replicates=3)
    values = truth[:, None] + scatter[:, None] * generator.standard_normal((200, 3))
    result = points_of(replace(table, values=values.reshape(-1, 1)), "y")
    hits = np.abs(result.means - truth) <= result.half_widths
    for part in (slice(0, 50), slice(150, 200)):
        assert hits[part].mean() >= 0.88
    assert np.sqrt(result.variances[[0, -1]]) == pytest.approx(
        scatter[[0, -1]], rel=0.15
    )
    # A mean of zero has no share.
    values[0] = 0.0, 0.1, -0.1
    flat = points_of(replace(table, values=values.reshape(-1, 1)), "y").variances
    assert flat.min() == flat.max()


def test_failed_runs_are_omitted_and_too_few_have_no_indices():
    points = design("saltelli", 16, 3, seed=5)
    table = table_of(points, ishigami(points))
    table.values[7] = np.nan
    rest = table_of(
        np.delete(points, range(5, 10), 0), np.delete(ishigami(points), range(5, 10))
    )
    omitted = result_of(table, "saltelli").values
    assert omitted == pytest.approx(result_of(rest, "saltelli").values)
    for few, kind in (
        (ishigami_of("saltelli", 4, 1), "saltelli"),
        (ishigami_of("latin", 20, 1), "latin"),
        (table_of(points, np.ones(80)), "saltelli"),
    ):
        assert sensitivity(points_of(few, "y"), kind) is None


@pytest.mark.parametrize(("share", "has_indices"), [(0.89, True), (0.91, False)])
def test_no_indices_if_chaos_causes_nearly_all_variance(share, has_indices):
    points = design("saltelli", 16, 3, seed=5)
    variance = ishigami(points).reshape(-1, 5)[:, [0, -1]].var()
    half_width = stats.norm.ppf(0.975) * math.sqrt(share * variance)
    table = table_of(points, ishigami(points), half_widths=half_width)
    assert (sensitivity(points_of(table, "y"), "saltelli") is not None) == has_indices


def test_elementary_effects_of_a_plane_and_of_chaos():
    points = design("morris", 8, 3, seed=1)
    result = result_of(table_of(points, points @ SLOPES), "morris")
    assert result.values[0] == pytest.approx(MORRIS_JUMP * np.abs(SLOPES), abs=1e-12)
    assert result.values[1] == pytest.approx(np.zeros(3), abs=1e-12)
    points = design("morris", 2000, 8, seed=1)
    result = result_of(table_of(points, np.zeros(len(points)), 2, noise=1.0), "morris")
    assert result.values[0] == pytest.approx(result.noise, rel=0.05)


def test_one_at_a_time_gives_changes_with_intervals():
    points = design("oat", 2, 3, seed=0)
    truth = np.outer([-0.45, 0.45], SLOPES)
    hits = np.zeros((2, 3))
    for seed in SEEDS:
        result = result_of(table_of(points, points @ SLOPES, 4, 1.0, seed), "oat")
        hits += np.abs(result.values - truth) <= result.half_widths
    assert hits.min() / len(SEEDS) >= MIN_COVERAGE
    exact = table_of(points, points @ SLOPES)
    exact.values[1:3] = np.nan
    result = result_of(exact, "oat")
    assert result.values[:, 1:] == pytest.approx(truth[:, 1:])
    assert result.order == [1, 0, 2]


@pytest.mark.parametrize(("count", "replicates", "noise"), [(16, 2, 0.5), (32, 4, 2.0)])
def test_intervals_of_the_chaotic_share_hold_it(count, replicates, noise):
    hits = 0
    for seed in SEEDS:
        points = np.random.default_rng(seed).standard_normal((count, 1))
        table = table_of(points, points[:, 0], replicates, noise, seed + 1000)
        share = chaotic_share(points_of(table, "y"))
        hits += share[1] <= noise**2 / (1.0 + noise**2) <= share[2]
    assert hits / len(SEEDS) >= MIN_COVERAGE
    assert chaotic_share(points_of(ishigami_of("latin", 64, 1), "y")) is None


def test_quantiles_of_rows_are_order_statistics():
    life = stats.lognorm(0.5, scale=100.0)
    hits = np.zeros(99)
    for seed in range(200):
        values = life.rvs(100, random_state=seed)
        spread = spread_of_rows(
            table_of(values[:, None], values), "y", ResponseLimit(50.0, True)
        )
        truth = life.ppf(PROBABILITIES)
        low = np.nan_to_num(spread.low, nan=0.0)
        high = np.nan_to_num(spread.high, nan=np.inf)
        hits += (low <= truth) & (truth <= high)
        assert spread.violation[0] == np.mean(values < 50.0)
    assert hits.min() / 200 >= 0.9


def test_censored_values_leave_quantiles_open():
    values = np.minimum(np.arange(100.0), 80.0)
    table = table_of(values[:, None], values, replicates=3, censored=values >= 80.0)
    spread = spread_of_rows(table, "y", ResponseLimit(90.0, True))
    assert spread.values[49] == 49.0
    assert np.isnan([spread.values[89], spread.high[89]]).all()
    assert spread.violation[1] < 0.8 < 0.99 < spread.violation[2]
    assert spread_of_rows(table_of(np.ones((5, 1)), np.full(5, np.nan)), "y") is None


OTHERS = np.random.default_rng(5).random((500, 3))
NORMAL = parse_distribution(
    "normal(0, 1)", "x", Quantity("", -math.inf, math.inf, "", "")
)


def curved(points: Array) -> Array:
    return np.asarray(10.0 * np.exp(2.0 * points[:, 0] + np.sin(3.0 * points[:, 1])))


def sampled(
    size: int, noise: float = 0.0, censored: NDArray[np.bool_] | None = None
) -> Points:
    points = design("sobol", size, 3, seed=1)
    table = table_of(points, curved(points), noise=noise, censored=censored)
    return points_of(table, "y")


def test_a_smooth_function_is_predicted():
    surrogate = fit(sampled(64))
    assert surrogate.predict(OTHERS) == pytest.approx(curved(OTHERS), rel=0.05)


@pytest.mark.parametrize(("replicates", "chaos"), [(1, 0.25), (4, 0.5)])
def test_a_distribution_has_the_quantiles_of_single_runs(replicates, chaos):
    """A life of 100 exp(0.5 x + 0.3 y + chaos e), all normal, is lognormal."""
    exact = stats.lognorm(math.hypot(0.5, 0.3, chaos), scale=100.0)
    truth = exact.ppf((0.05, 0.5, 0.95))
    hits = np.zeros(3)
    for seed in range(1, 4):
        points = NORMAL.ppf(design("sobol", 64, 2, seed)).repeat(replicates, axis=0)
        scatter = chaos * np.random.default_rng(seed).standard_normal(len(points))
        life = 100.0 * np.exp(0.5 * points[:, 0] + 0.3 * points[:, 1] + scatter)
        table = replace(table_of(points, life), replicates=replicates)
        surrogate = fit(points_of(table, "y"))
        spread = surrogate.spread([NORMAL, NORMAL], ResponseLimit(40.0, True))
        places = [4, 49, 94]
        assert spread.values[places] == pytest.approx(truth, rel=0.25)
        hits += (spread.low[places] <= truth) & (truth <= spread.high[places])
        assert spread.violation[0] == pytest.approx(exact.cdf(40.0), abs=0.05)
    assert hits.min() >= 2


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (sampled(8), "8 points have a value; it needs 15 to 1000"),
        (
            sampled(64, censored=np.arange(64) == 3),
            "some of its values are lower bounds",
        ),
        (sampled(64, noise=1e4), "in cross-validation it explains"),
        (
            points_of(table_of(OTHERS, np.ones(500)), "y"),
            "the same value at all points",
        ),
    ],
)
def test_unsuitable_points_are_refused(points, message):
    with refused(message):
        fit(points)


@pytest.mark.parametrize(
    ("package", "distribution", "function"),
    [
        ("sklearn", "scikit-learn", fit),
        ("SALib", "SALib", partial(sensitivity, kind="sobol")),
    ],
)
def test_a_missing_package_is_named(package, distribution, function, monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    install = rf"pip install {distribution}, or pip install '\.\[sweep\]' in"
    with refused(f"needs {distribution}: {install}"):
        function(sampled(64))
