"""Results that were damaged or made to deceive, and results of older versions."""

import json
import math
import random
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswear.catalog import wear_times
from presswear.endure.altered import (
    ALTERATIONS,
    altered_results,
    arrays_of,
    executable_array,
    readers,
    save_arrays,
)
from presswear.endure.inputs import answered
from presswear.errors import InputError
from presswear.results import StoredResult, load

STORED = Path(__file__).parents[1] / "stored"
"""Results that older revisions wrote; see its README."""


def test_altered_results_are_refused_in_one_line() -> None:
    found = altered_results(10 * len(ALTERATIONS), seed=1)
    assert found.survived == found.tried == 10 * len(ALTERATIONS), found.note


@pytest.mark.slow
def test_many_altered_results_are_refused_in_one_line() -> None:
    found = altered_results(250 * len(ALTERATIONS), seed=2)
    assert found.survived == found.tried, found.note


def test_what_would_be_executed_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The trap works for whoever allows pickles, and does not for us."""
    monkeypatch.chdir(tmp_path)
    copy = shutil.copytree(STORED / "schema-1", tmp_path / "copy")
    executable_array(random.Random(3), copy)
    with pytest.raises(InputError, match=r"stage-.\.npz cannot be read"):
        load(copy)
    assert not (tmp_path / "executed").exists()
    for file in copy.glob("*.npz"):
        with np.load(file, allow_pickle=True) as stored:
            for name in stored.files:
                _ = stored[name]
    assert (tmp_path / "executed").exists()


@pytest.fixture
def first(tmp_path: Path) -> StoredResult:
    """A result of schema 1, as its own revision wrote it."""
    return load(shutil.copytree(STORED / "schema-1", tmp_path / "schema-1"))


def test_a_result_of_schema_1_means_what_it_meant(first: StoredResult) -> None:
    scene = first.scene
    # Bodies and joints were all that there was, torques were always stored.
    assert (scene.engine, scene.solver, scene.drive_torque) == ("exudyn-joints",) * 2 + ("on",)
    assert (scene.extrapolation, scene.starts) == ("single", 1)
    assert scene.conventions.contact == "radial"
    assert scene.mechanism == wear_times().mechanism
    assert (scene.bearings.angles, scene.wears, scene.cycles) == (36, 1, 1)
    assert scene.numerics.steps_per_contact == 50


def test_arrays_of_schema_1_agree_with_its_statistics(first: StoredResult) -> None:
    for k, arrays in enumerate(first.stages):
        for joint in "AC":
            told = first.statistics(k)["joints"][joint]
            wear = arrays[f"{joint}_wear_bearing"]
            assert float(wear.max()) == pytest.approx(told["wear_depth_max_bearing_m"], rel=1e-12)
            assert arrays[f"{joint}_force"][:, 0].max() <= told["force_max_N"]
            assert len(arrays[f"{joint}_contacts"]) == told["contacts"]
    before, after = first.stages
    assert before["A_depth_pin"].max() == 0.0
    np.testing.assert_array_equal(after["A_depth_pin"], before["A_wear_pin"])


def test_a_result_of_schema_1_is_reported_and_exported(
    first: StoredResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(first.path.parent)
    report, export, _ = readers(first.path, Path("none.csv"))
    assert answered(report).code == answered(export).code == 0
    page = (first.path / "report.html").read_text()
    assert "exudyn-joints" in page


def test_the_first_results_of_schema_2_had_numerics_of_the_scene_itself(tmp_path: Path) -> None:
    folder = shutil.copytree(STORED / "schema-1", tmp_path / "both")
    shutil.copy(STORED / "schema-2-early" / "result.json", folder)
    early, first = load(folder), load(STORED / "schema-1")
    assert early.document["schema"] == 2
    assert replace(early.scene, statuses={}) == first.scene


Edit = dict[str, Any]


@pytest.mark.parametrize(
    ("part", "edit", "says"),
    [
        ("", {"schema": True}, "schema True; this version reads 1 to 3"),
        ("", {"schema": 4}, "schema 4; this version reads 1 to 3"),
        ("", {"engine": "dae"}, "'engine' is not what it is in 'scene', 'exudyn'"),
        ("", {"conventions": {}}, "'conventions' is not what it is in 'scene'"),
        ("", {"wall_s": "1"}, "'wall_s' is not what it should be: '1'"),
        ("", {"provenance": {}}, "'provenance' is not what it should be"),
        ("stages", {"index": -1}, "'index' is not what it should be: -1"),
        ("stages", {"index": 1}, "'index' is 1; 0 is expected"),
        ("stages", {"index": "../0"}, r"'index' is not what it should be: '\.\./0'"),
        ("stages", {"statistics": {"cycles": True}}, "'statistics' is not what it should be"),
        ("stages", {"statistics": {"cycles": 1, "joints": {"B": {}}}}, "statistics of joints B"),
        ("scene", {"wears": 0}, "2 stages, where the scene has wears = 0"),
        ("scene", {"cycles": 10**400}, "cycles = inf: allowed is 1 to"),
        ("scene", {"bearings": {}}, "'clearance' is missing"),
    ],
)
def test_what_is_wrong_with_a_document_is_said(
    tmp_path: Path, part: str, edit: Edit, says: str
) -> None:
    folder = shutil.copytree(STORED / "schema-1", tmp_path / "copy")
    file = folder / "result.json"
    document = json.loads(file.read_text())
    owner = document[part] if part else document
    (owner[0] if isinstance(owner, list) else owner).update(edit)
    file.write_text(json.dumps(document))
    with pytest.raises(InputError, match=says) as refusal:
        load(folder)
    assert "result.json" in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("time", None, "the array time is missing"),
        ("slider", np.zeros((3, 3)), r"slider has the shape \(3, 3\); \(\d+, 3\) is expected"),
        ("angle", np.zeros(36), "angle does not hold the middles of 36 bins"),
        ("angle", np.arange(35.0), "angle does not hold"),
        ("A_depth_pin", np.full(36, -1e-6), "A_depth_pin holds a depth below zero"),
        ("C_wear_pin", np.full(36, math.nan), "C_wear_pin holds a value that is not finite"),
        ("extra", np.array(["a"]), "extra holds no real numbers"),
    ],
)
def test_what_is_wrong_with_the_arrays_is_said(
    tmp_path: Path, name: str, value: Any, says: str
) -> None:
    folder = shutil.copytree(STORED / "schema-1", tmp_path / "copy")
    file = folder / "stage-1.npz"
    arrays = arrays_of(file)
    arrays[name] = value
    kept = {key: own for key, own in arrays.items() if own is not None}
    save_arrays(file, kept)
    with pytest.raises(InputError, match=says) as refusal:
        load(folder)
    assert "stage-1.npz" in str(refusal.value)


def test_an_option_that_numpy_stored_as_an_array_is_no_array(tmp_path: Path) -> None:
    folder = shutil.copytree(STORED / "schema-1", tmp_path / "copy")
    with (
        zipfile.ZipFile(folder / "stage-0.npz", "a") as archive,
        archive.open("allow_pickle.npy", "w") as member,
    ):
        np.save(member, np.array(False))
    assert "allow_pickle" not in load(folder).stages[0]


def test_time_must_not_go_backwards(tmp_path: Path) -> None:
    folder = shutil.copytree(STORED / "schema-1", tmp_path / "copy")
    arrays = arrays_of(folder / "stage-0.npz")
    arrays["time"][[3, 4]] = arrays["time"][[4, 3]]
    save_arrays(folder / "stage-0.npz", arrays)
    with pytest.raises(InputError, match="time goes backwards"):
        load(folder)
