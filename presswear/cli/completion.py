"""``presswear completion``: words for a shell to complete, by shtab."""

import argparse
from typing import Any

from rich.console import Console

from presswear.cli import COMMANDS
from presswear.cli.parser import parser_with
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import SCENES
from presswear.scene.scene import ENGINES
from presswear.tools.errors import not_installed, unknown

_WORDS = {
    "scene": tuple(SCENES),
    "engine": tuple(ENGINES),
    "conventions": tuple(CONVENTIONS),
}
"""What some arguments and options are, by their names."""


def add(commands: Any) -> None:
    """Add the parser of ``completion``."""
    parser = commands.add_parser(
        "completion",
        description="Prints a script by which a shell completes commands, options, scenes, files "
        "and folders. Bash reads it from a file that ~/.bashrc names: source "
        "~/.presswear-completion; zsh from a file _presswear in a folder of $fpath.",
        epilog="example: presswear completion bash > ~/.presswear-completion",
    )
    parser.add_argument("shell", help="bash or zsh")
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    shells = ("bash", "zsh")
    if arguments.shell not in shells:
        raise unknown("shell", arguments.shell, shells)
    try:
        import shtab
    except ImportError:
        raise not_installed("presswear completion", "shtab", "completion") from None
    parser, commands = parser_with(COMMANDS)
    for own in commands.parsers.values():
        own.description = None  # a menu has room for the line of help
        for action in own._actions:
            if action.dest in _WORDS:
                action.choices = _WORDS[action.dest]
            elif action.metavar == "DIR" or action.dest == "out":
                vars(action)["complete"] = shtab.DIRECTORY
            elif action.metavar == "FILE":
                vars(action)["complete"] = shtab.FILE
    console.file.write(f"{shtab.complete(parser, arguments.shell)}\n")
    return 0
