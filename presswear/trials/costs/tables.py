"""The study of costs as tables of words, for a terminal or a Markdown file."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from presswear.trials.costs.equal_work import FIXED_STEP, REFERENCE, WANTED, EqualWork
from presswear.trials.costs.features import FeatureTable
from presswear.trials.costs.profile import LARGEST_PYTHON_SHARE, Profile
from presswear.trials.costs.study import Costs
from presswear.trials.timing import Timing


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


def _engines(work: EqualWork) -> TextTable:
    rows = tuple(
        (
            row.timing.name,
            row.timing.model,
            f"{row.timing.attempts}",
            f"{row.slider_error:.1e}",
            f"{row.touchdown_error:.1e}",
            _fixed(row.timing.per_second, 3),
            _ends(row.timing, row.timing.simulated),
            _fixed(row.faster, 1),
        )
        for row in work.rows
    )
    tree, fixed = work.tree, work.fixed
    return TextTable(
        "Engines at equal work",
        ("engine", "model"),
        ("steps", "slider, m", "touches, s", "s/s", "min..max", "faster"),
        rows,
        (
            f"{work.simulated:g} s simulated; medians of {len(fixed.timing.walls)}, least and "
            f"greatest. Errors against the in-house solver at tolerance "
            f"{REFERENCE.integration_tolerance:.0e}: the slider at the end, and the greatest of "
            f"the first {work.touchdowns} touches' times.",
            SIZES,
            f"All {fixed.timing.steps} steps of the first row are {FIXED_STEP:.0e} s. "
            f"The open tree as scenes take it is {tree.faster:.0f} times faster "
            f"(at least {WANTED:.0f} is wanted) with errors of {tree.slider_error:.1e} m and "
            f"{tree.touchdown_error:.1e} s against {fixed.slider_error:.1e} m and "
            f"{fixed.touchdown_error:.1e} s: {'as wanted' if work.passed else 'MISSED'}.",
        ),
    )


def _profiles(profiles: Mapping[str, Profile]) -> TextTable:
    found = list(profiles.values())
    rows = []
    for parts in zip(*(each.parts for each in found), strict=True):
        cells = [parts[0].name, parts[0].kind]
        for each, part in zip(found, parts, strict=True):
            cells.append(_fixed(1e6 * part.seconds / each.timing.attempts, 2))
            cells.append(_fixed(100.0 * part.share, 1))
        rows.append(tuple(cells))
    sentences = [
        f"{found[0].timing.simulated:.3g} s simulated; medians of {len(found[0].timing.walls)}. "
        "Kernels were timed in compiled loops on the states of the run, clocks around Python's "
        "functions are subtracted; Exudyn's own part is its timer of the mass matrix, and what "
        "is left."
    ]
    for name, each in profiles.items():
        largest = each.largest_python
        verdict = "none is above" if largest.share <= LARGEST_PYTHON_SHARE else "ABOVE"
        sentences.append(
            f"{name.capitalize()}: Python as such takes {100.0 * each.share_of('Python'):.0f} % of "
            f"the run, with its kernels {100.0 * each.share_of('Python', 'kernel'):.0f} %; its "
            f"longest stage ({largest.name}) takes {100.0 * largest.share:.0f} %: {verdict} "
            f"{100.0 * LARGEST_PYTHON_SHARE:.0f} %."
        )
    columns = tuple(column for name in profiles for column in (f"{name}, us/step", "%"))
    title = "Where the time of the open tree goes"
    return TextTable(title, ("stage", "in"), columns, tuple(rows), tuple(sentences))


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
    return (*features, _engines(costs.engines), _profiles(costs.profiles))


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
