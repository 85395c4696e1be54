"""Comparison of a mean over cycles between two engines, by the interval of the difference."""

import math
from statistics import NormalDist

from presswear.recording.statistics import Estimate
from presswear.tools.numbers import readable
from presswear.validation.cases import Check

MEAN_BOUND = 0.1  # largest relative difference of two means


def mean_check(
    quantity: str, first: Estimate, second: Estimate, count: int = 1
) -> Check | str:
    """Return the check of the relative difference of two means, or a text without a verdict.

    The check passes if the 95 % interval of the difference lies within ``MEAN_BOUND``.
    It fails if a wider interval lies beyond ``MEAN_BOUND``: the interval that holds for
    all of ``count`` comparisons with 95 % (Bonferroni). If neither is true, the intervals
    are too wide for a verdict. The checked number is the end of the interval that is
    compared with the bound.
    """
    size = 0.5 * (abs(first.mean) + abs(second.mean))
    if first.half_width is None or second.half_width is None or size == 0.0:
        return f"mean {quantity}: no verdict, too few cycles"
    difference = abs(first.mean - second.mean) / size
    half_width = math.hypot(first.half_width, second.half_width) / size
    upper = difference + half_width
    if upper <= MEAN_BOUND:
        return Check(f"mean {quantity}", upper, MEAN_BOUND, "relative")
    quantile = NormalDist().inv_cdf
    lower = difference - half_width * quantile(1.0 - 0.025 / count) / quantile(0.975)
    if lower > MEAN_BOUND:
        return Check(f"mean {quantity}", lower, MEAN_BOUND, "relative")
    interval = (
        f"{readable(100.0 * difference, 2)} ± {readable(100.0 * half_width, 2)} %"
    )
    return f"mean {quantity}: no verdict, difference {interval}"
