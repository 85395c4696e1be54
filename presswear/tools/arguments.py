"""Arguments of functions of the face: names and types are checked, lists become arrays."""

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial, wraps
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from presswear.tools.arrays import numbers_of
from presswear.tools.errors import InputError, shown, unknown
from presswear.tools.symbols import SYMBOLS
from presswear.tools.type_check import check_type

F = TypeVar("F", bound=Callable[..., Any])


def check_names(what: str, names: Iterable[str], allowed: Mapping[str, Any]) -> None:
    """Raise InputError for a name that no field or parameter has, with the one that is meant."""
    for name in names:
        if name in allowed:
            continue
        setting = SYMBOLS.get(name, "")
        owner = ""
        for key, parameter in allowed.items():
            if setting and not owner and hasattr(parameter.default, setting):
                owner = f" of {key}"
        if owner or setting in allowed:
            raise InputError(f"unknown {what} {name!r}: {name} is {setting}{owner}")
        raise unknown(what, name, allowed)


def checked_arguments(function: F) -> F:
    """Decorate a function of the face: a misspelt or a wrong argument raises InputError.

    Arguments are compared with their annotations, not converted.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def checked(*values: Any, **named: Any) -> Any:
        check_names(f"argument of {function.__name__}", named, signature.parameters)
        hints = get_type_hints(function, include_extras=True)
        for name, value in signature.bind_partial(*values, **named).arguments.items():
            check_type(name, value, hints[name])
        return function(*values, **named)

    return cast(F, checked)


def takes_numbers(function: F) -> F:
    """Decorate a function of arrays: it takes lists, too; wrong arguments raise InputError."""
    signature = inspect.signature(function)
    hints = cache(partial(get_type_hints, function))

    @wraps(function)
    def checked(*values: Any, **named: Any) -> Any:
        try:
            arguments = signature.bind(*values, **named)
        except TypeError as error:
            raise InputError(f"{function.__name__}: {error}") from None
        passed = arguments.arguments
        for name, value in passed.items():
            passed[name] = _with_arrays(name, value, hints()[name])
        try:
            return function(*arguments.args, **arguments.kwargs)
        except (ValueError, IndexError, ArithmeticError, TypeError) as error:
            if isinstance(error, InputError):
                raise
            texts = ", ".join(_in_words(name, value) for name, value in passed.items())
            raise InputError(f"{function.__name__}: {texts}: {error}") from None

    return cast(F, checked)


def _in_words(name: str, value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{name} of shape {value.shape}"
    return f"{name} = {shown(value)}"


def _with_arrays(name: str, value: Any, kind: Any) -> Any:
    """Return an argument with arrays in place of lists; InputError if it does not fit."""
    kinds = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    if value is None and NoneType in kinds:
        return None
    if get_origin(kinds[0]) is np.ndarray:
        is_number = not (np.ndim(value) or value is None) and float in kinds
        return value if is_number else numbers_of(name, value)
    if get_origin(kind) is Sequence and get_origin(get_args(kind)[0]) is np.ndarray:
        check_type(name, value, Sequence[Any])
        return [numbers_of(name, item) for item in value]
    check_type(name, value, kind)
    return value
