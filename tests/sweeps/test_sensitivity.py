"""Sensitivity of functions whose indices are known, and how often its intervals hold them.

Coverage: of 200 intervals of 95 % fewer than 88 % hold with a probability below 1e-4 each.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from made_up_sweep import (
    ISHIGAMI_FIRST,
    ISHIGAMI_TOTAL,
    ISHIGAMI_VARIANCE,
    g_function,
    g_indices,
    ishigami,
    random_blocks,
    swept,
    swept_by,
)
from SALib.analyze import morris as salib_morris
from scipy.stats import sobol_indices

from presswear.recording.statistics import Estimate
from presswear.sweeps.chaos import chaos_share
from presswear.sweeps.designs import JUMP, design
from presswear.sweeps.one_plan import WAVES, are_independent, by_waves, first_order
from presswear.sweeps.responses import Responses, responses
from presswear.sweeps.sensitivity import Indices, by_blocks, screening, swings
from presswear.tools.arrays import Array

REPEATS = 200
LEAST_HELD = 0.88
NOISE = float(0.8 * np.sqrt(ISHIGAMI_VARIANCE))
SHARE = 0.8**2 / (1.0 + 0.8**2)


def values(found: Sequence[Estimate]) -> list[float]:
    return [own.mean for own in found]


def held(found: Callable[[int], Sequence[Estimate]], truth: Sequence[float]) -> Array:
    """Part of the intervals from many seeds that hold each truth."""
    count = np.zeros(len(truth))
    for seed in range(REPEATS):
        for k, (own, right) in enumerate(zip(found(seed), truth, strict=True)):
            assert own.low is not None
            assert own.high is not None
            count[k] += own.low <= right <= own.high
    return count / REPEATS


def known(found: Indices | None) -> Indices:
    assert found is not None
    return found


def drawn(points: Array, draws: int = 1, noise: float = 0.0, seed: int = 0) -> Responses:
    return responses(swept(points, ishigami(points), draws=draws, noise=noise, seed=seed), "y")


def of_g(points: Array) -> Responses:
    return responses(swept(points, g_function(points)), "y")


def test_ishigami_by_blocks() -> None:
    found = known(by_blocks(swept_by("saltelli", 4096, seed=1)))
    assert values(found.first) == pytest.approx(ISHIGAMI_FIRST, abs=0.015)
    assert values(found.total) == pytest.approx(ISHIGAMI_TOTAL, abs=0.015)
    assert found.chaos is None


def test_g_function_by_blocks() -> None:
    first, total = g_indices()
    found = known(by_blocks(of_g(design("saltelli", 4096, 4, seed=1))))
    assert values(found.first) == pytest.approx(first, abs=0.01)
    assert values(found.total) == pytest.approx(total, abs=0.01)


def test_without_chaos_blocks_are_those_of_scipy() -> None:
    points = design("saltelli", 64, 3, seed=5)
    blocks = ishigami(points).reshape(-1, 5)
    theirs = sobol_indices(
        func={"f_A": blocks[:, :1].T, "f_B": blocks[:, -1:].T, "f_AB": blocks[:, 1:-1].T[:, None]},
        n=64,
    )
    ours = known(by_blocks(drawn(points)))
    assert values(ours.first) == pytest.approx(theirs.first_order.ravel(), rel=1e-9)
    assert values(ours.total) == pytest.approx(theirs.total_order.ravel(), rel=1e-9)


def test_intervals_of_blocks_hold() -> None:
    truth = [*ISHIGAMI_FIRST, *ISHIGAMI_TOTAL]

    def found(seed: int) -> list[Estimate]:
        own = known(by_blocks(drawn(random_blocks(256, 3, seed))))
        return [*own.first, *own.total]

    assert held(found, truth).min() >= LEAST_HELD


def test_chaos_is_taken_off_blocks() -> None:
    truth = [*ISHIGAMI_FIRST, *ISHIGAMI_TOTAL, SHARE]

    def found(seed: int, draws: int) -> list[Estimate]:
        points = random_blocks(256, 3, seed)
        own = known(by_blocks(drawn(points, draws, NOISE, seed + 1000)))
        return [*own.first, *own.total, *([own.chaos] if own.chaos else [])]

    assert held(lambda seed: found(seed, 2), truth).min() >= LEAST_HELD
    # One draw a point tells nothing of chaos: total indices hold it.
    single = held(lambda seed: found(seed, 1), truth[:-1])
    assert single[3:].max() < 0.5


def test_chaos_that_runs_tell_is_taken_off_blocks() -> None:
    points = random_blocks(2048, 3, seed=1)
    random = np.random.default_rng(2)
    told = ishigami(points) + NOISE * random.standard_normal(len(points))
    table = swept(points, told, halves=np.full(len(points), 1.959964 * NOISE))
    found = known(by_blocks(responses(table, "y")))
    assert values(found.total) == pytest.approx(ISHIGAMI_TOTAL, abs=0.08)
    assert found.chaos is not None
    assert found.chaos.mean == pytest.approx(SHARE, abs=0.03)


def test_a_block_with_a_failure_is_left_out() -> None:
    points = design("saltelli", 16, 3, seed=5)
    table = swept(points, ishigami(points))
    table.values[7] = np.nan
    assert known(by_blocks(responses(table, "y"))).used == 15 * 5


@pytest.mark.parametrize("kind", ["sobol", "latin", "morris", "one"])
def test_other_designs_are_no_blocks(kind: str) -> None:
    assert by_blocks(swept_by(kind, 64, seed=1)) is None


@pytest.mark.parametrize("seed", range(5))
def test_sobol_points_are_not_independent_and_others_are(seed: int) -> None:
    assert not are_independent(design("sobol", 256, 3, seed))
    assert are_independent(design("latin", 256, 3, seed))
    assert are_independent(np.random.default_rng(seed).random((256, 3)))


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_ishigami_from_one_plan(kind: str) -> None:
    found = known(first_order(swept_by(kind, 4096, seed=1)))
    assert values(found.first) == pytest.approx(ISHIGAMI_FIRST, abs=0.04)
    assert ("by rank" in found.method) == (kind == "latin")


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_intervals_from_one_plan_hold(kind: str) -> None:
    def found(seed: int) -> Sequence[Estimate]:
        return known(first_order(swept_by(kind, 256, seed))).first

    assert held(found, ISHIGAMI_FIRST).min() >= LEAST_HELD


@pytest.mark.parametrize("kind", ["latin", "sobol"])
def test_chaos_is_taken_off_one_plan(kind: str) -> None:
    def found(seed: int) -> Sequence[Estimate]:
        return known(first_order(swept_by(kind, 256, seed, draws=2, noise=NOISE))).first

    assert held(found, ISHIGAMI_FIRST).min() >= LEAST_HELD


def test_intervals_of_the_g_function_from_one_plan_hold() -> None:
    first, _ = g_indices()

    def points(seed: int) -> Responses:
        return of_g(np.random.default_rng(seed).random((256, 4)))

    assert held(lambda seed: known(first_order(points(seed))).first, list(first)).min() > LEAST_HELD
    assert held(lambda seed: by_waves(points(seed)), list(first)).min() > LEAST_HELD


def test_rows_of_a_grid_have_indices() -> None:
    axis = (np.arange(16) + 0.5) / 16
    points = np.array([[x, y, z] for x in axis for y in axis for z in axis])
    found = known(first_order(drawn(points)))
    assert values(found.first) == pytest.approx(ISHIGAMI_FIRST, abs=0.08)


def test_nothing_but_chaos_has_no_indices() -> None:
    points = np.random.default_rng(1).random((200, 3))
    alike = swept(points, np.zeros(200), draws=2, noise=1.0, seed=6)
    own = responses(alike, "y")
    share = chaos_share(own)
    assert share is not None
    assert share.high is not None
    assert share.high > 0.95
    still = responses(swept(points, np.ones(200)), "y")
    assert first_order(still) is None
    assert by_blocks(responses(swept(random_blocks(9, 3, 1), np.ones(45)), "y")) is None


@pytest.mark.parametrize("draws", [2, 4])
@pytest.mark.parametrize(("count", "size"), [(16, 0.5), (32, 2.0)])
def test_intervals_of_the_share_of_chaos_hold(count: int, draws: int, size: float) -> None:
    def found(seed: int, heavy: bool) -> list[Estimate]:
        random = np.random.default_rng(seed)
        points = random.random((count, 2))
        shape = (count, draws)
        noise = random.exponential(1.0, shape) if heavy else random.standard_normal(shape)
        table = swept(points, points.sum(axis=1) * np.sqrt(6.0), draws=draws)
        table.values[:, 0] += size * noise.ravel()
        share = chaos_share(responses(table, "y"))
        assert share is not None
        return [share]

    right = size**2 / (1.0 + size**2)
    assert held(lambda seed: found(seed, heavy=False), [right]).min() >= LEAST_HELD
    assert held(lambda seed: found(seed, heavy=True), [right]).min() >= LEAST_HELD


def test_unequal_draws_give_the_same_share() -> None:
    random = np.random.default_rng(1)
    points = random.random((4000, 1))
    table = swept(points, points[:, 0] * np.sqrt(12.0), draws=3, noise=1.0)
    table.values[random.random(12000) < 0.3] = np.nan
    share = chaos_share(responses(table, "y"))
    assert share is not None
    assert share.mean == pytest.approx(0.5, abs=0.02)


def test_single_draws_tell_no_share() -> None:
    assert chaos_share(swept_by("latin", 64, seed=1)) is None


def test_paths_give_the_effects_of_salib() -> None:
    points = design("morris", 20, 3, seed=1)
    found = screening(drawn(points))
    assert found is not None
    # SALib divides by a step of its own, and takes jumps for equal.
    problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[0.0, 1.0]] * 3}
    theirs = salib_morris.analyze(problem, points, ishigami(points), num_levels=4)
    step = 2.0 / 3.0
    assert [own.size.mean / step for own in found] == pytest.approx(theirs["mu_star"].data)
    assert [own.scatter.mean / step for own in found] == pytest.approx(theirs["sigma"])


def test_effects_of_a_plane_are_its_slopes_and_do_not_scatter() -> None:
    points = design("morris", 8, 3, seed=1)
    found = screening(responses(swept(points, points @ np.array([1.0, -4.0, 0.0])), "y"))
    assert found is not None
    sizes = [own.size.mean for own in found]
    assert sizes == pytest.approx([JUMP * 1.0, JUMP * 4.0, 0.0], abs=1e-12)
    assert [own.scatter.mean for own in found] == pytest.approx([0.0] * 3, abs=1e-12)


def test_chaos_alone_has_effects_as_large_as_its_floor() -> None:
    points = design("morris", 2000, 8, seed=1)
    own = responses(swept(points, np.zeros(len(points)), draws=2, noise=1.0), "y")
    found = screening(own)
    assert found is not None
    for one in found:
        # Draws of a normal distribution: sqrt(2/pi) of the scatter of a difference of two means.
        assert one.size.mean == pytest.approx(np.sqrt(2.0 / np.pi), rel=0.05)
        assert one.floor == pytest.approx(one.size.mean, rel=0.15)


def test_intervals_of_effects_hold() -> None:
    def found(seed: int, size: int) -> list[Estimate]:
        points = design("morris", size, 3, seed)
        bent = np.exp(2.0 * points[:, 0] * points[:, 1]) + (points[:, 1] - points[:, 2]) ** 2
        own = screening(responses(swept(points, bent), "y"))
        assert own is not None
        return [*(one.size for one in own), *(one.scatter for one in own)]

    right = values(found(99, 20_000))
    assert held(lambda seed: found(seed, 30), right).min() >= LEAST_HELD


def test_one_at_a_time_says_how_far_each_moves_the_measure() -> None:
    points = design("one", 2, 3, seed=0)
    heights = 2.0 + points @ np.array([1.0, -4.0, 0.0])
    found = swings(responses(swept(points, heights), "y"))
    assert found is not None
    first, second, third = found
    assert first is not None
    assert second is not None
    assert third is not None
    assert (first.low, first.high) == pytest.approx((0.05, 0.95))
    assert (first.at_low.mean, first.at_high.mean) == pytest.approx((-0.45, 0.45))
    assert (second.at_low.mean, second.at_high.mean) == pytest.approx((1.8, -1.8))
    assert (first.span, second.span, third.span) == pytest.approx((0.9, 3.6, 0.0), abs=1e-12)
    assert first.at_low.low is None


def test_intervals_of_swings_hold() -> None:
    points = design("one", 1, 2, seed=0)

    def found(seed: int) -> list[Estimate]:
        own = responses(swept(points, points[:, 0], draws=4, noise=1.0, seed=seed), "y")
        told = swings(own)
        assert told is not None
        assert told[0] is not None
        return [told[0].at_low, told[0].at_high]

    assert held(found, [-0.45, 0.45]).min() >= LEAST_HELD


def test_a_factor_whose_runs_failed_has_no_swing() -> None:
    points = design("one", 1, 2, seed=0)
    table = swept(points, points[:, 0])
    table.values[1:3] = np.nan
    found = swings(responses(table, "y"))
    assert found is not None
    assert found[0] is None
    assert found[1] is not None
    table.values[0] = np.nan
    assert swings(responses(table, "y")) is None


def test_waves_take_off_half_of_what_chance_gives() -> None:
    random = np.random.default_rng(1)
    found = []
    for _ in range(400):
        table = swept(random.random((128, 1)), random.standard_normal(128))
        found += values(by_waves(responses(table, "y")))
    # Each cosine takes 1/n of the variance of independent points that do not depend on it.
    assert np.mean(found) == pytest.approx(0.5 * WAVES / 128, rel=0.15, abs=0)
