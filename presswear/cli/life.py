"""``presswear life``: after how many strokes a limit is passed, and how sure that is."""

import argparse
import re
from functools import partial
from typing import Any

from rich.console import Console

from presswear.cli.run import add_options, is_plain, run_or_go_on, with_options
from presswear.cli.terminal import (
    check_resumed,
    free_folder,
    goes_on,
    jobs_given,
    progress_bar,
    scene_given,
    settings_given,
)
from presswear.linkage.laws import MATERIALS
from presswear.scene.options import FOLLOWED, NEW, TURNED, Life
from presswear.scene.scene import Scene
from presswear.scene.settings import SET, changed
from presswear.tools.errors import InputError
from presswear.tools.processes import check_stopped

STAGES = "2"
"""Parts of the life between stages, of a scene that says nothing on it."""
OPTIONS = ("until", "at_most")
"""Fields of ``Life`` that have an option of their own."""


def add(commands: Any) -> None:
    """Add the parser of ``life``."""
    names = "; ".join(f"{name}: {own.text}" for name, own in FOLLOWED.items())
    life = commands.add_parser(
        "life",
        description="Wears the joints of a scene until the first of some limits is passed, and "
        "tells after how many strokes that is, with an interval.  Conventions are refined where "
        "nothing else is said.  Numbers that may be limited: " + names + ".",
        epilog="example: presswear life press-blanking --until 'depth > 0.05 mm' --engine dae",
    )
    life.add_argument("scene", help="a file, FILE.toml, or a scene (see presswear list)")
    life.add_argument(
        "--until",
        action="append",
        metavar="LIMIT",
        help=f"such as 'A.depth > 50 um'; repeatable, the first counts (default {Life().until})",
    )
    life.add_argument(
        "--at-most", help=f"strokes after which nothing is followed (default {Life().at_most:g})"
    )
    life.add_argument(
        "--replace",
        action="append",
        default=[],
        metavar="JOINT@STROKES",
        help="compare with the life where the bush of a joint is made new after so many strokes",
    )
    life.add_argument(
        "--turn",
        action="append",
        default=[],
        metavar="JOINT@STROKES",
        help="compare with the life where it is turned by half a turn then",
    )
    life.add_argument(
        "--compare",
        action="append",
        default=[],
        metavar="KEY=VALUE[,KEY=VALUE]",
        help="compare with the life where something else is, such as clearance=0.4mm or "
        "A.materials=316L-304L; repeatable",
    )
    life.add_argument(
        "--materials",
        action="store_true",
        help="compare with each joint made of each pair of materials in the table",
    )
    add_options(life, "results/SCENE-life, or results/lives")
    life.set_defaults(run=_run)


def _with_life(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """A scene with the life that the options ask for."""
    settings: dict[str, str] = {"life": Life.kind}
    if arguments.until:
        settings["life.until"] = ", ".join(arguments.until)
    for name in OPTIONS[1:]:
        given = getattr(arguments, name)
        if given is not None:
            settings[f"life.{name}"] = given
    told = {key for key, status in scene.origins.items() if status.startswith(SET)}
    told |= settings_given(arguments.set).keys()
    if arguments.conventions is None and not told & {"conventions", "wear_distribution", "contact"}:
        scene = changed(scene, {"conventions": "refined"})
    if scene.wear_updates == 0 and arguments.wear_updates is None and not told & {"wear_updates"}:
        scene = changed(scene, {"wear_updates": STAGES})
    return with_options(scene, arguments, settings)


def _others(scene: Scene, arguments: argparse.Namespace) -> dict[str, dict[str, str]]:
    """What the life is compared with: settings by what is different, in words."""
    found: dict[str, dict[str, str]] = {}
    for given, field, words in (
        (arguments.replace, NEW, "bush replaced"),
        (arguments.turn, TURNED, "bush turned"),
    ):
        for one in given:
            found[f"{words}: {one}"] = {f"life.{field}": one}
    for one in arguments.compare:
        found[one] = settings_given(one.split(","))
    if arguments.materials:
        for joint in scene.clearance_joints:
            own = scene.bearing(joint).materials.name
            for name in MATERIALS:
                if name != own:
                    found[f"{joint}.materials={name}"] = {f"{joint}.materials": name}
    return found


def _run(arguments: argparse.Namespace, console: Console) -> int:
    make = partial(_with_life, arguments=arguments)
    if arguments.replace or arguments.turn or arguments.compare or arguments.materials:
        _compare(make(scene_given(arguments.scene)), arguments, console)
        return 0
    bare = is_plain(arguments) and all(getattr(arguments, name) is None for name in OPTIONS)
    # One that is gone on with, without a word, is the one in its folder.
    goes_on = arguments.resume and arguments.out is not None
    return run_or_go_on(arguments, console, None if bare and goes_on else make)


def _compare(scene: Scene, arguments: argparse.Namespace, console: Console) -> None:
    """Run the life of a scene and of its variants, and print them in one table."""
    from presswear.campaign.campaign import run_scenes
    from presswear.results.life import life_ratio

    scenes = {"plain": scene}
    for label, settings in _others(scene, arguments).items():
        variant = changed(scene, settings)
        if variant.modelled() == scene.modelled():
            raise InputError(f"{label}: changes nothing, so there is nothing to compare")
        scenes[re.sub(r"[^A-Za-z0-9.+=,_-]+", "-", label).strip("-")] = variant
    check_resumed(arguments.resume, arguments.out)
    folder = arguments.out or free_folder("lives")
    if not arguments.resume and folder.exists() and any(folder.iterdir()):
        raise InputError(f"--out {folder}: it is not empty; name a new folder, or add --resume")
    go_on = f"the same command with --resume --out {folder} continues"
    fractions = dict.fromkeys(scenes, 0.0)
    with goes_on(go_on, folder, lambda: "finished lives are stored"), progress_bar(console) as bar:
        task = bar.add_task("lives", total=len(scenes))

        def show(name: str, fraction: float, words: str) -> None:
            check_stopped()
            fractions[name] = fraction
            done = sum(fractions.values())
            bar.update(task, completed=done, description=f"{name}: {words}")
            if fraction == 1.0:
                bar.console.print(f"finished {name}: {words}", highlight=False, soft_wrap=True)

        results = run_scenes(scenes, folder, jobs=jobs_given(arguments.jobs), on_progress=show)
    plain = results["plain"].life
    for name, result in results.items():
        life = result.life
        line = result.message if life is None else f"{life}"
        if life is not None and plain is not None and name != "plain":
            ratio, longer = life_ratio(life, plain)
            if ratio:
                line = f"{ratio} times as long, longer with a probability of {longer}; {line}"
        console.print(f"{name}: {line}", highlight=False, markup=False, soft_wrap=True)
    console.print(f"results in {folder}; presswear report FOLDER writes a report", highlight=False)
