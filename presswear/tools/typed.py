"""Whether a data class made of stored data holds what its annotations say."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

LARGEST = 1e300
"""Beyond this a number is damage: sums and units would overflow."""


def misfits(owner: Any) -> Iterator[str]:
    """Names of the fields of a data class instance, and of those in it, of a wrong kind.

    A number is an ``int`` or a ``float`` of a size that can be computed with, never True or
    False; a ``float`` may be nan or infinite, which stand for what is not known or bounded.
    """
    kinds = get_type_hints(type(owner))
    for item in fields(owner):
        value = getattr(owner, item.name)
        if not fits(value, kinds[item.name]):
            yield item.name
        elif is_dataclass(value):
            yield from (f"{item.name}.{inner}" for inner in misfits(value))


def fits(value: Any, kind: Any) -> bool:
    """Whether a value is of a kind that annotations name; of data classes only which it is."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind is Any:
        return True
    if origin in (UnionType, Union):
        return any(fits(value, one) for one in inner)
    if origin is Literal:
        return any(type(value) is type(word) and value == word for word in inner)
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        if inner[-1] is Ellipsis:
            return all(_fits_wholly(item, inner[0]) for item in value)
        return len(value) == len(inner) and all(map(_fits_wholly, value, inner))
    if origin is not None and issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(
            fits(key, inner[0]) and _fits_wholly(item, inner[1]) for key, item in value.items()
        )
    if kind is NoneType:
        return value is None
    if kind is float:
        return _is_number(value, int | float)
    if kind is int:
        return _is_number(value, int)
    return isinstance(value, kind)


def _fits_wholly(value: Any, kind: Any) -> bool:
    return fits(value, kind) and not (is_dataclass(value) and next(misfits(value), None))


def _is_number(value: Any, kind: Any) -> bool:
    if isinstance(value, bool) or not isinstance(value, kind):
        return False
    return abs(value) <= LARGEST or (isinstance(value, float) and not math.isfinite(value))
