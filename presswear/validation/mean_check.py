"""Check of a mean over cycles of two engines, by the interval of the difference."""

import math
from statistics import NormalDist

from presswear.recording.statistics import Estimate
from presswear.tools.numbers import readable
from presswear.validation.cases import Check

MEAN_BOUND = 0.1  # of the relative difference of two means


def mean_check(
    quantity: str, first: Estimate, second: Estimate, count: int = 1
) -> Check | str:
    """Check the relative difference of two means, or say that their intervals are too wide.

    The check passes if the 95 % interval of the difference lies within ``MEAN_BOUND``.
    It misses if the interval lies beyond it that holds for all of ``count`` comparisons
    with 95 % (Bonferroni). Otherwise there is no verdict. The checked number is the end
    of the interval that decides.
    """
    size = 0.5 * (abs(first.mean) + abs(second.mean))
    if first.half_width is None or second.half_width is None or size == 0.0:
        return f"mean {quantity}: no verdict, too few cycles"
    difference = abs(first.mean - second.mean) / size
    half = math.hypot(first.half_width, second.half_width) / size
    if difference + half <= MEAN_BOUND:
        return Check(f"mean {quantity}", difference + half, MEAN_BOUND, "relative")
    quantile = NormalDist().inv_cdf
    of_all = half * quantile(1.0 - 0.025 / count) / quantile(0.975)
    if difference - of_all > MEAN_BOUND:
        return Check(f"mean {quantity}", difference - of_all, MEAN_BOUND, "relative")
    parts = f"{readable(100.0 * difference, 2)} ± {readable(100.0 * half, 2)} %"
    return f"mean {quantity}: no verdict, difference {parts}"
