"""A table of a sweep as text."""

import math
from pathlib import Path

from presswear.sweeps.table import NOT_RUN, Table


def lines_of(table: Table, count: int) -> list[list[str]]:
    """The names of the columns of a table with their units, then its first rows.

    A lower bound has its sign, nothing measured is a dash.
    """
    from presswear.sweeps.figures.scales import Scale  # slow to import

    columns = []
    for column, values in zip(table.factors, table.points.T, strict=True):
        scale = Scale.of(column, values)
        columns.append([scale.label, *(scale.number(value, 4) for value in values[:count])])
    measured = zip(table.measures, table.values.T, table.halves.T, table.is_beyond.T, strict=True)
    for column, *found in measured:
        scale = Scale.of(column, found[0])
        told = []
        for value, half, beyond in zip(*(own[:count] for own in found), strict=True):
            sign = ">" if beyond else ""
            width = "" if math.isnan(half) else f" ± {scale.number(half, 2)}"
            told.append(f"{sign}{scale.number(value, 4)}{width}")
        columns.append([scale.label, *told])
    return [list(line) for line in zip(*columns, strict=True)]


def counts_of(table: Table, path: Path) -> str:
    """How many rows there are and how many have no values, with the first reason."""
    reasons = [own for own in table.reasons if own and own != NOT_RUN]
    told, waiting = f"{len(table.reasons)} rows in {path}", table.reasons.count(NOT_RUN)
    if waiting:
        told += f", {waiting} not run yet"
    if reasons:
        told += f"; {len(reasons)} without values, the first: {reasons[0]}"
    return told
