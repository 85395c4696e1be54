"""``presswear sweep``: a scene at many points, on this machine or on a cluster."""

import argparse
import shlex
from dataclasses import replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from presswear.cli import terminal
from presswear.scene.files import SUFFIX
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.numbers import duration_text
from presswear.tools.processes import check_stopped

if TYPE_CHECKING:
    from presswear.sweeps.plan import Table
    from presswear.sweeps.runner import Progress
    from presswear.sweeps.sweep import Sweep

SHOWN_ROWS = 12
COLUMN_GAP = 3  # characters between two columns
MAX_TIME = 3600.0  # largest expected time of a sweep without --yes, s
# Completed rows after which the time is estimated; the first one may compile.
MEASURED_ROWS = 2
SETTINGS = ("engine", "cycles", "wear_updates")  # settings that have an option
# Options that a sweep folder stores
STORED_OPTIONS = (
    "vary",
    "sample",
    "range",
    "response",
    "limit",
    "replicates",
    "seed",
    "keep",
    "set",
    *SETTINGS,
)


def sweep(arguments: argparse.Namespace, console: Console) -> int:
    """Run a scene at many points."""
    from presswear.sweeps.sweep import check_folder_of, parse_shard, run_sweep

    shard = parse_shard(arguments.shard or "1/1")
    terminal.check_resume(arguments.resume, arguments.out)
    sweep = _requested_sweep(arguments)
    # All jobs of an array start together, in a folder that one of them makes.
    check_folder_of(sweep, arguments.resume, is_part=arguments.shard is not None)
    plan = sweep.plan
    replicates = f", {plan.replicates} replicates each" if plan.replicates > 1 else ""
    text = f"{plan.scene.name}: {len(plan.points)} points{replicates}, {plan.rows} runs"
    terminal.print_lines(console, text)
    folder = shlex.quote(str(sweep.path))
    command = terminal.resume_command(arguments, sweep.path, plan.scene)
    is_confirmed = arguments.yes
    with (
        terminal.resumable(command, sweep.path, lambda: "all finished runs are stored"),
        terminal.progress_bar(console) as bar,
    ):
        task = bar.add_task("sweep", total=None)

        def report(progress: "Progress") -> None:
            nonlocal is_confirmed
            check_stopped()
            failed = f", {progress.failed} failed" if progress.failed else ""
            text = f"sweep: {progress.done} of {progress.rows}{failed}"
            bar.update(
                task, total=progress.rows, completed=progress.done, description=text
            )
            if not is_confirmed and progress.done >= MEASURED_ROWS:
                is_confirmed = True
                _check_time(progress)

        def notify(line: str) -> None:
            terminal.print_lines(bar.console, line)

        sweep = run_sweep(sweep, arguments.on, arguments.jobs, shard, report, notify)
    _print(console, sweep.table)
    terminal.print_lines(console, sweep.summary)
    terminal.print_lines(console, f"for the report: presswear report {folder}")
    return 0


def _check_time(progress: "Progress") -> None:
    """Refuse a sweep whose remaining rows take long; completed rows are kept."""
    remaining = progress.rows - progress.done
    seconds = progress.seconds * remaining / progress.slots
    if seconds > MAX_TIME:
        runs = f"{remaining} runs of about {duration_text(progress.seconds)}"
        raise InputError(
            f"{runs}, {progress.slots} at a time, take "
            f"about {duration_text(seconds)}: continue with --resume --yes"
        )


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Write the figures and the report of a sweep folder."""
    from presswear.sweeps.sweep import load_sweep

    sweep = load_sweep(arguments.folder)
    if arguments.limit:
        sweep = replace(sweep, limits=tuple(arguments.limit))
    terminal.print_lines(console, f"report in {sweep.report()}")
    return 0


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Write the rows of a sweep as CSV or Parquet."""
    from presswear.sweeps.sweep import export_table, load_sweep

    options = ("stage", "strokes", "cycles", "life")
    if any(getattr(arguments, name) for name in options):
        raise InputError(
            f"{arguments.folder} is a sweep: --stage, --strokes, --cycles and --life cannot be used"
        )
    table = load_sweep(arguments.folder).table
    export_table(table, arguments.file)
    terminal.print_lines(console, f"{len(table.errors)} rows in {arguments.file}")
    return 0


def _requested_sweep(arguments: argparse.Namespace) -> "Sweep":
    """Return the sweep of the options; without options the sweep of the folder."""
    from presswear.sweeps.plan import Plan, SweepFile, read_sweep
    from presswear.sweeps.responses import request
    from presswear.sweeps.sweep import FILE, Sweep, load_sweep

    has_options = any(getattr(arguments, name) for name in STORED_OPTIONS)
    is_stored = arguments.resume and not has_options
    if is_stored and (arguments.out / FILE).exists():
        sweep = load_sweep(arguments.out)
        if arguments.trust:
            sweep.plan.scene.trust()
        return sweep
    if arguments.scene.endswith(SUFFIX):
        scene, file = read_sweep(Path(arguments.scene))
    else:
        scene = terminal.load_scene(arguments.scene)
        file = SweepFile()
    if is_stored and file == SweepFile():
        return load_sweep(arguments.out)  # its error names the missing file
    options = {name: getattr(arguments, name) for name in SETTINGS}
    settings = terminal.merge_options(terminal.parse_settings(arguments.set), options)
    plan = Plan(
        scene=changed(scene, settings),
        vary=tuple(arguments.vary or file.vary),
        sample=arguments.sample or file.sample,
        ranges=tuple(arguments.range or file.ranges),
        replicates=arguments.replicates or file.replicates,
        seed=file.seed if arguments.seed is None else arguments.seed,
    )
    responses: list[str] = []
    for text in arguments.response or file.responses:
        responses += text.split(",")
    requested = request(plan.example, responses)
    folder = arguments.out or terminal.free_folder(f"{scene.name}-sweep")
    limits = tuple(arguments.limit or file.limits)
    return Sweep(plan, requested, folder, arguments.keep or file.keep, limits)


def _print(console: Console, table: "Table") -> None:
    """Print the first rows, with as many columns as fit into the width of the terminal."""
    heads, *rows = table.texts(SHOWN_ROWS)
    columns = zip(heads, *rows, strict=True)
    widths = [COLUMN_GAP + max(map(len, column)) for column in columns]
    fitting = sum(end <= console.width for end in accumulate(widths))
    count = max(fitting, len(table.parameters) + 1)
    shown = [f">{head}" for head in heads[:count]]
    terminal.print_table(console, shown, [row[:count] for row in rows])
    if len(heads) > count:
        text = f"and {', '.join(heads[count:])}"
        terminal.print_lines(console, text)
