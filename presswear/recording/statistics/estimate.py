"""Numbers with their 95 % confidence interval."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar, final

from presswear.tools.numbers import readable, with_interval
from presswear.tools.type_check import check_type

K = TypeVar("K")
LEVEL = 0.95
MIN_SAMPLES = 3  # samples needed for a bootstrap or an analysis of variance
# Largest ratio of the mean of a positive quantity and an end of its interval
MAX_FACTOR = 10.0


@final
@dataclass(frozen=True)
class Estimate:
    """Number with its 95 % confidence interval."""

    mean: float
    low: float | None = None  # end of the interval; None: too few samples
    high: float | None = None
    samples: int = 0  # cycles, batches of cycles or replicates behind it

    def __post_init__(self) -> None:
        check_type("mean", self.mean, float)
        check_type("low", self.low, float | None)
        check_type("high", self.high, float | None)
        check_type("samples", self.samples, int)

    @staticmethod
    def symmetric(
        mean: float, half_width: float | None, samples: int = 0
    ) -> "Estimate":
        """Return an estimate with an interval that is symmetric about the mean."""
        if half_width is None:
            return Estimate(mean, samples=samples)
        return Estimate(mean, mean - half_width, mean + half_width, samples)

    @property
    def half_width(self) -> float | None:
        """Half the length of the interval; None: too few samples."""
        if self.low is None or self.high is None:
            return None
        return 0.5 * (self.high - self.low)

    @property
    def positive(self) -> "Estimate":
        """Estimate of a positive quantity, with the interval of its logarithm (delta method).

        Without an interval if an end is more than ``MAX_FACTOR`` times away: too few
        samples.
        """
        half = self.half_width
        if half is None or self.mean <= 0.0:
            return self
        if half > self.mean * math.log(MAX_FACTOR):
            return self.without_interval
        factor = math.exp(half / self.mean)
        return Estimate(self.mean, self.mean / factor, self.mean * factor, self.samples)

    @property
    def has_interval(self) -> bool:
        """True if there is an interval that is not too wide.

        The ends of the interval of a positive quantity may differ by the square of
        ``MAX_FACTOR``.
        """
        if self.low is None or self.high is None:
            return False
        return not 0.0 < MAX_FACTOR**2 * self.low < self.high

    @property
    def without_interval(self) -> "Estimate":
        """Mean alone."""
        return Estimate(self.mean, samples=self.samples)

    def __str__(self) -> str:
        """Return the mean with its interval; ``±`` if the interval is nearly symmetric."""
        if self.low is None and self.samples >= MIN_SAMPLES:
            # The mean is over different motions, or the interval is too wide.
            return f"{readable(self.mean)} (no interval)"
        if not self.has_interval:
            return with_interval(self.mean, None)
        assert self.low is not None
        assert self.high is not None
        half = 0.5 * (self.high - self.low)
        if abs(0.5 * (self.low + self.high) - self.mean) <= 0.05 * half:
            return with_interval(self.mean, half)
        mean, *ends = (
            readable(number, 2) for number in (self.mean, self.low, self.high)
        )
        return f"{mean} ({' to '.join(ends)})"

    @property
    def with_ends(self) -> str:
        """Mean with both ends of its interval; alone if there is none or both read the same."""
        mean = readable(self.mean)
        if self.low is None or self.high is None:
            return mean
        low = readable(self.low)
        high = readable(self.high)
        return mean if low == high else f"{mean} ({low} to {high})"

    def scaled(self, factor: float) -> "Estimate":
        """Return the estimate in another unit; the factor is positive."""
        low, high = (
            None if end is None else factor * end for end in (self.low, self.high)
        )
        return Estimate(factor * self.mean, low, high, self.samples)


def greatest(estimates: Iterable[Estimate]) -> Estimate | None:
    """Return the estimate with the greatest mean; None without estimates."""
    return max(estimates, key=lambda estimate: estimate.mean, default=None)


def key_of_greatest(estimates: Mapping[K, Estimate]) -> K:
    """Return the key of the estimate with the greatest mean."""
    return max(estimates, key=lambda key: estimates[key].mean)


def weighted_sum(estimates: Sequence[Estimate], weights: Sequence[float]) -> Estimate:
    """Return the weighted sum of independent estimates; no interval if one of them has none."""
    terms = list(zip(estimates, weights, strict=True))
    mean = sum(weight * estimate.mean for estimate, weight in terms)
    half_widths = []
    for estimate, weight in terms:
        if estimate.half_width is None:
            return Estimate.symmetric(mean, None)
        half_widths.append(weight * estimate.half_width)
    return Estimate.symmetric(mean, math.hypot(*half_widths))


def ratio(first: Estimate, second: Estimate) -> Estimate:
    """Return the ratio of two independent estimates, with the interval of its logarithm.

    The ratio is that of the magnitudes. It has no interval if the interval of an
    estimate is missing or contains 0.
    """
    result = abs(first.mean / second.mean)
    halves = []
    for estimate in (first, second):
        low = estimate.low
        high = estimate.high
        if low is None or high is None or low * high <= 0.0:
            return Estimate(result)
        halves.append(0.5 * abs(math.log(high / low)))
    factor = math.exp(math.hypot(*halves))
    return Estimate(result, result / factor, result * factor)


def widened(estimate: Estimate, error: float) -> Estimate:
    """Return an estimate with an independent error added as the root of the sum of squares."""
    if estimate.low is None or estimate.high is None:
        return estimate
    mean, (below, above) = estimate.mean, (estimate.low, estimate.high)
    low = mean - math.copysign(math.hypot(mean - below, error), mean - below)
    high = mean + math.copysign(math.hypot(above - mean, error), above - mean)
    return replace(estimate, low=low, high=high)


def about(mean: float, estimate: Estimate) -> Estimate:
    """Return an estimate moved to another mean and widened by the distance."""
    off = mean - estimate.mean
    if estimate.low is None or estimate.high is None:
        return replace(estimate, mean=mean)
    return widened(
        Estimate(mean, estimate.low + off, estimate.high + off, estimate.samples), off
    )


def quantile(freedom: float) -> float:
    """Return Student's quantile at the upper end of an interval; the normal one for infinity."""
    # slow to import, and scipy.stats three times as slow
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + 0.5 * LEVEL))
