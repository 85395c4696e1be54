"""Estimate of a service life from its refinements, with the errors of scatter and of steps."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np

from presswear.campaign.refinement import Refinements
from presswear.campaign.wear_update import STEP_SAFETY
from presswear.recording.statistics import quantile
from presswear.scene.options import Limit
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# smallest ratio of the cycles of two refinements from which the error of steps is computed
MIN_REFINEMENT = 1.5


def finite(value: float) -> float | None:
    """Return a number, or None for one that is not finite."""
    return value if math.isfinite(value) else None


def scatter_of(scene: Scene) -> float:
    """Return the half width of ln(strokes) by the scatter of the wear coefficients.

    A life is inversely proportional to the wear coefficients, if all of them are high or
    low together.
    """
    scatters = [
        scene.bearing(joint).materials.wear_scatter for joint in scene.wearing_joints
    ]
    return quantile(math.inf) * math.sqrt(math.log1p(max(scatters) ** 2))


@dataclass(frozen=True)
class LifeEstimate:
    """Life, infinite if no limit was exceeded, and the errors of its logarithm."""

    strokes: float
    sampling: float  # half width over the histories
    step: float
    # weight of each refinement in the mean logarithm of the life, with sum 1
    weights: tuple[float, ...] = ()

    @property
    def error(self) -> float:
        """Root of the sum of squares of both errors."""
        return math.hypot(self.sampling, self.step)


def estimate_life(refinements: Refinements, limits: Sequence[Limit]) -> LifeEstimate:
    """Return the strokes after which the first of some limits is exceeded, with their errors.

    The logarithm of the life is the mean over the refinements, each weighted by its
    cycles. The error of the steps of a refinement decreases with one over its cycles,
    or faster.  If it is larger than the scatter in the last refinement, the estimate is
    that of the last refinement alone.
    """
    end = refinements[-1].crossing(limits)
    if not 0.0 < end < math.inf:
        return LifeEstimate(end, math.inf, math.inf)
    crossings = np.array([refinement.crossing(limits) for refinement in refinements])
    is_ended = (crossings > 0.0) & np.isfinite(crossings)
    ended = list(compress(refinements, is_ended))
    lives = crossings[is_ended]
    logarithms = np.log(lives)
    pairs = zip(ended, lives.tolist(), strict=True)
    cycles = np.array([refinement.cycles_until(life) for refinement, life in pairs])
    halves = np.array([refinement.sampling_error(limits) for refinement in ended])
    freedom = np.array([refinement.histories - 1 for refinement in ended])
    slope = _step_slope(cycles, logarithms)
    weights_of_last = (*np.zeros(len(refinements) - 1), 1.0)
    step_of_last = slope / float(cycles[-1])
    last = LifeEstimate(end, float(halves[-1]), step_of_last, weights_of_last)
    if not last.step < last.sampling < math.inf:
        return last
    weights = cycles / cycles.sum()
    strokes = math.exp(float(weights @ logarithms))
    step = slope * len(ended) / float(cycles.sum())
    sampling = _pooled_half_width(weights, halves, freedom)
    all_weights = np.zeros(len(refinements))
    all_weights[is_ended] = weights
    return LifeEstimate(strokes, sampling, step, tuple(all_weights.tolist()))


def _pooled_half_width(weights: Array, halves: Array, freedom: Array) -> float:
    """Return the half width of a weighted mean of independent estimates.

    Its degrees of freedom are those of Welch and Satterthwaite.
    """
    if np.isinf(halves).any():
        return math.inf
    variances = (weights * halves / [quantile(degrees) for degrees in freedom]) ** 2
    variance = float(variances.sum())
    joint_freedom = variance**2 / float((variances**2 / freedom).sum())
    return quantile(joint_freedom) * math.sqrt(variance)


def _step_slope(cycles: Array, logarithms: Array) -> float:
    """Return the error of the step of a refinement times its cycles; infinite if it is unknown.

    It is twice the slope of the logarithms over one over the cycles, by least squares
    with the cycles as weights.
    """
    if cycles.min() * MIN_REFINEMENT > cycles.max():
        return math.inf
    slope, _ = np.polyfit(1.0 / cycles, logarithms, 1, w=np.sqrt(cycles))
    return STEP_SAFETY * abs(float(slope))
