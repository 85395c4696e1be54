"""Parser of the command line, options that several commands share, and converters of values."""

import argparse
import math
import re
import shlex
from collections.abc import Callable, Collection, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from presswear.cli import COMMANDS
from presswear.tools.errors import InputError, nearest, unknown


class Parser(argparse.ArgumentParser):
    """Parser that reports an error in one line with the nearest right name."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        # It may stand before or after the command; neither may reset the value of the other.
        self.add_argument(
            "-v",
            "--verbose",
            action="store_true",
            default=argparse.SUPPRESS,
            help="log each step to standard error",
        )

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse as ``argparse`` does, and suggest names for unrecognized words."""
        arguments, rest = super().parse_known_args(args, namespace)
        if rest:
            options = self._option_string_actions
            hint = nearest(rest[0].partition("=")[0], options) or f"; see {self.prog} --help"
            setting = _intended_setting(rest, getattr(arguments, "scene", ""))
            if "--set" in options and setting:
                hint = f"; use --set {shlex.quote(setting)} to set a value of the scene"
            raise InputError(f"unrecognized arguments: {' '.join(rest)}{hint}")
        return arguments, rest

    def error(self, message: str) -> NoReturn:
        """Raise InputError instead of exiting."""
        command = re.match(r"argument COMMAND: invalid choice: '(.*?)' ", message)
        if command is not None:
            raise unknown("command", command[1], COMMANDS)
        message = re.sub(r"^argument (\S+): ", r"\1 ", message)
        raise InputError(f"{message}; see {self.prog} --help")


def _intended_setting(rest: Sequence[str], scene: str) -> str:
    """Return the value for ``--set`` that unrecognized words seem to mean, or an empty text."""
    from presswear.scene.catalog import SCENES  # slow to import
    from presswear.scene.settings import settings_of

    key, equals, value = rest[0].partition("=")
    if not key.startswith("-"):
        return rest[0] if equals else "KEY=VALUE"
    key = key.lstrip("-")
    settings = settings_of(SCENES[scene].make()) if scene in SCENES else ()
    if key not in {setting.key for setting in settings}:
        return ""
    return f"{key}={value or ' '.join(rest[1:2]) or 'VALUE'}"


class Commands:
    """Parsers of the commands.

    Attributes
    ----------
    parsers : dict
        Parser by name of the command.
    """

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        self._parsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
        self.parsers: dict[str, argparse.ArgumentParser] = {}

    def add_parser(self, name: str, **settings: Any) -> argparse.ArgumentParser:
        """Add the parser of a command."""
        self.parsers[name] = self._parsers.add_parser(name, help=COMMANDS[name][1], **settings)
        return self.parsers[name]


def parser_for(words: Sequence[str]) -> argparse.ArgumentParser:
    """Return a parser with the options of the command in ``words`` and the names of all others."""
    command = next((word for word in words if not word.startswith("-")), "")
    return parser_with([command] if command in COMMANDS else [])[0]


def parser_with(names: Collection[str]) -> tuple[argparse.ArgumentParser, Commands]:
    """Return a parser with the options of some commands and the names of all others."""
    parser = Parser(
        prog="presswear",
        description="Dynamics and wear of planar linkages with clearance in their joints.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    parser.add_argument("--version", action="store_true", help="print the version")
    commands = Commands(parser)
    modules = dict.fromkeys(COMMANDS[name][0] for name in names)
    for name, (module, _) in COMMANDS.items():
        if module not in modules:
            commands.add_parser(name)
    for module in modules:
        import_module(f"presswear.cli.{module}").add(commands)
    return parser, commands


def integer(low: int, high: int = 10**9) -> Callable[[str], int]:
    """Return a converter to a whole number within a range."""

    def convert(text: str) -> int:
        is_number = text.isascii() and text.isdigit() and len(text) <= len(f"{high}")
        if not (is_number and low <= int(text) <= high):
            limits = f"from {low}" if high == 10**9 else f"from {low} to {high}"
            raise argparse.ArgumentTypeError(f"{text[:80]}: must be a whole number {limits}")
        return int(text)

    return convert


def number(
    low: float = -math.inf, high: float = math.inf, unit: str = ""
) -> Callable[[str], float]:
    """Return a converter to a finite number within a range; ``unit`` appears in its message."""

    def convert(text: str) -> float:
        try:
            value = float(text) if "_" not in text else math.nan
        except ValueError:
            value = math.nan
        if not (low <= value <= high and math.isfinite(value)):
            limits = f" from {low:g} to {high:g}" if math.isfinite(high) else ""
            limits = f" from {low:g}" if not limits and math.isfinite(low) else limits
            of_unit = f" of {unit}" if unit else ""
            raise argparse.ArgumentTypeError(f"{text[:80]}: must be a number{of_unit}{limits}")
        return value

    return convert


def folder(text: str) -> Path:
    """Return a path; the empty text, which Path takes for the present folder, is refused."""
    if not text.strip():
        raise argparse.ArgumentTypeError("a name is expected")
    return Path(text)


def option(*flags: str, **settings: Any) -> argparse.ArgumentParser:
    """Return a parent parser with one option."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument(*flags, **settings)
    return parser


ENGINE = option(
    "--engine", help="exudyn (default: the smallest model), exudyn-tree, exudyn-joints or dae"
)
CYCLES = option("--cycles", help="cycles of each stage (default: until the wear maps converge)")
WEAR_UPDATES = option(
    "--wear-updates", metavar="N", help="number of wear updates, from 0; a stage runs after each"
)
SET = option(
    "--set",
    action="append",
    default=[],
    metavar="KEY=VALUE",
    help="set a value, with its unit; repeatable (see presswear list SCENE)",
)
JOBS = option(
    "--jobs", type=integer(1, 256), metavar="N", help="number of processes (default: all cores)"
)
RESUME = option(
    "--resume",
    action="store_true",
    help="continue in --out, with the same numbers as without interruption",
)
TRUST = option(
    "--trust",
    action="store_true",
    help="with --resume: execute the Python source code of user laws that is stored in --out",
)
LIMIT = option(
    "--limit",
    action="append",
    metavar="RESPONSE>=VALUE",
    help="of a sweep: lower or upper limit on a response, such as 'A.force_max<=15kN'; the report "
    "has the probability that it is violated; repeatable",
)


def out(default: str) -> argparse.ArgumentParser:
    """Return the parent parser with ``--out``."""
    return option("--out", type=folder, metavar="DIR", help=f"new folder (default {default})")
