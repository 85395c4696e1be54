"""Cycles that the computation of a service life is expected to take."""

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

# Expected distance of the lives of the first two refinements: a part of the tolerance,
# or of the half width over the histories. With one life known it is the mean for equal
# distributions; before, that with which half of the lives need more cycles.
FIRST_DISTANCE = 0.3
FIRST_SCATTER = 0.4
EARLY_SCATTER = 0.7


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
    part = FIRST_SCATTER if coarser else EARLY_SCATTER
    distance = max(FIRST_DISTANCE * problem.tolerance, part * sampling)
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
        cycles = next_cycles(problem, sampling, ends)
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

    They are assumed to be spread evenly over the depth that wears off. The completed
    part follows from the limit on a quantity of the surfaces, or from the refinement
    before for a quantity of a stroke.
    """
    *coarser, last = refinements
    blocks = last.blocks
    limits = problem.limits
    lefts = []
    whole = float(MIN_CYCLES)
    if coarser:
        before = coarser[-1]
        life = coarser[-1].crossing(limits)
        each = finished_cycles(coarser, limits)
        finished = each[-1]
        whole = next_cycles(problem, estimate_life(coarser, limits).sampling, each)
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
