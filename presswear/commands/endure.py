"""``presswear endure``: runs are killed, starved and damaged on purpose; exit code 1 on a loss."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.commands.terminal import print_table, progress_bar, verdict
from presswear.tools.errors import InputError
from presswear.tools.stopping import check_stopped


def add(commands: Any) -> None:
    """Add the parser of ``endure``."""
    endure = commands.add_parser(
        "endure",
        help="kill, starve and damage runs on purpose; exit code 1 when anything is lost",
        description="Runs of all engines are killed at random moments and gone on with, the disk "
        "fills up, folders vanish, files are damaged, runs get long. Whatever happens, what was "
        "computed must be kept and end equal to a run that was left alone. Bad input and altered "
        "results are drawn at random, each must be refused in one line. Three quarters of an "
        "hour; with --quick some minutes. Needs presswear[test].",
        epilog="example: presswear endure --quick --out endured.json",
    )
    endure.add_argument("--quick", action="store_true", help="a few of each")
    endure.add_argument("--out", type=Path, metavar="FILE", help="new file, .json: the table")
    endure.set_defaults(run=_endure)


def _endure(arguments: argparse.Namespace, console: Console) -> int:
    out: Path | None = arguments.out
    if out is not None and (out.exists() or not out.parent.is_dir()):
        raise InputError(f"--out {out}: a new file in a folder that exists is expected")
    from presswear.results.provenance import provenance
    from presswear.tools.files import write_bytes
    from presswear.trials.endure.trial import Trial
    from presswear.trials.endure.trials import attempts

    trials: list[Trial] = []
    tried = attempts(arguments.quick)
    with progress_bar(console) as bar:
        task = bar.add_task("endure", total=float(len(tried)))
        for k, attempt in enumerate(tried):

            def told(word: str, part: float, k: int = k) -> None:
                check_stopped()
                bar.update(task, description=word, completed=k + part)

            trials.append(attempt(told))
    print_table(
        console,
        ("what", "", "note"),
        ("tried", "survived"),
        [
            [
                trial.what,
                str(trial.tried),
                str(trial.survived),
                verdict(trial.passed) if trial.tried else "",
                trial.note,
            ]
            for trial in trials
        ],
    )
    if out is not None:
        table = {"provenance": provenance(), "trials": [asdict(trial) for trial in trials]}
        write_bytes(out, json.dumps(table, indent=1).encode())
    return 0 if all(trial.survived == trial.tried for trial in trials) else 1
