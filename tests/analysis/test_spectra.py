"""Spectra of sums of sines and of noise, and periods of motions whose period is known."""

import numpy as np
import pytest
from refusals import refused
from scipy.signal import welch

from presswear.analysis.periods import Periodicity, periodicity
from presswear.analysis.spectra import power_spectrum, resample

PERIOD = 0.02
RANDOM = np.random.default_rng(1)
TIME = np.sort(np.append([0.0, 40 * PERIOD], RANDOM.uniform(0.0, 40 * PERIOD, 200_000)))


def test_amplitudes_of_harmonics():
    """Means over the interval take the part sinc of each, here below 1 %."""
    turn = 2.0 * np.pi * TIME / PERIOD
    values = 5.0 + 3.0 * np.sin(turn) + 0.2 * np.cos(7.0 * turn)
    spectrum = power_spectrum(TIME, values, PERIOD, 100.0 / PERIOD)
    assert spectrum.amplitude(1.0) == pytest.approx(3.0, rel=0.01)
    assert spectrum.amplitude(7.0) == pytest.approx(0.2, rel=0.01)
    assert spectrum.amplitude(4.0) < 1e-3
    assert spectrum.harmonic_share > 0.999
    assert spectrum.order[np.argmax(spectrum.density)] == pytest.approx(1.0, rel=1e-12)


def test_power_is_the_variance():
    """White noise over 0 .. f has the density variance / f, and harmonics no greater part."""
    time = np.linspace(0.0, 1000 * PERIOD, 400_001)
    values = RANDOM.normal(0.0, 2.0, time.size)
    spectrum = power_spectrum(time, values, PERIOD, 50.0 / PERIOD, cycles=16)
    # Linear between rows, the means of four intervals have 7/32 of the rows' variance.
    power = spectrum.density.sum() * spectrum.frequency[1]
    assert power == pytest.approx(4.0 * 7.0 / 32.0, rel=0.02)
    assert spectrum.harmonic_share == pytest.approx(3.0 / 16.0, abs=0.02)


def test_means_keep_an_impulse():
    """A triangle of 2 us and 1000 N, on a grid of 1 ms."""
    time = np.array([0.0, 4.999e-3, 5e-3 + 1e-6, 5e-3 + 3e-6, 5e-3 + 5e-6, 0.02])
    force = np.array([0.0, 0.0, 0.0, 1000.0, 0.0, 0.0])
    means = resample(time, force, 1e-3)
    assert means.size == 20
    assert means.sum() * 1e-3 == pytest.approx(2e-3, rel=1e-9)
    assert np.argmax(means) == 5


@pytest.mark.parametrize("highest", [50.0, 50.25])
def test_density_is_that_of_scipy(highest):
    """Segments of an even and of an odd number of means."""
    values = 5.0 + RANDOM.normal(0.0, 2.0, TIME.size)
    spectrum = power_spectrum(TIME, values, PERIOD, highest / PERIOD, cycles=5)
    each = int(np.ceil(2.0 * highest))
    means = resample(TIME, values, PERIOD / each)
    size = 5 * each
    frequency, density = welch(means, each / PERIOD, "hann", size, size // 2)
    assert size % 2 == (highest > 50.0)
    np.testing.assert_allclose(spectrum.frequency, frequency, rtol=1e-12)
    np.testing.assert_allclose(spectrum.density, density, rtol=1e-9)


def test_less_than_a_cycle_is_refused():
    with refused("at least one recorded cycle"):
        power_spectrum(TIME[:100], TIME[:100], PERIOD, 1000.0)


def test_the_logistic_map_repeats_itself_after_four_and_never():
    def orbit(r: float) -> Periodicity:
        x = 0.3
        rows = []
        for _ in range(1200):
            x = r * x * (1.0 - x)
            rows.append([x])
        return periodicity(np.array(rows[-200:]), np.ones(1), 1e-6)

    # May, Nature 261 (1976) 459: period 4 from 1 + sqrt(6) to 3.5441, period 3 from 1 +
    # sqrt(8).
    assert [orbit(r).period for r in (2.9, 3.2, 3.5, 3.835, 4.0)] == [1, 2, 4, 3, None]
    assert str(orbit(3.5)) == "period 4 within 0.0001 % in 200 cycles"
    assert str(orbit(4.0)) == "no period within 0.0001 % in 200 cycles"
    assert orbit(4.0).error > 1e-6


def test_a_period_is_seen_twice_and_each_number_has_its_scale():
    """Seven states of period four have been seen once only."""
    states = np.tile(np.arange(4.0), 2)[:, None]
    assert periodicity(states[:7], np.ones(1)).period is None
    assert periodicity(states, np.ones(1)).period == 4
    states = np.array([[0.0, 0.0], [1e-6, 0.0]] * 4)
    assert periodicity(states, np.array([1e-6, 1.0])).period == 2
    assert periodicity(states, np.array([1.0, 1.0])).period == 1
