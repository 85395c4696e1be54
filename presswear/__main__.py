"""The command line: what commands there are, and how they end.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 interrupted.
"""

import argparse
import sys
from collections.abc import Sequence
from typing import NoReturn

from rich.console import Console

from presswear.commands import costs, crosscheck, precision, run, scenes, verify
from presswear.errors import InputError, RunError, one_line

COMMANDS = (scenes, run, verify, crosscheck, costs, precision)
"""In the order in which help lists them."""


class _Parser(argparse.ArgumentParser):
    """Errors of usage in one line, like every other."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; see {self.prog} --help")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="presswear",
        description="Press linkages with worn joints: motion, contact and wear, in Exudyn.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in COMMANDS:
        module.add(commands)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    console = Console()
    problem = Console(stderr=True, soft_wrap=True, highlight=False, markup=False, emoji=False)

    def tell(text: str) -> None:
        problem.print(one_line(f"presswear: {text}"))

    try:
        arguments = _parser().parse_args(argv)
        return int(arguments.run(arguments, console))
    except InputError as error:
        tell(f"{error}")
        return 2
    except RunError as error:
        tell(f"{error}")
        return 1
    except OSError as error:
        tell(f"{error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt:
        tell("interrupted; finished stages are kept")
        return 130


if __name__ == "__main__":
    sys.exit(main())
