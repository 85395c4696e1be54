"""Power spectral densities of unevenly sampled motions, over orders of the cycle."""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from presswear.results.sampled_cycles import sampled_span
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

MAX_ORDER = 1000  # highest frequency of a spectrum in turns of the crank


@dataclass(frozen=True)
class Spectrum:
    """One-sided power spectral density."""

    frequency: Array  # Hz
    density: Array  # square of the unit of the values per Hz
    period: float  # period of a cycle, s

    @property
    def order(self) -> Array:
        """Frequency in multiples of the frequency of the cycle."""
        return self.frequency * self.period

    @property
    def lines(self) -> int:
        """Number of spectral lines per order."""
        return round(1.0 / self.order[1])

    def amplitude(self, order: float) -> float:
        """Return the amplitude of a sine with the power within half an order of ``order``."""
        is_near = np.abs(self.order - order) < 0.5
        power = self.density[is_near].sum() * self.frequency[1]
        return float(np.sqrt(2.0 * power))

    @property
    def harmonic_share(self) -> float:
        """Share of the power on the lines of integer orders and on the next line on each side.

        These three lines are the main lobe of Hann's window. The share is 1 for a motion
        that repeats every cycle and 3 / ``lines`` for white noise.
        """
        position = np.arange(self.order.size) % self.lines
        is_harmonic = np.minimum(position, self.lines - position) <= 1
        powers = self.density[1:]
        return float(powers[is_harmonic[1:]].sum() / powers.sum())


def resample(time: Array, values: Array, interval: float) -> Array:
    """Return the mean of a series, linear between its rows, in each of equal intervals, s.

    A mean keeps the impulse of peaks that are shorter than the interval and limits
    aliasing.
    """
    count = int((time[-1] - time[0]) / interval * (1.0 + 1e-12))
    edges = time[0] + interval * np.arange(count + 1)
    steps = np.diff(time)
    areas = np.append(0.0, np.cumsum(0.5 * steps * (values[1:] + values[:-1])))
    # The area is a parabola between two rows.
    row = np.clip(np.searchsorted(time, edges, side="right") - 1, 0, time.size - 2)
    elapsed = edges - time[row]
    slope = (values[row + 1] - values[row]) / steps[row]
    area = areas[row] + elapsed * (values[row] + 0.5 * slope * elapsed)
    return np.asarray(np.diff(area) / interval)


def power_spectrum(
    time: Array, values: Array, period: float, max_frequency: float, cycles: int = 8
) -> Spectrum:
    """Return the power spectral density of a series by Welch's method.

    Segments consist of whole cycles, so that harmonics of the cycle lie on spectral
    lines. They have Hann's window, overlap by half, and their means are subtracted
    (Welch, IEEE Trans. Audio 15 (1967) 70).

    Parameters
    ----------
    time, values : ndarray, shape (n,)
        Rows at increasing times, s, of any spacing.
    period : float
        Duration of a cycle, s.
    max_frequency : float
        Hz.
    cycles : int
        Largest number of cycles in a segment.
    """
    # The last row is slightly before the end of a cycle.
    available = int((time[-1] - time[0]) / period + 0.02)
    if available < 1:
        raise InputError(
            "a spectrum needs at least one recorded cycle; increase recorded_cycles"
        )
    rows_per_cycle = int(np.ceil(2.0 * max_frequency * period))
    interval = period / rows_per_cycle
    means = resample(time, values, interval)
    size = min(min(cycles, available) * rows_per_cycle, len(means))
    segments = sliding_window_view(means, size)[:: size - size // 2]
    # scipy.signal.welch gives the same, but takes 0.3 s to import.
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi / size * np.arange(size))
    centred = segments - segments.mean(axis=1, keepdims=True)
    power = (np.abs(np.fft.rfft(window * centred)) ** 2).mean(axis=0)
    # One-sided: every line counts twice, except the mean and the Nyquist line of an
    # even size.
    power[1 : (size + 1) // 2] *= 2.0
    density = power * interval / (window**2).sum()
    frequency = np.asarray(np.fft.rfftfreq(size, interval), dtype=np.float64)
    return Spectrum(frequency, density, period)


def spectra_of(scene: Scene, stage: StageResult) -> dict[str, Spectrum]:
    """Return spectra of the recorded sampled cycles, up to ``MAX_ORDER``.

    The key is the name of a joint for the spectrum of its normal force, N^2/Hz, and
    ``""`` for that of the acceleration of the output point, (m/s^2)^2/Hz.
    """
    start, end = sampled_span(scene, stage)
    rows = (stage.time >= start) & (stage.time <= end)
    series = {"": stage.acceleration}
    series |= {name: joint.force[:, 0] for name, joint in stage.joints.items()}
    clock = stage.clock[rows]
    period = scene.mechanism.period
    if stage.has_clock:  # the mean duration of a cycle
        period *= float(np.ptp(clock) / np.ptp(stage.time[rows]))
    return {
        name: power_spectrum(clock, values[rows], period, MAX_ORDER / period)
        for name, values in series.items()
    }
