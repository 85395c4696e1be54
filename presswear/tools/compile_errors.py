"""Short messages for functions that numba cannot compile, or that fail where they run."""

import inspect
import linecache
import re
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

import numba
from numba.core import config, event
from numba.core.callconv import CPUCallConv
from numba.core.lowering import BaseLower

from presswear.tools.errors import InputError, KernelError, RunFailed
from presswear.tools.user_function import is_user_law

_NUMBA = str(Path(numba.__file__).parent)
_PACKAGE = str(Path(__file__).parents[1])
_TYPE = re.compile(
    r"Literal\[\w+\]\((.+?)\)|Function\(<(?:built-in function|class) '?(\w+)'?>\)"
)
# Numba rejects an allocation with words about returned arrays.
_ALLOCATES = "Only accept returning of array passed into the function as argument"
_MAX_REASON = 300  # characters


class _Failures(event.Listener):
    """Note the first function whose compilation fails within that of its callers."""

    function: Callable[..., Any] | None = None
    _depth = 0

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self.function = None
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        # The public property ``is_failed`` is True for a success, in numba 0.61 to
        # 0.68.
        has_failed = event._exc_details is not None
        if has_failed and self.function is None and event.data:
            function = event.data["dispatcher"].py_func
            if not function.__code__.co_filename.startswith(_NUMBA):
                self.function = function
        if self._depth == 0 and not has_failed:
            self.function = None


_failures = _Failures()
event.register("numba:compile", _failures)


class ShortErrors:
    """Context that shortens errors of kernels to file, line, statement and reason.

    ``lazy_failure`` is the error of a lazily compiled kernel, which its callers cannot
    pass on.

    A kernel that cannot be compiled or that reads beyond an array is KernelError. A user
    law that fails where it runs is InputError. Kernels are called in this context from
    Python, which a generator would delay more than the call takes.
    """

    lazy_failure: Exception | None = None

    def __enter__(self) -> None:
        _failures.function = None
        self.lazy_failure = None

    def __exit__(
        self, kind: object, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not isinstance(error, Exception):
            return
        # Numba has no common base for its errors: a wrong field of a record is a
        # KeyError.
        if _failures.function is not None:
            function = _failures.function
            _failures.function = None
            text = f"no field {error}" if isinstance(error, KeyError) else str(error)
            raise KernelError(describe(function, text)) from None
        if self.lazy_failure is not None:
            failure = self.lazy_failure
            self.lazy_failure = None
            raise failure from None
        error_with_place = _with_statement(error, trace)
        if error_with_place is not None:
            raise error_with_place from None


def _with_statement(error: Exception, trace: TracebackType | None) -> Exception | None:
    """Return the error of a user law or a kernel with the place where it was raised, or None."""
    for frame, number in reversed([*traceback.walk_tb(trace)]):
        file = frame.f_code.co_filename
        name = frame.f_code.co_name
        statement = linecache.getline(file, number).strip()
        cause = str(error) or type(error).__name__
        if is_user_law(file):
            place = f'{file[1:-1]}, line {number}, {name}: "{statement}"'
            return InputError(f"user law fails: {place}: {cause}")
        # Numba adds the place of an error as a frame without global names.
        if not frame.f_globals:
            return KernelError(f"{file}:{number}: {name}\n    {statement}\n{cause}")
        is_plain = config.DISABLE_JIT and not isinstance(error, RunFailed | InputError)
        if is_plain and file.startswith((_PACKAGE, "<equations")):
            cause = f"{type(error).__name__}: {error}"
            return KernelError(f"{file}:{number}: {name}\n    {statement}\n{cause}")
    return None


def _with_place(add_error: Callable[..., None]) -> Callable[..., None]:
    """Return the function that writes an error into machine code, with the line of it.

    Numba leaves the line out where an index is beyond a tuple or an array. A kernel that
    is stored gets it only where its key has the line (``kernel_digest``).
    """

    def add(
        convention: Any,
        builder: Any,
        error: Any,
        exc_args: Any = None,
        loc: Any = None,
        func_name: Any = None,
    ) -> None:
        frame = sys._getframe() if loc is None else None
        while frame is not None and frame.f_code is not BaseLower.lower_block.__code__:
            frame = frame.f_back
        if frame is not None:
            lower = frame.f_locals["self"]
            if config.BOUNDSCHECK or is_user_law(lower.loc.filename):
                loc = lower.loc
                func_name = lower.func_ir.func_id.func_name
        add_error(convention, builder, error, exc_args, loc, func_name)

    return add


CPUCallConv.set_static_user_exc = _with_place(CPUCallConv.set_static_user_exc)
short_errors = ShortErrors()


def describe(function: Callable[..., Any], text: str) -> str:
    """Return file, line, statement and reason of a failed compilation, in three lines.

    Parameters
    ----------
    function : function
        Function that cannot be compiled.
    text : str
        Message of numba, with up to hundreds of lines.
    """
    line, statement = statement_of(function, text)
    name = function.__code__.co_filename
    return f"{name}:{line}: {function.__name__} cannot be compiled\n    {statement}\n{reason(text)}"


def statement_of(function: Callable[..., Any], text: str) -> tuple[int, str]:
    """Return number and text of the line that a message of numba is about."""
    code = function.__code__
    try:
        lines, first = inspect.getsourcelines(code)
    except OSError:  # code of ``python -c`` has no file
        return code.co_firstlineno, "(no source)"
    places = re.findall(
        rf"(?:at |File \"){re.escape(code.co_filename)}\W+(?:line )?(\d+)", text
    )
    places += re.findall(r"File \".*\", line (\d+)", text)
    inside = [int(place) for place in places if 0 < int(place) - first < len(lines)]
    if inside:
        # Returns of different types are listed in any order.
        place = max(inside) if "Return of:" in text else inside[0]
        return place, lines[place - first].strip()
    # Without a place: the line with the name, or with the construct, that numba
    # complains about
    for word in re.findall(r"'(\w+)", reason(text)):
        for number, line in enumerate(lines[1:], first + 1):
            if re.search(rf"\b{word}\b", line):
                return number, line.strip()
    return first, lines[0].strip()


def reason(text: str) -> str:
    """Return the reason in a message of numba as one line."""
    if _ALLOCATES in text:
        return "kernels cannot allocate memory"
    lines = (line.strip() for line in text.splitlines())
    shown_lines = (line for line in lines if line and not line.startswith("Failed in "))
    first = next(shown_lines, "numba gives no reason")
    call = re.search(">>> (.+)", text)
    if call and first.startswith("No implementation of function"):
        name, _, kinds = call[1].partition("(")
        first = f"{name} is not defined for the types ({kinds}"
    cause = re.search(r'"TypeError: (.+)"', first)
    if cause and first.startswith("Cannot bind"):
        first = cause[1].rstrip(".")
    first = first.removesuffix(". Raised from None")
    first = _TYPE.sub(lambda match: match[1] or match[2], first)
    return first if len(first) <= _MAX_REASON else f"{first[: _MAX_REASON - 3]}..."
