"""Sweeps from a script and from the command line, and bad input, which writes nothing."""

import json
import math
import pickle
import re
import sys
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from made_up_sweep import table_of
from refusals import refused

import presswear as pw
from presswear.cli import sweep as sweep_command
from presswear.scene.files import example_file, scene_from
from presswear.scene.settings import changed
from presswear.sweeps.plan import NOT_RUN, Plan, read_sweep
from presswear.sweeps.report import write_report
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.sweep import load_sweep, run_sweep
from presswear.tools.errors import RunFailed

QUICK = {"engine": "dae", "integrator": "dopri5", "integration_tolerance": 1e-6}
QUICK |= {"wear_updates": 0, "cycles": 1, "replicates": 1}
SCENE = pw.scenes.wear_times(**QUICK)
OPTIONS = " ".join(f"--set {key}={value}" for key, value in QUICK.items())
VARY = "--vary clearance=0.4mm,0.6mm --response A.force_max,bdc_error"


def peak(result: pw.Result) -> float:
    return float(result.stages[0].joints["A"].force.max())


def run_at(settings: dict[str, float]) -> pw.Result:
    return pw.run(changed(SCENE, settings), jobs=1)


def test_a_row_has_the_numbers_of_a_run_of_its_scene(tmp_path):
    vary = {"clearance": [4e-4, 6e-4], "A.friction": "0.02,0.05"}
    sweep = pw.sweep(
        SCENE, vary, tmp_path / "sweep", [peak, "bdc_error"], replicates=2, jobs=1
    )
    table = sweep.table
    keys = [column.key for column in (*table.parameters, *table.responses)]
    assert keys == ["clearance", "A.friction", "peak", "bdc_error"]
    assert table.points[::2].tolist() == [
        [4e-4, 0.02],
        [4e-4, 0.05],
        [6e-4, 0.02],
        [6e-4, 0.05],
    ]
    assert set(table.errors) == {""}
    alone = run_at({"clearance": 6e-4, "A.friction": 0.02, "seed": 1})
    bottom = alone.stages[0].each_cycle("bottom_height")[0] - SCENE.bottom
    assert table.values[5].tolist() == [
        peak(alone),
        pytest.approx(bottom, rel=1e-9, abs=0),
    ]
    assert np.isnan(table.half_widths).all()  # one cycle has no interval
    assert table.freedom == (1.0, 1.0)
    assert table.values[4, 0] != table.values[5, 0]
    assert "8 rows in" in str(sweep)
    means = sweep.to_pandas(means=True)
    assert means["A.friction"].tolist() == [0.02, 0.05, 0.02, 0.05]
    assert (
        means["peak"].tolist() == table.values[:, 0].reshape(4, 2).mean(axis=1).tolist()
    )
    assert (means["peak_half_width"] > 0.0).all()
    assert means["peak_replicates"].tolist() == [2, 2, 2, 2]
    assert means.attrs["units"]["bdc_error_half_width"] == "m"
    again = load_sweep(tmp_path / "sweep")
    assert np.array_equal(again.table.values, table.values)
    with refused("user functions as responses"):
        run_sweep(again)


def test_other_responses_of_stored_rows_need_no_run(tmp_path):
    few = {"clearance": [4e-4]}
    first = pw.sweep(SCENE, few, tmp_path / "sweep", ["A.force_max"], jobs=1)
    rows = {
        file: file.stat().st_mtime_ns
        for file in (tmp_path / "sweep" / "rows").iterdir()
    }
    second = pw.sweep(SCENE, few, tmp_path / "sweep", ["C.force_max"], jobs=1)
    assert rows == {file: file.stat().st_mtime_ns for file in rows}
    assert math.isfinite(second.table.values[0, 0])
    results = pw.sweep(
        SCENE, few, tmp_path / "sweep", ["A.force_max"], jobs=1, keep="results"
    )
    assert results.table.values.tolist() == first.table.values.tolist()
    assert results.result(0).scene.bearing("A").clearance == 4e-4


CYCLES_OF_TWO = {"clearance": [4e-4, 6e-4], "cycles": [4]}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone") / "sweep"
    return pw.sweep(SCENE, CYCLES_OF_TWO, folder, jobs=1).table


@pytest.mark.parametrize("on", ["", "dask", "concurrent.futures:ProcessPoolExecutor"])
def test_executors_agree(on, alone, tmp_path, capsys):
    table = pw.sweep(SCENE, CYCLES_OF_TWO, tmp_path, on=on, jobs=2).table
    assert np.isfinite(alone.values[:, 0]).all()
    assert np.array_equal(table.values, alone.values, equal_nan=True)
    assert np.array_equal(table.half_widths, alone.half_widths, equal_nan=True)
    assert on != "dask" or "dashboard at http://127.0.0.1" in capsys.readouterr().out


def test_a_failed_run_is_a_row_with_its_error(tmp_path):
    vary = {"integrator": ["dopri5", "rk4-paper"]}
    sweep = pw.sweep(SCENE, vary, tmp_path / "sweep", ["A.force_max"], jobs=1)
    assert sweep.table.errors[0] == ""
    assert "no longer finite" in sweep.table.errors[1]
    assert np.isfinite(sweep.table.values[:, 0]).tolist() == [True, False]
    assert "1 failed, the first: " in str(sweep)


def test_a_sweep_is_resumed_extended_reported_and_exported(
    tmp_path, command, monkeypatch
):
    folder = tmp_path / "sweep"
    csv = tmp_path / "rows.csv"
    line = f"sweep wear-times {VARY} {OPTIONS} --out {folder} --jobs 1"
    assert "2 points, 2 runs" in command(f"{line} --shard 1/2")
    assert load_sweep(folder).table.errors == ("", NOT_RUN)
    assert "exists and is not empty" in command(line, 2)
    command(f"{line} --shard 2/2")
    wider = line.replace("0.6mm", "0.6mm,0.8mm,0.9mm")
    assert "--resume extends it" in command(f"{wider} --shard 1/2", 2)
    monkeypatch.setattr(sweep_command, "MAX_TIME", 1e-6)
    assert "continue with --resume --yes" in command(f"{wider} --resume", 2)
    command(f"{wider} --resume --yes")
    table = load_sweep(folder).table
    assert np.isfinite(table.values).all()
    command(f"report {folder} --limit 'A.force_max<=1N'")
    page = (folder / "report.html").read_text()
    assert "4 of 4 points violate the upper limit 1.00 N of A.force_max" in page
    assert (folder / "figures" / "lines-A-force_max.svg").exists()
    refused = command(f"report {folder} --limit 'B.force_max<=1MN'", 2)
    assert "did you mean A.force_max" in refused
    assert "--limit needs a" in command(
        f"report {tmp_path} --limit 'A.force_max<=1MN'", 2
    )
    command(f"export {folder} {csv}")
    assert csv.read_text() == table.csv()
    assert "--strokes, --cycles and --life cannot be used" in command(
        f"export {folder} {csv} --life", 2
    )
    (folder / "sweep.json").write_text(json.dumps({"schema": 2, "plan": {}}))
    assert "sweep.json" in command(f"report {folder}", 2)


RANGES = ("clearance=0.2mm:1mm", "friction=0:0.1")
SAMPLED = Plan(SCENE, ("engine=dae,exudyn",), "sobol:64", RANGES, 2)


def test_a_report_tells_sensitivity_chaos_and_violations(tmp_path):
    points = SAMPLED.points
    values = 1e6 * points[:, 0] + 1e3 * points[:, 2]
    table = table_of(points, values, 2, noise=10.0)
    table = type(table)(SAMPLED.columns, *list(vars(table).values())[1:])
    table.values[5] = np.nan
    table = replace(table, errors=("", "", "", "", "", "ended early", *[""] * 250))
    page = write_report(
        table, SAMPLED, tmp_path, {"y": ResponseLimit(800.0, False)}
    ).read_text()
    page = re.sub(r"data:image/png;base64,[^\"]*", "", page)
    text = unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", page)))
    assert "256 runs at 128 points" in text
    for engine in ("dae", "exudyn"):
        assert f"At engine = {engine}: y depends most on clearance" in text
        assert text.count("Scatter of chaotic motion is") == 2
        assert f"At engine = {engine}: The probability that the upper limit 800" in text
    assert "1 of 128 runs failed" in text
    assert "1 of 256 runs failed" in text
    assert (tmp_path / "figures" / "1" / "map-y.svg").exists()
    assert (tmp_path / "table.csv").read_text() == table.csv()


FILE = """
[sweep]
scene = "wear-times"
vary = ["clearance=0.4mm,0.6mm", "engine=dae"]
responses = ["A.force_max, bdc_error"]
replicates = 2
"""


def test_a_sweep_may_be_a_file(tmp_path, command):
    file = tmp_path / "my.toml"
    folder = tmp_path / "sweep"
    file.write_text(FILE)
    shown = command(f"sweep {file} {OPTIONS} --out {folder} --replicates 1 --jobs 1")
    assert "2 points, 2 runs" in shown
    keys = [column.key for column in load_sweep(folder).requested.columns]
    assert keys == ["A.force_max", "bdc_error"]
    text = example_file("slider-crank")
    file.write_text(text + '\n[sweep]\nvary = ["clearance=0.1mm,0.2mm"]\n')
    scene, options = read_sweep(file)
    assert scene == scene_from(file)
    assert options.vary == ("clearance=0.1mm,0.2mm",)


def test_a_new_file_is_swept_at_once(tmp_path, command):
    """Without the wear update of the file; other numbers of wear updates need strokes."""
    file = tmp_path / "my.toml"
    folder = tmp_path / "sweep"
    file.write_text(example_file("slider-crank"))
    options = "--vary clearance=0.1mm,0.2mm --cycles 1 --jobs 1"
    shown = command(f"sweep {file} {options} --out {folder} --response B.force_max")
    assert "no wear updates: set cycles_per_update" in shown
    assert "failed" not in shown
    assert "no wear updates" in load_sweep(folder).report().read_text()
    assert "cycles_per_update = none" in command(
        f"sweep {file} {options} --wear-updates 2", code=2
    )


def test_without_dask_one_line_names_the_package(tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "distributed", None)
    shown = command("sweep wear-times --vary clearance=1mm --on dask", 2)
    assert (
        "pip install distributed, or pip install '.[sweep]' in the folder of the"
        in shown
    )
    assert not list(tmp_path.iterdir())


def test_a_scene_is_a_function_of_its_settings():
    function = pw.function_of(SCENE, [peak, "bdc_error"])
    point = {"clearance": 5e-4, "A.friction": 0.03}
    values = pickle.loads(pickle.dumps(function))({**point, "clearance": "0.5 mm"})
    assert values[0] == pw.function_of(SCENE, peak)(point) == peak(run_at(point))
    failing = {"integrator": "rk4-paper"}
    with pytest.raises(RunFailed, match="no longer finite"):
        pw.function_of(SCENE, "A.force_max")(failing)
    assert pw.function_of(SCENE, peak, failed=1e9)(failing) == 1e9
    with refused("did you mean clearance"):
        function({"clearence": 1e-3})


# Options of ``presswear sweep wear-times``, and words of the message.
BAD_INPUT = r"""
--vary clearence=1mm | did you mean clearance
--vary clearance= | expected KEY=VALUES
--vary clearance=0.4,0.5 | clearance = '0.4' has no unit
--vary clearance=1mm:3m:4 | clearance = 3 m: allowed is
--vary engine=dae,exudyntree | did you mean exudyn-tree
--vary friction=0.1,0.1 | a value is repeated
--vary 'A.friction=0.1,0.2 & C.friction=0.1' | as many values of each key, got 2 and 1
--vary friction=0.1 --vary friction=0.2 | friction varies twice
--vary seed=1,2 --replicates 2 | cannot be combined
--vary clearance=1mm,2mm --set cycles_per_update=none | set it, as in cycles_per_update=1e6
--vary length_3=0.1m,0.11m | no scene of this plan can be made
--vary friction=0:0.1:10000 --vary clearance=0.1mm:1mm:10000 | the plan has 100000000 rows
--sample sobol:8 | a sample and ranges must be used together
--sample sobol --range friction=0:0.1 | expected KIND:SIZE
--sample sobel:8 --range friction=0:0.1 | did you mean sobol
--sample sobol:500 --range friction=0:0.1 | must be a power of two, 256 or 512
--sample morris:0 --range friction=0:0.1 | a size and a number of parameters of at least 1
--sample sobol:8 --range engine=dae | engine is not a number
--sample sobol:8 --range friction | expected KEY=DISTRIBUTION
--sample sobol:8 --range 'clearance=nromal(0.8mm, 0.05mm)' | did you mean normal
--sample sobol:8 --range clearance=0.8mm | expected a range such as
--sample sobol:8 --range 'clearance=normal(0.8mm)' | expected normal(MEAN, DEVIATION)
--sample sobol:8 --range 'clearance=normal(0.8, 0.05mm)' | has no unit
--sample sobol:8 --range 'clearance=normal(0.8mm, 0.5mm)' | of it lies outside the allowed range
--sample sobol:8 --range clearance=0.2mm:2m | allowed is
--sample sobol:8 --range clearance=1mm:0.2mm | the first end must be below the second
--sample sobol:8 --range 'clearance=lognormal(0.8mm, 0.5)' | a factor such as x1.6
--sample sobol:8 --range 'friction=lognormal(0, 50%)' | the median must be positive
--sample sobol:8 --range 'clearance=table(nowhere.csv)' | no such file
--vary clearance=1mm --response A.forcemax | did you mean A.force_max
--vary clearance=1mm --response B.depth | unknown response 'B.depth'
--vary clearance=1mm --response A.depth@3 | the stage must be 0 to wear_updates = 2
--vary clearance=1mm --response A.depth@x | NAME@STAGE
--vary clearance=1mm --set wear_updates=0 --response A.depth | request A.wear_rate, the volume
--vary clearance=1mm --response A.depth,A.depth | is repeated
--vary clearance=1mm --limit 'bdc_error<1mm' | expected RESPONSE>=VALUE or RESPONSE<=VALUE
--vary clearance=1mm --limit 'bdc_eror>=1mm' | did you mean bdc_
--vary clearance=1mm --limit 'A.force_max<=15' | has no unit
--vary clearance=1mm --limit 'bdc_error>=1mm' --limit 'bdc_error<=2mm' | already has a limit
--vary clearance=1mm --on dsk | MODULE:FACTORY
--vary clearance=1mm --on nowhere:Executor | nowhere
--vary clearance=1mm --on builtins:dict | dict is not an Executor
--vary clearance=1mm --on dask://nowhere | expected dask://HOST:PORT
--vary clearance=1mm --shard 3/2 | expected K/N
--vary clearance=1mm --replicates few | --replicates few
--vary clearance=1mm --replicates 10001 | replicates = 10001: must be 1 to 10000
--vary clearance=1mm --seed -1 | must be a whole number from 0
--vary clearance=1mm --keep most | allowed is one of responses, results
--vary clearance=1mm --set colour=red | unknown key 'colour'
--vary clearance=1mm --cycles 1 --set cycles=2 | cannot be combined
--resume | --resume needs the folder
--resume --out . | is not the folder of a sweep
"""


@pytest.mark.parametrize("case", ["| nothing varies", *BAD_INPUT.strip().splitlines()])
def test_bad_input_is_one_line_and_writes_nothing(case, tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words, _, message = case.rpartition("| ")
    assert message in command(f"sweep wear-times {words}", 2)
    assert not list(tmp_path.iterdir())


SWEEP_FILE = (
    '[sweep]\nscene = "wear-times"\nvary = ["clearance=0.4mm"]\nreplicates = 2\n'
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SWEEP_FILE.replace("vary", "varry"), "unknown key of [sweep] in "),
        (SWEEP_FILE.replace("= 2", '= "2"'), "replicates"),
        (SWEEP_FILE.replace("wear-times", "wear-time"), "did you mean wear-times"),
        (SWEEP_FILE + '\n[mechanism]\nkind = "x"\n', "the file describes one"),
        ("sweep = 3\n", "a table is expected"),
    ],
)
def test_a_wrong_file_is_refused(text, message, tmp_path):
    (tmp_path / "my.toml").write_text(text)
    with refused(re.escape(message)):
        read_sweep(tmp_path / "my.toml")
