"""``presswear sweep``: one scene at many points, on all cores here or on a cluster."""

import argparse
import shlex
from dataclasses import replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import Progress

from presswear.cli.terminal import (
    add_required,
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
from presswear.tools.stopping import check_stopped

if TYPE_CHECKING:
    from presswear.sweeps.run import Standing
    from presswear.sweeps.sweep import Sweep
    from presswear.sweeps.table import Table

_SHOWN = 12
"""Rows of the table that is printed at the end."""
_GAP = 3
"""Characters between two columns."""


def add(commands: Any) -> None:
    """Add the parser of ``sweep``."""
    parser = commands.add_parser(
        "sweep",
        description="Runs a scene at every point of a grid, of a sample, or of both, and keeps "
        "what it measures in a folder. What stands there is never run again: a sweep that is "
        "stopped goes on with --resume, and may be widened by it; several processes and machines "
        "may work in one folder. A run that fails is a row with its reason.",
        epilog="example: presswear sweep wear-times --vary clearance=0.2mm:1.0mm:9 "
        "--vary A.friction=0.02,0.05,0.1 --measure A.force_max,bdc_error --draws 4",
    )
    parser.add_argument("scene", help="a file, FILE.toml, with or without [sweep], or a scene")
    parser.add_argument(
        "--vary",
        action="append",
        metavar="KEY=VALUES",
        help="values with units: a list, FIRST:LAST:COUNT, or FIRST:LAST:COUNT:log; "
        "'KEY=VALUES & KEY=VALUES' vary together; repeatable, every value with every other",
    )
    parser.add_argument(
        "--sample", metavar="KIND:SIZE", help="points of a design, such as sobol:512 or latin:100"
    )
    parser.add_argument(
        "--range",
        action="append",
        metavar="KEY=DISTRIBUTION",
        help="what is sampled: a range such as 0.2mm:1mm, normal(MEAN, DEVIATION), "
        "lognormal(MEDIAN, SPREAD), table(FILE.csv); repeatable",
    )
    parser.add_argument(
        "--measure",
        action="append",
        metavar="NAMES",
        help="with commas between, such as A.force_max,bdc_error, or A.force_max@0 of the stage "
        "without wear (default: all, of the last stage)",
    )
    add_required(parser)
    parser.add_argument("--draws", metavar="N", help="independent runs at each point (default 1)")
    parser.add_argument(
        "--seed", type=place_given, metavar="N", help="draws the points of the sample anew"
    )
    parser.add_argument("--keep", help="measures (default), or all: whole result folders")
    add_where(parser)
    parser.add_argument("--jobs", metavar="N", help="runs at a time (default: all cores)")
    parser.add_argument("--out", type=folder_given, help="folder (default results/SCENE-sweep)")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on in --out, or widen what is there; without other options with the same sweep",
    )
    add_trust(parser)
    parser.add_argument(
        "--yes", action="store_true", help="start also what takes longer than an hour"
    )
    add_settings(parser)
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.sweeps.sweep import begun, run_sweep, shard_given
    from presswear.sweeps.text import counts_of

    jobs = jobs_given(arguments.jobs)
    shard = shard_given(arguments.shard or "1/1")
    check_resumed(arguments.resume, arguments.out)
    sweep = _asked(arguments)
    # All jobs of an array begin together, in a folder that one of them makes.
    sweep = begun(sweep, arguments.resume, is_shared=arguments.shard is not None)
    plan = sweep.plan
    told = f"{plan.points} points" + (f", {plan.draws} runs each" if plan.draws > 1 else "")
    console.print(f"{plan.scene.name}: {told}, {plan.rows} runs", highlight=False)
    again = (
        f"go on with: presswear sweep {shlex.quote(arguments.scene)} --resume "
        f"--out {shlex.quote(str(sweep.path))}{' --trust' if plan.scene.user_laws else ''}"
    )
    rows = len(range(shard[0] - 1, plan.rows, shard[1]))
    with (
        goes_on(again, sweep.path, lambda: "all finished runs are kept"),
        progress_bar(console) as bar,
    ):
        board = _Board(bar, rows, arguments.yes, sweep.path)
        run_sweep(
            sweep,
            arguments.on,
            jobs,
            shard,
            board.standing,
            board.gate,
            lambda line: bar.console.print(line, highlight=False, markup=False, soft_wrap=True),
        )
    _print(console, sweep.table)
    console.print(counts_of(sweep.table, sweep.path), highlight=False, soft_wrap=True)
    folder = shlex.quote(str(sweep.path))
    console.print(f"what follows from it: presswear report {folder}", highlight=False)
    return 0


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Write figures and report anew of a sweep, as far as it has run."""
    from presswear.sweeps.sweep import load_sweep

    sweep = load_sweep(arguments.folder)
    if arguments.require:
        sweep = replace(sweep, required=tuple(arguments.require))
    console.print(f"report in {sweep.report()}", highlight=False, soft_wrap=True)
    return 0


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Write the rows of a sweep for other programs."""
    from presswear.sweeps.export import write_table
    from presswear.sweeps.sweep import load_sweep

    if arguments.strokes or arguments.life or arguments.stage:
        raise InputError(f"{arguments.folder} is a sweep: --stage, --strokes and --life do not go")
    table = load_sweep(arguments.folder).table
    write_table(arguments.file, table)
    console.print(f"{len(table.reasons)} rows in {arguments.file}", highlight=False)
    return 0


def _asked(arguments: argparse.Namespace) -> "Sweep":
    """The sweep that the options ask for, or the one in the folder where they say nothing."""
    from presswear.sweeps.files import Written, read_sweep
    from presswear.sweeps.measures import measures_asked
    from presswear.sweeps.plan import MOST_DRAWS, Plan
    from presswear.sweeps.sweep import KEEP, Sweep, is_sweep, load_sweep

    options = ("vary", "sample", "range", "measure", "require", "draws", "seed", "keep", "set")
    is_bare = all(getattr(arguments, name) in (None, []) for name in options)
    is_bare = is_bare and arguments.resume
    if is_bare and is_sweep(arguments.out):
        sweep = load_sweep(arguments.out)
        if arguments.trust:
            sweep.plan.scene.trust()
        return sweep
    if arguments.scene.endswith(SUFFIX):
        scene, written = read_sweep(Path(arguments.scene))
    else:
        scene, written = scene_given(arguments.scene), Written()
    if is_bare and written == Written():
        return load_sweep(arguments.out)  # which says what is missing in it
    keep = arguments.keep or written.keep
    if keep not in KEEP:
        raise InputError(f"--keep {keep}: allowed is one of {', '.join(KEEP)}")
    scene = changed(scene, settings_given(arguments.set))
    plan = Plan(
        scene,
        tuple(arguments.vary or written.vary),
        arguments.sample or written.sample,
        tuple(arguments.range or written.ranges),
        written.draws
        if arguments.draws is None
        else count_given("--draws", arguments.draws, MOST_DRAWS),
        written.seed if arguments.seed is None else arguments.seed,
    )
    names = [own for text in arguments.measure or written.measures for own in text.split(",")]
    folder = arguments.out or free_folder(f"{scene.name}-sweep")
    required = tuple(arguments.require or written.required)
    return Sweep(plan, measures_asked(plan.example, names), folder, keep, required=required)


class _Board:
    """Progress of a sweep on a terminal, and the word on what it costs."""

    def __init__(self, bar: Progress, rows: int, is_sure: bool, path: Path) -> None:
        self._bar, self._is_sure, self._path = bar, is_sure, path
        self._task = bar.add_task("sweep", total=rows)

    def standing(self, standing: "Standing") -> None:
        """Show how far it is; ends it where a signal has come."""
        check_stopped()
        told = f"sweep: {standing.done} of {standing.rows}"
        if standing.failed:
            told += f", {standing.failed} without values"
        done = standing.done + standing.parts
        self._bar.update(self._task, completed=done, description=told)

    def gate(self, seconds: float, left: int, places: int) -> None:
        """Tell what the rest takes, by the first run; InputError where that is long."""
        from presswear.sweeps.sweep import LONG

        takes = seconds * left / places
        if not left:
            return
        line = (
            f"{left} run{'s' * (left > 1)} of about {lasting(seconds)} (the first), {places} at a "
            f"time: about {lasting(takes)}"
        )
        if takes > LONG and not self._is_sure:
            raise InputError(
                f"{line}; --yes starts what takes longer than an hour, the first run is kept in "
                f"{self._path}"
            )
        self._bar.console.print(line, highlight=False, soft_wrap=True)


def _print(console: Console, table: "Table") -> None:
    """The first rows of a table, with as many measures as the terminal has room for."""
    from presswear.sweeps.text import lines_of

    heads, *rows = lines_of(table, _SHOWN)
    ends = accumulate(_GAP + max(map(len, cells)) for cells in zip(heads, *rows, strict=True))
    # What was varied and one measure are shown in any case.
    count = max(sum(end <= console.width for end in ends), len(table.factors) + 1)
    print_table(console, [], heads[:count], [cells[:count] for cells in rows])
    if len(heads) > count:
        told = f"and {', '.join(heads[count:])}"
        console.print(told, highlight=False, markup=False, soft_wrap=True)
