"""``presswear completion``: completion in a shell, by shtab."""

import argparse

from rich.console import Console

from presswear.cli import COMMANDS
from presswear.cli.parser import parser_with
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import SCENES
from presswear.scene.scene import ENGINES
from presswear.tools.errors import not_installed, unknown

CHOICES = {"scene": SCENES, "engine": ENGINES, "conventions": CONVENTIONS}
SHELLS = ("bash", "zsh")


def completion(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    if arguments.shell not in SHELLS:
        raise unknown("shell", arguments.shell, SHELLS)
    try:
        import shtab
    except ImportError:
        raise not_installed("presswear completion", "shtab", "completion") from None
    parser, parsers = parser_with(COMMANDS)
    for command in parsers.values():
        command.description = None  # menus show the line of help
        for action in command._actions:
            if action.dest in CHOICES:
                action.choices = tuple(CHOICES[action.dest])
            elif action.metavar == "DIR":
                vars(action)["complete"] = shtab.DIRECTORY
            elif action.metavar == "FILE":
                vars(action)["complete"] = shtab.FILE
    console.file.write(f"{shtab.complete(parser, arguments.shell)}\n")
    return 0
