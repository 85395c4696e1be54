"""The study of costs as tables of words, for a terminal or a Markdown file."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

from presswear.engines import settings
from presswear.validation.costs.features import FeatureTable
from presswear.validation.costs.side_by_side import (
    HAND,
    IN_HOUSE,
    LEVELS,
    REFERENCE,
    TOO_DEAR,
    TREE,
    Level,
    SideBySide,
)
from presswear.validation.costs.study import Costs
from presswear.validation.timing import Timing


@dataclass(frozen=True)
class TextTable:
    """A table of words: columns of texts, then of numbers; the sentences explain it."""

    title: str
    texts: tuple[str, ...]
    numbers: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    sentences: tuple[str, ...]


SIZES = "Behind a model stand its coordinates and, after a +, its constraints."


def _fixed(value: float, digits: int) -> str:
    """A number with so many decimals, never -0."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


def _ends(timing: Timing, unit: float) -> str:
    """Least and greatest wall time, in parts of a time, s."""
    return "{:.2f}..{:.2f}".format(*(wall / unit for wall in timing.ends))


def _features(table: FeatureTable, simulated: float, surfaces: str) -> TextTable:
    repeats = len(table.rows[0].timing.walls)
    sentences = [
        f"{simulated:.3g} s simulated; medians of {repeats}, least and greatest.",
        "The motion differs from row to row and with it the number of steps, so the fair measure "
        "of a feature is the time of one attempted step; ratios, of us/step and of s/s, are to the "
        "row with it off.",
        SIZES,
    ]
    if any(row.feature == "worn surfaces" for row in table.rows):
        sentences.append(surfaces)
    rows = tuple(
        (
            f"{row.feature}: {row.state}",
            row.timing.model,
            _fixed(row.timing.per_second, 3),
            _fixed(1e6 * row.timing.per_step, 2),
            _ends(row.timing, 1e-6 * row.timing.attempts),
            _fixed(row.timing.attempts / row.timing.simulated, 0),
            _fixed(row.step_ratio, 3),
            _fixed(row.wall_ratio, 2),
        )
        for row in table.rows
    )
    numbers = ("s/s", "us/step", "min..max", "steps/s", "ratio/step", "ratio/s")
    return TextTable(table.title, ("feature", "model"), numbers, rows, tuple(sentences))


def _ratio(cost: float | None, unit: float | None) -> str:
    """A cost in parts of a unit, with two digits that count."""
    if not (cost and unit and math.isfinite(cost)):
        return "-"
    return f"{float(f'{cost / unit:.2g}'):g}"


def _costs_of(level: Level | None) -> tuple[float | None, float | None]:
    """Costs of a method at an error in both tasks, s/s, as far as they are known."""
    if level is None:
        return None, None
    return level.cost, level.long.cost if level.long else None


def _beside(found: SideBySide) -> TextTable:
    units = [own.cost or 0.0 for own in found.units]
    order, tolerance = settings.IN_HOUSE["wear"]
    rows = []
    for method in found.methods:
        cells = [method.name]
        for level in method.levels:
            cells += map(_ratio, _costs_of(level), units)
        rows.append(tuple(cells))
    sentences = [
        f"Processor time in parts of that of {TREE} at {found.units[0].value:.0e}, its tolerance "
        f"for trajectories, at equal error; medians over {len(found.units[1].seconds)} starts, run "
        "in turn.",
        f"Task a is the first {found.short:g} s with {found.touches} touches. The error is that "
        "of the slider and of the links' ends, against the in-house solver at "
        f"{REFERENCE:.0e}; cost and setting are found between those of two others. Task b is "
        f"{found.long:.3g} s at that setting: pins rest in contact nine tenths of the time. What "
        f"takes more than {TOO_DEAR:g} times the tree's time in task a is left out.",
        f"For wear scenes take {settings.TREE_TOLERANCES['wear']:.0e} in {TREE} and "
        f"{order.upper()} at {tolerance:.0e} in-house; the errors that these make in task a stand "
        "below.",
        "By hand: minimal coordinates, compiled, 2 by 2 equations solved directly; the loop sums "
        "the work of friction, the others keep nothing.",
        *(_verdict(found, k) for k in range(len(LEVELS))),
    ]
    if found.missing:
        sentences.append(f"Not installed: {', '.join(found.missing)}.")
    numbers = tuple(name for error in LEVELS for name in (f"{error:.0e} m: a", "b"))
    return TextTable("Same work, side by side", ("method",), numbers, tuple(rows), tuple(sentences))


def _verdict(found: SideBySide, k: int) -> str:
    """How the in-house solver stands beside the loop by hand at an error."""
    costs = {method.name: _costs_of(method.levels[k]) for method in found.methods}
    words = []
    for task, name in enumerate("ab"):
        own = {
            cost[task] or math.inf: method
            for method, cost in costs.items()
            if method.startswith(IN_HOUSE)
        }
        best = min(own)
        words.append(f"{_ratio(best, costs[HAND][task])} in task {name} ({own[best]})")
    return (
        f"The in-house solver takes, of the loop by hand at {LEVELS[k]:.0e} m, {', '.join(words)}."
    )


def _runs(found: SideBySide) -> TextTable:
    rows = []
    for method in found.methods:
        runs = [("a", own) for own in method.settings]
        runs += [("b", level.long) for level in method.levels if level and level.long]
        for task, own in runs:
            cost = own.cost
            rows.append(
                (
                    method.name,
                    task,
                    f"{own.value:.3g}",
                    *("-" if x is None else f"{x:.1e}" for x in (own.error, own.touch_error)),
                    _fixed(own.steps, 0),
                    _fixed(own.evaluations / own.steps, 1) if own.evaluations else "-",
                    "failed" if cost is None else _fixed(1e6 * cost / own.steps, 2),
                )
            )
    return TextTable(
        "Work and precision",
        ("method", "task"),
        ("setting", "error, m", "touches, s", "steps/s", "a step", "us/step"),
        tuple(rows),
        (
            "A setting is a tolerance, a step in s, or for exudyn-joints the steps in an impact; "
            "those of task b make the errors above. "
            "Steps are those tried in a simulated second; beside them the evaluations in a step.",
        ),
    )


def tables_of(costs: Costs) -> tuple[TextTable, ...]:
    """All tables of a study."""
    extent, period = costs.extent, costs.scene.mechanism.period
    depths = ", ".join(f"{1e6 * depth:.0f} um at {name}" for name, depth in costs.deepest.items())
    surfaces = (
        f"Worn surfaces are those after the scene's own first wear, known from "
        f"{extent.wear_cycles} cycle{'s' if extent.wear_cycles > 1 else ''}: bearing and pin "
        f"together at most {depths}."
    )
    tree, joints = extent.tree_cycles * period, extent.joints_cycles * period
    features = [
        _features(table, simulated, surfaces)
        for table, simulated in zip(costs.features, (tree, tree, joints), strict=True)
    ]
    return (_beside(costs.side_by_side), _runs(costs.side_by_side), *features)


def markdown_of(costs: Costs) -> str:
    """The tables as a Markdown file."""
    origin = costs.provenance
    packages = origin["packages"]
    lines = [
        "# What the features of a model cost",
        "",
        f"Scene {costs.scene.name}, {costs.scene.title[:1].lower()}{costs.scene.title[1:]}; one "
        f"core of {costs.processor} ({origin['machine']}); Exudyn {packages['exudyn']}, "
        f"Python {origin['python']}, revision {origin['revision']}. Only the solve is "
        "timed, not compiling and building; repeats are interleaved. Between machines compare "
        "ratios, not times. s/s is wall time per simulated second.",
    ]
    for table in tables_of(costs):
        marks = ["---"] * len(table.texts) + ["---:"] * len(table.numbers)
        lines += ["", f"## {table.title}", "", _line((*table.texts, *table.numbers)), _line(marks)]
        lines += [_line(row) for row in table.rows]
        lines += ["", " ".join(table.sentences)]
    return "\n".join([*lines, ""])


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
