"""What a person hands over to a class or a function: settled by its annotations, or refused."""

import inspect
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache, partial, wraps
from itertools import repeat
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from presswear.tools.errors import InputError, nearest, shown, unknown
from presswear.tools.quantities import NAMING, meaning_of

F = TypeVar("F", bound=Callable[..., Any])

LARGEST = 1e15
"""Of any number, SI: that of the stiffest contact; nothing of a machine is beyond."""

_WORDS: dict[Any, str] = {
    float: "finite number",
    int: "whole number",
    str: "text",
    bool: "True or False",
    NoneType: "None",
    Callable: "function",
    np.ndarray: "list of numbers",
}


class _Meant:
    """The kind of a field that says itself what is allowed; see ``quantities.check_fields``."""


def checked(made: F) -> F:
    """Check whatever a class is made of, or a function is called with, by its annotations.

    A sequence becomes a tuple, and a number of any kind one of Python's own.  InputError names
    an argument that is unknown, missing or of a wrong kind; a range is told by its field.
    """
    is_class = isinstance(made, type)
    function: Callable[..., Any] = cast(Any, made).__init__ if is_class else made
    signature, label = inspect.signature(function), made.__name__
    known = [name for name in signature.parameters if name != "self"]

    @cache
    def kinds() -> dict[str, Any]:
        found = get_type_hints(made)
        for item in fields(cast(Any, made)) if is_dataclass(made) else ():
            is_choice = "choice" in item.metadata and get_origin(item.type) is not Literal
            if is_choice or meaning_of(item) is not None:
                found[item.name] = _Meant
        return found

    @wraps(function)
    def settling(*given: Any, **named: Any) -> Any:
        for name in named:
            if name not in known:
                raise unknown(f"argument of {label}", name, known)
        try:
            bound = signature.bind(*given, **named)
        except TypeError as error:
            raise InputError(f"{label}: {error}") from None
        arguments = bound.arguments
        owner = arguments.get(known[0]) if known[0] in NAMING else None
        for name in arguments.keys() & set(known):
            whose = f" of {owner}" if isinstance(owner, str) and name != known[0] else ""
            arguments[name] = _settled(name, whose, arguments[name], kinds().get(name, Any))
        return function(*bound.args, **bound.kwargs)

    if not is_class:
        return cast(F, settling)
    cast(Any, made).__init__ = settling
    return made


def _settled(name: str, whose: str, value: Any, kind: Any) -> Any:
    """A value as its kind has it; InputError names its place and whose it is."""
    origin, inner = get_origin(kind) or kind, get_args(kind)
    refusal = InputError(f"{name}{whose} = {shown(value)}: a {_word(kind)} is expected")
    if kind is Any:
        return value
    if kind is _Meant:
        return _number(value)
    if origin in (Union, UnionType):
        return _one_of(name, whose, value, inner, refusal)
    if origin in (tuple, Sequence):
        return _rows(name, whose, value, kind, refusal)
    if origin is np.ndarray:
        try:
            return np.array(value, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise refusal from None
    if kind in (float, int):
        number = _number(value)
        if isinstance(number, bool) or not isinstance(number, int | kind):
            raise refusal
        if not -LARGEST <= number <= LARGEST:
            raise InputError(f"{refusal}, {LARGEST:g} at most")
        return kind(number)
    fits = isinstance(value, Mapping if origin is Mapping else object)
    if origin is Literal:
        fits = isinstance(value, str) and value in inner
        near = nearest(f"{value}", inner)
        refusal = InputError(f"{name}{whose} = {shown(value)}: allowed is {_word(kind)}{near}")
    elif origin is Callable:
        fits = callable(value)
    elif origin is not Mapping:
        fits = isinstance(value, origin)
    if not fits:
        raise refusal
    if origin is Mapping:
        settled = partial(_settled, whose=whose)
        return {
            settled(f"name in {name}", value=key, kind=inner[0]): settled(
                f"{name}.{key}", value=own, kind=inner[1]
            )
            for key, own in value.items()
        }
    return value


def _number(value: Any) -> Any:
    """A number of any kind as one of Python's; anything else as it is."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return value
    try:
        return int(value) if isinstance(value, Integral) else float(value)
    except OverflowError:
        return math.inf


def _one_of(name: str, whose: str, value: Any, kinds: Sequence[Any], refusal: InputError) -> Any:
    """A value of one of some kinds."""
    if isinstance(value, Real) and not isinstance(value, bool) and float in kinds:
        return _settled(name, whose, value, float)
    for kind in kinds:
        try:
            return _settled(name, whose, value, kind)
        except InputError as error:
            # Where the whole is of this kind but a part is not, the part is told.
            if not str(error).startswith(f"{name}{whose} = "):
                refusal = error
    raise refusal


def _rows(name: str, whose: str, value: Any, kind: Any, refusal: InputError) -> tuple[Any, ...]:
    """A list of any sort as a tuple, each of its values settled."""
    if not isinstance(value, Collection) or isinstance(value, str | bytes | Mapping):
        raise refusal
    inner, rows = get_args(kind), list(value) if len(getattr(value, "shape", "1")) else []
    alike = get_origin(kind) is not tuple or inner[-1] is Ellipsis
    if not alike and len(rows) != len(inner):
        raise refusal
    each = repeat(inner[0]) if alike else inner
    return tuple(
        _settled(f"{name}[{k}]", whose, *pair)
        for k, pair in enumerate(zip(rows, each, strict=False))
    )


def _word(kind: Any) -> str:
    """A kind as a person reads it."""
    origin, inner = get_origin(kind) or kind, get_args(kind)
    if origin in (Union, UnionType):
        *most, last = dict.fromkeys(map(_word, inner))
        return f"{', '.join(most)} or {last}" if most else last
    if origin is Literal:
        return f"one of {', '.join(inner)}"
    if origin is tuple and inner[-1] is not Ellipsis:
        return f"({', '.join(map(_word, inner))})"
    if origin in (tuple, Sequence):
        return f"list of {_word(inner[0])}"
    if origin is Mapping:
        return f"mapping of {_word(inner[0])} to {_word(inner[1])}"
    return _WORDS.get(origin, getattr(origin, "__name__", f"{origin}"))
