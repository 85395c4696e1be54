"""A life: wear run forward until the first of some limits is passed, and how well it is known.

The surfaces of each start wear from cycle to cycle, and a cycle stands for as many strokes as take
a given part of the clearance off, by the mean of the cycles before it: by its own it would weigh
cycles that wear much less than others.  Passes over the whole life, each with finer steps and
starts of its own, go on until the life is known: the half width over the starts, and what
passes in much coarser steps say of the steps, as the root of the sum of squares.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.crossing import (
    Block,
    Blocks,
    chains_of,
    curve,
    cycles_until,
    first_passed,
    is_beyond,
    passed,
    sampling_error,
)
from presswear.recording.statistics import half_width
from presswear.scene.options import Limit, Service
from presswear.tools.errors import InputError

Array = NDArray[np.float64]

FIRST_CHANGE = 5e-3
"""Part of the clearance that a cycle of the first pass takes off."""
LEAST_BLOCK = 2
"""Cycles in which each start goes on before the step is chosen anew."""
LONGER = 0.5
"""Cycles in a block over the root of those in the pass: blocks are to get finer with steps."""
SURELY = 16
"""Blocks after which a limit that seems to be exceeded when new is taken to be so."""
FEWEST_CYCLES = 16
"""Of each start up to the life in a pass that tells it: one in fewer only finds how long it about
is."""
COARSER = 2.5
"""Cycles of a pass over those of another that tells the error of its steps: where they are nearly
as many, chance is all that sets them apart."""
FASTER, MOST_MORE = 2.0, 8.0
"""Growth of a step from block to block at most, and of the cycles from pass to pass."""
ROOM = 0.7
"""Part of the tolerance that is meant for the scatter of starts."""


@dataclass(frozen=True)
class Problem:
    """What is asked of a life.

    Attributes
    ----------
    limits : tuple of Limit
    services : tuple of Service
        In the order of strokes.
    at_most : float
        Strokes.
    tolerance : float
        Part of the life.
    most_cycles : int
        Of all starts in a pass.
    """

    limits: tuple[Limit, ...]
    services: tuple[Service, ...]
    at_most: float
    tolerance: float
    max_cycles: int


@dataclass(frozen=True)
class Step:
    """The cycles that come next.

    Attributes
    ----------
    cycles : int
        Of each start.
    share : float
        Strokes that each stands for.
    extra : ndarray, shape (joints, 2, m), or 0
        Depth that each takes off besides, m; below zero where wear slows down.
    """

    cycles: int
    share: float
    extra: Array | float = 0.0


@dataclass(frozen=True)
class Pass:
    """One pass over a life.

    Attributes
    ----------
    change : float
        Part of the clearance that a cycle takes off.
    block : int
        Cycles in a block.
    blocks : tuple of Block
        So far; the first stands for as many strokes as it has cycles: what is new.
    """

    change: float = FIRST_CHANGE
    block: int = LEAST_BLOCK
    blocks: tuple[Block, ...] = ()


class Chains(Protocol):
    """Starts whose surfaces wear as they run: those of a scene, or made-up ones of a test."""

    def go(self, number: int, before: Blocks, step: Step) -> Block:
        """Go on by a step in a pass of a number, behind some blocks."""

    def serve(self, number: int, before: Blocks, service: Service) -> Block:
        """See to a bush: a block without cycles, the surfaces as they are then."""


def next_step(problem: Problem, own: Pass) -> Step | Service | None:
    """What a pass needs next; None where it is over."""
    blocks = own.blocks
    if not blocks:
        return Step(LEAST_BLOCK, 1.0)
    last, served = blocks[-1], blocks[-1].span
    if last.gone or last.strokes >= problem.at_most:
        return None
    if len(blocks) > SURELY and first_passed(blocks, problem.limits) == 0.0:
        return None
    run = chains_of(blocks) * sum(block.cycles for block in blocks)
    if run >= 2 * problem.max_cycles or is_beyond(blocks, problem.limits):
        return None
    is_served = served == len(problem.services)
    until = problem.at_most if is_served else problem.services[served].strokes
    if last.strokes >= until:
        return problem.services[served]
    if not last.cycles:
        # Behind a service the rate is that of the bush before it: what is new is looked at first.
        return Step(LEAST_BLOCK, 1.0)
    ran = [block for block in blocks if block.cycles and block.span == served]
    rate = sum(block.rate for block in ran[-2:]) / len(ran[-2:])
    share = own.change / rate if rate > 0.0 else math.inf
    if len(ran) > 1:
        share = min(share, FASTER * (last.strokes - blocks[-2].strokes) / last.cycles)
    return Step(own.block, min(share, (until - last.strokes) / own.block), _extra(ran, own.block))


def _extra(ran: Blocks, cycles: int) -> Array | float:
    """Depth by which the last block fell short of the trapezoidal rule, for each of some cycles.

    Each cycle has stood for strokes that come behind it, at the rate of its own surfaces: the sum
    lacks half a cycle's change of the rate for each of its cycles.  All chains are given the mean:
    the sum over a life is half of the change from new, and no chance adds up in it.
    """
    if len(ran) < 2:
        return 0.0
    before, last = ran[-2:]
    # What is new was seen where the next block began.
    way = 0.5 * (last.cycles + (before.cycles if len(ran) > 2 else 0))
    share = (last.strokes - before.strokes) / last.cycles
    whole: Array = 0.5 * share * last.cycles / way * (last.taken - before.taken)
    return whole / cycles


def next_pass(problem: Problem, passes: Sequence[Pass]) -> Pass | None:
    """The next pass over a life; None where it is known, or as far as it may be.

    InputError where a limit is exceeded when new.
    """
    if not passes:
        return Pass()
    last = passes[-1]
    known = known_by(problem, passes)
    if known.strokes == 0.0:
        limits = (own for own in problem.limits if not passed(last.blocks, own))
        raise InputError(exceeded(next(limits), last.blocks))
    if len(passes) > 1 and (known.error <= problem.tolerance or not math.isfinite(known.strokes)):
        return None
    run = cycles_until(last.blocks, min(known.strokes, last.blocks[-1].strokes))
    more = FASTER
    if math.isfinite(known.sampling):
        more = min(max((known.sampling / (ROOM * problem.tolerance)) ** 2, more), MOST_MORE)
    wanted = max(more * run, FEWEST_CYCLES)
    if len(passes) > 1 and wanted * chains_of(last.blocks) > problem.max_cycles:
        return None
    return Pass(
        last.change * max(run, 1.0) / wanted, max(round(LONGER * math.sqrt(wanted)), LEAST_BLOCK)
    )


@dataclass(frozen=True)
class Known:
    """A life, as far as it is known.

    Attributes
    ----------
    strokes : float
        Infinite: no limit was passed as far as the chains went.
    sampling, step : float
        Half width over the starts, and error of the steps, of its logarithm.
    """

    strokes: float
    sampling: float
    step: float

    @property
    def error(self) -> float:
        """Both, as the root of the sum of squares."""
        return math.hypot(self.sampling, self.step)


def known_by(
    problem: Problem, passes: Sequence[Pass], limits: Sequence[Limit] | None = None
) -> Known:
    """The life by some passes; with other limits, when the first of those is passed."""
    limits = problem.limits if limits is None else limits
    end, blocks = first_passed(passes[-1].blocks, limits), passes[-1].blocks
    return Known(end, sampling_error(blocks, limits), _step_error(passes, limits))


def _step_error(passes: Sequence[Pass], limits: Sequence[Limit]) -> float:
    """Error of the steps of the last pass, part of the life; infinite where none tells it.

    It goes as one over the cycles, or faster: by each pass in steps so much coarser, that of the
    last one is their distance over the ratio of the cycles less one.  The largest is taken.  Chance
    is in it as well, and counts for little, the farther the passes are apart.
    """
    ends = [first_passed(own.blocks, limits) for own in passes]
    runs = [
        cycles_until(own.blocks, end) if 0.0 < end < math.inf else math.inf
        for own, end in zip(passes, ends, strict=True)
    ]
    return max(
        (
            abs(math.log(ends[-1] / end)) / (runs[-1] / run - 1.0)
            for end, run in zip(ends[:-1], runs[:-1], strict=True)
            if runs[-1] < math.inf and 0.0 < COARSER * run <= runs[-1]
        ),
        default=math.inf,
    )


def exceeded(limit: Limit, blocks: Blocks) -> str:
    """Say by what a limit is exceeded when new."""
    value = float(curve(blocks, limit.key)[0])
    return (
        f"until = '{limit.key} > {limit.value:.4g} {limit.unit}': it is exceeded when new, where "
        f"{limit.key} is {value:.4g} {limit.unit}"
    )


def is_exceeded(limit: Limit, new: Block) -> bool:
    """True where all of the interval of what is new lies above a limit."""
    each = np.array([curve([new], limit.key, np.array([k]))[0] for k in range(chains_of([new]))])
    return float(each.mean()) - (half_width(each) or 0.0) >= limit.value


def live(
    problem: Problem,
    chains: Chains,
    passes: Sequence[Pass] = (),
    keep: Callable[[tuple[Pass, ...]], None] = lambda passes: None,
) -> tuple[Pass, ...]:
    """Run passes over a life until it is known.

    Parameters
    ----------
    passes : sequence of Pass
        Those that have run, the last perhaps in part.
    keep : callable
        Told of them after each block.

    Raises
    ------
    InputError
        Where a limit is exceeded when new.
    """
    done = list(passes)
    if not done:
        done.append(Pass())
    while True:
        own = done[-1]
        step = next_step(problem, own)
        if step is None:
            another = next_pass(problem, done)
            if another is None:
                return tuple(done)
            done.append(another)
            continue
        number = len(done)
        block = (
            chains.serve(number, own.blocks, step)
            if isinstance(step, Service)
            else chains.go(number, own.blocks, step)
        )
        done[-1] = Pass(own.change, own.block, (*own.blocks, block))
        if not own.blocks:
            for limit in problem.limits:
                if is_exceeded(limit, block):
                    raise InputError(exceeded(limit, [block]))
        keep(tuple(done))
