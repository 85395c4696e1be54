"""Wear coefficient of a joint from readings: general path model with one random effect.

At a known shape x of the wear over strokes a coefficient of f times that of the scene
wears as x(f N), because a life is inversely proportional to the coefficient. A reading
is the sum of x(f N) and of a normal error. The prior of ln f is normal. Its posterior
is computed on a grid (Lu and Meeker, 1993; Gebraeel and others, 2005).
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.tools.arrays import Array

MOST = 14.0  # largest |ln f|: a factor of a million
_COARSE = 2801  # nodes of the grid over all f
_FINE = 401  # nodes over the f that have a density
_DENSITY = 1e-10  # relative density below which f is left out
# standard deviations; 99 % of readings agree with the prior within them
CONFLICT = 2.58
MISFIT = 0.05  # probability of residuals below which errors are widened
LEAST_SCATTER = 0.01  # scatter of the prior for a scene without a scatter
_TAIL = 3  # part of the shape, from its end, that gives the slope beyond it: a third
_ROUND_OFF = 1e-9  # smallest error of readings, part of the largest growth


@dataclass(frozen=True)
class Shape:
    """Computed course of a quantity of a joint over strokes."""

    strokes: Array  # shape (n,), from 0, increasing
    values: Array  # m, or m^3

    @staticmethod
    def of(strokes: Array, values: Array, new: float) -> "Shape":
        """Return the course from a new value on, without decreases by scatter."""
        levels = np.maximum.accumulate(np.append(new, values))
        return Shape(np.append(0.0, strokes), levels)

    @property
    def new(self) -> float:
        """Value of the new joint."""
        return float(self.values[0])

    @property
    def slope(self) -> float:
        """Mean slope of the last third, by which the shape goes on beyond its end."""
        end = float(self.strokes[-1])
        start = end * (1.0 - 1.0 / _TAIL)
        level = float(np.interp(start, self.strokes, self.values))
        return (float(self.values[-1]) - level) / (end - start)

    def at(self, strokes: Array) -> Array:
        """Return the value after some strokes."""
        beyond = np.maximum(strokes - self.strokes[-1], 0.0)
        value = np.interp(strokes, self.strokes, self.values)
        return np.asarray(value + self.slope * beyond)

    def strokes_until(self, value: Array) -> Array:
        """Return the strokes after which a value is reached; infinite if it never is."""
        beyond = np.maximum(value - self.values[-1], 0.0)
        strokes = np.interp(value, self.values, self.strokes)
        with np.errstate(divide="ignore", invalid="ignore"):
            more = np.where(beyond > 0.0, beyond / self.slope, 0.0)
        return np.asarray(strokes + more)


@dataclass(frozen=True)
class Observed:
    """Readings of a joint."""

    strokes: Array
    values: Array
    errors: Array | None  # standard deviations; None: unknown, equal for all
    has_baseline: bool  # the value when new is read, too, and not that of the scene

    @property
    def weights(self) -> Array:
        """Weights of the squares of residuals."""
        return np.ones_like(self.values) if self.errors is None else self.errors**-2.0

    @property
    def freedom(self) -> int:
        """Readings less the value when new, if it is fitted."""
        return len(self.values) - int(self.has_baseline)

    def squares(self, shape: Shape, logarithms: Array) -> tuple[Array, Array]:
        """Return the weighted squares of residuals for each ln f, and the value when new."""
        scaled = np.exp(logarithms)[:, np.newaxis] * self.strokes
        growth = shape.at(scaled) - shape.new
        new = np.full(len(logarithms), shape.new)
        if self.has_baseline:
            new = (self.values - growth) @ self.weights / self.weights.sum()
        residuals = self.values - growth - new[:, np.newaxis]
        return residuals**2 @ self.weights, new


@dataclass(frozen=True)
class Posterior:
    """Posterior of the wear coefficient of a joint relative to that of the scene."""

    logarithms: Array  # ln f, shape (n,)
    probabilities: Array  # sum 1
    new: Array  # value of the new joint for each f
    new_error: float = 0.0  # standard deviation of this value
    has_prior: bool = True  # False: the readings contradict the prior
    widening: float = 1.0  # factor on the errors, because residuals exceed them
    misfit: float = 1.0  # probability of residuals as large as these

    def quantiles(self, levels: Array) -> Array:
        """Return quantiles of f."""
        below = np.cumsum(self.probabilities) - 0.5 * self.probabilities
        return np.exp(np.interp(levels, below, self.logarithms))


def prior_of(scatter: float) -> Posterior:
    """Return the distribution without readings, for a coefficient of variation."""
    deviation = _deviation(scatter)
    grid = np.linspace(-6.0 * deviation, 6.0 * deviation, _FINE)
    density = np.exp(-0.5 * (grid / deviation) ** 2)
    return Posterior(grid, density / density.sum(), np.zeros(_FINE))


def posterior_of(shape: Shape, observed: Observed, scatter: float) -> Posterior:
    """Return the posterior of the wear coefficient of a joint.

    Where the readings contradict the prior, they are used alone. Where residuals are
    larger than the errors of the readings explain (``MISFIT``), the errors are widened
    by Birge's ratio. Errors that are unknown are integrated over, with Jeffreys' prior.

    Parameters
    ----------
    shape : Shape
        Computed course of the quantity that is read.
    observed : Observed
    scatter : float
        Coefficient of variation of the wear coefficient.
    """
    deviation = _deviation(scatter)
    grid = np.linspace(-MOST, MOST, _COARSE)
    best, steepness = _best_fit(shape, observed, grid)
    misfit, widening = _widening(shape, observed, best)
    uncertainty = widening * steepness
    has_prior = abs(best) <= CONFLICT * math.hypot(deviation, uncertainty)

    def density(logarithms: Array) -> Array:
        squares, _ = observed.squares(shape, logarithms)
        exponent = -0.5 * squares / widening**2
        if observed.errors is None:
            smallest_error = _ROUND_OFF * float(np.abs(observed.values).max())
            floor = len(observed.values) * smallest_error**2
            exponent = -0.5 * observed.freedom * np.log(squares + floor)
        if has_prior:
            exponent = exponent - 0.5 * (logarithms / deviation) ** 2
        return np.asarray(np.exp(exponent - exponent.max()))

    for _ in range(3):  # accurate readings leave a narrow density
        dense = np.flatnonzero(density(grid) > _DENSITY)
        first = max(dense[0] - 1, 0)
        last = min(dense[-1] + 1, len(grid) - 1)
        grid = np.linspace(grid[first], grid[last], _FINE)
    final = density(grid)
    _, new = observed.squares(shape, grid)
    error = _new_error(shape, observed, best) if observed.has_baseline else 0.0
    return Posterior(
        grid,
        final / final.sum(),
        new,
        new_error=widening * error,
        has_prior=has_prior,
        widening=widening,
        misfit=misfit,
    )


def _deviation(scatter: float) -> float:
    """Return the standard deviation of ln f for a coefficient of variation of f."""
    return max(math.sqrt(math.log1p(scatter**2)), LEAST_SCATTER)


def _best_fit(shape: Shape, observed: Observed, grid: Array) -> tuple[float, float]:
    """Return the ln f of least squares and its standard deviation, infinite if unknown."""
    for _ in range(3):
        squares, _ = observed.squares(shape, grid)
        k = int(np.argmin(squares))
        best = float(grid[k])
        low = grid[max(k - 1, 0)]
        high = grid[min(k + 1, len(grid) - 1)]
        grid = np.linspace(low, high, _FINE)
    step = 1e-3
    ends, _ = observed.squares(shape, best + step * np.array([-1.0, 0.0, 1.0]))
    curvature = 0.5 * float(ends[0] - 2.0 * ends[1] + ends[2]) / step**2
    variance = 1.0
    if observed.errors is None:
        variance = float(ends[1]) / max(observed.freedom - 1, 1)
    if curvature <= 0.0:
        return best, math.inf
    return best, math.sqrt(variance / curvature)


def _widening(shape: Shape, observed: Observed, best: float) -> tuple[float, float]:
    """Return the probability of residuals as large as these, and Birge's ratio, 1 or more."""
    freedom = observed.freedom - 1
    if observed.errors is None or freedom < 1:
        return 1.0, 1.0
    from scipy.special import chdtrc  # slow to import

    squares, _ = observed.squares(shape, np.array([best]))
    misfit = float(chdtrc(freedom, squares[0]))
    ratio = math.sqrt(float(squares[0]) / freedom)
    return misfit, ratio if misfit < MISFIT else 1.0


def _new_error(shape: Shape, observed: Observed, best: float) -> float:
    """Return the standard deviation of the value of the new joint at a known f."""
    squares, _ = observed.squares(shape, np.array([best]))
    variance = 1.0
    if observed.errors is None:
        variance = float(squares[0]) / max(observed.freedom - 1, 1)
    return math.sqrt(variance / float(observed.weights.sum()))
