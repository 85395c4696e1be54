"""``presswear list``: the scenes, and what can be set in one."""

import argparse
from typing import Any

from rich.console import Console

from presswear.commands.terminal import scene_given
from presswear.scene.catalog import SCENES
from presswear.scene.settings import settings_of
from presswear.studies import STUDIES


def add(commands: Any) -> None:
    """Add the parser of ``list``."""
    shown = commands.add_parser(
        "list",
        epilog="example: presswear list wear-times",
    )
    shown.add_argument("scene", nargs="?", help="list what --set can change in this scene")
    shown.set_defaults(run=_list)


def _list(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene is None:
        for name, scene in SCENES.items():
            console.print(f"{name:12} {scene.title}", highlight=False)
        for name, title in STUDIES.items():
            console.print(f"{name:12} {title}", highlight=False)
        return 0
    for setting in settings_of(scene_given(arguments.scene)):
        console.print(f"{setting.key:20} {setting.described()}", highlight=False, soft_wrap=True)
    return 0
