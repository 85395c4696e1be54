"""Service life: wear until the first of several limits is exceeded.

A refinement computes the whole life once.  Refinements with ever finer steps and new
replicates follow until the life is known.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswear.campaign.life_estimate import estimate_life
from presswear.campaign.refinement import MIN_BLOCK, LoadBlock, Refinement, Refinements
from presswear.recording.statistics import half_width
from presswear.scene.options import Limit, Service
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

# 1/Pa, K_d times the strokes of a cycle of the first block: one stroke of steel
FIRST_WEAR = 1.2e-15
BLOCK_GROWTH = 0.5  # cycles in a block over the root of the cycles in the refinement
# cycles of each history up to the life, in a refinement that determines it
MIN_CYCLES = 16
# largest ratio of the strokes of a cycle in successive blocks
MAX_STEP_GROWTH = 2.0
SECOND_GROWTH = 4.0  # cycles of the second refinement over those of the first one
# Limits of the ratio of the cycles of successive refinements
MIN_GROWTH = 2.0
MAX_CYCLE_GROWTH = 8.0
SCATTER_FRACTION = 0.7  # part of the tolerance for the scatter of histories


@dataclass(frozen=True)
class LifeProblem:
    """Limits and accuracy of a service life."""

    limits: tuple[Limit, ...]
    services: tuple[Service, ...]  # in the order of strokes
    at_most: float  # strokes
    tolerance: float  # relative error of the life
    max_cycles: int  # cycles of all histories in a refinement
    # strokes that a cycle stands for before a wear rate is known
    first_share: float = 1.0


@dataclass(frozen=True)
class BlockPlan:
    """Plan of the next load block."""

    cycles: int  # cycles of each history
    share: float  # strokes that each stands for
    # depth that each takes off besides by Archard's law, (joints, 2, bins), m
    extra: Array | float = 0.0


Advance = Callable[[Refinements, BlockPlan | Service], LoadBlock]
"""Runs the next block, or the maintenance, in the last of some refinements."""


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
        if not last.blocks:
            _check_new(problem.limits, done[-1])
        keep(tuple(done))


def _check_new(limits: Sequence[Limit], refinement: Refinement) -> None:
    """Raise InputError if a limit is below the interval of the value in the first block."""
    for limit in limits:
        histories = range(refinement.histories)
        curves = [refinement.curve(limit.key, np.array([k])) for k in histories]
        values = np.ravel(curves)
        lowest = values.mean() - (half_width(values) or 0.0)
        if lowest >= limit.value:
            raise _exceeded_when_new(limit, refinement)


def _exceeded_when_new(limit: Limit, refinement: Refinement) -> InputError:
    value = float(refinement.curve(limit.key)[0])
    return InputError(
        f"until = '{limit.key} > {limit.value:.4g} {limit.unit}': it is exceeded when new, where "
        f"{limit.key} is {value:.4g} {limit.unit}"
    )


def next_block(
    problem: LifeProblem, refinement: Refinement
) -> BlockPlan | Service | None:
    """Return the next block, or maintenance, of a refinement; None if it is finished."""
    blocks = refinement.blocks
    if not blocks:
        return _first_block(problem, problem.at_most)
    last = blocks[-1]
    interval = last.interval
    has_all_strokes = last.strokes >= problem.at_most
    has_all_cycles = refinement.cycles >= 2 * problem.max_cycles
    if last.ended_by or has_all_strokes or has_all_cycles:
        return None
    if refinement.determines(problem.limits):
        return None
    is_last = interval == len(problem.services)
    until = problem.at_most if is_last else problem.services[interval].strokes
    if last.strokes >= until:
        return problem.services[interval]
    if not last.cycles:
        # After maintenance the rate is that of the bushing before it: the new state
        # runs first.
        return _first_block(problem, until - last.strokes)
    finished = [
        block for block in blocks if block.cycles and block.interval == interval
    ]
    rate = sum(block.rate for block in finished[-2:]) / len(finished[-2:])
    share = refinement.change / rate if rate > 0.0 else math.inf
    share = min(share, (until - last.strokes) / refinement.block)
    if len(finished) == 1:
        return BlockPlan(refinement.block, share)
    present = (last.strokes - finished[-2].strokes) / last.cycles
    share = min(share, MAX_STEP_GROWTH * present)
    extra = _lacking_depth(finished, present) / refinement.block
    return BlockPlan(refinement.block, share, extra)


def _first_block(problem: LifeProblem, strokes: float) -> BlockPlan:
    """Return the first block on new surfaces, of which some strokes remain."""
    return BlockPlan(MIN_BLOCK, min(problem.first_share, strokes / MIN_BLOCK))


def _lacking_depth(finished: Sequence[LoadBlock], share: float) -> Array:
    """Return the depth that the last block lacks, (joints, 2, bins), m.

    Each cycle stands for ``share`` strokes after it, at the rate on the surfaces before
    it. Compared with the trapezoidal rule, the sum lacks half of the change of the rate
    in each cycle.  All histories get the mean, so that no scatter adds up.  The new
    state was observed at the start of the next block.
    """
    before = finished[-2]
    last = finished[-1]
    distance = 0.5 * last.cycles
    if len(finished) > 2:
        distance += 0.5 * before.cycles
    change = last.removed - before.removed
    return 0.5 * share * last.cycles / distance * change


def next_refinement(
    problem: LifeProblem, refinements: Refinements
) -> Refinement | None:
    """Return the next refinement; None if the life is known, or the cycles are used up.

    InputError if a limit is exceeded when new.
    """
    last = refinements[-1]
    has_coarser = len(refinements) > 1  # else no error of the steps is known
    life = estimate_life(refinements, problem.limits)
    if life.strokes == 0.0:
        limit = next(limit for limit in problem.limits if last.crossing([limit]) == 0.0)
        raise _exceeded_when_new(limit, last)
    if has_coarser and (life.error <= problem.tolerance or math.isinf(life.strokes)):
        return None
    all_finished = finished_cycles(refinements, problem.limits)
    finished = all_finished[-1]
    cycles = next_cycles(problem, life.sampling, all_finished)
    if has_coarser and cycles * last.histories > problem.max_cycles:
        return None
    block = max(round(BLOCK_GROWTH * math.sqrt(cycles)), MIN_BLOCK)
    # The first cycles of a life stand for few strokes, however fine the steps are. The
    # number of the other cycles is proportional to the fineness.
    rates = np.array([block.rate for block in last.blocks[1:]])
    strokes = np.minimum(last.strokes, last.crossing(problem.limits))
    change = float(rates @ np.diff(strokes))
    scaled = min(max(change / last.change, 1.0), max(finished, 1.0))
    return Refinement(last.change * scaled / (cycles - finished + scaled), block)


def finished_cycles(refinements: Refinements, limits: Sequence[Limit]) -> list[float]:
    """Return the cycles of each history up to the life, or to the end, in each refinement."""
    return [
        max(refinement.cycles_until(refinement.crossing(limits)), 1.0)
        for refinement in refinements
    ]


def next_cycles(
    problem: LifeProblem, sampling: float, finished: Sequence[float]
) -> float:
    """Return the cycles of the refinement after some with finished cycles.

    ``sampling`` is the sampling error with the cycles of all finished refinements.
    """
    cycles = max(SECOND_GROWTH * finished[0], MIN_GROWTH * finished[-1])
    if math.isfinite(sampling):
        needed = (sampling / (SCATTER_FRACTION * problem.tolerance)) ** 2
        lacking = (needed - 1.0) * sum(finished)
        cycles = min(max(lacking, cycles), MAX_CYCLE_GROWTH * finished[-1])
    return max(cycles, MIN_CYCLES)
