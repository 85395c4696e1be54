"""Sweeps from a script and from the command line."""

import json
import math
import pickle
import re
import subprocess
import sys
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from exudyn.processing import ParameterVariation
from made_up_sweep import table_of

import presswear as pw
from presswear.__main__ import main
from presswear.cli import sweep as command
from presswear.scene.files import example_file, scene_from
from presswear.scene.settings import changed
from presswear.sweeps.plan import NOT_RUN, Plan, read_sweep
from presswear.sweeps.report import write_report
from presswear.sweeps.responses import Limit
from presswear.sweeps.sweep import load_sweep, run_sweep
from presswear.tools.errors import InputError, RunFailed

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
VARY = ["--vary", "clearance=0.4mm,0.6mm", "--response", "A.force_max,bdc_error"]


def peak(result: pw.Result) -> float:
    return float(result.stages[0].joints["A"].force.max())


def run_at(settings: dict[str, float]) -> pw.Result:
    return pw.run(changed(SCENE, settings), jobs=1)


def test_a_row_has_the_numbers_of_a_run_of_its_scene(tmp_path: Path) -> None:
    sweep = pw.sweep(
        SCENE,
        {"clearance": [4e-4, 6e-4], "A.friction": "0.02,0.05"},
        tmp_path / "sweep",
        [peak, "bdc_error"],
        replicates=2,
        jobs=1,
    )
    table = sweep.table
    keys = [column.key for column in (*table.parameters, *table.responses)]
    assert keys == ["clearance", "A.friction", "peak", "bdc_error"]
    assert table.points[::2].tolist() == [[4e-4, 0.02], [4e-4, 0.05], [6e-4, 0.02], [6e-4, 0.05]]
    assert set(table.errors) == {""}
    alone = run_at({"clearance": 6e-4, "A.friction": 0.02, "seed": 1})
    bottom = alone.stages[0].each_cycle("bottom_height")[0] - SCENE.bottom
    assert table.values[5].tolist() == [peak(alone), pytest.approx(bottom, rel=1e-9, abs=0)]
    assert np.isnan(table.half_widths).all()  # one cycle has no interval
    assert table.values[4, 0] != table.values[5, 0]
    assert "8 rows in" in str(sweep)
    again = load_sweep(tmp_path / "sweep")
    assert np.array_equal(again.table.values, table.values)
    with pytest.raises(InputError, match="user functions as responses"):
        run_sweep(again)


def test_other_responses_of_stored_rows_need_no_run(tmp_path: Path) -> None:
    few = {"clearance": [4e-4]}
    first = pw.sweep(SCENE, few, tmp_path / "sweep", ["A.force_max"], jobs=1)
    rows = {file: file.stat().st_mtime_ns for file in (tmp_path / "sweep" / "rows").iterdir()}
    second = pw.sweep(SCENE, few, tmp_path / "sweep", ["C.force_max"], jobs=1)
    assert rows == {file: file.stat().st_mtime_ns for file in rows}
    assert math.isfinite(second.table.values[0, 0])
    results = pw.sweep(SCENE, few, tmp_path / "sweep", ["A.force_max"], jobs=1, keep="results")
    assert results.table.values.tolist() == first.table.values.tolist()
    assert results.result(0).scene.bearing("A").clearance == 4e-4


@pytest.mark.parametrize("on", ["", "dask", "concurrent.futures:ProcessPoolExecutor"])
def test_numbers_do_not_depend_on_the_executor(
    on: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    vary = {"clearance": [4e-4, 6e-4], "cycles": [4]}
    alone = pw.sweep(SCENE, vary, tmp_path / "1", jobs=1).table
    table = pw.sweep(SCENE, vary, tmp_path / "2", on=on, jobs=2).table
    assert np.isfinite(alone.values[:, 0]).all()
    assert np.array_equal(table.values, alone.values, equal_nan=True)
    assert np.array_equal(table.half_widths, alone.half_widths, equal_nan=True)
    assert on != "dask" or "dashboard at http://127.0.0.1" in capsys.readouterr().out


def test_a_failed_run_is_a_row_with_its_error(tmp_path: Path) -> None:
    vary = {"integrator": ["dopri5", "rk4-paper"]}
    sweep = pw.sweep(SCENE, vary, tmp_path / "sweep", ["A.force_max"], jobs=1)
    assert sweep.table.errors[0] == ""
    assert "no longer finite" in sweep.table.errors[1]
    assert np.isfinite(sweep.table.values[:, 0]).tolist() == [True, False]
    assert "1 failed, the first: " in str(sweep)


def test_a_sweep_is_resumed_extended_reported_and_exported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, out = tmp_path / "sweep", ["--out", str(tmp_path / "sweep"), "--jobs", "1"]
    assert main(["sweep", "wear-times", *VARY, *OPTIONS, *out, "--shard", "1/2"]) == 0
    assert "2 points, 2 runs" in capsys.readouterr().out
    assert load_sweep(folder).table.errors == ("", NOT_RUN)
    assert main(["sweep", "wear-times", *VARY, *OPTIONS, *out]) == 2
    assert "the folder is not empty" in capsys.readouterr().err
    assert main(["sweep", "wear-times", *VARY, *OPTIONS, *out, "--shard", "2/2"]) == 0
    wider = [word.replace("0.6mm", "0.6mm,0.8mm,0.9mm") for word in VARY]
    assert main(["sweep", "wear-times", *wider, *OPTIONS, *out, "--shard", "1/2"]) == 2
    assert "--resume extends it" in capsys.readouterr().err
    monkeypatch.setattr(command, "LONG", 1e-6)
    assert main(["sweep", "wear-times", *wider, *OPTIONS, *out, "--resume"]) == 2
    assert "continue with --resume --yes" in capsys.readouterr().err
    assert main(["sweep", "wear-times", *wider, *OPTIONS, *out, "--resume", "--yes"]) == 0
    table = load_sweep(folder).table
    assert np.isfinite(table.values).all()
    capsys.readouterr()
    assert main(["report", str(folder), "--limit", "A.force_max<=1N"]) == 0
    page = (folder / "report.html").read_text()
    assert "4 of 4 points violate the upper limit 1.00 N of A.force_max" in page
    assert (folder / "figures" / "lines-A-force_max.png").exists()
    assert main(["report", str(folder), "--limit", "B.force_max<=1MN"]) == 2
    assert "did you mean A.force_max" in capsys.readouterr().err
    assert main(["report", str(tmp_path), "--limit", "A.force_max<=1MN"]) == 2
    assert "--limit needs a sweep" in capsys.readouterr().err
    assert main(["export", str(folder), str(tmp_path / "rows.csv")]) == 0
    assert (tmp_path / "rows.csv").read_text() == table.csv()
    assert main(["export", str(folder), str(tmp_path / "rows.csv"), "--life"]) == 2
    assert "--strokes and --life cannot be used" in capsys.readouterr().err
    (folder / "sweep.json").write_text(json.dumps({"schema": 2, "plan": {}}))
    assert main(["report", str(folder)]) == 2
    assert "sweep.json" in capsys.readouterr().err


SAMPLED = Plan(
    SCENE, ("engine=dae,exudyn",), "sobol:64", ("clearance=0.2mm:1mm", "friction=0:0.1"), 2
)


def test_a_report_tells_sensitivity_chaos_and_violations(tmp_path: Path) -> None:
    points = SAMPLED.points
    values = 1e6 * points[:, 0] + 1e3 * points[:, 2]
    table = table_of(points, values, 2, noise=10.0)
    table = type(table)(SAMPLED.columns, *list(vars(table).values())[1:])
    table.values[5] = np.nan
    page = write_report(table, SAMPLED, tmp_path, {"y": Limit(800.0, False)}).read_text()
    page = re.sub(r"data:image/png;base64,[^\"]*", "", page)
    text = unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", page)))
    assert "256 runs at 128 points" in text
    for engine in ("dae", "exudyn"):
        assert f"At engine = {engine}: y depends most on clearance." in text
        assert f"At engine = {engine}: Chaos is" in text
        assert f"At engine = {engine}: The probability that the upper limit 800" in text
    assert (tmp_path / "figures" / "1" / "map-y.png").exists()
    assert (tmp_path / "table.csv").read_text() == table.csv()


FILE = """
[sweep]
scene = "wear-times"
vary = ["clearance=0.4mm,0.6mm", "engine=dae"]
responses = ["A.force_max, bdc_error"]
replicates = 2
"""


def test_a_sweep_may_be_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "my.toml"
    file.write_text(FILE)
    out = ["--out", str(tmp_path / "sweep"), "--replicates", "1", "--jobs", "1"]
    assert main(["sweep", str(file), *OPTIONS, *out]) == 0
    assert "2 points, 2 runs" in capsys.readouterr().out
    assert load_sweep(tmp_path / "sweep").requested.keys == ("A.force_max@last", "bdc_error@last")
    text = example_file("slider-crank")
    file.write_text(text + '\n[sweep]\nvary = ["clearance=0.1mm,0.2mm"]\n')
    scene, options = read_sweep(file)
    assert scene == scene_from(file)
    assert options.vary == ("clearance=0.1mm,0.2mm",)


def test_without_dask_one_line_names_the_package(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['distributed'] = None; from presswear.__main__ import main; "
        "sys.exit(main(['sweep', 'wear-times', '--vary', 'clearance=1mm', '--on', 'dask', "
        f"'--out', {str(tmp_path / 'sweep')!r}]))"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert answer.returncode == 2
    assert "pip install 'presswear[sweep]'" in answer.stderr
    assert not (tmp_path / "sweep").exists()


def test_a_scene_is_a_function_of_its_settings() -> None:
    function = pw.function_of(SCENE, [peak, "bdc_error"])
    point = {"clearance": 5e-4, "A.friction": 0.03}
    values = pickle.loads(pickle.dumps(function))({**point, "clearance": "0.5 mm"})
    assert values[0] == pw.function_of(SCENE, peak)(point) == peak(run_at(point))
    failing = {"integrator": "rk4-paper"}
    with pytest.raises(RunFailed, match="no longer finite"):
        pw.function_of(SCENE, "A.force_max")(failing)
    assert pw.function_of(SCENE, peak, failed=1e9)(failing) == 1e9
    with pytest.raises(InputError, match="did you mean clearance"):
        function({"clearence": 1e-3})


def test_parameter_variation_of_exudyn_accepts_a_function() -> None:
    function = pw.function_of(SCENE, "A.force_max")
    varied, values = ParameterVariation(
        function,
        {"clearance": (4e-4, 6e-4, 2), "friction": [0.02, 0.05]},
        useMultiProcessing=True,
        numberOfThreads=2,
        showProgress=False,
        addComputationIndex=True,
        parameterFunctionData={"seed": 1},
    )
    points = zip(varied["clearance"], varied["friction"], strict=True)
    shared = {"seed": 1}
    assert values == [function({"clearance": c, "friction": f, **shared}) for c, f in points]
