"""Check of a value against an annotation, without a conversion."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from presswear.tools.errors import InputError, shown
from presswear.tools.quantities import plain_number

# Types in messages
_WORDS: dict[Any, str] = {
    float: "finite number",
    int: "whole number",
    str: "text",
    bool: "True or False",
    NoneType: "None",
    tuple: "list",
    Sequence: "list",
    Mapping: "mapping",
}


def check_type(name: str, value: Any, kind: Any) -> None:
    """Raise InputError unless a value is of an annotated type; a text is not a number."""
    if not _is_of(name, value, kind):
        raise refusal(name, value, kind)


def _is_of(name: str, value: Any, kind: Any) -> bool:
    """Return whether a value is of an annotated type; InputError for one out of range."""
    origin = get_origin(kind) or kind
    inner = get_args(kind)
    if kind is Any:
        return True
    if origin in (Union, UnionType):
        if value is None:
            return NoneType in inner
        return any(_is_of(name, value, member) for member in inner)
    if origin is Annotated:
        quantity = inner[1]
        quantity.check(name, plain_number(value))
        return True
    if origin is Literal:
        return isinstance(value, str) and value in inner
    if kind in (float, int):
        number = plain_number(value)
        return isinstance(number, int | kind) and not isinstance(number, bool)
    if origin in (Sequence, tuple):
        if not is_list(value):
            return False
        kinds = inner
        if origin is not tuple or inner[-1] is Ellipsis:
            kinds = (inner[0],) * len(value)
        if len(value) != len(kinds):
            return False
        return all(map(partial(_is_of, name), value, kinds))
    if origin is Mapping:
        if not isinstance(value, Mapping):
            return False
        has_names = all(isinstance(key, str) for key in value)
        return has_names and all(
            _is_of(name, item, inner[1]) for item in value.values()
        )
    if origin is Callable:
        return callable(value)
    return isinstance(value, origin)


def is_list(value: Any) -> bool:
    """Return whether a value is a list, tuple, set or array; a text or mapping is not."""
    if isinstance(value, str | bytes | Mapping):
        return False
    # A numpy array without dimensions is a Collection, but a single number.
    return isinstance(value, Collection) and getattr(value, "ndim", 1) > 0


def _type_name(kind: Any) -> str:
    """Return the name of a type in messages."""
    if get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    plain = get_origin(kind) or kind
    return _WORDS.get(plain, plain.__name__)


def refusal(name: str, value: Any, kind: Any) -> InputError:
    """Return the error for a value that is not of an annotated type."""
    is_union = get_origin(kind) in (Union, UnionType)
    kinds = get_args(kind) if is_union else (kind,)
    names = [_type_name(member) for member in kinds]
    words = " or ".join(dict.fromkeys(names))
    article = "an" if words[0] in "AEIOU" else "a"
    examples = [member.example for member in kinds if hasattr(member, "example")]
    hint = f", such as {examples[0]}" if examples else ""
    return InputError(f"{name} = {shown(value)}: {article} {words} is expected{hint}")
