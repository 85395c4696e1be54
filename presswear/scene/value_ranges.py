"""Values of a setting as a list or a range."""

import re

import numpy as np

from presswear.scene.fits import clearances_of, fit_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import (
    Quantity,
    parse_quantity,
)

_MAX_VALUES = 1_000_000  # of a range
_DIGITS = 12  # of the values of a range: those of a finer range meet them
_RANGE = re.compile(
    r"\s*([^:]+?)\s*:\s*([^:]+?)\s*:\s*([0-9]{1,8})(?: ([^:]+?))?\s*(?::\s*(log)(?: ([^:]+))?\s*)?$"
)


def values_of(key: str, text: str, meaning: Quantity) -> list[float]:
    """Return the values of a list or a range, SI, in the order in which they are typed.

    A list is as ``0.02,0.05,0.1``. A range has both ends and a number of values, in
    equal steps as ``2pi:12pi:200 rad/s``, or in equal ratios as
    ``1e8N/m:1e10N/m:5:log``. InputError with the key.
    """
    fit_text, _, count_text = text.rpartition(":")
    if fit := fit_of(fit_text):
        if fit.diameter is None or not count_text.strip().isdigit():
            raise InputError(
                f"{key} = {text}: a fit with its diameter and a number of values is expected, "
                "such as 110 H8/f7:5"
            )
        least, largest = clearances_of(fit, fit.diameter)
        return values_of(key, f"{least!r} m:{largest!r} m:{count_text}", meaning)
    if ":" not in text:
        return [
            float(parse_quantity(key, part.strip(), meaning))
            for part in text.split(",")
        ]
    match = _RANGE.match(text)
    if match is None:
        raise InputError(
            f"{key} = {text}: FIRST:LAST:COUNT or FIRST:LAST:COUNT:log is expected"
        )
    low, high, count, unit, log, unit_behind = match.groups("")
    if not 2 <= int(count) <= _MAX_VALUES:
        raise InputError(
            f"{key} = {text}: a number of values from 2 to {_MAX_VALUES} is expected"
        )
    first, final = (
        float(parse_quantity(key, f"{end} {unit or unit_behind}".strip(), meaning))
        for end in (low, high)
    )
    if first == final:
        raise InputError(f"{key} = {text}: two ends that differ are expected")
    if log and min(first, final) <= 0.0:
        raise InputError(f"{key} = {text}: equal ratios need ends above 0")
    space = np.geomspace if log else np.linspace
    values = [
        float(f"{value:.{_DIGITS}g}") for value in space(first, final, int(count))
    ]
    for value in values:
        meaning.check(
            key, int(value) if meaning.whole and value.is_integer() else value
        )
    return values
