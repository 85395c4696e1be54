"""Service life: wear until the first of several limits is exceeded.

A *wear history* is a replicate whose surfaces wear from cycle to cycle, each cycle
standing for many strokes.  All histories advance together in *load blocks* of a few
cycles, in which a cycle stands for as many strokes as take a specified part of the
clearance off, by the mean rate of the cycles before.  A *refinement* computes the whole
life once.  Refinements with ever finer steps and new replicates follow until the life
is known.  A *service interval* ends where a bushing is replaced or turned.

Quantities of the surfaces, *levels*, are known at the end of each block.  Quantities of
a stroke,
*samples*, scatter: a polynomial is fitted to the means of the blocks, of the order that best
predicts one history from the others.  Intervals are those of the jackknife over whole
histories, of the logarithm of the life (Miller, The jackknife - a review, Biometrika
61, 1, 1974).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.wear_update import STEP_SAFETY
from presswear.recording.statistics import STARTUP_CYCLES, half_width, quantile
from presswear.scene.options import Limit, Service
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

Chosen = NDArray[np.int64] | slice  # histories
EVERY = slice(None)

FIRST_CHANGE = 5e-3  # of the clearance, that a cycle of the first refinement takes off
MIN_BLOCK = 2  # cycles
# 1/Pa, K_d times the strokes of a cycle of the first block: one stroke of steel
FIRST_WEAR = 1.2e-15
BLOCK_GROWTH = 0.5  # cycles in a block over the root of those in the refinement
# after which a limit that seems exceeded when new is taken to be so
MIN_BLOCKS_FOR_REFUSAL = 16
MIN_CYCLES = 16  # of each history up to the life, in a refinement that determines it
# ratio of cycles of two refinements that show the error of the step
MIN_REFINEMENT = 1.5
MAX_STEP_GROWTH = 2.0  # from block to block
SECOND_GROWTH = 2.6  # of the cycles, in the second refinement
# Growth of the cycles from refinement to refinement
MIN_GROWTH = 2.0
MAX_CYCLE_GROWTH = 8.0
# of the tolerance, expected distance of the first two refinements, or
FIRST_DISTANCE = 0.3
# of the half width over the histories: the mean for equal distributions
FIRST_SCATTER = 0.4
SCATTER_FRACTION = 0.7  # of the tolerance, that is meant for the scatter of histories
MAX_ORDER = 3  # of a polynomial through samples
MARGIN = 0.1  # of the cycles up to a crossing; samples reach this far beyond it
MIN_BLOCKS = 4  # before samples can have exceeded a limit


@dataclass(frozen=True)
class LifeProblem:
    """Limits and accuracy of a service life."""

    limits: tuple[Limit, ...]
    services: tuple[Service, ...]  # in the order of strokes
    at_most: float  # strokes
    tolerance: float  # relative error of the life
    max_cycles: int  # of all histories in a refinement
    # strokes that a cycle stands for before a wear rate is known
    first_share: float = 1.0


@dataclass(frozen=True)
class LoadBlock:
    """Some cycles of every wear history, or the maintenance of a bushing."""

    strokes: float  # since new, at its end
    cycles: int  # of each history; 0: maintenance or a failed run
    interval: int  # number of the service interval
    # quantities of the surfaces at its end, by key, (histories,)
    levels: Mapping[str, Array]
    samples: Mapping[str, Array]  # means over its cycles, by key, (histories,)
    rate: float  # largest mean depth that a stroke took off, relative to the clearance
    # mean depth that a stroke takes off by Archard's law, (joints, 2, bins), m
    removed: Array
    depth: Array = field(default_factory=lambda: np.zeros((0, 0, 2, 0)))
    # of the surfaces at its end, (histories, joints, 2, bins), m
    ended_by: str = ""  # reason why it is the last: worn too deep, or a failed run
    wall_s: float = 0.0
    # histories whose motion repeats at its end; None: too few cycles
    settled: int | None = None


Blocks = Sequence[LoadBlock]


@dataclass(frozen=True)
class BlockPlan:
    """Plan of the next load block."""

    cycles: int  # of each history
    share: float  # strokes that each stands for
    # depth that each takes off besides by Archard's law, (joints, 2, bins), m
    extra: Array | float = 0.0


@dataclass(frozen=True)
class Refinement:
    """One computation of a life; its first block has short steps, on new surfaces."""

    change: float = FIRST_CHANGE  # part of the clearance that a cycle takes off
    block: int = MIN_BLOCK  # cycles in a block
    blocks: tuple[LoadBlock, ...] = ()

    @cached_property
    def histories(self) -> int:
        """Number of wear histories."""
        return next(
            iter({**self.blocks[0].levels, **self.blocks[0].samples}.values())
        ).size

    @property
    def cycles(self) -> int:
        """Cycles of all histories."""
        return self.histories * sum(block.cycles for block in self.blocks)

    @cached_property
    def strokes(self) -> Array:
        """Strokes at the ends of the blocks, shape (blocks,)."""
        return np.array([block.strokes for block in self.blocks])

    def curve(self, key: str, chosen: Chosen = EVERY) -> Array:
        """Return a quantity at the ends of blocks, mean of the chosen histories, (blocks,)."""
        blocks = self.blocks
        if key in blocks[0].levels:
            return np.array([block.levels[key][chosen].mean() for block in blocks])
        fits = np.empty(len(blocks))
        for _, group in groupby(range(len(blocks)), lambda k: blocks[k].interval):
            rows = list(group)
            if any(blocks[k].cycles for k in rows):
                fits[rows] = _fit([blocks[k] for k in rows], key, chosen)
            else:
                fits[rows] = fits[
                    rows[0] - 1
                ]  # no stroke has run since the maintenance
        if key == "repeatability":  # of which variances are averaged
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
            if above.size and above[0] == 0:
                return 0.0
            if above.size:
                k = above[0]
                part = (limit.value - values[k - 1]) / (values[k] - values[k - 1])
                first = min(
                    first, float(strokes[k - 1] + part * (strokes[k] - strokes[k - 1]))
                )
        return first

    def _pseudo_values(self, value: Callable[[Chosen], Array | float]) -> Array:
        """Return the pseudo-values of the jackknife over the histories."""
        n = self.histories
        left_out = np.array([value(np.delete(np.arange(n), k)) for k in range(n)])
        return n * np.asarray(value(EVERY)) - (n - 1) * left_out

    def sampling_error(self, limits: Sequence[Limit]) -> float:
        """Return the half width of the logarithm of the strokes at the first crossing.

        Infinite if some history, left out, leaves the others without a crossing.
        """
        if not 0.0 < self.crossing(limits) < math.inf or self.histories < 2:
            return math.inf
        with np.errstate(divide="ignore"):
            values = self._pseudo_values(
                lambda chosen: np.log(self.crossing(limits, chosen))
            )
        return (half_width(values) or 0.0) if np.isfinite(values).all() else math.inf

    def cycles_until(self, strokes: float) -> float:
        """Return the cycles of each history after the first block, up to some strokes."""
        ends = (
            np.cumsum([block.cycles for block in self.blocks]) - self.blocks[0].cycles
        )
        return float(np.interp(strokes, self.strokes, ends))

    def band(self, key: str) -> tuple[Array, Array]:
        """Return a quantity at the ends of blocks and its half width, by the jackknife."""
        value = self.curve(key)
        if self.histories < 2:
            return value, np.zeros_like(value)
        pseudo = self._pseudo_values(lambda chosen: self.curve(key, chosen))
        return value, np.array([half_width(values) for values in pseudo.T])

    def determines(self, limits: Sequence[Limit]) -> bool:
        """Return whether the blocks reach far enough beyond the first crossing."""
        value = self.crossing(limits)
        if value == 0.0:
            return len(self.blocks) > MIN_BLOCKS_FOR_REFUSAL
        if math.isinf(self.sampling_error(limits)):
            return False
        first = next(limit for limit in limits if self.crossing([limit]) == value)
        if first.key in self.blocks[0].levels:
            return True
        needed = (1.0 + MARGIN) * self.cycles_until(value)
        return len(self.blocks) > MIN_BLOCKS and self.cycles_until(math.inf) >= needed


Refinements = Sequence[Refinement]
Advance = Callable[[Refinements, BlockPlan | Service], LoadBlock]
"""Runs the next block, or the maintenance, in the last of some refinements."""


@dataclass(frozen=True)
class LifeEstimate:
    """Life, infinite if no limit was exceeded, and the errors of its logarithm."""

    strokes: float
    sampling: float  # half width over the histories
    step: float

    @property
    def error(self) -> float:
        """Root of the sum of squares of both errors."""
        return math.hypot(self.sampling, self.step)


def _fit(blocks: Blocks, key: str, chosen: Chosen) -> Array:
    """Return a polynomial over the depth worn off through samples, at the ends of blocks."""
    strokes = np.array([block.strokes for block in blocks])
    rates = np.array([block.rate for block in blocks[1:]])
    # A service interval starts with its new state, not with the end of its first block.
    change = np.append(0.0, np.cumsum(rates * np.diff(strokes)))
    scale = float(change[-1]) or 1.0
    has_cycles = np.array([block.cycles > 0 for block in blocks])
    counts = np.array([block.cycles for block in blocks if block.cycles], dtype=float)
    # A cycle runs on the surfaces before it.
    back = np.diff(change, prepend=0.0)[has_cycles] * 0.5 * (1.0 + 1.0 / counts)
    places = (change[has_cycles] - back) / scale
    rows = np.array([block.samples[key] for block in blocks if block.cycles])
    weights = np.sqrt(counts)[:, np.newaxis]
    # Of the order that best predicts one history from the others.
    others = (rows.sum(axis=1, keepdims=True) - rows) / max(rows.shape[1] - 1, 1)
    errors = []
    for order in range(max(min(MAX_ORDER, places.size // 2 - 1), 0) + 1):
        base = np.vander(places, order + 1) * weights
        fit = base @ np.linalg.lstsq(base, others * weights, rcond=None)[0]
        errors.append(float(((fit - rows * weights) ** 2).sum()))
    # With order 0 a drift would be exactly zero.
    order = max(int(np.argmin(errors)), int(key == "bdc_drift"))
    order = min(order, places.size - 1)
    mean = rows[:, chosen].mean(axis=1)
    curve = np.polynomial.Polynomial.fit(
        places, mean, order, domain=[0.0, 1.0], w=weights[:, 0]
    )
    return np.asarray(curve(change / scale))


def run_refinements(
    problem: LifeProblem,
    advance: Advance,
    refinements: Refinements = (),
    keep: Callable[[tuple[Refinement, ...]], None] = lambda refinements: None,
    report: Callable[[tuple[Refinement, ...]], None] = lambda refinements: None,
) -> tuple[Refinement, ...]:
    """Run refinements until the life is known; InputError if a limit is exceeded when new.

    ``report`` is called with the finished refinements whenever another one follows.
    """
    done = list(refinements) or [Refinement()]
    is_unfinished = len(done) > 1 and next_block(problem, done[-1]) is not None
    if is_unfinished and next_refinement(problem, done[:-1]) is None:
        # a looser tolerance is met without the refinement that was interrupted
        done.pop()
    while True:
        last = done[-1]
        plan = next_block(problem, last)
        if plan is None:
            further = next_refinement(problem, done)
            if further is None:
                return tuple(done)
            report(tuple(done))
            done.append(further)
            continue
        done[-1] = replace(last, blocks=(*last.blocks, advance(done, plan)))
        for limit in () if last.blocks else problem.limits:
            each = [
                done[-1].curve(limit.key, np.array([k]))
                for k in range(done[-1].histories)
            ]
            # The lower end of the interval of the new value.
            if np.mean(each) - (half_width(np.ravel(each)) or 0.0) >= limit.value:
                raise _exceeded_when_new(limit, done[-1])
        keep(tuple(done))


def _exceeded_when_new(limit: Limit, refinement: Refinement) -> InputError:
    value = float(refinement.curve(limit.key)[0])
    return InputError(
        f"until = '{limit.key} > {limit.value:.4g} {limit.unit}': it is exceeded when new, where "
        f"{limit.key} is {value:.4g} {limit.unit}"
    )


def next_block(
    problem: LifeProblem, refinement: Refinement
) -> BlockPlan | Service | None:
    """Return what a refinement runs next; None if it is finished."""
    blocks = refinement.blocks
    if not blocks:
        return BlockPlan(
            MIN_BLOCK, min(problem.first_share, problem.at_most / MIN_BLOCK)
        )
    last = blocks[-1]
    interval = blocks[-1].interval
    is_used_up = (
        last.strokes >= problem.at_most or refinement.cycles >= 2 * problem.max_cycles
    )
    if last.ended_by or is_used_up or refinement.determines(problem.limits):
        return None
    is_last = interval == len(problem.services)
    until = problem.at_most if is_last else problem.services[interval].strokes
    if last.strokes >= until:
        return problem.services[interval]
    if not last.cycles:
        # After maintenance the rate is that of the bushing before it: the new state
        # runs first.
        return BlockPlan(
            MIN_BLOCK, min(problem.first_share, (until - last.strokes) / MIN_BLOCK)
        )
    finished = [
        block for block in blocks if block.cycles and block.interval == interval
    ]
    rate = sum(block.rate for block in finished[-2:]) / len(finished[-2:])
    share = refinement.change / rate if rate > 0.0 else math.inf
    if len(finished) > 1:
        share = min(
            share, MAX_STEP_GROWTH * (last.strokes - blocks[-2].strokes) / last.cycles
        )
    share = min(share, (until - last.strokes) / refinement.block)
    if len(finished) == 1:
        return BlockPlan(refinement.block, share)
    # Each cycle stood for strokes after it, at the rate of its own surfaces: to the
    # trapezoidal rule the sum lacks half of a cycle's change of the rate for each
    # cycle.  All histories get the mean, so that no scatter adds up.  The new state was
    # observed where the next block started.
    before = finished[-2]
    distance = 0.5 * (last.cycles + (before.cycles if len(finished) > 2 else 0))
    stood_for = (last.strokes - before.strokes) / last.cycles
    lacking = 0.5 * stood_for * last.cycles / distance * (last.removed - before.removed)
    return BlockPlan(refinement.block, share, lacking / refinement.block)


def next_refinement(
    problem: LifeProblem, refinements: Refinements
) -> Refinement | None:
    """Return the next refinement; None if the life is known, or the cycles are used up.

    InputError if a limit is exceeded when new.
    """
    last = refinements[-1]
    has_coarser = len(refinements) > 1
    life = estimate_life(refinements, problem.limits)
    if life.strokes == 0.0:
        limit = next(limit for limit in problem.limits if last.crossing([limit]) == 0.0)
        raise _exceeded_when_new(limit, last)
    if has_coarser and (life.error <= problem.tolerance or math.isinf(life.strokes)):
        return None
    each = _finished_cycles(refinements, problem.limits)
    finished = each[-1]
    cycles = _next_cycles(problem, life.sampling, each)
    if has_coarser and cycles * last.histories > problem.max_cycles:
        return None
    block = max(round(BLOCK_GROWTH * math.sqrt(cycles)), MIN_BLOCK)
    # The first cycles of a life stand for few strokes, however fine the steps; the
    # others scale.
    rates = np.array([block.rate for block in last.blocks[1:]])
    change = float(
        rates @ np.diff(np.minimum(last.strokes, last.crossing(problem.limits)))
    )
    scaled = min(max(change / last.change, 1.0), max(finished, 1.0))
    return Refinement(last.change * scaled / (cycles - finished + scaled), block)


def _finished_cycles(refinements: Refinements, limits: Sequence[Limit]) -> list[float]:
    """Return the cycles of each history up to the life, or to the end, in each refinement."""
    return [max(each.cycles_until(each.crossing(limits)), 1.0) for each in refinements]


def _next_cycles(
    problem: LifeProblem, sampling: float, finished: Sequence[float]
) -> float:
    """Return the cycles of the refinement after some with finished cycles.

    The sampling error is that of the cycles of all of them.
    """
    cycles = max(SECOND_GROWTH * finished[0], MIN_GROWTH * finished[-1])
    if math.isfinite(sampling):
        needed = (sampling / (SCATTER_FRACTION * problem.tolerance)) ** 2
        lacking = (needed - 1.0) * sum(finished)
        cycles = min(max(lacking, cycles), MAX_CYCLE_GROWTH * finished[-1])
    return max(cycles, MIN_CYCLES)


def fewest_cycles(problem: LifeProblem, clearances: Mapping[str, float]) -> float:
    """Return the cycles of each history that two refinements take at least, before any has run.

    A cycle of the first one wears no joint by more than a part of its clearance, m, so
    that a limit on a depth takes some cycles. The second one has at least twice as
    many.
    """
    # A clearance grows by as much as both surfaces wear.
    surfaces = {"depth": 1.0, "radial_clearance": 2.0, "diametral_clearance": 4.0}
    parts = [
        (limit.value - limit.new)
        / (surfaces[limit.name] * FIRST_CHANGE * clearances[limit.joint])
        if limit.name in surfaces
        else 0.0
        for limit in problem.limits
    ]
    first = max(min(parts), MIN_BLOCK)
    second = max(SECOND_GROWTH * first, MIN_CYCLES)
    return 2 * (STARTUP_CYCLES + MIN_BLOCK) + first + second


def cycles_left(problem: LifeProblem, refinements: Refinements) -> float:
    """Return the cycles of each history that are expected until the life is known.

    After the last refinement others follow by the rule of ``next_refinement``. The
    error of the scatter falls with the root of the cycles of all refinements. That of
    the step follows from the distance of the first life and the last one. In the first
    refinement the scatter follows from the depths worn so far.
    """
    *coarser, last = refinements
    limits = problem.limits
    ends = _finished_cycles(coarser, limits)
    histories = refinements[0].histories if refinements[0].blocks else 1
    completed = sum(block.cycles for block in last.blocks[1:])
    left = _left_in_last(problem, refinements, completed)
    ends.append(max(completed + left, 1.0))
    left += last.block + (0 if last.blocks else STARTUP_CYCLES + MIN_BLOCK)
    if coarser:
        sampling = estimate_life(coarser, limits).sampling
        pooled = sum(ends[:-1])
    else:
        sampling = _expected_sampling(problem, last, ends[-1])
        pooled = ends[-1]
    if math.isinf(sampling):
        return left
    distance = max(FIRST_DISTANCE * problem.tolerance, FIRST_SCATTER * sampling)
    if coarser:
        change = abs(
            math.log(coarser[0].crossing(limits) / coarser[-1].crossing(limits))
        )
        distance = change if 0.0 < change < math.inf else distance
    while True:
        sampling *= math.sqrt(pooled / sum(ends))
        pooled = sum(ends)
        ratio = max(ends[-1] / ends[0], MIN_REFINEMENT)
        slope = distance * ends[0] * ratio / (ratio - 1.0)
        step = STEP_SAFETY * slope * len(ends) / pooled
        cycles = _next_cycles(problem, sampling, ends)
        is_known = math.hypot(sampling, step) <= problem.tolerance
        is_used_up = cycles * histories > problem.max_cycles
        if len(ends) > 1 and (is_known or is_used_up):
            return left
        left += STARTUP_CYCLES + MIN_BLOCK + cycles
        ends.append(cycles)


def _expected_sampling(
    problem: LifeProblem, refinement: Refinement, cycles: float
) -> float:
    """Return the sampling error expected after some cycles, by the depths worn so far.

    The tolerance is expected before the depths of the histories can be compared.
    """
    completed = sum(block.cycles for block in refinement.blocks[1:])
    if not completed or refinement.histories < 2:
        return problem.tolerance
    levels = refinement.blocks[-1].levels
    limits = [limit for limit in problem.limits if limit.key in levels]
    depths = [levels[limit.key] - limit.new for limit in limits]
    halves = [
        half_width(np.log(depth)) or 0.0 for depth in depths if np.all(depth > 0.0)
    ]
    share = min(completed / cycles, 1.0)
    return min(halves) * math.sqrt(share) if halves else problem.tolerance


def _left_in_last(
    problem: LifeProblem, refinements: Refinements, completed: int
) -> float:
    """Return the cycles of each history up to the life that the last refinement lacks.

    They are spread evenly over the depth that wears off: a limit on a quantity of the
    surfaces tells the completed part, and the refinement before tells it for one of a
    stroke.
    """
    *coarser, last = refinements
    blocks = last.blocks
    limits = problem.limits
    lefts = []
    whole = float(MIN_CYCLES)
    if coarser:
        before = coarser[-1]
        life = coarser[-1].crossing(limits)
        each = _finished_cycles(coarser, limits)
        finished = each[-1]
        whole = _next_cycles(problem, estimate_life(coarser, limits).sampling, each)
    if not blocks:
        return whole
    strokes = blocks[-1].strokes
    first = blocks[0]
    for limit in limits:
        if limit.key in first.levels:
            values = last.curve(limit.key)
            per_cycle = float(np.diff(values).clip(0.0).sum()) / max(completed, 1)
            if not completed and first.rate > 0.0:
                growth = float(values[0]) - limit.new
                per_cycle = growth / first.strokes * last.change / first.rate
            if per_cycle > 0.0:
                lefts.append(float(limit.value - values[-1]) / per_cycle)
        elif coarser and before.crossing([limit]) == life:
            part = before.cycles_until(strokes) / max(finished, 1.0)
            lefts.append((1.0 + MARGIN) * whole * (1.0 - part))
    if completed and strokes > blocks[-2].strokes:
        stood_for = (strokes - blocks[-2].strokes) / blocks[-1].cycles
        lefts.append((problem.at_most - strokes) / stood_for)
    return max(min(lefts, default=whole - completed), 0.0)


def estimate_life(refinements: Refinements, limits: Sequence[Limit]) -> LifeEstimate:
    """Return the strokes after which the first of some limits is exceeded, with their errors.

    The logarithm of the life is the mean over the refinements, each weighted by its
    cycles.  The error of the step of a refinement goes as one over its cycles, or
    faster.  Where it is larger than the scatter in the last refinement, that refinement
    alone is taken.
    """
    end = refinements[-1].crossing(limits)
    if not 0.0 < end < math.inf:
        return LifeEstimate(end, math.inf, math.inf)
    ended = [item for item in refinements if 0.0 < item.crossing(limits) < math.inf]
    logarithms = np.log([item.crossing(limits) for item in ended])
    cycles = np.array([item.cycles_until(item.crossing(limits)) for item in ended])
    halves = np.array([item.sampling_error(limits) for item in ended])
    freedom = np.array([item.histories - 1 for item in ended])
    slope = _step_slope(cycles, logarithms)
    last = LifeEstimate(end, float(halves[-1]), slope / float(cycles[-1]))
    if not last.step < last.sampling < math.inf:
        return last
    weights = cycles / cycles.sum()
    strokes = math.exp(float(weights @ logarithms))
    step = slope * len(ended) / float(cycles.sum())
    return LifeEstimate(strokes, _pooled_half_width(weights, halves, freedom), step)


def _pooled_half_width(weights: Array, halves: Array, freedom: Array) -> float:
    """Return the half width of a weighted mean of independent estimates.

    Its degrees of freedom are those of Welch and Satterthwaite.
    """
    if np.isinf(halves).any():
        return math.inf
    variances = (weights * halves / [quantile(each) for each in freedom]) ** 2
    variance = float(variances.sum())
    joint_freedom = variance**2 / float((variances**2 / freedom).sum())
    return quantile(joint_freedom) * math.sqrt(variance)


def _step_slope(cycles: Array, logarithms: Array) -> float:
    """Return the error of the step of a refinement times its cycles; infinite if it is unknown.

    It is twice the slope of the logarithms over one over the cycles, by least squares
    with the cycles as weights.
    """
    if cycles.min() * MIN_REFINEMENT > cycles.max():
        return math.inf
    slope = np.polyfit(1.0 / cycles, logarithms, 1, w=np.sqrt(cycles))[0]
    return STEP_SAFETY * abs(float(slope))
