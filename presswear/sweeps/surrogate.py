"""Surrogate of a response: a Gaussian process through its means at the points of a sweep."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from presswear.sweeps.parameters import Distribution, design
from presswear.sweeps.response_distribution import ENDS, PROBABILITIES, Spread
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.response_points import Points
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, not_installed

# Share of the variance, less chaos, that cross-validation must explain
MIN_EXPLAINED = 0.5
MIN_EXPLAINED_TOTAL = 0.1  # share of the total variance: less may be chance
MIN_POINTS_EACH = 5  # points for each parameter
MAX_POINTS = 1000  # the time to fit grows with the third power
FOLDS = 10  # folds of the cross-validation
SPREAD_POINTS = 512  # points of the distributions at which the surrogate is evaluated
# Draws of the process; an end of an interval scatters by 10 % of its width
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
        self, distributions: Sequence[Distribution], limit: ResponseLimit | None = None
    ) -> Spread:
        """Return the distribution of single runs when the parameters have distributions.

        The intervals contain the error of the process. Parameters are in the order of
        the columns.
        """
        unit = design("sobol", SPREAD_POINTS, len(distributions), seed=1)
        columns = zip(distributions, unit.T, strict=True)
        values = [distribution.ppf(column) for distribution, column in columns]
        points = np.column_stack(values)
        scaled = _scaled(self.points, points)
        draws = self.process.sample_y(scaled, SPREAD_DRAWS, random_state=1)
        draws = draws + self._single_runs(draws.shape)
        responses = np.exp(draws) if self.is_logarithmic else draws
        quantiles = np.quantile(responses, PROBABILITIES, axis=0)
        median, low, high = np.quantile(quantiles, (0.5, *ENDS), axis=1)
        violation = None
        if limit is not None:
            # Fraction of violations in each draw
            fractions = limit.violated(responses).mean(axis=0)
            violation = tuple(np.quantile(fractions, (0.5, *ENDS)).tolist())
        return Spread("by the surrogate", median, low, high, violation)

    def _single_runs(self, shape: tuple[int, ...]) -> Array:
        """Return the scatter of single runs, which draws of the process of means lack."""
        points = self.points
        variance = float((points.variances - points.noise).mean())
        if variance <= 0.0:
            return np.zeros(shape)
        shift = 0.0
        if self.is_logarithmic:
            variance /= float(np.mean(points.means**2))
            # The logarithm of a mean is above the mean logarithm.
            shift = -0.5 * variance
        generator = np.random.default_rng(1)
        # The variance of single runs is an estimate, too: each draw has its own.
        _, draws = shape
        chi_square = generator.chisquare(points.freedom, draws)
        scale = np.sqrt(variance * points.freedom / chi_square)
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
    pairs = zip(points.parameters, points.points.T, values.T, strict=True)
    for column, present, requested in pairs:
        if column.choices:
            for index in range(len(column.choices)):
                columns.append((requested == index).astype(float))
            continue
        if is_logarithmic(present):
            present = np.log(present)
            requested = np.log(requested)
        columns.append((requested - present.min()) / (np.ptp(present) or 1.0))
    return np.column_stack(columns)


def fit(points: Points) -> Surrogate:
    """Fit the surrogate of a response, or of its logarithm if that is less skewed.

    `InputError` if scikit-learn is not installed, values are censored, points are too
    few or too many, or cross-validation explains too little of the variance.
    """
    name = points.response.key
    _check_points(points)
    try:
        from sklearn.exceptions import ConvergenceWarning  # slow to import
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
        from sklearn.metrics import r2_score
        from sklearn.model_selection import KFold, cross_val_predict
    except ImportError:
        raise not_installed("a surrogate", "scikit-learn") from None
    points = _with_value(points)
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
        folds = KFold(min(FOLDS, len(values)), shuffle=True, random_state=1)
        predicted = cross_val_predict(fixed, inputs, values, cv=folds)
    if logarithmic:
        predicted = np.exp(predicted)
    explained = float(r2_score(points.means, predicted))
    noise = float(points.noise.mean() / points.means.var(ddof=1))
    needed = max(MIN_EXPLAINED * (1.0 - min(noise, 1.0)), MIN_EXPLAINED_TOTAL)
    if explained < needed:
        share = f"{100.0 * max(explained, 0.0):.0f} % of the variance"
        raise InputError(
            f"no surrogate of {name}: in cross-validation it explains {share}; "
            f"it needs {100.0 * needed:.0f} %"
        )
    return Surrogate(points, process, logarithmic)


def _check_points(points: Points) -> None:
    """Raise InputError if the points do not allow a surrogate."""
    name = points.response.key
    dimension = len(points.parameters)
    count = int(points.has_value.sum())
    least = MIN_POINTS_EACH * dimension
    if points.censored.any():
        raise InputError(f"no surrogate of {name}: some of its values are lower bounds")
    if not least <= count <= MAX_POINTS:
        allowed = f"{least} to {MAX_POINTS} for {dimension} parameters"
        raise InputError(
            f"no surrogate of {name}: {count} points have a value; it needs {allowed}"
        )
    if points.is_constant:
        raise InputError(f"no surrogate of {name}: it has the same value at all points")


def _with_value(points: Points) -> Points:
    """Return the points that have a value."""
    rows = points.has_value
    return replace(
        points,
        points=points.points[rows],
        means=points.means[rows],
        variances=points.variances[rows],
        counts=points.counts[rows],
        censored=points.censored[rows],
    )
