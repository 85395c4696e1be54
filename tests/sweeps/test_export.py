"""The table of a sweep as other programs read it."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas
import pytest
from made_up_sweep import swept

from presswear.sweeps.export import dataset, write_csv, write_table
from presswear.sweeps.table import Column, Table
from presswear.tools.errors import InputError

AXIS = np.array([[a, b] for a in (0.1, 0.2, 1.0 / 3.0) for b in (1.0, 0.0)])


def grid() -> Table:
    """Three values by two words, two draws each; one row failed, one is a lower bound."""
    found = swept(AXIS, AXIS[:, 0] * 10.0 + AXIS[:, 1], draws=2)
    found.values[3] = np.nan
    found.is_beyond[4] = True
    found.halves[:] = 0.5
    words = Column("engine", "", "which engine", ("dae", "exudyn"))
    reasons = tuple('it hit, "hard"' if k == 3 else "" for k in range(12))
    return replace(found, factors=(found.factors[0], words), reasons=reasons)


def test_csv_is_what_pandas_reads(tmp_path: Path) -> None:
    table = grid()
    write_table(tmp_path / "table.csv", table)
    read = pandas.read_csv(tmp_path / "table.csv", comment="#", keep_default_na=True)
    assert read["x1"].tolist() == table.points[:, 0].tolist()
    assert read["engine"].tolist() == ["exudyn", "exudyn", "dae", "dae"] * 3
    assert np.array_equal(read["y"], table.values[:, 0], equal_nan=True)
    assert read["y_is_lower_bound"].tolist() == [0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]
    assert read["reason"][3] == 'it hit, "hard"'
    assert (tmp_path / "table.csv").read_text().splitlines()[1].startswith("# units: x1 m,engine,")


def test_parquet_is_the_same_with_units(tmp_path: Path) -> None:
    import pyarrow.parquet

    table = grid()
    write_table(tmp_path / "table.parquet", table)
    write_csv(tmp_path / "table.csv", table)
    read = pandas.read_parquet(tmp_path / "table.parquet")
    text = pandas.read_csv(tmp_path / "table.csv", comment="#")
    assert list(read) == list(text)
    assert np.array_equal(read["y"], text["y"], equal_nan=True)
    assert read["engine"].tolist() == text["engine"].tolist()
    schema = pyarrow.parquet.read_schema(tmp_path / "table.parquet")
    assert schema.field("y").metadata[b"unit"] == b"N"


def test_a_grid_has_its_factors_for_dimensions() -> None:
    table = grid()
    found = dataset(table)
    assert dict(found.sizes) == {"x1": 3, "engine": 2, "draw": 2}
    assert float(found["y"].sel(x1=0.2, engine="exudyn", draw=1)) == 3.0
    assert np.isnan(found["y"].sel(x1=0.1, engine="dae", draw=1))
    assert found["y"].attrs["units"] == "N"
    mixed = np.random.default_rng(1).permutation(12)
    again = replace(
        table,
        **{name: getattr(table, name)[mixed] for name in ("points", "values", "halves", "draws")},
        is_beyond=table.is_beyond[mixed],
        reasons=tuple(table.reasons[k] for k in mixed),
    )
    assert dataset(again).identical(found)


def test_what_is_no_grid_goes_by_run() -> None:
    table = swept(np.random.default_rng(1).random((5, 2)), np.arange(5.0))
    found = dataset(table)
    assert dict(found.sizes) == {"run": 5}
    assert found["y"].to_numpy().tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert found["x1"].to_numpy().tolist() == table.points[:, 0].tolist()


@pytest.mark.parametrize(
    ("name", "told"),
    [("t.xlsx", "ends in .csv or .parquet"), ("no/t.csv", "is no folder"), ("is.csv", "exists")],
)
def test_what_cannot_be_written_is_refused(tmp_path: Path, name: str, told: str) -> None:
    (tmp_path / "is.csv").write_text("")
    with pytest.raises(InputError, match=told):
        write_table(tmp_path / name, grid())
    assert [own.name for own in tmp_path.iterdir()] == ["is.csv"]


def test_what_is_not_installed_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    monkeypatch.setitem(sys.modules, "xarray", None)
    for ask in (lambda: write_table(tmp_path / "t.parquet", grid()), lambda: dataset(grid())):
        with pytest.raises(InputError, match=r"pip install 'presswear\[sweep\]'"):
            ask()
    assert not list(tmp_path.iterdir())
