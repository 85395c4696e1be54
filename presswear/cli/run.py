"""``presswear run``: a scene into its result folder."""

import argparse
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli import terminal
from presswear.cli.run_observer import RunObserver, least_needed
from presswear.scene.catalog import title_of
from presswear.scene.differences import changes_from
from presswear.scene.files import SUFFIX
from presswear.scene.plausible import doubts
from presswear.scene.scene import Scene
from presswear.scene.setting_list import SET
from presswear.scene.settings import changed, on_surfaces
from presswear.tools.errors import InputError, RunFailed

if TYPE_CHECKING:
    from presswear.results.folder import ResultFolder
    from presswear.results.result import Result

OPTIONS = ("conventions", "engine", "cycles", "wear_updates", "tolerance")


def has_no_options(arguments: argparse.Namespace) -> bool:
    """Return whether no option changes the scene."""
    values = (arguments.surfaces, *(getattr(arguments, key) for key in OPTIONS))
    return not arguments.set and all(value is None for value in values)


def with_options(scene: Scene, arguments: argparse.Namespace, **more: Any) -> Scene:
    """Return the scene changed by the options, and by ``more`` settings; checked."""
    options = {key: getattr(arguments, key) for key in OPTIONS} | more
    settings = terminal.parse_settings(arguments.set)
    scene = changed(scene, terminal.merge_options(settings, options))
    if arguments.surfaces is not None:
        from presswear.results.result import read_surfaces

        scene = on_surfaces(
            scene, read_surfaces(arguments.surfaces), arguments.surfaces
        )
    scene.check()
    return scene


def run(arguments: argparse.Namespace, console: Console) -> int:
    """Run a scene into its result folder."""
    if has_no_options(arguments):
        return run_scene(arguments, console, None)
    return run_scene(arguments, console, partial(with_options, arguments=arguments))


def run_scene(
    arguments: argparse.Namespace,
    console: Console,
    change: Callable[[Scene], Scene] | None,
) -> int:
    """Run or resume a scene, write its report, and return the exit code.

    ``change`` applies the options; without options a resumed run uses its stored scene
    and needs no scene file.
    """
    terminal.check_resume(arguments.resume, arguments.out)
    scene, remarks = _scene_to_run(arguments, change)
    name = f"{scene.name}-life" if scene.life else scene.name
    unfinished = None if arguments.out else terminal.unfinished_folder(name)
    if unfinished is not None:
        advice = terminal.resume_command(arguments, unfinished, scene)
        remarks.append(f"{unfinished} holds an unfinished run; {advice}")
    folder = arguments.out or terminal.free_folder(name)
    from presswear.results.folder import ResultFolder  # slow to import
    from presswear.results.result import load

    store = ResultFolder(folder, scene, arguments.checkpoint, arguments.resume)
    _print_start(store, scene, remarks, console)
    _run_into(store, scene, arguments, console)
    return finish(load(folder), arguments, console)


def _scene_to_run(
    arguments: argparse.Namespace, change: Callable[[Scene], Scene] | None
) -> tuple[Scene, list[str]]:
    """Return the scene with its changes, or the stored one of a run to resume, with remarks."""
    is_stored = arguments.resume and (arguments.out / "result.json").exists()
    if is_stored and change is None:
        return _stored_scene(arguments)
    scene = terminal.load_scene(arguments.scene)
    return scene if change is None else change(scene), []


def _print_start(
    store: "ResultFolder", scene: Scene, remarks: list[str], console: Console
) -> None:
    """Print the title of a run, its warnings and what it needs."""
    from presswear.campaign.life_problem import fewest_cycles_of

    lines = [title_of(scene)]
    lines += [f"warning: {doubt}" for doubt in doubts(scene)]
    lines += store.remarks
    if scene.life and not (scene.is_quick or store.is_finished or store.resumed):
        lines.append(f"the life {least_needed(fewest_cycles_of(scene))}")
    lines += remarks
    if store.is_finished:
        lines.append(f"the run in {store.path} is already complete")
    terminal.print_lines(console, *lines)


def _run_into(
    store: "ResultFolder",
    scene: Scene,
    arguments: argparse.Namespace,
    console: Console,
) -> None:
    """Run a scene into its folder with a progress bar; a run that is stopped says how to go on."""
    from presswear.campaign.runs import run_into, workers_of

    has_report = not (arguments.no_report or store.is_finished)
    command = terminal.resume_command(arguments, store.path, scene)
    try:
        with (
            terminal.resumable(command, store.path, lambda: store.stored_part),
            terminal.progress_bar(console) as bar,
        ):
            observers = [RunObserver(bar, scene, arguments.yes)]
            with workers_of(
                scene, arguments.jobs, observers, store.interval
            ) as workers:
                if workers.count > 1 and has_report:
                    Thread(target=_prepare_report, args=(scene,), daemon=True).start()
                run_into(store, scene, observers, workers)
    except InputError as error:
        raise InputError(f"{arguments.scene}: {error}") from None


def finish(result: "Result", arguments: argparse.Namespace, console: Console) -> int:
    """Write the report of a stored run, print what it tells at the end, return the exit code."""
    from presswear.results.run_warnings import run_warnings

    folder = result.path
    readings = getattr(arguments, "readings", None)
    if readings is not None and folder is not None:
        from presswear.results.readings import store_readings

        store_readings(folder, readings)
    if arguments.no_report:
        terminal.print_lines(console, f"results in {folder}")
    else:
        from presswear.show.report import write_report

        with console.status("drawing the figures") as line:
            report = write_report(
                result,
                lambda count: line.update(f"drawing {count} figures"),
                has_all_figures=False,
            )
        terminal.print_lines(console, f"results in {folder}, report in {report}")
    terminal.print_lines(console, *run_warnings(result.scene, result.stages))
    if result.status == "failed":
        raise RunFailed(result.message)
    if result.status == "unconverged":
        terminal.print_lines(console, f"not converged: {result.message}")
    if readings is not None:
        from presswear.results.life_from_readings import remaining_life

        terminal.print_lines(console, *remaining_life(result, readings).lines)
    return 0


def _prepare_report(scene: Scene) -> None:
    """Import and compile what the report needs, while other processes run the scene."""
    with suppress(Exception):  # the report itself tells of a problem
        from presswear.show.report import prepare

        prepare(scene)


def _stored_scene(arguments: argparse.Namespace) -> tuple[Scene, list[str]]:
    """Return the scene of the folder, and a remark if the scene that is named has changed."""
    from presswear.results.result import stored_scene

    scene, _ = stored_scene(arguments.out)
    if arguments.trust:
        scene.trust()
    if Path(arguments.scene) == arguments.out:
        return scene, []
    if scene.name != Path(arguments.scene).name.removesuffix(SUFFIX):
        raise InputError(
            f"--out {arguments.out}: it holds a run of {scene.name}, not of {arguments.scene}"
        )
    with suppress(InputError):  # the file may be gone
        changes = changes_from(scene, terminal.load_scene(arguments.scene))
        # An option of the command that started the run is no change of the file.
        edited = [change for change in changes if scene.origins.get(change.key) != SET]
        if edited:
            first = edited[0]
            unit = f" {first.unit}".rstrip()
            text = f"{arguments.scene} has changed: {first.key} = {first.value}{unit}, "
            text += f"stored is {first.was}{unit}. The stored scene is run. "
            text += "For a new run omit --resume and --out"
            return scene, [text]
    return scene, []
