"""``presswear verify``: both engines against reference problems."""

import argparse
from typing import Any

from rich.console import Console

from presswear.commands.terminal import print_table, progress_bar, verdict


def add(commands: Any) -> None:
    """Add the parser of ``verify``."""
    verify = commands.add_parser(
        "verify",
        help="both engines against reference problems with known answers; exit code 1 on a miss",
        epilog="example: presswear verify",
    )
    verify.set_defaults(run=_verify)


def _verify(arguments: argparse.Namespace, console: Console) -> int:
    from presswear.verify import verify

    with progress_bar(console) as bar:
        task = bar.add_task("verify", total=1.0)
        rows = verify(lambda name, part: bar.update(task, description=name, completed=part))
    print_table(
        console,
        ("problem", ""),
        ("reference", "ours", "error", "bound"),
        [
            [
                row.name,
                f"{row.reference:.9g}",
                f"{row.ours:.9g}",
                f"{row.error:.1e}",
                f"{row.bound:.0e}",
                verdict(row.passed),
            ]
            for row in rows
        ],
    )
    missed = sum(not row.passed for row in rows)
    console.print(f"{len(rows) - missed} of {len(rows)} within their bounds", highlight=False)
    return 1 if missed else 0
