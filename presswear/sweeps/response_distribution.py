"""Distribution of a response over the points of a sample."""

from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import LEVEL
from presswear.sweeps.plan import Table
from presswear.sweeps.response_limits import ResponseLimit
from presswear.tools.arrays import Array

PROBABILITIES = np.arange(1, 100) / 100.0  # probabilities of the quantiles
# Probabilities at the ends of an interval
LOWER_END = 0.5 - 0.5 * LEVEL
UPPER_END = 0.5 + 0.5 * LEVEL
ENDS = (LOWER_END, UPPER_END)


@dataclass(frozen=True)
class Spread:
    """Distribution of a response: quantiles at `PROBABILITIES` with their 95 % intervals."""

    source: str
    values: Array  # shape (99,); NaN if unknown
    low: Array
    high: Array
    # probability of a violation of the limit, with the ends of its interval
    violation: tuple[float, float, float] | None


def spread_of_rows(
    table: Table, key: str, limit: ResponseLimit | None = None
) -> Spread | None:
    """Return the distribution of a response over the first replicates of a sample.

    Intervals of quantiles are those of order statistics (David and Nagaraja, Order
    Statistics, section 7.1), the interval of a probability is by Clopper and Pearson
    (1934). A censored value may be any larger value: intervals contain all possibilities.
    None if no point has a value.
    """
    from scipy import stats

    column = table.index(key)
    values = table.values[:: table.replicates, column]
    censored = table.censored[:: table.replicates, column][np.isfinite(values)]
    values = values[np.isfinite(values)]
    count = len(values)
    if count == 0:
        return None
    # Smallest and largest possible values in order
    least = np.sort(values)
    most = np.sort(np.where(censored, np.inf, values))
    # Places in the order at which the interval of a quantile begins and ends
    first = stats.binom.ppf(LOWER_END, count, PROBABILITIES).astype(int)
    last = stats.binom.ppf(UPPER_END, count, PROBABILITIES).astype(int)
    place = np.ceil(count * PROBABILITIES).astype(int) - 1
    low = np.where(first > 0, least[first - 1], np.nan)
    high = np.where(last < count, most[np.minimum(last, count - 1)], np.nan)
    violation = None
    if limit is not None:
        fewest, greatest = limit.count(values, censored)
        violation = (
            0.5 * (fewest + greatest) / count,
            float(stats.binomtest(fewest, count).proportion_ci(LEVEL).low),
            float(stats.binomtest(greatest, count).proportion_ci(LEVEL).high),
        )
    middle = np.where(least[place] == most[place], least[place], np.nan)
    high = np.where(np.isinf(high), np.nan, high)
    return Spread("by the runs alone", middle, low, high, violation)
