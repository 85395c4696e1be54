"""``presswear verify``: both engines against reference problems, and where it is hard."""

import argparse
from typing import Any

from rich.console import Console
from rich.markup import escape

from presswear.cli.terminal import print_table, progress_bar, verdict
from presswear.cli.trials import telling
from presswear.tools.errors import InputError


def add(commands: Any) -> None:
    """Add the parser of ``verify``."""
    verify = commands.add_parser(
        "verify",
        description="Without --hard: published references and closed forms. With --hard: cases "
        "in which a run could hang, break or be wrong without a word, at the ends of all ranges; "
        "each has its energy add up within a bound, or is refused by name, value and range.",
        epilog="example: presswear verify; presswear verify --hard",
    )
    verify.add_argument("--hard", action="store_true", help="the hard cases, some minutes")
    verify.add_argument(
        "--long", action="store_true", help="with --hard: those that take minutes each, too"
    )
    verify.set_defaults(run=_verify)


def _verify(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.hard:
        return _hard(console, long=arguments.long)
    if arguments.long:
        raise InputError("--long goes only with --hard; see presswear verify --help")
    from presswear.validation.verify.verify import verify

    with telling(console, "verify") as told:
        rows = verify(told)
    print_table(
        console,
        ("problem",),
        ("reference", "ours", "error", "bound"),
        [[*row.cells, verdict(row.passed)] for row in rows],
        ("",),
    )
    missed = sum(not row.passed for row in rows)
    console.print(f"{len(rows) - missed} of {len(rows)} within their bounds", highlight=False)
    return 1 if missed else 0


def _hard(console: Console, *, long: bool) -> int:
    """Run the hard cases, print what came of them; 1 on a miss."""
    from presswear.validation.hard import hard_cases
    from presswear.validation.hard.case import HardOutcome, outcomes

    cases = [case for case in hard_cases() if long or not case.long]
    found: list[HardOutcome] = []
    with progress_bar(console) as bar:
        task = bar.add_task("hard cases", total=float(len(cases)))
        for case in cases:
            bar.update(task, description=f"{case.name}, {case.engine}")
            found.extend(outcomes(case))
            bar.advance(task)
    print_table(
        console,
        ("case",),
        ("figure", "bound", "s"),
        [
            [
                outcome.case.name,
                *outcome.numbers,
                f"{outcome.seconds:.1f}",
                outcome.case.engine,
                escape(outcome.checked),
                outcome.verdict if outcome.verdict != "MISS" else verdict(False),
            ]
            for outcome in found
        ],
        ("engine", "checked", ""),
    )
    missed = sum(outcome.verdict == "MISS" for outcome in found)
    refused = sum(outcome.verdict == "refused" for outcome in found)
    console.print(
        f"{len(found) - missed - refused} of {len(found)} within their bounds, {refused} refused "
        f"by name, {missed} missed",
        highlight=False,
    )
    return 1 if missed else 0
