"""``presswear verify``: the engines on reference problems and on hard cases."""

import argparse
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from presswear.cli.terminal import print_lines, print_table, progress_bar, verdict
from presswear.tools.errors import InputError

if TYPE_CHECKING:
    from presswear.validation.cases import Outcome


def verify(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    if arguments.long and not arguments.hard:
        raise InputError("--long needs --hard; see presswear verify --help")
    from presswear.validation import cases, hard_cases, reference_problems

    selected = reference_problems.reference_cases()
    if arguments.hard:
        selected = [case for case in hard_cases.hard_cases() if arguments.long or not case.is_long]
    outcomes: list[Outcome] = []
    with progress_bar(console) as bar:
        task = bar.add_task("verify", total=float(len(selected)))
        for case in selected:
            bar.update(task, description=f"{case.name}, {case.engine}")
            outcomes.extend(cases.outcomes(case))
            bar.advance(task)
    (_print_hard if arguments.hard else _print_references)(console, outcomes)
    missed = sum(outcome.verdict == "MISS" for outcome in outcomes)
    refused = sum(outcome.verdict == "refused" for outcome in outcomes)
    others = f", {refused} refused, {missed} missed" if arguments.hard else ""
    passed = len(outcomes) - missed - refused
    print_lines(console, f"{passed} of {len(outcomes)} within their bounds{others}")
    return 1 if missed else 0


def _print_references(console: Console, outcomes: "list[Outcome]") -> None:
    rows = []
    for outcome in outcomes:
        check, cells = outcome.check, ["", "", "", ""]
        if check is not None and check.reference is not None:
            cells = [f"{check.reference:.9g}", f"{check.reference + check.value:.9g}"]
            cells += [f"{abs(check.value):.1e}", f"{check.bound:.0e}"]
        rows.append([outcome.label, *cells, verdict(outcome.verdict == "pass")])
    numbers = ("reference", "computed", "error", "bound")
    print_table(console, ("quantity",), numbers, rows, ("",))


def _print_hard(console: Console, outcomes: "list[Outcome]") -> None:
    rows = []
    for outcome in outcomes:
        case, check, numbers = outcome.case, outcome.check, ["", ""]
        if check is not None:
            numbers = [f"{check.value:.1e}", f"{check.bound:.0e}"]
        mark = outcome.verdict if outcome.verdict != "MISS" else verdict(False)
        cells = [f"{outcome.seconds:.1f}", case.engine, escape(outcome.label), mark]
        rows.append([case.name, *numbers, *cells])
    names = ("engine", "checked", "")
    print_table(console, ("case",), ("value", "bound", "s"), rows, names)
