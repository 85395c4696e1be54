"""User laws: plain Python functions of numbers, stored as source text.

The text is executed only where the user supplied it in this process: as a function, as
a file, or by trusting a result. Text that was merely read from a result is never
executed.
"""

import ast
import hashlib
import inspect
import linecache
import math
import textwrap
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_text
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.units import UNITS

_JUMP_WIDTH = 1e-9  # m/s or rad/s; a change within a narrower interval is a jump
_JUMP_SIZE = 1e-4  # smallest jump over the greatest absolute value
_POINTS = 20  # number of points at which a law is run before it is compiled

_trusted: set[str] = set()  # texts that may be executed in this process
_files: dict[str, str] = {}  # file name by text, of texts that were read from a file
_executed: set[str] = set()  # file names of texts that were executed in this process


class UntrustedLaw(InputError):
    """Stored source code of a law that the user has not allowed to be executed."""


def is_user_law(file: str) -> bool:
    """Return whether the code of a function, by its ``co_filename``, is that of a user law."""
    return file in _executed


def is_stored_function(data: Any) -> bool:
    """Return whether data is a user function as results and scene files store it."""
    return isinstance(data, dict) and {*data} - {"values"} == {"name", "source"}


class LawNumber(NamedTuple):
    """Number of a user law that a setting varies: a parameter with a default, SI.

    Its annotation may be a range: ``fade: "0.1 um to 1 mm" = 2e-6``.
    """

    name: str
    default: float
    meaning: Quantity


@dataclass(frozen=True)
class UserFunction:
    """Function of numbers by its name in a Python text, in which ``math`` is provided.

    ``values`` are numbers of the law, SI, that differ from their defaults; see
    ``LawNumber``.
    """

    name: str
    source: str
    values: tuple[tuple[str, float], ...] = ()

    @staticmethod
    def from_plain(data: Mapping[str, Any]) -> "UserFunction":
        """Return a function from its stored form."""
        values = tuple(data.get("values", {}).items())
        return UserFunction(data["name"], data["source"], values)

    def as_plain(self) -> dict[str, Any]:
        """Return the stored form."""
        data: dict[str, Any] = {"name": self.name, "source": self.source}
        return {**data, "values": dict(self.values)} if self.values else data

    def __str__(self) -> str:
        digest = hashlib.sha256(self.source.encode()).hexdigest()[:8]
        values = ", ".join(f"{name} = {value:g}" for name, value in self.values)
        name = f"{self.name}({values})" if values else self.name
        return f"user law {name}, {digest}"

    def __reduce__(self) -> tuple[Any, ...]:
        # A worker process may execute the same texts as the process that started it.
        return _unpickled, (self.as_plain(), self.is_trusted, self._file_name)

    @property
    def is_trusted(self) -> bool:
        """True if the text may be executed in this process."""
        return self.source in _trusted

    def trusted(self) -> "UserFunction":
        """Allow this process, and the processes it starts, to execute the text."""
        _trusted.add(self.source)
        return self

    def check_trusted(self, key: str) -> None:
        """Raise UntrustedLaw unless the text may be executed."""
        if not self.is_trusted:
            raise UntrustedLaw(
                f"{key} = {self}: source code that is stored in a result is not executed; use "
                "--trust, or pw.load(folder, trust=True), if you trust where it comes from"
            )

    @staticmethod
    def read(
        key: str, value: Any, parameters: tuple[str, ...] | None = None
    ) -> "UserFunction":
        """Return a function from a function, ``FILE.py:NAME``, or its stored form.

        The first two are trusted; stored text is not. InputError with the key for a
        value that is no readable function, or one with a parameter that is not among
        ``parameters``.
        """
        if isinstance(value, UserFunction):
            function = value
        elif isinstance(value, dict):
            function = _read_stored(key, value, parameters or ())
        elif callable(value):
            function = _read_function(key, value)
        else:
            function = _read_file(key, str(value))
        if parameters is not None:
            function.parameters(key, parameters)
        return function

    def arguments(self, key: str) -> ast.arguments:
        """Return the arguments of the function; InputError for text that does not define it."""
        try:
            tree = ast.parse(self.source)
        except (SyntaxError, ValueError, RecursionError) as error:
            raise InputError(f"{key}: {self.name} is no Python: {error}") from None
        nodes = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
        functions = {node.name: node for node in nodes}
        if self.name not in functions:
            raise unknown(f"function in {key}", self.name, tuple(functions))
        arguments = functions[self.name].args
        starred = arguments.vararg or arguments.kwarg
        if starred or arguments.kwonlyargs or arguments.posonlyargs:
            raise InputError(
                f"{key}: {self.name} must have plain parameters, no * and no **"
            )
        return arguments

    def parameters(self, key: str, allowed: tuple[str, ...]) -> tuple[str, ...]:
        """Return the names of the parameters without executing the text.

        Numbers of the law are none of them. InputError for text that does not define
        the function, and for a parameter that is not allowed.
        """
        names = tuple(argument.arg for argument in self.arguments(key).args)
        numbers = {number.name for number in self.numbers(key, allowed)}
        for name in names:
            if name not in allowed and name not in numbers:
                raise unknown(f"parameter of {self.name} in {key}", name, allowed)
        return tuple(name for name in names if name not in numbers)

    def numbers(self, key: str, allowed: tuple[str, ...]) -> tuple[LawNumber, ...]:
        """Return the numbers of the law: parameters with a default that are not allowed ones."""
        return _numbers_of(key, self.name, self.arguments(key), allowed)

    def settings(
        self, key: str, allowed: tuple[str, ...]
    ) -> list[tuple[LawNumber, float]]:
        """Return the numbers of the law with their present values, SI."""
        values = dict(self.values)
        settings = []
        for number in self.numbers(key, allowed):
            settings.append((number, values.get(number.name, number.default)))
        return settings

    def with_values(
        self, key: str, values: Mapping[str, Any], allowed: tuple[str, ...]
    ) -> "UserFunction":
        """Return the law with values of its numbers, SI or texts with a unit, in their ranges."""
        numbers = {number.name: number for number in self.numbers(key, allowed)}
        present = dict(self.values)
        for name, value in values.items():
            if name not in numbers:
                raise unknown(f"number of {self.name} in {key}", name, tuple(numbers))
            meaning = numbers[name].meaning
            present[name] = float(meaning.convert(f"{key}.{name}", value))
        return replace(self, values=tuple(sorted(present.items())))

    def namespace(self) -> dict[str, Any]:
        """Execute the text and return its names; UntrustedLaw unless that is allowed."""
        self.check_trusted("law")
        names: dict[str, Any] = {"math": math, "__name__": self.name}
        # A debugger and messages show the lines of the text.
        lines = self.source.splitlines(keepends=True)
        linecache.cache[self._file] = (len(self.source), None, lines, self._file)
        _executed.add(self._file)
        exec(compile(self.source, self._file, "exec"), names)
        return names

    @property
    def _file_name(self) -> str:
        return _files.get(self.source, self.name)

    @property
    def _file(self) -> str:
        """Name of the text in messages of Python, which marks it as no present file."""
        return f"<{self._file_name}>"

    def _failure(self, error: BaseException) -> str:
        """Return the message of an error with the last line of the text that was executed."""
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame for frame in frames if is_user_law(frame.filename)]
        place = f'line {lines[-1].lineno}, "{lines[-1].line}": ' if lines else ""
        return f"{place}{error}"

    def in_python(self) -> Callable[..., Any]:
        """Return the function in plain Python; each process executes its text for this once."""
        self.check_trusted("law")
        return _in_python(self)

    def evaluate(
        self, key: str, allowed: tuple[str, ...], values: dict[str, float]
    ) -> float:
        """Return the value in plain Python; InputError if it is no finite number."""
        arguments = {name: values[name] for name in self.parameters(key, allowed)}
        place = ", ".join(f"{name} = {value:g}" for name, value in arguments.items())
        self.check_trusted(key)
        try:
            result = self.in_python()(**arguments)
        except (Exception, SystemExit) as error:
            reason = self._failure(error)
            if isinstance(error, NameError):
                reason += "; define everything inside it, or pass FILE.py:NAME"
            raise InputError(f"{key}: {self.name} fails at {place}: {reason}") from None
        is_number = isinstance(result, (int, float)) and not isinstance(result, bool)
        if not is_number or not math.isfinite(result):
            raise InputError(
                f"{key}: {self.name} gives {result!r} at {place}: must be a number"
            )
        return float(result)

    def jump(
        self, name: str, values: dict[str, float]
    ) -> tuple[float, float, float] | None:
        """Return the first jump of the law as one parameter varies from -1 to 1, or None.

        The result is the parameter at the jump, and the values below and above the jump.
        The other parameters are constant, ``values``. An interval with a change is
        halved until the change is distributed, as in a steep function, or is a jump.
        """
        used = self.parameters(self.name, (*values, name))
        if name not in used:
            return None
        constant = {key: values[key] for key in used if key != name}
        positive = [10.0 ** (0.25 * k) for k in range(-24, 1)]
        arguments = [*(-x for x in reversed(positive)), 0.0, *positive]
        function = partial(self._result_at, name, constant)
        points = [(x, function(x)) for x in arguments]
        least = _JUMP_SIZE * max(abs(value) for _, value in points)
        for start, end in pairwise(points):
            jump = _narrowed(function, start, end, least)
            if jump is not None:
                return jump
        return None

    def _result_at(self, name: str, constant: dict[str, float], x: float) -> float:
        """Return the value for ``name`` = ``x``, or NaN outside of the range of the law."""
        try:
            return float(self.in_python()(**constant, **{name: x}))
        except (ArithmeticError, ValueError):
            return math.nan
        except Exception as error:
            reason = self._failure(error)
            raise InputError(f"{self.name} fails at {name} = {x:g}: {reason}") from None

    def check_runs(self, key: str, allowed: tuple[str, ...]) -> None:
        """Raise InputError with the key for a function that fails at one of ``_POINTS`` points.

        Arithmetic errors are allowed: a point may lie outside of the range of the law.
        """
        self.check_trusted(key)
        names = self.parameters(key, allowed)
        try:
            function = self.in_python()
        except (Exception, SystemExit) as error:
            raise InputError(
                f"{key}: {self.name} fails: {self._failure(error)}"
            ) from None
        for k in range(_POINTS):
            # Sizes from 1e-6 to about 1, signs and order different for each parameter.
            point = {}
            for i, name in enumerate(names):
                sign = (-1.0) ** (k // (i + 1))
                point[name] = sign * 2.0 ** -((7 * k + 3 * i) % _POINTS)
            try:
                function(**point)
            except (ArithmeticError, ValueError):
                continue
            except (Exception, SystemExit) as error:
                raise InputError(
                    f"{key}: {self.name} fails: {self._failure(error)}"
                ) from None


def _narrowed(
    function: Callable[[float], float],
    start: tuple[float, float],
    end: tuple[float, float],
    least: float,
) -> tuple[float, float, float] | None:
    """Return place and values below and above a jump in an interval; None for none.

    ``start`` and ``end`` are the ends of the interval with their values, and ``least``
    is the smallest change that is a jump.
    """
    low, below = start
    high, above = end
    while abs(above - below) > least and high - low > _JUMP_WIDTH:
        middle = 0.5 * (low + high)
        between = function(middle)
        if abs(between - below) > abs(above - between):
            high = middle
            above = between
        else:
            low = middle
            below = between
    if not abs(above - below) > least:
        return None
    place = round(low, 8) + 0.0  # the sum turns -0.0 into 0.0
    return place, below, above


def _read_stored(
    key: str, data: dict[str, Any], parameters: tuple[str, ...]
) -> UserFunction:
    """Return a function from its stored form, which is not trusted."""
    texts = [data.get("name"), data.get("source")]
    are_texts = all(isinstance(text, str) for text in texts)
    if not (is_stored_function(data) and are_texts):
        raise InputError(f"{key} = {data!r}: must have texts under name and source")
    function = UserFunction(data["name"], data["source"])
    values = data.get("values", {})
    return function.with_values(key, values, parameters) if values else function


def _read_function(key: str, function: Callable[..., Any]) -> UserFunction:
    """Return a user function from a function of Python."""
    name = getattr(function, "__name__", "")
    if name == "<lambda>":
        raise InputError(f"{key}: a lambda has no name; define the function with def")
    try:
        source = textwrap.dedent(inspect.getsource(function))
        return UserFunction(function.__name__, source).trusted()
    except (OSError, TypeError, AttributeError):
        fault = f"the source of {function!r} cannot be read"
        raise InputError(f"{key}: {fault}; define the function in a file") from None


def _read_file(key: str, text: str) -> UserFunction:
    """Return a user function from ``FILE.py:NAME``."""
    file, _, name = text.rpartition(":")
    try:
        function = UserFunction(name, read_text(Path(file))).trusted()
    except InputError as error:
        raise InputError(f"{key} = {text!r}: must be FILE.py:NAME; {error}") from None
    _files[function.source] = file
    return function


def _numbers_of(
    key: str, law: str, arguments: ast.arguments, allowed: tuple[str, ...]
) -> tuple[LawNumber, ...]:
    """Return the parameters of a function with a default that are not among ``allowed``.

    Raises
    ------
    InputError
        If a default is not a number in its range, or an annotation is not a range.
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
    # An annotation such as ``float`` has no range.
    if annotation is None or isinstance(annotation, ast.Name):
        return Quantity(origin="law", text=text)
    words = ""
    if isinstance(annotation, ast.Constant):
        words = f"{annotation.value!s}"
    first, separator, last = words.partition(" to ")
    if not separator:
        raise InputError(
            f"{name}: {ast.unparse(annotation)}: a range such as '0.1 um to 1 mm' is expected"
        )
    unit = _unit_of(last)
    low = parse_quantity(name, first, Quantity(unit))
    high = parse_quantity(name, last, Quantity(unit))
    if not low < high:
        raise InputError(f"{name}: {words}: the first end must be below the second")
    return Quantity(unit, low, high, "law", text)


def _unit_of(text: str) -> str:
    """Return the SI unit of a text such as ``1 mm``; an unknown unit is returned as it is."""
    symbol = text.strip().partition(" ")[2].strip()
    for unit, symbols in UNITS.items():
        if symbol in symbols:
            return unit
    return symbol


@cache
def _in_python(function: UserFunction) -> Callable[..., Any]:
    return partial(function.namespace()[function.name], **dict(function.values))


def _unpickled(data: dict[str, Any], is_trusted: bool, file: str) -> UserFunction:
    function = UserFunction.from_plain(data)
    _files[function.source] = file
    return function.trusted() if is_trusted else function
