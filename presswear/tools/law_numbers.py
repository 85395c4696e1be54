"""Numbers of a user law: parameters with a default, and perhaps a range as annotation.

``def fading(depth, coefficient, fade: "0.1 um to 1 mm" = 2e-6)`` has the number ``fade``.
The default is in SI.
"""

import ast
from typing import NamedTuple

from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.units import UNITS

_TO = " to "


class LawNumber(NamedTuple):
    """Number of a user law that a setting varies."""

    name: str
    default: float
    meaning: Quantity


def numbers_of(
    key: str, law: str, arguments: ast.arguments, allowed: tuple[str, ...]
) -> tuple[LawNumber, ...]:
    """Return the parameters of a function with a default that are not among ``allowed``.

    Raises
    ------
    InputError
        If a default is not a number in its range, or an annotation is not a range.
    """
    first = len(arguments.args) - len(arguments.defaults)
    numbers = []
    for argument, default in zip(
        arguments.args[first:], arguments.defaults, strict=True
    ):
        if argument.arg in allowed:
            continue
        name = f"{key}.{argument.arg}"
        meaning = _meaning_of(name, argument.annotation, f"number of {law}")
        try:
            value = ast.literal_eval(default)
        except ValueError:
            value = ast.unparse(default)
        if isinstance(value, str):
            raise InputError(f"{name} = {value}: a default must be a number, SI")
        numbers.append(
            LawNumber(argument.arg, float(meaning.convert(name, value)), meaning)
        )
    return tuple(numbers)


def _meaning_of(name: str, annotation: ast.expr | None, text: str) -> Quantity:
    """Return unit and range of a number from its annotation, such as ``0.1 um to 1 mm``."""
    # An annotation such as ``float`` has no range.
    if annotation is None or isinstance(annotation, ast.Name):
        return Quantity(origin="law", text=text)
    words = ""
    if isinstance(annotation, ast.Constant):
        words = f"{annotation.value!s}"
    first, separator, last = words.partition(_TO)
    if not separator:
        raise InputError(
            f"{name}: {ast.unparse(annotation)}: a range such as '0.1 um to 1 mm' is expected"
        )
    unit = _unit_of(last)
    low = parse_quantity(name, first, Quantity(unit))
    high = parse_quantity(name, last, Quantity(unit))
    if not low < high:
        raise InputError(f"{name}: {words}: the first end must be below the second")
    return Quantity(unit, low, high, "law", text)


def _unit_of(text: str) -> str:
    """Return the SI unit of a text such as ``1 mm``; an unknown unit is returned as it is."""
    symbol = text.strip().partition(" ")[2].strip()
    for unit, symbols in UNITS.items():
        if symbol in symbols:
            return unit
    return symbol
