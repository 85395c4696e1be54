"""Plans: the scene of each row, and the table of the rows for other programs."""

import csv
import io
import itertools
from pathlib import Path

import numpy as np
import pandas
import pytest
from made_up_sweep import table_of

import presswear as pw
from presswear.sweeps.plan import Plan, scene_digest
from presswear.sweeps.sweep import export_table
from presswear.tools.errors import InputError
from presswear.tools.serialize import plain

SCENE = pw.scenes.wear_times(engine="dae", wear_updates=0, cycles=1)
VARY = ("clearance=0.2mm,0.4mm", "A.friction=0.1,0.2 & C.friction=0.3,0.4", "engine=dae,exudyn")


def test_all_values_are_combined() -> None:
    plan = Plan(SCENE, VARY, replicates=3)
    assert (len(plan.points), plan.rows) == (8, 24)
    pairs = itertools.product((2e-4, 4e-4), ((0.1, 0.3), (0.2, 0.4)), (0.0, 1.0))
    assert plan.points.tolist() == [[c, *both, e] for c, both, e in pairs]


def test_a_row_is_the_scene_with_its_values() -> None:
    plan = Plan(SCENE, VARY, replicates=2)
    scene = plan.scene_of(plan.rows - 1)
    values = (scene.bearing("A").clearance, *(scene.bearing(joint).friction for joint in "AC"))
    assert values == (4e-4, 0.2, 0.4)
    assert (scene.engine, scene.seed) == ("exudyn", SCENE.seed + 1)


def test_a_sample_has_the_quantiles_of_its_distributions() -> None:
    ranges = ("clearance=0.2mm:1mm", "friction=normal(0.05, 0.01)")
    plan = Plan(SCENE, ("engine=dae,exudyn",), "sobol:64", ranges)
    assert plan.rows == 128
    points = plan.points[::2]
    # A scrambled Sobol' sequence of 64 has one point in each 64th of a range.
    places = np.sort((points[:, 0] - 2e-4) / 8e-4 * 64.0).astype(int)
    assert places.tolist() == list(range(64))
    assert np.mean(points[:, 1]) == pytest.approx(0.05, abs=5e-4)
    assert np.std(points[:, 1]) == pytest.approx(0.01, abs=1e-3)


def test_equal_rows_of_two_plans_have_one_identity() -> None:
    plan = Plan(SCENE, ("clearance=0.2mm,0.4mm",), replicates=2)
    assert len({plan.identity(row) for row in range(4)}) == 4
    wider = Plan(SCENE, ("clearance=0.1mm,0.4mm", f"friction={SCENE.bearing('A').friction},0.3"))
    assert wider.identity(2) == plan.identity(2)
    assert scene_digest(wider.scene_of(2)) == scene_digest(plan.scene_of(2))


def test_plans_are_stored_as_plain_data() -> None:
    plan = Plan(SCENE, ("clearance=0.2mm,0.4mm",), "latin:5", ("friction=uniform(0, 0.1)",), 2, 3)
    again = Plan.from_dict(plain(plan.as_dict()))
    assert again == plan
    assert [again.identity(row) for row in range(20)] == [plan.identity(row) for row in range(20)]


def test_one_impossible_point_does_not_refuse_the_others() -> None:
    plan = Plan(SCENE, ("length_3=0.1m,0.2m",))
    with pytest.raises(InputError, match="assembled"):
        plan.scene_of(0)
    assert plan.example == plan.scene_of(1)


def test_tables_are_written_for_other_programs(tmp_path: Path) -> None:
    grid = np.array([[x, y] for x in (1.0, 2.0, 3.0) for y in (0.1, 0.2)])
    censored = np.arange(6) == 4
    table = table_of(grid, np.array([1.0, 2.0, np.nan, 4.0, 5.0, 1 / 3]), 2, censored=censored)
    rows = list(csv.DictReader(io.StringIO(table.csv().replace("# units", "units"))))
    assert rows[0]["y"] == "y N"
    assert [row["y"] for row in rows[1::2]][2] == ""
    assert float(rows[-1]["y"]) == 1 / 3
    assert [int(row["y_is_lower_bound"]) for row in rows[1::2]] == list(censored)
    for file in ("a.csv", "a.parquet"):
        export_table(table, tmp_path / file)
    read = pandas.read_parquet(tmp_path / "a.parquet")
    assert np.array_equal(read["y"], table.values[:, 0], equal_nan=True)
    assert np.array_equal(pandas.read_csv(tmp_path / "a.csv", comment="#")["x2"], read["x2"])
    for name, message in (("a.csv", "exists"), ("a.xls", ".csv or .parquet"), ("n/a.csv", "n is")):
        with pytest.raises(InputError, match=message):
            export_table(table, tmp_path / name)
