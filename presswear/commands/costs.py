"""``presswear costs``: what features cost, how engines compare, where time goes.

It measures and does not judge: a verdict is printed, and the exit code is 0.
"""

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from presswear.commands.terminal import (
    folder_given,
    free_folder,
    progress_bar,
    repeats_given,
    scene_given,
)
from presswear.tools.folders import only_writer

if TYPE_CHECKING:
    from presswear.trials.costs.text import TextTable

SCENE = "wear-times"


def add(commands: Any) -> None:
    """Add the parser of ``costs``."""
    costs = commands.add_parser(
        "costs",
        description=f"Times the scene {SCENE} on one core, with each feature on and off, in every "
        "engine at equal work, and stage by stage in the open tree. Ratios hold within one run "
        "of this command; keep the machine calm meanwhile. About four minutes.",
        epilog="example: presswear costs --repeats 7 --out results/costs-calm",
    )
    costs.add_argument("--out", type=folder_given, help="new folder (default results/costs)")
    costs.add_argument("--repeats", help="how often each run is timed (default 5)")
    costs.add_argument(
        "--quick", action="store_true", help="short runs, twice each: rough, below a minute"
    )
    costs.set_defaults(run=_costs)


def _costs(arguments: argparse.Namespace, console: Console) -> int:
    repeats = None if arguments.repeats is None else repeats_given(arguments.repeats)
    scene = scene_given(SCENE)
    folder = arguments.out if arguments.out is not None else free_folder("costs")
    from presswear.results.provenance import provenance

    with only_writer(folder):
        from presswear.trials.costs.study import QUICK, Extent, store, study
        from presswear.trials.costs.text import markdown_of, tables_of

        extent = QUICK if arguments.quick else Extent()
        if repeats is not None:
            extent = replace(extent, repeats=repeats)
        with progress_bar(console) as bar:
            task = bar.add_task("start", total=1.0)
            found = study(
                scene,
                extent,
                lambda name, part: bar.update(task, description=name, completed=part),
            )
        store(found, markdown_of(found, provenance()), folder)
        for table in tables_of(found):
            print_text_table(console, table)
        console.print(f"tables and all times in {folder}", highlight=False)
        return 0


def print_text_table(console: Console, table: "TextTable") -> None:
    """A table and the sentences that explain it."""
    shown = Table(
        box=SIMPLE,
        pad_edge=False,
        collapse_padding=True,
        title=table.title,
        title_justify="left",
    )
    for name in table.texts:
        shown.add_column(name, overflow="fold")
    for name in table.numbers:
        shown.add_column(name, justify="right", no_wrap=True)
    for row in table.rows:
        shown.add_row(*(escape(cell) for cell in row))
    console.print(shown, highlight=False)
    for sentence in table.sentences:
        console.print(escape(sentence), highlight=False)
    console.print()
