"""A table of a sweep as text."""

import math
from pathlib import Path

from presswear.sweeps.table import Table
from presswear.tools.numbers import readable


def heads_of(table: Table) -> list[str]:
    """Names of the columns of a table, with their units."""
    columns = (*table.factors, *table.measures)
    return [f"{own.key} ({own.unit})" if own.unit else own.key for own in columns]


def cells_of(table: Table, row: int) -> list[str]:
    """A row of a table as text; a lower bound with its sign, nothing measured as a dash."""
    found = []
    for column, value in zip(table.factors, table.points[row], strict=True):
        found.append(column.words[int(value)] if column.words else readable(value, 4))
    for value, half, beyond in zip(
        table.values[row], table.halves[row], table.is_beyond[row], strict=True
    ):
        told = readable(value, 4)
        if beyond:
            told = f">{told}"
        found.append(told if math.isnan(half) else f"{told} ± {readable(half, 2)}")
    return found


def counts_of(table: Table, path: Path) -> str:
    """How many rows there are and how many have no values, with the first reason."""
    reasons = [own for own in table.reasons if own]
    told = f"{len(table.reasons)} rows in {path}"
    if reasons:
        told += f"; {len(reasons)} without values, the first: {reasons[0]}"
    return told
