"""``presswear list``, ``new`` and ``show``: scenes, files that describe them, their mechanism."""

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.terminal import add_settings, scene_given, settings_given
from presswear.linkage.linkage import Linkage, values_of
from presswear.scene.catalog import SCENES
from presswear.scene.files import EXAMPLES, SUFFIX, example_file
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, parse_quantity


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
    drawn = commands.add_parser(
        "show",
        epilog="example: presswear show my-press.toml --at 20ms --out my-press.png",
    )
    drawn.add_argument("scene", help="a file, FILE.toml, or a scene")
    drawn.add_argument("--at", default="0s", metavar="TIME", help="instant, with its unit")
    drawn.add_argument("--out", type=Path, metavar="FILE", help="picture, .png (default SCENE.png)")
    add_settings(drawn)
    drawn.set_defaults(run=_show)


def _show(arguments: argparse.Namespace, console: Console) -> int:
    scene = changed(scene_given(arguments.scene), settings_given(arguments.set))
    time = parse_quantity("--at", arguments.at, Quantity("s", -math.inf, math.inf, "", ""))
    file = arguments.out or Path(f"{scene.name}.png")
    if file.suffix != ".png":
        raise InputError(f"--out {file}: a name that ends in .png is expected")
    if not file.parent.is_dir():
        raise InputError(f"--out {file}: there is no folder {file.parent}")
    # Imported when everything that was typed is right: it takes most of a second.
    import matplotlib

    from presswear.show.figures import save
    from presswear.show.figures.mechanism import labelled
    from presswear.show.figures.style import SETTINGS

    with matplotlib.rc_context(SETTINGS):
        drawing = labelled(scene, time)
    save(replace(drawing, file=file.name), file.parent)
    console.print(f"{drawing.caption}", highlight=False)
    console.print(f"picture in {file}", highlight=False, soft_wrap=True)
    return 0


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
        titles = {name: entry.title for name, entry in SCENES.items()}
        width = max(map(len, titles))
        for name, title in titles.items():
            console.print(f"{name:{width}} {title}", highlight=False, soft_wrap=True)
        return 0
    scene = scene_given(arguments.scene)
    settings = tuple(settings_of(scene))
    if isinstance(scene.mechanism, Linkage):
        keys = {setting.key for setting in settings}
        for key, value, text in values_of(scene.mechanism):
            if key not in keys:
                line = f"{key:20} {value}  {text}".rstrip()
                console.print(line, highlight=False, soft_wrap=True)
    for setting in settings:
        console.print(f"{setting.key:20} {setting.described()}", highlight=False, soft_wrap=True)
    return 0
