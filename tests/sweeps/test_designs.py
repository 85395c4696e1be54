"""Designs: their rows, their spread, and what is refused."""

import numpy as np
import pytest
from scipy.stats import qmc

from presswear.sweeps.designs import FARTHEST, JUMP, LEVELS, design, rows
from presswear.tools.errors import InputError

SIZES = {"sobol": 64, "latin": 50, "saltelli": 16, "morris": 12, "one": 3}


@pytest.mark.parametrize("kind", SIZES)
@pytest.mark.parametrize("dimension", [1, 4])
def test_rows_are_known_before_they_are_made(kind: str, dimension: int) -> None:
    found = design(kind, SIZES[kind], dimension, seed=3)
    assert found.shape == (rows(kind, SIZES[kind], dimension), dimension)
    assert found.min() >= 0.0
    assert found.max() <= 1.0
    assert np.array_equal(found, design(kind, SIZES[kind], dimension, seed=3))


@pytest.mark.parametrize("kind", ["sobol", "latin", "saltelli", "morris"])
def test_another_seed_gives_other_points(kind: str) -> None:
    first, second = (design(kind, SIZES[kind], 3, seed) for seed in (1, 2))
    assert not np.array_equal(first, second)


@pytest.mark.parametrize("kind", ["sobol", "saltelli", "morris"])
def test_a_larger_design_begins_with_the_smaller(kind: str) -> None:
    small, large = (design(kind, size, 3, seed=7) for size in (16, 64))
    assert np.array_equal(large[: len(small)], small)


@pytest.mark.parametrize("kind", ["sobol", "latin"])
def test_points_are_spread_more_evenly_than_at_random(kind: str) -> None:
    random = np.random.default_rng(1).random((64, 3))
    assert qmc.discrepancy(design(kind, 64, 3, seed=1)) < 0.5 * qmc.discrepancy(random)


def test_blocks_of_saltelli_change_one_value_each() -> None:
    blocks = design("saltelli", 8, 3, seed=1).reshape(8, 5, 3)
    first, second = blocks[:, 0], blocks[:, -1]
    assert not np.any(first == second)
    for k in range(3):
        others = np.delete(np.arange(3), k)
        assert np.array_equal(blocks[:, k + 1, k], second[:, k])
        assert np.array_equal(blocks[:, k + 1, others], first[:, others])


def test_a_path_of_morris_changes_each_value_once() -> None:
    paths = design("morris", 40, 4, seed=1).reshape(40, 5, 4)
    jumps = np.diff(paths, axis=1)
    assert np.all(np.count_nonzero(jumps, axis=1) == 1)
    assert np.all(np.count_nonzero(jumps, axis=2) == 1)
    assert np.all(np.abs(jumps[jumps != 0.0]) == JUMP)
    assert set(np.unique(paths)) == {(k + 0.5) / LEVELS for k in range(LEVELS)}


def test_one_at_a_time_goes_from_low_to_high() -> None:
    found = design("one", 1, 2, seed=0)
    low, high = 0.5 - FARTHEST, 0.5 + FARTHEST
    assert found.tolist() == [[0.5, 0.5], [low, 0.5], [high, 0.5], [0.5, low], [0.5, high]]


@pytest.mark.parametrize(
    ("kind", "size", "dimension", "told"),
    [
        ("sobel", 8, 2, "did you mean sobol"),
        ("sobol", 500, 2, "a power of two is expected, 256 or 512"),
        ("saltelli", 48, 2, "32 or 64"),
        ("morris", 0, 2, "a size of at least 1"),
        ("one", 1, 0, "one factor at least"),
        ("saltelli", 2, 20_000, "too many for Sobol' points"),
    ],
)
def test_what_cannot_be_is_refused(kind: str, size: int, dimension: int, told: str) -> None:
    for asked in (
        lambda: design(kind, size, dimension, seed=0),
        lambda: rows(kind, size, dimension),
    ):
        with pytest.raises(InputError, match=told):
            asked()
