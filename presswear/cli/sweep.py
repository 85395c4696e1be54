"""``presswear sweep``: a scene at many points, on this machine or on a cluster."""

import argparse
import shlex
from dataclasses import replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli.terminal import (
    add_limits,
    add_settings,
    add_trust,
    add_where,
    check_resumed,
    count_given,
    folder_given,
    free_folder,
    goes_on,
    jobs_given,
    place_given,
    print_table,
    progress_bar,
    scene_given,
    settings_given,
)
from presswear.scene.files import SUFFIX
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.numbers import lasting
from presswear.tools.processes import check_stopped

if TYPE_CHECKING:
    from presswear.sweeps.plan import Table
    from presswear.sweeps.runner import Progress
    from presswear.sweeps.sweep import Sweep

SHOWN_ROWS = 12
COLUMN_GAP = 3  # characters between two columns
LONG = 3600.0  # time of a sweep that needs --yes, s
MEASURED_ROWS = 2  # completed rows after which the time is estimated: the first may compile
SETTINGS = ("engine", "cycles")  # settings that have an option


def add(commands: Any) -> None:
    """Add the parser of ``sweep``."""
    parser = commands.add_parser(
        "sweep",
        description="Runs a scene at every point of a grid, of a sample, or of both, and stores "
        "responses of each run in a folder. A row in the folder does not run again: --resume "
        "continues an interrupted sweep or extends it. A run that fails is a row with its error.",
        epilog="example: presswear sweep wear-times --vary clearance=0.2mm:1.0mm:9 "
        "--vary A.friction=0.02,0.05,0.1 --response A.force_max,bdc_error --replicates 4",
    )
    parser.add_argument("scene", help="a file, FILE.toml, with or without [sweep], or a scene")
    parser.add_argument(
        "--vary",
        action="append",
        metavar="KEY=VALUES",
        help="values with units: a list, FIRST:LAST:COUNT, or FIRST:LAST:COUNT:log; "
        "'KEY=VALUES & KEY=VALUES' vary together; repeatable, all values are combined",
    )
    parser.add_argument(
        "--sample", metavar="KIND:SIZE", help="design: sobol, latin, saltelli, morris or oat"
    )
    parser.add_argument(
        "--range",
        action="append",
        metavar="KEY=DISTRIBUTION",
        help="distribution of a sampled parameter: a range such as 0.2mm:1mm, "
        "normal(MEAN, DEVIATION), lognormal(MEDIAN, SPREAD), table(FILE.csv); repeatable",
    )
    parser.add_argument(
        "--response",
        action="append",
        metavar="NAMES",
        help="separated by commas, such as A.force_max,bdc_error, or A.force_max@0 of the unworn "
        "stage (default: all, of the last stage)",
    )
    add_limits(parser)
    parser.add_argument(
        "--replicates", metavar="N", help="independent runs at each point (default 1)"
    )
    parser.add_argument("--seed", type=place_given, metavar="N", help="seed of the sample")
    parser.add_argument("--keep", help="responses (default), or results: complete result folders")
    parser.add_argument("--engine", help="as in presswear run")
    parser.add_argument("--cycles", help="as in presswear run")
    add_where(parser)
    parser.add_argument("--jobs", metavar="N", help="runs at a time (default: all cores)")
    parser.add_argument("--out", type=folder_given, help="folder (default results/SCENE-sweep)")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="run what is missing in --out; without other options the same sweep",
    )
    add_trust(parser)
    parser.add_argument("--yes", action="store_true", help="do not ask for confirmation")
    add_settings(parser)
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.sweeps.sweep import check_folder_of, parse_shard, run_sweep

    jobs = jobs_given(arguments.jobs)
    shard = parse_shard(arguments.shard or "1/1")
    check_resumed(arguments.resume, arguments.out)
    sweep = _requested_sweep(arguments)
    # All jobs of an array start together, in a folder that one of them makes.
    check_folder_of(sweep, arguments.resume, is_part=arguments.shard is not None)
    plan = sweep.plan
    replicates = f", {plan.replicates} replicates each" if plan.replicates > 1 else ""
    console.print(
        f"{plan.scene.name}: {len(plan.points)} points{replicates}, {plan.rows} runs",
        highlight=False,
    )
    folder = shlex.quote(str(sweep.path))
    resume = (
        f"continue with: presswear sweep {shlex.quote(arguments.scene)} --resume "
        f"--out {folder}{' --trust' if plan.scene.user_laws else ''}"
    )
    is_confirmed = arguments.yes
    with (
        goes_on(resume, sweep.path, lambda: "all finished runs are kept"),
        progress_bar(console) as bar,
    ):
        task = bar.add_task("sweep", total=None)

        def report(progress: "Progress") -> None:
            nonlocal is_confirmed
            check_stopped()
            failed = f", {progress.failed} failed" if progress.failed else ""
            text = f"sweep: {progress.done} of {progress.rows}{failed}"
            bar.update(task, total=progress.rows, completed=progress.done, description=text)
            if not is_confirmed and progress.done >= MEASURED_ROWS:
                is_confirmed = True
                _check_time(progress)

        def notify(line: str) -> None:
            bar.console.print(line, highlight=False, markup=False, soft_wrap=True)

        run_sweep(sweep, arguments.on, jobs, shard, report, notify)
    _print(console, sweep.table)
    console.print(sweep.summary, highlight=False, soft_wrap=True)
    console.print(f"for the report: presswear report {folder}", highlight=False)
    return 0


def _check_time(progress: "Progress") -> None:
    """Refuse a sweep whose remaining rows take long; completed rows are kept."""
    left = progress.rows - progress.done
    seconds = progress.seconds * left / progress.slots
    if seconds > LONG:
        raise InputError(
            f"{left} runs of about {lasting(progress.seconds)}, {progress.slots} at a time, take "
            f"about {lasting(seconds)}: continue with --resume --yes"
        )


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Write the figures and the report of a sweep folder."""
    from presswear.sweeps.sweep import load_sweep

    sweep = load_sweep(arguments.folder)
    if arguments.limit:
        sweep = replace(sweep, limits=tuple(arguments.limit))
    console.print(f"report in {sweep.report()}", highlight=False, soft_wrap=True)
    return 0


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Write the rows of a sweep as CSV or Parquet."""
    from presswear.sweeps.sweep import export_table, load_sweep

    if arguments.strokes or arguments.life or arguments.stage:
        raise InputError(
            f"{arguments.folder} is a sweep: --stage, --strokes and --life cannot be used"
        )
    table = load_sweep(arguments.folder).table
    export_table(table, arguments.file)
    console.print(f"{len(table.errors)} rows in {arguments.file}", highlight=False)
    return 0


def _requested_sweep(arguments: argparse.Namespace) -> "Sweep":
    """Return the sweep of the options, or without options the one in the folder."""
    from presswear.sweeps.plan import MAX_REPLICATES, Plan, SweepFile, read_sweep
    from presswear.sweeps.responses import request
    from presswear.sweeps.sweep import Sweep, is_sweep, load_sweep

    options = ("vary", "sample", "range", "response", "limit", "replicates", "seed", "keep", "set")
    names = (*options, *SETTINGS)
    is_bare = arguments.resume and not any(getattr(arguments, name) for name in names)
    if is_bare and is_sweep(arguments.out):
        sweep = load_sweep(arguments.out)
        if arguments.trust:
            sweep.plan.scene.trust()
        return sweep
    if arguments.scene.endswith(SUFFIX):
        scene, file = read_sweep(Path(arguments.scene))
    else:
        scene, file = scene_given(arguments.scene), SweepFile()
    if is_bare and file == SweepFile():
        return load_sweep(arguments.out)  # its error says what the folder lacks
    settings = settings_given(arguments.set)
    for name in SETTINGS:
        if getattr(arguments, name) is not None:
            if name in settings:
                raise InputError(f"--{name} and --set {name} cannot be combined")
            settings[name] = getattr(arguments, name)
    replicates = file.replicates
    if arguments.replicates is not None:
        replicates = count_given("--replicates", arguments.replicates, MAX_REPLICATES)
    plan = Plan(
        changed(scene, settings),
        tuple(arguments.vary or file.vary),
        arguments.sample or file.sample,
        tuple(arguments.range or file.ranges),
        replicates,
        file.seed if arguments.seed is None else arguments.seed,
    )
    listed = ",".join(arguments.response or file.responses)
    requested = request(plan.example, listed.split(",") if listed else [])
    folder = arguments.out or free_folder(f"{scene.name}-sweep")
    limits = tuple(arguments.limit or file.limits)
    return Sweep(plan, requested, folder, arguments.keep or file.keep, limits)


def _print(console: Console, table: "Table") -> None:
    """Print the first rows, with as many responses as the terminal is wide enough for."""
    from presswear.sweeps.report import text_table

    heads, *rows = text_table(table, SHOWN_ROWS)
    widths = (COLUMN_GAP + max(map(len, cells)) for cells in zip(heads, *rows, strict=True))
    fitting = sum(end <= console.width for end in accumulate(widths))
    count = max(fitting, len(table.parameters) + 1)
    print_table(console, [], heads[:count], [cells[:count] for cells in rows])
    if len(heads) > count:
        text = f"and {', '.join(heads[count:])}"
        console.print(text, highlight=False, markup=False, soft_wrap=True)
