"""Sensitivity of a response to the parameters, its chaotic variance, distribution and surrogate.

Replicates of a chaotic motion differ, which adds a variance that no parameter explains.
It lowers first-order indices and raises total indices. Where replicates or the
intervals of the runs tell how large it is, it is subtracted.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import LEVEL, quantile
from presswear.sweeps.parameters import MORRIS_LEVELS, Column, Distribution, design
from presswear.sweeps.plan import Table
from presswear.sweeps.responses import Limit
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, not_installed

# Saltelli blocks or Morris trajectories below which nothing is estimated
MIN_BLOCKS = 8
MIN_SHARE = 0.1  # of the parameters in the variance; indices of less are errors alone
MIN_POINTS = 64  # points of a sample below which first-order indices are not estimated
RESAMPLES = 200  # bootstrap resamples of SALib
RBD_HARMONICS = 6  # of RBD-FAST; more resolve faster variations, with more noise
PROBABILITIES = np.arange(1, 100) / 100.0
ENDS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)


@dataclass(frozen=True)
class Points:
    """One response at the n points of a sweep in d parameters, averaged over the replicates."""

    parameters: tuple[Column, ...]
    response: Column
    points: Array  # shape (n, d)
    means: Array  # shape (n,); NaN where no replicate has a value
    # shape (n,), of a single run about the mean of its point; 0 if unknown
    variances: Array
    counts: Array  # shape (n,), replicates with a value
    # shape (n,), whether the value of a replicate is a lower bound
    censored: NDArray[np.bool_]
    # degrees of freedom of the variances; infinite if from intervals of the runs
    freedom: float
    # of the interval of a run, which the variances are from
    interval_freedom: float = math.inf

    @property
    def has_value(self) -> NDArray[np.bool_]:
        """True for each point where a replicate has a value, shape (n,)."""
        return self.counts > 0.0

    @property
    def noise(self) -> Array:
        """Variance of each mean, shape (n,)."""
        return self.variances / np.maximum(self.counts, 1.0)

    @property
    def quantile(self) -> float:
        """Half width of a 95 % interval over the standard deviation; NaN if that is unknown."""
        freedom = min(self.freedom, self.interval_freedom)
        return quantile(freedom) if freedom > 0.0 else math.nan

    @property
    def is_constant(self) -> bool:
        """True if the response has at most one value."""
        values = self.means[self.has_value]
        return not values.size or float(np.ptp(values)) == 0.0

    @property
    def half_widths(self) -> Array:
        """Half widths of the 95 % intervals of the means, shape (n,); NaN if unknown."""
        return self.quantile * np.sqrt(self.noise)


def points_of(table: Table, key: str) -> Points:
    """Return the means of a response over the replicates of each point.

    Replicates share one pooled variance. Without replicates the intervals of the runs
    are used.
    """
    k = table.index(key)
    shape = (-1, table.replicates)
    values, halves, censored = (
        array[:, k].reshape(shape)
        for array in (table.values, table.half_widths, table.censored)
    )
    counts = np.isfinite(values).sum(axis=1).astype(float)
    with np.errstate(invalid="ignore"):
        means = np.nansum(values, axis=1) / np.where(counts > 0.0, counts, np.nan)
    freedom = float(np.maximum(counts - 1.0, 0.0).sum())
    interval_freedom = math.inf
    halves = np.where(np.isfinite(values), halves, 0.0)
    variances = np.zeros(len(counts))
    if freedom > 0.0:
        variances += np.nansum((values - means[:, None]) ** 2) / freedom
    elif counts.any() and np.isfinite(halves).all():
        freedom = math.inf
        interval_freedom = table.freedom[k] if table.freedom else math.inf
        squared = (halves / quantile(interval_freedom)) ** 2
        variances = squared.sum(axis=1) / np.maximum(counts, 1.0)
    points = table.points[:: table.replicates]
    bounds = np.logical_or.reduce(censored & np.isfinite(values), axis=1)
    response = table.responses[k]
    columns = table.parameters, response
    return Points(
        *columns, points, means, variances, counts, bounds, freedom, interval_freedom
    )


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivity of a response to each of d parameters."""

    title: str
    method: str
    names: tuple[str, ...]  # of the measures, such as first-order and total index
    values: Array  # shape (measures, d)
    half_widths: Array  # shape (measures, d), of the 95 % intervals; NaN if unknown
    # shares of the variance; otherwise in the unit of the response
    is_share: bool = False
    # value that chaos alone would give; NaN if unknown or subtracted
    noise: float = math.nan

    @property
    def order(self) -> list[int]:
        """Indices of the parameters, the most important first."""
        strength = np.nan_to_num(
            self.values[-1] if self.is_share else np.abs(self.values).max(0)
        )
        return [int(k) for k in np.argsort(-strength, kind="stable")]


def sensitivity(points: Points, kind: str) -> Sensitivity | None:
    """Return the sensitivity of a design; None if it has none or too few points.

    ``saltelli``: first-order and total Sobol' indices (`SALib.analyze.sobol`).
    ``sobol`` and ``latin``: first-order indices (`SALib.analyze.rbd_fast`). ``morris``:
    elementary effects of a jump by half of the range (`SALib.analyze.morris`). ``oat``:
    changes from the middle point. `InputError` if SALib is not installed.
    """
    if points.is_constant or not kind:
        return None
    if kind == "oat":
        return _changes(points)
    try:
        from SALib.analyze import morris, rbd_fast, sobol
    except ImportError:
        raise not_installed("sensitivity analysis", "SALib", "sweep") from None
    # A block or trajectory with a missing value is omitted.
    dimension = len(points.parameters)
    size = {"saltelli": dimension + 2, "morris": dimension + 1}.get(kind, 1)
    blocks = np.arange(len(points.means)).reshape(-1, size)
    blocks = blocks[points.has_value[blocks].all(axis=1)]
    rows = blocks.ravel()
    if len(blocks) < (MIN_POINTS if size == 1 else MIN_BLOCKS):
        return None
    names = [column.key for column in points.parameters]
    problem = {
        "num_vars": dimension,
        "names": names,
        "bounds": [[0.0, 1.0]] * dimension,
    }
    options: dict[str, Any] = {"num_resamples": RESAMPLES, "seed": 1}
    values = points.means[rows]
    noise = float(points.noise[rows].mean())
    if kind == "morris":
        options["num_levels"] = MORRIS_LEVELS
        effects = morris.analyze(problem, points.points[rows], values, **options)
        # SALib divides by the jump between its own levels, which lie at the ends of the
        # range.
        jump = MORRIS_LEVELS / (2.0 * (MORRIS_LEVELS - 1.0))
        halves = [effects["mu_star_conf"], np.full(dimension, np.nan)]
        return Sensitivity(
            "Elementary effects of a jump by half of the range",
            "Morris 1991; Campolongo, Cariboni and Saltelli 2007",
            ("mean of the absolute effects", "standard deviation of the effects"),
            jump * np.array([effects["mu_star"], effects["sigma"]], float),
            jump * np.array(halves, float),
            noise=math.sqrt(4.0 / math.pi * noise) if noise > 0.0 else math.nan,
        )
    if kind == "saltelli":
        indices = sobol.analyze(problem, values, calc_second_order=False, **options)
        method = "Saltelli et al. 2010; total indices after Jansen 1999"
        keys = ["S1", "ST"]
        values = points.means[blocks[:, [0, -1]]]
    else:
        indices = rbd_fast.analyze(
            problem, points.points[rows], values, M=RBD_HARMONICS, **options
        )
        method = "RBD-FAST: Tarantola et al. 2006; Tissot and Prieur 2012"
        keys = ["S1"]
    variance = float(values.var())
    if variance - noise < MIN_SHARE * variance:
        return None
    # Chaos adds its variance to the denominator, and to the numerator of total indices.
    scale = variance / (variance - noise)
    shares = scale * np.array([indices[key] for key in keys], float)
    widths = scale * np.array([indices[f"{key}_conf"] for key in keys], float)
    shares[1:] -= noise / (variance - noise)
    measures = ("first-order index", "total index")[: len(keys)]
    return Sensitivity(
        "Sobol' indices", method, measures, shares, widths, is_share=True
    )


def _changes(points: Points) -> Sensitivity | None:
    """Return the changes of a one-at-a-time design; None if its middle point has no value."""
    if not points.has_value[0]:
        return None
    values, variances = np.full((2, 2, len(points.parameters)), np.nan)
    for k, column in enumerate(points.points.T):
        rows = np.flatnonzero((column != column[0]) & points.has_value)
        for side, pick in enumerate((np.argmin, np.argmax)):
            if rows.size:
                row = rows[pick(column[rows])]
                values[side, k] = points.means[row] - points.means[0]
                variances[side, k] = points.noise[row] + points.noise[0]
    halves = points.quantile * np.sqrt(variances)
    names = ("change at the lowest value", "change at the highest value")
    return Sensitivity(
        "One parameter at a time", "change from the middle", names, values, halves
    )


def chaotic_share(points: Points) -> tuple[float, float, float] | None:
    """Return the share of the variance of single runs that is chaos, with its 95 % interval.

    One-way analysis of variance with random effects (Searle, Casella and McCulloch,
    Variance Components, chapter 3). The interval follows from the ratio F and is exact
    for normal points and runs. None without replicates.
    """
    from scipy import stats  # slow to import

    rows = points.has_value
    count = int(rows.sum())
    within = float(points.variances.mean())
    if not 0.0 < points.freedom < math.inf or count < 3 or within == 0.0:
        return None
    counts = points.counts[rows]
    means = points.means[rows]
    total = counts.sum()
    size = (total - (counts**2).sum() / total) / (count - 1.0)
    between = (counts * (means - (counts * means).sum() / total) ** 2).sum() / (
        count - 1.0
    )
    ratios = (
        between / within / np.append(1.0, stats.f(count - 1, points.freedom).ppf(ENDS))
    )
    value, low, high = size / (size + np.maximum(ratios - 1.0, 0.0))
    return float(value), float(min(low, high)), float(max(low, high))


@dataclass(frozen=True)
class Spread:
    """Distribution of a response: quantiles at `PROBABILITIES` with their 95 % intervals."""

    source: str
    values: Array  # shape (99,); NaN if unknown
    low: Array
    high: Array
    # probability of a violation with its interval
    violation: tuple[float, float, float] | None


def spread_of_rows(table: Table, key: str, limit: Limit | None = None) -> Spread | None:
    """Return the distribution of a response over the first replicates of a sample.

    Intervals of quantiles are those of order statistics (David and Nagaraja, Order
    Statistics, section 7.1), the interval of a probability is that of Clopper and
    Pearson (1934). A censored value may be any larger one: intervals contain all
    possibilities. None without values.
    """
    from scipy import stats

    k = table.index(key)
    values = table.values[:: table.replicates, k]
    censored = table.censored[:: table.replicates, k][np.isfinite(values)]
    values = values[np.isfinite(values)]
    count = len(values)
    if count == 0:
        return None
    least = np.sort(values)
    most = np.sort(np.where(censored, np.inf, values))
    first, last = (
        stats.binom.ppf(end, count, PROBABILITIES).astype(int) for end in ENDS
    )
    place = np.ceil(count * PROBABILITIES).astype(int) - 1
    low = np.where(first > 0, least[first - 1], np.nan)
    high = np.where(last < count, most[np.minimum(last, count - 1)], np.nan)
    violation = None
    if limit is not None:
        fewest, largest = limit.count(values, censored)
        violation = (
            0.5 * (fewest + largest) / count,
            float(stats.binomtest(fewest, count).proportion_ci(LEVEL).low),
            float(stats.binomtest(largest, count).proportion_ci(LEVEL).high),
        )
    middle = np.where(least[place] == most[place], least[place], np.nan)
    high = np.where(np.isinf(high), np.nan, high)
    return Spread("by the runs alone", middle, low, high, violation)


# --- Surrogate ----------------------------------------------------------------------

# share of the variance, less chaos, that cross-validation must explain
MIN_EXPLAINED = 0.5
MIN_EXPLAINED_TOTAL = 0.1  # share of the total variance: less may be chance
MIN_POINTS_EACH = 5  # points for each parameter
MAX_POINTS = 1000  # the time to fit grows with the third power
FOLDS = 10  # of the cross-validation
SPREAD_POINTS = 512  # points of the distributions at which the surrogate is evaluated
# draws of the process: an end of an interval scatters by 10 % of its width
SPREAD_DRAWS = 300
MAX_OUTSIDE = 0.05  # probability of a distribution that may lie outside the points


@dataclass(frozen=True)
class Surrogate:
    """Gaussian process through the means of a response."""

    points: Points  # points with a value
    process: Any  # regressor of scikit-learn; its noise is chaos and misfit
    is_logarithmic: bool  # whether the process models the logarithm of the response

    def predict(self, points: Array) -> Array:
        """Return the response at points, shape (n,): the median of a logarithmic process."""
        mean = self.process.predict(_scaled(self.points, points))
        return np.exp(mean) if self.is_logarithmic else mean

    def spread(
        self, distributions: Sequence[Distribution], limit: Limit | None = None
    ) -> Spread:
        """Return the distribution of single runs when the parameters have distributions.

        The intervals contain the error of the process. Parameters are in the order of
        the columns.
        """
        unit = design("sobol", SPREAD_POINTS, len(distributions), seed=1)
        points = np.column_stack(
            [item.ppf(unit[:, k]) for k, item in enumerate(distributions)]
        )
        scaled = _scaled(self.points, points)
        draws = self.process.sample_y(scaled, SPREAD_DRAWS, random_state=1)
        draws = draws + self._single_runs(draws.shape)
        values = np.exp(draws) if self.is_logarithmic else draws
        quantiles = np.quantile(values, PROBABILITIES, axis=0)
        low, median, high = np.quantile(quantiles, (ENDS[0], 0.5, ENDS[1]), axis=1)
        violation = None
        if limit is not None:
            parts = limit.violated(values).mean(axis=0)
            violation = tuple(np.quantile(parts, (0.5, *ENDS)).tolist())
        return Spread("by the surrogate", median, low, high, violation)

    def _single_runs(self, shape: tuple[int, ...]) -> Array:
        """Return what single runs add to draws of the process, which has the noise of means."""
        points = self.points
        variance = float((points.variances - points.noise).mean())
        if variance <= 0.0:
            return np.zeros(shape)
        shift = 0.0
        if self.is_logarithmic:
            variance /= float(np.mean(points.means**2))
            # the logarithm of a mean is above the mean logarithm
            shift = -0.5 * variance
        generator = np.random.default_rng(1)
        # The variance of single runs is an estimate, too: each draw has its own.
        scale = np.sqrt(
            variance * points.freedom / generator.chisquare(points.freedom, shape[1])
        )
        return np.asarray(shift + scale * generator.standard_normal(shape))

    def outside(self, distributions: Sequence[Distribution]) -> str:
        """Return which parameter has too many values outside the points; empty if none."""
        columns = zip(
            self.points.parameters, distributions, self.points.points.T, strict=True
        )
        for column, distribution, values in columns:
            drawn = distribution.ppf((np.arange(1000) + 0.5) / 1000)
            share = float(np.mean((drawn < values.min()) | (drawn > values.max())))
            if share > MAX_OUTSIDE:
                return f"{100.0 * share:.3g} % of the values of {column.key} lie outside the points"
        return ""


def is_logarithmic(column_values: Array) -> bool:
    """Return whether positive values are more evenly spaced in their logarithms."""
    if column_values.min() <= 0.0 or np.ptp(column_values) == 0.0:
        return False
    from scipy.stats import skew  # slow to import

    return bool(abs(skew(np.log(column_values))) < abs(skew(column_values)) - 1e-6)


def _scaled(points: Points, values: Array) -> Array:
    """Return parameters as coordinates from 0 to 1, and a coordinate for each word."""
    columns = []
    for k, column in enumerate(points.parameters):
        present = points.points[:, k]
        wanted = values[:, k]
        if column.choices:
            columns += [
                (wanted == index).astype(float) for index in range(len(column.choices))
            ]
            continue
        if is_logarithmic(present):
            present = np.log(present)
            wanted = np.log(wanted)
        columns.append((wanted - present.min()) / (np.ptp(present) or 1.0))
    return np.column_stack(columns)


def fit(points: Points) -> Surrogate:
    """Fit the surrogate of a response, or of its logarithm if that is less skewed.

    `InputError` if scikit-learn is not installed, values are censored, points are too
    few or too many, or cross-validation explains too little of the variance.
    """
    name = points.response.key
    rows = points.has_value
    dimension = len(points.parameters)
    count = int(rows.sum())
    if points.censored.any():
        raise InputError(f"no surrogate of {name}: some of its values are lower bounds")
    if not MIN_POINTS_EACH * dimension <= count <= MAX_POINTS:
        allowed = (
            f"{MIN_POINTS_EACH * dimension} to {MAX_POINTS} for {dimension} parameters"
        )
        raise InputError(
            f"no surrogate of {name}: {count} points have a value; it needs {allowed}"
        )
    if points.is_constant:
        raise InputError(f"no surrogate of {name}: it has the same value at all points")
    try:
        from sklearn.exceptions import ConvergenceWarning  # slow to import
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
        from sklearn.metrics import r2_score
        from sklearn.model_selection import KFold, cross_val_predict
    except ImportError:
        raise not_installed("a surrogate", "scikit-learn", "sweep") from None
    names = ("points", "means", "variances", "counts", "censored")
    points = replace(points, **{name: getattr(points, name)[rows] for name in names})
    inputs = _scaled(points, points.points)
    logarithmic = is_logarithmic(points.means)
    values = np.log(points.means) if logarithmic else points.means
    shape = Matern(np.ones(inputs.shape[1]), (1e-2, 1e2), nu=2.5)
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * shape + WhiteKernel(0.1, (1e-8, 1e1))
    process = GaussianProcessRegressor(kernel, normalize_y=True, random_state=1)
    with warnings.catch_warnings():
        # A length at its bound belongs to a parameter without effect.
        warnings.simplefilter("ignore", ConvergenceWarning)
        process.fit(inputs, values)
        fixed = GaussianProcessRegressor(
            process.kernel_, optimizer=None, normalize_y=True
        )
        folds = KFold(min(FOLDS, count), shuffle=True, random_state=1)
        predicted = cross_val_predict(fixed, inputs, values, cv=folds)
    explained = float(
        r2_score(points.means, np.exp(predicted) if logarithmic else predicted)
    )
    noise = float(points.noise.mean() / points.means.var(ddof=1))
    needed = max(MIN_EXPLAINED * (1.0 - min(noise, 1.0)), MIN_EXPLAINED_TOTAL)
    if explained < needed:
        part = f"{100.0 * max(explained, 0.0):.0f} % of the variance"
        fault = (
            f"in cross-validation it explains {part}; it needs {100.0 * needed:.0f} %"
        )
        raise InputError(f"no surrogate of {name}: {fault}")
    return Surrogate(points, process, logarithmic)
