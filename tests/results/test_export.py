"""Tables for other programs, names of joints in them, and lives beside each other."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from numpy.testing import assert_array_equal
from refusals import refused

import presswear as pw
from presswear.recording.columns import CYCLE, JOINT_CYCLE
from presswear.results.export import (
    compare_tables,
    cycles_table,
    life_table,
    read_table,
    strokes_table,
    table_of,
    unit_of,
    write_table,
)
from presswear.results.life import LifeResult, life_ratio
from presswear.scene.files import read_profiles
from presswear.scene.settings import changed
from presswear.show.report import render_report


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
@pytest.mark.parametrize("rows", [1, 5])
def test_what_is_written_is_read_to_the_last_bit(suffix, rows, tmp_path):
    numbers = np.array([-1e308, -0.0, 5e-324, 0.1, np.pi])
    table = {
        "time": np.sort(numbers),
        "B 2_eccentricity_x": numbers,
        "A_sliding": numbers[::-1],
    }
    table = {name: values[:rows] for name, values in table.items()}
    path = tmp_path / f"table{suffix}"
    write_table(path, table)
    again = read_table(path)
    assert list(again) == list(table)
    assert [again[name].tobytes() for name in table] == [
        table[name].tobytes() for name in table
    ]


def test_numpy_reads_the_names_and_skips_the_units(tmp_path):
    path = tmp_path / "table.csv"
    write_table(
        path, {"time": np.array([0.0, 0.1]), "A_normal_force": np.array([1.0, 2.0])}
    )
    assert path.read_text().splitlines()[1] == "# units: time s,A_normal_force N"
    rows = np.genfromtxt(path, delimiter=",", names=True)
    assert rows.dtype.names == ("time", "A_normal_force")
    assert_array_equal(rows["A_normal_force"], [1.0, 2.0])
    units = {
        "slider_depth": "m",
        "rod 3_wear_volume_low": "m^3",
        "crank 2_angle": "rad",
    }
    assert {name: unit_of(name) for name in units} == units
    with refused("slider"):
        unit_of("slider")


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "lacks time"),
        ("time\n1\n", "besides time"),
        ("time,velocity\n", "no rows"),
        ("time,velocity,velocity\n0,1,1\n", "a column is named twice"),
        ("time,velocity\n0,1\n1\n", "columns changed from 2 to 1 at row 2"),
        ("time,velocity\n0\n1\n", "1 values in a row for 2 columns"),
        ("time,velocity\n0,1\n# note\n1,fast\n", "'fast'.* in row 2, column 2"),
        ("time,velocity\n0,1\n1,nan\n", "velocity = nan in row 2: must be finite"),
        ("time,velocity\n0,1\n2,1\n2,1\n", "time does not increase from row 2 to 3"),
    ],
)
def test_a_wrong_table_is_refused_in_one_line(text, word, tmp_path):
    path = tmp_path / "theirs.csv"
    path.write_text(text)
    with refused(f"theirs.csv.*{word}"):
        read_table(path)


def test_ours_is_interpolated_at_their_times():
    time = np.linspace(0.0, 1.0, 101)
    ours = {"time": time, "displacement": np.sin(time), "velocity": np.cos(time)}
    between = np.linspace(0.005, 2.0, 333)
    theirs = {
        "time": between,
        "velocity": np.cos(between),
        "displacement": np.sin(between),
    }
    for found in compare_tables(ours, theirs, None, 1e-3):
        assert 0.0 < found.greatest < 1e-6
        assert found.passed
    theirs["displacement"] = theirs["displacement"] + 0.01
    velocity, displacement = compare_tables(ours, theirs, 0.5, 1e-3)
    assert velocity.passed
    assert not displacement.passed
    assert displacement.rms == pytest.approx(0.01, rel=1e-6)
    rms = np.sqrt(np.mean(np.sin(between[between <= 0.5]) ** 2))
    assert displacement.bound == pytest.approx(1e-3 * rms, rel=1e-6)
    for when, column, word in (
        (2.0, "velocity", "no overlap"),
        (0.5, "B_sliding", "B_sliding"),
    ):
        foreign = {"time": np.array([when]), column: np.zeros(1)}
        with refused(word):
            compare_tables(ours, foreign, None, 1e-3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One fast cycle of the in-house solver, worn once."""
    scene = pw.scenes.wear_times(speed=60.0)
    scene = replace(scene, engine="dae", cycles=1, wear_updates=0)
    path = tmp_path_factory.mktemp("result") / "run"
    pw.run(scene, path)
    return path


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_an_exported_run_agrees_with_itself(suffix, folder, tmp_path, command):
    file = tmp_path / f"run{suffix}"
    theirs = tmp_path / f"theirs{suffix}"
    command(f"export {folder} {file}")
    table = read_table(file)
    with np.load(folder / "stage-0.npz") as stored:
        assert_array_equal(table["velocity"], stored["slider"][:, 1])
        assert_array_equal(table["C_eccentricity_y"], stored["C_eccentricity"][:, 1])
        assert_array_equal(table["A_tangential_force"], stored["A_force"][:, 1])
    assert len(table) == 21
    assert "MISS" not in command(
        f"crosscheck {folder} --against {file} --tolerance 1e-12"
    )
    table["C_eccentricity_x"] *= 1.01
    write_table(theirs, table)
    shown = command(f"crosscheck {folder} --against {theirs}", 1)
    missed = [line for line in shown.splitlines() if "MISS" in line]
    assert [line.split()[0] for line in missed] == ["C_eccentricity_x"]
    command(f"crosscheck {folder} --against {theirs} --tolerance 0.02")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("run.csv", "exists"),
        ("run.txt", ".csv or .npz or .mat"),
        ("new.csv --stage 7", "no stage 7"),
    ],
)
def test_export_refuses_in_one_line(words, message, folder, tmp_path, command):
    kept = tmp_path / "run.csv"
    kept.write_text("mine")
    assert message in command(f"export {folder} {tmp_path}/{words}", 2)
    assert kept.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [kept]


def test_moments_of_strokes_are_exported(folder):
    scene = pw.scenes.press_blanking(
        engine="dae", cycles=1, wear_updates=0, replicates=1
    )
    result = pw.run(scene)
    table = strokes_table(result, 0)
    moments = ("contact", "fracture", "separation")
    assert list(table) == [
        f"{name}_{end}" for name in moments for end in ("time", "height")
    ]
    process = scene.process
    assert table["contact_height"] == pytest.approx(process.height, rel=1e-6)
    broken = process.height - process.fracture
    assert table["fracture_height"] == pytest.approx(broken, rel=1e-6)
    assert np.all(table["contact_time"] < table["fracture_time"])
    with refused("has no strokes to write: the scene has no process"):
        strokes_table(pw.load(folder), 0)


def test_numbers_of_each_cycle_are_exported_with_units(folder):
    stage = pw.load(folder).stages[0]
    table = cycles_table(pw.load(folder), 0)
    assert len(table) == 1 + len(CYCLE) + len(JOINT_CYCLE) * len(stage.joints)
    for name, joint in stage.joints.items():
        for column in JOINT_CYCLE:
            assert unit_of(f"{name}_{column.name}") == column.unit
            values = table[f"{name}_{column.name}"]
            assert_array_equal(values, joint.each_cycle(column.name))
    assert_array_equal(table["steps"], stage.each_cycle("steps"))
    assert_array_equal(table["replicate"], stage.arrays["cycle_start"])


def test_a_life_is_exported_with_units(tmp_path):
    """Every followed number with both ends of its band, as the curves have them."""
    strokes = np.array([4.0, 1e6])
    depth = np.array([[1e-9, 0.0, 2e-9], [3e-5, 2e-5, 4e-5]])
    curves = {"strokes": strokes, "A.depth": depth, "bdc_drift": 10.0 * depth}
    life = LifeResult("at_most", "", 1e6, None, None, 0.9, (), (), (), (), curves)
    result = pw.Result(
        pw.scenes.press_blanking(), (), "completed", "", {}, 1.0, life=life
    )
    table = life_table(result)
    low, high = (f"A_depth_{end}" for end in ("low", "high"))
    assert list(table)[:4] == ["strokes", "A_depth", low, high]
    columns = [table["A_depth"], table[low], table[high]]
    assert_array_equal(np.transpose(columns), depth)
    assert table["bdc_drift_high"].tolist() == [2e-8, 4e-4]
    write_table(tmp_path / "life.csv", table)
    assert (
        f"strokes 1,A_depth m,{low} m,{high} m," in (tmp_path / "life.csv").read_text()
    )
    with refused("has no life to write"):
        life_table(replace(result, life=None))


def named(*names: str) -> pw.linkage.Linkage:
    kept = FOUR_BAR.joints[: -len(names)]
    last = FOUR_BAR.joints[-len(names) :]
    renamed = [
        replace(joint, name=name) for joint, name in zip(last, names, strict=True)
    ]
    return FOUR_BAR.changed(joints=(*kept, *renamed))


@pytest.mark.parametrize("name", ["all", "Bolzen Ø 20", "2", "depth_pin", "time"])
def test_names_are_carried_to_the_table(name, tmp_path):
    settings = {
        "engine": "dae",
        "integration_tolerance": "1e-6",
        "cycles": "1",
        "replicates": "1",
    }
    mechanism = named(name, "P")
    scene = changed(
        pw.Scene(mechanism=mechanism, joints=name, wear_updates=0), settings
    )
    out = tmp_path / "out"
    pw.run(scene, out)
    assert set(pw.load(out).stages[0].joints) == {name}
    assert name in render_report(pw.load(out))
    write_table(tmp_path / "table.csv", table_of(pw.load(out), 0))
    with (tmp_path / "table.csv").open() as opened:
        header = next(csv.reader(line for line in opened if not line.startswith("#")))
    assert f"{name}_penetration" in header


@pytest.mark.parametrize("name", ["", " pin", "a/b", "a.b", "a,b", "a\nb", "none"])
def test_a_name_that_files_or_lists_cannot_hold_is_refused(name):
    with refused("name"):
        named(name)


def test_two_joints_whose_arrays_could_be_mixed_up_are_refused():
    with refused("must not begin with B_, because B is a joint too"):
        named("B", "B_force")


LIFE = LifeResult("limit", "", 1e6, 0.04, 0.0, 0.9, (), (), ())


def test_half_a_standard_deviation_has_the_probability_of_the_normal_distribution():
    half = 0.1
    exact = replace(LIFE, sampling=0.0)
    beside = replace(LIFE, strokes=1e6 * math.exp(0.5 * half / 1.959964), sampling=half)
    assert float(life_ratio(beside, exact)[1]) == pytest.approx(0.691462, abs=0.005)


def test_a_life_without_limit_or_interval_is_not_compared():
    for other in (replace(LIFE, ended="at_most"), replace(LIFE, sampling=None)):
        assert life_ratio(LIFE, other) == ("", "")


def test_a_table_with_semicolons_is_read(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("time;height\n0;1\n0.5;2\n")
    assert {name: list(row) for name, row in read_table(file).items()} == {
        "time": [0.0, 0.5],
        "height": [1.0, 2.0],
    }
    profiles = tmp_path / "b.csv"
    profiles.write_text("# measured\njoint;side;angle (deg);depth (um)\nA;pin;90;2\n")
    assert read_profiles(profiles)["A"][1] == pytest.approx(
        np.array([[np.pi / 2, 2e-6]])
    )
