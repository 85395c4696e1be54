"""Spectra of a motion whose rows are unevenly spaced in time, over orders of its cycle."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from presswear.tools.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Spectrum:
    """A one-sided power spectral density.

    Attributes
    ----------
    frequency : ndarray, shape (n,)
        Hz.
    density : ndarray, shape (n,)
        Squares of the values' unit per Hz.
    period : float
        Duration of a cycle, s.
    segments : int
        Segments that it is the mean of.
    """

    frequency: Array
    density: Array
    period: float
    segments: int

    @property
    def order(self) -> Array:
        """Frequency in turns of the cycle."""
        return self.frequency * self.period

    def amplitude(self, order: float) -> float:
        """Amplitude of what lies within half an order of one, in the values' unit."""
        near = np.abs(self.order - order) < 0.5
        return float(np.sqrt(2.0 * self.density[near].sum() * (self.frequency[1])))

    @property
    def lines(self) -> int:
        """Lines in an order."""
        return round(1.0 / self.order[1])

    @property
    def harmonic_share(self) -> float:
        """Part of the power that lies at whole orders, within a line of each: Hann's window.

        1 for a motion of one cycle; of noise that is even over all orders 3 / ``lines``.
        """
        place = np.arange(self.order.size) % self.lines
        at_whole = np.minimum(place, self.lines - place) <= 1
        powers = self.density[1:]
        return float(powers[at_whole[1:]].sum() / powers.sum())


def evenly(time: Array, values: Array, interval: float) -> tuple[Array, Array]:
    """Means of a series over equal intervals; gives the middles of these, s, and the means.

    The series is linear between its rows.  A mean keeps the impulse of peaks that are shorter
    than the interval, and lets little of them fold back to low frequencies.
    """
    count = int((time[-1] - time[0]) / interval * (1.0 + 1e-12))
    edges = time[0] + interval * np.arange(count + 1)
    steps = np.diff(time)
    areas = np.append(0.0, np.cumsum(0.5 * steps * (values[1:] + values[:-1])))
    # The area grows as a parabola between two rows.
    place = np.clip(np.searchsorted(time, edges, side="right") - 1, 0, time.size - 2)
    since = edges - time[place]
    slope = (values[place + 1] - values[place]) / steps[place]
    area = areas[place] + since * (values[place] + 0.5 * slope * since)
    return 0.5 * (edges[1:] + edges[:-1]), np.asarray(np.diff(area) / interval)


def spectrum_of(
    time: Array, values: Array, period: float, highest: float, cycles: int = 8
) -> Spectrum:
    """Density of a series by Welch's method, its lines at parts of the order.

    Segments are of whole cycles, by Hann's window and overlapping by half, without their mean
    (Welch, IEEE Trans. Audio 15 (1967) 70).

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        Rows at rising times, however spaced, s.
    period : float
        Duration of a cycle, s.
    highest : float
        Highest frequency, Hz.
    cycles : int
        Cycles in a segment, at most as many as there are; lines lie at 1 / cycles of an order.

    Raises
    ------
    InputError
        For less than one cycle.
    """
    # Rows end a little before a cycle does.
    whole = int((time[-1] - time[0]) / period + 0.02)
    if whole < 1:
        raise InputError("a spectrum takes one cycle at least, and less was recorded")
    length = min(cycles, whole)
    each = int(np.ceil(2.0 * highest * period))
    _, means = evenly(time, values, period / each)
    size = min(length * each, len(means))
    segments = sliding_window_view(means, size)[:: size - size // 2]
    # By hand: scipy.signal takes half a second to import.
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi / size * np.arange(size))
    centred = segments - segments.mean(axis=1, keepdims=True)
    power = (np.abs(np.fft.rfft(window * centred)) ** 2).mean(axis=0)
    # One-sided: all but the mean and, of an even number of rows, the highest stand for two.
    power[1 : (size + 1) // 2] *= 2.0
    interval = period / each
    density = power * interval / (window**2).sum()
    frequency = np.asarray(np.fft.rfftfreq(size, interval), dtype=np.float64)
    return Spectrum(frequency, density, period, len(segments))
