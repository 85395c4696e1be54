"""``presswear list``, ``new``, ``show`` and ``completion``: scenes and their names in a shell."""

import argparse
import json
from dataclasses import replace
from itertools import chain
from pathlib import Path

from rich.console import Console

from presswear.cli import COMMANDS
from presswear.cli.parser import parser_with
from presswear.cli.terminal import load_scene, parse_settings, print_lines
from presswear.scene import schema as schemas
from presswear.scene.catalog import SCENES
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.files import SUFFIX, example_file
from presswear.scene.plausible import doubts
from presswear.scene.scene import ENGINES, Scene
from presswear.scene.setting_groups import settings_in_groups
from presswear.scene.settings import changed
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import check_ending, write_bytes
from presswear.tools.quantities import Quantity, parse_quantity

CHOICES = {"scene": SCENES, "engine": ENGINES, "conventions": CONVENTIONS}
SHELLS = ("bash", "zsh")
_MORE_SETTINGS = (
    "laws of contact, friction, oil and wear, conventions, engines, recording"
)


def list_scenes(arguments: argparse.Namespace, console: Console) -> int:
    """List the scenes, or the settings of a scene."""
    if arguments.scene is None:
        width = max(map(len, SCENES))
        for name, entry in SCENES.items():
            print_lines(console, f"{name:{width}} {entry.title}")
        return 0
    scene = load_scene(arguments.scene)
    groups = settings_in_groups(scene, arguments.all)
    shown = list(chain(*groups.values()))
    width = max(len(setting.key) for setting in shown)
    for title, settings in groups.items():
        lines = (f"{setting.key:{width}} {setting.described()}" for setting in settings)
        print_lines(console, f"{title}:", *lines, "")
    if not arguments.all:
        all_groups = settings_in_groups(scene, every=True)
        count = sum(map(len, all_groups.values())) - len(shown)
        print_lines(console, f"{count} more with --all: {_MORE_SETTINGS}")
    return 0


def new(arguments: argparse.Namespace, console: Console) -> int:
    """Write an example file, and the schema for editors beside it."""
    text = example_file(arguments.kind)
    file = arguments.file or Path(f"{arguments.kind}{SUFFIX}")
    if file.suffix != SUFFIX:
        raise InputError(f"{file}: the name must end in {SUFFIX}")
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except FileExistsError:
        raise InputError(f"{file} exists; name a new file") from None
    except OSError as error:
        raise InputError(f"{file} cannot be written: {error.strerror}") from None
    schema = file.with_name(schemas.FILE)
    write_bytes(schema, json.dumps(schemas.scene_schema(), indent=1).encode())
    print_lines(
        console,
        f"wrote {file}; run it with: presswear run {file}",
        f"wrote {schema}, with which an editor completes and checks it",
    )
    return 0


def show(arguments: argparse.Namespace, console: Console) -> int:
    """Draw the mechanism of a scene, or print its equations of motion."""
    scene = changed(load_scene(arguments.scene), parse_settings(arguments.set))
    if arguments.equations:
        text = _equations_of(scene)
        console.print(text, highlight=False, markup=False, soft_wrap=True)
        return 0
    time = parse_quantity("--at", arguments.at, Quantity("s"))
    file = arguments.out or Path(f"{scene.name}.png")
    check_ending(file, ".png", option="--out")
    from presswear.show.figures import save
    from presswear.show.figures.mechanism import labelled

    drawing = labelled(scene, time)
    save(replace(drawing, file=file.name), file.parent)
    warnings = [f"warning: {doubt}" for doubt in doubts(scene)]
    print_lines(console, drawing.caption, *warnings, f"picture in {file}")
    return 0


def _equations_of(scene: Scene) -> str:
    """Return the equations of motion of a scene as text; InputError where none can be written."""
    from presswear.physics.equations.writer import write_equations
    from presswear.physics.packed import pack

    linkage = scene.linkage()
    equations = write_equations(linkage, pack(linkage))
    if isinstance(equations, str):
        raise InputError(
            f"{scene.name}: no equations can be written in the fewest coordinates, because "
            f"{equations}; they have Lagrange multipliers"
        )
    return equations.listing


def completion(arguments: argparse.Namespace, console: Console) -> int:
    """Print a script of shtab for completion in a shell."""
    if arguments.shell not in SHELLS:
        raise unknown("shell", arguments.shell, SHELLS)
    import shtab  # for this command only

    # A shell completes word by word: commands of two words are left out.
    names = [name for name in COMMANDS if " " not in name]
    parser, parsers = parser_with(names, names)
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
