"""``presswear list``: the scenes, and what can be set in one; ``presswear new``: a file of one."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.commands.terminal import scene_given
from presswear.linkage.elements import Linkage
from presswear.linkage.written import values_of
from presswear.scene.catalog import SCENES
from presswear.scene.files import EXAMPLES, SUFFIX, example_file
from presswear.scene.settings import settings_of
from presswear.studies import STUDIES
from presswear.tools.errors import InputError


def add(commands: Any) -> None:
    """Add the parser of ``list``."""
    shown = commands.add_parser(
        "list",
        epilog="example: presswear list wear-times",
    )
    shown.add_argument(
        "scene", nargs="?", help="list what --set can change in this scene, or FILE.toml"
    )
    shown.set_defaults(run=_list)
    new = commands.add_parser(
        "new",
        epilog="example: presswear new four-bar my-press.toml",
    )
    new.add_argument("kind", help="the mechanism to begin with: " + ", ".join(EXAMPLES))
    new.add_argument("file", type=Path, metavar="FILE", help="a new file, NAME.toml")
    new.set_defaults(run=_new)


def _new(arguments: argparse.Namespace, console: Console) -> int:
    text, file = example_file(arguments.kind), arguments.file
    if file.suffix != SUFFIX:
        raise InputError(f"{file}: a name that ends in {SUFFIX} is expected")
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except OSError as error:
        raise InputError(f"{file} cannot be written: {error.strerror}") from None
    console.print(f"{file} is written; presswear run {file}", highlight=False, soft_wrap=True)
    return 0


def _list(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene is None:
        for name, entry in SCENES.items():
            console.print(f"{name:12} {entry.title}", highlight=False)
        for name, title in STUDIES.items():
            console.print(f"{name:12} {title}", highlight=False)
        return 0
    scene = scene_given(arguments.scene)
    if isinstance(scene.mechanism, Linkage):
        for key, value, text in values_of(scene.mechanism):
            console.print(f"{key:20} {value}  {text}".rstrip(), highlight=False, soft_wrap=True)
    for setting in settings_of(scene):
        console.print(f"{setting.key:20} {setting.described()}", highlight=False, soft_wrap=True)
    return 0
