"""What a person hands over to a class or a function: settled by its annotations, or refused."""

import inspect
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import partial, wraps
from itertools import repeat
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, cast, get_args, get_origin

import numpy as np

from presswear.tools.errors import InputError, nearest, shown, unknown
from presswear.tools.own import OwnFunction
from presswear.tools.quantities import NAMING, Meaning

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
    OwnFunction: "function",
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
    parameters = [own for own in signature.parameters.values() if own.name != "self"]
    kinds: dict[str, Any] = {
        # What is imported later, if at all, is checked by whoever imports it.
        own.name: Any if isinstance(own.annotation, str) else own.annotation
        for own in parameters
        if own.kind is not own.VAR_KEYWORD
    }
    for item in fields(cast(Any, made)) if is_dataclass(made) else ():
        is_choice = "choice" in item.metadata and get_origin(item.type) is not Literal
        if is_choice or "meaning" in item.metadata:
            kinds[item.name] = _Meant
    known = list(kinds)
    first = known[0] if known and known[0] in NAMING else ""

    @wraps(function)
    def settling(*given: Any, **named: Any) -> Any:
        for name in named:
            if name not in kinds and len(kinds) == len(parameters):
                raise unknown(f"argument of {label}", name, known)
        try:
            bound = signature.bind(*given, **named)
        except TypeError as error:
            raise InputError(f"{label}: {error}") from None
        arguments = bound.arguments
        owner = arguments.get(first)
        for name in arguments.keys() & kinds.keys():
            whose = f" of {owner}" if isinstance(owner, str) and name != first else ""
            arguments[name] = _settled(name, whose, arguments[name], kinds[name])
        return function(*bound.args, **bound.kwargs)

    if not is_class:
        return cast(F, settling)
    cast(Any, made).__init__ = settling
    return made


def _settled(name: str, whose: str, value: Any, kind: Any) -> Any:
    """A value as its kind has it; InputError names its place and whose it is."""
    kind = _behind(kind)
    origin, inner = get_origin(kind) or kind, get_args(kind)
    if kind is Any:
        return value
    if kind is _Meant:
        return _number(value)
    if origin is Annotated:
        number = _number(value)
        cast(Meaning, inner[1]).check(f"{name}{whose}", number)
        return number
    if origin in (Union, UnionType):
        return _one_of(name, whose, value, kind)
    if origin in (tuple, Sequence):
        return _rows(name, whose, value, kind)
    if origin is Mapping and isinstance(value, Mapping):
        settled = partial(_settled, whose=whose)
        return {
            settled(f"name in {name}", value=key, kind=inner[0]): settled(
                f"{name}.{key}", value=own, kind=inner[1]
            )
            for key, own in value.items()
        }
    if origin is np.ndarray:
        with suppress(TypeError, ValueError, OverflowError):
            return np.array(value, dtype=float)
    if kind in (float, int):
        number = _number(value)
        if isinstance(number, int | kind) and not isinstance(number, bool):
            if -LARGEST <= number <= LARGEST:
                return kind(number)
            raise InputError(f"{_refusal(name, whose, value, kind)}, {LARGEST:g} at most")
    elif origin is Literal:
        if isinstance(value, str) and value in inner:
            return value
        told = f"{name}{whose} = {shown(value)}: allowed is {_word(kind)}"
        raise InputError(f"{told}{nearest(f'{value}', inner)}")
    elif callable(value) if origin is Callable else isinstance(value, origin):
        return value
    raise _refusal(name, whose, value, kind)


def _behind(kind: Any) -> Any:
    """The kind that an alias stands for, as numpy's ``NDArray`` is one from Python 3.12 on."""
    meant = getattr(get_origin(kind) or kind, "__value__", kind)
    return meant if meant is kind or not get_args(kind) else meant[get_args(kind)]


def _refusal(name: str, whose: str, value: Any, kind: Any) -> InputError:
    word = _word(kind)
    article = "an" if word[0] in "AEIOU" else "a"
    return InputError(f"{name}{whose} = {shown(value)}: {article} {word} is expected")


def _number(value: Any) -> Any:
    """A number of any kind as one of Python's; anything else as it is."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return value
    try:
        return int(value) if isinstance(value, Integral) else float(value)
    except OverflowError:
        return math.inf


def _one_of(name: str, whose: str, value: Any, kind: Any) -> Any:
    """A value of one of some kinds."""
    kinds, refusal = get_args(kind), None
    if isinstance(value, Real) and not isinstance(value, bool) and float in kinds:
        return _settled(name, whose, value, float)
    for own in kinds:
        try:
            return _settled(name, whose, value, own)
        except InputError as error:
            # Where the whole is of this kind but a part is not, the part is told.
            if not str(error).startswith(f"{name}{whose} = "):
                refusal = error
    raise refusal or _refusal(name, whose, value, kind)


def _rows(name: str, whose: str, value: Any, kind: Any) -> tuple[Any, ...]:
    """A list of any sort as a tuple, each of its values settled."""
    is_list = isinstance(value, Collection) and not isinstance(value, str | bytes | Mapping)
    # An array without dimensions calls itself a collection as well.
    if not is_list or getattr(value, "ndim", 1) == 0:
        raise _refusal(name, whose, value, kind)
    inner, rows = get_args(kind), list(value)
    alike = get_origin(kind) is not tuple or inner[-1] is Ellipsis
    if not alike and len(rows) != len(inner):
        raise _refusal(name, whose, value, kind)
    each = repeat(inner[0]) if alike else inner
    return tuple(
        _settled(f"{name}[{k}]", whose, *pair)
        for k, pair in enumerate(zip(rows, each, strict=False))
    )


def _word(kind: Any) -> str:
    """A kind as a person reads it."""
    kind = _behind(kind)
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
