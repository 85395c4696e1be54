"""``presswear export``: the recorded motion of a run as a table for other programs."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.terminal import finished_part, place_given

TABLE_TEXT = (
    "Columns, in SI units: time, displacement, velocity, acceleration (of the slider), and for "
    "each clearance joint J: J_eccentricity_x, J_eccentricity_y, J_penetration, J_normal_force, "
    "J_tangential_force, J_sliding (speed). Further height (over the ideal bottom dead centre), "
    "process_force where there is a process, and for each driven body D: D_angle and, where "
    "torques are stored, D_torque and D_power. CSV with a header line of names and # comments, or "
    "NPZ with one array per column; another program's table may hold any subset beside time."
)


def add(commands: Any) -> None:
    """Add the parser of ``export``."""
    export = commands.add_parser(
        "export",
        description=f"Writes the recorded series of a stage. {TABLE_TEXT}",
        epilog="example: presswear export results/wear-times first.csv --stage 0",
    )
    export.add_argument("folder", type=Path, metavar="DIR")
    export.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="new file, .csv or .npz; of a sweep .csv or .parquet, a row a run",
    )
    export.add_argument(
        "--stage",
        type=place_given,
        default=0,
        metavar="K",
        help="0 unworn (default), 1 after a wear, ...",
    )
    kinds = export.add_mutually_exclusive_group()
    kinds.add_argument(
        "--strokes",
        action="store_true",
        help="the moments of the recorded strokes instead, a row each: time and height over "
        "bottom dead centre at contact, fracture and separation, nan where there is none",
    )
    kinds.add_argument(
        "--life",
        action="store_true",
        help="what was followed through a life instead, over strokes: depth, wear_volume and "
        "force_max of each joint J as J_depth, J_depth_low, J_depth_high, ..., bottom dead centre "
        "likewise",
    )
    export.set_defaults(run=_export)


def _export(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.results.export import life_table, strokes_table, table_of, write_table

    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.export(arguments, console)
    result = finished_part(arguments.folder, console)
    if arguments.life:
        table = life_table(result)
    else:
        table = (strokes_table if arguments.strokes else table_of)(result, arguments.stage)
    write_table(arguments.file, table)
    rows = next(iter(table.values())).size
    console.print(f"{rows} rows of {len(table)} columns in {arguments.file}", highlight=False)
    return 0
