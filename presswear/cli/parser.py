"""Parser of the command line that ``commands.toml`` describes, and converters of values."""

import argparse
import math
import re
import shlex
from collections.abc import Callable, Collection, Sequence
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
        arguments, rest = super().parse_known_args(args, namespace)
        if rest:
            options = self._option_string_actions
            hint = nearest(rest[0].partition("=")[0], options)
            hint = hint or f"; see {self.prog} --help"
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
    from presswear.cli.terminal import load_scene  # slow to import
    from presswear.scene.setting_list import settings_of

    key, equals, value = rest[0].partition("=")
    if not key.startswith("-"):
        return rest[0] if equals else "KEY=VALUE"
    key = key.lstrip("-")
    if not scene:
        return ""
    try:
        keys = {setting.key for setting in settings_of(load_scene(scene))}
    except InputError:
        return ""
    if key not in keys:
        return ""
    following = rest[1] if len(rest) > 1 else ""
    return f"{key}={value or following or 'VALUE'}"


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
    return parser_with([command])[0]


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
        texts = _texts() if name in names else TEXTS
        parsers[name] = commands.add_parser(
            name,
            help=content["help"],
            description=content["description"].format(**texts) if name in names else "",
            epilog=f"example: {content['example']}",
        )
        if name in names:
            _add_arguments(parsers[name], content, texts)
    return parser, parsers


def _texts() -> dict[str, str]:
    """Return the texts that replace names in braces."""
    from presswear.scene.catalog import SCENES
    from presswear.scene.files import EXAMPLES
    from presswear.scene.options import LIFE_QUANTITIES, Life

    return {
        **TEXTS,
        "scenes": ", ".join(SCENES),
        "kinds": ", ".join(EXAMPLES),
        "until": Life().until,
        "at_most": f"{Life().at_most:g}",
        "quantities": "; ".join(
            f"{name}: {quantity.text}" for name, quantity in LIFE_QUANTITIES.items()
        ),
    }


def _add_arguments(
    parser: argparse.ArgumentParser, content: dict[str, Any], texts: dict[str, str]
) -> None:
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
        try:
            is_plain = text.isascii() and (
                text.isdigit() if kind == "integer" else "_" not in text
            )
            value = float(text) if is_plain else math.nan
        except ValueError:
            value = math.nan
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
    if match is None or not all(
        MIN_SIZE <= int(part) <= MAX_SIZE for part in match.groups()
    ):
        raise argparse.ArgumentTypeError(
            f"{text[:80]}: must be WIDTHxHEIGHT, each {MIN_SIZE} to {MAX_SIZE} pixels"
        )
    return int(match[1]), int(match[2])


CONVERTERS: dict[str, Callable[[str], Any]] = {
    "path": Path,
    "folder": folder,
    "size": size,
}
