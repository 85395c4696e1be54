"""Statistics of cycles: means, batches, wear maps, bootstrap intervals and their coverage."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from presswear.recording import statistics
from presswear.recording.statistics.estimate import weighted_sum
from presswear.tools.arrays import Array


def test_interval_of_a_mean_over_cycles():
    """Student's interval of 2, 6, 4 after the start-up: 4 +- 4.303 * 2 / sqrt(3)."""
    found = statistics.pooled([np.array([100.0, 50.0, 2.0, 6.0, 4.0])])[0]
    assert (found.mean, found.half_width) == pytest.approx(
        (4.0, 4.30265 * 2.0 / 3.0**0.5)
    )
    # Where no more ran, the last is the only sample.
    assert statistics.pooled([np.array([1.0, 3.0])])[0] == statistics.Estimate(
        3.0, samples=1
    )


def autoregressive(
    generator: np.random.Generator, phi: float, runs: int, count: int
) -> Array:
    """Return stationary series of unit variance, shape (runs, count)."""
    series = generator.normal(size=(runs, count))
    for i in range(1, count):
        series[:, i] = (
            phi * series[:, i - 1] + math.sqrt(1.0 - phi * phi) * series[:, i]
        )
    return series


def moving_average(
    generator: np.random.Generator, part: float, runs: int, count: int
) -> Array:
    """Return stationary series of unit variance whose neighbours alone are correlated."""
    noise = generator.normal(size=(runs, count + 1))
    series: Array = (noise[:, 1:] + part * noise[:, :-1]) / math.sqrt(1.0 + part * part)
    return series


@pytest.mark.parametrize(
    ("make", "number", "runs", "count", "plain"),
    [
        (autoregressive, 0.0, 4, 5, 1.0),
        (autoregressive, 0.0, 1, 60, 1.0),
        (moving_average, 0.6, 4, 5, 0.89),
        (moving_average, 0.6, 4, 20, 0.89),
        (moving_average, 0.6, 4, 64, 0.89),
        (autoregressive, 0.8, 1, 1600, 0.7),
    ],
)
def test_means_of_correlated_cycles_are_covered(make, number, runs, count, plain):
    """Of correlated series Student's interval of the cycles is too narrow; that of runs is not."""
    generator = np.random.default_rng(3)
    tries = 600
    inside = 0
    inside_plain = 0
    for _ in range(tries):
        series = list(make(generator, number, runs, count))
        samples = np.concatenate(series)
        half = statistics.half_width_of_runs(series)
        narrow = statistics.half_width(samples)
        assert narrow is not None
        assert half >= narrow
        inside += abs(samples.mean()) <= half
        inside_plain += abs(samples.mean()) <= narrow
    assert 0.91 < inside / tries < 0.985
    assert inside_plain / tries <= plain


def test_few_or_equal_samples_have_no_correlation():
    assert statistics.inefficiency([np.ones(5), np.ones(5)]) == 1.0
    assert statistics.half_width_of_runs([np.ones(5)]) == 0.0
    assert statistics.half_width_of_runs([np.array([1.0])]) is None
    means = [np.array([1.0]), np.array([2.0]), np.array([4.0])]
    student = statistics.half_width(np.concatenate(means))
    assert statistics.half_width_of_runs(means) == student


def ends_of(estimate: Any) -> tuple[float, float]:
    """Return the ends of an interval."""
    assert estimate.low < estimate.mean < estimate.high
    return estimate.low, estimate.high


def as_it_is(series: Array) -> Array:
    return series


def skewed(series: Array) -> Array:
    """Normal numbers made those of a gamma distribution of shape 2, of unit variance."""
    found: Array = stats.gamma.ppf(stats.norm.cdf(series), 2.0) / math.sqrt(2.0)
    return found


@pytest.mark.parametrize(
    ("phi", "runs", "count", "shape", "far"),
    [
        (0.0, 4, 5, as_it_is, 0.0),
        (0.0, 4, 14, as_it_is, 3.0),
        (0.0, 4, 50, skewed, 0.0),
        (0.5, 4, 80, as_it_is, 3.0),
        (0.8, 1, 1600, as_it_is, 0.0),
    ],
)
def test_intervals_of_scatter_cover_it(phi, runs, count, shape, far):
    """Standard deviation and range of samples that hang together, of runs far apart."""
    generator = np.random.default_rng(11)
    size = min(10, count - statistics.STARTUP_CYCLES)
    long = shape(autoregressive(generator, phi, 2000, 20 // size * size))
    truth = float(np.ptp(long.reshape(-1, size), axis=1).mean())
    draws = 300
    deviations = 0
    ranges = 0
    plain = 0
    for _ in range(draws):
        series = shape(autoregressive(generator, phi, runs, count))
        series += far * np.arange(runs)[:, np.newaxis]
        scatter = statistics.spread(list(series))
        low, high = ends_of(scatter)
        deviations += low <= 1.0 <= high
        span, pieces = statistics.mean_range(list(series))
        assert pieces == size
        low, high = ends_of(span)
        ranges += low <= truth <= high
        free = runs * (count - statistics.STARTUP_CYCLES - 1)
        ends = scatter.mean * np.sqrt(free / stats.chi2.ppf([0.975, 0.025], free))
        plain += ends[0] <= 1.0 <= ends[1]
    assert 0.89 < deviations / draws < 0.99
    assert 0.89 < ranges / draws < 0.99
    if phi > 0.7 or shape is skewed:
        assert plain / draws < 0.85


@given(st.integers(1, 200), st.integers(0, 2**31))
def test_map_batches_keep_sums_means_and_scatter(count, seed):
    maps = np.random.default_rng(seed).gamma(1.0, size=(count, 2, 2, 5))
    found = statistics.MapBatches((2, 2, 5))
    for depth in maps:
        found.add(depth)
    samples = maps[min(statistics.STARTUP_CYCLES, count - 1) :]
    assert np.array_equal(statistics.after_startup(maps), samples)
    assert found.samples == len(samples)
    assert np.allclose(statistics.mean_map([found]), samples.mean(axis=0))
    if len(samples) < statistics.MIN_SAMPLES:
        assert np.all(np.isinf(statistics.map_errors(*statistics.map_batches([found]))))
        return
    whole = len(samples) // found.size
    expected = (
        samples[: whole * found.size].reshape(whole, found.size, 2, 2, 5).mean(axis=1)
    )
    assert np.allclose(found.batches, expected)
    assert whole <= statistics.MAX_BATCHES
    noise = (expected.var(axis=0, ddof=1) / whole).sum(axis=(1, 2))
    size = (expected.mean(axis=0) ** 2).sum(axis=(1, 2))
    assert np.allclose(
        statistics.map_errors(*statistics.map_batches([found])), np.sqrt(noise / size)
    )


@pytest.mark.parametrize(("count", "width"), [(6, 10.0), (20, 10.0), (20, 40.0)])
def test_intervals_of_the_deepest_place_cover_it(count, width):
    """The deepest of noisy bins is too deep on average; the interval must know that."""
    generator = np.random.default_rng(7)
    truth = np.exp(-0.5 * ((np.arange(360) - 90.0) / width) ** 2)
    draws = 100
    deep = 0
    turned = 0
    bias = 0.0
    for _ in range(draws):
        scale = 1.0 + 0.3 * generator.standard_normal((count, 1))
        maps = truth * scale * generator.gamma(11.0, 1.0 / 11.0, (count, 360))
        depth, angle = statistics.peak_of(
            maps.mean(axis=0), statistics.resampled(maps, np.ones(count)), count
        )
        low = depth.low or 0.0
        high = depth.high or 0.0
        deep += low <= 1.0 <= high
        low, high = ends_of(angle)
        turned += low <= math.radians(90.5) + 1e-9 <= high + 2e-9
        bias += (depth.mean - 1.0) / draws
    assert bias > 0.03
    assert deep / draws > 0.9
    assert turned / draws > 0.9


def test_interval_of_the_deepest_place_moves_to_the_mean_and_widens_by_the_distance():
    """The map of a wear update differs from the mean of the maps of its samples."""
    groove = np.exp(-0.5 * ((np.arange(90) - 30.0) / 5.0) ** 2)
    maps = groove * np.random.default_rng(2).gamma(20.0, 0.05, (8, 1))
    draws = statistics.resampled(maps, np.ones(8))
    centre = maps.mean(axis=0)
    of_centre, _ = statistics.peak_of(centre, draws, 8)
    mean = centre + 0.1
    off = 0.1
    depth, _ = statistics.peak_of(mean, draws, 8, centre)
    assert depth.mean == pytest.approx(mean.max(), rel=1e-15)
    # Half widths and the distance are added as the root of the sum of squares.
    low, high = ends_of(of_centre)
    below = math.hypot(of_centre.mean - low, off)
    above = math.hypot(high - of_centre.mean, off)
    assert ends_of(depth) == pytest.approx((depth.mean - below, depth.mean + above))


def test_a_smoothed_map_keeps_volume_and_nears_the_true_map():
    """A known map with known noise: error, flattening of its peak, and width by its samples."""
    generator = np.random.default_rng(3)
    bins = (360, 90)
    around = [np.arange(360) - 90.0, np.arange(90) - 20.0]
    truth = np.zeros((2, 2, 360))
    for k, angle in enumerate(around):
        truth[k, :, : bins[k]] = np.exp(-0.5 * (angle / 12.0) ** 2)
    widths = []
    fixed = np.append(statistics.MIN_WIDTH, np.geomspace(0.5, 10.0, 20))
    for count in (3, 12, 96):
        errors = []
        peaks = []
        selected = []
        for _ in range(20):
            maps = truth * generator.gamma(10.0, 0.1, (count, 2, 2, 360))
            mean = maps.mean(axis=0)
            selected.append(
                statistics.smoothing_widths(mean, count, maps, np.ones(count), bins)
            )
            each = [selected[-1], *(np.full((2, 2), width) for width in fixed)]
            results = [statistics.smoothed(mean, width, bins) for width in each]
            assert results[0].min() >= 0.0
            assert results[0].sum(axis=2) == pytest.approx(mean.sum(axis=2), rel=1e-13)
            peaks.append(results[0].max(axis=2))
            errors.append([((result - truth) ** 2).sum() for result in results])
        error, raw, *others = np.mean(errors, axis=0)
        assert error < 0.65 * raw
        # The variance of the Gaussian is half of the best one.
        best = fixed[1 + int(np.argmin(others))]
        assert np.median(selected) == pytest.approx(math.sqrt(0.5) * best, rel=0.3)
        # A quarter of the half width of the interval; the variance of a bin is 0.1.
        half_width = statistics.quantile(count - 1) * math.sqrt(0.1 / count)
        assert abs(np.mean(peaks) - 1.0) < 0.25 * half_width
        widths.append(np.mean(selected))
    assert widths[0] > widths[1] > widths[2]


def test_a_map_without_noise_or_with_one_sample_stays_as_it_is():
    depth = np.random.default_rng(1).random((1, 2, 30))
    for count in (1, 5):
        maps = np.repeat(depth[np.newaxis], count, axis=0)
        width = statistics.smoothing_widths(depth, count, maps, np.ones(count), [30])
        assert np.array_equal(statistics.smoothed(depth, width, [30]), depth)


@pytest.mark.parametrize("count", [3, 5, 20])
def test_bootstrap_intervals_of_a_mean_are_those_of_student(count):
    """Draws of the mean of normal samples are normal, with their standard deviation over root n.

    The standard deviation of a bootstrap is that without Bessel's correction.
    """
    samples = np.random.default_rng(count).normal(3.0, 0.5, count)
    mean = float(samples.mean())
    error = float(samples.std()) / math.sqrt(count)
    expected = stats.t.interval(0.95, count - 1, mean, stats.sem(samples))
    # So many draws that the ends of the interval are two of them.
    draws = mean + error * stats.norm.ppf(
        np.linspace(0.0, 1.0, 1001).clip(1e-9, 1.0 - 1e-9)
    )
    found = statistics.basic_interval(mean, draws, count)
    assert (found.low, found.high) == pytest.approx(expected, rel=1e-9)
    low, high = statistics.pointwise_interval(
        np.array([mean]), draws[:, np.newaxis], count
    )
    assert (low[0], high[0]) == pytest.approx(expected, rel=1e-9)
    bins = 1_000_000
    turn = 2.0 * math.pi
    place = round(mean / turn * bins)
    angle = statistics.angle_interval(
        place, np.rint(draws / turn * bins).astype(np.int64), bins, count
    )
    assert (angle.low, angle.high) == pytest.approx(expected, abs=10.0 * turn / bins)


def test_an_angle_near_zero_keeps_its_interval_together():
    generator = np.random.default_rng(5)
    around = (np.arange(360) + 180) % 360 - 180
    maps = np.exp(-0.5 * (around / 5.0) ** 2) * generator.gamma(4.0, 0.25, (12, 360))
    _, angle = statistics.peak_of(
        maps.mean(axis=0), statistics.resampled(maps, np.ones(12)), 12
    )
    low, high = ends_of(angle)
    assert 0.0 < high - low < math.radians(40.0)


def test_runs_that_differ_are_single_samples():
    generator = np.random.default_rng(0)
    alike = [generator.normal(10.0, 1.0, 30) for _ in range(3)]
    apart = [generator.normal(mean, 1.0, 30) for mean in (8.0, 10.0, 12.0)]
    together, are_apart = statistics.pooled(alike)
    assert not are_apart
    assert together.samples == 84
    assert together.half_width < 0.5
    wide, are_apart = statistics.pooled(apart)
    assert are_apart
    means = np.array([rows[statistics.STARTUP_CYCLES :].mean() for rows in apart])
    assert wide.half_width == pytest.approx(statistics.half_width(means))
    assert wide.half_width > 2.0


def test_quantiles_and_variances_are_those_of_scipy():
    draw = np.random.default_rng(5)
    for count in (2, 3, 8, 33, 200):
        some = draw.normal(size=count)
        low, high = stats.t.interval(0.95, count - 1, some.mean(), stats.sem(some))
        assert statistics.half_width(some) == pytest.approx(
            0.5 * (high - low), rel=1e-12
        )
    found = set()
    for shift in np.linspace(0.0, 6.0, 41):
        # Successive samples of negative correlation count as independent.
        groups = [
            shift * (k == 0) + np.diff(draw.normal(size=5 + 3 * k)) for k in range(4)
        ]
        assert statistics.differ(groups) == (stats.f_oneway(*groups).pvalue < 0.01)
        found.add(statistics.differ(groups))
    assert found == {True, False}


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (statistics.Estimate(21.0, samples=100), "21.0 (no interval)"),
        (statistics.Estimate(21.0, samples=2), "21.0 (too few cycles)"),
        (statistics.Estimate(21.0, 0.012, 1.1e6, 6), "21.0 (too few cycles)"),
        (statistics.Estimate(21.0, 3.0, 290.0, 6), "21 (3.0 to 290)"),
        (statistics.Estimate(21.0, -1.0, 1.1e6, 6), "21 (−1.0 to 1.1·10⁶)"),
    ],
)
def test_an_estimate_is_written_with_its_interval(estimate, text):
    """An interval over a factor of a hundred is not written."""
    assert f"{estimate}" == text


@pytest.mark.parametrize(("count", "first"), [(20, 5), (100, 33), (1000, 90)])
def test_maps_without_the_first_cycles_are_those_of_the_others(count, first):
    """The batch in which the samples begin is left out as a whole."""
    depth = np.random.default_rng(1).random((count, 1, 2, 6))
    maps = statistics.MapBatches((1, 2, 6))
    for one in depth:
        maps.add(one)
    later = maps.since(first)
    begin = statistics.STARTUP_CYCLES + -(-first // maps.size) * maps.size
    assert begin >= statistics.STARTUP_CYCLES + first
    assert later.samples == count - begin
    assert later.sampled == pytest.approx(depth[begin:].sum(axis=0))
    assert later.batches == pytest.approx(maps.batches[-(-first // maps.size) :])
    assert maps.since(0).sampled == pytest.approx(maps.sampled)


def test_a_weighted_sum_of_independent_estimates_has_the_root_of_the_squares():
    first = statistics.Estimate.symmetric(3.0, 1.5)
    second = statistics.Estimate.symmetric(5.0, 4.0)
    result = weighted_sum((first, second), (2.0, -1.0))
    assert (result.mean, result.low, result.high) == (1.0, -4.0, 6.0)
    unknown = statistics.Estimate(5.0)
    assert weighted_sum((first, unknown), (2.0, -1.0)) == statistics.Estimate(1.0)
