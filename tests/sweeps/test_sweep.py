"""Sweeps of scenes, from a script and from the command line."""

import csv
import io
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import presswear as pw
from presswear.__main__ import main
from presswear.cli import sweep as command
from presswear.results.provenance import program_digest
from presswear.sweeps import sweep as sweeps
from presswear.sweeps import work as works
from presswear.sweeps.measures import measures_asked
from presswear.sweeps.plan import Plan
from presswear.sweeps.sweep import load_sweep
from presswear.sweeps.table import Column, Table
from presswear.sweeps.work import SceneWork
from presswear.tools.errors import InputError
from presswear.tools.folders import FolderLock

QUICK = {
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": 1e-6,
    "wear_updates": 0,
    "cycles": 1,
    "replicates": 1,
}
SCENE = pw.scenes.wear_times(**QUICK)
OPTIONS = [word for key, value in QUICK.items() for word in ("--set", f"{key}={value}")]
VARY = ["--vary", "clearance=0.4mm,0.6mm", "--measure", "A.force_max,bdc_error"]


def test_a_row_holds_what_a_run_of_its_scene_gives(tmp_path: Path) -> None:
    found = pw.sweep(
        SCENE,
        {"clearance": [4e-4, 6e-4], "A.friction": "0.02,0.05"},
        tmp_path / "sweep",
        ["A.force_max", "bdc_error"],
        draws=2,
        jobs=1,
    )
    table = found.table
    assert [own.key for own in (*table.factors, *table.measures)] == [
        "clearance",
        "A.friction",
        "A.force_max",
        "bdc_error",
    ]
    assert table.points[::2].tolist() == [[4e-4, 0.02], [4e-4, 0.05], [6e-4, 0.02], [6e-4, 0.05]]
    assert table.draws.tolist() == [0, 1] * 4
    assert set(table.reasons) == {""}
    settings = {**QUICK, "clearance": 6e-4, "A.friction": 0.02, "seed": 1}
    alone = pw.run(pw.scenes.wear_times(**settings), jobs=1).stages[0]
    peak = alone.joints["A"].statistics.peak_force_per_cycle.mean
    assert table.values[5].tolist() == [peak, alone.bdc.error.mean]
    assert np.isnan(table.halves).all()  # one cycle tells no interval
    # Two runs at one point differ, for their seeds do.
    assert table.values[4, 0] != table.values[5, 0]
    assert "8 rows in" in str(found)
    again = load_sweep(tmp_path / "sweep").table
    assert np.array_equal(again.values, table.values)
    # Another measure of the same runs needs no run.
    records = list((tmp_path / "sweep" / "records").glob("*/*.jsonl"))
    more = pw.sweep(SCENE, {"clearance": [4e-4]}, tmp_path / "sweep", ["C.force_max"], jobs=1)
    assert math.isfinite(more.table.values[0, 0])
    assert len(records) == 1


def test_numbers_are_the_same_wherever_rows_run(tmp_path: Path) -> None:
    varied = {"clearance": [4e-4, 6e-4], "cycles": [4]}
    places = {"alone": 1, "": 2, "dask": 2, "concurrent.futures:ProcessPoolExecutor": 2}
    tables = [
        pw.sweep(SCENE, varied, tmp_path / f"{k}", on=on.removeprefix("alone"), jobs=jobs).table
        for k, (on, jobs) in enumerate(places.items())
    ]
    assert np.isfinite(tables[0].values[:, 0]).all()
    for table in tables[1:]:
        assert np.array_equal(table.values, tables[0].values, equal_nan=True)
        assert np.array_equal(table.halves, tables[0].halves, equal_nan=True)


def test_a_run_that_fails_is_a_row_with_its_reason(tmp_path: Path) -> None:
    varied = {"integrator": ["dopri5", "rk4-paper"]}
    found = pw.sweep(SCENE, varied, tmp_path / "sweep", ["A.force_max"], jobs=1)
    table = found.table
    assert table.reasons[0] == ""
    assert "no longer finite" in table.reasons[1]
    assert np.isnan(table.values[1]).all()
    assert math.isfinite(table.values[0, 0])
    assert "1 without values, the first: " in str(found)


def test_whole_results_are_kept_where_that_is_asked(tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    few = {"clearance": [4e-4]}
    numbers = pw.sweep(SCENE, few, folder, ["A.force_max"], jobs=1).table
    assert not (folder / "runs").exists()
    whole = pw.sweep(SCENE, few, folder, ["A.force_max"], jobs=1, keep="all").table
    (run,) = (folder / "runs").iterdir()
    told = pw.load(run).stages[0].joints["A"].statistics.peak_force_per_cycle.mean
    assert whole.values.tolist() == numbers.values.tolist() == [[told]]


def test_a_run_that_outlived_its_submitter_is_waited_for(tmp_path: Path) -> None:
    plan = Plan(SCENE, ("clearance=0.4mm",))
    work = SceneWork(plan, measures_asked(SCENE, ["A.force_max"]), program_digest(), tmp_path)
    _, job = work.job(0)
    assert job.folder is not None
    lock = FolderLock(job.folder)
    told: list[float] = []

    def report(done: float, word: str = "", rows: object = None) -> None:
        told.append(done)
        if len(told) == 3:
            lock.release()

    assert job(report).reason == ""
    assert told[:3] == [0.0, 0.0, 0.0]


def first_force(result: pw.Result) -> float:
    """Force at the first row."""
    return float(result.stages[0].joints["A"].force[0, 0])


def test_a_measure_of_ones_own_goes_to_the_processes(tmp_path: Path) -> None:
    found = pw.sweep(SCENE, {"clearance": [4e-4, 6e-4]}, tmp_path / "sweep", [first_force], jobs=2)
    assert np.isfinite(found.table.values).all()
    with pytest.raises(InputError, match="the script that gave them goes on with it"):
        sweeps.begun(load_sweep(tmp_path / "sweep"), resume=True)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--vary", "clearence=1mm"], "did you mean clearance"),
        (["--vary", "clearance="], "KEY=VALUES is expected"),
        (["--vary", "clearance=1mm", "--measure", "A.forcemax"], "did you mean A.force_max"),
        (["--vary", "clearance=1mm:3m:4"], "clearance = 3 m: allowed is"),
        ([], "nothing is varied"),
        (["--vary", "clearance=1mm", "--on", "dsk"], "MODULE:FACTORY is expected"),
        (["--vary", "clearance=1mm", "--shard", "3/2"], "K/N is expected"),
        (["--vary", "clearance=1mm", "--draws", "0"], "--draws 0: a whole number from 1 to 10000"),
        (["--vary", "clearance=1mm", "--draws", "1e5"], "a whole number from 1 to 10000"),
        (["--vary", "clearance=1mm", "--seed", "-1"], "a whole number from 0 is expected"),
        (
            ["--vary", "clearance=1mm", "--measure", "bdc_error@7"],
            "a stage from 0 to wear_updates = 2",
        ),
        (["--vary", "clearance=1mm", "--draws", "few"], "--draws few"),
        (["--vary", "clearance=1mm", "--keep", "most"], "allowed is one of measures, all"),
        (["--vary", "clearance=1mm", "--set", "colour=red"], "unknown key 'colour'"),
        (["--sample", "sobol:8"], "--sample and --range go together"),
        (["--vary", "clearance=1mm", "--require", "bdc_eror>=1mm"], "did you mean bdc_"),
        (["--vary", "clearance=1mm", "--require", "bdc_error>=1"], "has no unit"),
        (["--vary", "clearance=1mm", "--require", "bdc_error"], "MEASURE>=VALUE"),
        (["--resume"], "--resume needs the folder"),
        (["--resume", "--out", "nowhere"], "nowhere: there is no such folder"),
        (["--resume", "--out", "."], "no folder of a sweep"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    words: list[str],
    told: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", "wear-times", *words]) == 2
    line = capsys.readouterr().err
    assert line.startswith("presswear: ")
    assert line.count("\n") == 1
    assert told in line
    assert not list(tmp_path.iterdir())


def test_a_sweep_is_run_gone_on_with_and_widened(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["--out", str(tmp_path / "sweep")]
    assert main(["sweep", "wear-times", *VARY, *OPTIONS, *out, "--jobs", "1"]) == 0
    first = capsys.readouterr().out
    assert "2 points, 2 runs" in first
    assert "1 run of about" in first
    assert "2 rows in" in first
    assert main(["sweep", "wear-times", *VARY, *OPTIONS, *out]) == 2
    assert "it exists and is not empty" in capsys.readouterr().err
    assert main(["sweep", "wear-times", "--resume", *out]) == 0
    assert "of about" not in capsys.readouterr().out
    wider = [word.replace("0.6mm", "0.6mm,0.8mm") for word in VARY]
    shard = ["--shard", "1/2"]
    assert main(["sweep", "wear-times", *wider, *OPTIONS, *out, *shard]) == 2
    assert "--resume widens it to this" in capsys.readouterr().err
    assert main(["sweep", "wear-times", *wider, *OPTIONS, *out, "--resume", "--jobs", "1"]) == 0
    assert np.isfinite(load_sweep(tmp_path / "sweep").table.values).all()


def test_a_sweep_is_reported_and_exported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "sweep"
    found = pw.sweep(SCENE, {"clearance": "0.3mm:0.9mm:3"}, folder, ["A.force_max"], jobs=1)
    assert main(["report", str(folder)]) == 0
    assert "clearance" in (folder / "report.html").read_text()
    file = tmp_path / "rows.csv"
    assert main(["export", str(folder), str(file)]) == 0
    with file.open() as opened:
        read = list(csv.DictReader(line for line in opened if not line.startswith("#")))
    assert [float(own["clearance"]) for own in read] == found.table.points[:, 0].tolist()
    assert [float(own["A.force_max"]) for own in read] == found.table.values[:, 0].tolist()
    capsys.readouterr()
    assert main(["export", str(folder), str(file), "--life"]) == 2
    assert "--strokes and --life do not go" in capsys.readouterr().err


def test_what_is_required_stands_in_its_folder_and_in_its_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "a sweep"
    measured = SCENE, {"clearance": "0.3mm:0.9mm:2"}, folder, ["A.force_max"]
    found = pw.sweep(*measured, jobs=1, required=["A.force_max<=1N"])
    assert load_sweep(folder).required == ("A.force_max<=1N",)
    page = found.report()
    assert "2 of 2 points miss what is required of A.force_max, at most 1.00 N" in page.read_text()
    assert main(["report", str(folder), "--require", "A.force_max<=1MN"]) == 0
    assert "0 of 2 points miss what is required" in page.read_text()
    capsys.readouterr()
    assert main(["report", str(folder), "--require", "B.force_max<=1MN"]) == 2
    assert "did you mean A.force_max" in capsys.readouterr().err
    assert main(["report", str(tmp_path), "--require", "A.force_max<=1MN"]) == 2
    assert "--require goes with a sweep" in capsys.readouterr().err


def test_a_script_is_told_where_the_dashboard_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pw.sweep(SCENE, {"clearance": [4e-4]}, tmp_path / "sweep", ["A.force_max"], on="dask", jobs=1)
    assert "dashboard at http" in capsys.readouterr().out


def test_runs_of_another_program_are_told_of_and_not_mixed_in(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["sweep", "wear-times", *VARY, *OPTIONS, "--out", str(tmp_path / "sweep")]
    assert main([*words, "--jobs", "1"]) == 0
    file = tmp_path / "sweep" / "sweep.json"
    stored = json.loads(file.read_text())
    stored["provenance"]["packages"]["numpy"] = "0.1"
    file.write_text(json.dumps(stored))
    for module in (sweeps, works):
        monkeypatch.setattr(module, "program_digest", lambda: "another")
    capsys.readouterr()
    assert main([*words, "--jobs", "1", "--resume"]) == 0
    told = capsys.readouterr().out
    assert "was begun by another program (numpy 0.1 there and" in told
    assert "1 run of about" in told


def test_a_table_shows_as_many_measures_as_there_is_room_for() -> None:
    columns = tuple(Column(f"measure_{k}", "m", "") for k in range(12))
    values = np.full((2, 12), 1.25)
    table = Table(
        (Column("clearance", "m", ""),),
        columns,
        np.array([[1e-4], [2e-4]]),
        values,
        np.full((2, 12), np.nan),
        np.zeros((2, 12), dtype=bool),
        np.zeros(2, dtype=np.int64),
        ("", ""),
    )
    for width in (60, 100):
        console = Console(width=width, record=True, file=io.StringIO())
        command._print(console, table)
        lines = console.export_text().splitlines()
        assert "…" not in "".join(lines)
        named = [f"measure_{k} (m)" for k in range(12)]
        shown = [name for name in named if name in lines[1]]
        assert shown == named[: len(shown)]
        assert 1 <= len(shown) < 12
        assert lines[-1] == f"and {', '.join(named[len(shown) :])}"


def test_shards_of_one_command_share_a_folder(tmp_path: Path) -> None:
    words = ["sweep", "wear-times", *VARY, *OPTIONS, "--out", str(tmp_path / "sweep")]
    for part in ("1/2", "2/2"):
        assert main([*words, "--jobs", "1", "--shard", part]) == 0
    assert np.isfinite(load_sweep(tmp_path / "sweep").table.values).all()
    assert len(list((tmp_path / "sweep" / "records").iterdir())) == 2


def test_what_takes_longer_than_an_hour_is_asked_for_twice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sweeps, "LONG", 1e-6)
    words = ["sweep", "wear-times", *VARY, *OPTIONS, "--out", str(tmp_path / "sweep")]
    assert main([*words, "--jobs", "1"]) == 2
    told = capsys.readouterr().err
    assert "1 run of about" in told
    assert "--yes" in told
    values = load_sweep(tmp_path / "sweep").table.values[:, 0]
    assert math.isfinite(values[0])
    assert math.isnan(values[1])
    assert main([*words, "--jobs", "1", "--resume", "--yes"]) == 0
    assert np.isfinite(load_sweep(tmp_path / "sweep").table.values).all()


FILE = """
[sweep]
scene = "wear-times"
vary = ["clearance=0.4mm,0.6mm", "engine=dae"]
measures = ["A.force_max, bdc_error"]
draws = 2
"""


def test_a_sweep_may_stand_in_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "my.toml"
    file.write_text(FILE)
    out = ["--out", str(tmp_path / "sweep")]
    assert main(["sweep", str(file), *OPTIONS, *out, "--draws", "1", "--jobs", "1"]) == 0
    assert "2 points, 2 runs" in capsys.readouterr().out
    plan = load_sweep(tmp_path / "sweep").plan
    assert (plan.scene.name, plan.rows) == ("wear-times", 2)
    stored = json.loads((tmp_path / "sweep" / "sweep.json").read_text())
    assert stored["keys"] == ["A.force_max@last", "bdc_error@last"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (FILE.replace("vary", "varry"), "unknown key of [sweep]"),
        (FILE.replace("draws = 2", 'draws = "2"'), "draws"),
        (FILE.replace("wear-times", "wear-time"), "did you mean wear-times"),
        (FILE + '\n[mechanism]\nkind = "x"\n', "the file describes one"),
        ("sweep = 3\n", "a table is expected"),
        ("[sweep\n", "my.toml"),
    ],
)
def test_a_file_that_does_not_fit_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, told: str
) -> None:
    file = tmp_path / "my.toml"
    file.write_text(text)
    assert main(["sweep", str(file), "--out", str(tmp_path / "sweep")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "sweep").exists()


def test_the_file_of_a_scene_may_hold_its_sweep(tmp_path: Path) -> None:
    from presswear.scene.files import example_file, scene_from
    from presswear.sweeps.files import read_sweep

    file = tmp_path / "own.toml"
    text = example_file("slider-crank")
    file.write_text(text + '\n[sweep]\nvary = ["clearance=0.1mm,0.2mm"]\n')
    scene, written = read_sweep(file)
    assert scene == scene_from(file)
    assert written.vary == ("clearance=0.1mm,0.2mm",)


def test_without_the_extra_one_line_says_what_to_install(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['distributed'] = None; from presswear.__main__ import main; "
        "sys.exit(main(['sweep', 'wear-times', '--vary', 'clearance=1mm', '--on', 'dask', "
        f"'--out', {str(tmp_path / 'sweep')!r}]))"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert answer.returncode == 2
    assert "pip install 'presswear[sweep]'" in answer.stderr
    assert not (tmp_path / "sweep").exists()
