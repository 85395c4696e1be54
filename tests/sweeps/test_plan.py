"""Plans, their parameters from texts and Python values, distributions, designs and tables."""

import csv
import io
import itertools
import math
from dataclasses import replace

import numpy as np
import pandas
import pytest
from made_up_sweep import table_of
from refusals import refused
from scipy import stats

import presswear as pw
from presswear.sweeps.parameters import (
    design,
    parse_distribution,
    parse_group,
    texts_of,
)
from presswear.sweeps.plan import Plan
from presswear.sweeps.sweep import export_table
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import plain

SCENE = pw.scenes.wear_times(engine="dae", wear_updates=0, cycles=1)
VARY = (
    "clearance=0.2mm,0.4mm",
    "A.friction=0.1,0.2 & C.friction=0.3,0.4",
    "engine=dae,exudyn",
)


def test_all_values_are_combined():
    plan = Plan(SCENE, VARY, replicates=2)
    assert (len(plan.points), plan.rows) == (8, 16)
    pairs = itertools.product((2e-4, 4e-4), ((0.1, 0.3), (0.2, 0.4)), (0.0, 1.0))
    assert plan.points.tolist() == [[c, *both, e] for c, both, e in pairs]
    scene = plan.scene_of(plan.rows - 1)
    values = (
        scene.bearing("A").clearance,
        *(scene.bearing(joint).friction for joint in "AC"),
    )
    assert values == (4e-4, 0.2, 0.4)
    assert (scene.engine, scene.seed) == ("exudyn", SCENE.seed + 1)


def test_equal_rows_of_two_plans_have_one_identity():
    plan = Plan(SCENE, ("clearance=0.2mm,0.4mm",), replicates=2)
    assert len({plan.identity(row) for row in range(4)}) == 4
    wider = Plan(
        SCENE, ("clearance=0.1mm,0.4mm", f"friction={SCENE.bearing('A').friction},0.3")
    )
    assert wider.identity(2) == plan.identity(2)
    assert replace(wider.scene_of(2), origins={}) == replace(
        plan.scene_of(2), origins={}
    )


def test_plans_are_stored_as_plain_data():
    plan = Plan(
        SCENE,
        ("clearance=0.2mm,0.4mm",),
        "latin:5",
        ("friction=uniform(0, 0.1)",),
        2,
        3,
    )
    again = Plan.from_plain(plain(plan))
    assert again == plan
    assert [again.identity(row) for row in range(20)] == [
        plan.identity(row) for row in range(20)
    ]


def test_one_impossible_point_does_not_refuse_the_others():
    plan = Plan(SCENE, ("length_3=0.1m,0.2m",))
    with refused("assembled"):
        plan.scene_of(0).check()
    assert plan.example == plan.scene_of(1)


def test_tables_are_written_for_other_programs(tmp_path):
    grid = np.array([[x, y] for x in (1.0, 2.0, 3.0) for y in (0.1, 0.2)])
    censored = np.arange(6) == 4
    table = table_of(
        grid, np.array([1.0, 2.0, np.nan, 4.0, 5.0, 1 / 3]), 2, censored=censored
    )
    rows = list(csv.DictReader(io.StringIO(table.csv().replace("# units", "units"))))
    assert rows[0]["y"] == "y N"
    assert [row["y"] for row in rows[1::2]][2] == ""
    assert float(rows[-1]["y"]) == 1 / 3
    assert [int(row["y_is_lower_bound"]) for row in rows[1::2]] == list(censored)
    for file in ("a.csv", "a.parquet"):
        export_table(table, tmp_path / file)
    read = pandas.read_parquet(tmp_path / "a.parquet")
    assert np.array_equal(read["y"], table.values[:, 0], equal_nan=True)
    assert np.array_equal(
        pandas.read_csv(tmp_path / "a.csv", comment="#")["x2"], read["x2"]
    )
    bad = {"a.csv": "exists", "a.xls": ".csv or .parquet", "n/a.csv": "no folder"}
    for name, message in bad.items():
        with refused(message):
            export_table(table, tmp_path / name)


LENGTH = Quantity("m", 0.0, 1.0, "", "")
PURE = Quantity("", 0.0, 1.0, "", "", open_low=True)
PRESSURE = Quantity("1/Pa", 0.0, math.inf, "", "")
POSITIVE = Quantity("", 0.0, math.inf, "", "")
U = np.linspace(0.01, 0.99, 99)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("clearance=0.2mm:1.0mm:5", [[2e-4], [4e-4], [6e-4], [8e-4], [1e-3]]),
        ("wear_coefficient=1e-16/Pa:1e-14/Pa:3:log", [[1e-16], [1e-15], [1e-14]]),
        ("engine=dae,exudyn", [[0.0], [1.0]]),
        ("A.friction=0.1,0.2 & C.friction=0.1,0.3", [[0.1, 0.1], [0.2, 0.3]]),
    ],
)
def test_text_gives_values(text, values):
    assert parse_group(SCENE, text).values.tolist() == values


def test_python_values_equal_texts():
    vary = {
        "clearance": np.array([1e-4, 2.5e-4]),
        "A.friction & C.friction": [(0.1, 0.2), (0.3, 0.4)],
        "engine": ["dae", "exudyn"],
        "cycles": [2, 3],
        "friction": "0:0.1:3",
    }
    groups = [parse_group(SCENE, text) for text in texts_of(SCENE, vary)]
    expected = [
        [1e-4, 2.5e-4],
        [[0.1, 0.2], [0.3, 0.4]],
        [0.0, 1.0],
        [2.0, 3.0],
        [0.0, 0.05, 0.1],
    ]
    assert [group.values.squeeze().tolist() for group in groups] == expected
    assert [repr(groups[k].columns[0].setting(1.0)) for k in (0, 2, 3)] == [
        "1.0",
        "'exudyn'",
        "1",
    ]
    wrong: list[object] = [[], 3, [None], [math.nan], [True], {"a": 1}]
    for values in wrong:
        with refused("friction"):
            texts_of(SCENE, {"friction": values})


@pytest.mark.parametrize(
    ("text", "meaning", "reference"),
    [
        ("0.2mm:1mm", LENGTH, stats.uniform(0.2e-3, 0.8e-3)),
        ("uniform( 200um,0.1cm )", LENGTH, stats.uniform(0.2e-3, 0.8e-3)),
        ("normal(0.8mm, 0.05mm)", LENGTH, stats.norm(0.8e-3, 0.05e-3)),
        ("normal(0.5, 0.2)", PURE, stats.truncnorm(-2.5, 2.5, loc=0.5, scale=0.2)),
        (
            "lognormal(1e-15/Pa, x1.6)",
            PRESSURE,
            stats.lognorm(math.log(1.6), scale=1e-15),
        ),
        (
            "lognormal(0.1, 50%)",
            POSITIVE,
            stats.lognorm(math.log(1.25) ** 0.5, scale=0.1),
        ),
    ],
)
def test_quantiles(text, meaning, reference):
    quantiles = parse_distribution(text, "key", meaning).ppf(U)
    assert quantiles == pytest.approx(reference.ppf(U), rel=1e-9, abs=0)
    if "%" in text:
        assert reference.std() / reference.mean() == pytest.approx(0.5, rel=1e-12)


def test_values_of_a_file_have_weights(tmp_path):
    file = tmp_path / "measured.csv"
    file.write_text("# bushings\n0.4mm, 1\n\n0.2mm, 3\n")
    draws = parse_distribution(f"table({file})", "key", LENGTH).ppf(
        (np.arange(400) + 0.5) / 400
    )
    assert [np.count_nonzero(draws == value) for value in (0.2e-3, 0.4e-3)] == [
        300,
        100,
    ]
    for lines, message in (
        ("0.2mm\nred\n", "line 2: key = 'red'"),
        ("0.2mm,-1\n0.3mm\n", "line 1: weight"),
        ("0.2mm,0\n0.3mm,0", "at least two values and a positive weight"),
    ):
        file.write_text(lines)
        with refused(message):
            parse_distribution(f"table({file})", "key", LENGTH)


def test_designs_are_reproducible_and_balanced():
    rows = {"sobol": 16, "latin": 16, "saltelli": 80, "morris": 64, "oat": 97}
    for kind, count in rows.items():
        points = design(kind, 16, 3, seed=3)
        assert points.shape == (count, 3)
        assert np.array_equal(points, design(kind, 16, 3, seed=3))
        assert kind == "oat" or not np.array_equal(points, design(kind, 16, 3, seed=4))
    for kind in ("sobol", "latin"):  # one point in each sixteenth of every range
        places = np.sort((16.0 * design(kind, 16, 3, seed=1)).astype(int), axis=0)
        assert np.array_equal(places, np.repeat(np.arange(16)[:, None], 3, axis=1))
    blocks = design("saltelli", 8, 3, seed=1).reshape(8, 5, 3)
    for k in range(3):
        others = np.delete(np.arange(3), k)
        assert np.array_equal(blocks[:, k + 1, k], blocks[:, -1, k])
        assert np.array_equal(blocks[:, k + 1, others], blocks[:, 0, others])
