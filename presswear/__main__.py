"""The command line: the only part of presswear that knows the terminal.

Exit codes: 0 success; 1 a run that failed; 2 bad input; 130 interrupted.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

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
from presswear.scene import CONVENTIONS, Scene, stage_name
from presswear.settings import changed, settings_of

if TYPE_CHECKING:
    from presswear.campaign import Stage


_TABLE_TEXT = (
    "Columns, in SI units: time, displacement, velocity, acceleration (of the slider), and for "
    "each clearance joint J: J_eccentricity_x, J_eccentricity_y, J_penetration, J_normal_force, "
    "J_tangential_force, J_sliding (speed). CSV with a header line of names and # comments, or "
    "NPZ with one array per column; another program's table may hold any subset beside time."
)


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
    _add_crosscheck(commands)
    return parser


def _add_crosscheck(commands: Any) -> None:
    """The commands that compare runs and hand them on."""
    check = commands.add_parser(
        "crosscheck",
        help="Exudyn against the in-house solver, or a stored run against another program's table; "
        "exit code 1 when they disagree",
        description="Without --against: Exudyn (the open tree where there is one, or what --set "
        "engine=... says) and the in-house solver run a scene on unworn surfaces from the same "
        "start. They are compared one by one up to the horizon, where a start moved by 1e-9 m has "
        "grown apart a thousand times, and by means over cycles beyond it (8 cycles, or as many as "
        "--set cycles=N says). With --against: stage 0 of a result folder is compared with "
        f"another solver's table. {_TABLE_TEXT} Ours is interpolated at their times; between "
        "stored rows forces and accelerations are known to some per cent only, so export first "
        "and let the other solver write its rows at our times.",
        epilog="example: presswear crosscheck wear-times --set 'speed=8pi rad/s'; "
        "presswear crosscheck results/wear-times --against theirs.csv --until 0.1",
    )
    check.add_argument(
        "target", nargs="?", metavar="SCENE|DIR", help="scene (default wear-times) or result folder"
    )
    check.add_argument("--out", type=Path, help="new folder (default results/crosscheck-SCENE)")
    check.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="as in presswear run"
    )
    check.add_argument(
        "--duration",
        type=float,
        metavar="S",
        help="longest time that trajectories are compared, s (default one cycle)",
    )
    check.add_argument("--against", type=Path, metavar="FILE", help="table, .csv or .npz")
    check.add_argument(
        "--until", type=float, metavar="S", help="last time compared, s (default: all in common)"
    )
    check.add_argument(
        "--tolerance",
        type=float,
        metavar="X",
        help="rms difference allowed in a column, part of its rms (default 1e-3)",
    )
    check.set_defaults(run=_crosscheck)

    export = commands.add_parser(
        "export",
        help="a stored run as CSV or NPZ for other programs",
        description=f"Writes the recorded series of a stage. {_TABLE_TEXT}",
        epilog="example: presswear export results/wear-times first.csv --stage 0",
    )
    export.add_argument("folder", type=Path, metavar="DIR")
    export.add_argument("file", type=Path, metavar="FILE", help="new file, .csv or .npz")
    export.add_argument(
        "--stage", type=int, default=0, metavar="K", help="0 unworn (default), 1 after a wear, ..."
    )
    export.set_defaults(run=_export)


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
    settings = _settings(arguments.set)
    for key in ("engine", "cycles", "wears", "tolerance"):
        given = getattr(arguments, key)
        if given is not None:
            settings[key] = given
    return changed(scene, settings)


def _settings(items: list[str]) -> dict[str, str]:
    """What ``--set`` says, by key."""
    settings: dict[str, str] = {}
    for item in items:
        key, equals, value = item.partition("=")
        if not equals:
            raise InputError(f"--set {item}: KEY=VALUE is expected")
        if key.strip() in settings:
            raise InputError(f"--set {key.strip()} is given twice")
        settings[key.strip()] = value.strip()
    return settings


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


def _crosscheck(arguments: argparse.Namespace, console: Console) -> int:
    own, foreign = ("set", "out", "duration"), ("until", "tolerance")
    for name in own if arguments.against else foreign:
        if getattr(arguments, name) not in (None, []):
            word = "does not go" if arguments.against else "goes only"
            raise InputError(f"--{name} {word} with --against; see presswear crosscheck --help")
    for name in ("duration", *foreign):
        value = getattr(arguments, name)
        if value is not None and not 0.0 < value < float("inf"):
            raise InputError(f"--{name} {value:g}: a finite number above 0 is expected")
    if arguments.against:
        return _against(arguments, console)
    scene = changed(scene_named(arguments.target or "wear-times"), _settings(arguments.set))
    folder = arguments.out or _free_folder(f"crosscheck-{scene.name}")
    from presswear.crosscheck import check_engines, store
    from presswear.figures.crosscheck import write_differences
    from presswear.results import ResultFolder

    ResultFolder(folder, scene)  # refuses a folder that holds something
    with _bar(console) as bar:
        task = bar.add_task("start", total=1.0)
        outcome = check_engines(
            scene,
            arguments.duration,
            lambda name, part: bar.update(task, description=name, completed=part),
        )
    store(outcome, folder)
    write_differences(outcome, folder / "difference.png")
    how = "where trajectories part" if outcome.parted else "the end; trajectories did not part"
    console.print(f"compared up to {outcome.horizon:.4g} s, {how}", highlight=False)
    _print_checks(
        console,
        ("difference", "bound"),
        [
            (check.quantity, check.unit, (check.difference, check.bound), check.passed)
            for check in outcome.checks
        ],
    )
    console.print(f"table and figure in {folder}", highlight=False)
    return 0 if outcome.passed else 1


def _against(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.target is None:
        raise InputError("--against needs the result folder to compare with: crosscheck DIR")
    from presswear.results import load
    from presswear.tables import TOLERANCE, compare_tables, read_table, table_of

    theirs = read_table(arguments.against)
    ours = table_of(load(Path(arguments.target)), 0)
    tolerance = TOLERANCE if arguments.tolerance is None else arguments.tolerance
    columns = compare_tables(ours, theirs, arguments.until, tolerance)
    _print_checks(
        console,
        ("greatest", "rms", "bound of rms"),
        [
            (found.column, found.unit, (found.greatest, found.rms, found.bound), found.passed)
            for found in columns
        ],
    )
    return 0 if all(found.passed for found in columns) else 1


def _print_checks(
    console: Console,
    names: tuple[str, ...],
    rows: list[tuple[str, str, tuple[float | None, ...], bool]],
) -> None:
    """A table of quantities with their numbers, and whether each is within its bound."""
    table = Table(box=SIMPLE, pad_edge=False)
    table.add_column("quantity", overflow="fold")
    for column in names:
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("unit")
    table.add_column("")
    for quantity, unit, numbers, passed in rows:
        shown = ["" if number is None else f"{number:.2e}" for number in numbers]
        verdict = "" if numbers[-1] is None else "pass" if passed else "[bold red]MISS[/]"
        table.add_row(escape(quantity), *shown, unit, verdict)
    console.print(table, highlight=False)


def _export(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.results import load
    from presswear.tables import table_of, write_table

    table = table_of(load(arguments.folder), arguments.stage)
    write_table(arguments.file, table)
    rows = table["time"].size
    console.print(f"{rows} rows of {len(table)} columns in {arguments.file}", highlight=False)
    return 0


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
