"""Values of a setting as a list or a range."""

import re

import numpy as np

from presswear.scene.fits import clearances_of, fit_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import (
    Quantity,
    parse_quantity,
)

# A list that begins like a number with a decimal comma, such as 0,1mm
_COMMA = re.compile(r"(?:^|,)(0,\d+)(\s*[^\d\s.,])", re.ASCII)
_MAX_VALUES = 1_000_000  # largest number of values of a range
# Significant digits of the values of a range. Equal values of a coarse and of a fine
# range are then equal to the last bit.
_DIGITS = 12
# FIRST:LAST:COUNT UNIT:log UNIT; both units and the logarithm can be left out
_RANGE = re.compile(
    r"\s*(?P<first>[^:]+?)\s*:\s*(?P<last>[^:]+?)\s*:\s*(?P<count>[0-9]{1,8})"
    r"(?: (?P<unit>[^:]+?))?\s*"
    r"(?::\s*(?P<log>log)(?: (?P<unit_after_log>[^:]+))?\s*)?$"
)


def values_of(key: str, text: str, meaning: Quantity) -> list[float]:
    """Return the values of a list or a range, SI, in the order in which they are typed.

    Examples of a list are ``0.02,0.05,0.1`` and ``2 mm,3 mm``. A range has both ends and
    a number of values, in equal steps, such as ``2pi:12pi:200 rad/s``, or in equal
    ratios, such as ``1e8N/m:1e10N/m:5:log``. A fit with its diameter and a number of
    values, such as ``110 H8/f7:5``, is the range of its clearances.

    Raises
    ------
    InputError
        With the key, for a text of another form and for a value out of range.
    """
    fit_text, _, count_text = text.rpartition(":")
    if fit := fit_of(fit_text):
        if fit.diameter is None or not count_text.strip().isdigit():
            raise InputError(
                f"{key} = {text}: a fit with its diameter and a number of values is expected, "
                "such as 110 H8/f7:5"
            )
        least, largest = clearances_of(fit, fit.diameter)
        text = f"{least!r} m:{largest!r} m:{count_text}"
    if ":" in text:
        return _values_of_range(key, text, meaning)
    _check_commas(key, text, meaning)
    texts = map(str.strip, text.split(","))
    return [float(parse_quantity(key, number, meaning)) for number in texts]


def _check_commas(key: str, text: str, meaning: Quantity) -> None:
    """Raise InputError if a 0 without unit in a list may be the digit before a decimal comma."""
    if meaning.unit and _COMMA.search(text):
        point = _COMMA.sub(lambda zero: zero[0].replace("0,", "0."), text)
        raise InputError(
            f"{key} = {text}: use a decimal point, {point}; a 0 of a list needs its unit here"
        )


def _values_of_range(key: str, text: str, meaning: Quantity) -> list[float]:
    """Return the values of a range, SI."""
    match = _RANGE.match(text)
    if match is None:
        raise InputError(
            f"{key} = {text}: FIRST:LAST:COUNT or FIRST:LAST:COUNT:log is expected"
        )
    count = int(match["count"])
    if not 2 <= count <= _MAX_VALUES:
        raise InputError(
            f"{key} = {text}: a number of values from 2 to {_MAX_VALUES} is expected"
        )
    unit = match["unit"] or match["unit_after_log"] or ""
    first = float(parse_quantity(key, f"{match['first']} {unit}".strip(), meaning))
    last = float(parse_quantity(key, f"{match['last']} {unit}".strip(), meaning))
    if first == last:
        raise InputError(f"{key} = {text}: two ends that differ are expected")
    if match["log"] and min(first, last) <= 0.0:
        raise InputError(f"{key} = {text}: equal ratios need ends above 0")
    space = np.geomspace if match["log"] else np.linspace
    values = [float(f"{value:.{_DIGITS}g}") for value in space(first, last, count)]
    for value in values:
        is_whole = meaning.whole and value.is_integer()
        meaning.check(key, int(value) if is_whole else value)
    return values
