"""Errors that the command line reports in one line, or a mistake in a kernel in three.

The exit code is 2 for bad input and 1 for a failed run; anything else is a defect and
shows its traceback.
"""

from collections.abc import Iterable
from typing import Any

from presswear.tools.not_modelled import NOT_MODELLED, not_modelled


class InputError(ValueError):
    """Unknown name, value out of range, or values that do not fit together, in one line."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(f"{message}"))


class AssemblyError(InputError):
    """Linkage that cannot be assembled in some position."""


class NotStored(InputError):
    """Series that a result does not contain."""


class RunFailed(RuntimeError):
    """Failed run.

    Attributes
    ----------
    finding : Finding or None
        Cause with time, joint and remedy; None if there is no such cause.
    """

    def __init__(self, message: str, finding: Any = None) -> None:
        super().__init__(message)
        self.finding = finding


class KernelError(RunFailed):
    """Mistake in a kernel, in lines: file with line and function, statement, reason."""


# In errors for a library that cannot be loaded or a thread that cannot be started
_MEMORY_WORDS = "failed to map segment", "cannot allocate memory", "start new thread"


def is_out_of_memory(error: BaseException) -> bool:
    """Return whether an error says that memory ran out."""
    if isinstance(error, MemoryError):
        return True
    text = f"{error}".lower()
    return any(words in text for words in _MEMORY_WORDS)


def nearest(name: str, names: Iterable[str]) -> str:
    """Return a question with the nearest of some names; empty if none is near."""
    from difflib import get_close_matches  # slow to import

    lower = {word.lower(): word for word in names}
    unknown_name = name.lower()[:MAX_MESSAGE]
    matches = get_close_matches(unknown_name, lower, n=1, cutoff=NEAR)
    if not matches and len(unknown_name) > LEAST_STEM:
        stem = unknown_name[:-1]  # body and bodies
        matches = [word for word in lower if word.startswith(stem)]
    return f"; did you mean {lower[matches[0]]}?" if matches else ""


def remedy(name: str, names: Iterable[str]) -> str:
    """Return the end of a message on an unknown name: the nearest known one, or all."""
    words = tuple(names)
    absent = not_modelled(name)
    if hint := nearest(name, words):
        if 1 < len(words) <= FEW_NAMES:
            hint += f" Known are {', '.join(words)}."
        # The nearest name is a better answer than another name of the same thing.
        return f"{hint} {absent}" if absent.startswith(NOT_MODELLED) else hint
    if absent:
        return f". {absent}"
    return f"; known are {', '.join(words)}" if words else "; there is none"


def unknown(kind: str, name: Any, names: Iterable[str]) -> InputError:
    """Return the error for an unknown name, with the nearest of the known names or with all."""
    return InputError(f"unknown {kind} {shown(name)}{remedy(f'{name}', names)}")


def not_installed(what: str, package: str) -> InputError:
    """Return the error for something that needs a package of the extra ``sweep``."""
    source = "pip install '.[sweep]' in the folder of the sources"
    return InputError(f"{what} needs {package}: pip install {package}, or {source}")


NEAR = 0.65  # similarity of a name that is proposed; 0.6 proposes speed for spiel
LEAST_STEM = 3  # fewest letters that a name and the proposed one share
FEW_NAMES = 6  # up to so many names are all listed beside the nearest one
MAX_VALUE = 80  # characters of a value in a message
MAX_MESSAGE = 1000  # characters of a message
NARROW = "\u202f"  # space between groups of three digits
# Characters that terminals print, although ``str.isprintable`` is false for them
_PRINTED = (NARROW, "\xa0", "\n")


def shown(value: Any) -> str:
    """Return a value as Python writes it, cut where it is long."""
    try:
        text = repr(value)
    except ValueError:  # an integer with more than 4300 digits
        text = "a huge number"
    return text if len(text) <= MAX_VALUE else f"{text[: MAX_VALUE - 3]}..."


def printable(text: str) -> str:
    """Return a text with escapes in place of characters that would control a terminal."""
    characters = []
    for character in text:
        if character.isprintable() or character in _PRINTED:
            characters.append(character)
        else:
            characters.append(ascii(character)[1:-1])
    return "".join(characters)


def one_line(text: str) -> str:
    """Return a message as one line of printable characters, the rest as escapes."""
    line = printable(text[: MAX_MESSAGE + 1]).replace("\n", "\\n")
    return line if len(line) <= MAX_MESSAGE else f"{line[: MAX_MESSAGE - 3]}..."
