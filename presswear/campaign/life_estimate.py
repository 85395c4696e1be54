"""Estimate of a service life from its refinements, with the errors of scatter and of steps."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from presswear.campaign.refinement import Refinements
from presswear.campaign.wear_update import STEP_SAFETY
from presswear.recording.statistics import quantile
from presswear.scene.options import Limit
from presswear.tools.arrays import Array

# smallest ratio of the cycles of two refinements from which the error of steps is computed
MIN_REFINEMENT = 1.5


@dataclass(frozen=True)
class LifeEstimate:
    """Life, infinite if no limit was exceeded, and the errors of its logarithm."""

    strokes: float
    sampling: float  # half width over the histories
    step: float
    # of the logarithm of each refinement in that of the life, with sum 1
    weights: tuple[float, ...] = ()

    @property
    def error(self) -> float:
        """Root of the sum of squares of both errors."""
        return math.hypot(self.sampling, self.step)


def estimate_life(refinements: Refinements, limits: Sequence[Limit]) -> LifeEstimate:
    """Return the strokes after which the first of some limits is exceeded, with their errors.

    The logarithm of the life is the mean over the refinements, each weighted by its
    cycles.  The error of the steps of a refinement decreases with one over its cycles,
    or faster.  If it is larger than the scatter in the last refinement, the estimate is
    that of the last refinement alone.
    """
    end = refinements[-1].crossing(limits)
    if not 0.0 < end < math.inf:
        return LifeEstimate(end, math.inf, math.inf)
    is_ended = np.array(
        [0.0 < item.crossing(limits) < math.inf for item in refinements]
    )
    ended = [
        item for item, has_end in zip(refinements, is_ended, strict=True) if has_end
    ]
    logarithms = np.log([item.crossing(limits) for item in ended])
    cycles = np.array([item.cycles_until(item.crossing(limits)) for item in ended])
    halves = np.array([item.sampling_error(limits) for item in ended])
    freedom = np.array([item.histories - 1 for item in ended])
    slope = _step_slope(cycles, logarithms)
    alone = (*np.zeros(len(refinements) - 1), 1.0)
    last = LifeEstimate(end, float(halves[-1]), slope / float(cycles[-1]), alone)
    if not last.step < last.sampling < math.inf:
        return last
    weights = cycles / cycles.sum()
    strokes = math.exp(float(weights @ logarithms))
    step = slope * len(ended) / float(cycles.sum())
    sampling = _pooled_half_width(weights, halves, freedom)
    each = np.zeros(len(refinements))
    each[is_ended] = weights
    return LifeEstimate(strokes, sampling, step, tuple(each.tolist()))


def _pooled_half_width(weights: Array, halves: Array, freedom: Array) -> float:
    """Return the half width of a weighted mean of independent estimates.

    Its degrees of freedom are those of Welch and Satterthwaite.
    """
    if np.isinf(halves).any():
        return math.inf
    variances = (weights * halves / [quantile(each) for each in freedom]) ** 2
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
    slope = np.polyfit(1.0 / cycles, logarithms, 1, w=np.sqrt(cycles))[0]
    return STEP_SAFETY * abs(float(slope))
