"""``presswear report``: figures and report of a stored run or sweep."""

import argparse

from rich.console import Console

from presswear.cli.terminal import load_result, print_lines
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    check_folder(arguments.folder)
    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.report(arguments, console)
    if arguments.limit:
        raise InputError(f"--limit needs a sweep; {arguments.folder} is a run")
    from presswear.show.report import write_report

    print_lines(console, f"report in {write_report(load_result(arguments.folder, console))}")
    return 0
