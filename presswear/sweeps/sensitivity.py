"""Sensitivity: how much of a measure follows from which factor, each number with its interval.

Chaos makes any two runs differ, and counts as a variance that no factor explains: it lowers first
order indices, and raises total ones and all effects of single steps.  Where draws at the same
points (or the intervals that runs tell) say how large it is, it is taken off, so that the indices
are those of the means over all draws.
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import Estimate, half_width
from presswear.sweeps.estimates import intervals, jackknife
from presswear.sweeps.responses import Responses
from presswear.tools.arrays import Array

LEAST_BLOCKS = 8
"""Blocks of a plan of Saltelli, or paths of Morris, below which nothing is told."""


@dataclass(frozen=True)
class Indices:
    """Sobol' indices of every factor.

    Attributes
    ----------
    first : tuple of Estimate
        Share of the variance that goes when the factor is known.
    total : tuple of Estimate
        Share that stays when all others are known; none where the points do not tell it.
    chaos : Estimate or None
        Share of the variance of a run that no factor explains.
    used : int
        Points they are from.
    method : str
        How they were found, with its source.
    """

    first: tuple[Estimate, ...]
    total: tuple[Estimate, ...]
    chaos: Estimate | None
    used: int
    method: str


@dataclass(frozen=True)
class Screening:
    """Effects of a factor that jumps by half of its range, after Morris (1991).

    Attributes
    ----------
    size : Estimate
        Mean of the absolute effects (mu* of Campolongo, Cariboni and Saltelli 2007).
    scatter : Estimate
        Standard deviation of the effects: how much they depend on the others, or bend.
    floor : float
        The mean that chaos alone would give; NaN where nothing tells it.
    """

    size: Estimate
    scatter: Estimate
    floor: float


@dataclass(frozen=True)
class Swing:
    """A measure when one factor alone leaves the middle.

    Attributes
    ----------
    low, high : float
        Values of the factor.
    at_low, at_high : Estimate
        Change of the measure from its value in the middle; no ends where nothing tells them.
    """

    low: float
    high: float
    at_low: Estimate
    at_high: Estimate

    @property
    def span(self) -> float:
        """Largest distance between the middle and both ends."""
        return max(self.at_low.mean, self.at_high.mean, 0.0) - min(
            self.at_low.mean, self.at_high.mean, 0.0
        )


def by_blocks(own: Responses) -> Indices | None:
    """Indices of first and total order of a plan of Saltelli; None where the points are none.

    First order after Saltelli and others (2010), total after Jansen (1999), both as
    ``scipy.stats.sobol_indices``, less what chaos makes of them; intervals by the jackknife over
    blocks.  A block with a point that has no value is left out.
    """
    dimension = own.points.shape[1]
    size = dimension + 2
    if not _are_blocks(own.points[own.path], size):
        return None
    rows = own.path.reshape(-1, size)
    values, noise, variances = own.means[rows], own.noise[rows], own.variances[rows]
    whole = np.isfinite(values).all(axis=1)
    values, noise, variances = values[whole], noise[whole], variances[whole]
    if len(values) < LEAST_BLOCKS:
        return None
    terms = block_terms(values, noise, variances)
    mean = terms.mean(axis=0)
    if mean[1] <= mean[0] ** 2:
        return None
    chaos, *found = intervals(*jackknife(terms, block_shares))
    return Indices(
        tuple(found[:dimension]),
        tuple(found[dimension:]),
        None if own.noise_source == "nothing" else chaos,
        values.size,
        "from blocks of points of which each changes one value (Saltelli and others 2010; total "
        "indices after Jansen 1999)",
    )


def block_terms(values: Array, noise: Array, variances: Array) -> Array:
    """What the indices of blocks are means of, shape (n, terms).

    Parameters
    ----------
    values, noise, variances : ndarray, shape (n, d + 2)
        Means at the points of the blocks, their variances, and those of single runs.
    """
    values = values - values[:, [0, -1]].mean()
    first, last, mixed = values[:, 0], values[:, -1], values[:, 1:-1]
    off = 0.5 * (noise[:, 0] + noise[:, -1])
    return np.column_stack(
        [
            0.5 * (first + last),
            0.5 * (first**2 + last**2) - off,
            0.5 * (variances[:, 0] + variances[:, -1]),
            last[:, None] * (mixed - first[:, None]),
            0.5 * (np.square(mixed - first[:, None]) - noise[:, 1:-1] - noise[:, :1]),
        ]
    )


def block_shares(mean: Array) -> Array:
    """Shares from means of ``block_terms``: of chaos, then first and total ones of each factor."""
    variance = mean[..., 1:2] - mean[..., :1] ** 2
    chaos = mean[..., 2:3]
    return np.concatenate([chaos / (variance + chaos), mean[..., 3:] / variance], axis=-1)


def _are_blocks(points: Array, size: int) -> bool:
    """Tell whether rows are blocks of a plan of Saltelli: A, A with one value of B each, B."""
    if len(points) < size or len(points) % size or size < 4:
        return False
    blocks = points.reshape(-1, size, size - 2)
    first, last, mixed = blocks[:, :1], blocks[:, -1:], blocks[:, 1:-1]
    is_own = np.eye(size - 2, dtype=np.bool_)
    return bool(np.array_equal(mixed, np.where(is_own, last, first)))


def screening(own: Responses) -> tuple[Screening, ...] | None:
    """Effects of each factor along paths on which each changes once; None where there are none.

    A path with a point that has no value is left out.
    """
    size = own.points.shape[1] + 1
    rows = own.path
    if not _are_paths(own.points[rows], size):
        return None
    rows = rows.reshape(-1, size)
    points, values, noise = own.points[rows], own.means[rows], own.noise[rows]
    whole = np.isfinite(values).all(axis=1)
    if np.count_nonzero(whole) < LEAST_BLOCKS:
        return None
    steps = np.diff(points[whole], axis=1)
    changes = np.diff(values[whole], axis=1)
    doubt = noise[whole, 1:] + noise[whole, :-1]
    found = []
    for k in range(size - 1):
        path, step = np.nonzero(steps[..., k])
        effects = changes[path, step] * np.sign(steps[path, step, k])
        chance = np.sqrt(2.0 / np.pi * doubt[path, step])
        floor = math.nan if own.noise_source == "nothing" else float(chance.mean())
        sizes = np.abs(effects)
        half = half_width(sizes) or 0.0
        mean = float(sizes.mean())
        found.append(Screening(Estimate(mean, mean - half, mean + half), _scatter(effects), floor))
    return tuple(found)


def _scatter(effects: Array) -> Estimate:
    """Standard deviation with the interval of its logarithm by the jackknife."""
    value = float(effects.std(ddof=1))
    if value == 0.0:
        return Estimate(0.0, 0.0, 0.0)
    off = effects - effects.mean()
    _, half = jackknife(
        np.column_stack([off, off**2]),
        lambda mean: 0.5 * np.log(mean[..., 1:] - mean[..., :1] ** 2),
    )
    factor = math.exp(float(half[0]))
    return Estimate(value, value / factor, value * factor)


def _are_paths(points: Array, size: int) -> bool:
    """Tell whether rows are paths on which each value changes once."""
    if len(points) < size or len(points) % size or size < 3:
        return False
    jumps = np.diff(points.reshape(-1, size, size - 1), axis=1) != 0.0
    return bool((jumps.sum(axis=1) == 1).all() and (jumps.sum(axis=2) == 1).all())


def swings(own: Responses) -> tuple[Swing | None, ...] | None:
    """The measure with each factor alone at its lowest and highest; None where nothing is alone.

    The first point is the middle; of a factor whose ends have no value there is nothing.
    """
    middle = own.points[0]
    apart = own.points != middle
    if len(own.points) < 3 or not (apart[1:].sum(axis=1) == 1).all() or not own.has_value[0]:
        return None
    found: list[Swing | None] = []
    for k, factor in enumerate(own.points.T):
        rows = np.flatnonzero(apart[:, k] & own.has_value)
        if not rows.size:
            found.append(None)
            continue
        low, high = (int(rows[place]) for place in (factor[rows].argmin(), factor[rows].argmax()))
        ends = (own.difference(low, 0), own.difference(high, 0))
        found.append(Swing(float(factor[low]), float(factor[high]), *ends))
    return tuple(found)
