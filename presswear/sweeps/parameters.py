"""Parameters of a sweep: lists of values, distributions and designs, read from text."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswear.scene.fits import clearances_of, fit_of
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import Setting
from presswear.scene.value_ranges import values_of
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, shown, unknown
from presswear.tools.files import read_text
from presswear.tools.numbers import readable, unit_scale
from presswear.tools.quantities import Quantity, parse_quantity, plain_number

TOGETHER = "&"
MAX_CUT = 0.05  # probability that may lie outside the allowed range of a setting
# Smallest distance of a probability from 0 and 1, where a quantile may be infinite
TAIL = 2.0**-40
MORRIS_LEVELS = 4  # values that a parameter takes in a Morris design
MORRIS_JUMP = 0.5  # change of a parameter in a Morris design, in probability
# largest distance from the median in a one-at-a-time design, in probability
OAT_REACH = 0.45
Value = str | float | int


@dataclass(frozen=True)
class Column:
    """Column of the table of a sweep: a parameter or a response."""

    key: str  # as on the command line, such as A.friction or A.force_max
    unit: str  # SI; empty for a pure number
    text: str
    choices: tuple[str, ...] = ()  # words of a parameter; the table holds their indices
    whole: bool = False  # True: the values are whole numbers

    def setting(self, value: float) -> Value:
        """Return a value of the table as the value of a setting."""
        if self.choices:
            return self.choices[int(value)]
        return int(value) if self.whole else float(value)


class Display:
    """Column with its display unit, in which the largest value has few digits.

    ``factor`` times a value in SI units is the value in the display unit.
    """

    def __init__(self, column: Column, values: Array) -> None:
        self.column = column
        self.factor = 1.0
        self.unit = column.unit
        largest = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
        if largest > 0.0:
            self.factor, self.unit = unit_scale(column.unit, largest)
        self.label = f"{column.key} ({self.unit})" if self.unit else column.key

    def number(self, value: float, digits: int = 3) -> str:
        """Return a value in SI units as text in the display unit, without the unit."""
        if self.column.choices and not math.isnan(value):
            return self.column.choices[int(value)]
        return readable(self.factor * value, digits)

    def with_half_width(self, value: float, half: float, digits: int = 3) -> str:
        """Return a value with the half width of its interval, unless that is NaN."""
        interval = "" if math.isnan(half) else f" ± {self.number(half, 2)}"
        return f"{self.number(value, digits)}{interval}"

    def text(self, value: float) -> str:
        """Return a value in SI units as text with the display unit."""
        return f"{self.number(value)} {self.unit}".rstrip()


@dataclass(frozen=True)
class Group:
    """Parameters that vary together, with their values, shape (points, columns)."""

    columns: tuple[Column, ...]
    values: Array


def column_of(setting: Setting, choices: tuple[str, ...] = ()) -> Column:
    """Return the column of a setting."""
    meaning = setting.meaning
    is_whole = isinstance(meaning, Quantity) and meaning.whole
    return Column(setting.key, meaning.unit, meaning.text, choices, is_whole)


def parse_group(scene: Scene, text: str) -> Group:
    """Read one ``--vary`` option; `InputError` if a value is missing, repeated or out of range."""
    columns = []
    rows = []
    for assignment in text.split(TOGETHER):
        key, _, listed = map(str.strip, assignment.partition("="))
        if not listed:
            raise InputError(
                f"vary {text}: expected KEY=VALUES, such as friction=0.02,0.05"
            )
        setting = setting_of(scene, key)
        choices: tuple[str, ...] = ()
        if isinstance(setting.meaning, Quantity):
            values = values_of(key, listed, setting.meaning)
        else:
            choices = tuple(map(str.strip, listed.split(",")))
            values = list(map(float, range(len(choices))))
            for word in choices:
                setting.meaning.check(key, word)
        if len(set(choices or values)) < len(values) and TOGETHER not in text:
            raise InputError(f"vary {text}: a value is repeated")
        columns.append(column_of(setting, choices))
        rows.append(values)
    if len({len(values) for values in rows}) > 1:
        counts = " and ".join(str(len(values)) for values in rows)
        raise InputError(
            f"vary {text}: expected as many values of each key, got {counts}"
        )
    return Group(tuple(columns), np.array(rows, dtype=float).T)


def texts_of(scene: Scene, vary: Mapping[str, object]) -> tuple[str, ...]:
    """Return Python values of parameters as ``--vary`` texts.

    A value is a text as on the command line, or a list of numbers in SI units or of
    words; for several keys joined by ``&`` a list of rows.
    """
    texts = []
    for key, values in vary.items():
        if isinstance(values, str):
            texts.append(f"{key}={values}")
            continue
        keys = list(map(str.strip, key.split(TOGETHER)))
        rows = np.array(values, dtype=object)
        width = (len(keys),) if len(keys) > 1 else ()
        if rows.ndim == 0 or rows.size == 0 or rows.shape[1:] != width:
            expected = f"rows of {len(keys)} values" if width else "values"
            raise InputError(
                f"{key} = {shown(values)}: expected a text or a list of {expected}"
            )
        assignments = []
        for name, column in zip(keys, rows.reshape(len(rows), -1).T, strict=True):
            setting = setting_of(scene, name)
            listed = ",".join(_value_text(setting, value) for value in column)
            assignments.append(f"{name}={listed}")
        texts.append(f" {TOGETHER} ".join(assignments))
    return tuple(texts)


def _value_text(setting: Setting, value: object) -> str:
    if isinstance(value, str):
        return value
    number = plain_number(value)
    if type(number) not in (int, float) or not math.isfinite(number):
        raise InputError(
            f"{setting.key} = {shown(value)}: expected a finite number or a text"
        )
    return f"{number!r} {setting.meaning.unit}".strip()


@dataclass(frozen=True)
class Distribution:
    """Frozen distribution of `scipy.stats`, truncated to the allowed range of a parameter."""

    text: str
    frozen: Any
    low: float = 0.0  # cumulative probability at the lower end of the range
    high: float = 1.0

    def ppf(self, probability: Array) -> Array:
        """Return quantiles in SI units at probabilities from 0 to 1, any shape."""
        inside = np.clip(probability, TAIL, 1.0 - TAIL)
        return np.asarray(
            self.frozen.ppf(self.low + (self.high - self.low) * inside), np.float64
        )


ARGUMENTS = {
    "uniform": "LOW, HIGH",
    "normal": "MEAN, DEVIATION",
    "lognormal": "MEDIAN, SPREAD",
    "table": "FILE.csv",
}


def parse_distribution(text: str, key: str, meaning: Quantity) -> Distribution:
    """Read the distribution of a parameter.

    ``0.2mm:1mm`` is uniform; so is a fit with its diameter, ``110 H8/f7``, from its least
    to its largest clearance. A lognormal distribution has a median and a coefficient of
    variation, ``50%``, or a factor of one standard deviation of the logarithm,
    ``x1.6``. A line of ``table(FILE.csv)`` has a value with its unit, and optionally a
    weight after a comma. `InputError` if the text is not a distribution, or more than
    `MAX_CUT` of it is out of range.
    """
    fit = fit_of(text)
    if fit:
        if fit.diameter is None:
            raise InputError(
                f"{key} = {text}: a fit with its diameter is expected, such as 110 H8/f7"
            )
        least, largest = clearances_of(fit, fit.diameter)
        text = f"{least!r} m:{largest!r} m"
    kind, words = _kind_and_arguments(text, key)
    if meaning.whole and kind != "table":
        raise InputError(
            f"{key} = {text!r}: a whole number can only have table(FILE.csv)"
        )
    if len(words) != len(ARGUMENTS[kind].split(",")):
        raise InputError(f"{key} = {text!r}: expected {kind}({ARGUMENTS[kind]})")
    if kind == "table":
        return Distribution(text.strip(), _discrete(Path(words[0]), key, meaning))
    frozen = _frozen(kind, key, meaning, *words)
    low = float(frozen.cdf(meaning.low))
    high = float(frozen.cdf(meaning.high))
    outside = low + (1.0 - high)
    if outside > MAX_CUT:
        allowed = f"{meaning.range_text()}; at most {100.0 * MAX_CUT:g} % may"
        raise InputError(
            f"{key} = {text!r}: {100.0 * outside:.3g} % of it lies outside the allowed "
            f"range {allowed}"
        )
    return Distribution(text.strip(), frozen, low, high)


def _kind_and_arguments(text: str, key: str) -> tuple[str, list[str]]:
    """Return the kind and the arguments of a text such as ``normal(1 mm, 10 um)``.

    A range such as ``1:2`` is uniform.
    """
    kind, bracket, rest = map(str.strip, text.strip().partition("("))
    if not bracket and ":" in text:
        kind = "uniform"
        bracket = "("
        rest = f"{text.strip().replace(':', ',')})"
    if kind not in ARGUMENTS and bracket:
        raise unknown(f"distribution of {key}", kind, ARGUMENTS)
    if not bracket or not rest.endswith(")"):
        kinds = ", ".join(
            f"{name}({arguments})" for name, arguments in ARGUMENTS.items()
        )
        raise InputError(
            f"{key} = {text!r}: expected a range such as 1:2 or one of {kinds}"
        )
    return kind, list(map(str.strip, rest[:-1].split(",")))


def _frozen(kind: str, key: str, meaning: Quantity, text: str, spread: str) -> Any:
    """Return a frozen distribution of scipy.stats from its two arguments."""
    from scipy import stats  # slow to import

    def number_above(low: float, name: str, text: str, unit: str = "") -> float:
        return parse_quantity(name, text, Quantity(unit, low, math.inf, open_low=True))

    first = float(parse_quantity(key, text, meaning))
    if kind == "uniform":
        last = parse_quantity(key, spread, meaning)
        if not first < last:
            raise InputError(
                f"{key} = {text}, {spread}: the first end must be below the second"
            )
        return stats.uniform(first, last - first)
    if kind == "normal":
        name = f"standard deviation of {key}"
        return stats.norm(first, number_above(0.0, name, spread, meaning.unit))
    if first <= 0.0:
        raise InputError(f"{key} = {text}: the median must be positive")
    if spread.endswith("%"):
        name = f"coefficient of variation of {key}, %,"
        variation = number_above(0.0, name, spread[:-1]) / 100.0
        # Standard deviation of the logarithm: Johnson, Kotz and Balakrishnan, Continuous
        # Univariate Distributions 1, chapter 14
        deviation = math.sqrt(math.log1p(variation**2))
        return stats.lognorm(deviation, scale=first)
    if spread.startswith("x"):
        factor = number_above(1.0, f"factor of {key}", spread[1:])
        return stats.lognorm(math.log(factor), scale=first)
    allowed = "a factor such as x1.6 or a coefficient of variation such as 50%"
    raise InputError(f"spread of {key} = {spread!r}: expected {allowed}")


def _discrete(file: Path, key: str, meaning: Quantity) -> Any:
    """Return the discrete distribution of the values and weights of a file."""
    from scipy import stats

    rows = []
    for number, line in enumerate(read_text(file).splitlines(), start=1):
        without_comment = line.partition("#")[0]
        value, _, share = map(str.strip, without_comment.partition(","))
        if not value:
            continue
        try:
            weight = parse_quantity("weight", share or "1", Quantity("", 0.0, math.inf))
            rows.append((float(parse_quantity(key, value, meaning)), float(weight)))
        except InputError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
    values, weights = np.array(sorted(rows)).reshape(-1, 2).T
    if len(values) < 2 or weights.sum() <= 0.0:
        raise InputError(f"{file}: expected at least two values and a positive weight")
    return stats.rv_discrete(values=(values, weights / weights.sum()))


DESIGNS = ("sobol", "latin", "saltelli", "morris", "oat")


def design(kind: str, size: int, dimension: int, seed: int) -> Array:
    """Return the points of a design in the unit cube, shape (rows, dimension).

    ``sobol`` (scrambled Sobol' points) and ``latin`` (Latin hypercube) have `size`
    rows. ``saltelli``: points A, A with one column of B each, and B, ``size (d + 2)``
    rows (Saltelli et al., Computer Physics Communications 181, 2010, 259). ``morris``:
    trajectories on which each parameter changes once, ``size (d + 1)`` rows (Morris,
    Technometrics 33, 1991, 161). ``oat``: the middle, then each parameter alone in
    `size` steps to each side. The size is a power of two for ``sobol`` and
    ``saltelli``.
    """
    if kind not in DESIGNS:
        raise unknown("design", kind, DESIGNS)
    if size < 1 or dimension < 1:
        raise InputError(
            f"{kind}:{size}: expected a size and a number of parameters of at least 1"
        )
    if kind in ("sobol", "saltelli") and size & (size - 1):
        lower = 1 << (size.bit_length() - 1)
        raise InputError(
            f"{kind}:{size}: must be a power of two, {lower} or {2 * lower}"
        )
    random = np.random.default_rng(seed)
    if kind == "morris":
        return _morris(size, dimension, random)
    if kind == "oat":
        return _one_at_a_time(size, dimension)
    from scipy.stats import qmc  # slow to import

    if kind == "latin":
        return np.asarray(qmc.LatinHypercube(dimension, seed=random).random(size))
    width = dimension if kind == "sobol" else 2 * dimension
    if width > qmc.Sobol.MAXDIM:
        raise InputError(
            f"{kind}:{size}: {dimension} parameters are too many for Sobol' points"
        )
    points = np.asarray(qmc.Sobol(width, seed=random).random(size))
    if kind == "sobol":
        return points
    return _saltelli(points[:, :dimension], points[:, dimension:])


def _morris(size: int, dimension: int, random: np.random.Generator) -> Array:
    """Return trajectories on which each parameter changes once, in random order."""
    paths = np.empty((size, dimension + 1, dimension))
    for path in paths:
        start = random.integers(MORRIS_LEVELS, size=dimension)
        path[:] = (start + 0.5) / MORRIS_LEVELS
        for step, k in enumerate(random.permutation(dimension), start=1):
            is_low = start[k] < MORRIS_LEVELS // 2
            path[step:, k] += MORRIS_JUMP if is_low else -MORRIS_JUMP
    return paths.reshape(-1, dimension)


def _one_at_a_time(size: int, dimension: int) -> Array:
    """Return the middle of the cube, then each parameter alone in steps to both sides."""
    steps = OAT_REACH * np.arange(1, size + 1) / size
    deviations = np.concatenate([-steps[::-1], steps])
    rows = [np.full(dimension, 0.5)]
    for k in range(dimension):
        for deviation in deviations:
            row = np.full(dimension, 0.5)
            row[k] += deviation
            rows.append(row)
    return np.array(rows)


def _saltelli(first: Array, second: Array) -> Array:
    """Return A, A with one column of B each, and B, with the rows of each point together.

    ``first`` is A and ``second`` B, both of shape (size, dimension).
    """
    size, dimension = first.shape
    blocks = np.repeat(first[:, np.newaxis], dimension + 2, axis=1)
    for k in range(dimension):
        blocks[:, k + 1, k] = second[:, k]
    blocks[:, -1] = second
    return blocks.reshape(size * (dimension + 2), dimension)
