"""Digest of everything on which the machine code of a function depends.

The digest covers the instructions and constants of the function, and every kernel,
constant and class to which they refer. After an edit only kernels with a new digest are
compiled again. Comments, docstrings and types of parameters are not covered.
"""

import dis
import types
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numba.core import config
from numba.core import types as kinds
from numba.core.extending import _Intrinsic

from presswear.tools.files import digest


@cache
def function_digest(function: Callable[..., Any]) -> str:
    """Return a digest of a function and of all that it refers to."""
    parts = [
        repr(function.__defaults__),
        *_code_parts(function.__code__, function.__doc__),
    ]
    for name in sorted(_names(function.__code__)):
        if name in function.__globals__:
            parts += [name, *_parts(function.__globals__[name])]
    return digest("\n".join(parts).encode())


def options_text(options: Mapping[str, Any]) -> str:
    """Return options of a kernel as a text that is the same in every process."""
    parts = []
    for name, value in options.items():
        # The order of a set differs between processes.
        parts.append((name, sorted(value) if isinstance(value, set) else value))
    return repr(parts)


def _names(code: types.CodeType) -> set[str]:
    """Return the global names of a function and of the functions inside it."""
    names = set()
    for instruction in dis.get_instructions(code):
        if instruction.opname == "LOAD_GLOBAL":
            names.add(instruction.argval)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names(constant)
    return names


def _code_parts(code: types.CodeType, docstring: str | None = None) -> Iterator[str]:
    """Yield texts that describe instructions.

    Line numbers are included if bounds are checked, because an IndexError shows them.
    """
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    yield f"{code.co_code.hex()} {names} {code.co_argcount} {code.co_flags}"
    if config.BOUNDSCHECK:
        yield f"{code.co_filename} {[*code.co_lines()]}"
    for constant in code.co_consts:
        is_docstring = bool(constant) and constant == docstring
        if isinstance(constant, types.CodeType):
            yield from _code_parts(constant)
        elif not is_docstring:
            yield f"{type(constant).__name__} {constant!r}"


def _parts(value: Any) -> Iterator[str]:
    """Yield texts that describe a value to which a function refers."""
    if hasattr(value, "py_func"):
        yield f"{options_text(value.options)} {value.is_inside_callers}"
        if value.is_inside_callers:
            yield function_digest(value.py_func)
        else:
            yield from _code_parts(value.generate_call.__code__)
    elif isinstance(value, _Intrinsic):
        yield from _code_parts(value._defn.__code__)
    elif isinstance(value, types.FunctionType):
        yield function_digest(value)
    elif isinstance(value, tuple):
        yield from fields_of(type(value))
        for item in value:
            yield from _parts(item)
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    elif isinstance(value, type | types.ModuleType):
        yield value.__name__
        yield from fields_of(value)
    else:
        yield f"{type(value).__name__} {value!r}"


def fields_of(kind: Any) -> Iterator[str]:
    """Yield the names of the fields of named tuples in a class or a type of numba."""
    if isinstance(kind, kinds.BaseNamedTuple):
        yield f"{kind.instance_class._fields}"
    elif hasattr(kind, "_fields"):
        yield f"{kind._fields}"
    if isinstance(kind, kinds.BaseTuple):
        for item in kind.types:
            yield from fields_of(item)
    elif isinstance(kind, kinds.CPointer | kinds.Array):
        yield from fields_of(kind.dtype)
