"""``presswear run`` and ``presswear report``: a scene or a study into its result folder."""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import Progress, TaskID

from presswear.catalog import SCENES, STUDIES, scene_named
from presswear.commands import precision, studies
from presswear.commands.terminal import folder_given, free_folder, progress_bar, settings_given
from presswear.errors import InputError, RunError
from presswear.scene import CONVENTIONS, Scene, stage_name
from presswear.settings import changed
from presswear.studies import is_study

if TYPE_CHECKING:
    from presswear.campaign import Stage


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
        "--resume", action="store_true", help="of a study: keep the finished runs in --out"
    )
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
    for key in ("engine", "cycles", "wears", "tolerance"):
        given = getattr(arguments, key)
        if given is not None:
            if key in settings:
                raise InputError(f"--{key} and --set {key} are both given: one of them is meant")
            settings[key] = given
    return changed(scene, settings)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene in STUDIES:
        return studies.run(arguments, console, partial(_with_options, arguments=arguments))
    if arguments.resume or arguments.jobs != "1":
        raise InputError(f"--resume and --jobs are for studies: {', '.join(STUDIES)}")
    scene = _scene_from(arguments)
    folder = arguments.out if arguments.out is not None else free_folder(scene.name)
    from presswear.campaign import Watcher, run_campaign
    from presswear.report import write_report
    from presswear.results import ResultFolder, load

    store = ResultFolder(folder, scene)
    with progress_bar(console) as bar:
        task = bar.add_task(stage_name(0), total=1.0)

        def progress(stage: int, part: float, word: str) -> None:
            description = f"{stage_name(stage)}{': ' if word else ''}{word}"
            bar.update(task, description=description)

        def finished(stage: "Stage") -> None:
            store.add(stage)
            bar.console.print(_model_line(stage), highlight=False)
            bar.console.print(_stage_line(stage), highlight=False)

        try:
            overall = partial(_completed, bar, task)
            status, message = run_campaign(scene, Watcher(progress, finished, overall))
        except KeyboardInterrupt:
            store.close("interrupted", "stopped by the user; finished stages are kept")
            raise
        store.close(status, message)
    if not (folder / "result.json").exists():
        raise RunError(message)
    report = write_report(load(folder))
    console.print(f"results in {folder}, report in {report}", highlight=False)
    if status == "failed":
        raise RunError(message)
    return 0


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
    from presswear.report import write_report
    from presswear.results import load

    console.print(f"report in {write_report(load(arguments.folder))}", highlight=False)
    return 0
