"""Cycles and time that the computation of a service life is expected to take."""

import math
from collections.abc import Mapping

import numpy as np

from presswear.campaign.life_estimate import MIN_REFINEMENT, estimate_life
from presswear.campaign.refinement import (
    FIRST_CHANGE,
    MARGIN,
    MIN_BLOCK,
    Refinement,
    Refinements,
)
from presswear.campaign.service_life import (
    MIN_CYCLES,
    SECOND_GROWTH,
    LifeProblem,
    finished_cycles,
    next_cycles,
)
from presswear.campaign.wear_update import STEP_SAFETY
from presswear.recording.statistics import STARTUP_CYCLES, half_width

# Expected distance of the lives of the first two refinements over the tolerance
FIRST_DISTANCE = 0.3
# Expected distance over the half width of the histories: after the first refinement the
# mean for equal distributions; during it, half of the lives then need more cycles.
FIRST_SCATTER = 0.4
EARLY_SCATTER = 0.7
# Growth of a quantity of the surfaces over the wear of one surface: a clearance grows by
# the wear of both, a diametral clearance by twice as much.
_SURFACES = {"depth": 1.0, "radial_clearance": 2.0, "diametral_clearance": 4.0}
# Time of a cycle at the end of a life over the time when new, because steps on worn
# surfaces are shorter: 1.3 to 7.5 in six lives of presses, means 1.3 to 5.4 (median 1.85)
WORN_TIME = 2.5
MIN_TIMED_BLOCKS = 2  # kernels are compiled in the first one


def fewest_cycles(problem: LifeProblem, clearances: Mapping[str, float]) -> float:
    """Return the least number of cycles of each history in two refinements, before a run.

    A cycle of the first refinement wears no joint by more than FIRST_CHANGE of its
    clearance, so that a limit on a depth takes some cycles. The second refinement has at
    least twice as many. ``clearances`` are those of the new joints by name, m.
    """
    cycles_to_limits = []
    for limit in problem.limits:
        if limit.name not in _SURFACES:
            cycles_to_limits.append(0.0)
            continue
        per_cycle = FIRST_CHANGE * clearances[limit.joint]
        growth = limit.value - limit.new
        cycles_to_limits.append(growth / (_SURFACES[limit.name] * per_cycle))
    first = max(min(cycles_to_limits), MIN_BLOCK)
    second = max(SECOND_GROWTH * first, MIN_CYCLES)
    return 2 * (STARTUP_CYCLES + MIN_BLOCK) + first + second


def cycles_left(problem: LifeProblem, refinements: Refinements) -> float:
    """Return the cycles of each history that are expected until the computation ends.

    Further refinements follow by the rule of ``next_refinement``. The sampling error is
    proportional to 1 / sqrt(cycles of all refinements); in the first refinement it
    follows from the depths worn so far. The error of the step is proportional to the
    step, 1 / cycles of a refinement; its factor follows from the difference of the lives
    of the first and the last refinement.
    """
    *coarser, last = refinements
    limits = problem.limits
    ends = finished_cycles(coarser, limits)
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
    scatter = FIRST_SCATTER if coarser else EARLY_SCATTER
    distance = max(FIRST_DISTANCE * problem.tolerance, scatter * sampling)
    if coarser:
        lives = coarser[0].crossing(limits), coarser[-1].crossing(limits)
        change = abs(math.log(lives[0] / lives[1]))
        if 0.0 < change < math.inf:
            distance = change
    while True:
        sampling *= math.sqrt(pooled / sum(ends))
        pooled = sum(ends)
        ratio = max(ends[-1] / ends[0], MIN_REFINEMENT)
        slope = distance * ends[0] * ratio / (ratio - 1.0)
        step = STEP_SAFETY * slope * len(ends) / pooled
        cycles = next_cycles(problem, sampling, ends)
        is_accurate = math.hypot(sampling, step) <= problem.tolerance
        is_too_long = cycles * histories > problem.max_cycles
        if len(ends) > 1 and (is_accurate or is_too_long):
            return left
        left += STARTUP_CYCLES + MIN_BLOCK + cycles
        ends.append(cycles)


def time_per_cycle(problem: LifeProblem, refinements: Refinements) -> float:
    """Return the expected mean time of the later cycles of each history, s.

    It is the mean of the last finished refinement. In the first refinement it follows
    from the last block: the time is assumed to grow by WORN_TIME, linearly over the
    life.
    """
    *coarser, last = refinements
    if coarser:
        return _mean_time(coarser[-1:])
    timed = [block for block in last.blocks if block.cycles]
    completed = sum(block.cycles for block in timed[1:])
    left = _left_in_last(problem, refinements, completed)
    share = completed / max(completed + left, 1.0)
    mean = 0.5 * (1.0 + WORN_TIME)
    present = 1.0 + (WORN_TIME - 1.0) * share
    return mean / present * timed[-1].wall_s / timed[-1].cycles


def relative_time(problem: LifeProblem, refinements: Refinements) -> float:
    """Return the expected time of a later cycle over the mean time of the cycles so far."""
    if sum(len(refinement.blocks) for refinement in refinements) < MIN_TIMED_BLOCKS:
        return 1.0
    return time_per_cycle(problem, refinements) / _mean_time(refinements)


def _mean_time(refinements: Refinements) -> float:
    """Return the mean time of the cycles of each history, s, with those of the start-up."""
    cycles = 0
    seconds = 0.0
    for refinement in refinements:
        if refinement.blocks:
            cycles += STARTUP_CYCLES
        for block in refinement.blocks:
            if block.cycles:
                cycles += block.cycles
                seconds += block.wall_s
    return seconds / cycles


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
    half_widths = []
    for limit in problem.limits:
        if limit.key not in levels:
            continue
        depth = levels[limit.key] - limit.new
        if np.all(depth > 0.0):
            half_widths.append(half_width(np.log(depth)) or 0.0)
    if not half_widths:
        return problem.tolerance
    share = min(completed / cycles, 1.0)
    return min(half_widths) * math.sqrt(share)


def _left_in_last(
    problem: LifeProblem, refinements: Refinements, completed: int
) -> float:
    """Return the cycles of each history that the last refinement lacks up to the life.

    The wear per cycle is assumed to be constant. For a limit on a quantity of the
    surfaces the lacking cycles follow from the present value, for a limit on a quantity
    of a stroke from the share of the life in the refinement before.
    """
    *coarser, last = refinements
    blocks = last.blocks
    limits = problem.limits
    remaining = []  # expected cycles up to each limit
    expected = float(MIN_CYCLES)  # cycles of the refinement
    if coarser:
        before = coarser[-1]
        life = before.crossing(limits)
        finished = finished_cycles(coarser, limits)
        sampling = estimate_life(coarser, limits).sampling
        expected = next_cycles(problem, sampling, finished)
    if not blocks:
        return expected
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
                remaining.append(float(limit.value - values[-1]) / per_cycle)
        elif coarser and before.crossing([limit]) == life:
            completed_share = before.cycles_until(strokes) / max(finished[-1], 1.0)
            remaining.append((1.0 + MARGIN) * expected * (1.0 - completed_share))
    if completed and strokes > blocks[-2].strokes:
        strokes_per_cycle = (strokes - blocks[-2].strokes) / blocks[-1].cycles
        remaining.append((problem.at_most - strokes) / strokes_per_cycle)
    return max(min(remaining, default=expected - completed), 0.0)
