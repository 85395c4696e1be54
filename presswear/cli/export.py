"""``presswear export``: stored results as tables for other programs."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.parser import integer
from presswear.cli.terminal import load_result, print_lines

COLUMNS = (
    "Columns, in SI units: time, displacement, velocity and acceleration of the slider; for each "
    "clearance joint J: J_eccentricity_x, J_eccentricity_y, J_penetration, J_normal_force, "
    "J_tangential_force, J_sliding (speed); height above the ideal bottom dead centre; "
    "process_force if there is a process; for each driven body D: D_angle and, if torques are "
    "stored, D_torque and D_power. CSV files have a header line and # comments, NPZ files one "
    "array per column."
)


def add(commands: Any) -> None:
    """Add the parser of ``export``."""
    parser = commands.add_parser(
        "export",
        description=f"Writes the recorded series of a stage. {COLUMNS}",
        epilog="example: presswear export results/wear-times first.csv --stage 0",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run or a sweep")
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="new file, .csv or .npz; for a sweep .csv or .parquet with one row per run",
    )
    parser.add_argument(
        "--stage",
        type=integer(0),
        default=0,
        metavar="K",
        help="0 unworn (default), 1 after the first wear update, ...",
    )
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument(
        "--strokes",
        action="store_true",
        help="time and height above bottom dead centre at contact, fracture and separation of "
        "each recorded stroke; nan if absent",
    )
    kinds.add_argument(
        "--life",
        action="store_true",
        help="quantities through a service life over strokes: depth, wear_volume and force_max of "
        "each joint J as J_depth, J_depth_low, J_depth_high, ..., and bottom dead centre",
    )
    parser.set_defaults(run=_export)


def _export(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.results.export import life_table, strokes_table, table_of, write_table

    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.export(arguments, console)
    result = load_result(arguments.folder, console)
    if arguments.life:
        table = life_table(result)
    else:
        table = (strokes_table if arguments.strokes else table_of)(result, arguments.stage)
    write_table(arguments.file, table)
    rows = next(iter(table.values())).size
    print_lines(console, f"{rows} rows of {len(table)} columns in {arguments.file}")
    return 0
