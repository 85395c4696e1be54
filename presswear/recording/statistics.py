"""Statistics of cycles, which are samples of a chaotic motion: means, wear maps, intervals.

Cycles after the start-up are the samples: in the first cycle the pins fall on their
bearings all at once, and the second cycle has weaker impacts than later ones.
Successive cycles are correlated: an interval is that of as many independent samples as
the cycles are worth.  Confidence intervals are of 95 %.  In this module ``runs`` are
arrays of one number per cycle, start-up included, one for each run; ``count`` is the
number of maps that bootstrap samples are from.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import final

import numpy as np
from numpy.typing import NDArray

from presswear.tools.arrays import Array, State
from presswear.tools.numbers import readable, with_interval

# that are no samples; if no more ran, the last of them is the only one
STARTUP_CYCLES = 2
MIN_SAMPLES = 3  # for a bootstrap or an analysis of variance
MAX_BATCHES = 32  # of wear maps; with more, two neighbours become one
LEVEL = 0.95
RANGE_STROKES = 10  # successive strokes of which the range is computed
MIN_WIDTH = 0.1  # bins, standard deviation of a Gaussian that leaves a map as it is
MAX_WIDTH = 0.1  # of a turn, of the widest Gaussian that smooths a map
WIDTHS = 64  # of Gaussians to choose from
# of a bootstrap: an end of an interval scatters by about 5 % of its width
RESAMPLES = 1000
MAX_FACTOR = 10.0  # from the mean of a positive quantity to an end of its interval
_ENDS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)


@final
@dataclass(frozen=True)
class Estimate:
    """Number with its 95 % confidence interval."""

    mean: float
    low: float | None = None  # end of the interval; None: too few samples
    high: float | None = None
    samples: int = 0  # cycles, batches of cycles or replicates behind it

    @staticmethod
    def symmetric(
        mean: float, half_width: float | None, samples: int = 0
    ) -> "Estimate":
        """Return an estimate whose interval reaches as far to both sides."""
        if half_width is None:
            return Estimate(mean, samples=samples)
        return Estimate(mean, mean - half_width, mean + half_width, samples)

    @property
    def half_width(self) -> float | None:
        """Half the length of the interval; None: too few samples."""
        return (
            None
            if self.low is None or self.high is None
            else 0.5 * (self.high - self.low)
        )

    @property
    def positive(self) -> "Estimate":
        """Estimate of a positive quantity, with the interval of its logarithm (delta method).

        Without an interval if an end is more than ``MAX_FACTOR`` times away: too few
        samples.
        """
        half = self.half_width
        if half is None or self.mean <= 0.0:
            return self
        if half > self.mean * math.log(MAX_FACTOR):
            return self.without_interval
        factor = math.exp(half / self.mean)
        return Estimate(self.mean, self.mean / factor, self.mean * factor, self.samples)

    @property
    def without_interval(self) -> "Estimate":
        """Mean alone."""
        return Estimate(self.mean, samples=self.samples)

    def __str__(self) -> str:
        """Return the mean with its interval; ``±`` where both ends are about as far away.

        An interval over more than ``MAX_FACTOR`` squared says no more than too few
        cycles.
        """
        if self.low is None and self.samples >= MIN_SAMPLES:
            # of different motions, or too wide
            return f"{readable(self.mean)} (no interval)"
        if (
            self.low is None
            or self.high is None
            or 0.0 < MAX_FACTOR**2 * self.low < self.high
        ):
            return with_interval(self.mean, None)
        half = 0.5 * (self.high - self.low)
        if abs(0.5 * (self.low + self.high) - self.mean) <= 0.05 * half:
            return with_interval(self.mean, half)
        mean, *ends = (
            readable(number, 2) for number in (self.mean, self.low, self.high)
        )
        return f"{mean} ({' to '.join(ends)})"

    def scaled(self, factor: float) -> "Estimate":
        """Return the estimate in another unit; the factor is positive."""
        low, high = (
            None if end is None else factor * end for end in (self.low, self.high)
        )
        return Estimate(factor * self.mean, low, high, self.samples)


def after_startup(rows: Array) -> Array:
    """Return the rows, one per cycle, that are samples."""
    return rows[max(min(STARTUP_CYCLES, len(rows) - 1), 0) :]


def half_width(samples: Array) -> float | None:
    """Return the half width of Student's interval of a mean; None for fewer than two samples.

    The samples are independent; see ``half_width_of_runs``.
    """
    count = len(samples)
    if count < 2:
        return None
    return quantile(count - 1) * (float(samples.std(ddof=1)) / math.sqrt(count))


def half_width_of_runs(series: Sequence[Array]) -> float | None:
    """Return the half width of the mean of correlated samples; None for fewer than two.

    Student's interval of as many independent samples as the correlated ones are worth.

    Parameters
    ----------
    series : sequence of ndarray
        Successive samples, one array for each run. The runs are independent of each
        other.
    """
    samples = np.concatenate(series)
    if samples.size < 2:
        return None
    worth = samples.size / inefficiency(series)
    return quantile(max(worth - 1.0, 1.0)) * (
        float(samples.std(ddof=1)) / math.sqrt(worth)
    )


def inefficiency(series: Sequence[Array]) -> float:
    """Return how many successive samples are worth one independent sample, 1 or more.

    It is the sum of the autocorrelations over all lags.  The autocovariances are those
    of all runs together.  They are summed in pairs of neighbouring lags, up to the
    first pair that is not positive, and no pair counts more than the pair before it:
    the initial monotone sequence (Geyer, Practical Markov chain Monte Carlo,
    Statistical Science 7, 4, 1992).  Negative correlation does not narrow an interval.
    """
    samples = np.concatenate(series)
    count = samples.size
    mean = float(samples.mean())
    deviations = [run - mean for run in series]
    variance = sum(float(run @ run) for run in deviations) / max(count - 1, 1)
    longest = max(map(len, series))
    if variance == 0.0:
        return 1.0
    total = -1.0
    last = math.inf
    for lag in range(0, longest - 1, 2):
        first, second = (
            _autocovariance(deviations, each, variance / count)
            for each in (lag, lag + 1)
        )
        pair = min((first + second) / variance, last)
        if pair <= 0.0:
            break
        total += 2.0 * pair
        last = pair
    return max(total, 1.0)


def _autocovariance(deviations: Sequence[Array], lag: int, noise: float) -> float:
    """Return the autocovariance of all runs, weighted by the part of the samples with that lag.

    The deviations are from the mean of all samples, which lowers each product by the
    variance of this mean, the ``noise``.
    """
    pairs = [(run[: run.size - lag], run[lag:]) for run in deviations if run.size > lag]
    products = sum(
        float(before @ after) + before.size * noise for before, after in pairs
    )
    return products / sum(run.size for run in deviations)


def quantile(freedom: float) -> float:
    """Return Student's quantile at the upper end of an interval; the normal one for infinity."""
    # slow to import, and scipy.stats three times as slow
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * LEVEL))


@dataclass
class MapBatches:
    """Wear maps of a run, summed over batches of neighbouring cycles, in constant memory."""

    shape: tuple[int, ...]  # (joints, 2, bins)
    cycles: int = 0  # added, start-up included
    size: int = 1  # cycles in a full batch
    _last: Array = field(init=False)
    _sums: Array = field(init=False)

    def __post_init__(self) -> None:
        self._last = np.zeros(self.shape)
        self._sums = np.zeros((MAX_BATCHES, *self.shape))

    def add(self, depth: Array) -> None:
        """Add the depth that one cycle added, m."""
        self.cycles += 1
        if self.cycles <= STARTUP_CYCLES:
            self._last[...] = depth
            return
        before = self.cycles - STARTUP_CYCLES - 1
        if before == MAX_BATCHES * self.size:
            half = MAX_BATCHES // 2
            self._sums[:half] = self._sums[0::2] + self._sums[1::2]
            self._sums[half:] = 0.0
            self.size *= 2
        self._sums[before // self.size] += depth

    @property
    def samples(self) -> int:
        """Number of cycles that are samples."""
        return max(self.cycles - STARTUP_CYCLES, min(self.cycles, 1))

    @property
    def sampled(self) -> Array:
        """Depth of all samples, m."""
        return (
            np.asarray(self._sums.sum(axis=0))
            if self.cycles > STARTUP_CYCLES
            else self._last
        )

    @property
    def batches(self) -> Array:
        """Mean depth per cycle in each full batch, shape (n, joints, 2, bins), m."""
        count = max(self.cycles - STARTUP_CYCLES, 0) // self.size
        return np.asarray(self._sums[:count] / self.size)

    def since(self, cycle: int) -> "MapBatches":
        """Return the maps without the batches that begin in the first cycles."""
        skipped = min(
            -(-cycle // self.size), max(self.cycles - STARTUP_CYCLES, 0) // self.size
        )
        later = MapBatches(self.shape, self.cycles - skipped * self.size, self.size)
        later._last[...] = self._last
        later._sums[: MAX_BATCHES - skipped] = self._sums[skipped:]
        return later

    def save(self) -> State:
        """Return copies of the arrays that change."""
        filed = np.array([self.cycles, self.size])
        return {"filed": filed, "last": self._last.copy(), "sums": self._sums.copy()}

    @staticmethod
    def load(state: State) -> "MapBatches":
        """Return the maps that ``save`` gave."""
        maps = MapBatches(
            state["last"].shape, *(int(number) for number in state["filed"])
        )
        maps._last[...], maps._sums[...] = state["last"], state["sums"]
        return maps


def mean_map(runs: Sequence[MapBatches]) -> Array:
    """Return the mean depth of a sample, m."""
    depth = np.sum([run.sampled for run in runs], axis=0)
    return np.asarray(depth / max(sum(run.samples for run in runs), 1))


def map_batches(runs: Sequence[MapBatches]) -> tuple[Array, Array]:
    """Return batches of all runs, shape (n, joints, 2, bins), m, and the cycles in each, (n,)."""
    batches = [run.batches for run in runs]
    weights = np.repeat([float(run.size) for run in runs], list(map(len, batches)))
    return np.concatenate(batches), weights


def smoothed(maps: Array, widths: Array, bins: Sequence[int]) -> Array:
    """Return wear maps averaged over angle with the weights of Gaussians.

    The mean depth of each map is conserved, and no depth becomes negative.

    Parameters
    ----------
    maps : ndarray, shape (..., joints, 2, bins)
        Depth, m.
    widths : ndarray, shape (joints, 2)
        Standard deviations of the Gaussians in bins.
    bins : sequence of int
        Number of bins of each joint; none: the maps stay raw.
    """
    from scipy.ndimage import gaussian_filter1d  # slow to import

    result = maps.copy()
    for k, count in enumerate(bins):
        for side in range(2):
            place = (..., k, side, slice(count))
            result[place] = gaussian_filter1d(maps[place], widths[k, side], mode="wrap")
    return result


@cache
def _smoothings(bins: int) -> tuple[Array, Array]:
    """Return widths of Gaussians, in bins, and which part of each harmonic of a map each leaves."""
    widths = np.geomspace(MIN_WIDTH, MAX_WIDTH * bins, WIDTHS)
    peak = np.zeros((1, 2, bins))
    peak[0, 0, 0] = 1.0
    left = [
        np.fft.fft(smoothed(peak, np.full((1, 2), w), [bins])[0, 0]).real
        for w in widths
    ]
    return widths, np.array(left)


def smoothing_widths(
    depth: Array, cycles: int, maps: Array, weights: Array, bins: Sequence[int]
) -> Array:
    """Return the widths with which a wear map is smoothed, in bins, shape (joints, 2).

    Mallows' criterion (Some comments on C_p, Technometrics 15, 4, 1973) estimates the
    mean square error of the smoothed map without bias.  The variance of the Gaussian is
    half of that at which the estimate is least: the peak is flattened half as much, at
    a few parts in a hundred more error.

    Parameters
    ----------
    depth : ndarray, shape (joints, 2, bins)
        Mean of a number of cycles, m.
    maps : ndarray, shape (n, joints, 2, bins)
        Samples whose scatter gives the noise, m; with one the map stays as it is.
    weights : ndarray, shape (n,)
        Cycles in each sample.
    bins : sequence of int
        Number of bins of each joint.
    """
    result = np.full((len(bins), 2), MIN_WIDTH)
    if len(maps) < 2 or cycles == 0:  # a run may fail in its first cycle
        return result
    share = weights / weights.sum()
    mean = np.tensordot(share, maps, 1)
    volume = maps.sum(axis=-1, keepdims=True)
    whole = mean.sum(axis=-1, keepdims=True)
    # Only noise of the shape counts: the volume of a map is kept as it is.
    off = maps - mean * np.divide(
        volume, whole, out=np.zeros_like(volume), where=whole > 0.0
    )
    scale = weights.sum() / (len(maps) - 1) / cycles
    for k, count in enumerate(bins):
        widths, left = _smoothings(count)
        for side in range(2):
            power = np.abs(np.fft.fft(depth[k, side, :count])) ** 2
            noise = scale * share @ np.abs(np.fft.fft(off[:, k, side, :count])) ** 2
            risk = (1.0 - left) ** 2 @ power + 2.0 * left @ noise
            result[k, side] = max(math.sqrt(0.5) * widths[risk.argmin()], MIN_WIDTH)
    return result


def smoothed_maps(runs: Sequence[MapBatches], bins: Sequence[int]) -> Array:
    """Return the mean depth of a cycle in each run, smoothed, m, shape (runs, joints, 2, bins).

    The noise is that of the batches of all runs. ``bins`` are those of each joint;
    none: raw maps.
    """
    batches = map_batches(runs)
    return np.array([smoothed_mean([run], bins, batches) for run in runs])


def smoothed_mean(
    runs: Sequence[MapBatches],
    bins: Sequence[int],
    batches: tuple[Array, Array] | None = None,
) -> Array:
    """Return the mean depth of a cycle in all runs, smoothed, m; ``batches`` give the noise."""
    depth = mean_map(runs)
    cycles = sum(run.samples for run in runs)
    widths = smoothing_widths(depth, cycles, *(batches or map_batches(runs)), bins)
    return smoothed(depth, widths, bins)


def map_errors(maps: Array, weights: Array) -> Array:
    """Return the standard error of each joint's mean map relative to its rms, shape (joints,).

    Infinite if there are too few samples. They count as independent: over all bins the
    maps of successive cycles correlate by -0.1 to 0.05 (four-bar, press).

    Parameters
    ----------
    maps : ndarray, shape (n, joints, 2, bins)
    weights : ndarray, shape (n,)
        Cycles in each map; its variance goes as one over them.
    """
    if len(maps) < MIN_SAMPLES:
        return np.full(maps.shape[1], math.inf)
    share = weights / weights.sum()
    mean = np.tensordot(share, maps, 1)
    variance = np.tensordot(share, (maps - mean) ** 2, 1) / (len(maps) - 1)
    size, noise = (np.sum(part, axis=(1, 2)) for part in (mean**2, variance))
    return np.sqrt(np.divide(noise, size, out=np.zeros(len(size)), where=size > 0.0))


def widened(estimate: Estimate, error: float) -> Estimate:
    """Return an estimate with an independent error added as the root of the sum of squares."""
    if estimate.low is None or estimate.high is None:
        return estimate
    mean, (below, above) = estimate.mean, (estimate.low, estimate.high)
    low = mean - math.copysign(math.hypot(mean - below, error), mean - below)
    high = mean + math.copysign(math.hypot(above - mean, error), above - mean)
    return replace(estimate, low=low, high=high)


def about(mean: float, estimate: Estimate) -> Estimate:
    """Return an estimate moved to another mean and widened by the distance."""
    off = mean - estimate.mean
    if estimate.low is None or estimate.high is None:
        return replace(estimate, mean=mean)
    return widened(
        Estimate(mean, estimate.low + off, estimate.high + off, estimate.samples), off
    )


def resampled(maps: Array, weights: Array, seed: int = 1) -> Array:
    """Return bootstrap means, (RESAMPLES, bins), of maps, (n, bins), with weights, (n,)."""
    count = len(maps)
    generator = np.random.default_rng(seed)
    picked = (
        generator.multinomial(count, np.full(count, 1.0 / count), RESAMPLES) * weights
    )
    return np.asarray(picked @ maps / picked.sum(axis=1, keepdims=True))


def _ends(draws: Array, centre: Array | float, count: int) -> Array:
    """Return quantiles of bootstrap samples, widened about a centre as Student's interval is.

    The standard deviation of a bootstrap is smaller than the one without bias.
    """
    ratio = quantile(count - 1) / quantile(math.inf) * math.sqrt(count / (count - 1))
    return np.asarray(ratio * (np.quantile(draws, _ENDS, axis=0) - centre))


def basic_interval(value: float, draws: Array, count: int) -> Estimate:
    """Return the interval of a statistic from its bootstrap samples, shape (RESAMPLES,).

    A statistic that is biased by noise, such as the deepest of many bins, is biased
    again by as much in the samples: the interval is reflected at the estimate ("basic"
    bootstrap, Davison and Hinkley, Bootstrap Methods and their Application, section
    2.4), and widened as Student's is.
    """
    if count < MIN_SAMPLES:
        return Estimate(value, samples=count)
    below, above = _ends(draws, value, count).tolist()
    return Estimate(value, value - above, value - below, count)


def angle_interval(
    place: int, places: NDArray[np.int64], bins: int, count: int
) -> Estimate:
    """Return the angle of a bin, rad, with its interval from its places in bootstrap samples.

    The ends are continuous with the angle: they may lie below 0 or above 2 pi.
    """
    angle = 2.0 * math.pi * (place + 0.5) / bins
    if count < MIN_SAMPLES:
        return Estimate(angle, samples=count)
    moved = (places - place + bins // 2) % bins - bins // 2
    left, right = _ends(moved.astype(np.float64), 0.0, count).tolist()
    width = 2.0 * math.pi / bins  # no place is known better than its bin
    return Estimate(
        angle, angle + width * min(left, -0.5), angle + width * max(right, 0.5), count
    )


def pointwise_interval(mean: Array, draws: Array, count: int) -> tuple[Array, Array]:
    """Return the ends of the interval of each bin of a mean map; of one map the mean twice."""
    if count < 2:
        return mean, mean
    low, high = mean + _ends(draws, mean, count)
    return low, high


def peak_of(
    mean: Array, draws: Array, count: int, centre: Array | None = None
) -> tuple[Estimate, Estimate]:
    """Return depth, m, and angle, rad, of the deepest place of a mean wear map.

    Parameters
    ----------
    mean : ndarray, shape (bins,)
        Depth, m.
    draws : ndarray, shape (RESAMPLES, bins)
        Bootstrap samples of ``resampled``.
    centre : ndarray, shape (bins,) or None
        Mean of the maps behind them, if it differs from the mean, m. The interval is
        then moved to the mean and widened by the distance.
    """
    place = int(mean.argmax())
    deepest = float((mean if centre is None else centre).max())
    depth = about(float(mean[place]), basic_interval(deepest, draws.max(axis=1), count))
    if depth.low is not None:
        depth = replace(depth, low=max(depth.low, 0.0))
    return depth, angle_interval(place, draws.argmax(axis=1), mean.size, count)


def pooled(runs: Sequence[Array], alone: Sequence[Array] = ()) -> tuple[Estimate, bool]:
    """Return the mean over the cycles of several runs, and whether the runs differ.

    Runs whose means differ by more than their cycles explain (one-way analysis of
    variance, 1 %) are single samples themselves: the interval is that of the runs.

    Parameters
    ----------
    alone : sequence of ndarray
        Runs that are single samples, such as those on surfaces of their own: their
        scatter, and the distance of their mean from that of the runs, give the
        interval.
    """
    samples = [after_startup(rows) for rows in runs]
    everything = np.concatenate(samples)
    mean = float(everything.mean()) if everything.size else math.nan
    if len(alone) > 1:
        means = np.array([after_startup(rows).mean() for rows in alone])
        half = math.hypot(half_width(means) or 0.0, mean - float(means.mean()))
        return Estimate.symmetric(mean, half, everything.size), True
    return Estimate.symmetric(mean, _half_width_of(samples), everything.size), differ(
        samples
    )


def _half_width_of(samples: Sequence[Array]) -> float | None:
    """Return the half width of the mean over several runs, or of the means of runs that differ."""
    if differ(samples):
        return half_width(np.array([run.mean() for run in samples]))
    return half_width_of_runs(samples)


def spread(runs: Sequence[Array]) -> Estimate | None:
    """Return the standard deviation of cycles about the mean of their run; None: too few.

    The distance between the means of runs on different surfaces does not count.  The
    interval is that of the logarithm of the variance by the jackknife (Miller, The
    jackknife - a review, Biometrika 61, 1, 1974), which holds for samples that are not
    normal.  Its pseudo-values are correlated as the cycles are.
    """
    samples = [after_startup(rows) for rows in runs]
    centred = [run - run.mean() for run in samples if run.size > 1]
    if not centred:
        return None
    free = sum(run.size - 1 for run in centred)
    squares = sum(float(run @ run) for run in centred)
    value = math.sqrt(squares / free)
    count = sum(run.size for run in centred)
    # The other samples of the run have another mean: the sum of all is zero.
    without = [
        (squares - run**2 * run.size / (run.size - 1)) / max(free - 1, 1)
        for run in centred
    ]
    if count < MIN_SAMPLES or not all(np.all(left > 0.0) for left in without):
        return Estimate(value, samples=count)
    pseudo = [
        2.0 * count * math.log(value) - (count - 1) * np.log(left) for left in without
    ]
    centre = float(np.concatenate(pseudo).mean())
    half = half_width_of_runs(pseudo) or 0.0
    low, high = math.exp(0.5 * (centre - half)), math.exp(0.5 * (centre + half))
    return Estimate(value, low, high, count)


def mean_range(runs: Sequence[Array]) -> tuple[Estimate | None, int]:
    """Return the mean range over successive cycles of a run, and their number.

    The range of a sample grows with its size.  Each run is therefore cut into pieces of
    ``RANGE_STROKES`` cycles, or of as many as the shortest run has.  Cycles that do not
    fill a piece are left out, at the start.
    """
    samples = [after_startup(rows) for rows in runs]
    count = min([RANGE_STROKES, *(run.size for run in samples)])
    if count < 2:
        return None, count
    ranges = [
        np.ptp(run[run.size % count :].reshape(-1, count), axis=1) for run in samples
    ]
    everything = np.concatenate(ranges)
    mean = float(everything.mean())
    half = _half_width_of(ranges)
    return Estimate.symmetric(mean, half, everything.size).positive, count


def differ(samples: Sequence[Array]) -> bool:
    """Return whether the means of some runs differ (one-way analysis of variance, 1 %).

    Their successive samples count as so many independent ones as they are worth.
    """
    groups = [group for group in samples if group.size >= MIN_SAMPLES]
    if len(groups) < 2 or all(np.ptp(group) == 0.0 for group in groups):
        return False
    from scipy.special import fdtrc  # slow to import

    everything = np.concatenate(groups)
    centred = [group - group.mean() for group in groups]
    per_sample = inefficiency(centred)
    between = len(groups) - 1
    within = everything.size - len(groups)
    scatter = per_sample * sum(float(group @ group) for group in centred) / within
    distances = [
        group.size * float(group.mean() - everything.mean()) ** 2 for group in groups
    ]
    ratio = sum(distances) / between / scatter if scatter > 0.0 else math.inf
    return bool(fdtrc(between, max(within / per_sample, 1.0), ratio) < 0.01)
