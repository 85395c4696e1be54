"""``presswear run`` and ``presswear report``: a scene into its result folder."""

import argparse
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli.terminal import (
    add_limits,
    add_trust,
    check_resumed,
    finished_part,
    folder_given,
    free_folder,
    go_on_with,
    goes_on,
    jobs_given,
    progress_bar,
    scene_given,
    seconds_given,
    settings_given,
)
from presswear.scene.catalog import SCENES, title_of
from presswear.scene.files import SUFFIX
from presswear.scene.scene import Scene
from presswear.scene.settings import changed, on_surfaces
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import check_folder

if TYPE_CHECKING:
    from presswear.results.folder import ResultFolder
    from presswear.show.replay.output import Live

OPTIONS = ("conventions", "engine", "cycles", "wear_updates", "tolerance")
"""Settings that have an option of their own."""


LIVE_SIZE = (960, 640)
"""Size of the window that shows a run, pixels."""


def add(commands: Any) -> None:
    """Add the parsers of ``run`` and ``report``."""
    run = commands.add_parser(
        "run",
        epilog="example: presswear run wear-times --conventions refined --cycles 10 "
        "--set clearance=0.6mm --set 'speed=6pi rad/s' --set geometry=swapped",
    )
    run.add_argument("scene", help=f"a file, FILE.toml, or one of: {', '.join(SCENES)}")
    add_options(run, "results/SCENE")
    run.add_argument("--live", action="store_true", help="show the press in a window while it runs")
    run.set_defaults(run=_run)

    report = commands.add_parser(
        "report",
        epilog="example: presswear report results/wear-times",
    )
    report.add_argument("folder", type=Path, metavar="DIR")
    add_limits(report)
    report.set_defaults(run=_report)


def add_options(parser: Any, folder: str) -> None:
    """Add what ``run`` and ``life`` can be told about a scene and where it runs."""
    parser.add_argument("--out", type=folder_given, help=f"new result folder (default {folder})")
    parser.add_argument(
        "--engine", help="exudyn (default: the smallest model), exudyn-tree, exudyn-joints or dae"
    )
    parser.add_argument("--conventions", help="paper (as printed) or refined; default: the scene's")
    parser.add_argument("--cycles", help="cycles of each stage; default: until the maps are known")
    parser.add_argument("--wear-updates", help="how often the joints are worn (0, 1, 2, ...)")
    parser.add_argument("--tolerance", help="how well wear maps must be known (default 0.1)")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one value, with its unit; repeatable (see presswear list SCENE)",
    )
    parser.add_argument(
        "--surfaces",
        metavar="WHENCE",
        help="begin on worn ones: DIR:STAGE, those that a stage of another result ran on (1: "
        "those after its first wear, the mean of its starts; without :STAGE its last stage), or "
        "FILE.csv, measured ones, with a header such as joint,side,angle (deg),depth (um), side "
        "bearing or pin; other angles than the maps' own are resampled, the worn volume kept",
    )
    parser.add_argument("--jobs", metavar="N", help="runs at a time (default: all cores)")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on with the run in --out, with the same numbers as if it had never stopped; "
        "without other options with those that it was started with",
    )
    add_trust(parser)
    parser.add_argument(
        "--checkpoint",
        default="60",
        metavar="SECONDS",
        help="time between two checkpoints within a stage (default 60; 0: after every cycle)",
    )


def with_options(
    scene: Scene, arguments: argparse.Namespace, more: Mapping[str, str] | None = None
) -> Scene:
    """A scene changed as the options of ``run`` say, and ``more``; InputError before any run."""
    settings = settings_given(arguments.set)
    for key, value in (more or {}).items():
        if settings.setdefault(key, value) != value:
            raise InputError(f"{key} is given twice, as {value} and by --set: one of them is meant")
    for key in OPTIONS:
        given = getattr(arguments, key)
        if given is not None:
            if key in settings:
                option = key.replace("_", "-")
                raise InputError(f"--{option} and --set {key} cannot be combined")
            settings[key] = given
    scene = changed(scene, settings)
    if arguments.surfaces is not None:
        from presswear.results.result import read_surfaces

        scene = on_surfaces(scene, read_surfaces(arguments.surfaces), arguments.surfaces)
    scene.check()
    return scene


def _run(arguments: argparse.Namespace, console: Console) -> int:
    make = partial(with_options, arguments=arguments)
    return run_or_go_on(arguments, console, None if is_plain(arguments) else make)


def run_or_go_on(
    arguments: argparse.Namespace,
    console: Console,
    change: Callable[[Scene], Scene] | None,
) -> int:
    """Run a scene as the options say, or go on with it, and write its report.

    Parameters
    ----------
    change : callable or None
        Changes the scene that was named; None: nothing is said about it, and a run that is gone
        on with is the one in its folder.
    """
    jobs = jobs_given(arguments.jobs)
    interval = seconds_given("--checkpoint", arguments.checkpoint)
    check_resumed(arguments.resume, arguments.out)
    goes_on = arguments.resume and (arguments.out / "result.json").exists()
    if goes_on and change is None:
        # Neither its file nor those of its laws are needed any more.
        scene = _stored_scene(arguments)
    else:
        scene = scene_given(arguments.scene)
        scene = scene if change is None else change(scene)
    folder = arguments.out or free_folder(f"{scene.name}-life" if scene.life else scene.name)
    from presswear.results.folder import ResultFolder
    from presswear.results.press_analysis import deep_contacts
    from presswear.results.result import load

    with _window(arguments, scene) as window:
        store = ResultFolder(folder, scene, interval, arguments.resume)
        console.print(title_of(scene), highlight=False, markup=False, soft_wrap=True)
        for remark in store.remarks:
            console.print(remark, highlight=False, soft_wrap=True)
        if store.is_finished:
            console.print(f"the run in {folder} has come to its end before", highlight=False)
        _run_into(arguments, store, scene, jobs, window, console)
    from presswear.show.report import write_report

    result = load(folder)
    with console.status("drawing the report"):
        report = write_report(result)
    console.print(f"results in {folder}, report in {report}", highlight=False)
    for told in deep_contacts(result.scene, result.stages):
        console.print(told, highlight=False, markup=False, soft_wrap=True)
    if result.status == "failed":
        raise RunFailed(result.message)
    if result.status == "unconverged":
        console.print(f"not converged: {result.message}", highlight=False)
    return 0


def is_plain(arguments: argparse.Namespace) -> bool:
    """True where nothing is said about the scene but its name."""
    told = (arguments.surfaces, *(getattr(arguments, key) for key in OPTIONS))
    return not arguments.set and all(own is None for own in told)


def _stored_scene(arguments: argparse.Namespace) -> Scene:
    """The scene of the folder to go on in."""
    from presswear.results.result import stored_scene

    scene, _ = stored_scene(arguments.out)
    if arguments.trust:
        scene.trust()
    if scene.name != Path(arguments.scene).name.removesuffix(SUFFIX):
        raise InputError(
            f"--out {arguments.out}: it holds a run of {scene.name}, not of {arguments.scene}"
        )
    return scene


def _run_into(
    arguments: argparse.Namespace,
    store: "ResultFolder",
    scene: Scene,
    jobs: int | None,
    window: "Live | None",
    console: Console,
) -> None:
    """Run a scene into its folder, with progress on the terminal."""
    from presswear.campaign.campaign import run_into, workers_of
    from presswear.cli.running import Terminal

    go_on = go_on_with(scene.name, store.path, arguments.command, bool(scene.user_laws))
    try:
        with goes_on(go_on, store.path, lambda: store.kept), progress_bar(console) as bar:
            terminal = Terminal(bar, scene)
            observers = [terminal, *([window] if window else [])]
            with workers_of(scene, jobs, observers, store.interval) as workers:
                run_into(store, scene, observers, workers)
    except InputError as error:
        raise InputError(f"{arguments.scene}: {error}") from None


def _window(arguments: argparse.Namespace, scene: Scene) -> "AbstractContextManager[Live | None]":
    """The window that shows the run while it lasts, where that is asked for."""
    if not getattr(arguments, "live", False):
        return nullcontext()
    from presswear.show.replay.output import Live

    return closing(Live(scene, LIVE_SIZE))


def _report(arguments: argparse.Namespace, console: Console) -> int:
    check_folder(arguments.folder)
    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.report(arguments, console)
    if arguments.limit:
        raise InputError(f"--limit is for sweeps; {arguments.folder} is not the folder of one")
    from presswear.show.report import write_report

    result = finished_part(arguments.folder, console)
    console.print(f"report in {write_report(result)}", highlight=False)
    return 0
