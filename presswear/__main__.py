"""The command line: what commands there are, and how they end.

Exit codes: 0 success; 1 a run that failed; 2 bad input, or standard output that cannot be written;
130 and 143 stopped by SIGINT and SIGTERM.
"""

import io
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version

from presswear.tools.errors import InputError, RunFailed, one_line
from presswear.tools.processes import exit_code, is_stopped, stoppable


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A character that the encoding of a terminal lacks is written as an escape.
            stream.reconfigure(errors="backslashreplace")
    try:
        with stoppable(), _flushed():
            words = sys.argv[1:] if argv is None else argv
            if list(words) == ["--version"]:
                print(f"presswear {version('presswear')}")
                return 0
            # Imported when a signal is answered already.
            from presswear.cli.parser import parser_of

            arguments = parser_of(words).parse_args(words)
            from rich.console import Console

            from presswear.cli.logs import logged

            with logged("verbose" in arguments):
                return int(arguments.run(arguments, Console()))
    except InputError as error:
        _tell(str(error))
        return 2
    except RunFailed as error:
        _tell(str(error))
        return 1
    except OSError as error:
        if error.filename is None and _drops_output():
            _tell(f"standard output cannot be written: {error.strerror}")
            return 2
        _tell(f"{error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt as error:
        _tell(str(error) if error.args else "interrupted")
        return exit_code()
    # Behind a signal any error is one of being stopped: see ``tools.processes``.
    except Exception:
        if not is_stopped():
            raise
        _tell("interrupted")
        return exit_code()


@contextmanager
def _flushed() -> Iterator[None]:
    """Flush standard output at the end, where an error can still be reported."""
    try:
        yield
    finally:
        if sys.stdout is not None:
            sys.stdout.flush()


def _drops_output() -> bool:
    """Whether standard output cannot be written; its buffer then goes to the null device."""
    try:
        sys.stdout.write("\n")  # without a buffer there is nothing left that a flush would write
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


def _tell(problem: str) -> None:
    print(one_line(f"presswear: {problem}"), file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
