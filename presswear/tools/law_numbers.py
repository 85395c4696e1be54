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

    InputError with the key for a default that is no number in its range, and for an
    annotation that is no range.
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
    if annotation is None or isinstance(annotation, ast.Name):
        return Quantity(origin="law", text=text)
    words = f"{annotation.value!s}" if isinstance(annotation, ast.Constant) else ""
    first, to, last = words.partition(_TO)
    if not to:
        raise InputError(
            f"{name}: {ast.unparse(annotation)}: a range such as '0.1 um to 1 mm' is expected"
        )
    unit = _unit_of(last)
    low, high = (parse_quantity(name, end, Quantity(unit)) for end in (first, last))
    if not low < high:
        raise InputError(f"{name}: {words}: the first end must be below the second")
    return Quantity(unit, low, high, "law", text)


def _unit_of(text: str) -> str:
    """Return the SI unit of a text with a number and a unit; an unknown unit is returned."""
    symbol = text.strip().partition(" ")[2].strip()
    return next((unit for unit, sizes in UNITS.items() if symbol in sizes), symbol)
