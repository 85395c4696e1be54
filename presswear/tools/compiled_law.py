"""Compiled user functions."""

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any, cast

from presswear.tools.errors import InputError
from presswear.tools.processes import signals_held
from presswear.tools.user_function import UserFunction


def check_compiles(law: UserFunction, key: str, allowed: tuple[str, ...]) -> None:
    """Raise InputError with the key for a function that fails or cannot be compiled.

    The function is first run in Python, because Ctrl-C cannot stop compiled code.
    """
    law.check_runs(key, allowed)
    try:
        compile_function(law, allowed)
    except InputError as error:
        raise InputError(f"{key}: {error}") from None


@cache
def compile_function(
    function: UserFunction, parameters: tuple[str, ...]
) -> Callable[..., float]:
    """Compile a user function of these parameters, in order; InputError if numba cannot."""
    import numba  # slow to import

    from presswear.tools.compile_errors import reason, statement_of

    compiler = numba.njit(error_model="numpy", _nrt=False)
    namespace = function.namespace()
    for name, value in namespace.items():
        if inspect.isfunction(value):
            namespace[name] = compiler(value)
    values = {
        number.name: repr(value)
        for number, value in function.settings(function.name, parameters)
    }
    names = [argument.arg for argument in function.arguments(function.name).args]
    used = ", ".join(values.get(name, name) for name in names)
    call = f"float({function.name}({used}))"
    exec(f"def kernel({', '.join(parameters)}):\n    return {call}", namespace)
    kernel: Any = compiler(namespace["kernel"])
    if numba.config.DISABLE_JIT:
        return cast(Callable[..., float], kernel)
    try:
        with signals_held():  # as ``kernel_compiler`` does
            kernel.compile((numba.float64,) * len(parameters))
    # The text may be any Python. Numba has no common base for its errors: what it does
    # not support shows as TypeError, ValueError, KeyError, NotImplementedError or
    # AssertionError, too.
    except Exception as error:
        line, statement = statement_of(namespace[function.name].py_func, f"{error}")
        place = f'line {line}, "{statement}"'
        raise InputError(
            f"{function.name} cannot be compiled: {place}: {reason(f'{error}')}"
        ) from None
    return cast(Callable[..., float], kernel)
