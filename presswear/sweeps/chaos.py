"""Chaos: which share of the variance of a measure is scatter of runs at one and the same point.

Beyond some twenty impacts a run is one draw of many, and several draws at each point, which
differ by their ``seed`` alone, tell how far draws scatter.  A random effects model of one way
(Searle, Casella and McCulloch, Variance components, chapter 3) parts the variance of a run in
that of the points and that of the draws at a point.
"""

import numpy as np

from presswear.recording.statistics import LEAST_SAMPLES, Estimate
from presswear.sweeps.estimates import jackknife
from presswear.sweeps.responses import Responses
from presswear.tools.arrays import Array


def chaos_share(own: Responses) -> Estimate | None:
    """Share of the variance of one run that is chaos, with its interval.

    The interval is Student's, by the jackknife over points, of the logarithm of the ratio F of
    both mean squares: neither the points nor the draws need to be normal.  The points are to be
    independent of each other.  Where each ran once, the intervals that runs tell are taken for the
    scatter of draws.  None where fewer than three points have values, where nothing tells the
    scatter, and where intervals are wider than the runs differ: few cycles and starts make them so.
    """
    kept = own.only(own.has_value)
    count = len(kept.means)
    if count < LEAST_SAMPLES or not kept.variances.any() or np.ptp(kept.means) == 0.0:
        return None
    if own.noise_source == "intervals":
        return _told_share(kept) if kept.noise.mean() < kept.means.var(ddof=1) else None
    draws = kept.counts
    free = draws - 1.0
    # About their mean, so that squares of large numbers do not cancel.
    means = kept.means - kept.means.mean()
    terms = np.column_stack(
        [draws, draws * means, draws * means**2, free * kept.variances, free, draws**2]
    )
    more = count / (count - 1.0)

    def logarithm(mean: Array) -> Array:
        total, first, second, within, freedom, _ = np.moveaxis(mean, -1, 0)
        between = more * (second - first**2 / total)
        return np.log(between * freedom / within)[..., None]

    value, half = jackknife(terms, logarithm)
    total, squares = terms[:, 0].sum(), terms[:, 5].sum()
    typical = (total - squares / total) / (count - 1.0)

    def share(log_ratio: float) -> float:
        # Below 1 the points differ by less than their draws make them: chaos is all there is.
        return float(1.0 / (1.0 + max(np.exp(log_ratio) - 1.0, 0.0) / typical))

    middle, width = float(value[0]), float(half[0])
    return Estimate(share(middle), share(middle + width), share(middle - width))


def _told_share(own: Responses) -> Estimate:
    """Mean of the variances that single runs tell, over the variance of the runs."""
    off = own.means - own.means.mean()
    terms = np.column_stack([own.variances, off, off**2])

    def logarithm(mean: Array) -> Array:
        told, first, second = np.moveaxis(mean, -1, 0)
        return np.log(told / (second - first**2))[..., None]

    value, half = jackknife(terms, logarithm)
    low, middle, high = np.minimum(np.exp(value + half * np.array([-1.0, 0.0, 1.0])), 1.0)
    return Estimate(float(middle), float(low), float(high))
