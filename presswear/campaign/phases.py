"""Running-in, steady and accelerated wear, told apart by the volume that a stroke takes."""

import math
from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.crossing import Blocks, chains_of
from presswear.recording.statistics import half_width
from presswear.results.life import Phase

Array = NDArray[np.float64]

MOST_PHASES = 3
LEAST_CHANGE = 0.05
"""Part of a rate by which the next phase differs, at least: less is nothing to act upon."""
RUNNING_IN, STEADY, ACCELERATED = "running-in", "steady", "accelerated"


def phases_of(blocks: Blocks, joint: str) -> tuple[Phase, ...]:
    """The phases of a joint's wear.

    Rates that stay the same between a few changes are laid through those of the blocks: as many
    as the Bayesian information criterion grants, in which a change that may be anywhere counts
    twice (Zhang and Siegmund, Biometrics 63, 22, 2007).

    Parameters
    ----------
    joint : str
        Its name.
    """
    ran = [k for k, block in enumerate(blocks) if block.cycles and k > 0]
    if not ran:
        return ()
    volume = [block.levels[f"{joint}.wear_volume"] for block in blocks]
    strokes = [block.strokes for block in blocks]
    rates = np.array([(volume[k] - volume[k - 1]) / (strokes[k] - strokes[k - 1]) for k in ran])
    weights = np.array([float(blocks[k].cycles) for k in ran])
    edges = list(_edges(rates.mean(axis=1), weights))

    def means_of(edges: Sequence[int]) -> list[Array]:
        return [np.average(rates[a:b], axis=0, weights=weights[a:b]) for a, b in pairwise(edges)]

    means = means_of(edges)
    while off := [k for k, pair in enumerate(pairwise(means), 1) if not _differ(*pair)]:
        del edges[off[0]]
        means = means_of(edges)
    names = _names([float(own.mean()) for own in means])
    return tuple(
        Phase(
            joint,
            name,
            strokes[ran[a] - 1],
            strokes[ran[b - 1]],
            float(own.mean()),
            (half_width(own) or 0.0) if chains_of(blocks) > 1 else 0.0,
        )
        for name, own, (a, b) in zip(names, means, pairwise(edges), strict=True)
    )


def _differ(one: Array, other: Array) -> bool:
    """True where the rates of the chains in two phases are apart by more than chance or a trifle.

    The same chains ran in both: their differences are judged.
    """
    off = other - one
    least = LEAST_CHANGE * float(np.mean(one))
    return abs(float(off.mean())) > max(half_width(off) or 0.0, least)


def _edges(rates: Array, weights: Array) -> tuple[int, ...]:
    """Where phases begin, and the end of the last."""
    count = rates.size
    best = math.inf
    found: tuple[int, ...] = (0, count)
    for parts in range(1, min(MOST_PHASES, count // 2) + 1):
        for inner in combinations(range(1, count), parts - 1):
            edges = (0, *inner, count)
            rest = sum(_rest(rates[a:b], weights[a:b]) for a, b in pairwise(edges))
            rest = max(rest / float(weights.sum()), 1e-12 * float(np.mean(rates**2)))
            told = count * math.log(rest) + (3 * parts - 2) * math.log(count) if rest else -math.inf
            if told < best:
                best, found = told, edges
    return found


def _rest(rates: Array, weights: Array) -> float:
    mean = float(np.average(rates, weights=weights))
    return float(weights @ (rates - mean) ** 2)


def _names(rates: Sequence[float]) -> list[str]:
    """Names of phases: falling at first is running-in, rising in the end accelerated."""
    names = [STEADY] * len(rates)
    for k in range(len(rates) - 1):
        if rates[k] <= rates[k + 1]:
            break
        names[k] = RUNNING_IN
    for k in reversed(range(1, len(rates))):
        if rates[k] <= rates[k - 1] or names[k] != STEADY:
            break
        names[k] = ACCELERATED
    return names
