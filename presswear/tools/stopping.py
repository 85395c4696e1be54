"""Being stopped: SIGINT, SIGTERM and SIGHUP end a command in the same way.

The handler raises KeyboardInterrupt wherever the program is.  That can be a place that
swallows it, so the command asks again whenever it tells its progress; or one that makes
another error of it, as Python does inside ``__set_name__``: any error behind a signal is one.
"""

import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
_received: list[int] = []


def _stop(number: int, frame: FrameType | None) -> None:
    _received.append(number)
    raise KeyboardInterrupt


@contextmanager
def _answered(answer: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Answer signals by a function; those that somebody had ignored stay ignored."""
    before = {}
    for name in NAMES:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) not in (signal.SIG_IGN, None):
            try:
                before[number] = signal.signal(number, answer)
            except ValueError:  # not in the main thread: the program around decides
                break
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def stoppable() -> Iterator[None]:
    """Let signals stop what is inside."""
    _received.clear()
    complain = sys.unraisablehook

    def dropped(problem: "sys.UnraisableHookArgs") -> None:
        # An object that a signal left half made fails as it is dropped, and nobody need know.
        if not is_stopped():
            complain(problem)

    sys.unraisablehook = dropped
    try:
        with _answered(_stop):
            yield
    finally:
        # Such objects may live until the program ends.
        if not is_stopped():
            sys.unraisablehook = complain


@contextmanager
def deferred() -> Iterator[None]:
    """Let no signal stop what is inside; those that come arrive behind it.

    To block them does not do: another thread takes them, and Python answers in the main one.
    """
    came: list[int] = []
    try:
        with _answered(lambda number, frame: came.append(number)):
            yield
    finally:
        for number in came:
            signal.raise_signal(number)


def is_stopped() -> bool:
    """True once a signal has come."""
    return bool(_received)


def check_stopped() -> None:
    """KeyboardInterrupt where a signal has come that nothing has answered."""
    if is_stopped():
        raise KeyboardInterrupt


def exit_code() -> int:
    """128 and the number of the signal that came."""
    return 128 + (_received[0] if _received else signal.SIGINT)
