"""Service life as results store it."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswear.campaign.life_estimate import (
    LifeEstimate,
    estimate_life,
    finite,
    scatter_of,
)
from presswear.campaign.refinement import LoadBlock, Refinement, Refinements
from presswear.campaign.service_life import LifeProblem
from presswear.results.life import Ended, LifeResult, LimitResult, RefinementResult
from presswear.scene.options import Limit
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.numbers import large, percent

STEADY_RATE = 0.03  # change of a wear rate, relative, that its scatter may explain


def preliminary_life(
    scene: Scene, problem: LifeProblem, refinements: Refinements
) -> LifeResult:
    """Return the life of the finished refinements while another refinement runs."""
    life = life_result(scene, problem, refinements)
    error = "has an unknown error"
    if life.error is not None:
        error = f"has an error of {100.0 * life.error:.2g} %"
    elif life.sampling is not None:
        sampling = f"{100.0 * life.sampling:.2g} % by the scatter of the motion"
        error = f"has an error of {sampling}, and an unknown error of the wear steps"
    count = len(refinements)
    message = (
        f"refinement {count} is finished and {error}; refinement {count + 1} runs next"
    )
    return replace(life, ended="preliminary", message=message)


def life_by_rate(
    scene: Scene, problem: LifeProblem, refinements: Refinements
) -> LifeResult | None:
    """Return the life by the wear rate of the last load block, without an error.

    None if that block begins a service interval, or if no limited quantity of the surfaces
    grows.
    """
    blocks = refinements[-1].blocks
    before, last = blocks[-2:]
    life = life_result(scene, problem, refinements)
    limits = []
    for limit, limit_result in zip(problem.limits, life.limits, strict=True):
        strokes = _strokes_by_rate(limit, before, last)
        limits.append(replace(limit_result, strokes=strokes, sampling=None, step=None))
    reached = [limit.strokes for limit in limits if limit.strokes is not None]
    first = min(reached, default=math.inf)
    if first > problem.at_most:
        return None
    key = next(limit.key for limit in limits if limit.strokes == first)
    message = f"by the wear rate after {large(last.strokes, digits=2)} strokes, "
    message += f"{_change_of_rate(blocks, key)}; refinement {len(refinements)} runs"
    return replace(
        life,
        ended="preliminary",
        message=message,
        strokes=first,
        limits=tuple(limits),
    )


def _change_of_rate(blocks: Sequence[LoadBlock], key: str) -> str:
    """Return in words how the rate of a quantity has changed, and what it says about a life.

    Worn surfaces conform, so that most wear rates fall. A life by an early rate is then
    too short: a four-bar linkage lost 1.17 um in 10^6 strokes when new and 0.58 um after
    33 million strokes.
    """
    since = [block for block in blocks if block.interval == blocks[-1].interval]
    first = _rate_of(since[0], since[1], key)
    last = _rate_of(since[-2], since[-1], key)
    if len(since) == 2 or first <= 0.0:
        return "which mostly falls as surfaces run in: the life is then longer"
    change = last / first - 1.0
    if abs(change) < STEADY_RATE:
        return "which has not changed yet, with an unknown error"
    size = percent(abs(change), 2)
    if change < 0.0:
        return f"{size} lower than at first: while this rate falls, the life is longer"
    return f"{size} higher than at first: while this rate rises, the life is shorter"


def _rate_of(before: LoadBlock, after: LoadBlock, key: str) -> float:
    """Return the growth of the mean of a quantity per stroke between two blocks."""
    growth = float(after.levels[key].mean()) - float(before.levels[key].mean())
    return growth / (after.strokes - before.strokes)


def _strokes_by_rate(limit: Limit, before: LoadBlock, last: LoadBlock) -> float | None:
    """Return the strokes at which a quantity of the surfaces reaches its limit, linearly."""
    if limit.key not in last.levels or before.interval != last.interval:
        return None
    value = float(last.levels[limit.key].mean())
    growth = value - float(before.levels[limit.key].mean())
    if growth <= 0.0:
        return None
    strokes = last.strokes - before.strokes
    return last.strokes + strokes * (limit.value - value) / growth


def life_result(
    scene: Scene, problem: LifeProblem, refinements: Refinements
) -> LifeResult:
    """Return the life as results store it."""
    last = refinements[-1]
    end = last.blocks[-1]
    life = estimate_life(refinements, problem.limits)
    ended: Ended = "limit"
    message = ""
    if math.isinf(life.strokes):
        ended, message = _end_without_limit(problem, last)
    services = []
    for service in problem.services[: end.interval]:
        services.append(f"{service.words} after {service.strokes:.4g} strokes")
    return LifeResult(
        ended=ended,
        message=message,
        strokes=life.strokes if math.isfinite(life.strokes) else end.strokes,
        sampling=finite(life.sampling),
        step=finite(life.step),
        scatter=scatter_of(scene),
        limits=_limit_results(problem, refinements, life),
        refinements=_refinement_results(problem, refinements, life),
        services=tuple(services),
        curves=_curves(last),
        settled=tuple(block.settled for block in last.blocks if block.cycles),
    )


def _end_without_limit(problem: LifeProblem, last: Refinement) -> tuple[Ended, str]:
    """Return why a life ended although no limit was exceeded, and a message."""
    end = last.blocks[-1]
    if end.ended_by:
        return "worn", end.ended_by
    none = "no limit is exceeded within"
    if end.strokes >= problem.at_most:
        return "at_most", f"{none} {problem.at_most:.4g} strokes"
    return "cycles", f"{none} {last.cycles} cycles of all replicates"


def _limit_results(
    problem: LifeProblem, refinements: Refinements, life: LifeEstimate
) -> tuple[LimitResult, ...]:
    """Return the strokes at which each limit is exceeded, and the last value of its quantity."""
    last = refinements[-1]
    limits = []
    for limit in problem.limits:
        limit_life = estimate_life(refinements, [limit])
        if last.crossing([limit]) == last.crossing(problem.limits):
            # The same limit ends the life: all refinements count, also coarser ones
            # that another limit ended.
            limit_life = life
        value, half_width = last.band(limit.key)
        limits.append(
            LimitResult(
                key=limit.key,
                unit=limit.unit,
                value=limit.value,
                strokes=finite(limit_life.strokes),
                sampling=finite(limit_life.sampling),
                step=finite(limit_life.step),
                last=float(value[-1]),
                last_half_width=float(half_width[-1]),
            )
        )
    return tuple(limits)


def _refinement_results(
    problem: LifeProblem, refinements: Refinements, life: LifeEstimate
) -> tuple[RefinementResult, ...]:
    """Return the life of each refinement, and the deviations of its histories."""
    stored = []
    weights = life.weights or (0.0,) * len(refinements)
    for refinement, weight in zip(refinements, weights, strict=True):
        strokes = refinement.crossing(problem.limits)
        error = refinement.sampling_error(problem.limits)
        logarithms = refinement.logarithms(problem.limits)
        deviations = np.zeros(0)
        if weight > 0.0 and logarithms.size:
            deviations = weight * (logarithms - logarithms.mean())
        stored.append(
            RefinementResult(
                change=refinement.change,
                cycles=refinement.cycles,
                strokes=finite(strokes),
                sampling=finite(error),
                deviations=tuple(map(float, deviations)),
            )
        )
    return tuple(stored)


def _curves(last: Refinement) -> dict[str, Array]:
    """Return the curves of a refinement by key over its strokes.

    A row of a curve has mean, lower and upper limit.
    """
    curves = {"strokes": last.strokes}
    for key in (*last.blocks[0].levels, *last.blocks[0].samples):
        value, half_width = last.band(key)
        low = value - half_width
        high = value + half_width
        curves[key] = np.column_stack([value, low, high])
    return curves


def unknown_life(scene: Scene, life: LifeResult) -> list[str]:
    """Return a message if a life is less accurate than requested, or unknown."""
    if life.ended != "limit":
        return [f"the life is not known: {life.message}"]
    if life.error is not None and life.error <= scene.tolerance:
        return []
    fault = "is unknown"
    if life.error is not None:
        fault = f"is {100.0 * life.error:.2g} %, above tolerance = {100.0 * scene.tolerance:.2g} %"
    return [f"the error of the life {fault}: a larger life.max_cycles is needed"]
