"""Stages and sweeps as data frames and data sets, and results in a notebook."""

from dataclasses import replace

import numpy as np
import pandas
import pytest

import presswear as pw

SHORT = {"cycles": 2, "wear_updates": 0, "replicates": 1, "engine": "dae"}


@pytest.fixture(scope="module")
def result():
    return pw.run(pw.scenes.clearance_c(**SHORT))


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    values = {"clearance": [0.4e-3, 0.5e-3], "C.friction": [0.0, 0.1]}
    folder = tmp_path_factory.mktemp("sweep") / "rows"
    scene = pw.scenes.clearance_c(**SHORT)
    return pw.sweep(scene, values, folder, ["C.force_max"], jobs=1)


def test_a_stage_is_a_data_frame_over_the_time(result):
    stage = result.stages[0]
    table = stage.to_pandas()
    assert table.index.name == "time"
    assert (table.index.to_numpy() == stage.time).all()
    joint = stage.joints["C"]
    assert (table["C_normal_force"].to_numpy() == joint.series("normal")).all()
    assert table.attrs["units"]["C_normal_force"] == "N"
    assert table.attrs["units"].keys() == {"time", *table.columns}


def test_a_stage_is_a_data_set_with_units(result):
    pytest.importorskip("xarray")
    data = result.stages[0].to_xarray()
    assert data["velocity"].dims == ("time",)
    assert data["velocity"].attrs["units"] == "m/s"
    assert data["time"].attrs["units"] == "s"
    assert float(data["C_normal_force"].max()) == pytest.approx(
        result.stages[0].joints["C"].series("normal").max()
    )


def test_statistics_have_a_row_for_each_stage(result):
    table = result.to_pandas()
    assert list(table.index) == ["no wear"]
    peak = result.stages[0].joints["C"].statistics.peak_force
    assert table.loc["no wear", "joints.C.peak_force"] == peak


def test_a_sweep_is_a_data_frame_and_a_grid(sweep):
    table = sweep.to_pandas()
    assert table.equals(sweep.table.to_pandas())
    assert isinstance(table, pandas.DataFrame)
    assert table.attrs["units"]["clearance"] == "m"
    assert table.attrs["units"]["C.force_max_half_width"] == "N"
    pytest.importorskip("xarray")
    data = sweep.to_xarray()
    assert data["C.force_max"].dims == ("clearance", "C.friction", "replicate")
    chosen = data["C.force_max"].sel({"clearance": 0.5e-3, "C.friction": 0.1})
    row = table[(table["clearance"] == 0.5e-3) & (table["C.friction"] == 0.1)]
    assert chosen.item() == row["C.force_max"].item()
    assert data["C.force_max"].attrs["units"] == "N"


def test_points_of_a_sample_are_rows_of_a_data_set(sweep):
    pytest.importorskip("xarray")
    points = sweep.table.points.copy()
    points[0] = 0.45e-3, 0.05  # no grid any more
    data = replace(sweep.table, points=points).to_xarray()
    assert data["C.force_max"].dims == ("row",)
    assert data["clearance"].values[0] == 0.45e-3
    assert "clearance" in data.coords


def test_texts_of_results_are_short(result, sweep):
    assert repr(result).startswith("<Result: clearance-c, changed: ")
    assert len(repr(result)) < 200
    assert len(repr(sweep)) < 400


def test_a_notebook_shows_headline_numbers_and_a_picture(result, sweep):
    html = result._repr_html_()
    assert "The press with clearance at C alone" in html
    assert "Peak joint force" in html
    assert html.count("<svg") == 1
    assert len(html) < 400_000
    assert sweep._repr_html_().count("<tr>") == 5
    assert np.isfinite(sweep.table.values).all()
