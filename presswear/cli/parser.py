"""The parser of the command line: of the command that is called, or of all of them."""

import argparse
import re
import shlex
from collections.abc import Collection, Sequence
from importlib import import_module
from typing import Any, NoReturn

from presswear.cli import COMMANDS
from presswear.tools.errors import InputError, nearest, unknown


class _Parser(argparse.ArgumentParser):
    """Tells errors of usage in one line, like every other, with the nearest right word."""

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        # Before or behind the command; one of them must not undo the other.
        self.add_argument(
            "-v",
            "--verbose",
            action="store_true",
            default=argparse.SUPPRESS,
            help="log to standard error what is done",
        )

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            known = self._option_string_actions
            hint = nearest(rest[0].partition("=")[0], known) or self._see
            if "--set" in known and (setting := _setting_meant(rest, getattr(found, "scene", ""))):
                hint = f"; a value of the scene is set by --set {shlex.quote(setting)}"
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


def _setting_meant(rest: Sequence[str], name: str) -> str:
    """What ``--set`` is to take, where words that no option takes seem to say it; or nothing.

    Parameters
    ----------
    name : str
        Of the scene that the other words name.
    """
    # Imported where something is wrong already.
    from presswear.scene.catalog import SCENES
    from presswear.scene.settings import settings_of

    key, equals, value = rest[0].partition("=")
    if not key.startswith("-"):
        return rest[0] if equals else "KEY=VALUE"
    key = key.lstrip("-")
    keys = {own.key for own in settings_of(SCENES[name].make())} if name in SCENES else set()
    return f"{key}={value or ' '.join(rest[1:2]) or 'VALUE'}" if key in keys else ""


class Commands:
    """Where commands add their parsers, each with the line of help that it has everywhere.

    Attributes
    ----------
    parsers : dict of str to ArgumentParser
        Those that were added, by their names.
    """

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        self._parsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
        self.parsers: dict[str, argparse.ArgumentParser] = {}

    def add_parser(self, name: str, **named: Any) -> argparse.ArgumentParser:
        """Add the parser of a command."""
        self.parsers[name] = self._parsers.add_parser(name, help=COMMANDS[name][1], **named)
        return self.parsers[name]


def parser_of(words: Sequence[str]) -> argparse.ArgumentParser:
    """The parser of the command that is called; of the others it knows names only."""
    called = next((word for word in words if not word.startswith("-")), "")
    return parser_with([called] if called in COMMANDS else [])[0]


def parser_with(names: Collection[str]) -> tuple[argparse.ArgumentParser, Commands]:
    """A parser that knows the options of some commands, and of others the names."""
    parser = _Parser(
        prog="presswear",
        description="Press linkages with worn joints: motion, contact and wear, in Exudyn.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    parser.add_argument("--version", action="store_true", help="tell the version and end")
    commands = Commands(parser)
    modules = dict.fromkeys(COMMANDS[name][0] for name in names)
    for name, (own, _) in COMMANDS.items():
        if own not in modules:
            commands.add_parser(name)
    for module in modules:
        import_module(f"presswear.cli.{module}").add(commands)
    return parser, commands
