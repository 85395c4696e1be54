"""The command line: the only part of presswear that knows the terminal.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 interrupted.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

from presswear.catalog import SCENES, scene_named
from presswear.errors import InputError, RunError
from presswear.scene import CONVENTIONS, Scene, changed, settings_of, stage_name

if TYPE_CHECKING:
    from presswear.campaign import Stage


class _Parser(argparse.ArgumentParser):
    """Errors of usage in one line, like every other."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; see {self.prog} --help")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="presswear",
        description="Press linkages with worn joints: motion, contact and wear, in Exudyn.",
        epilog="example: presswear run wear-times --cycles 5 --out results/first",
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    shown = commands.add_parser(
        "list",
        help="the scenes, one line each; or everything that can be set in one",
        epilog="example: presswear list wear-times",
    )
    shown.add_argument("scene", nargs="?", help="list what --set can change in this scene")
    shown.set_defaults(run=_list)

    run = commands.add_parser(
        "run",
        help="run a scene and write its result folder and report",
        epilog="example: presswear run wear-times --conventions refined --cycles 10 "
        "--set clearance=0.6mm --set 'speed=6pi rad/s' --set geometry=swapped",
    )
    run.add_argument("scene", help="one of: " + ", ".join(SCENES))
    run.add_argument("--out", type=Path, help="new result folder (default results/SCENE)")
    run.add_argument("--engine", help="exudyn (default: the fittest), exudyn-joints or dae")
    run.add_argument("--conventions", help="paper (as printed, default) or refined")
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
    run.set_defaults(run=_run)

    report = commands.add_parser(
        "report",
        help="figures and report anew from a result folder",
        epilog="example: presswear report results/wear-times",
    )
    report.add_argument("folder", type=Path, metavar="DIR")
    report.set_defaults(run=_report)

    verify = commands.add_parser(
        "verify",
        help="both engines against reference problems with known answers; exit code 1 on a miss",
        epilog="example: presswear verify",
    )
    verify.set_defaults(run=_verify)
    return parser


def _list(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene is None:
        for scene in SCENES.values():
            console.print(f"{scene().name:12} {scene().title}", highlight=False)
        return 0
    for setting in settings_of(scene_named(arguments.scene)):
        console.print(f"{setting.key:20} {setting.described()}", highlight=False, soft_wrap=True)
    return 0


def _scene_from(arguments: argparse.Namespace) -> Scene:
    """The scene that the options of ``run`` describe; InputError before anything runs."""
    scene = scene_named(arguments.scene)
    if arguments.conventions is not None:
        if arguments.conventions not in CONVENTIONS:
            raise InputError(
                f"--conventions {arguments.conventions}: allowed is one of {', '.join(CONVENTIONS)}"
            )
        scene = replace(scene, conventions=CONVENTIONS[arguments.conventions])
    settings: dict[str, str] = {}
    for item in arguments.set:
        key, equals, value = item.partition("=")
        if not equals:
            raise InputError(f"--set {item}: KEY=VALUE is expected")
        if key in settings:
            raise InputError(f"--set {key} is given twice")
        settings[key.strip()] = value.strip()
    for key in ("engine", "cycles", "wears", "tolerance"):
        given = getattr(arguments, key)
        if given is not None:
            settings[key] = given
    return changed(scene, settings)


def _free_folder(name: str) -> Path:
    """results/NAME, or the first of results/NAME-2, -3 ... that is free."""
    base = Path("results") / name
    folder, number = base, 1
    while folder.exists():
        number += 1
        folder = base.with_name(f"{base.name}-{number}")
    return folder


def _bar(console: Console) -> Progress:
    """Progress with times passed and left; silent where there is no terminal."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=console, disable=not console.is_terminal)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    scene = _scene_from(arguments)
    folder = arguments.out if arguments.out is not None else _free_folder(scene.name)
    # Imported here: a wrong option is answered without waiting for Exudyn and matplotlib.
    from presswear.campaign import Watcher, run_campaign
    from presswear.report import write_report
    from presswear.results import ResultFolder, load

    store = ResultFolder(folder, scene)
    with _bar(console) as bar:
        stages = scene.wears + 1
        task = bar.add_task(stage_name(0), total=stages)

        def progress(stage: int, part: float, word: str) -> None:
            description = f"{stage_name(stage)}{': ' if word else ''}{word}"
            bar.update(task, completed=stage + part, description=description)

        def finished(stage: "Stage") -> None:
            store.add(stage)
            bar.update(task, completed=stage.index + 1)
            bar.console.print(_stage_line(stage), highlight=False)

        try:
            status, message = run_campaign(scene, Watcher(progress, finished))
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


def _stage_line(stage: "Stage") -> str:
    """One line on a finished stage: what ran, how finely, what came out."""
    numbers = stage.statistics
    steps = stage.run.diagnostics["steps"]
    speed = stage.wall / stage.run.time if stage.run.time > 0.0 else float("nan")
    parts = [
        f"{stage_name(stage.index)}: {numbers['cycles']} cycles, {steps} steps, "
        f"{speed:.1f} s per simulated second"
    ]
    for name, joint in numbers.get("joints", {}).items():
        fewest = joint["fewest_steps_in_a_contact"]
        resolved = "no contact" if fewest is None else f"at least {fewest} steps in each"
        parts.append(
            f"{name}: {joint['contacts']} contacts, {resolved}, peak {joint['force_max_N']:.0f} N, "
            f"wear {1e9 * joint['wear_volume_m3']:.3g} mm^3"
        )
    return "; ".join(parts)


def _report(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.report import write_report
    from presswear.results import load

    console.print(f"report in {write_report(load(arguments.folder))}", highlight=False)
    return 0


def _verify(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.verify import verify

    with _bar(console) as bar:
        task = bar.add_task("verify", total=1.0)
        rows = verify(lambda name, part: bar.update(task, description=name, completed=part))
    table = Table(box=SIMPLE, pad_edge=False)
    table.add_column("problem", overflow="fold")
    for column in ("reference", "ours", "error", "bound"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("")
    for row in rows:
        table.add_row(
            escape(row.name),
            f"{row.reference:.9g}",
            f"{row.ours:.9g}",
            f"{row.error:.1e}",
            f"{row.bound:.0e}",
            "pass" if row.passed else "[bold red]MISS[/]",
        )
    console.print(table, highlight=False)
    missed = sum(not row.passed for row in rows)
    console.print(f"{len(rows) - missed} of {len(rows)} within their bounds", highlight=False)
    return 1 if missed else 0


def main(argv: Sequence[str] | None = None) -> int:
    """Entry point of ``presswear`` and ``python -m presswear``; returns the exit code."""
    console = Console()
    problem = Console(stderr=True, soft_wrap=True, highlight=False, markup=False)
    try:
        arguments = _parser().parse_args(argv)
        return int(arguments.run(arguments, console))
    except InputError as error:
        problem.print(f"presswear: {error}")
        return 2
    except RunError as error:
        problem.print(f"presswear: {error}")
        return 1
    except OSError as error:
        problem.print(f"presswear: {error.strerror}: {error.filename}")
        return 1
    except KeyboardInterrupt:
        problem.print("presswear: interrupted; finished stages are kept")
        return 130


if __name__ == "__main__":
    sys.exit(main())
