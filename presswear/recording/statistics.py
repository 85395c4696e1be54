"""Cycles as samples of a chaotic motion: means, wear maps and peaks with their intervals.

Beyond some twenty impacts the motion is chaotic and one run is one draw.  Cycles behind the
start-up are the samples: in the first the pins fall on their bearings all at once, and the second
knocks less than any later one (of a hundred starts of the paper's scene the mean peak forces at A
are 271, 82, 120, 131, 118 N).  Where there are many they are put together in batches of
neighbours, so that what one cycle hands on to the next is counted once: the method of batch
means (Law and Kelton, Simulation Modeling and Analysis, section 9.5.3).  Estimates are of
95 %.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from presswear.tools.arrays import State

Array = NDArray[np.float64]

STARTUP_CYCLES = 2
"""Cycles at the start that are no samples; where no more ran, the last of them is the only one."""
LEAST_SAMPLES = 3
MOST_BATCHES = 32
"""When there would be more batches, neighbours become one."""
LEVEL = 0.95
RANGE_STROKES = 10
"""Successive strokes over which the range of something is told."""
RESAMPLES = 1000
"""Draws of a bootstrap: an end of an interval scatters by about 5 % of its width."""


@final
@dataclass(frozen=True)
class Estimate:
    """Number with its 95 % confidence interval.

    Attributes
    ----------
    mean : float
    low, high : float or None
        Ends of the interval; None: too few samples.
    samples : int
        Cycles, batches of cycles or replicates behind it.
    """

    mean: float
    low: float | None = None
    high: float | None = None
    samples: int = 0

    @staticmethod
    def symmetric(mean: float, half_width: float | None, samples: int = 0) -> "Estimate":
        """Return an estimate whose interval reaches as far to both sides."""
        if half_width is None:
            return Estimate(mean, samples=samples)
        return Estimate(mean, mean - half_width, mean + half_width, samples)

    @property
    def half_width(self) -> float | None:
        """Half the length of the interval; None: too few samples."""
        if self.low is None or self.high is None:
            return None
        return 0.5 * (self.high - self.low)

    def scaled(self, factor: float) -> "Estimate":
        """Return the estimate in another unit; the factor is positive."""
        low, high = (None if end is None else factor * end for end in (self.low, self.high))
        return Estimate(factor * self.mean, low, high, self.samples)


def after_startup(rows: Array) -> Array:
    """The rows, one a cycle, that are samples."""
    return rows[max(min(STARTUP_CYCLES, len(rows) - 1), 0) :]


def batched(samples: Array) -> Array:
    """Means of at most MOST_BATCHES batches of equal size, shape (batches, ...).

    What does not fill a batch is left out, at the start.
    """
    size = -(-len(samples) // MOST_BATCHES)
    if size <= 1:
        return samples
    count = len(samples) // size
    whole = samples[len(samples) - count * size :]
    return np.asarray(whole.reshape(count, size, *samples.shape[1:]).mean(axis=1))


def half_width(samples: Array) -> float | None:
    """Half width of Student's interval of a mean; None for fewer than two samples."""
    count = len(samples)
    if count < 2:
        return None
    spread = float(samples.std(ddof=1)) / math.sqrt(count)
    return quantile(count - 1) * spread


def quantile(freedom: float) -> float:
    """Student's quantile at the upper end of an interval; of the normal distribution at inf."""
    # Slow to import, and the whole of scipy.stats three times as slow.
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * LEVEL))


def estimate(rows: Array) -> Estimate:
    """Mean and interval of one number a cycle, shape (cycles,), start-up included."""
    samples = after_startup(rows)
    mean = float(samples.mean()) if samples.size else math.nan
    return Estimate.symmetric(mean, half_width(batched(samples)), samples.size)


def _no_maps() -> Array:
    return np.zeros(0)


@dataclass
class MapBatches:
    """Wear maps of a run, summed over batches of neighbouring cycles.

    Memory does not grow with the number of cycles.

    Attributes
    ----------
    shape : tuple of int
        (joints, 2, m).
    cycles : int
        Cycles filed, start-up included.
    size : int
        Cycles in a full batch.
    """

    shape: tuple[int, ...]
    cycles: int = 0
    size: int = 1
    _last: Array = field(default_factory=_no_maps)
    _sums: Array = field(default_factory=_no_maps)

    def __post_init__(self) -> None:
        self._last = np.zeros(self.shape)
        self._sums = np.zeros((MOST_BATCHES, *self.shape))

    def add(self, depth: Array) -> None:
        """File the depth that one cycle added, m."""
        self.cycles += 1
        if self.cycles <= STARTUP_CYCLES:
            self._last[...] = depth
            return
        behind = self.cycles - STARTUP_CYCLES - 1
        if behind == MOST_BATCHES * self.size:
            half = MOST_BATCHES // 2
            self._sums[:half] = self._sums[0::2] + self._sums[1::2]
            self._sums[half:] = 0.0
            self.size *= 2
        self._sums[behind // self.size] += depth

    @property
    def samples(self) -> int:
        """Cycles that are samples."""
        return max(self.cycles - STARTUP_CYCLES, min(self.cycles, 1))

    @property
    def sampled(self) -> Array:
        """Depth of the samples, m."""
        return np.asarray(self._sums.sum(axis=0)) if self.cycles > STARTUP_CYCLES else self._last

    @staticmethod
    def stored(state: State) -> "MapBatches":
        """The maps of a state."""
        maps = MapBatches(state["last"].shape)
        maps.restore(state)
        return maps

    def state(self) -> dict[str, NDArray[Any]]:
        """All that changes, copied."""
        return {
            "filed": np.array([self.cycles, self.size]),
            "last": self._last.copy(),
            "sums": self._sums.copy(),
        }

    def restore(self, stored: State) -> None:
        """Go on from a state of maps of the same shape."""
        self.cycles, self.size = (int(number) for number in stored["filed"])
        self._last[...] = stored["last"]
        self._sums[...] = stored["sums"]

    def batches(self) -> Array:
        """Mean depth per cycle in each full batch, shape (batches, joints, 2, m), m."""
        count = max(self.cycles - STARTUP_CYCLES, 0) // self.size
        return np.asarray(self._sums[:count] / self.size)


def mean_map(runs: Sequence[MapBatches]) -> Array:
    """Mean depth of a sample, m."""
    depth = np.sum([run.sampled for run in runs], axis=0)
    return np.asarray(depth / max(sum(run.samples for run in runs), 1))


def map_batches(runs: Sequence[MapBatches]) -> tuple[Array, Array]:
    """Batches of all runs, shape (n, joints, 2, m), m, and the cycles in each, (n,)."""
    maps = np.concatenate([run.batches() for run in runs])
    weights = np.concatenate([np.full(len(run.batches()), float(run.size)) for run in runs])
    return maps, weights


def map_errors(maps: Array, weights: Array) -> Array:
    """Standard error of each joint's mean map as part of its rms, shape (joints,).

    Infinite where there are too few samples.

    Parameters
    ----------
    maps : ndarray, shape (n, joints, 2, m)
        By batches.
    weights : ndarray, shape (n,)
        Cycles in each; the variance of a batch goes as one over them.
    """
    if len(maps) < LEAST_SAMPLES:
        return np.full(maps.shape[1], math.inf)
    share = weights / weights.sum()
    mean = np.tensordot(share, maps, 1)
    variance = np.tensordot(share, (maps - mean) ** 2, 1) / (len(maps) - 1)
    size, noise = (np.sum(part, axis=(1, 2)) for part in (mean**2, variance))
    return np.where(size > 0.0, np.sqrt(noise / np.where(size > 0.0, size, 1.0)), 0.0)


@dataclass(frozen=True)
class Peak:
    """The deepest place of a wear map: depth, m, and angle, rad.

    The ends of the angle's interval are continuous with the angle itself: they may lie below
    0 or above 2 pi.
    """

    depth: Estimate
    angle: Estimate


def widened(estimate: Estimate, error: float) -> Estimate:
    """Return an estimate with an independent error added to its interval, root of sum of squares.

    Parameters
    ----------
    error : float
        In the estimate's unit.
    """
    if estimate.low is None or estimate.high is None:
        return estimate
    below, above = estimate.mean - estimate.low, estimate.high - estimate.mean
    return replace(
        estimate,
        low=estimate.mean - math.copysign(math.hypot(below, error), below),
        high=estimate.mean + math.copysign(math.hypot(above, error), above),
    )


def about(mean: float, estimate: Estimate) -> Estimate:
    """Return an estimate moved to another mean and widened by the distance."""
    off = mean - estimate.mean
    if estimate.low is None or estimate.high is None:
        return replace(estimate, mean=mean)
    moved = Estimate(mean, estimate.low + off, estimate.high + off, estimate.samples)
    return widened(moved, off)


def resampled(maps: Array, weights: Array, seed: int = 1) -> Array:
    """Bootstrap of a weighted mean over maps, shape (RESAMPLES, m); a seed gives its draws.

    Parameters
    ----------
    maps : ndarray, shape (n, m)
    weights : ndarray, shape (n,)
        Cycles in each.
    """
    count = len(maps)
    generator = np.random.default_rng(seed)
    picked = generator.multinomial(count, np.full(count, 1.0 / count), RESAMPLES) * weights
    return np.asarray(picked @ maps / picked.sum(axis=1, keepdims=True))


def basic_interval(value: float, draws: Array, count: int) -> Estimate:
    """Estimate of a statistic from what it is in bootstrap draws, shape (RESAMPLES,).

    What is biased by noise, such as the deepest of many bins, is biased again by as much in
    the draws: the interval is turned about the estimate ("basic" bootstrap, Davison and
    Hinkley, Bootstrap Methods and their Application, section 2.4).  It is widened as
    Student's is.

    Parameters
    ----------
    count : int
        Samples that the draws are from.
    """
    if count < LEAST_SAMPLES:
        return Estimate(value, samples=count)
    ends = value - _widening(count) * (np.quantile(draws, _ENDS[::-1]) - value)
    return Estimate(value, float(ends[0]), float(ends[1]), count)


_ENDS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)


def _widening(count: int) -> float:
    """Student's quantile over that of the normal distribution, and the bias of a spread."""
    return quantile(count - 1) / quantile(math.inf) * math.sqrt(count / (count - 1))


def turned_interval(place: int, places: NDArray[np.int64], bins: int, count: int) -> Estimate:
    """Estimate of the angle, rad, of a bin from where it is in bootstrap draws."""
    angle = 2.0 * math.pi * (place + 0.5) / bins
    if count < LEAST_SAMPLES:
        return Estimate(angle, samples=count)
    moved = (places - place + bins // 2) % bins - bins // 2
    left, right = _widening(count) * np.quantile(moved, _ENDS)
    # No place is known better than its bin.
    width = 2.0 * math.pi / bins
    low, high = angle + width * min(float(left), -0.5), angle + width * max(float(right), 0.5)
    return Estimate(angle, low, high, count)


def pointwise_interval(mean: Array, draws: Array, count: int) -> tuple[Array, Array]:
    """Ends of the interval of each place of a mean map from its draws.

    Parameters
    ----------
    mean : ndarray, shape (m,)
    draws : ndarray, shape (RESAMPLES, m)
    count : int
        Maps that the draws are from; of one the ends are the mean.
    """
    if count < 2:
        return mean, mean
    low, high = mean + _widening(count) * (np.quantile(draws, _ENDS, axis=0) - mean)
    return low, high


def peak_of(mean: Array, draws: Array, count: int, centre: Array | None = None) -> Peak:
    """The deepest place of a mean wear map.

    Parameters
    ----------
    mean : ndarray, shape (m,)
        Depth at the bin centres, m.
    draws : ndarray, shape (RESAMPLES, m)
        Of ``resampled``.
    count : int
        Maps that the draws are from.
    centre : ndarray, shape (m,) or None
        The mean of those maps, where it is another, m.
    """
    place = int(mean.argmax())
    deepest = float((mean if centre is None else centre).max())
    depth = about(float(mean[place]), basic_interval(deepest, draws.max(axis=1), count))
    if depth.low is not None:
        depth = replace(depth, low=max(depth.low, 0.0))
    return Peak(depth, turned_interval(place, draws.argmax(axis=1), mean.size, count))


def pooled(runs: Sequence[Array], alone: Sequence[Array] = ()) -> tuple[Estimate, bool]:
    """Mean over the cycles of several runs, start-up left out, and whether the runs differ.

    Runs whose means differ by more than their cycles explain (one-way analysis of variance,
    1 %) are single samples themselves: their interval is that of the runs.

    Parameters
    ----------
    runs : sequence of ndarray, shape (cycles,)
    alone : sequence of ndarray
        The same of runs that are known to be single samples, such as those on surfaces of their
        own: their scatter, and how far their mean is from this one, give the interval.
    """
    samples = [after_startup(rows) for rows in runs]
    everything = np.concatenate(samples)
    mean = float(everything.mean()) if everything.size else math.nan
    if len(alone) > 1:
        means = np.array([after_startup(rows).mean() for rows in alone])
        half = math.hypot(half_width(means) or 0.0, mean - float(means.mean()))
        return Estimate.symmetric(mean, half, everything.size), True
    apart = differ(samples)
    half_within = half_width(_parts(samples, apart))
    return Estimate.symmetric(mean, half_within, everything.size), apart


def _parts(samples: Sequence[Array], apart: bool) -> Array:
    """Independent parts of several runs: their batches, or their means where they differ."""
    return np.concatenate(
        [some.mean(keepdims=True) if apart else batched(some) for some in samples]
    )


def spread(runs: Sequence[Array]) -> Estimate | None:
    """Standard deviation of cycles about the mean of their own run; None where none is left.

    Runs may have surfaces of their own: how far their means are apart is no matter of how one
    repeats itself.  The interval is Student's of the logarithm of the variance by the jackknife
    over batches of neighbours (Miller, The jackknife - a review, Biometrika 61, 1, 1974), which
    holds where samples are not normal, and those of one batch hang together.

    Parameters
    ----------
    runs : sequence of ndarray, shape (cycles,)
        Start-up included.
    """
    samples = [after_startup(rows) for rows in runs]
    centred = [some - some.mean() for some in samples if some.size > 1]
    if not centred:
        return None
    free = sum(own.size - 1 for own in centred)
    squares = sum(float(own @ own) for own in centred)
    value = math.sqrt(squares / free)
    without = []
    for own in centred:
        for part in np.array_split(own, min(own.size, MOST_BATCHES)):
            # Those that stay have another mean: the sum of all is zero.
            lost = float(part @ part) + float(part.sum()) ** 2 / (own.size - part.size)
            without.append((squares - lost) / max(free - part.size, 1))
    left_out = np.array(without)
    groups = left_out.size
    if groups < LEAST_SAMPLES or not np.all(left_out > 0.0):
        return Estimate(value, samples=groups)
    pseudo = 2.0 * groups * math.log(value) - (groups - 1) * np.log(left_out)
    centre, half = float(pseudo.mean()), half_width(pseudo)
    assert half is not None, "there are several groups"
    low, high = math.exp(0.5 * (centre - half)), math.exp(0.5 * (centre + half))
    return Estimate(value, low, high, groups)


def mean_range(runs: Sequence[Array], most: int = RANGE_STROKES) -> tuple[Estimate | None, int]:
    """Mean range over so many successive cycles of a run, and how many they are.

    The range of a sample grows with its size, so that only those of one size compare: each run
    is cut into pieces of ``most`` cycles, or of as many as the shortest run has.  Their ranges are
    samples as those of ``pooled`` are.

    Parameters
    ----------
    runs : sequence of ndarray, shape (cycles,)
        Start-up included.
    """
    samples = [after_startup(rows) for rows in runs]
    count = min([most, *(some.size for some in samples)])
    if count < 2:
        return None, count
    ranges = []
    for some in samples:
        pieces = some.size // count
        # What does not fill a piece is left out, at the start.
        whole = some[some.size - pieces * count :].reshape(pieces, count)
        ranges.append(np.ptp(whole, axis=1))
    everything = np.concatenate(ranges)
    mean, half = float(everything.mean()), half_width(_parts(ranges, differ(ranges)))
    if half is None:
        return Estimate(mean, samples=everything.size), count
    return Estimate(mean, max(mean - half, 0.0), mean + half, everything.size), count


def differ(samples: Sequence[Array]) -> bool:
    """True where some groups of samples have means that differ (analysis of variance, 1 %)."""
    groups = [some for some in samples if some.size >= LEAST_SAMPLES]
    if len(groups) < 2 or all(np.ptp(some) == 0.0 for some in groups):
        return False
    from scipy.special import fdtrc  # slow to import

    everything = np.concatenate(groups)
    means = np.concatenate([np.full(some.size, some.mean()) for some in groups])
    between, within = len(groups) - 1, everything.size - len(groups)
    scatter = float(((everything - means) ** 2).sum()) / within
    apart = float(((means - everything.mean()) ** 2).sum()) / between
    return scatter == 0.0 or bool(fdtrc(between, within, apart / scatter) < 0.01)
