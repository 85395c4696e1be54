"""Functions of one's own: plain Python, kept as text, so that a result knows its laws.

The text is executed only where the user supplied it in this process: as a function, as a file, or
by trusting a result.  Text that was merely read from a result is never executed.
"""

import ast
import hashlib
import inspect
import math
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_checked

_MOST_BYTES = 2**18
_MOST_ROUNDS = 1000
_FORBIDDEN: dict[type[ast.AST], str] = {
    ast.Raise: "raises",
    ast.Assert: "asserts",
    ast.Try: "tries",
    ast.Subscript: "takes by an index",
    ast.While: "loops while something holds",
    ast.GeneratorExp: "makes a list",
    ast.ListComp: "makes a list",
    ast.SetComp: "makes a list",
    ast.DictComp: "makes a list",
}
"""What no law does, in words."""

_trusted: set[str] = set()
"""SHA-256 of the texts that may be executed in this process."""


class UntrustedLaw(InputError):
    """A law whose stored source code would have to be executed, which nobody has allowed."""


def _is_short(loop: ast.For) -> bool:
    """True for a loop whose number of rounds stands there, and is small."""
    rounds = 1
    for inner in (own.iter for own in ast.walk(loop) if isinstance(own, ast.For)):
        try:
            # Within a call of range nothing but whole numbers is read.
            bounds = ast.literal_eval(ast.unparse(inner).removeprefix("range"))
            rounds *= len(range(*bounds) if isinstance(bounds, tuple) else range(bounds))
        except (ValueError, TypeError, SyntaxError, OverflowError):
            return False
    return rounds <= _MOST_ROUNDS


def is_function(data: Any) -> bool:
    """True for a function of one's own as it is stored."""
    return isinstance(data, dict) and set(data) == {"name", "source"}


@dataclass(frozen=True)
class OwnFunction:
    """A function of numbers that gives a number, as the text that defines it.

    Everything that it needs stands in that text; ``math`` is there.

    Attributes
    ----------
    name : str
        Of the function in the text.
    source : str
        Python.
    """

    name: str
    source: str

    @property
    def _checksum(self) -> str:
        return hashlib.sha256(self.source.encode()).hexdigest()

    @property
    def digest(self) -> str:
        """First digits of the SHA-256 of its text."""
        return self._checksum[:8]

    @property
    def is_trusted(self) -> bool:
        """Whether its text may be executed in this process."""
        return self._checksum in _trusted

    def trusted(self) -> "OwnFunction":
        """Allow this process, and the processes it starts, to execute the text."""
        _trusted.add(self._checksum)
        return self

    def check_trusted(self, key: str) -> None:
        """Raise UntrustedLaw unless the text may be executed."""
        if not self.is_trusted:
            raise UntrustedLaw(
                f"{key} = {self}: source code that is stored in a result is not executed; use "
                "--trust, or pw.load(folder, trust=True), if you trust where it comes from"
            )

    def __reduce__(self) -> tuple[Any, ...]:
        # A worker process executes what the process that started it may execute.
        return _unpickled, (self.name, self.source, self.is_trusted)

    def __str__(self) -> str:
        """Its name, and by which text it is known."""
        return f"{self.name} of one's own, {self.digest}"

    @staticmethod
    def of(key: str, given: Any) -> "OwnFunction":
        """A function that is given as itself, as ``FILE.py:NAME``, or as stored.

        The first two are trusted; stored text is not.

        Raises
        ------
        InputError
            Naming the key and what is wrong.
        """
        if isinstance(given, OwnFunction):
            return given
        if isinstance(given, dict):
            if not is_function(given) or not all(isinstance(own, str) for own in given.values()):
                raise InputError(f"{key} = {given!r}: texts under name and source are expected")
            return OwnFunction(**given)
        if callable(given):
            try:
                source = textwrap.dedent(inspect.getsource(given))
                return OwnFunction(given.__name__, source).trusted()
            except (OSError, TypeError, AttributeError):
                raise InputError(
                    f"{key}: the source of {given!r} cannot be read: a function defined in a file "
                    "is expected"
                ) from None
        file, _, name = str(given).rpartition(":")
        path = Path(file)
        if not path.is_file():
            raise InputError(f"{key} = {given!r}: there is no file {file!r}; FILE.py:NAME is read")
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{key} = {given!r}: it has more than {_MOST_BYTES} bytes")
        try:
            return OwnFunction(name, read_checked(path).decode()).trusted()
        except UnicodeDecodeError:
            raise InputError(f"{key} = {given!r}: this is no text") from None

    @staticmethod
    def asking(key: str, given: Any, known: tuple[str, ...]) -> "OwnFunction":
        """A function as ``of`` reads it, which asks for nothing but what is known."""
        own = OwnFunction.of(key, given)
        own.parameters(f"{key} = {given}" if isinstance(given, str) else key, known)
        return own

    def parameters(self, key: str, known: tuple[str, ...]) -> tuple[str, ...]:
        """Names of its parameters, without running it; InputError for one that is not known."""
        try:
            tree = ast.parse(self.source)
        except (SyntaxError, ValueError, RecursionError) as error:
            raise InputError(f"{key}: {self.name} is no Python: {error}") from None
        found = {own.name: own for own in tree.body if isinstance(own, ast.FunctionDef)}
        if self.name not in found:
            raise unknown(f"function in {key}", self.name, tuple(found))
        for part in ast.walk(tree):
            # Compiled and called by its address it has nobody to tell, and nobody can stop it.
            what = _FORBIDDEN.get(type(part), "")
            if isinstance(part, ast.For) and not _is_short(part):
                what = f"loops over other than a range of written numbers up to {_MOST_ROUNDS}"
            if what:
                raise InputError(
                    f"{key}: {self.name} {what} in line {getattr(part, 'lineno', 1)}: a law gives "
                    "a number everywhere, by arithmetic and ifs"
                )
        arguments = found[self.name].args
        names = tuple(own.arg for own in arguments.args)
        if arguments.vararg or arguments.kwarg or arguments.kwonlyargs or arguments.posonlyargs:
            raise InputError(f"{key}: {self.name} takes parameters by plain names alone")
        for name in names:
            if name not in known:
                raise unknown(f"parameter of {self.name} in {key}", name, known)
        return names

    def check_compiles(self, key: str, known: tuple[str, ...]) -> None:
        """InputError naming the key where it cannot be compiled; runs its text."""
        from presswear.tools import compiled  # slow to import

        try:
            compiled.own_kernel(self, known)
        except InputError as error:
            raise InputError(f"{key}: {error}") from None

    def space(self) -> dict[str, Any]:
        """Execute its text and return what it defines; UntrustedLaw unless that is allowed."""
        self.check_trusted("law")
        space: dict[str, Any] = {"math": math, "__name__": self.name}
        exec(compile(self.source, f"<{self.name}>", "exec"), space)
        return space

    def number(self, key: str, known: tuple[str, ...], values: dict[str, float]) -> float:
        """Its value at some values of all known parameters; InputError where it is no number."""
        given = {name: values[name] for name in self.parameters(key, known)}
        told = ", ".join(f"{name} = {value:g}" for name, value in given.items())
        try:
            found = self.space()[self.name](**given)
        except UntrustedLaw:
            raise
        except (Exception, SystemExit) as error:
            inside = ""
            if isinstance(error, NameError):
                inside = "; all that it needs stands within it, or in FILE.py given as FILE.py:NAME"
            raise InputError(f"{key}: {self.name} fails at {told}: {error}{inside}") from None
        number = isinstance(found, (int, float)) and not isinstance(found, bool)
        if not number or not math.isfinite(found):
            raise InputError(f"{key}: {self.name} gives {found!r} at {told}: a number is expected")
        return float(found)


def _unpickled(name: str, source: str, is_trusted: bool) -> OwnFunction:
    found = OwnFunction(name, source)
    return found.trusted() if is_trusted else found
