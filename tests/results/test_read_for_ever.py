"""Results of every schema since version 0.2.0 are read, reported and exported."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from presswear.__main__ import main
from presswear.results.result import SCHEMA as RESULT
from presswear.results.result import load
from presswear.studies.plan import SCHEMA as STUDY
from presswear.studies.plan import load_study, results_of
from presswear.sweeps.sweep import SCHEMA as SWEEP
from presswear.sweeps.sweep import load_sweep

DATA = Path(__file__).parents[1] / "data"


def stored(kind: str) -> list[Path]:
    return sorted(DATA.glob(f"{kind}-*"))


@pytest.fixture
def copy(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A copy of a stored folder, which may be written into."""
    return Path(shutil.copytree(request.param, tmp_path / "copy"))


def test_there_is_an_example_of_each_schema() -> None:
    for kind, newest in {"result": RESULT, "study": STUDY, "sweep": SWEEP}.items():
        assert f"{kind}-{newest}" in [path.name for path in stored(kind)]


@pytest.mark.parametrize("copy", stored("result"), indirect=True, ids=lambda path: path.name)
def test_a_result_is_read_reported_and_exported(copy: Path, tmp_path: Path) -> None:
    result = load(copy)
    told = json.loads((copy / "result.json").read_text())
    assert result.status == told["status"]
    assert [stage.cycles for stage in result.stages] == [
        stage["statistics"]["cycles"] for stage in told["stages"]
    ]
    with np.load(copy / "stage-1.npz") as arrays:
        assert np.array_equal(result.stages[1].joints["B"].force, arrays["B_force"])
        worn = arrays["B_depth_bearing"]
    assert worn.max() > 0.0
    with np.load(copy / "film-1.npz") as arrays:
        assert np.array_equal(result.stages[1].film.time, arrays["time"])
    assert main(["report", str(copy)]) == 0
    assert "Wear depth" in (copy / "report.html").read_text()
    assert main(["export", str(copy), str(tmp_path / "table.csv"), "--stage", "1"]) == 0
    with (tmp_path / "table.csv").open() as opened:
        rows = list(csv.DictReader(line for line in opened if not line.startswith("#")))
    assert [float(row["time"]) for row in rows] == result.stages[1].time.tolist()


@pytest.mark.parametrize("copy", stored("study"), indirect=True, ids=lambda path: path.name)
def test_a_study_is_read_and_reported(copy: Path) -> None:
    study = load_study(copy)
    lives = [found.life for _, found in results_of(study, copy) if found is not None]
    assert len(lives) == len(study.variants) == 2
    for variant, life in zip(study.variants, lives, strict=True):
        told = json.loads((copy / variant.key / "result.json").read_text())
        assert life is not None
        assert life.strokes == told["life"]["strokes"]
    assert main(["report", str(copy)]) == 0
    page = (copy / "report.html").read_text()
    for variant in study.variants:
        assert variant.label in page


@pytest.mark.parametrize("copy", stored("sweep"), indirect=True, ids=lambda path: path.name)
def test_a_sweep_is_read_and_reported(copy: Path) -> None:
    table = load_sweep(copy).table
    (records,) = copy.glob("records/*/records.jsonl")
    values = [
        json.loads(line.partition(" ")[2])["values"]["B.force_max@1"][0]
        for line in records.read_text().splitlines()
    ]
    assert sorted(table.values[:, 0]) == sorted(values)
    assert main(["report", str(copy)]) == 0
    assert "force_max" in (copy / "report.html").read_text()
