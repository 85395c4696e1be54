"""Errors that a person is told in one line.

The command line turns these into one line and exit code 2 (bad input) or 1
(a run that failed); anything else is a defect and shows its traceback.
"""

from collections.abc import Iterable
from typing import Any


class InputError(ValueError):
    """Input that names nothing, is out of range or does not fit together; told in one line."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class AssemblyError(InputError):
    """A linkage that cannot be put together in some position."""


class RunFailed(RuntimeError):
    """A run that had to stop: what happened, when, and what to do about it.

    Attributes
    ----------
    finding : Finding or None
        The cause with its time, joint and remedy, where it was a finding about the run.
    """

    def __init__(self, message: str, finding: Any = None) -> None:
        super().__init__(message)
        self.finding = finding


def nearest(name: str, known: Iterable[str]) -> str:
    """The known name that an unknown one comes near, as a question for a message, or nothing."""
    # Imported where something is wrong already: it takes a hundredth of a second.
    from difflib import get_close_matches

    lower = {word.lower(): word for word in known}
    found = get_close_matches(name.lower()[:MOST_SHOWN], lower, n=1, cutoff=0.6)
    return f"; did you mean {lower[found[0]]}?" if found else ""


def unknown(kind: str, name: Any, known: Iterable[str]) -> InputError:
    """The error for a name that is none of those known, with the nearest of them."""
    words = tuple(known)
    told = f"known are {', '.join(words)}" if words else "there is none"
    return InputError(f"unknown {kind} {shown(name)}{nearest(f'{name}', words)}; {told}")


def not_installed(what: str, package: str, extra: str) -> InputError:
    """The error for something that needs a package of an extra that is not there."""
    return InputError(f"{what} needs {package}: pip install 'presswear[{extra}]'")


MOST_OF_VALUE = 80
"""Characters of a value in a message."""


def shown(value: Any) -> str:
    """A value as Python writes it, cut where it is long."""
    text = repr(value)
    return text if len(text) <= MOST_OF_VALUE else f"{text[: MOST_OF_VALUE - 3]}..."


MOST_SHOWN = 1000
"""Characters of a message: what somebody typed or stored may be of any length."""


def one_line(text: str) -> str:
    """A message as one line that any terminal can show; what it cannot is written as escapes."""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[: MOST_SHOWN + 1])
    return shown if len(shown) <= MOST_SHOWN else f"{shown[: MOST_SHOWN - 3]}..."
