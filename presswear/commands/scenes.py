"""``presswear list``: the scenes, and what can be set in one."""

import argparse
from typing import Any

from rich.console import Console

from presswear.scene.catalog import SCENES, STUDIES, scene_named
from presswear.scene.settings import settings_of


def add(commands: Any) -> None:
    """Add the parser of ``list``."""
    shown = commands.add_parser(
        "list",
        help="the scenes, one line each; or everything that can be set in one",
        epilog="example: presswear list wear-times",
    )
    shown.add_argument("scene", nargs="?", help="list what --set can change in this scene")
    shown.set_defaults(run=_list)


def _list(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene is None:
        for scene in SCENES.values():
            console.print(f"{scene().name:12} {scene().title}", highlight=False)
        for name, title in STUDIES.items():
            console.print(f"{name:12} {title}", highlight=False)
        return 0
    for setting in settings_of(scene_named(arguments.scene)):
        console.print(f"{setting.key:20} {setting.described()}", highlight=False, soft_wrap=True)
    return 0
