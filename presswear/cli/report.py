"""``presswear report``: figures and report of a stored run or sweep."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.parser import LIMIT
from presswear.cli.terminal import load_result, print_lines
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder


def add(commands: Any) -> None:
    """Add the parser of ``report``."""
    parser = commands.add_parser(
        "report",
        parents=[LIMIT],
        description="Writes the figures and the report of a result folder or a sweep folder "
        "again, complete or not.",
        epilog="example: presswear report results/wear-times",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run or a sweep")
    parser.set_defaults(run=_report)


def _report(arguments: argparse.Namespace, console: Console) -> int:
    check_folder(arguments.folder)
    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.report(arguments, console)
    if arguments.limit:
        raise InputError(f"--limit needs a sweep; {arguments.folder} is a run")
    from presswear.show.report import write_report

    print_lines(console, f"report in {write_report(load_result(arguments.folder, console))}")
    return 0
