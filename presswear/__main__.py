"""The command line: what commands there are, and how they end.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 and 143 stopped by SIGINT and
SIGTERM.
"""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, NoReturn

from presswear.commands.stopping import exit_code, is_stopped, stoppable
from presswear.tools.errors import InputError, RunError, one_line

if TYPE_CHECKING:
    import argparse


def _parser() -> "argparse.ArgumentParser":
    # Imported when a signal is answered already: it takes most of a second.
    import argparse

    from presswear.commands import costs, crosscheck, precision, replay, run, scenes, verify

    class _Parser(argparse.ArgumentParser):
        """Errors of usage in one line, like every other."""

        def error(self, message: str) -> NoReturn:
            raise InputError(f"{message}; see {self.prog} --help")

    parser = _Parser(
        prog="presswear",
        description="Press linkages with worn joints: motion, contact and wear, in Exudyn.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in (scenes, run, replay, verify, crosscheck, costs, precision):
        module.add(commands)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    try:
        with stoppable():
            arguments = _parser().parse_args(argv)
            from rich.console import Console

            return int(arguments.run(arguments, Console()))
    except InputError as error:
        _tell(str(error))
        return 2
    except RunError as error:
        _tell(str(error))
        return 1
    except OSError as error:
        _tell(f"{error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt as error:
        _tell(str(error) if error.args else "interrupted")
        return exit_code()
    except Exception:
        if not is_stopped():
            raise
        _tell("interrupted")
        return exit_code()


def _tell(problem: str) -> None:
    print(one_line(f"presswear: {problem}"), file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
