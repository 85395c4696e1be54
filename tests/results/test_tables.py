"""Tables that go to other programs and come back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswear.__main__ import main
from presswear.campaign.campaign import run
from presswear.results.export import (
    compare_tables,
    life_table,
    read_table,
    strokes_table,
    unit_of,
    write_table,
)
from presswear.results.life import LifeResult
from presswear.results.result import Result, load
from presswear.scene.catalog import press_blanking, wear_times
from presswear.tools.errors import InputError


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
@pytest.mark.parametrize("rows", [1, 5])
def test_what_is_written_is_read_to_the_last_bit(suffix: str, rows: int, tmp_path: Path) -> None:
    numbers = np.array([-1e308, -0.0, 5e-324, 0.1, np.pi])
    table = {"time": np.sort(numbers), "B 2_eccentricity_x": numbers, "A_sliding": numbers[::-1]}
    table = {name: values[:rows] for name, values in table.items()}
    path = tmp_path / f"table{suffix}"
    write_table(path, table)
    again = read_table(path)
    assert list(again) == list(table)
    assert [again[name].tobytes() for name in table] == [table[name].tobytes() for name in table]


def test_numpy_reads_the_names_and_skips_the_units(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_table(path, {"time": np.array([0.0, 0.1]), "A_normal_force": np.array([1.0, 2.0])})
    assert path.read_text().splitlines()[1] == "# units: time s,A_normal_force N"
    rows = np.genfromtxt(path, delimiter=",", names=True)
    assert rows.dtype.names == ("time", "A_normal_force")
    np.testing.assert_array_equal(rows["A_normal_force"], [1.0, 2.0])
    units = {"slider_depth": "m", "rod 3_wear_volume_low": "m^3", "crank 2_angle": "rad"}
    assert {name: unit_of(name) for name in units} == units
    with pytest.raises(InputError, match="slider"):
        unit_of("slider")


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "lacks time"),
        ("time\n1\n", "beside time"),
        ("time,velocity\n", "no rows"),
        ("time,velocity,velocity\n0,1,1\n", "a column is named twice"),
        ("time,velocity\n0,1\n1\n", "columns changed from 2 to 1 at row 2"),
        ("time,velocity\n0\n1\n", "1 values in a row for 2 columns"),
        ("time,velocity\n0,1\n# note\n1,fast\n", "'fast'.* in row 2, column 2"),
        ("time,velocity\n0,1\n1,nan\n", "velocity = nan in row 2: must be finite"),
        ("time,velocity\n0,1\n2,1\n2,1\n", "time does not increase from row 2 to 3"),
    ],
)
def test_a_wrong_table_is_refused_in_one_line(text: str, word: str, tmp_path: Path) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=f"theirs.csv.*{word}") as refused:
        read_table(path)
    assert "\n" not in str(refused.value)


def test_ours_is_interpolated_at_their_times() -> None:
    time = np.linspace(0.0, 1.0, 101)
    ours = {"time": time, "displacement": np.sin(time), "velocity": np.cos(time)}
    between = np.linspace(0.005, 2.0, 333)
    theirs = {"time": between, "velocity": np.cos(between), "displacement": np.sin(between)}
    for found in compare_tables(ours, theirs, None, 1e-3):
        assert 0.0 < found.greatest < 1e-6
        assert found.passed
    theirs["displacement"] = theirs["displacement"] + 0.01
    (velocity, displacement) = compare_tables(ours, theirs, 0.5, 1e-3)
    assert velocity.passed
    assert not displacement.passed
    assert displacement.rms == pytest.approx(0.01, rel=1e-6)
    rms = np.sqrt(np.mean(np.sin(between[between <= 0.5]) ** 2))
    assert displacement.bound == pytest.approx(1e-3 * rms, rel=1e-6)
    for when, column, word in ((2.0, "velocity", "no overlap"), (0.5, "B_sliding", "B_sliding")):
        foreign = {"time": np.array([when]), column: np.zeros(1)}
        with pytest.raises(InputError, match=word):
            compare_tables(ours, foreign, None, 1e-3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One fast cycle of the in-house solver, worn once."""
    scene = wear_times(speed=60.0)
    scene = replace(scene, engine="dae", cycles=1, wear_updates=0)
    path = tmp_path_factory.mktemp("result") / "run"
    run(scene, path)
    return path


@pytest.mark.parametrize("suffix", [".csv", ".npz"])
def test_an_exported_run_agrees_with_itself(
    suffix: str, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / f"run{suffix}"
    assert main(["export", str(folder), str(file)]) == 0
    table = read_table(file)
    with np.load(folder / "stage-0.npz") as stored:
        np.testing.assert_array_equal(table["velocity"], stored["slider"][:, 1])
        np.testing.assert_array_equal(table["C_eccentricity_y"], stored["C_eccentricity"][:, 1])
        np.testing.assert_array_equal(table["A_tangential_force"], stored["A_force"][:, 1])
    assert len(table) == 19
    command = ["crosscheck", str(folder), "--against"]
    assert main([*command, str(file), "--tolerance", "1e-12"]) == 0
    assert "MISS" not in capsys.readouterr().out
    table["C_eccentricity_x"] *= 1.01
    theirs = tmp_path / f"theirs{suffix}"
    write_table(theirs, table)
    assert main([*command, str(theirs)]) == 1
    missed = [line for line in capsys.readouterr().out.splitlines() if "MISS" in line]
    assert [line.split()[0] for line in missed] == ["C_eccentricity_x"]
    assert main([*command, str(theirs), "--tolerance", "0.02"]) == 0


@pytest.mark.parametrize(
    ("file", "more", "word"),
    [
        ("run.csv", (), "exists"),
        ("run.txt", (), ".csv or .npz"),
        ("nowhere/run.csv", (), "no folder"),
        ("new.csv", ("--stage", "7"), "no stage 7"),
        ("new.csv", ("--stage", "one"), "one"),
    ],
)
def test_export_refuses_in_one_line(
    file: str,
    more: tuple[str, ...],
    word: str,
    folder: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    kept = tmp_path / "run.csv"
    kept.write_text("mine")
    assert main(["export", str(folder), str(tmp_path / file), *more]) == 2
    shown = capsys.readouterr()
    assert word in shown.err
    assert shown.err.count("\n") == 1
    assert kept.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [kept]


def test_moments_of_strokes_are_exported(folder: Path) -> None:
    scene = press_blanking(engine="dae", cycles=1, wear_updates=0, replicates=1)
    result = run(scene)
    table = strokes_table(result, 0)
    moments = ("contact", "fracture", "separation")
    assert list(table) == [f"{name}_{end}" for name in moments for end in ("time", "height")]
    process = scene.process
    assert process is not None
    assert process.fracture is not None
    assert table["contact_height"] == pytest.approx(process.height, rel=1e-6)
    broken = process.height - process.fracture
    assert table["fracture_height"] == pytest.approx(broken, rel=1e-6)
    assert np.all(table["contact_time"] < table["fracture_time"])
    with pytest.raises(InputError, match="has no strokes to write: the scene has no process"):
        strokes_table(load(folder), 0)


def test_a_life_is_exported_with_units(tmp_path: Path) -> None:
    """Every followed number with both ends of its band, as the curves have them."""
    strokes, depth = np.array([4.0, 1e6]), np.array([[1e-9, 0.0, 2e-9], [3e-5, 2e-5, 4e-5]])
    curves = {"strokes": strokes, "A.depth": depth, "bdc_drift": 10.0 * depth}
    life = LifeResult("at_most", "", 1e6, None, None, 0.9, (), (), (), (), curves)
    result = Result(press_blanking(), (), "completed", "", {}, 1.0, life=life)
    table = life_table(result)
    low, high = (f"A_depth_{end}" for end in ("low", "high"))
    assert list(table)[:4] == ["strokes", "A_depth", low, high]
    np.testing.assert_array_equal(
        np.column_stack([table["A_depth"], table[low], table[high]]), depth
    )
    assert table["bdc_drift_high"].tolist() == [2e-8, 4e-4]
    write_table(tmp_path / "life.csv", table)
    assert f"strokes 1,A_depth m,{low} m,{high} m," in (tmp_path / "life.csv").read_text()
    with pytest.raises(InputError, match="has no life to write"):
        life_table(replace(result, life=None))
