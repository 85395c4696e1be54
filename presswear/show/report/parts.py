"""Tables of the report, and their cells from the statistics of a stage."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from presswear.recording.statistics import Estimate
from presswear.results.result import Result
from presswear.results.stage import JointStatistics, OutputStatistics, StageResult
from presswear.show.figures.style import stage_names
from presswear.tools.numbers import readable, whole, with_interval

Column = TypeVar("Column")
Row = tuple[str, ...]
Rows = Mapping[str, Callable[[Column], str]]
"""By a row's label, the function that gives its text in a column."""
Text = Callable[[StageResult], str]
"""Gives the text in the column of a stage."""

MICRONS = 1e6
MILLI = 1e3
CUBIC_MILLIMETRES = 1e9
NOTHING = "–"


@dataclass(frozen=True)
class Table:
    """A table as the page shows it.

    Attributes
    ----------
    head : tuple of str
        Column titles; the first column names the rows.
    groups : tuple
        Rows under a heading each; an empty heading is not shown.
    numeric : bool
        True where all but the first column are numbers.
    """

    head: Row
    groups: tuple[tuple[str, tuple[Row, ...]], ...]
    numeric: bool = True


def column_table(
    corner: str,
    heads: Sequence[str],
    columns: Sequence[Column],
    groups: Mapping[str, Rows[Column]],
) -> Table:
    """A table whose rows, under their headings, say something of each column."""
    told = {
        heading: tuple((label, *map(text, columns)) for label, text in rows.items())
        for heading, rows in groups.items()
    }
    return Table((corner, *heads), tuple(told.items()))


def stage_table(result: Result, corner: str, groups: Mapping[str, Rows[StageResult]]) -> Table:
    """A table with a column for each stage."""
    return column_table(corner, stage_names(result, result.stages), result.stages, groups)


def by_joint(result: Result, of_joint: Callable[[str], Rows[Column]]) -> dict[str, Rows[Column]]:
    """Rows of each joint with clearance under its heading."""
    return {f"Joint {joint}": of_joint(joint) for joint in result.scene.clearance_joints}


def statistics(stage: StageResult, joint: str) -> JointStatistics | OutputStatistics | None:
    """Statistics of a joint, or of the output for ``""``; None where the stage failed early."""
    return stage.statistics.joints.get(joint) if joint else stage.statistics.output


def number(joint: str, name: str, factor: float = 1.0, digits: int = 3) -> Text:
    """A number of a joint, or of the output, in another unit."""
    return lambda stage: readable(scaled(_value(stage, joint, name), factor), digits)


def count(joint: str, name: str) -> Text:
    """A whole number of a joint, or of the output."""
    return lambda stage: whole(_value(stage, joint, name))


def _value(stage: StageResult, joint: str, name: str) -> float | None:
    value = getattr(statistics(stage, joint), name, None)
    return value.mean if isinstance(value, Estimate) else value


def mean(joint: str, name: str, factor: float = 1.0) -> Text:
    """A mean over cycles, in another unit, with its interval."""
    return lambda stage: estimated(getattr(statistics(stage, joint), name, None), factor)


def estimated(estimate: Estimate | None, factor: float = 1.0) -> str:
    """A number in another unit with its interval."""
    if estimate is None:
        return NOTHING
    estimate = estimate.scaled(factor)
    return with_interval(estimate.mean, estimate.half_width)


def scaled(value: float | None, factor: float) -> float | None:
    """A number in another unit, where there is one."""
    return None if value is None else factor * value
