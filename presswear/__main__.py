"""Command line ``presswear``.

Exit codes: 0 success; 1 a run that failed; 2 bad input, or standard output that cannot
be written; 130 and 143 stopped by SIGINT and SIGTERM.
"""

import os
import signal
import sys
from collections.abc import Sequence

# The threads of numpy's linear algebra would wait in a busy loop beside these small
# matrices.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Without this, worker processes would import a file of the user, such as statistics.py.
os.environ.setdefault("PYTHONSAFEPATH", "1")

# Windows can block no signal.
_mask = getattr(signal, "pthread_sigmask", None)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line ``argv`` and return the exit code.

    Signals wait until they are handled: an import that is interrupted ends in a
    traceback.
    """
    words = sys.argv[1:] if argv is None else argv
    mask = _mask and _mask(
        signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    )
    from presswear.tools.errors import (
        InputError,
        KernelError,
        RunFailed,
        is_out_of_memory,
        printable,
    )
    from presswear.tools.processes import exit_code, is_stopped, stoppable

    _write_unknown_characters_as_escapes()
    try:
        with stoppable():
            if _mask:
                _mask(signal.SIG_SETMASK, mask)
            return _run_and_flush(words)
    except InputError as error:
        return _fail(f"{error}", 2)
    except KernelError as error:
        print(printable(f"presswear: {error}"), file=sys.stderr)
        return 1
    except RunFailed as error:
        return _fail(f"{error}", 1)
    except OSError as error:
        if error.filename is None and _is_output_broken():
            return _fail(f"standard output cannot be written: {error.strerror}", 2)
        return _fail(f"{error.strerror}: {error.filename}", 1)
    except KeyboardInterrupt as error:
        message = f"{error}" if error.args else "interrupted"
        return _fail(message, exit_code())
    except Exception as error:
        if is_out_of_memory(error):
            return _fail("memory ran out", 1)
        if not is_stopped():
            raise
        # Python can turn the KeyboardInterrupt of a signal into another error.
        return _fail("interrupted", exit_code())


def _write_unknown_characters_as_escapes() -> None:
    """Let standard output and error write characters that the terminal lacks as escapes."""
    import io

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _run_and_flush(words: Sequence[str]) -> int:
    """Run the command and flush standard output, while its error can still be reported."""
    try:
        return _run(words)
    finally:
        if sys.stdout is not None:
            sys.stdout.flush()


def _run(words: Sequence[str]) -> int:
    """Run the command of a command line and return its exit code."""
    if list(words) == ["--version"]:
        from importlib.metadata import version

        print(f"presswear {version('presswear')}")
        return 0
    from importlib import import_module

    from rich.console import Console

    from presswear.cli.parser import parser_for, with_joined_command

    if not words or words[0] == "help":
        words = [*words[1:], "--help"]
    words = with_joined_command(words)
    arguments = parser_for(words).parse_args(words)
    from presswear.cli import COMMANDS
    from presswear.cli.terminal import logging_to_stderr

    module, _, function = COMMANDS[arguments.command]["call"].partition(":")
    command = getattr(import_module(f"presswear.cli.{module}"), function)
    # Names of files and scenes may look like markup.
    console = Console(markup=False, highlight=False, emoji=False)
    with logging_to_stderr("verbose" in arguments):
        return int(command(arguments, console))


def _is_output_broken() -> bool:
    """Return whether standard output cannot be written; its buffer then goes to the null device."""
    try:
        # A stream without a buffer has nothing that a flush would write.
        sys.stdout.write("\n")
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return True
    return False


def _fail(message: str, code: int) -> int:
    """Print a message in one line and return the exit code."""
    from presswear.tools.errors import one_line

    print(one_line(f"presswear: {message}"), file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
