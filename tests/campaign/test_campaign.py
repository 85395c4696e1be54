"""The outer loop, its results on disk, and the statistics."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswear.campaign.amplification import worn_out
from presswear.campaign.campaign import Stage, Watcher, run_campaign
from presswear.linkage.surface import Surface
from presswear.results.folder import ResultFolder
from presswear.results.result import Result, load
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import CONVENTIONS, Scene
from presswear.tools.errors import InputError
from presswear.tools.files import write_whole


def short(conventions: str) -> Scene:
    """One fast cycle of the press, worn once; each wear stands for that cycle a million times."""
    scene = wear_times()
    return replace(
        scene,
        mechanism=replace(scene.mechanism, speed=60.0),
        conventions=CONVENTIONS[conventions],
        cycles=1,
        wears=1,
        represented_cycles=1e6,
        extrapolation="single",
    )


@pytest.fixture(scope="module", params=["paper", "refined"])
def campaign(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Scene, list[Stage], Path]:
    scene = short(request.param)
    path = tmp_path_factory.mktemp("result") / request.param
    folder = ResultFolder(path, scene)
    stages: list[Stage] = []

    def finished(stage: Stage) -> None:
        stages.append(stage)
        folder.add(stage)

    folder.close(*run_campaign(scene, Watcher(stage=finished)))
    return scene, stages, path


def test_the_next_stage_runs_on_the_amplified_wear(
    campaign: tuple[Scene, list[Stage], Path],
) -> None:
    scene, (first, second), _ = campaign
    assert first.amplification == scene.represented_cycles
    for k, joint in enumerate(second.linkage.clearances):
        assert joint.bearing_surface.is_worn
        expected = 1e6 * first.ensemble.recorders[0].maps.total[k]
        np.testing.assert_allclose(joint.bearing_surface.depth, expected[0], rtol=1e-14)
        np.testing.assert_allclose(joint.pin_surface.depth, expected[1], rtol=1e-14)
    assert not first.linkage.clearances[0].bearing_surface.is_worn


def test_stored_arrays_have_the_contracted_names_and_shapes(
    campaign: tuple[Scene, list[Stage], Path],
) -> None:
    scene, stages, path = campaign
    stored = load(path)
    assert stored.scene == scene
    assert stored.document["status"] == "completed"
    for stage, arrays in zip(stages, stored.stages, strict=True):
        n, m = arrays["time"].size, scene.bearings.angles
        assert n > 100
        assert np.all(np.diff(arrays["time"]) > 0.0)
        assert arrays["slider"].shape == (n, 3)
        assert arrays["slider"][0, 0] == 0.0
        assert arrays["angle"].shape == (m,)
        for joint in "AC":
            assert arrays[f"{joint}_eccentricity"].shape == (n, 2)
            assert arrays[f"{joint}_force"].shape == (n, 2)
            assert arrays[f"{joint}_penetration"].shape == (n,)
            assert arrays[f"{joint}_sliding"].shape == (n,)
            for side in ("bearing", "pin"):
                assert arrays[f"{joint}_depth_{side}"].shape == (m,)
                assert arrays[f"{joint}_wear_{side}"].max() > 0.0
            open_rows = arrays[f"{joint}_penetration"] < 0.0
            assert np.all(arrays[f"{joint}_force"][open_rows] == 0.0)
        peak = stored.stages[stage.index].statistics["joints"]["A"]["force_max_N"]
        assert 0.9 * peak < arrays["A_force"][:, 0].max() <= peak


def test_result_json_says_where_it_comes_from(
    campaign: tuple[Scene, list[Stage], Path],
) -> None:
    document = json.loads((campaign[2] / "result.json").read_text())
    assert document["provenance"]["packages"]["exudyn"] == "1.13.6"
    assert document["provenance"]["python"].startswith("3.")
    assert document["wall_s"] > 0.0
    for stage in document["stages"]:
        assert "clearance: A, C" in stage["diagnostics"]["model"]
        joint = stage["statistics"]["joints"]["A"]
        assert joint["unresolved_contacts"] == 0
        assert joint["fewest_steps_in_a_contact"] >= 5


def test_a_folder_with_anything_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("mine")
    with pytest.raises(InputError, match="not empty"):
        ResultFolder(tmp_path, wear_times())
    assert (tmp_path / "precious").read_text() == "mine"


def test_a_file_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")

    def broken(file: object) -> None:
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        write_whole(target, broken)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def _restored(path: Path, schema: object, scene: object) -> Result:
    """A folder without stages, read back."""
    document = {
        "schema": schema,
        "scene": scene,
        "engine": "exudyn",
        "provenance": {
            "packages": {},
            **dict.fromkeys(("python", "revision", "machine", "started"), ""),
        },
        "status": "running",
        "message": "",
        "wall_s": 0.0,
        "stages": [],
    }
    (path / "result.json").write_text(json.dumps(document))
    return load(path)


def test_scenes_of_schema_1_are_presses(tmp_path: Path) -> None:
    scene = short("refined")
    data = scene.as_dict()
    press = data.pop("mechanism")
    assert press.pop("kind") == "press"
    del data["statuses"]
    found = _restored(tmp_path, 1, {**data, "press": press})
    assert found.scene == scene
    # What is stored is left alone.
    assert "press" in found.document["scene"]


def test_scenes_say_which_mechanism_they_hold(tmp_path: Path) -> None:
    assert _restored(tmp_path, 2, slider_crank().as_dict()).scene == slider_crank()


@pytest.mark.parametrize(
    ("schema", "scene", "says"),
    [
        (4, {}, "schema 4; this version reads 1 to 3"),
        (0, {}, "schema 0"),
        ("2", {}, "schema '2'"),
        (True, {}, "schema True"),
        (2.0, {}, "schema 2.0"),
        (None, {}, "schema None"),
        (1, {"mechanism": {}}, "not a stored scene: 'kind'"),
        (1, {"press": 3}, "not a stored scene.*mechanism"),
        (1, 3, "'scene' is not what it should be: 3"),
        (2, {"press": {}}, "not a stored scene.*mechanism"),
    ],
)
def test_other_schemas_are_refused(
    tmp_path: Path, schema: object, scene: object, says: str
) -> None:
    with pytest.raises(InputError, match=says):
        _restored(tmp_path, schema, scene)


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 99}', "{", "\x00\xff"])
def test_a_folder_that_holds_no_result_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "result.json").write_text(text, encoding="latin-1")
    with pytest.raises(InputError):
        load(tmp_path)


def test_wear_through_the_pin_is_named() -> None:
    joints = wear_times().linkage().clearances
    whole = Surface(np.zeros(360))
    deep = Surface(np.full(360, 0.0143))
    worn = {"A": (whole, whole), "C": (whole, deep)}
    found = worn_out(joints, worn)
    assert found is not None
    joint, what = found
    assert joint == "C"
    assert "the pin would lose 0.0143 m, more than the clearance of 0.0008 m" in what
    assert worn_out(joints, {"A": (whole, whole), "C": (whole, whole)}) is None
