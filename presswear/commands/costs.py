"""``presswear costs``: what features cost, how engines compare, where time goes.

It measures and does not judge: a verdict is printed, and the exit code is 0.
"""

import argparse
from dataclasses import replace
from typing import Any

from rich.console import Console

from presswear.commands.terminal import folder_given, free_folder, repeats_given, scene_given
from presswear.commands.trials import print_text_table, telling
from presswear.tools.folders import only_writer

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
    with only_writer(folder):
        from presswear.trials.costs.study import QUICK, CostsExtent, store, study
        from presswear.trials.costs.tables import markdown_of, tables_of

        extent = QUICK if arguments.quick else CostsExtent()
        if repeats is not None:
            extent = replace(extent, repeats=repeats)
        with telling(console, "start") as told:
            found = study(scene, extent, told)
        store(found, markdown_of(found), folder)
        for table in tables_of(found):
            print_text_table(console, table)
        console.print(f"tables and all times in {folder}", highlight=False)
        return 0
