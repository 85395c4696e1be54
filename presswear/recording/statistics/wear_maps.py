"""Wear maps summed over batches of cycles, their mean, noise and smoothing."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from presswear.recording.statistics.correlated_samples import STARTUP_CYCLES
from presswear.recording.statistics.estimate import MIN_SAMPLES
from presswear.tools.arrays import Array, State

MAX_BATCHES = 32  # number of batches at which two neighbours become one batch
# Smallest standard deviation of a Gaussian, bins, which leaves a map as it is
MIN_WIDTH = 0.1
MAX_WIDTH = 0.1  # largest standard deviation of a Gaussian, turns
WIDTHS = 64  # number of Gaussians to choose from


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
        if self.cycles <= STARTUP_CYCLES:
            return self._last
        return np.asarray(self._sums.sum(axis=0))

    @property
    def batches(self) -> Array:
        """Mean depth per cycle in each full batch, shape (n, joints, 2, bins), m."""
        count = max(self.cycles - STARTUP_CYCLES, 0) // self.size
        return np.asarray(self._sums[:count] / self.size)

    def since(self, cycle: int) -> "MapBatches":
        """Return the maps without the batches that begin in the first cycles."""
        full = max(self.cycles - STARTUP_CYCLES, 0) // self.size
        skipped = min(math.ceil(cycle / self.size), full)
        later = MapBatches(self.shape, self.cycles - skipped * self.size, self.size)
        later._last[...] = self._last
        later._sums[: MAX_BATCHES - skipped] = self._sums[skipped:]
        return later

    def save(self) -> State:
        """Return copies of the arrays that change."""
        counts = np.array([self.cycles, self.size])
        return {"filed": counts, "last": self._last.copy(), "sums": self._sums.copy()}

    @staticmethod
    def load(state: State) -> "MapBatches":
        """Return the maps of a state that ``save`` has returned."""
        cycles, size = state["filed"].tolist()
        maps = MapBatches(state["last"].shape, cycles, size)
        maps._last[...] = state["last"]
        maps._sums[...] = state["sums"]
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
    """Return widths of Gaussians, in bins, and their frequency responses, (widths, bins).

    The response is the factor by which a Gaussian multiplies each harmonic of a map.
    """
    widths = np.geomspace(MIN_WIDTH, MAX_WIDTH * bins, WIDTHS)
    peak = np.zeros((1, 2, bins))
    peak[0, 0, 0] = 1.0
    responses = []
    for width in widths:
        result = smoothed(peak, np.full((1, 2), width), [bins])
        responses.append(np.fft.fft(result[0, 0]).real)
    return widths, np.array(responses)


def smoothing_widths(
    depth: Array, cycles: int, maps: Array, weights: Array, bins: Sequence[int]
) -> Array:
    """Return the widths with which a wear map is smoothed, in bins, shape (joints, 2).

    Mallows' criterion (Some comments on C_p, Technometrics 15, 4, 1973) estimates the
    mean square error of the smoothed map without bias.  The variance of the Gaussian is
    half of that at which the estimate is least. This flattens the peak half as much and
    increases the error by a few per cent.

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
    mean_volume = mean.sum(axis=-1, keepdims=True)
    # Smoothing conserves the volume of a map, so that only noise of its shape counts.
    zeros = np.zeros_like(volume)
    ratio = np.divide(volume, mean_volume, out=zeros, where=mean_volume > 0.0)
    deviations = maps - mean * ratio
    scale = weights.sum() / (len(maps) - 1) / cycles
    for k, count in enumerate(bins):
        widths, response = _smoothings(count)
        for side in range(2):
            power = np.abs(np.fft.fft(depth[k, side, :count])) ** 2
            spectra = np.abs(np.fft.fft(deviations[:, k, side, :count])) ** 2
            noise = scale * share @ spectra
            error = (1.0 - response) ** 2 @ power + 2.0 * response @ noise
            result[k, side] = max(math.sqrt(0.5) * widths[error.argmin()], MIN_WIDTH)
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
        Cycles in each map; the variance of a map is proportional to one over them.
    """
    if len(maps) < MIN_SAMPLES:
        return np.full(maps.shape[1], math.inf)
    share = weights / weights.sum()
    mean = np.tensordot(share, maps, 1)
    variance = np.tensordot(share, (maps - mean) ** 2, 1) / (len(maps) - 1)
    square = np.sum(mean**2, axis=(1, 2))
    noise = np.sum(variance, axis=(1, 2))
    zeros = np.zeros(len(square))
    return np.sqrt(np.divide(noise, square, out=zeros, where=square > 0.0))
