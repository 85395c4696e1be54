"""Statistics of a chaotic motion by method: sampling error, step error, and when one hides
in the other.

The sampling error of a statistic falls with the root of the number of cycles; the step
error, its difference from the finest method's, does not.  A setting is honest as long as
the largest step error that the cycles allow is below the sampling error: it is an
equivalence that has to be shown, so few cycles make nothing honest.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from presswear.linkage.linkage import Linkage
from presswear.recording.recorder import Recorder
from presswear.recording.sampling import (
    LEVEL,
    Estimate,
    MapBatches,
    basic_interval,
    map_batches,
    map_errors,
    mean_map,
    pooled,
    resampled,
)

Array = NDArray[np.float64]
Names = Mapping[str, tuple[str, int]]
"""Kind and joint of each statistic by its name."""

DOSE, MAP, FORCE = "wear total", "wear map", "peak force"
COLUMNS = {DOSE: "load_distance", FORCE: "force_max"}
"""Names of statistics in a recorder's cycles."""
FOR_WEAR = (DOSE, MAP)
"""The statistics that a setting has to have right to be honest for wear."""
_NORMAL = float(norm.ppf(0.5 + 0.5 * LEVEL))
ONE_SIDED = float(norm.ppf(LEVEL)) / _NORMAL
"""Part of a two-sided interval's half width that a one-sided one has."""


def sampling_error(statistic: Estimate, cycles: float) -> float:
    """Sampling error of so many cycles; infinite where nothing is known of it."""
    if statistic.half_width is None:
        return math.inf
    return statistic.half_width * math.sqrt(statistic.cycles / cycles)


@dataclass(frozen=True)
class StepError:
    """Difference of a statistic from the finest method's.

    Attributes
    ----------
    value : float or None
        Signed; for a map the root mean square distance over angles, of which what the
        scatter of both explains is taken off.  None where nothing is known of it.
    low, high : float or None
        Ends of its interval, 95 % for all statistics of a method together: one of many
        that is seen by chance is no finding.
    bound : float or None
        Size that it does not exceed, at 95 %; None where the cycles are too few.  It holds
        for one statistic: a method is honest only where each is, which chance does not help.
    """

    value: float | None
    low: float | None
    high: float | None
    bound: float | None

    @property
    def is_seen(self) -> bool:
        """True where it is certainly not zero."""
        return self.low is not None and self.high is not None and not self.low <= 0.0 <= self.high


@dataclass(frozen=True)
class Draws:
    """Numbers that the runs of one method give, one entry a start.

    Attributes
    ----------
    cycles : tuple of mapping of str to ndarray, shape (cycles,)
        Numbers of each cycle by the names of their statistics.
    """

    cycles: tuple[Mapping[str, Array], ...]
    maps: tuple[MapBatches, ...]

    def and_of(self, recorder: Recorder, names: Names) -> "Draws":
        """These and what a recorder holds."""
        numbers = {
            name: recorder.each_cycle(COLUMNS[kind], k).copy()
            for name, (kind, k) in names.items()
            if kind != MAP
        }
        return Draws((*self.cycles, numbers), (*self.maps, recorder.maps))


def names_of(linkage: Linkage) -> Names:
    """Kind and joint of each statistic by its name."""
    return {
        f"{kind} at {joint.name}": (kind, k)
        for kind in (DOSE, MAP, FORCE)
        for k, joint in enumerate(linkage.clearances)
    }


UNITS = {DOSE: "N m", MAP: "m", FORCE: "N"}
"""Unit of each kind, in a cycle."""


def is_for_wear(name: str) -> bool:
    """True where a statistic counts for wear."""
    return name.startswith(FOR_WEAR)


def statistics_of(names: Names, draws: Draws) -> dict[str, Estimate]:
    """All statistics of a method."""
    found = {}
    for name, (kind, k) in names.items():
        if kind == MAP:
            found[name] = map_statistic(draws.maps, k)
        else:
            found[name], _ = pooled([numbers[name] for numbers in draws.cycles])
    return found


def map_statistic(maps: Sequence[MapBatches], k: int) -> Estimate:
    """Mean map of joint ``k`` and the half width of its 95 % interval, as root mean squares, m."""
    size = _rms(mean_map(maps)[k])
    error = float(map_errors(*map_batches(maps))[k])
    cycles = sum(run.samples for run in maps)
    return Estimate(size, _NORMAL * error * size if math.isfinite(error) else None, cycles)


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))


def together(count: int) -> float:
    """Factor on a 95 % interval with which ``count`` of them hold together (Bonferroni)."""
    return float(norm.ppf(1.0 - 0.5 * (1.0 - LEVEL) / count)) / _NORMAL


def step_errors(names: Names, draws: Draws, finest: Draws) -> dict[str, StepError]:
    """Difference of each statistic from the finest method's."""
    here, there = statistics_of(names, draws), statistics_of(names, finest)
    widening = together(len(names))
    found = {}
    for name, (kind, k) in names.items():
        if kind == MAP:
            found[name] = map_step_error(draws.maps, finest.maps, k, widening)
        else:
            found[name] = mean_step_error(here[name], there[name], widening)
    return found


def mean_step_error(here: Estimate, there: Estimate, widening: float) -> StepError:
    """Difference of two independent means."""
    value = here.mean - there.mean
    if here.half_width is None or there.half_width is None:
        return StepError(value, None, None, None)
    half = math.hypot(here.half_width, there.half_width)
    wide = widening * half
    return StepError(value, value - wide, value + wide, abs(value) + ONE_SIDED * half)


def map_step_error(
    here: Sequence[MapBatches], there: Sequence[MapBatches], k: int, widening: float
) -> StepError:
    """Distance of two mean maps, m.

    Even of two equal methods the maps are apart, by what the scatter of both makes; the
    squared distance less that is without bias.  Its interval is from bootstrap draws of
    both maps.
    """
    pools = []
    for runs in (here, there):
        batches, weights = map_batches(runs)
        own = batches[:, k].reshape(len(batches), -1)
        pools.append((own, weights, map_errors(batches, weights)[k]))
    if not all(math.isfinite(error) for _, _, error in pools):
        return StepError(None, None, None, None)
    means = [np.tensordot(w / w.sum(), m, 1) for m, w, _ in pools]
    noise = sum((e * _rms(m)) ** 2 for (_, _, e), m in zip(pools, means, strict=True))
    raw = float(np.mean((means[0] - means[1]) ** 2))
    drawn = [resampled(m, w, seed) for seed, (m, w, _) in enumerate(pools, 1)]
    # Of the draws the distance is known to be the raw one: what they add to it is scatter.
    draws = np.mean((drawn[0] - drawn[1]) ** 2, axis=1) - 2.0 * noise
    interval = basic_interval(raw - noise, draws, min(len(m) for m, _, _ in pools))
    assert interval.low is not None
    assert interval.high is not None
    value, up, down = interval.value, interval.high - interval.value, interval.low - interval.value
    squares = (value, value + widening * down, value + widening * up, value + ONE_SIDED * up)
    return StepError(*(math.sqrt(max(square, 0.0)) for square in squares))


def honest_cycles(statistic: Estimate, step: StepError) -> float:
    """Cycles of a run up to which the largest step error allowed is below the sampling error.

    nan where nothing is known.
    """
    if statistic.half_width is None or step.bound is None:
        return math.nan
    if step.bound == 0.0:
        return math.inf
    return statistic.cycles * (statistic.half_width / step.bound) ** 2
