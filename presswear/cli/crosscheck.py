"""``presswear crosscheck``: engine against engine, or a run against another solver's table."""

import argparse
from pathlib import Path
from typing import Any

from rich.console import Console

from presswear.cli.export import TABLE_TEXT
from presswear.cli.terminal import (
    add_out,
    add_settings,
    finished_part,
    free_folder,
    number_given,
    print_table,
    scene_given,
    settings_given,
    verdict,
)
from presswear.cli.trials import telling
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder, only_writer

_CYCLES = (1e-3, 100.0)
"""Shortest and longest time over which trajectories are compared, cycles."""


def add(commands: Any) -> None:
    """Add the parser of ``crosscheck``."""
    check = commands.add_parser(
        "crosscheck",
        description="Without --against: Exudyn (the open tree where there is one, or what --set "
        "engine=... says) and the in-house solver run a scene on unworn surfaces from the same "
        "start. They are compared one by one up to the horizon, where a start moved by 1e-9 m has "
        "grown apart a thousand times, and by means over cycles beyond it (8 cycles, or as many as "
        "--set cycles=N says). With --against: stage 0 of a result folder is compared with "
        f"another solver's table. {TABLE_TEXT} Ours is interpolated at their times; between "
        "stored rows forces and accelerations are known to some per cent only, so export first "
        "and let the other solver write its rows at our times.",
        epilog="example: presswear crosscheck wear-times --set 'speed=8pi rad/s'; "
        "presswear crosscheck results/wear-times --against theirs.csv --until 0.1",
    )
    check.add_argument(
        "target", nargs="?", metavar="SCENE|DIR", help="scene (default wear-times) or result folder"
    )
    add_out(check, "crosscheck-SCENE")
    add_settings(check)
    check.add_argument(
        "--duration",
        type=number_given,
        metavar="S",
        help="longest time that trajectories are compared, s (default one cycle)",
    )
    check.add_argument("--against", type=Path, metavar="FILE", help="table, .csv or .npz")
    check.add_argument(
        "--until",
        type=number_given,
        metavar="S",
        help="last time compared, s (default: all in common)",
    )
    check.add_argument(
        "--tolerance",
        type=number_given,
        metavar="X",
        help="rms difference allowed in a column, part of its rms (default 1e-3)",
    )
    check.set_defaults(run=_crosscheck)


def _crosscheck(arguments: argparse.Namespace, console: Console) -> int:
    own, foreign = ("set", "out", "duration"), ("until", "tolerance")
    for name in own if arguments.against else foreign:
        if getattr(arguments, name) not in (None, []):
            word = "does not go" if arguments.against else "goes only"
            raise InputError(f"--{name} {word} with --against; see presswear crosscheck --help")
    for name in ("duration", *foreign):
        value = getattr(arguments, name)
        if value is not None and not 0.0 < value < float("inf"):
            raise InputError(f"--{name} {value:g}: a finite number above 0 is expected")
    if arguments.against:
        return _against(arguments, console)
    scene = changed(scene_given(arguments.target or "wear-times"), settings_given(arguments.set))
    scene.check()
    period = scene.mechanism.period
    least, most = (cycles * period for cycles in _CYCLES)
    if arguments.duration is not None and not least <= arguments.duration <= most:
        raise InputError(
            f"--duration {arguments.duration:g}: allowed is {least:.3g} to {most:.3g} s, "
            f"{_CYCLES[0]:g} to {_CYCLES[1]:g} cycles"
        )
    folder = arguments.out or free_folder(f"crosscheck-{scene.name}")
    from presswear.show.figures import save
    from presswear.tools.serialize import write_json
    from presswear.validation.crosscheck import check_engines, draw_differences

    with only_writer(folder):
        with telling(console, "start") as report:
            outcome = check_engines(scene, arguments.duration, report)
        folder.mkdir(parents=True, exist_ok=True)
        write_json(folder / "crosscheck.json", {"schema": 1, **outcome.as_dict()})
        save(draw_differences(outcome), folder)
        how = "where trajectories part" if outcome.parted else "the end; trajectories did not part"
        console.print(f"compared up to {outcome.horizon:.4g} s, {how}", highlight=False)
        _print_checks(
            console,
            ("difference", "bound"),
            [
                (check.quantity, check.unit, (check.value, check.bound), check.passed)
                for check in outcome.checks
            ],
        )
        console.print(f"table and figure in {folder}", highlight=False)
        return 0 if outcome.passed else 1


def _against(arguments: argparse.Namespace, console: Console) -> int:
    if arguments.target is None:
        raise InputError("--against needs the result folder to compare with: crosscheck DIR")
    from presswear.results.export import TOLERANCE, compare_tables, read_table, table_of

    folder = Path(arguments.target)
    check_folder(folder)
    theirs = read_table(arguments.against)
    ours = table_of(finished_part(folder, console), 0)
    tolerance = TOLERANCE if arguments.tolerance is None else arguments.tolerance
    columns = compare_tables(ours, theirs, arguments.until, tolerance)
    _print_checks(
        console,
        ("greatest", "rms", "bound of rms"),
        [
            (found.column, found.unit, (found.greatest, found.rms, found.bound), found.passed)
            for found in columns
        ],
    )
    return 0 if all(found.passed for found in columns) else 1


def _print_checks(
    console: Console,
    names: tuple[str, ...],
    rows: list[tuple[str, str, tuple[float | None, ...], bool]],
) -> None:
    """Print quantities with their numbers, and whether each is within its bound."""
    cells = []
    for quantity, unit, numbers, passed in rows:
        shown = ["" if number is None else f"{number:.2e}" for number in numbers]
        cells.append([quantity, *shown, unit, "" if numbers[-1] is None else verdict(passed)])
    print_table(console, ("quantity",), names, cells, ("unit", ""))
