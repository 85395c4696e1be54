"""Parser of the command line that ``commands.toml`` describes, and converters of values."""

import argparse
import math
import re
import shlex
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from presswear.cli import COMMANDS, SHARED, TEXTS
from presswear.tools.errors import InputError, nearest, unknown

# Width and height of a picture, pixels
MIN_SIZE = 160
MAX_SIZE = 4096


class Parser(argparse.ArgumentParser):
    """Parser that reports an error in one line with the nearest right name."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        # The option is allowed before and after the command. Without a default the parser
        # of the command does not reset the value that was set before the command.
        self.add_argument(
            "-v",
            "--verbose",
            action="store_true",
            default=argparse.SUPPRESS,
            help="log each step to standard error",
        )

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse as ``argparse`` does, and suggest names for unrecognized words."""
        arguments, unrecognized = super().parse_known_args(args, namespace)
        if unrecognized:
            options = self._option_string_actions
            option, _, _ = unrecognized[0].partition("=")
            hint = nearest(option, options) or f"; see {self.prog} --help"
            setting = _intended_setting(unrecognized, getattr(arguments, "scene", ""))
            if "--set" in options and setting:
                hint = f"; use --set {shlex.quote(setting)} to set a value of the scene"
            words = " ".join(unrecognized)
            raise InputError(f"unrecognized arguments: {words}{hint}")
        return arguments, unrecognized

    def error(self, message: str) -> NoReturn:
        """Raise InputError instead of exiting."""
        command = re.match(r"argument COMMAND: invalid choice: '(.*?)' ", message)
        if command is not None:
            raise unknown("command", command[1], COMMANDS)
        message = re.sub(r"^argument (\S+): ", r"\1 ", message)
        raise InputError(f"{message}; see {self.prog} --help")


def _intended_setting(unrecognized: Sequence[str], scene: str) -> str:
    """Return the value for ``--set`` that unrecognized words seem to mean, or an empty text."""
    from presswear.cli.terminal import load_scene  # slow to import
    from presswear.scene.setting_list import settings_of

    first, *others = unrecognized
    key, equals, value = first.partition("=")
    if not key.startswith("-"):
        return first if equals else "KEY=VALUE"
    key = key.lstrip("-")
    if not scene:
        return ""
    try:
        keys = {setting.key for setting in settings_of(load_scene(scene))}
    except InputError:
        return ""
    if key not in keys:
        return ""
    if not value:
        value = others[0] if others else "VALUE"
    return f"{key}={value}"


def with_joined_command(words: Sequence[str]) -> list[str]:
    """Return the words of a command line, with a command of two words as one element.

    ``["dynamics", "settle", "DIR"]`` becomes ``["dynamics settle", "DIR"]``.
    """
    first = next((k for k, word in enumerate(words) if not word.startswith("-")), 0)
    command = " ".join(words[first : first + 2])
    if command not in COMMANDS:
        return list(words)
    return [*words[:first], command, *words[first + 2 :]]


def parser_for(words: Sequence[str]) -> Parser:
    """Return a parser with the options of the command in ``words`` and the names of all others.

    ``words`` are those of ``with_joined_command``.
    """
    command = next((word for word in words if not word.startswith("-")), "")
    parser, _ = parser_with([command])
    return parser


def parser_with(
    names: Collection[str], listed: Collection[str] = tuple(COMMANDS)
) -> tuple[Parser, dict[str, Parser]]:
    """Return a parser with the options of some commands, and the parser of each listed command."""
    parser = Parser(
        prog="presswear",
        description="Dynamics and wear of planar linkages with clearance in their joints.",
        epilog="example: presswear run wear-times --cycles 5; presswear help run",
    )
    parser.add_argument("--version", action="store_true", help="print the version")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    parsers = {}
    for name in listed:
        content = COMMANDS[name]
        command = commands.add_parser(
            name,
            help=content["help"],
            description="",
            epilog=f"example: {content['example']}",
        )
        if name in names:
            texts = _texts()
            command.description = content["description"].format(**texts)
            _add_arguments(command, content, texts)
        parsers[name] = command
    return parser, parsers


def _texts() -> dict[str, str]:
    """Return the texts that replace names in braces."""
    from presswear.scene.catalog import SCENES
    from presswear.scene.files import EXAMPLES
    from presswear.scene.options import LIFE_QUANTITIES, Life

    quantities = []
    for name, quantity in LIFE_QUANTITIES.items():
        quantities.append(f"{name}: {quantity.text}")
    return {
        **TEXTS,
        "scenes": ", ".join(SCENES),
        "kinds": ", ".join(EXAMPLES),
        "until": Life().until,
        "at_most": f"{Life().at_most:g}",
        "quantities": "; ".join(quantities),
    }


def _add_arguments(
    parser: argparse.ArgumentParser, content: dict[str, Any], texts: dict[str, str]
) -> None:
    """Add the arguments of a command to its parser, with ``texts`` in their helps."""
    shared = {name: SHARED[name] for name in content.get("shared", ())}
    arguments = {**shared, **content.get("arguments", {})}
    # argparse cannot print the help of an empty group.
    has_group = any("exclusive" in settings for settings in arguments.values())
    exclusive = parser.add_mutually_exclusive_group() if has_group else parser
    for name, settings in arguments.items():
        settings = dict(settings)
        settings["help"] = settings["help"].format(**texts, out=content.get("out", ""))
        if "type" in settings:
            kind, *limits = settings["type"].split()
            settings["type"] = number(kind, *limits) if limits else CONVERTERS[kind]
        group = exclusive if settings.pop("exclusive", False) else parser
        group.add_argument(name, **settings)


def number(
    kind: str, least: str, most: str = "", unit: str = ""
) -> Callable[[str], float]:
    """Return a converter to an ``integer`` or a finite ``number`` within a range."""
    low = float(least)
    high = float(most or "1e9")
    what = "a whole number" if kind == "integer" else "a number"
    of_unit = f" of {unit}" if unit else ""
    to_most = f" to {most}" if most else ""

    def convert(text: str) -> float:
        # Python would take underscores, and digits of all scripts.
        is_plain = text.isascii() and "_" not in text
        if kind == "integer":
            is_plain = text.isascii() and text.isdigit()
        value = math.nan
        if is_plain:
            with suppress(ValueError):
                value = float(text)
        if not low <= value <= high:
            message = f"{text[:80]}: must be {what}{of_unit} from {least}{to_most}"
            raise argparse.ArgumentTypeError(message)
        return int(value) if kind == "integer" else value

    return convert


def folder(text: str) -> Path:
    """Return a path; an empty text is refused, which ``Path`` takes for the present folder."""
    if not text.strip():
        raise argparse.ArgumentTypeError("a name is expected")
    return Path(text)


def size(text: str) -> tuple[int, int]:
    """Return width and height of a picture, pixels."""
    match = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text)
    width, height = map(int, match.groups()) if match else (0, 0)
    if not MIN_SIZE <= min(width, height) <= max(width, height) <= MAX_SIZE:
        raise argparse.ArgumentTypeError(
            f"{text[:80]}: must be WIDTHxHEIGHT, each {MIN_SIZE} to {MAX_SIZE} pixels"
        )
    return width, height


CONVERTERS: dict[str, Callable[[str], Any]] = {
    "path": Path,
    "folder": folder,
    "size": size,
}
