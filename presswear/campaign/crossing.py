"""After how many strokes followed numbers pass their limits, from chains of independent starts.

A chain is a start whose surfaces wear from cycle to cycle, each cycle standing for many strokes;
all chains take the same steps.  What the surfaces alone decide, a level, is known at the end of
each block of cycles.  What a stroke gives, a sample, scatters from one to the next: a polynomial
over the cycles is laid through the means of the blocks, of the order that best foretells a chain
from the others.  In cycles, not strokes: each cycle takes about as much off as the one before, so
that running-in bends no curve.

Intervals are those of the jackknife over whole chains, which share nothing: of the logarithm, since
a life has no sign (Miller, The jackknife - a review, Biometrika 61, 1, 1974).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import half_width
from presswear.scene.options import Limit

Array = NDArray[np.float64]

HIGHEST_ORDER = 3
"""Of a polynomial through samples."""
LOWEST = {"bdc_drift": 1}
"""The same by key, at least: of a level line a drift would be nothing, and surely so."""
SPARE = 0.1
"""Part of the cycles up to a crossing that samples reach beyond it: at its end a fit is loose."""
LEAST_BLOCKS = 4
"""Blocks before samples are said to have passed a limit."""


@dataclass(frozen=True)
class Block:
    """Some cycles of every chain.

    Attributes
    ----------
    strokes : float
        Since new, at its end.
    cycles : int
        Of each chain; none where a bush was seen to.
    span : int
        Times that a bush was seen to before.
    levels : mapping of str to ndarray, shape (chains,)
        What surfaces decide, at its end, by key.
    samples : mapping of str to ndarray, shape (chains,)
        Means over its cycles, by key.
    rate : float
        Largest depth that a stroke took off a place, mean of the chains, part of its clearance.
    taken : ndarray, shape (joints, 2, m)
        Depth that a stroke took off, mean of the chains, m.
    worn : ndarray, shape (chains, joints, 2, m)
        Depth of the surfaces at its end, m.
    gone : str
        Why it is the last: a surface is worn deeper than the model goes, or a run failed; or
        nothing.
    wall_s : float
        Wall time, s.
    """

    strokes: float
    cycles: int
    span: int
    levels: Mapping[str, Array]
    samples: Mapping[str, Array]
    rate: float
    taken: Array
    worn: Array = field(default_factory=lambda: np.zeros((0, 0, 2, 0)))
    gone: str = ""
    wall_s: float = 0.0


Blocks = Sequence[Block]
Chosen = NDArray[np.int64] | slice
EVERY = slice(None)
"""All chains."""

TOLD: dict[str, Callable[[Array, float], Array]] = {
    "bdc_error": lambda fit, new: np.abs(fit),
    "bdc_drift": lambda fit, new: np.abs(fit - new),
    "repeatability": lambda fit, new: np.sqrt(np.maximum(fit, 0.0)),
}
"""What a limit is put on, from a fit through samples and its value when new, where that is not the
fit: errors have a sign, and variances are what can be averaged."""


def strokes_of(blocks: Blocks) -> Array:
    """Strokes at the ends of blocks, shape (blocks,)."""
    return np.array([block.strokes for block in blocks])


def curve(blocks: Blocks, key: str, chains: Chosen = EVERY) -> Array:
    """A followed number at the ends of blocks, mean of some chains, shape (blocks,).

    Parameters
    ----------
    key : str
        As in a ``Limit``.
    chains : ndarray of int, or slice
    """
    if key in blocks[0].levels:
        return np.array([block.levels[key][chains].mean() for block in blocks])
    name = key.rpartition(".")[2]
    fits = np.empty(len(blocks))
    for span in sorted({block.span for block in blocks}):
        own = np.array([k for k, block in enumerate(blocks) if block.span == span])
        if any(blocks[k].cycles for k in own):
            fits[own] = _fit([blocks[k] for k in own], key, chains)
        else:
            # No stroke has run since a bush was seen to.
            fits[own] = fits[own[0] - 1]
    return TOLD[name](fits, float(fits[0])) if name in TOLD else fits


def _fit(blocks: Blocks, key: str, chains: Chosen) -> Array:
    """The fit through samples of one span, at the ends of its blocks, shape (blocks,)."""
    strokes = strokes_of(blocks)
    # A span begins with what is new in it, not with the end of its first block.
    way = np.cumsum([0.0, *(b.rate * n for b, n in zip(blocks[1:], np.diff(strokes), strict=True))])
    scale = float(way[-1]) or 1.0
    held = np.array([block.cycles > 0 for block in blocks])
    counts = np.array([block.cycles for block in blocks if block.cycles], dtype=float)
    # A cycle runs on the surfaces before it.
    back = np.append(0.0, np.diff(way))[held] * 0.5 * (1.0 + 1.0 / counts)
    places = (way[held] - back) / scale
    rows = np.array([block.samples[key] for block in blocks if block.cycles])
    weights = np.sqrt(counts)
    order = max(_order(places, rows, weights), LOWEST.get(key, 0))
    order = min(order, places.size - 1)
    found = np.polynomial.Polynomial.fit(
        places, rows[:, chains].mean(axis=1), order, domain=[0.0, 1.0], w=weights
    )
    return np.asarray(found(way / scale))


def _order(places: Array, rows: Array, weights: Array) -> int:
    """The order of the polynomial through some chains that best foretells another one."""
    count = rows.shape[1]
    highest = min(HIGHEST_ORDER, places.size // 2 - 1)
    errors = []
    for order in range(max(highest, 0) + 1):
        base = np.vander(places, order + 1) * weights[:, np.newaxis]
        # Of the mean of all but one chain, laid beside that one.
        others = (rows.sum(axis=1, keepdims=True) - rows) / max(count - 1, 1)
        laid = base @ np.linalg.lstsq(base, others * weights[:, np.newaxis], rcond=None)[0]
        errors.append(float(((laid - rows * weights[:, np.newaxis]) ** 2).sum()))
    return int(np.argmin(errors))


def passed(blocks: Blocks, limit: Limit, chains: Chosen = EVERY) -> float:
    """Strokes after which the mean of some chains passes a limit; infinite where it does not."""
    values, strokes = curve(blocks, limit.key, chains), strokes_of(blocks)
    above = np.flatnonzero(values >= limit.value)
    if not above.size:
        return math.inf
    k = int(above[0])
    if k == 0:
        return 0.0
    part = (limit.value - values[k - 1]) / (values[k] - values[k - 1])
    return float(strokes[k - 1] + part * (strokes[k] - strokes[k - 1]))


def first_passed(blocks: Blocks, limits: Sequence[Limit], chains: Chosen = EVERY) -> float:
    """Strokes after which the first of some limits is passed."""
    return min(passed(blocks, limit, chains) for limit in limits)


def sampling_error(blocks: Blocks, limits: Sequence[Limit]) -> float:
    """Half width of the logarithm of the strokes at which the first of some limits is passed.

    Infinite while some chain, left out, would leave it without a crossing.
    """
    everyone = np.arange(chains_of(blocks))
    value = first_passed(blocks, limits)
    if not 0.0 < value < math.inf or everyone.size < 2:
        return math.inf
    without = np.array([first_passed(blocks, limits, np.delete(everyone, k)) for k in everyone])
    if not np.all((without > 0.0) & np.isfinite(without)):
        return math.inf
    n = everyone.size
    half = half_width(n * math.log(value) - (n - 1) * np.log(without))
    assert half is not None, "there are several chains"
    return half


def chains_of(blocks: Blocks) -> int:
    """Number of chains."""
    return next(iter({**blocks[0].levels, **blocks[0].samples}.values())).size


def is_sampled(blocks: Blocks, limit: Limit) -> bool:
    """True where a limit is on what strokes give, not on what surfaces decide."""
    return limit.key not in blocks[0].levels


def cycles_until(blocks: Blocks, strokes: float) -> float:
    """Cycles of each chain behind the first block up to some strokes."""
    ends = np.cumsum([block.cycles for block in blocks]) - blocks[0].cycles
    return float(np.interp(strokes, strokes_of(blocks), ends))


def is_beyond(blocks: Blocks, limits: Sequence[Limit]) -> bool:
    """True where the chains have gone far enough past the first of their limits to know it."""
    if not math.isfinite(sampling_error(blocks, limits)):
        return False
    value = first_passed(blocks, limits)
    first = next(own for own in limits if passed(blocks, own) == value)
    if not is_sampled(blocks, first):
        return True
    run = cycles_until(blocks, math.inf)
    return len(blocks) > LEAST_BLOCKS and run >= (1.0 + SPARE) * cycles_until(blocks, value)
