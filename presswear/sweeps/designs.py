"""Designs: where in the unit cube a sweep looks, one row a point.

=============  ============================================================  ==================
kind           size                                                          rows in d dimensions
=============  ============================================================  ==================
``sobol``      points, a power of two                                        size
``latin``      points                                                        size
``saltelli``   pairs of points, a power of two                               size (d + 2)
``morris``     paths on which each value changes once                        size (d + 1)
``one``        steps to either side of the middle, one value at a time       1 + 2 size d
=============  ============================================================  ==================

A larger design of the same kind and seed begins with the rows of a smaller one, but for
``latin`` and ``one``.  Values are at 5 % to 95 % of their distributions in ``one`` and at the
middles of four equal parts in ``morris``: the ends of a distribution may be at infinity.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown

LEVELS = 4
"""Values that a factor takes in ``morris``."""
JUMP = 0.5
"""Change of a factor in ``morris``, part of its range: half of the levels."""
FARTHEST = 0.45
"""Distance from the middle to the last step in ``one``."""
_MOST_SOBOL = 21201
"""Dimensions of the sequence in scipy (Joe and Kuo)."""


def design(kind: str, size: int, dimension: int, seed: int) -> Array:
    """Rows of a design, shape (rows, dimension), in the unit cube.

    InputError for an unknown kind, or a size or a dimension that it cannot have.
    """
    _check(kind, size, dimension)
    return _KINDS[kind].make(size, dimension, np.random.default_rng(seed))


def rows(kind: str, size: int, dimension: int) -> int:
    """Rows that a design has, without making it; InputError as of ``design``."""
    _check(kind, size, dimension)
    return _KINDS[kind].rows(size, dimension)


def _check(kind: str, size: int, dimension: int) -> None:
    if kind not in _KINDS:
        raise unknown("design", kind, _KINDS)
    own = _KINDS[kind]
    if size < 1:
        raise InputError(f"{kind}:{size}: a size of at least 1 is expected")
    if dimension < 1:
        raise InputError(f"{kind}:{size}: one factor at least is to be varied")
    if own.sequences and size & (size - 1):
        lower = 1 << (size.bit_length() - 1)
        raise InputError(
            f"{kind}:{size}: a power of two is expected, {lower} or {2 * lower}: only then are "
            "the points evenly spread"
        )
    if own.sequences * dimension > _MOST_SOBOL:
        raise InputError(f"{kind}:{size}: {dimension} factors are too many for Sobol' points")


def _sobol(size: int, dimension: int, random: np.random.Generator) -> Array:
    """Scrambled Sobol' points (Owen 1998), shape (size, dimension)."""
    from scipy.stats import qmc  # slow to import

    return np.asarray(qmc.Sobol(dimension, seed=random).random(size))


def _latin(size: int, dimension: int, random: np.random.Generator) -> Array:
    """A Latin hypercube: each value is alone in its part of the range."""
    from scipy.stats import qmc

    return np.asarray(qmc.LatinHypercube(dimension, seed=random).random(size))


def _saltelli(size: int, dimension: int, random: np.random.Generator) -> Array:
    """Points A and B, and between them A with one value of B each (Saltelli and others 2010)."""
    both = _sobol(size, 2 * dimension, random)
    first, second = both[:, :dimension], both[:, dimension:]
    blocks = np.repeat(first[:, None], dimension + 2, axis=1)
    for k in range(dimension):
        blocks[:, k + 1, k] = second[:, k]
    blocks[:, -1] = second
    return blocks.reshape(-1, dimension)


def _morris(size: int, dimension: int, random: np.random.Generator) -> Array:
    """Paths on a grid on which each value jumps once, in random order (Morris 1991)."""
    found = np.empty((size, dimension + 1, dimension))
    for path in found:
        start = random.integers(LEVELS, size=dimension)
        path[:] = (start + 0.5) / LEVELS
        for step, k in enumerate(random.permutation(dimension), start=1):
            path[step:, k] += JUMP if start[k] < LEVELS // 2 else -JUMP
    return found.reshape(-1, dimension)


def _one(size: int, dimension: int, _: np.random.Generator) -> Array:
    """The middle, then each value alone from low to high."""
    steps = FARTHEST * np.arange(1, size + 1) / size
    found = np.full((1 + 2 * size * dimension, dimension), 0.5)
    for k in range(dimension):
        begin = 1 + 2 * size * k
        found[begin : begin + 2 * size, k] += np.concatenate([-steps[::-1], steps])
    return found


@dataclass(frozen=True)
class _Kind:
    """How a kind of design is made, its rows by size and dimension, Sobol' numbers a factor."""

    make: Callable[[int, int, np.random.Generator], Array]
    rows: Callable[[int, int], int]
    sequences: int = 0


_KINDS = {
    "sobol": _Kind(_sobol, lambda size, dimension: size, sequences=1),
    "latin": _Kind(_latin, lambda size, dimension: size),
    "saltelli": _Kind(_saltelli, lambda size, dimension: size * (dimension + 2), sequences=2),
    "morris": _Kind(_morris, lambda size, dimension: size * (dimension + 1)),
    "one": _Kind(_one, lambda size, dimension: 1 + 2 * size * dimension),
}
