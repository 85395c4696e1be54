"""Spread of a measure when its factors scatter: quantiles and the probability of a miss.

Two ways.  From a response surface, over the distributions of the factors: its own error, by draws
of the surfaces that the points allow, is in the interval, and chaos is one more thing that
scatters.  From the rows alone, where they are a sample of the distributions: the interval is that
of order statistics, which holds for any distribution (David and Nagaraja, Order statistics,
section 7.1); rows that are evenly spread know it better than it says.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.recording.statistics import LEVEL, Estimate
from presswear.sweeps.designs import design
from presswear.sweeps.distributions import Distribution
from presswear.sweeps.surface import Surface
from presswear.sweeps.table import Column, Table
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, parse_quantity

PROBABILITIES = np.arange(1, 100) / 100.0
"""Those for which values are told."""
POINTS = 1024
"""Of the distributions at which a surface is read."""
DRAWS = 400
"""Surfaces that are drawn: an end of an interval scatters by a tenth of its width."""
_ENDS = (0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL)


@dataclass(frozen=True)
class Required:
    """A value that a measure is not to miss.

    Attributes
    ----------
    is_least : bool
        True where less is a miss, as of a life; False where more is, as of a force.
    """

    value: float
    is_least: bool

    def missed(self, values: Array) -> NDArray[np.bool_]:
        """True for each value that misses it."""
        return values < self.value if self.is_least else values > self.value

    def counted(self, values: Array, is_beyond: NDArray[np.bool_]) -> tuple[int, int]:
        """How many values miss it for sure, and how many may where some are lower bounds."""
        is_missed = self.missed(values)
        # What lies beyond a bound may hold where the bound misses, and miss where the bound holds.
        is_open = is_beyond & (is_missed == self.is_least)
        surely = int(np.count_nonzero(is_missed & ~is_open))
        return surely, surely + int(np.count_nonzero(is_open))


def parse_required(text: str, measures: Sequence[Column]) -> tuple[str, Required]:
    """Read what is required of a measure, such as ``life>=2e6`` or ``A.force_max<=15kN``.

    Returns
    -------
    key : str
    required : Required

    Raises
    ------
    InputError
        For another form, a measure that is none, or a value without its unit.
    """
    for sign, is_least in ((">=", True), ("<=", False)):
        key, found, value = (part.strip() for part in text.partition(sign))
        if found:
            columns = {column.key: column for column in measures}
            if key not in columns:
                raise unknown("measure", key, columns)
            free = Quantity(columns[key].unit, -math.inf, math.inf, "", "")
            return key, Required(float(parse_quantity(key, value, free)), is_least)
    raise InputError(
        f"required {text!r}: MEASURE>=VALUE or MEASURE<=VALUE is expected, such as life>=2e6"
    )


def requirements(texts: Sequence[str], measures: Sequence[Column]) -> dict[str, Required]:
    """What is required, by the key of its measure; InputError where one is required twice."""
    found: dict[str, Required] = {}
    for text in texts:
        key, required = parse_required(text, measures)
        if key in found:
            raise InputError(f"required {text!r}: something is required of {key} already")
        found[key] = required
    return found


@dataclass(frozen=True)
class Spread:
    """Distribution of a measure, with 95 % intervals.

    Attributes
    ----------
    values, low, high : ndarray, shape (99,)
        Values below which the measure lies with each of ``PROBABILITIES``, and the ends of their
        intervals; NaN for an end that cannot be told.
    misses : Estimate or None
        Probability of missing what is required; None where nothing is.
    used : int
        Points or rows it is from.
    """

    values: Array
    low: Array
    high: Array
    misses: Estimate | None
    used: int

    def quantile(self, percent: int) -> Estimate:
        """The value below which a whole percentage of the measure lies."""
        told = (float(own[percent - 1]) for own in (self.values, self.low, self.high))
        value, low, high = (None if np.isnan(own) else own for own in told)
        return Estimate(np.nan if value is None else value, low, high)


def spread_of_surface(
    found: Surface,
    distributions: Sequence[Distribution],
    required: Required | None = None,
    *,
    chaos: bool = True,
    seed: int = 1,
) -> Spread:
    """The spread of a measure by its response surface.

    Parameters
    ----------
    distributions : sequence of Distribution
        Of each factor of the surface.
    chaos : bool
        True: of single runs; False: of what runs at a point are on average.
    """
    from scipy.special import ndtri

    cube = design("sobol", POINTS, len(distributions) + 1, seed)
    points = np.column_stack([own.at(u) for own, u in zip(distributions, cube.T, strict=False)])
    drawn = found.draws(points, DRAWS, np.random.default_rng(seed))
    if chaos:
        drawn = drawn + found.chaos * ndtri(np.clip(cube[:, -1], 1e-12, 1.0 - 1e-12))
    values = found.unscaled(drawn)
    levels = np.quantile(values, PROBABILITIES, axis=1)
    low, middle, high = np.quantile(levels, (_ENDS[0], 0.5, _ENDS[1]), axis=1)
    misses = None
    if required is not None:
        parts = required.missed(values).mean(axis=1)
        misses = Estimate(float(np.median(parts)), *np.quantile(parts, _ENDS).tolist())
    return Spread(middle, low, high, misses, len(found.own.means))


def spread_of_rows(table: Table, key: str, required: Required | None = None) -> Spread | None:
    """The spread of a measure by the first draws of a sample of the distributions.

    A lower bound may be any value above it: an interval holds all that it may be, and a value that
    depends on it is not told.  None where no row has a value.
    """
    from scipy.stats import binom

    place = table.place(key)
    kept = (table.draws == 0) & np.isfinite(table.values[:, place])
    values, beyond = table.values[kept, place], table.is_beyond[kept, place]
    count = len(values)
    if count == 0:
        return None
    least, most = np.sort(values), np.sort(np.where(beyond, np.inf, values))
    first = binom.ppf(_ENDS[0], count, PROBABILITIES).astype(int)
    last = binom.ppf(_ENDS[1], count, PROBABILITIES).astype(int)
    at = np.ceil(count * PROBABILITIES).astype(int) - 1
    low = np.where(first > 0, least[first - 1], np.nan)
    high = np.where(last < count, most[np.minimum(last, count - 1)], np.nan)
    known = least[at] == most[at]
    misses = None if required is None else _missed(required, values, beyond)
    return Spread(
        np.where(known, least[at], np.nan),
        low,
        np.where(np.isinf(high), np.nan, high),
        misses,
        count,
    )


def _missed(required: Required, values: Array, beyond: NDArray[np.bool_]) -> Estimate:
    """Part of the rows that miss, with the interval of Clopper and Pearson (1934)."""
    from scipy.stats import binomtest

    surely, perhaps = required.counted(values, beyond)
    low = binomtest(surely, len(values)).proportion_ci(LEVEL).low
    high = binomtest(perhaps, len(values)).proportion_ci(LEVEL).high
    return Estimate(0.5 * (surely + perhaps) / len(values), float(low), float(high))
