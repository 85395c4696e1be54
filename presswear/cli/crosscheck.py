"""``presswear crosscheck``: two engines, or a run and the table of another program."""

import argparse
from pathlib import Path

from rich.console import Console

from presswear.cli import terminal
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder, only_writer

MIN_CYCLES, MAX_CYCLES = 1e-3, 100.0  # time over which trajectories are compared, cycles


def crosscheck(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    excluded = ("set", "out", "duration") if arguments.against else ("until", "tolerance")
    for name in excluded:
        if getattr(arguments, name) not in (None, []):
            verb = "cannot be combined with" if arguments.against else "needs"
            raise InputError(f"--{name} {verb} --against; see presswear crosscheck --help")
    return (_against if arguments.against else _engines)(arguments, console)


def _engines(arguments: argparse.Namespace, console: Console) -> int:
    arguments.scene = arguments.scene or "wear-times"
    scene = terminal.requested_scene(arguments)
    shortest, longest = (n * scene.mechanism.period for n in (MIN_CYCLES, MAX_CYCLES))
    if arguments.duration is not None and not shortest <= arguments.duration <= longest:
        raise InputError(
            f"--duration {arguments.duration:g}: must be {shortest:.3g} to {longest:.3g} s, "
            f"{MIN_CYCLES:g} to {MAX_CYCLES:g} cycles"
        )
    folder = arguments.out or terminal.free_folder(f"crosscheck-{scene.name}")
    from presswear.show.figures import save
    from presswear.tools.serialize import write_json
    from presswear.validation.crosscheck import check_engines, draw_differences

    with only_writer(folder):
        with terminal.named_progress(console, "start") as report:
            outcome = check_engines(scene, arguments.duration, report)
        folder.mkdir(parents=True, exist_ok=True)
        write_json(folder / "crosscheck.json", {"schema": 1, **outcome.as_dict()})
        save(draw_differences(outcome), folder)
    reason = "trajectories diverge" if outcome.diverged else "the end; trajectories do not diverge"
    terminal.print_lines(console, f"compared up to {outcome.horizon:.4g} s: {reason}")
    _print_checks(
        console,
        ("difference", "bound"),
        [
            (check.quantity, check.unit, (check.value, check.bound), check.passed)
            for check in outcome.checks
        ],
    )
    terminal.print_lines(console, f"table and figure in {folder}")
    return 0 if outcome.passed else 1


def _against(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.scene is None:
        raise InputError("--against needs the result folder to compare with: crosscheck DIR")
    from presswear.results.export import TOLERANCE, compare_tables, read_table, table_of

    folder = Path(arguments.scene)
    check_folder(folder)
    theirs = read_table(arguments.against)
    ours = table_of(terminal.load_result(folder, console), 0)
    tolerance = arguments.tolerance or TOLERANCE
    columns = compare_tables(ours, theirs, arguments.until, tolerance)
    _print_checks(
        console,
        ("largest", "rms", "bound of rms"),
        [
            (each.column, each.unit, (each.greatest, each.rms, each.bound), each.passed)
            for each in columns
        ],
    )
    return 0 if all(each.passed for each in columns) else 1


def _print_checks(
    console: Console,
    names: tuple[str, ...],
    rows: list[tuple[str, str, tuple[float | None, ...], bool]],
) -> None:
    cells = []
    for quantity, unit, numbers, passed in rows:
        texts = ["" if value is None else f"{value:.2e}" for value in numbers]
        cells.append(
            [quantity, *texts, unit, "" if numbers[-1] is None else terminal.verdict(passed)]
        )
    terminal.print_table(console, ("quantity",), names, cells, ("unit", ""))
