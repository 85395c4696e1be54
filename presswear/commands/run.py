"""``presswear run`` and ``presswear report``: a scene or a study into its result folder."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import Progress, TaskID

from presswear.commands import precision, studies
from presswear.commands.stopping import check_stopped, go_on_with, is_stopped
from presswear.commands.terminal import (
    finished_part,
    folder_given,
    free_folder,
    progress_bar,
    seconds_given,
    settings_given,
)
from presswear.scene.catalog import SCENES, STUDIES, scene_named
from presswear.scene.scene import CONVENTIONS, Scene, stage_name
from presswear.scene.settings import changed
from presswear.studies.study import is_study
from presswear.tools.errors import InputError, RunError

if TYPE_CHECKING:
    from presswear.campaign.campaign import Stage
    from presswear.results.folder import ResultFolder

OPTIONS = ("engine", "cycles", "wears", "tolerance")
"""Settings that have an option of their own."""


LIVE_SIZE = (960, 640)
"""Of the window that shows a run, pixels."""


def add(commands: Any) -> None:
    """Add the parsers of ``run`` and ``report``."""
    run = commands.add_parser(
        "run",
        help="run a scene and write its result folder and report",
        epilog="example: presswear run wear-times --conventions refined --cycles 10 "
        "--set clearance=0.6mm --set 'speed=6pi rad/s' --set geometry=swapped",
    )
    run.add_argument("scene", help="one of: " + ", ".join((*SCENES, *STUDIES)))
    run.add_argument("--out", type=folder_given, help="new result folder (default results/SCENE)")
    run.add_argument(
        "--engine", help="exudyn (default: the smallest model), exudyn-tree, exudyn-joints or dae"
    )
    run.add_argument("--conventions", help="paper (as printed) or refined; default: the scene's")
    run.add_argument("--cycles", help="cycles of each stage; default: until the maps are known")
    run.add_argument("--wears", help="how often the joints are worn (0, 1, 2, ...)")
    run.add_argument("--tolerance", help="how well wear maps must be known (default 0.1)")
    run.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one value, with its unit; repeatable (see presswear list SCENE)",
    )
    run.add_argument("--jobs", default="1", metavar="N", help="of a study: runs at a time")
    run.add_argument(
        "--resume",
        action="store_true",
        help="go on with the run in --out, with the same numbers as if it had never stopped; "
        "without other options with those that it was started with",
    )
    run.add_argument(
        "--checkpoint",
        default="60",
        metavar="SECONDS",
        help="time between two checkpoints within a stage (default 60; 0: after every cycle)",
    )
    run.add_argument("--live", action="store_true", help="show the press in a window while it runs")
    run.set_defaults(run=_run)

    report = commands.add_parser(
        "report",
        help="figures and report anew from the folder of a run, a study or a precision",
        epilog="example: presswear report results/wear-times",
    )
    report.add_argument("folder", type=Path, metavar="DIR")
    report.set_defaults(run=_report)


def _scene_from(arguments: argparse.Namespace) -> Scene:
    """The scene that the options of ``run`` describe; InputError before anything runs."""
    return _with_options(scene_named(arguments.scene), arguments)


def _with_options(scene: Scene, arguments: argparse.Namespace) -> Scene:
    """A scene changed as the options of ``run`` say."""
    if arguments.conventions is not None:
        if arguments.conventions not in CONVENTIONS:
            raise InputError(
                f"--conventions {arguments.conventions}: allowed is one of {', '.join(CONVENTIONS)}"
            )
        scene = replace(scene, conventions=CONVENTIONS[arguments.conventions])
    settings = settings_given(arguments.set)
    for key in OPTIONS:
        given = getattr(arguments, key)
        if given is not None:
            if key in settings:
                raise InputError(f"--{key} and --set {key} are both given: one of them is meant")
            settings[key] = given
    return changed(scene, settings)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene in STUDIES:
        if arguments.live:
            raise InputError(f"--live is for scenes; {arguments.scene} is a study of several")
        change = partial(_with_options, arguments=arguments)
        return studies.run(arguments, console, None if _is_plain(arguments) else change)
    if arguments.jobs != "1":
        raise InputError(f"--jobs is for studies: {', '.join(STUDIES)}")
    interval = seconds_given("--checkpoint", arguments.checkpoint)
    if arguments.resume and arguments.out is None:
        raise InputError("--resume needs the folder to go on in: --out DIR")
    goes_on = arguments.resume and (arguments.out / "result.json").exists()
    told = goes_on and _is_plain(arguments)
    scene = _stored_scene(arguments) if told else _scene_from(arguments)
    folder = arguments.out if arguments.out is not None else free_folder(scene.name)
    from presswear.results.folder import ResultFolder
    from presswear.results.results import load
    from presswear.show.report import write_report

    with _window(arguments, scene) as live:
        store = ResultFolder(folder, scene, interval, arguments.resume)
        for remark in store.remarks:
            console.print(remark, highlight=False, soft_wrap=True)
        if store.is_finished:
            store.release()
            console.print(f"the run in {folder} has come to its end before", highlight=False)
        else:
            _run_into(store, scene, live, console)
    status, message = store.outcome
    report = write_report(load(folder))
    console.print(f"results in {folder}, report in {report}", highlight=False)
    if status == "failed":
        raise RunError(message)
    return 0


def _is_plain(arguments: argparse.Namespace) -> bool:
    """Whether nothing is said about the scene but its name."""
    options = (*OPTIONS, "conventions")
    return not arguments.set and all(getattr(arguments, key) is None for key in options)


def _stored_scene(arguments: argparse.Namespace) -> Scene:
    """The scene of the folder to go on in."""
    from presswear.results.results import read_document

    scene_named(arguments.scene)  # an unknown name is told first
    scene = Scene.from_dict(read_document(arguments.out)["scene"])
    if scene.name != arguments.scene:
        raise InputError(
            f"--out {arguments.out}: it holds a run of {scene.name}, not of {arguments.scene}"
        )
    return scene


def _run_into(
    store: "ResultFolder", scene: Scene, live: Callable[..., None], console: Console
) -> None:
    """Run a campaign into its folder, from where it stands."""
    from presswear.campaign.campaign import Watcher, run_campaign

    go_on = go_on_with(scene.name, store.path)
    with progress_bar(console) as bar:
        task = bar.add_task(stage_name(0), total=1.0)

        def progress(stage: int, part: float, word: str) -> None:
            check_stopped()
            description = f"{stage_name(stage)}{': ' if word else ''}{word}"
            bar.update(task, description=description)

        def finished(stage: "Stage") -> None:
            store.add(stage)
            bar.console.print(_model_line(stage), highlight=False)
            bar.console.print(_stage_line(stage), highlight=False)

        watcher = Watcher(progress, finished, partial(_completed, bar, task), live, store.keep)
        try:
            store.close(*run_campaign(scene, watcher, store.begun))
        except InputError:
            store.discard()
            raise
        except RunError as error:
            hint = f"; {go_on}" if store.path.exists() else ""
            raise RunError(f"{error}{hint}") from error
        except BaseException as error:
            if not isinstance(error, KeyboardInterrupt) and not is_stopped():
                raise
            kept = store.interrupt()
            raise KeyboardInterrupt(f"interrupted; kept up to {kept}; {go_on}") from None
        finally:
            store.release()


@contextmanager
def _window(arguments: argparse.Namespace, scene: Scene) -> Iterator[Callable[..., None]]:
    """What shows the run while it lasts, where that is asked for."""
    if not arguments.live:
        yield lambda stage, linkage, recorder: None
        return
    from presswear.show.replay.live import Live

    live = Live(scene, LIVE_SIZE)
    try:
        yield live.show
    finally:
        live.close()


def _completed(bar: Progress, task: TaskID, part: float) -> None:
    bar.update(task, completed=part)


def _model_line(stage: "Stage") -> str:
    """What was modelled, and by what it was solved."""
    told = stage.ensemble.diagnostics()
    return f"{stage_name(stage.index)}: {told['model']}. {told['solver']}"


def _stage_line(stage: "Stage") -> str:
    """One line on a finished stage: what ran, how finely, what came out."""
    numbers = stage.statistics
    ensemble = stage.ensemble
    steps = ensemble.diagnostics()["steps"]
    speed = ensemble.wall / ensemble.time if ensemble.time > 0.0 else float("nan")
    parts = [f"  {numbers['cycles']} cycles, {steps} steps, {speed:.2f} s per simulated second"]
    for name, joint in numbers.get("joints", {}).items():
        fewest = joint["fewest_steps_in_a_contact"]
        resolved = "no contact" if fewest is None else f"at least {fewest} steps in each"
        parts.append(
            f"{name}: {joint['contacts']} contacts, {resolved}, peak {joint['force_max_N']:.0f} N, "
            f"wear {1e9 * joint['wear_volume_m3']:.3g} mm^3"
        )
    return "; ".join(parts)


def _report(arguments: argparse.Namespace, console: Console) -> int:
    if is_study(arguments.folder):
        return studies.report(arguments.folder, console)
    if precision.is_precision(arguments.folder):
        return precision.report(arguments.folder, console)
    from presswear.show.report import write_report

    result = finished_part(arguments.folder, console)
    console.print(f"report in {write_report(result)}", highlight=False)
    return 0
