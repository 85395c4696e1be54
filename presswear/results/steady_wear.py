"""Wear of running-in and steady wear rate of a joint, from readings alone.

After running-in the wear h grows linearly with the number N of strokes, h = a + r N:
``a`` is the wear of running-in and ``r`` the steady rate. The line needs no computed
course. The exponent of the course shows whether the readings follow the computed course.
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import Estimate, quantile
from presswear.results.wear_posterior import Observed, Shape
from presswear.tools.arrays import Array

# Readings after some strokes from which a line or an exponent has an error
LEAST_READINGS = 3
_DOUBT = 0.01  # probability below which readings and shape disagree
# Lower and upper bounds of ln f and of m, see ``course_exponent``: far beyond any readings
_BOUNDS = ([-30.0, 0.05], [30.0, 20.0])
_LOGARITHM_GUESS = 29.0  # largest absolute first guess of ln f, inside the bounds
_SINGULAR = 1e12  # condition number above which readings do not determine an exponent
_ROUND_OFF = 1e-6  # of an exponent


@dataclass(frozen=True)
class SteadyWear:
    """Straight line through the readings of a joint after some strokes."""

    running_in: Estimate  # growth since new at 0 strokes of the line, m or m^3
    rate: Estimate  # per stroke
    until: Estimate | None  # strokes until the limit; None: no limit is reached


@dataclass(frozen=True)
class CourseExponent:
    """Exponent m of strokes^m with which the readings pass through the computed course."""

    value: Estimate  # 1: the readings follow the course
    disagrees: bool  # 1 lies outside the interval of 99 %


def steady_wear(observed: Observed, new: float, limit: float) -> SteadyWear | None:
    """Return the line through the readings after some strokes; None for fewer than three.

    The interval of the strokes until the limit is Fieller's. It has no upper end if a
    rate of zero lies within its interval.

    Parameters
    ----------
    observed : Observed
    new : float
        Value of the new joint.
    limit : float
        Infinite if there is none.
    """
    worn = observed.strokes > 0.0
    strokes = observed.strokes[worn]
    count = len(strokes)
    if count < LEAST_READINGS or np.ptp(strokes) <= 0.0:
        return None
    growth = observed.values[worn] - new
    weights = observed.weights[worn]
    scale = float(strokes.max())
    columns = np.column_stack([np.ones(count), strokes / scale])
    inverse = np.linalg.inv(columns.T * weights @ columns)
    intercept, slope = inverse @ (columns.T @ (weights * growth))
    residuals = growth - columns @ (intercept, slope)
    variance = float(residuals**2 @ weights) / (count - 2)
    student = quantile(count - 2)
    if observed.errors is not None:
        variance = max(variance, 1.0)
        student = quantile(math.inf)
    covariance = np.asarray(student**2 * variance * inverse, dtype=float)
    intercept_half, slope_half = np.sqrt(np.diag(covariance)).tolist()
    life = None
    if slope > 0.0 and not math.isinf(limit):
        remaining = float(limit - new - intercept)
        low, high = _fieller(remaining, float(slope), covariance)
        value = scale * remaining / float(slope)
        life = Estimate(value, scale * low, scale * high, count)
    return SteadyWear(
        Estimate.symmetric(float(intercept), intercept_half, count),
        Estimate.symmetric(float(slope) / scale, slope_half / scale, count),
        life,
    )


def _fieller(remaining: float, slope: float, covariance: Array) -> tuple[float, float]:
    """Return the values x at which remaining - slope x is as large as its half width.

    ``covariance`` of intercept and slope is that of the half widths. The upper value is
    infinite if the slope does not differ from zero.
    """
    quadratic = slope**2 - covariance[1, 1]
    linear = -2.0 * (remaining * slope + covariance[0, 1])
    constant = remaining**2 - covariance[0, 0]
    root = math.sqrt(max(linear**2 - 4.0 * quadratic * constant, 0.0))
    if quadratic <= 0.0:
        return 0.0, math.inf
    low = (-linear - root) / (2.0 * quadratic)
    return max(low, 0.0), (-linear + root) / (2.0 * quadratic)


def course_exponent(shape: Shape, observed: Observed) -> CourseExponent | None:
    """Return the exponent of the readings over the computed course; None if it is unknown.

    Readings are fitted by x(f N (N / N_last)^(m - 1)) with the course x.
    """
    from scipy.optimize import least_squares  # slow to import
    from scipy.special import stdtrit

    worn = observed.strokes > 0.0
    freedom = float(observed.freedom - 2)
    if len(np.unique(observed.strokes[worn])) < LEAST_READINGS or freedom < 1:
        return None
    last = float(observed.strokes.max())
    relative = np.log(np.where(worn, observed.strokes, last) / last)
    # A reading when new remains at 0 strokes whatever the exponent.
    powers = np.where(worn, relative, -np.inf)
    start = float(np.log(shape.strokes_until(observed.values.max()) / last))
    roots = np.sqrt(observed.weights)

    def residuals(unknown: Array) -> Array:
        logarithm, exponent = unknown
        growth = shape.at(last * np.exp(logarithm + exponent * powers)) - shape.new
        new = shape.new
        if observed.has_baseline:
            new = float((observed.values - growth) @ roots**2 / (roots @ roots))
        return np.asarray(roots * (observed.values - growth - new))

    guess = [float(np.clip(start, -_LOGARITHM_GUESS, _LOGARITHM_GUESS)), 1.0]
    fit = least_squares(residuals, guess, bounds=_BOUNDS, x_scale=[0.1, 0.1])
    information = fit.jac.T @ fit.jac
    if np.linalg.cond(information) > _SINGULAR:
        return None
    variance = 2.0 * float(fit.cost) / freedom
    if observed.errors is not None:
        freedom = math.inf
        variance = 1.0
    _, variance_of_exponent = np.diag(np.linalg.inv(information))
    error = math.sqrt(variance * float(variance_of_exponent))
    _, exponent = fit.x.tolist()
    doubt = float(stdtrit(freedom, 1.0 - 0.5 * _DOUBT)) * error
    value = Estimate.symmetric(exponent, quantile(freedom) * error)
    # Round-off of readings that are exact is no disagreement.
    return CourseExponent(value, abs(exponent - 1.0) > doubt + _ROUND_OFF)
