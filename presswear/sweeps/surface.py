"""Response surfaces: a Gaussian process through the points of a sweep, and how well it predicts.

The process (Rasmussen and Williams, Gaussian processes for machine learning, chapters 2 and 5; by
scikit-learn) has a length of its own for each factor, and a nugget for chaos.  Each point is
predicted from all others, which follows from the matrix of covariances in closed form
(Sundararajan and Keerthi, Neural Computation 13, 2001); the surface is refused where that explains
too little of what chaos leaves to be explained.

A lower bound, such as a life that was followed no further, is taken for the mean of what lies
above it by the prediction from all other points, again and again until it stands still (after
Tobin 1958).
"""

import math
import warnings
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from presswear.sweeps.inputs import Inputs
from presswear.sweeps.responses import Responses
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, not_installed

Scale = Literal["linear", "logarithmic"]

LEAST_EXPLAINED = 0.5
"""Part of the variance, less the chaos, that predictions from all other points must explain."""
LEAST_AT_ALL = 0.1
"""Part of the whole variance that they must explain: less may be chance."""
LEAST_A_FACTOR = 5
"""Points for each factor below which no surface is drawn."""
MOST_POINTS = 2000
"""Points beyond which the matrix of a process is too large."""
MOST_LEARNED = 400
"""Points, evenly spaced in their order, that lengths are learned from; it takes seconds."""
MOST_BOUNDS = 0.3
"""Part of the points that may be lower bounds."""
_PASSES = 50
_LEARNED_AGAIN = 3
"""Times that lengths are learned from lower bounds that were lifted."""
_STILL = 1e-3
"""Change of lower bounds, standard deviations, at which they stand still."""


@dataclass(frozen=True)
class LeftOut:
    """Each point as all others predict it, in units of the scale.

    Attributes
    ----------
    means, deviations : ndarray, shape (n,)
        Of the predictions, chaos included.
    explained : float
        Part of the variance that they explain; below 0 where the mean of the others does better.
    density : float
        Sum of the logarithms of their densities.
    wide : float
        Root mean square error over the deviations: above 1 the surface is too sure of itself.
    """

    means: Array
    deviations: Array
    explained: float
    density: float
    wide: float


@dataclass(frozen=True)
class Surface:
    """A measure over its factors.

    Attributes
    ----------
    own : Responses
        That it was drawn through, all with a value.
    inputs : Inputs
    scale : str
        The measure itself, or its logarithm, is normal.
    centre, unit : float
        Mean and standard deviation of the scaled measure.
    process : Process
        Of coordinates, in units of the scale.
    nugget : float
        Variance of one run about the surface, in units of the scale: its chaos, and what the
        surface misses.
    left_out : LeftOut
    """

    own: Responses
    inputs: Inputs
    scale: Scale
    centre: float
    unit: float
    process: "Process"
    nugget: float
    left_out: LeftOut

    def predicted(self, points: Array) -> tuple[Array, Array]:
        """Mean of the scaled measure over all chaos and its standard deviation, shape (n,) each."""
        mean, covariance = self._posterior(points)
        return mean, np.sqrt(np.maximum(np.diagonal(covariance), 0.0))

    def mean(self, points: Array) -> Array:
        """Mean of the scaled measure over all chaos, shape (n,)."""
        return self.centre + self.unit * self.process.mean(self.inputs.at(points))

    def level(self, points: Array) -> Array:
        """The measure itself at points, shape (n,): the median of a logarithmic one."""
        return self.unscaled(self.mean(points))

    def draws(self, points: Array, count: int, random: np.random.Generator) -> Array:
        """Surfaces that the points allow, at other points, shape (count, n), scaled.

        They lie as far apart as the points are from what all others predict of them.
        """
        mean, covariance = self._posterior(points)
        sizes, ways = np.linalg.eigh(covariance)
        roots = ways * np.sqrt(np.maximum(sizes, 0.0))
        return np.asarray(mean + random.standard_normal((count, len(mean))) @ roots.T)

    @property
    def chaos(self) -> float:
        """Standard deviation of one run about the surface, scaled."""
        return self.unit * math.sqrt(self.nugget)

    def unscaled(self, scaled: Array) -> Array:
        """The measure itself from the scaled one."""
        return np.exp(scaled) if self.scale == "logarithmic" else scaled

    def _posterior(self, points: Array) -> tuple[Array, Array]:
        mean, covariance = self.process.at(self.inputs.at(points))
        wide = max(self.left_out.wide, 1.0)
        return self.centre + self.unit * mean, (self.unit * wide) ** 2 * covariance


class _Kernel(Protocol):
    """A covariance of scikit-learn."""

    def __call__(self, x: Array, y: Array | None = None) -> Array: ...


@dataclass(frozen=True)
class Process:
    """A Gaussian process of mean zero through values with noise.

    Attributes
    ----------
    kernel : callable
        Covariances of the surface between coordinates.
    coordinates : ndarray, shape (n, c)
    values, noise : ndarray, shape (n,)
        The noise is a variance.
    """

    kernel: _Kernel
    coordinates: Array
    values: Array
    noise: Array

    def inverse(self) -> Array:
        """Inverse of the matrix of covariances of the values, shape (n, n)."""
        covariances = self.kernel(self.coordinates) + np.diag(self.noise)
        return np.asarray(np.linalg.inv(covariances), np.float64)

    def mean(self, coordinates: Array) -> Array:
        """Mean elsewhere, shape (m,)."""
        matrix = self.kernel(self.coordinates) + np.diag(self.noise)
        return self.kernel(coordinates, self.coordinates) @ np.linalg.solve(matrix, self.values)

    def at(self, coordinates: Array) -> tuple[Array, Array]:
        """Mean, shape (m,), and covariances, (m, m), of the surface without noise elsewhere."""
        across = self.kernel(coordinates, self.coordinates)
        matrix = self.kernel(self.coordinates) + np.diag(self.noise)
        solved = np.linalg.solve(matrix, np.column_stack([self.values, across.T]))
        return across @ solved[:, 0], self.kernel(coordinates) - across @ solved[:, 1:]

    def left_out(self) -> tuple[Array, Array]:
        """Mean and variance of each value as all others predict it, shape (n,) each."""
        inverse = self.inverse()
        diagonal = np.diagonal(inverse)
        return self.values - inverse @ self.values / diagonal, 1.0 / diagonal


def surface(own: Responses) -> Surface:
    """The response surface of a measure, of itself or of its logarithm, whichever predicts better.

    Raises
    ------
    InputError
        Saying why there is none.
    """
    name = own.measure.key
    kept = own.only(own.has_value)
    count, dimension = kept.points.shape
    if count < LEAST_A_FACTOR * dimension:
        raise InputError(
            f"no response surface of {name}: {count} points have a value, "
            f"{LEAST_A_FACTOR * dimension} at least are needed for {dimension} factors"
        )
    if count > MOST_POINTS:
        raise InputError(
            f"no response surface of {name}: {count} points are more than {MOST_POINTS}"
        )
    bounds = int(np.count_nonzero(kept.is_beyond))
    if bounds > MOST_BOUNDS * count:
        raise InputError(
            f"no response surface of {name}: {bounds} of {count} points are lower bounds only; "
            f"at most {MOST_BOUNDS:.0%} may be"
        )
    if np.ptp(kept.means) == 0.0:
        raise InputError(f"no response surface of {name}: it is the same at every point")
    scales: tuple[Scale, ...] = ("linear", "logarithmic") if kept.means.min() > 0.0 else ("linear",)
    found = max((fitted(kept, scale) for scale in scales), key=lambda one: one.left_out.density)
    most = 1.0 - noise_share(found)
    needed = max(LEAST_EXPLAINED * most, LEAST_AT_ALL)
    if found.left_out.explained < needed:
        raise InputError(
            f"no response surface of {name}: predicted from all others, the points explain "
            f"{max(found.left_out.explained, 0.0):.0%} of its variance, of which chaos leaves "
            f"{most:.0%}; at least {needed:.0%} is needed"
        )
    return found


def noise_share(found: Surface) -> float:
    """Share of the variance of the points that draws, or intervals of runs, say is chaos.

    Intervals that are wider than the runs differ say nothing: 0.
    """
    own = found.own
    scaled, noise = _scaled(own, found.scale)
    share = float(noise.mean() / scaled.var(ddof=1))
    return 0.0 if share >= 1.0 and own.noise_source == "intervals" else min(share, 1.0)


def _scaled(own: Responses, scale: Scale) -> tuple[Array, Array]:
    """The measure on its scale, and the variance that is told of it, shape (n,) each."""
    if scale == "logarithmic":
        return np.log(own.means), own.noise / own.means**2
    return own.means, own.noise


def fitted(own: Responses, scale: Scale) -> Surface:
    """The surface of a measure on a scale, good or bad; all points are to have a value."""
    scaled, told = _scaled(own, scale)
    centre, unit = float(scaled.mean()), float(scaled.std(ddof=1))
    inputs = Inputs.of(own.factors, own.points)
    coordinates, values = inputs.at(own.points), (scaled - centre) / unit
    process = _learned(coordinates, values)
    if own.is_beyond.any():
        process = _beyond(process, values, own)
    nugget = float(process.noise.mean())
    if own.noise_source == "draws":
        # The mean over draws scatters less than one of them; what a surface misses does not.
        one, mean = (float(part.mean()) / unit**2 for part in (told * own.counts, told))
        nugget = max(nugget, mean) + one - mean
    left_out = _left_out(process, values, own, scale, unit)
    return Surface(own, inputs, scale, centre, unit, process, nugget, left_out)


def _learned(coordinates: Array, values: Array) -> Process:
    """The process whose lengths and nugget make the values most likely."""
    try:
        from sklearn.exceptions import ConvergenceWarning  # slow to import
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
        from threadpoolctl import threadpool_limits  # with scikit-learn
    except ImportError:
        raise not_installed("a response surface", "scikit-learn", "sweep") from None

    # Smooth, but not endlessly so; within a hundredth and a hundred ranges.
    shape = Matern(np.ones(coordinates.shape[1]), (1e-2, 1e2), nu=2.5)
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * shape + WhiteKernel(0.1, (1e-8, 1e1))
    learner = GaussianProcessRegressor(kernel, n_restarts_optimizer=1, random_state=1)
    count = len(values)
    picked = np.unique(np.linspace(0, count - 1, min(count, MOST_LEARNED)).round().astype(int))
    # Matrices so small take longer on several threads, which wait on each other.
    with threadpool_limits(1), warnings.catch_warnings():
        # A length at its bound is a factor that does nothing.
        warnings.simplefilter("ignore", ConvergenceWarning)
        learner.fit(coordinates[picked], values[picked])
    smooth, white = learner.kernel_.k1, float(learner.kernel_.k2.noise_level)
    return Process(smooth, coordinates, values, np.full(count, white))


def _beyond(process: Process, bounds: Array, own: Responses) -> Process:
    """The process through values of which some are lower bounds."""
    from scipy.special import log_ndtr

    for _ in range(_LEARNED_AGAIN):
        values = process.values
        for _ in range(_PASSES):
            mean, variance = process.left_out()
            deviation = np.sqrt(variance)
            z = (bounds - mean) / deviation
            # Mean of a normal distribution above a bound: the inverse ratio of Mills.
            mills = np.exp(-0.5 * z**2 - 0.5 * math.log(2.0 * math.pi) - log_ndtr(-z))
            values = np.where(own.is_beyond, mean + deviation * mills, bounds)
            moved = float(np.abs(values - process.values).max())
            process = replace(process, values=values)
            if moved < _STILL:
                break
        process = _learned(process.coordinates, values)
    return process


def _left_out(
    process: Process, values: Array, own: Responses, scale: Scale, unit: float
) -> LeftOut:
    """Leave each point out; those that are lower bounds tell nothing of the error."""
    means, variances = process.left_out()
    told = ~own.is_beyond
    off = (values - means)[told]
    count = len(off)
    # The mean of all others is what a surface has to beat.
    base = (values[told] - values[told].mean()) * count / max(count - 1, 1)
    density = -0.5 * (off**2 / variances[told] + np.log(2.0 * math.pi * unit**2 * variances[told]))
    if scale == "logarithmic":
        density = density - np.log(own.means[told])
    return LeftOut(
        means,
        np.sqrt(variances),
        1.0 - float(off @ off) / float(base @ base),
        float(density.sum()),
        float(np.sqrt(np.mean(off**2 / variances[told]))),
    )
