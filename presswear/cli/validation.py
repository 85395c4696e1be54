"""``presswear crosscheck``, ``verify`` and ``benchmark``: engines against references."""

import argparse
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli import terminal
from presswear.cli.terminal import print_lines, print_table, verdict
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder, only_writer

if TYPE_CHECKING:
    from presswear.scene.scene import Scene

# Time over which trajectories are compared, cycles
MIN_CYCLES = 1e-3
MAX_CYCLES = 100.0
Check = tuple[str, str, tuple[float, ...], bool]  # quantity, unit, numbers, passed


def crosscheck(arguments: argparse.Namespace, console: Console) -> int:
    """Compare two engines, or a run with the table of another program."""
    excluded = (
        ("set", "out", "duration") if arguments.against else ("until", "tolerance")
    )
    for name in excluded:
        if getattr(arguments, name) not in (None, []):
            verb = "cannot be combined with" if arguments.against else "needs"
            raise InputError(
                f"--{name} {verb} --against; see presswear crosscheck --help"
            )
    if arguments.against:
        return _against(arguments, console)
    return _engines(arguments, console)


def _engines(arguments: argparse.Namespace, console: Console) -> int:
    """Compare two engines."""
    arguments.scene = arguments.scene or "wear-times"
    scene = terminal.requested_scene(arguments)
    shortest = MIN_CYCLES * scene.mechanism.period
    longest = MAX_CYCLES * scene.mechanism.period
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
    reason = "the end; trajectories do not diverge"
    if outcome.diverged:
        reason = "trajectories diverge"
    print_lines(console, f"compared up to {outcome.horizon:.4g} s: {reason}")
    checks = []
    for check in outcome.checks:
        numbers = (check.value, check.bound)
        checks.append((check.quantity, check.unit, numbers, check.passed))
    _print_checks(console, (">difference", ">bound"), checks)
    print_lines(console, *outcome.undecided)
    if outcome.undecided:
        print_lines(
            console,
            "no verdict: the interval of the difference of both engines is too wide; more "
            "cycles (--set cycles=N) narrow it",
        )
    print_lines(console, f"table and figure in {folder}")
    return 0 if outcome.passed else 1


def _against(arguments: argparse.Namespace, console: Console) -> int:
    """Compare a run with the table of another program."""
    if arguments.scene is None:
        raise InputError(
            "--against needs the result folder to compare with: crosscheck DIR"
        )
    from presswear.results.export import TOLERANCE, compare_tables, read_table, table_of

    folder = Path(arguments.scene)
    check_folder(folder)
    external_table = read_table(arguments.against)
    table = table_of(terminal.load_result(folder, console), 0)
    tolerance = arguments.tolerance or TOLERANCE
    differences = compare_tables(table, external_table, arguments.until, tolerance)
    checks = []
    for column in differences:
        numbers = (column.greatest, column.rms, column.bound)
        checks.append((column.column, column.unit, numbers, column.passed))
    _print_checks(console, (">largest", ">rms", ">bound of rms"), checks)
    return 0 if all(column.passed for column in differences) else 1


def _print_checks(
    console: Console, names: tuple[str, ...], checks: Iterable[Check]
) -> None:
    """Print a table of checks; ``names`` are the heads of the columns of their numbers."""
    rows = []
    for quantity, unit, numbers, passed in checks:
        texts = [f"{value:.2e}" for value in numbers]
        rows.append([quantity, *texts, unit, verdict(passed)])
    print_table(console, ("quantity", *names, "unit", ""), rows)


def verify(arguments: argparse.Namespace, console: Console) -> int:
    """Run the engines on reference problems."""
    from presswear.validation.cases import Outcome, outcomes
    from presswear.validation.reference_problems import reference_cases

    cases = reference_cases()
    results: list[Outcome] = []
    with terminal.named_progress(console, "verify") as report:
        for k, case in enumerate(cases):
            report(case.name, k / len(cases))
            results.extend(outcomes(case))
    rows = []
    for check, passed, label in results:
        cells = ["", "", "", ""]
        if check is not None and check.reference is not None:
            cells = [f"{check.reference:.9g}", f"{check.reference + check.value:.9g}"]
            cells += [f"{abs(check.value):.1e}", f"{check.bound:.0e}"]
        rows.append([label, *cells, verdict(passed)])
    heads = ("quantity", ">reference", ">computed", ">error", ">bound", "")
    print_table(console, heads, rows)
    count = sum(outcome.passed for outcome in results)
    print_lines(console, f"{count} of {len(results)} within their bounds")
    return 0 if count == len(results) else 1


def benchmark(arguments: argparse.Namespace, console: Console) -> int:
    """Measure speed against error, or the cost of each feature.

    It measures and does not judge: the exit code is 0 however slow or inaccurate a
    method is.
    """
    scene = terminal.requested_scene(arguments)
    folder = arguments.out or terminal.free_folder(f"benchmark-{scene.name}")
    from presswear.results.provenance import provenance
    from presswear.tools.serialize import write_json

    measure = _measure_features if arguments.features else _measure_methods
    with only_writer(folder):
        measure(scene, arguments, folder, console)
        write_json(
            folder / "benchmark.json", {**provenance(), "scene": scene.as_dict()}
        )
    print_lines(console, f"results in {folder}")
    return 0


def _measure_methods(
    scene: "Scene", arguments: argparse.Namespace, folder: Path, console: Console
) -> None:
    from presswear.results.export import write_rows
    from presswear.show.figures import save
    from presswear.validation import benchmark
    from presswear.validation.benchmark_problems import FULL, QUICK

    extent = QUICK if arguments.quick else FULL
    extent = replace(extent, repeats=arguments.repeats or extent.repeats)
    with terminal.named_progress(console, "benchmark") as report:
        points = benchmark.work_precision(scene, extent, report)
    write_rows(folder / "benchmark.csv", benchmark.table(points))
    save(benchmark.draw_work_precision(points), folder)
    _print_methods(console, points)


def _measure_features(
    scene: "Scene", arguments: argparse.Namespace, folder: Path, console: Console
) -> None:
    from presswear.results.export import write_rows
    from presswear.validation import benchmark

    extent = benchmark.QUICK_FEATURES if arguments.quick else benchmark.FeatureExtent()
    extent = replace(extent, repeats=arguments.repeats or extent.repeats)
    with terminal.named_progress(console, "benchmark") as report:
        rows = benchmark.feature_costs(scene, extent, report)
    write_rows(folder / "features.csv", rows)
    _print_features(console, rows)


def _print_methods(console: Console, points: Any) -> None:
    """Print CPU time and first error of each method, and the failures."""
    from presswear.validation.benchmark import problems_of

    for problem in problems_of(points):
        quantity = next(iter(problem.quantities))
        rows = []
        for point in points:
            if point.problem is problem and point.timing is not None:
                cpu = f"{1e3 * point.timing.cpu:.3g}"
                error = f"{point.errors[quantity]:.1e}"
                rows.append([point.method.label, cpu, error])
        heads = ("method", ">CPU ms", f">error of {quantity}")
        print_table(console, heads, rows, problem.name)
    for point in points:
        if point.failure:
            label = f"{point.problem.name}: {point.method.label}"
            print_lines(console, f"{label} failed: {point.failure}")


def _print_features(console: Console, table: Any) -> None:
    """Print the costs of each feature."""
    rows = []
    for row in table:
        cells = [
            f"{row['feature']}: {row['state']}",
            row["engine"],
            f"{row['cpu_s_per_simulated_s']:.3f}",
            f"{1e6 * row['cpu_s_per_step']:.2f}",
            f"{row['ratio_per_step']:.2f}",
            f"{row['ratio_per_simulated_second']:.2f}",
        ]
        rows.append(cells)
    heads = ("feature", "engine", ">s/s", ">us/step", ">ratio/step", ">ratio/s")
    print_table(console, heads, rows)
    meaning = "s/s is CPU time per simulated second; ratios are to the row without the feature"
    print_lines(console, meaning)
