"""Means over cycles, which are correlated samples of a chaotic motion, with their intervals.

Cycles after the start-up are the samples: in the first cycle the pins fall on their
bearings all at once, and the second cycle has weaker impacts than later ones.
Successive cycles are correlated: an interval is that of as many independent samples as
the cycles are worth.  In this module ``runs`` are arrays of one number per cycle,
start-up included, one for each run.
"""

import math
from collections.abc import Sequence

import numpy as np

from presswear.recording.statistics.estimate import MIN_SAMPLES, Estimate, quantile
from presswear.tools.arrays import Array

# Cycles that are no samples. If no more cycles ran, the last of them is the only sample
STARTUP_CYCLES = 2
RANGE_STROKES = 10  # successive strokes of which the range is computed
LEVEL = 0.01  # level of significance at which the means of runs differ


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
    worth = samples.size / inefficiency(series)  # number of independent samples
    standard_error = float(samples.std(ddof=1)) / math.sqrt(worth)
    return quantile(max(worth - 1.0, 1.0)) * standard_error


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
        first = _autocovariance(deviations, lag, variance / count)
        second = _autocovariance(deviations, lag + 1, variance / count)
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


def pooled(runs: Sequence[Array], alone: Sequence[Array] = ()) -> tuple[Estimate, bool]:
    """Return the mean over the cycles of several runs, and whether the runs differ.

    If the means of the runs differ significantly (one-way analysis of variance, 1 %),
    each run is a single sample, and the interval is that of the means of the runs.

    Parameters
    ----------
    alone : sequence of ndarray
        Runs that are single samples, because each has other surfaces: their scatter, and
        the distance of their mean from that of the runs, give the interval.
    """
    samples = [after_startup(rows) for rows in runs]
    everything = np.concatenate(samples)
    mean = float(everything.mean()) if everything.size else math.nan
    if len(alone) > 1:
        means = np.array([after_startup(rows).mean() for rows in alone])
        half = math.hypot(half_width(means) or 0.0, mean - float(means.mean()))
        return Estimate.symmetric(mean, half, everything.size), True
    estimate = Estimate.symmetric(mean, _half_width_of(samples), everything.size)
    return estimate, differ(samples)


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
    # Variance without each sample. The mean of its run changes, too.
    variances = [
        (squares - run**2 * run.size / (run.size - 1)) / max(free - 1, 1)
        for run in centred
    ]
    if count < MIN_SAMPLES or not all(np.all(variance > 0.0) for variance in variances):
        return Estimate(value, samples=count)
    pseudo = [
        2.0 * count * math.log(value) - (count - 1) * np.log(variance)
        for variance in variances
    ]
    centre = float(np.concatenate(pseudo).mean())
    half = half_width_of_runs(pseudo) or 0.0
    low = math.exp(0.5 * (centre - half))
    high = math.exp(0.5 * (centre + half))
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

    Successive samples are correlated: each counts as 1 / ``inefficiency`` of a sample.
    """
    groups = [group for group in samples if group.size >= MIN_SAMPLES]
    if len(groups) < 2 or all(np.ptp(group) == 0.0 for group in groups):
        return False
    from scipy.special import fdtrc  # slow to import

    everything = np.concatenate(groups)
    centred = [group - group.mean() for group in groups]
    per_sample = inefficiency(centred)
    between = len(groups) - 1  # degrees of freedom between the groups
    inside = everything.size - len(groups)  # and inside them
    scatter = per_sample * sum(float(group @ group) for group in centred) / inside
    distances = [
        group.size * float(group.mean() - everything.mean()) ** 2 for group in groups
    ]
    ratio = sum(distances) / between / scatter if scatter > 0.0 else math.inf
    return bool(fdtrc(between, max(inside / per_sample, 1.0), ratio) < LEVEL)
