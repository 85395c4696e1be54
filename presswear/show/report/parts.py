"""What the tables of the report share."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from presswear.results.result import Result
from presswear.results.stage import StageResult

Row = tuple[str, ...]

MICRONS = 1e6
MILLI = 1e3
CUBIC_MILLIMETRES = 1e9


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
        Whether all but the first column are numbers.
    """

    head: Row
    groups: tuple[tuple[str, tuple[Row, ...]], ...]
    numeric: bool = True


def stage_names(result: Result) -> Row:
    """Column titles: the stages."""
    if not result.scene.clearance_joints:
        return ("computed",) * len(result.stages)
    return tuple(stage.name for stage in result.stages)


def by_stage(result: Result, label: str, value: Callable[[StageResult], str]) -> Row:
    """A row with one cell for each stage."""
    return (label, *map(value, result.stages))


def number_at(data: Mapping[str, Any], *path: str) -> float | None:
    """A number inside nested data; None where a stage that failed early has none."""
    found: Any = data
    for key in path:
        found = found.get(key) if isinstance(found, Mapping) else None
    return None if found is None else float(found)


def scaled(value: float | None, factor: float) -> float | None:
    """A number in another unit, where there is one."""
    return None if value is None else factor * value
