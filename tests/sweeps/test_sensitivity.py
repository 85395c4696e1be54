"""Sensitivity of functions with known indices, and the coverage of its intervals.

Of 60 intervals of 95 % fewer than 50 contain the value with a probability below 1e-3 each.
"""

import math

import numpy as np
import pytest
from made_up_sweep import (
    ISHIGAMI_FIRST,
    ISHIGAMI_TOTAL,
    ISHIGAMI_VARIANCE,
    g_function,
    g_indices,
    ishigami,
    ishigami_points,
    table_of,
)
from scipy import stats

from presswear.sweeps.parameters import MORRIS_JUMP, design
from presswear.sweeps.responses import Limit
from presswear.sweeps.sensitivity import (
    PROBABILITIES,
    Sensitivity,
    chaotic_share,
    points_of,
    sensitivity,
    spread_of_rows,
)
from presswear.tools.arrays import Array

SEEDS = range(1, 61)
MIN_COVERAGE = 50 / 60
NOISE = 0.8 * math.sqrt(ISHIGAMI_VARIANCE)


def result_of(
    kind: str, size: int, seed: int, replicates: int = 1, noise: float = 0.0
) -> Sensitivity:
    result = sensitivity(ishigami_points(kind, size, seed, replicates, noise), kind, seed)
    assert result is not None
    return result


def coverage(
    kind: str, size: int, truth: Array, replicates: int, noise: float, seeds: range = SEEDS
) -> Array:
    """Return the fraction of seeds whose interval contains each index."""
    hits = np.zeros(truth.shape)
    for seed in seeds:
        result = result_of(kind, size, seed, replicates, noise)
        hits += np.abs(result.values - truth) <= result.half_widths
    return hits / len(seeds)


def test_indices_of_known_functions() -> None:
    truth = np.array([ISHIGAMI_FIRST, ISHIGAMI_TOTAL])
    assert result_of("saltelli", 4096, 1).values == pytest.approx(truth, abs=0.015)
    points = design("saltelli", 4096, 4, seed=1)
    result = sensitivity(points_of(table_of(points, g_function(points)), "y"), "saltelli")
    assert result is not None
    assert result.values == pytest.approx(np.array(g_indices()), abs=0.015)
    assert result.order == [0, 1, 2, 3]


def test_blocks_give_the_indices_of_scipy() -> None:
    blocks = ishigami(design("saltelli", 64, 3, seed=5)).reshape(-1, 5)
    reference = stats.sobol_indices(
        func={"f_A": blocks[:, :1].T, "f_B": blocks[:, -1:].T, "f_AB": blocks[:, 1:-1].T[:, None]},
        n=64,
    )
    indices = result_of("saltelli", 64, 5).values
    assert indices[1] == pytest.approx(reference.total_order.ravel(), rel=1e-9)
    assert indices[0] == pytest.approx(reference.first_order.ravel(), abs=0.1)


@pytest.mark.parametrize(("replicates", "noise"), [(1, 0.0), (2, NOISE)])
def test_intervals_of_blocks_contain_the_indices(replicates: int, noise: float) -> None:
    truth = np.array([ISHIGAMI_FIRST, ISHIGAMI_TOTAL])
    assert coverage("saltelli", 256, truth, replicates, noise).min() >= MIN_COVERAGE


def test_chaos_without_replicates_stays_in_total_indices() -> None:
    truth = np.array([ISHIGAMI_FIRST, ISHIGAMI_TOTAL])
    assert coverage("saltelli", 256, truth, 1, NOISE, range(1, 21))[1].max() < 0.5


@pytest.mark.parametrize(
    ("kind", "replicates", "noise"), [("sobol", 1, 0.0), ("latin", 1, 0.0), ("latin", 2, NOISE)]
)
def test_intervals_of_samples_contain_the_indices(kind: str, replicates: int, noise: float) -> None:
    truth = np.array([ISHIGAMI_FIRST])
    assert coverage(kind, 256, truth, replicates, noise, range(1, 21)).min() >= 0.7


def test_intervals_of_runs_tell_the_chaos() -> None:
    points = design("saltelli", 2048, 3, seed=1)
    table = table_of(points, ishigami(points), noise=NOISE, half_widths=1.959964 * NOISE)
    result = sensitivity(points_of(table, "y"), "saltelli")
    assert result is not None
    assert result.values[1] == pytest.approx(ISHIGAMI_TOTAL, abs=0.08)


def test_a_block_with_a_failed_run_is_omitted() -> None:
    points = design("saltelli", 16, 3, seed=5)
    table = table_of(points, ishigami(points))
    table.values[7] = np.nan
    rest = table_of(np.delete(points, range(5, 10), 0), np.delete(ishigami(points), range(5, 10)))
    first, second = (sensitivity(points_of(one, "y"), "saltelli") for one in (table, rest))
    assert first is not None
    assert second is not None
    assert first.values == pytest.approx(second.values)


def test_too_few_or_constant_values_have_no_indices() -> None:
    assert sensitivity(ishigami_points("saltelli", 4, 1), "saltelli") is None
    assert sensitivity(ishigami_points("latin", 20, 1), "latin") is None
    points = design("saltelli", 16, 3, seed=1)
    assert sensitivity(points_of(table_of(points, np.ones(80)), "y"), "saltelli") is None
    noisy = table_of(points, np.zeros(80), replicates=2, noise=1.0, seed=6)
    result = sensitivity(points_of(noisy, "y"), "saltelli")
    assert result is None or result.half_widths.max() > 0.5


def test_effects_of_a_plane_are_its_slopes() -> None:
    points = design("morris", 8, 3, seed=1)
    table = table_of(points, points @ np.array([1.0, -4.0, 0.0]))
    result = sensitivity(points_of(table, "y"), "morris")
    assert result is not None
    assert result.values[0] == pytest.approx([MORRIS_JUMP, 4.0 * MORRIS_JUMP, 0.0], abs=1e-12)
    assert result.values[1] == pytest.approx(np.zeros(3), abs=1e-12)
    assert math.isnan(result.noise)


def test_effects_of_chaos_alone_equal_its_noise() -> None:
    points = design("morris", 2000, 8, seed=1)
    table = table_of(points, np.zeros(len(points)), replicates=2, noise=1.0)
    result = sensitivity(points_of(table, "y"), "morris")
    assert result is not None
    assert result.values[0] == pytest.approx(result.noise, rel=0.05)


def test_one_at_a_time_gives_changes_with_intervals() -> None:
    points = design("oat", 2, 3, seed=0)
    hits = np.zeros((2, 3))
    truth = np.array([[-0.45, 1.8, 0.0], [0.45, -1.8, 0.0]])
    for seed in SEEDS:
        table = table_of(points, points @ np.array([1.0, -4.0, 0.0]), 4, 1.0, seed)
        result = sensitivity(points_of(table, "y"), "oat")
        assert result is not None
        hits += np.abs(result.values - truth) <= result.half_widths
    assert hits.min() / len(SEEDS) >= MIN_COVERAGE
    exact = table_of(points, points @ np.array([1.0, -4.0, 0.0]))
    exact.values[1:3] = np.nan
    result = sensitivity(points_of(exact, "y"), "oat")
    assert result is not None
    assert result.values[:, 1:] == pytest.approx(truth[:, 1:])
    assert result.order == [1, 0, 2]


@pytest.mark.parametrize(("count", "replicates", "noise"), [(16, 2, 0.5), (32, 4, 2.0)])
def test_intervals_of_the_chaotic_share_contain_it(
    count: int, replicates: int, noise: float
) -> None:
    hits = 0
    for seed in SEEDS:
        points = np.random.default_rng(seed).standard_normal((count, 1))
        table = table_of(points, points[:, 0], replicates, noise, seed + 1000)
        share = chaotic_share(points_of(table, "y"))
        assert share is not None
        hits += share[1] <= noise**2 / (1.0 + noise**2) <= share[2]
    assert hits / len(SEEDS) >= MIN_COVERAGE
    assert chaotic_share(ishigami_points("latin", 64, 1)) is None


def test_unequal_replicates_give_the_same_share() -> None:
    random = np.random.default_rng(1)
    points = random.random((4000, 1))
    table = table_of(points, points[:, 0] * math.sqrt(12.0), replicates=3, noise=1.0)
    table.values[random.random(12000) < 0.3] = np.nan
    share = chaotic_share(points_of(table, "y"))
    assert share is not None
    assert share[0] == pytest.approx(0.5, abs=0.02)


def test_quantiles_of_rows_are_order_statistics() -> None:
    life, hits = stats.lognorm(0.5, scale=100.0), np.zeros(99)
    for seed in range(200):
        values = life.rvs(100, random_state=seed)
        spread = spread_of_rows(table_of(values[:, None], values), "y", Limit(50.0, True))
        assert spread is not None
        truth = life.ppf(PROBABILITIES)
        low, high = np.nan_to_num(spread.low, nan=0.0), np.nan_to_num(spread.high, nan=np.inf)
        hits += (low <= truth) & (truth <= high)
        assert spread.violation is not None
        assert spread.violation[0] == np.mean(values < 50.0)
    assert hits.min() / 200 >= 0.9


def test_censored_values_leave_quantiles_open() -> None:
    values = np.minimum(np.arange(100.0), 80.0)
    table = table_of(values[:, None], values, replicates=3, censored=values >= 80.0)
    spread = spread_of_rows(table, "y", Limit(90.0, True))
    assert spread is not None
    assert spread.values[49] == 49.0
    assert np.isnan(spread.values[89])
    assert np.isnan(spread.high[89])
    assert spread.violation is not None
    assert spread.violation[1] < 0.8 < 0.99 < spread.violation[2]
    assert spread_of_rows(table_of(np.ones((5, 1)), np.full(5, np.nan)), "y") is None
