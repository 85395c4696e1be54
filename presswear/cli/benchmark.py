"""``presswear benchmark``: speed against error of the engines, and the cost of each feature.

It measures and does not judge: the exit code is 0 however slow or inaccurate a method is.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from presswear.cli import terminal
from presswear.tools.files import only_writer

if TYPE_CHECKING:
    from presswear.scene.scene import Scene

SCENE = "wear-times"


def benchmark(arguments: argparse.Namespace, console: Console) -> int:
    """Run the command and return its exit code."""
    repeats, scene = arguments.repeats, terminal.requested_scene(arguments)
    folder = arguments.out or terminal.free_folder(f"benchmark-{scene.name}")
    measure = _features if arguments.features else _work_precision
    with only_writer(folder):
        measure(scene, arguments.quick, repeats, folder, console)
        from presswear.results.folder import provenance
        from presswear.tools.serialize import write_json

        write_json(folder / "benchmark.json", {**provenance(), "scene": scene.as_dict()})
    terminal.print_lines(console, f"results in {folder}")
    return 0


def _work_precision(
    scene: "Scene", quick: bool, repeats: int | None, folder: Path, console: Console
) -> None:
    from presswear.show.figures import save
    from presswear.validation import work_precision as module
    from presswear.validation.timing import write_csv

    extent = module.QUICK if quick else module.FULL
    if repeats is not None:
        extent = replace(extent, repeats=repeats)
    with terminal.named_progress(console, "benchmark") as report:
        points = module.work_precision(scene, extent, report)
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(module.table(points), folder / "benchmark.csv")
    save(module.draw_work_precision(points), folder)
    for problem in {id(point.problem): point.problem for point in points}.values():
        quantity = next(iter(problem.quantities))
        rows = [
            [p.method.label, f"{1e3 * p.timing.wall:.3g}", f"{p.errors[quantity]:.1e}"]
            for p in points
            if p.problem is problem and p.timing is not None
        ]
        numbers = ("wall ms", f"error of {quantity}")
        terminal.print_table(
            console, ("method",), numbers, rows, title=problem.name, title_justify="left"
        )
    for point in points:
        if point.failure:
            words = f"{point.problem.name}: {point.method.label} failed: {point.failure}"
            console.print(words, highlight=False, markup=False)


def _features(
    scene: "Scene", quick: bool, repeats: int | None, folder: Path, console: Console
) -> None:
    from presswear.validation import feature_costs as module
    from presswear.validation.timing import write_csv

    extent = module.QUICK if quick else module.FeatureExtent()
    if repeats is not None:
        extent = replace(extent, repeats=repeats)
    with terminal.named_progress(console, "benchmark") as report:
        costs = module.feature_costs(scene, extent, report)
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(module.table(costs), folder / "features.csv")
    rows = [
        [
            f"{cost.feature}: {cost.state}",
            cost.engine,
            f"{cost.timing.per_second:.3f}",
            f"{1e6 * cost.timing.per_step:.2f}",
            f"{cost.step_ratio:.2f}",
            f"{cost.wall_ratio:.2f}",
        ]
        for cost in costs
    ]
    numbers = ("s/s", "us/step", "ratio/step", "ratio/s")
    terminal.print_table(console, ("feature", "engine"), numbers, rows)
    console.print(
        "s/s is wall time per simulated second; ratios are to the row without the feature",
        highlight=False,
    )
