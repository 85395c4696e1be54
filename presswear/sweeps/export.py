"""The table of a sweep for other programs: CSV, parquet and xarray.

A column for each factor, ``draw``, for each measure its value, ``MEASURE_half_width`` of its 95 %
interval and ``MEASURE_is_lower_bound``, and ``reason``, why a run has no values.  SI units; what is
not there is empty.
"""

import csv
import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from presswear.sweeps.table import Column, Table
from presswear.tools.errors import InputError, not_installed
from presswear.tools.files import write_whole
from presswear.tools.folders import check_name

if TYPE_CHECKING:
    import pyarrow
    import xarray

Values = NDArray[np.float64] | NDArray[np.int64] | NDArray[np.bool_] | NDArray[np.str_]


@dataclass(frozen=True)
class _Series:
    """A column for other programs: its name, unit, text and values, shape (n,)."""

    name: str
    unit: str
    text: str
    values: Values


def _series(table: Table) -> Iterator[_Series]:
    for place, factor in enumerate(table.factors):
        yield _Series(factor.key, factor.unit, factor.text, _worded(factor, table.points[:, place]))
    yield _Series("draw", "", "which of the runs at its point", table.draws)
    for place, own in enumerate(table.measures):
        yield _Series(own.key, own.unit, own.text, _worded(own, table.values[:, place]))
        half, is_bound = table.halves[:, place], table.is_beyond[:, place]
        yield _Series(f"{own.key}_half_width", own.unit, "of its 95 % interval", half)
        yield _Series(f"{own.key}_is_lower_bound", "", "the value may be any above it", is_bound)
    yield _Series("reason", "", "why there are no values", np.array(table.reasons, np.str_))


def _worded(column: Column, values: NDArray[np.float64]) -> Values:
    """Values as they are, or the words that they stand for."""
    if not column.words:
        return values
    known = np.isfinite(values)
    words = np.array([*column.words, ""], np.str_)
    return words[np.where(known, values, len(column.words)).astype(np.int64)]


def write_table(path: Path, table: Table) -> None:
    """Write a table as ``.csv`` or ``.parquet``.

    InputError for another ending, a file that exists, or a folder that does not.
    """
    kind = path.suffix.lower()
    if kind not in _WRITERS:
        raise InputError(f"{path}: a name that ends in {' or '.join(_WRITERS)} is expected")
    check_name(path)
    if path.exists():
        raise InputError(f"{path} exists; name a new file")
    if not path.parent.is_dir():
        raise InputError(f"{path.parent} is no folder")
    _WRITERS[kind](path, table)


def write_csv(path: Path, table: Table) -> None:
    """Write a table as CSV, whatever is there; a line of comment holds the units."""
    columns = list(_series(table))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([own.name for own in columns])
    text.write(f"# units: {','.join(f'{own.name} {own.unit}'.rstrip() for own in columns)}\n")
    writer.writerows(zip(*(map(_cell, own.values.tolist()) for own in columns), strict=True))
    write_whole(path, lambda file: file.write(text.getvalue().encode()))


def _cell(value: float | int | bool | str) -> str:
    """A value as the shortest text that is read back as the same; nothing for no number."""
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(value)
    return str(int(value)) if isinstance(value, bool) else str(value)


def _write_parquet(path: Path, table: Table) -> None:
    try:
        import pyarrow.parquet
    except ImportError:
        raise not_installed(f"{path}: parquet", "pyarrow", "sweep") from None
    found = arrow(table)
    write_whole(path, lambda file: pyarrow.parquet.write_table(found, file))


def arrow(table: Table) -> "pyarrow.Table":
    """The table of pyarrow, each column with its unit and text; what is not there is null."""
    import pyarrow

    arrays, fields = [], []
    for own in _series(table):
        values = pyarrow.array(own.values, from_pandas=True)
        told = {"unit": own.unit, "text": own.text}
        arrays.append(values)
        fields.append(pyarrow.field(own.name, values.type, metadata=told))
    return pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields))


def dataset(table: Table) -> "xarray.Dataset":
    """The measures over their factors and draws, where the points are a whole grid; else by run.

    InputError where xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise not_installed("a dataset", "xarray", "sweep") from None

    columns = list(_series(table))
    factors = columns[: len(table.factors) + 1]
    axes, places = zip(
        *(np.unique(own.values, return_inverse=True) for own in factors), strict=True
    )
    shape = tuple(len(axis) for axis in axes)
    flat = np.ravel_multi_index(places, shape)
    is_grid = len(flat) == np.prod(shape) and len(np.unique(flat)) == len(flat)
    order = np.argsort(flat) if is_grid else np.arange(len(flat))
    names = tuple(own.name for own in factors) if is_grid else ("run",)
    size = shape if is_grid else (len(flat),)
    rest = {
        own.name: (names, own.values[order].reshape(size), _attributes(own))
        for own in columns[len(factors) :]
    }
    beside = {
        own.name: (
            (own.name,) if is_grid else names,
            axis if is_grid else own.values,
            _attributes(own),
        )
        for own, axis in zip(factors, axes, strict=True)
    }
    return xarray.Dataset(rest, beside)


def _attributes(own: _Series) -> dict[str, str]:
    return {"units": own.unit, "long_name": own.text}


_WRITERS: dict[str, Callable[[Path, Table], None]] = {
    ".csv": write_csv,
    ".parquet": _write_parquet,
}
