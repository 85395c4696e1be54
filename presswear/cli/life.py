"""``presswear life``: strokes until a limit is exceeded, and comparisons of service lives."""

import argparse
import re
from functools import partial

from rich.console import Console

from presswear.cli import terminal
from presswear.cli.run import (
    has_no_options,
    run_scene,
    with_options,
)
from presswear.linkage.laws import MATERIALS
from presswear.scene.options import NEW, TURNED, Life
from presswear.scene.scene import Scene
from presswear.scene.settings import SET, changed
from presswear.tools.errors import InputError
from presswear.tools.processes import check_stopped

WEAR_UPDATES = "2"  # stages through the life of a scene that does not specify them


def life(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    change = partial(_with_life, arguments=arguments)
    if arguments.replace or arguments.turn or arguments.compare or arguments.materials:
        return _compare(change(terminal.load_scene(arguments.scene)), arguments, console)
    is_plain = has_no_options(arguments) and not arguments.until and arguments.at_most is None
    is_resumed = arguments.resume and arguments.out is not None
    return run_scene(arguments, console, None if is_plain and is_resumed else change)


def _with_life(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """Return the scene with the life and the defaults of this command."""
    specified = {key for key, origin in scene.origins.items() if origin.startswith(SET)}
    specified |= terminal.parse_settings(arguments.set).keys()
    wear = {"conventions", "wear_distribution", "contact"}
    if arguments.conventions is None and not specified & wear:
        scene = changed(scene, {"conventions": "refined"})
    is_open = arguments.wear_updates is None and "wear_updates" not in specified
    if scene.wear_updates == 0 and is_open:
        scene = changed(scene, {"wear_updates": WEAR_UPDATES})
    life = {
        "life": Life.kind,
        "life.until": ", ".join(arguments.until) if arguments.until else None,
        "life.at_most": arguments.at_most,
    }
    return with_options(scene, arguments, **life)


def _variants(scene: Scene, arguments: argparse.Namespace) -> dict[str, dict[str, str]]:
    """Return the settings of the lives to compare with, by label."""
    variants = {f"bush replaced: {each}": {f"life.{NEW}": each} for each in arguments.replace}
    variants |= {f"bush turned: {each}": {f"life.{TURNED}": each} for each in arguments.turn}
    variants |= {each: terminal.parse_settings(each.split(",")) for each in arguments.compare}
    if arguments.materials:
        for joint in scene.clearance_joints:
            for name in MATERIALS:
                if name != scene.bearing(joint).materials.name:
                    variants[f"{joint}.materials={name}"] = {f"{joint}.materials": name}
    return variants


def _compare(scene: Scene, arguments: argparse.Namespace, console: Console) -> int:
    """Run the life of a scene and of its variants, and print all of them."""
    from presswear.campaign.campaign import run_scenes
    from presswear.results.life import life_ratio

    scenes = {"plain": scene}
    for label, settings in _variants(scene, arguments).items():
        variant = changed(scene, settings)
        if variant.modelled() == scene.modelled():
            raise InputError(f"{label}: changes nothing, so there is nothing to compare")
        scenes[re.sub(r"[^A-Za-z0-9.+=,_-]+", "-", label).strip("-")] = variant
    folder = terminal.output_folder(arguments, "lives")
    command = f"the same command with --resume --out {folder} continues"
    shares = dict.fromkeys(scenes, 0.0)
    with (
        terminal.resumable(command, folder, lambda: "finished lives are stored"),
        terminal.progress_bar(console) as bar,
    ):
        task = bar.add_task("lives", total=len(scenes))

        def show(name: str, share: float, words: str) -> None:
            check_stopped()
            shares[name] = share
            bar.update(task, completed=sum(shares.values()), description=f"{name}: {words}")
            if share == 1.0:
                terminal.print_lines(bar.console, f"finished {name}: {words}")

        results = run_scenes(scenes, folder, jobs=arguments.jobs, on_progress=show)
    plain = results["plain"].life
    for name, result in results.items():
        life = result.life
        line = result.message if life is None else f"{life}"
        if life is not None and plain is not None and name != "plain":
            ratio, longer = life_ratio(life, plain)
            if ratio:
                line = f"{ratio} times as long, longer with a probability of {longer}; {line}"
        terminal.print_lines(console, f"{name}: {line}")
    terminal.print_lines(console, f"results in {folder}; presswear report FOLDER writes a report")
    return 0
