"""Distributions of uncertain values, as they are typed.

========================  =====================================================================
``0.2mm:1mm``             uniform between two ends
``uniform(0.2mm, 1mm)``   the same
``normal(0.8mm, 0.05mm)`` mean and standard deviation
``lognormal(1.2e-15/Pa,   median, and standard deviation over mean (the coefficient of
50%)``                    variation), with a percent sign; or
``lognormal(1.2e-15/Pa,   median, and the factor between which and its inverse two thirds
x1.6)``                   of the values lie about the median, with an x
``table(FILE.csv)``       values of a file, one a line, each with its unit, and its weight behind a
                          comma where they differ
========================  =====================================================================

Where a normal or lognormal distribution reaches outside the range that is allowed, it is cut off
there, and the rest takes its place; more than a twentieth is refused.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_checked
from presswear.tools.folders import check_file
from presswear.tools.numbers import readable
from presswear.tools.quantities import Quantity, parse_quantity

MOST_CUT = 0.05
"""Greatest probability that may lie outside the allowed range."""
_LEAST_TOLD = 1e-4
"""Probability below which what was cut off is not told."""
_EDGE = 2.0**-40
"""Nearest that a probability comes to 0 and 1, where a tail would be at infinity."""


@dataclass(frozen=True)
class Distribution:
    """The values that a factor may have, and how probable they are.

    Attributes
    ----------
    text : str
        As it was typed.
    inverse : callable
        From probabilities to the values, SI, below which so much lies, before it is cut.
    low, high : float
        Probabilities of the uncut distribution between which values are taken.
    """

    text: str
    inverse: Callable[[Array], Array]
    low: float = 0.0
    high: float = 1.0

    @property
    def cut(self) -> float:
        """Probability that was cut off with what is not allowed."""
        return self.low + 1.0 - self.high

    @property
    def described(self) -> str:
        """The distribution as a person reads it, with what was cut off."""
        if self.cut < _LEAST_TOLD:
            return self.text
        return f"{self.text}, cut off where values are not allowed ({readable(self.cut)} of it)"

    def at(self, u: Array) -> Array:
        """Values below which probabilities lie: the inverse cumulative distribution, SI.

        Parameters
        ----------
        u : ndarray, any shape
            From 0 to 1.
        """
        inside = np.clip(u, _EDGE, 1.0 - _EDGE)
        return np.asarray(self.inverse(self.low + (self.high - self.low) * inside), np.float64)


def parse(text: str, name: str, meaning: Quantity) -> Distribution:
    """Read a distribution of a quantity.

    Parameters
    ----------
    text : str
        See the head of this module.
    name : str
        Of the quantity, for messages.
    meaning : Quantity
        Its unit and range.

    Raises
    ------
    InputError
        Naming what is no distribution, of a whole number, or reaches where no value is allowed.
    """
    kind, bracket, rest = (part.strip() for part in text.strip().partition("("))
    if not bracket and ":" in text:
        kind, bracket, rest = "uniform", "(", f"{text.strip().replace(':', ',')})"
    if kind not in _KINDS and bracket:
        raise unknown(f"distribution of {name}", kind, _KINDS)
    if not bracket or not rest.endswith(")"):
        raise InputError(
            f"{name} = {text!r}: a distribution is expected, a range such as 1:2 or "
            f"{', '.join(f'{own}({shape})' for own, (shape, _) in _KINDS.items())}"
        )
    if meaning.whole and kind != "table":
        raise InputError(f"{name} = {text!r}: a whole number takes table(FILE.csv) only")
    shape, make = _KINDS[kind]
    words = [word.strip() for word in rest[:-1].split(",")]
    if len(words) != len(shape.split(",")):
        raise InputError(f"{name} = {text!r}: {kind}({shape}) is expected")
    return make(text.strip(), words, name, meaning)


def _uniform(text: str, words: list[str], name: str, meaning: Quantity) -> Distribution:
    from scipy import stats  # slow to import

    low, high = (float(parse_quantity(name, word, meaning)) for word in words)
    if not low < high:
        raise InputError(f"{name} = {text!r}: the first end is to be below the second")
    return Distribution(text, stats.uniform(low, high - low).ppf)


def _normal(text: str, words: list[str], name: str, meaning: Quantity) -> Distribution:
    from scipy import stats

    mean = float(parse_quantity(name, words[0], meaning))
    spread = Quantity(meaning.unit, 0.0, math.inf, "", "", open_low=True)
    sigma = float(parse_quantity(f"standard deviation of {name}", words[1], spread))
    return _cut(text, name, meaning, stats.norm(mean, sigma))


def _lognormal(text: str, words: list[str], name: str, meaning: Quantity) -> Distribution:
    from scipy import stats

    median = float(parse_quantity(name, words[0], meaning))
    if median <= 0.0:
        raise InputError(f"{name} = {text!r}: a median above 0 is expected")
    return _cut(text, name, meaning, stats.lognorm(_log_spread(words[1], name), scale=median))


def _log_spread(word: str, name: str) -> float:
    """Standard deviation of the logarithm, from a coefficient of variation or a factor."""
    above = Quantity("", 0.0, 1e4, "", "", open_low=True)
    if word.endswith("%"):
        told = parse_quantity(f"spread of {name}, %,", word[:-1], above)
        # Johnson, Kotz and Balakrishnan, Continuous Univariate Distributions 1, chapter 14.
        return math.sqrt(math.log1p((told / 100.0) ** 2))
    if word.startswith("x"):
        factor = Quantity("", 1.0, 1e4, "", "", open_low=True)
        return math.log(parse_quantity(f"factor of {name}", word[1:], factor))
    raise InputError(
        f"spread of {name} = {word!r}: a factor such as x1.6, or a standard deviation over the "
        "mean such as 50%, is expected"
    )


class _Known(Protocol):
    """A distribution of scipy, frozen."""

    def cdf(self, x: float) -> float: ...
    def ppf(self, q: Array) -> Array: ...


def _cut(text: str, name: str, meaning: Quantity, known: _Known) -> Distribution:
    """A distribution without what is not allowed; InputError where that is much."""
    low, high = float(known.cdf(meaning.low)), float(known.cdf(meaning.high))
    found = Distribution(text, known.ppf, low, high)
    if found.cut > MOST_CUT:
        raise InputError(
            f"{name} = {text!r}: {100.0 * found.cut:.3g} % of it lies outside what is allowed, "
            f"{meaning.range_text()}; at most {100.0 * MOST_CUT:g} % may be cut off"
        )
    return found


def _table(text: str, words: list[str], name: str, meaning: Quantity) -> Distribution:
    file = Path(words[0])
    check_file(file)
    try:
        lines = read_checked(file).decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise InputError(f"{file} is no text: {error}") from None
    rows = []
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            value, _, weight = (part.strip() for part in line.partition(","))
            try:
                rows.append(
                    (
                        float(parse_quantity(name, value, meaning)),
                        float(parse_quantity("weight", weight or "1", _WEIGHT)),
                    )
                )
            except InputError as error:
                raise InputError(f"{file}, line {number}: {error}") from None
    values, weights = np.array(sorted(rows)).reshape(-1, 2).T
    if len(values) < 2 or weights.sum() <= 0.0:
        raise InputError(f"{file}: two values at least are expected, with a weight above 0")
    ends = np.cumsum(weights) / weights.sum()
    return Distribution(text, partial(_stepped, values, ends))


def _stepped(values: Array, ends: Array, u: Array) -> Array:
    """Values in order, by the probabilities up to which each lasts."""
    return np.asarray(values[np.minimum(np.searchsorted(ends, u), len(values) - 1)])


_WEIGHT = Quantity("", 0.0, math.inf, "", "")
_KINDS: dict[str, tuple[str, Callable[[str, list[str], str, Quantity], Distribution]]] = {
    "uniform": ("LOW, HIGH", _uniform),
    "normal": ("MEAN, DEVIATION", _normal),
    "lognormal": ("MEDIAN, SPREAD", _lognormal),
    "table": ("FILE.csv", _table),
}
"""Arguments of each distribution, and how it is made."""
