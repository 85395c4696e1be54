"""Code that kernels call, with a function for plain Python beside it."""

from collections.abc import Callable
from typing import Any

from numba.core import extending


class _Intrinsic(extending._Intrinsic):
    in_python: Callable[..., Any]

    def __call__(self, *arguments: Any) -> Any:
        return self.in_python(*arguments)


def intrinsic_with(
    in_python: Callable[..., Any],
) -> Callable[[Callable[..., Any]], Any]:
    """Define code for kernels, beside a function that does the same in plain Python."""

    def define(code: Callable[..., Any]) -> Any:
        intrinsic = _Intrinsic(code.__name__, code)
        intrinsic._register()
        intrinsic.in_python = in_python
        return intrinsic

    return define
