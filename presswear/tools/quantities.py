"""Quantities with unit, range and origin, and numbers with units as people type them."""

import math
import re
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from numbers import Integral, Real
from typing import Any, cast

from presswear.tools.errors import InputError, shown
from presswear.tools.numbers import short_number
from presswear.tools.units import UNITS, WRITTEN_IN

_SIGNS = str.maketrans({"²": "^2", "³": "^3", "μ": "µ", "·": " ", "*": " ", "_": " "})
_POWER = re.compile(r"(?<=[a-z])(?=[23]\b)")  # where a power has no sign, as in mm2
# Forms of numbers that are refused, by the advice in the message, and the table of characters
# that corrects them
_SEPARATED = {
    "use no separator of thousands": (
        r"\d{1,3}([,'’]\d{3})+(\.\d*)?",
        str.maketrans("", "", ",'’"),
    ),
    "use a decimal point": (
        r"(\d{1,3}(\.\d{3})+|\d*),\d+",
        str.maketrans(",", ".", "."),
    ),
}
_NUMBER = re.compile(
    r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*)$"
)


def plain_number(value: Any) -> Any:
    """Return a number of any kind as an int or a float; anything else as it is."""
    if type(value) in (float, str):  # most values; abstract classes are slow
        return value
    if isinstance(value, bool) or not isinstance(value, Real):
        return value
    try:
        number = float(value)
    except OverflowError:
        return math.inf if int(cast(Any, value)) > 0 else -math.inf
    return int(value) if isinstance(value, Integral) else number


@dataclass(frozen=True)
class Quantity:
    """Number of a user: unit, allowed range, origin and meaning."""

    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    origin: str = ""  # source of the default value
    text: str = ""  # meaning, in a help text
    open_low: bool = False  # the lower end is not allowed
    whole: bool = False  # the number is an integer
    size: float = 1.0  # size of the unit, SI

    def with_unit(self, value: str) -> str:
        """Return a value as text with the unit behind it."""
        return f"{value} {self.unit}".rstrip()

    def written(self, value: float, digits: int = 6) -> str:
        """Return a value with the unit in which engineers write it."""
        converted = self.in_unit_of(value)
        return converted.with_unit(f"{value / converted.size:.{digits}g}")

    def typeset(self, value: float) -> str:
        """Return a value as ``written`` does, with powers as signs: ``1.2·10⁻⁶ mm³/(N m)``."""
        texts, unit = self.texts(value)
        (text,) = texts
        return f"{text} {unit}".rstrip()

    def texts(self, *values: Any) -> tuple[list[str], str]:
        """Return values as text in the unit in which engineers write the largest, and that unit."""
        numbers = [abs(value) for value in values if isinstance(value, int | float)]
        converted = self.in_unit_of(max(numbers, default=0.0))
        texts = []
        for value in values:
            if isinstance(value, int | float):
                texts.append(short_number(value / converted.size))
            else:
                texts.append(str(value))
        return texts, converted.unit.replace("^2", "²").replace("^3", "³")

    def in_unit_of(self, value: float) -> "Quantity":
        """Return the quantity in the unit in which engineers write a value."""
        sizes = UNITS.get(self.unit, {self.unit: 1.0})
        units = WRITTEN_IN.get(self.unit, (self.unit,))
        unit = next((unit for unit in units if abs(value) >= sizes[unit]), units[-1])
        return self.in_unit(unit, sizes[unit])

    def in_unit(self, unit: str, size: float) -> "Quantity":
        """Return the quantity in a unit of a size, SI."""
        low = _twelve_digits(self.low / size)
        high = _twelve_digits(self.high / size)
        return replace(self, unit=unit, low=low, high=high, size=size)

    def range_text(self) -> str:
        """Return the allowed range in words, with the unit, its ends rounded inward."""
        if math.isinf(self.high) and math.isinf(self.low):
            return f"any finite number in {self.unit}".removesuffix(" in ")
        low = _six_digits(self.low, ROUND_CEILING)
        if math.isinf(self.high):
            bound = "above" if self.open_low else "at least"
            return self.with_unit(f"{bound} {low}")
        high = _six_digits(self.high, ROUND_FLOOR)
        if self.open_low:
            return self.with_unit(f"above {low} up to {high}")
        return self.with_unit(f"{low} to {high}")

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is a finite number in range."""
        kind = int if self.whole else (int, float)
        if not isinstance(value, kind) or isinstance(value, bool):
            number = "a whole number" if self.whole else "a number"
            allowed = f"{number} is expected; allowed is {self.range_text()}"
            raise InputError(f"{name} = {shown(value)}: {allowed}")
        is_above = self.low < value if self.open_low else self.low <= value
        if not (is_above and value <= self.high) or math.isinf(value):
            text = f"{value:g}"
            # The value is outside by less than six digits show.
            if self.low <= float(text) <= self.high:
                text = repr(value)
            raise InputError(
                f"{name} = {self.with_unit(text)}: allowed is {self.range_text()}"
            )

    def convert(self, name: str, value: Any) -> Any:
        """Return a number, SI, or a text with a unit as a number in range; raise InputError."""
        if isinstance(value, str):
            return parse_quantity(name, value, self)
        number = plain_number(value)
        self.check(name, number)
        return number if self.whole else float(number)


def written(value: float, unit: str) -> str:
    """Return an SI value in the unit in which engineers write it, in up to six digits."""
    return Quantity(unit).written(value)


def _twelve_digits(value: float) -> float:
    """Return a converted number without the round-off of its conversion."""
    return float(f"{value:.12g}")


def _six_digits(value: float, rounding: str) -> str:
    return f"{float(Context(6, rounding).create_decimal(repr(value))):g}"


def parse_quantity(name: str, text: str, meaning: Quantity) -> float | int:
    """Return a number, SI, from a text with its unit, and check its range.

    A quantity with a dimension needs its unit, except for 0: 0.8 could be metres or
    millimetres. ``m or rad`` has the units of both. A unit that the table lacks is the
    only one of its dimension.

    Raises
    ------
    InputError
        With the name, and the known units or the allowed range.
    """
    units: dict[str, float] = {}
    for unit in meaning.unit.split(" or "):
        units |= UNITS.get(unit, {unit: 1.0})
    label = f"{name} = {text!r}"
    _check_separators(label, text)
    allowed = f"allowed is {meaning.in_unit_of(meaning.low).range_text()}"
    match = _NUMBER.match(text)
    if match is None:
        expected = "a number with a unit" if meaning.unit else "a number"
        raise InputError(f"{label} is not {expected}; {allowed}")
    value = float(match[1])
    symbol = _POWER.sub("^", match[2].translate(_SIGNS))
    symbol = " ".join(symbol.split())
    if symbol.startswith("pi") and "rad" in meaning.unit:
        value *= math.pi
        symbol = symbol.removeprefix("pi").strip()
    unit_list = ", ".join(units)
    if meaning.unit and not symbol:
        if value != 0.0:
            raise InputError(f"{label} has no unit; known are {unit_list}; {allowed}")
        symbol = next(iter(units))
    if symbol not in units:
        fault = f"unknown unit {shown(symbol)}; known are {unit_list}"
        if not meaning.unit:
            percent = "" if meaning.whole else ", or one in %,"
            fault = f"a pure number{percent} is expected"
        raise InputError(f"{label}: {fault}")
    size = units[symbol]
    value *= size
    number: float | int = int(value) if meaning.whole and value.is_integer() else value
    try:
        meaning.check(name, number)
    except InputError:
        if meaning.unit:  # with the allowed range in the unit of the text
            meaning.in_unit(symbol, size).check(name, _twelve_digits(number / size))
        raise
    return number


def _check_separators(label: str, text: str) -> None:
    """Raise InputError if a number has a decimal comma or separators of thousands."""
    advice = []
    for words, (form, signs) in _SEPARATED.items():
        digits = re.match(rf"\s*[+-]?{form}(?![\d.,'’])", text, re.ASCII)
        if digits:
            mended = digits[0].translate(signs) + text[digits.end() :]
            advice.append(f"{words}, {mended!r}")
    if advice:
        raise InputError(f"{label}: {'; or '.join(advice)}")
