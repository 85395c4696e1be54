"""Data frames of pandas and data sets of xarray."""

import math
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from presswear.tools.errors import not_installed

if TYPE_CHECKING:
    import pandas
    import xarray


def _module(name: str) -> Any:
    """Import pandas or xarray; InputError names it if it is missing."""
    try:
        return import_module(name)
    except ImportError:
        raise not_installed(f"a table of {name}", name) from None


def frame(
    columns: Mapping[str, Any], units: Mapping[str, str], index: str = ""
) -> "pandas.DataFrame":
    """Return columns of one length as a data frame, one of them as its index.

    ``frame.attrs["units"]`` holds the units by column.
    """
    result = _module("pandas").DataFrame(dict(columns))
    result.attrs["units"] = dict(units)
    return result.set_index(index) if index else result


def data_set(
    columns: Mapping[str, Any], units: Mapping[str, str], dimensions: Sequence[str]
) -> "xarray.Dataset":
    """Return columns as a data set over those of them that are its dimensions.

    Each variable has its unit in ``attrs["units"]``. Rows that are no full grid of the
    dimensions have the dimension ``row``, and the other columns are their coordinates.
    """
    _module("xarray")
    names = list(dimensions)
    table = frame(columns, {})
    table.attrs = {}
    is_grid = math.prod(table[name].nunique() for name in names) == len(table)
    if is_grid or len(names) == 1:
        result: xarray.Dataset = table.set_index(names).to_xarray()
    else:
        result = table.rename_axis("row").to_xarray().set_coords(names)
    for name, unit in units.items():
        result[name].attrs["units"] = unit
    return result
