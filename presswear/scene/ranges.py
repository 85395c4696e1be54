"""Values of a quantity as they are typed: a list, or a range with its unit at each end or behind.

=============================  ==========================================================
``0.2mm:1.0mm:9``              nine values in equal steps, both ends among them
``2pi:12pi:200 rad/s``         the same, with the unit told once
``1e8N/m:1e10N/m:5:log``       five in equal ratios
``0.02,0.05,0.1``              a list
=============================  ==========================================================
"""

import numpy as np

from presswear.tools.errors import InputError
from presswear.tools.quantities import Meaning, parse_quantity

_DIGITS = 12
"""Digits of the values of a range: those of a finer one meet them."""
_MOST = 1_000_000
"""Values of a range."""


def values_of(key: str, text: str, meaning: Meaning) -> list[float]:
    """The values of a list or a range, SI, in the order in which they are typed.

    Raises
    ------
    InputError
        Naming the key, and what is missing, unknown or out of range.
    """
    if ":" not in text:
        return [float(parse_quantity(key, own.strip(), meaning)) for own in text.split(",")]
    low, high, steps, last = (*(own.strip() for own in text.split(":")), "", "", "")[:4]
    count, _, unit = steps.partition(" ")
    kind, _, behind = last.partition(" ")
    if text.count(":") not in (2, 3) or kind not in ("", "log"):
        raise InputError(f"{key} = {text}: FIRST:LAST:COUNT or FIRST:LAST:COUNT:log is expected")
    if not (count.isascii() and count.isdigit() and len(count) < 9 and 2 <= int(count) <= _MOST):
        raise InputError(f"{key} = {text}: a whole number of values from 2 to {_MOST} is expected")
    first, final = (
        float(parse_quantity(key, f"{own} {unit or behind}".strip(), meaning))
        for own in (low, high)
    )
    if first == final:
        raise InputError(f"{key} = {text}: two ends that differ are expected")
    if kind and min(first, final) <= 0.0:
        raise InputError(f"{key} = {text}: equal ratios need ends above 0")
    space = np.geomspace if kind else np.linspace
    values = [float(f"{own:.{_DIGITS}g}") for own in space(first, final, int(count))]
    for own in values:
        meaning.check(key, int(own) if meaning.whole and own.is_integer() else own)
    return values
