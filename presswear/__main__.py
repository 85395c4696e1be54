"""The command line: what commands there are, and how they end.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 and 143 stopped by SIGINT and
SIGTERM.
"""

import re
import shlex
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, NoReturn

from presswear.commands import COMMANDS
from presswear.tools.errors import InputError, RunFailed, nearest, one_line, unknown
from presswear.tools.stopping import exit_code, is_stopped, stoppable

if TYPE_CHECKING:
    import argparse


def parser_of(words: Sequence[str]) -> "argparse.ArgumentParser":
    """The parser of the command that is called; of the others it knows names only."""
    # Imported when a signal is answered already: it takes most of a second.
    import argparse

    class _Parser(argparse.ArgumentParser):
        """Tells errors of usage in one line, like every other, with the nearest right word."""

        def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
            found, rest = super().parse_known_args(args, namespace)
            if rest:
                known = self._option_string_actions
                key, equals, _ = rest[0].partition("=")
                hint = nearest(key, known) or self._see
                if equals and not key.startswith("-") and "--set" in known:
                    hint = f"; a value of the scene is set by --set {shlex.quote(rest[0])}"
                raise InputError(f"unrecognized arguments: {' '.join(rest)}{hint}")
            return found, rest

        def error(self, message: str) -> NoReturn:
            wrong = re.match(r"argument COMMAND: invalid choice: '(.*?)' ", message)
            if wrong is not None:
                raise unknown("command", wrong[1], COMMANDS)
            raise InputError(f"{message}{self._see}")

        @property
        def _see(self) -> str:
            return f"; see {self.prog} --help"

    parser = _Parser(
        prog="presswear",
        description="Press linkages with worn joints: motion, contact and wear, in Exudyn.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    parser.add_argument("--version", action="store_true", help="tell the version and end")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    called = next((word for word in words if not word.startswith("-")), "")
    module = COMMANDS[called][0] if called in COMMANDS else ""
    for name, (own, line) in COMMANDS.items():
        if own != module:
            commands.add_parser(name, help=line)
    if module:
        import_module(f"presswear.commands.{module}").add(commands)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    try:
        with stoppable():
            words = sys.argv[1:] if argv is None else argv
            if list(words) == ["--version"]:
                print(f"presswear {version('presswear')}")
                return 0
            arguments = parser_of(words).parse_args(words)
            from rich.console import Console

            return int(arguments.run(arguments, Console()))
    except InputError as error:
        _tell(str(error))
        return 2
    except RunFailed as error:
        _tell(str(error))
        return 1
    except OSError as error:
        _tell(f"{error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt as error:
        _tell(str(error) if error.args else "interrupted")
        return exit_code()
    # Behind a signal any error is one of being stopped: see ``tools.stopping``.
    except Exception:
        if not is_stopped():
            raise
        _tell("interrupted")
        return exit_code()


def _tell(problem: str) -> None:
    print(one_line(f"presswear: {problem}"), file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
