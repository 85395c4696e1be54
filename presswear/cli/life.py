"""``presswear life``: the service life of a scene, or several of them compared."""

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path

from rich.console import Console
from rich.progress import Progress as ProgressBar

from presswear.cli import terminal
from presswear.cli.run import finish, has_no_options, run_scene, with_options
from presswear.cli.run_observer import (
    confirm,
    expected_time,
    least_needed,
    needed,
)
from presswear.cli.several_runs import several_runs
from presswear.linkage.materials import MATERIALS, listed_pair
from presswear.scene.options import Life
from presswear.scene.scene import Scene
from presswear.scene.setting_list import SET
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.files import name_for
from presswear.tools.processes import cores

WEAR_UPDATES = "2"  # stages through the life of a scene that does not specify them


def life(arguments: argparse.Namespace, console: Console) -> int:
    """Run a service life, or compare several."""
    change: Callable[[Scene], Scene] = partial(_with_life, arguments=arguments)
    if arguments.readings is not None:
        change = partial(_with_readings, arguments=arguments)
    if _changes_a_life(arguments):
        return _compare(
            change(terminal.load_scene(arguments.scene)), arguments, console
        )
    is_plain = has_no_options(arguments) and not (arguments.until or arguments.quick)
    is_plain = is_plain and arguments.at_most is None
    is_resumed = arguments.resume and arguments.out is not None
    is_folder = (Path(arguments.scene) / "result.json").exists()
    if arguments.readings is not None and is_plain and is_folder:
        result = terminal.load_result(Path(arguments.scene), console)
        from presswear.results.life_from_readings import remaining_life

        remaining_life(result, arguments.readings)  # nothing is stored if it is wrong
        return finish(result, arguments, console)
    return run_scene(arguments, console, None if is_plain and is_resumed else change)


def _with_life(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """Return the scene with the life and the defaults of this command."""
    specified = {key for key, origin in scene.origins.items() if origin.startswith(SET)}
    specified |= terminal.parse_settings(arguments.set).keys()
    wear = {"conventions", "wear_distribution", "contact"}
    if arguments.conventions is None and not specified & wear:
        scene = changed(scene, {"conventions": "refined"})
    is_open = arguments.wear_updates is None and "wear_updates" not in specified
    if is_open and (arguments.quick or scene.wear_updates == 0):
        scene = changed(
            scene, {"wear_updates": "1" if arguments.quick else WEAR_UPDATES}
        )
    limits = ", ".join(arguments.until) or None
    life = {"life": Life.kind, "life.until": limits, "life.at_most": arguments.at_most}
    life["life.quick"] = "on" if arguments.quick else None
    return with_options(scene, arguments, **life)


def _changes_a_life(arguments: argparse.Namespace) -> bool:
    """Return whether the life of the scene is compared with lives under changes."""
    names = ("replace", "rotate", "compare", "materials")
    return any(getattr(arguments, name) for name in names)


def _with_readings(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """Return the scene with the life of this command, checked for the readings."""
    from presswear.results.life_from_readings import check_for_life
    from presswear.results.readings import read_readings

    if _changes_a_life(arguments):
        raise InputError(
            "--readings is of one life: it cannot be combined with --replace, --rotate, "
            "--compare or --materials"
        )
    readings = read_readings(arguments.readings)
    scene = _with_life(scene, arguments)
    check_for_life(scene, readings)
    return scene


def _variants(scene: Scene, arguments: argparse.Namespace) -> dict[str, dict[str, str]]:
    """Return the settings of the lives to compare with, by label."""
    variants = {}
    for services in arguments.replace:
        variants[f"bush replaced: {services}"] = {"life.replaced": services}
    for services in arguments.rotate:
        variants[f"bush rotated: {services}"] = {"life.rotated": services}
    for settings in arguments.compare:
        variants[settings] = terminal.parse_settings(settings.split(","))
    if not arguments.materials:
        return variants
    for joint in scene.loose_pins:
        for name in MATERIALS:
            if name != listed_pair(scene.bearing(joint).materials):
                variants[f"{joint}.materials={name}"] = {f"{joint}.materials": name}
    return variants


def _compare(scene: Scene, arguments: argparse.Namespace, console: Console) -> int:
    """Run the life of a scene and of its variants, and print all of them."""
    from presswear.campaign.life_problem import fewest_cycles_of
    from presswear.campaign.runs import run_scenes
    from presswear.results.life import life_ratio

    scenes = {"plain": scene}
    for label, settings in _variants(scene, arguments).items():
        variant = changed(scene, settings)
        if variant.modelled() == scene.modelled():
            raise InputError(
                f"{label}: changes nothing, so there is nothing to compare"
            )
        scenes[name_for(label)] = variant
    folder = terminal.output_folder(arguments, "lives")
    if not scene.is_quick:
        terminal.print_lines(
            console, f"each life {least_needed(fewest_cycles_of(scene))}"
        )
    with several_runs(console, "lives", folder, len(scenes)) as (show, bar):
        together = min(arguments.jobs or cores(), len(scenes))
        announce = announcing(bar, len(scenes) / together, arguments.yes)
        results = run_scenes(scenes, folder, None, arguments.jobs, show, announce)
    plain = results["plain"].life
    for name, result in results.items():
        life = result.life
        line = result.message if life is None else f"{life}"
        if life is not None and plain is not None and name != "plain":
            ratio, longer = life_ratio(life, plain)
            if ratio:
                line = f"{ratio} times as long, longer with a probability of {longer}; {line}"
        terminal.print_lines(console, f"{name}: {line}")
    terminal.print_lines(
        console, f"results in {folder}; presswear report FOLDER writes a report"
    )
    return 0


def announcing(
    bar: ProgressBar, turns: float, is_confirmed: bool
) -> Callable[[str, float, float], None]:
    """Return a function for ``run_scenes`` that prints what each of several lives will take.

    All lives take about ``turns`` times as long as a single life. A user at a terminal is
    asked once.
    """
    has_answer = is_confirmed

    def announce(name: str, cycles: float, seconds: float) -> None:
        nonlocal has_answer
        total = turns * seconds
        words = f"{name}: the life {needed(cycles, seconds)}"
        text = f"{words}; all lives take {expected_time(total)}"
        terminal.print_lines(bar.console, text)
        has_answer = has_answer or confirm(bar, total)

    return announce
