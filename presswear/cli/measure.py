"""``presswear precision`` and ``presswear costs``: what accuracy and features cost.

They measure and do not judge: the exit code is 0 however slow or wrong a method is.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.terminal import (
    add_out,
    add_settings,
    free_folder,
    repeats_given,
    scene_given,
    settings_given,
)
from presswear.cli.trials import print_text_table, telling
from presswear.scene.settings import changed
from presswear.tools.folders import only_writer

SCENE = "wear-times"


def add(commands: Any) -> None:
    """Add the parsers of ``precision`` and ``costs``."""
    precision = commands.add_parser(
        "precision",
        description="Runs every engine and integrator over its steps or tolerances and holds it "
        "against references: the ideal press and Andrews' squeezer, one impact, and a scene with "
        "clearance up to the horizon to which a trajectory means something; beyond it statistics "
        "and wear. Times are medians of interleaved repeats, warm-up apart; failures stay in, and "
        "so does the paper's setting, RK4 at 1e-4 s. Keep the machine calm meanwhile. Below 40 "
        "minutes on two cores, with --quick below 3.",
        epilog="example: presswear precision wear-times --quick --out results/precision-first",
    )
    precision.add_argument(
        "scene", nargs="?", default=SCENE, metavar="SCENE", help=f"scene (default {SCENE})"
    )
    add_out(precision, "precision-SCENE")
    precision.add_argument("--repeats", help="how often each method is timed (default 5)")
    precision.add_argument("--quick", action="store_true", help="few steps and tolerances of each")
    add_settings(precision)
    precision.set_defaults(run=_precision)

    costs = commands.add_parser(
        "costs",
        description=f"Runs the scene {SCENE} in every engine, as one would write it by hand, in "
        "scipy's codes, and in MuJoCo and Drake where they are installed, at equal error; then "
        "times it on one core with each feature on and off. Ratios hold within one run of this "
        "command; keep the machine calm meanwhile. Below 15 minutes.",
        epilog="example: presswear costs --repeats 7 --out results/costs-calm",
    )
    add_out(costs, "costs")
    costs.add_argument("--repeats", help="how often each run is timed (default 5)")
    costs.add_argument(
        "--quick",
        action="store_true",
        help="short runs, twice each: rough, two minutes without peers",
    )
    costs.set_defaults(run=_costs)


def _precision(arguments: argparse.Namespace, console: Console) -> int:
    repeats = None if arguments.repeats is None else repeats_given(arguments.repeats)
    scene = changed(scene_given(arguments.scene), settings_given(arguments.set))
    folder = arguments.out or free_folder(f"precision-{scene.name}")
    with only_writer(folder):
        from presswear.validation.precision.store import store
        from presswear.validation.precision.study import FULL, QUICK, study
        from presswear.validation.precision.tables import terminal_tables

        extent = QUICK if arguments.quick else FULL
        if repeats is not None:
            extent = replace(extent, repeats=repeats)
        with telling(console, "start") as told:
            found = study(scene, extent, told)
        store(found, folder)
        for table in terminal_tables(found):
            print_text_table(console, table)
        return report(folder, console)


def report(folder: Path, console: Console) -> int:
    """Write figures and report anew from a stored study of precision."""
    from presswear.studies.paper.variants import base_scene
    from presswear.validation.precision.report import write_precision_report
    from presswear.validation.precision.store import load

    taken = base_scene("wear-times").numerics
    answer, path = write_precision_report(load(folder), taken, folder)
    console.print(answer, highlight=False)
    console.print(f"data in {folder}, report in {path}", highlight=False)
    return 0


def _costs(arguments: argparse.Namespace, console: Console) -> int:
    repeats = None if arguments.repeats is None else repeats_given(arguments.repeats)
    scene = scene_given(SCENE)
    folder = arguments.out or free_folder("costs")
    with only_writer(folder):
        from presswear.validation.costs.study import QUICK, CostsExtent, store, study
        from presswear.validation.costs.tables import markdown_of, tables_of

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
