"""Refinement: one computation of a service life in load blocks.

A *wear history* is a replicate whose surfaces wear from cycle to cycle, each cycle
standing for many strokes.  All histories advance together in *load blocks* of a few
cycles, in which a cycle stands for as many strokes as take a specified part of the
clearance off, by the mean rate of the cycles before.  A *service interval* ends with
the replacement or the turning of a bushing.

Quantities of the surfaces, *levels*, are known at the end of each block.  Quantities of
a stroke, *samples*, scatter: a polynomial is fitted to the means of the blocks, of the
order that best predicts one history from the others.  Intervals are those of the
jackknife over whole histories, of the logarithm of the life (Miller, The jackknife - a
review, Biometrika 61, 1, 1974).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import half_width
from presswear.scene.options import Limit
from presswear.tools.arrays import Array

Chosen = NDArray[np.int64] | slice  # indices of wear histories
EVERY = slice(None)
# part of the clearance that a cycle of the first refinement takes off
FIRST_CHANGE = 5e-3
MIN_BLOCK = 2  # cycles in the shortest load block
# Blocks after which a life ends at 0 strokes, because new surfaces exceed a limit
MIN_BLOCKS_FOR_REFUSAL = 16
MAX_ORDER = 3  # largest order of a polynomial through samples
# Samples must reach beyond a crossing by this part of the cycles up to the crossing
MARGIN = 0.1
MIN_BLOCKS = 4  # blocks before samples can have exceeded a limit


@dataclass(frozen=True)
class LoadBlock:
    """Some cycles of every wear history, or the maintenance of a bushing."""

    strokes: float  # since new, at its end
    cycles: int  # cycles of each history; 0: maintenance or a failed run
    interval: int  # number of the service interval
    # quantities of the surfaces at its end, by key, (histories,)
    levels: Mapping[str, Array]
    samples: Mapping[str, Array]  # means over its cycles, by key, (histories,)
    rate: float  # largest mean depth that a stroke took off, relative to the clearance
    # mean depth that a stroke takes off by Archard's law, (joints, 2, bins), m
    removed: Array
    # depth of the surfaces at its end, (histories, joints, 2, bins), m
    depth: Array = field(default_factory=lambda: np.zeros((0, 0, 2, 0)))
    ended_by: str = ""  # reason why it is the last: worn too deep, or a failed run
    wall_s: float = 0.0
    # histories whose motion repeats at its end; None: too few cycles
    settled: int | None = None


Blocks = Sequence[LoadBlock]


@dataclass(frozen=True)
class Refinement:
    """One computation of a life; its first block has short steps, on new surfaces."""

    change: float = FIRST_CHANGE  # part of the clearance that a cycle takes off
    block: int = MIN_BLOCK  # cycles in a block
    blocks: tuple[LoadBlock, ...] = ()

    @cached_property
    def histories(self) -> int:
        """Number of wear histories."""
        first = self.blocks[0]
        values = [*first.levels.values(), *first.samples.values()]
        return values[0].size

    @property
    def cycles(self) -> int:
        """Cycles of all histories."""
        return self.histories * sum(block.cycles for block in self.blocks)

    @cached_property
    def strokes(self) -> Array:
        """Strokes at the ends of the blocks, shape (blocks,)."""
        return np.array([block.strokes for block in self.blocks])

    def curve(self, key: str, chosen: Chosen = EVERY) -> Array:
        """Return a quantity at the ends of the blocks, shape (blocks,).

        It is the mean of the ``chosen`` histories.
        """
        blocks = self.blocks
        if key in blocks[0].levels:
            return np.array([block.levels[key][chosen].mean() for block in blocks])
        fits = np.empty(len(blocks))
        for _, group in groupby(range(len(blocks)), lambda k: blocks[k].interval):
            rows = list(group)
            if any(blocks[k].cycles for k in rows):
                fits[rows] = _fit([blocks[k] for k in rows], key, chosen)
            else:
                # No stroke has run since the maintenance.
                fits[rows] = fits[rows[0] - 1]
        if key == "repeatability":  # its samples are variances
            return np.sqrt(np.maximum(fits, 0.0))
        if key == "bdc_drift":
            fits = fits - fits[0]
        return np.abs(fits) if key in ("bdc_error", "bdc_drift") else fits

    def crossing(self, limits: Sequence[Limit], chosen: Chosen = EVERY) -> float:
        """Return the strokes after which the first of some limits is exceeded, or infinity."""
        first = math.inf
        strokes = self.strokes
        for limit in limits:
            values = self.curve(limit.key, chosen)
            above = np.flatnonzero(values >= limit.value)
            if not above.size:
                continue
            k = above[0]
            if k == 0:
                return 0.0
            fraction = (limit.value - values[k - 1]) / (values[k] - values[k - 1])
            crossing = strokes[k - 1] + fraction * (strokes[k] - strokes[k - 1])
            first = min(first, float(crossing))
        return first

    def _pseudo_values(self, value: Callable[[Chosen], Array | float]) -> Array:
        """Return the pseudo-values of the jackknife over the histories."""
        n = self.histories
        without_history = []
        for k in range(n):
            without_history.append(value(np.delete(np.arange(n), k)))
        return n * np.asarray(value(EVERY)) - (n - 1) * np.array(without_history)

    def logarithms(self, limits: Sequence[Limit]) -> Array:
        """Return the pseudo-values of the logarithm of the strokes at the first crossing.

        Empty if the other histories have no crossing when one history is left out.
        """
        if not 0.0 < self.crossing(limits) < math.inf or self.histories < 2:
            return np.zeros(0)
        with np.errstate(divide="ignore"):
            values = self._pseudo_values(
                lambda chosen: np.log(self.crossing(limits, chosen))
            )
        return values if np.isfinite(values).all() else np.zeros(0)

    def sampling_error(self, limits: Sequence[Limit]) -> float:
        """Return the half width of the logarithm of the strokes; infinite if it is unknown."""
        values = self.logarithms(limits)
        if not values.size:
            return math.inf
        return half_width(values) or 0.0

    def cycles_until(self, strokes: float) -> float:
        """Return the cycles of each history after the first block, up to some strokes."""
        cycles = np.cumsum([block.cycles for block in self.blocks])
        cycles -= self.blocks[0].cycles
        return float(np.interp(strokes, self.strokes, cycles))

    def band(self, key: str) -> tuple[Array, Array]:
        """Return a quantity at the ends of blocks and its half width, by the jackknife."""
        value = self.curve(key)
        if self.histories < 2:
            return value, np.zeros_like(value)
        pseudo = self._pseudo_values(lambda chosen: self.curve(key, chosen))
        return value, np.array([half_width(values) for values in pseudo.T])

    def determines(self, limits: Sequence[Limit]) -> bool:
        """Return whether the blocks reach far enough beyond the first crossing."""
        crossing = self.crossing(limits)
        if crossing == 0.0:
            return len(self.blocks) > MIN_BLOCKS_FOR_REFUSAL
        if math.isinf(self.sampling_error(limits)):
            return False
        first = next(limit for limit in limits if self.crossing([limit]) == crossing)
        if first.key in self.blocks[0].levels:
            return True
        needed = (1.0 + MARGIN) * self.cycles_until(crossing)
        return len(self.blocks) > MIN_BLOCKS and self.cycles_until(math.inf) >= needed


Refinements = Sequence[Refinement]


def _best_order(depths: Array, rows: Array, weights: Array) -> int:
    """Return the order of the polynomial that best predicts one history from the others.

    ``depths`` are the worn depths over the last one, shape (blocks,), ``rows`` the means
    of the blocks, (blocks, histories), and ``weights`` the square roots of their cycles,
    (blocks, 1).
    """
    # Mean of all histories but one, for each history
    means = (rows.sum(axis=1, keepdims=True) - rows) / max(rows.shape[1] - 1, 1)
    highest = max(min(MAX_ORDER, depths.size // 2 - 1), 0)
    errors = []
    for order in range(highest + 1):
        base = np.vander(depths, order + 1) * weights
        coefficients = np.linalg.lstsq(base, means * weights, rcond=None)[0]
        difference = base @ coefficients - rows * weights
        errors.append(float((difference**2).sum()))
    return int(np.argmin(errors))


def _fit(blocks: Blocks, key: str, chosen: Chosen) -> Array:
    """Return a quantity of a stroke at the ends of the blocks, shape (blocks,).

    It is a polynomial of the mean worn depth, fitted to the means of the blocks.
    """
    strokes = np.array([block.strokes for block in blocks])
    rates = np.array([block.rate for block in blocks[1:]])
    # A service interval starts with its new state, not with the end of its first block.
    worn = np.append(0.0, np.cumsum(rates * np.diff(strokes)))
    scale = float(worn[-1]) or 1.0
    cycles = np.array([float(block.cycles) for block in blocks])
    has_cycles = cycles > 0.0
    counts = cycles[has_cycles]
    # A sample belongs to the surfaces at the start of its cycle. The mean start of n
    # equal cycles is (1 + 1/n) / 2 of the block before its end.
    worn_in_block = np.diff(worn, prepend=0.0)[has_cycles]
    worn_at_samples = worn[has_cycles] - 0.5 * (1.0 + 1.0 / counts) * worn_in_block
    depths = worn_at_samples / scale
    rows = np.array([block.samples[key] for block in blocks])[has_cycles]
    weights = np.sqrt(counts)[:, np.newaxis]
    order = _best_order(depths, rows, weights)
    if key == "bdc_drift":  # with order 0 a drift would be exactly zero
        order = max(order, 1)
    order = min(order, depths.size - 1)
    mean = rows[:, chosen].mean(axis=1)
    curve = np.polynomial.Polynomial.fit(
        depths, mean, order, domain=[0.0, 1.0], w=weights[:, 0]
    )
    return np.asarray(curve(worn / scale))
