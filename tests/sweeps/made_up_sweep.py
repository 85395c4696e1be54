"""Made-up sweeps of functions whose answers are known."""

import numpy as np
from numpy.typing import NDArray

from presswear.sweeps.designs import design
from presswear.sweeps.responses import Responses, responses
from presswear.sweeps.table import Column, Table
from presswear.tools.arrays import Array

ISHIGAMI_FIRST = (0.3139, 0.4424, 0.0)
ISHIGAMI_TOTAL = (0.5576, 0.4424, 0.2437)
ISHIGAMI_VARIANCE = 7.0**2 / 8.0 + 0.1 * np.pi**4 / 5.0 + 0.1**2 * np.pi**8 / 18.0 + 0.5
"""Ishigami and Homma (1990) with a = 7 and b = 0.1."""
WEIGHTS = np.array([0.0, 1.0, 4.5, 9.0])
"""Of Sobol's g function."""


def ishigami(cube: Array) -> Array:
    """Ishigami's function of points in the unit cube."""
    x = np.pi * (2.0 * cube - 1.0)
    return np.asarray(
        np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    )


def g_function(cube: Array) -> Array:
    """Sobol's g function of points in the unit cube."""
    return np.asarray(np.prod((np.abs(4.0 * cube - 2.0) + WEIGHTS) / (1.0 + WEIGHTS), axis=1))


def g_indices() -> tuple[Array, Array]:
    """First and total indices of the g function (Sobol 1993)."""
    own = 1.0 / 3.0 / (1.0 + WEIGHTS) ** 2
    whole = np.prod(1.0 + own)
    return own / (whole - 1.0), own * (whole / (1.0 + own)) / (whole - 1.0)


def swept(
    points: Array,
    values: Array,
    *,
    draws: int = 1,
    noise: float = 0.0,
    seed: int = 0,
    halves: Array | None = None,
    is_beyond: NDArray[np.bool_] | None = None,
    reasons: tuple[str, ...] = (),
    unit: str = "N",
) -> Table:
    """A table of one measure at points, each drawn several times with normal noise."""
    count, dimension = points.shape
    random = np.random.default_rng(seed)
    rows = np.repeat(values, draws) + noise * random.standard_normal(count * draws)
    none = np.full((count * draws, 1), np.nan)
    return Table(
        tuple(Column(f"x{k + 1}", "m", f"factor {k + 1}") for k in range(dimension)),
        (Column("y", unit, "what is measured"),),
        np.repeat(points, draws, axis=0),
        rows[:, None],
        none if halves is None else np.repeat(halves, draws)[:, None],
        np.repeat(np.zeros(count, bool) if is_beyond is None else is_beyond.astype(bool), draws)[
            :, None
        ],
        np.tile(np.arange(draws), count),
        reasons or ("",) * (count * draws),
    )


def random_blocks(size: int, dimension: int, seed: int) -> Array:
    """Blocks of Saltelli of points drawn at random, independent of each other."""
    both = np.random.default_rng(seed).random((size, 2, dimension))
    blocks = np.repeat(both[:, :1], dimension + 2, axis=1)
    for k in range(dimension):
        blocks[:, k + 1, k] = both[:, 1, k]
    blocks[:, -1] = both[:, 1]
    return blocks.reshape(-1, dimension)


def swept_by(kind: str, size: int, seed: int, draws: int = 1, noise: float = 0.0) -> Responses:
    """Ishigami's function over a design."""
    points = design(kind, size, 3, seed)
    return responses(swept(points, ishigami(points), draws=draws, noise=noise, seed=seed), "y")
