"""Stored results that are damaged, of another version or made to deceive: refused by name."""

import copy
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswear.campaign.campaign import run
from presswear.linkage.surface import bin_centres
from presswear.results.folder import (
    FILE,
    SCHEMA,
    check_joints,
    provenance,
    read_document,
    stored_result,
)
from presswear.results.result import Result, load
from presswear.results.stage import StageStatistics, check_arrays
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import slider_crank, wear_times
from presswear.tools.errors import InputError
from presswear.tools.serialize import plain, write_json

FILE_PATH = Path(FILE)
JOINTS = ("A", "C")
NO_LEAVES: tuple[Any, ...] = (True, False, [], {})
"""Values that stand nowhere in the place of a number, a text or null."""


@pytest.fixture(scope="module")
def document(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A run of two stages, as if it had failed and left a checkpoint."""
    # On a foundation contacts make no energy, which would end the run.
    scene = wear_times(speed=60.0, conventions=CONVENTIONS["refined"])
    scene = replace(scene, engine="dae", cycles=5, wear_updates=1)
    path = tmp_path_factory.mktemp("result") / "run"
    run(scene, path)
    found = read_document(path)
    finding = {"kind": "wear", "what": "a", "time_s": 1.0, "joint": "", "remedy": ""}
    found["stages"][1]["finding"] = finding
    found["checkpoint"] = {"turn": 2, "words": "stage 1", "index": 1}
    found["files"]["checkpoint-2.npz"] = 64 * "0"
    found["provenance"]["resumed"] = [{"started": "now", "machine": "this"}]
    return found


def places(owner: Any, *keys: str | int) -> Iterator[tuple[Any, tuple[str | int, ...]]]:
    """Every part of nested data: what holds it, and its place."""
    for key in owner if isinstance(owner, dict) else range(len(owner)):
        if key in ("scene", "digest", "schema"):  # others look at these
            continue
        if isinstance(owner[key], dict | list):
            yield from places(owner[key], *keys, key)
        yield owner, (*keys, key)


def test_a_sound_document_is_read_and_keeps_all(document: dict[str, Any]) -> None:
    stored = stored_result(document, FILE_PATH)
    check_joints(stored, JOINTS, 1, FILE_PATH)
    for stage, told in zip(stored.stages, document["stages"], strict=True):
        assert plain(stage.as_dict()["statistics"]) == told["statistics"]
        assert repr(stage.diagnostics) == repr(told["diagnostics"])
    assert stored.provenance == document["provenance"]


def test_nothing_of_another_kind_is_read(document: dict[str, Any]) -> None:
    """In the place of each value and of each part stands what can be none."""
    here, read = copy.deepcopy(document), []
    for owner, place in places(here):
        whole = owner[place[-1]]
        for other in NO_LEAVES:
            if type(whole) is not type(other):
                owner[place[-1]] = other
                with suppress(InputError):
                    stored_result(here, FILE_PATH)
                    read.append((*place, other))
        owner[place[-1]] = whole
    assert here == document
    assert read == []


OPEN = {
    "conventions",
    "packages",
    "resumed",
    "diagnostics",
    "joints",
    "low",
    "high",
    "samples",
    "step_error",
    *(field.name for field in fields(StageStatistics) if field.name != "cycles"),
}
"""Parts that hold what there is, each under its name."""


def test_what_is_missing_is_named(document: dict[str, Any]) -> None:
    for _, place in places(document):
        if isinstance(place[-1], str) and not OPEN.intersection(place):
            here: Any = copy.deepcopy(document)
            owner = here
            for key in place[:-1]:
                owner = owner[key]
            del owner[place[-1]]
            with pytest.raises(InputError, match=r"^result\.json: ") as refused:
                check_joints(stored_result(here, FILE_PATH), JOINTS, 1, FILE_PATH)
            assert place[-1] in str(refused.value)


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda d: d["stages"].reverse(), r"stages\[0\]\.index is 1; 0 is expected"),
        (lambda d: d["stages"].append(d["stages"][0]), r"stages\[2\]\.index is 0; 2 is expected"),
        (lambda d: d["stages"].pop(), r"'files' has 'film-1\.npz', unlike its stages"),
        (lambda d: d["files"].update({"../x": ""}), r"'files' has '\.\./x', unlike its stages"),
        (lambda d: d["checkpoint"].update(turn=3), "checkpoint.turn: Invalid enum value 3"),
        (lambda d: d.update(status="fine"), "status: Invalid enum value 'fine'"),
        (
            lambda d: _step(d)["max_depth"].update(B={}),
            r"stages\[0\] tells of joints A, C, B, where",
        ),
        (
            lambda d: _step(d)["max_depth"]["A"].update(rod=1.0),
            r"stages\[0\]\.wear_steps tells of bearing, pin, rod;",
        ),
        (
            lambda d: d["stages"][0]["statistics"]["joints"].pop("C"),
            r"stages\[0\] tells of joints A, where the scene has clearance at A, C",
        ),
    ],
)
def test_what_does_not_fit_together_is_told(
    document: dict[str, Any], edit: Callable[[Any], object], says: str
) -> None:
    here = copy.deepcopy(document)
    edit(here)
    with pytest.raises(InputError, match=rf"^result\.json: {says}"):
        check_joints(stored_result(here, FILE_PATH), JOINTS, 1, FILE_PATH)


def _step(document: Any) -> Any:
    return document["stages"][0]["wear_steps"][0]


def test_more_stages_than_wears_are_refused(document: dict[str, Any]) -> None:
    stored = stored_result(document, FILE_PATH)
    with pytest.raises(InputError, match="2 stages, where the scene has wear_updates = 0"):
        check_joints(stored, JOINTS, 0, FILE_PATH)


def _restored(path: Path, **parts: object) -> Result:
    """A folder without stages, read back."""
    document = {
        "schema": SCHEMA,
        "scene": {},
        "conventions": {},
        "engine": "exudyn",
        "provenance": provenance(),
        "status": "running",
        "message": "",
        "wall_s": 0.0,
        "life": None,
        "stages": [],
        "files": {},
        "checkpoint": None,
    }
    write_json(path / FILE, {**document, **parts})
    return load(path)


def test_scenes_say_which_mechanism_they_hold(tmp_path: Path) -> None:
    scene = plain(slider_crank().as_dict())
    told = {key: scene[key] for key in ("engine", "conventions")}
    assert _restored(tmp_path, scene=scene, **told).scene == slider_crank()
    with pytest.raises(InputError, match="'engine' is not what it is in 'scene', 'exudyn'"):
        _restored(tmp_path, scene=scene, conventions=told["conventions"], engine="dae")
    with pytest.raises(InputError, match="'conventions' is not what it is in 'scene'"):
        _restored(tmp_path, scene=scene)


@pytest.mark.parametrize(
    ("scene", "says"),
    [
        ({"mechanism": {}}, "'joints' is missing"),
        ({"press": {}}, "'joints' is missing"),
        (3, "scene: Expected `object`, got `int`"),
    ],
)
def test_what_is_no_scene_is_refused(tmp_path: Path, scene: object, says: str) -> None:
    with pytest.raises(InputError, match=f"{FILE}: .*{says}"):
        _restored(tmp_path, scene=scene)


@pytest.mark.parametrize("text", ["", "[]", '{"schema": 99}', '{"schema": 9}', "{", "\x00\xff"])
def test_a_folder_that_holds_no_result_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=FILE):
        load(tmp_path)


ROWS, BINS = 5, 36
STAGE = {
    "time": np.arange(float(ROWS)),
    "slider": np.zeros((ROWS, 3)),
    "drive_torque": np.zeros((ROWS, 1)),
    "angle": bin_centres(BINS),
    "wear_batch_cycles": np.ones(2),
    "cycles": np.zeros((3, 19)),
    "cycle_start": np.zeros(3),
    "deviation": np.zeros((4, 4)),
    "deviation_start": np.zeros(4),
    "A_eccentricity": np.zeros((ROWS, 2)),
    "A_penetration": np.zeros(ROWS),
    "A_force": np.zeros((ROWS, 2)),
    "A_sliding": np.zeros(ROWS),
    "A_flight": np.zeros(4),
    "A_depth_bearing": np.zeros(BINS),
    "A_depth_pin": np.zeros(BINS),
    "A_wear_bearing": np.zeros(BINS),
    "A_wear_pin": np.zeros(BINS),
    "A_wear_batches": np.zeros((2, 2, BINS)),
    "A_contacts": np.zeros((9, 6)),
}


@pytest.mark.parametrize("name", STAGE)
def test_arrays_that_are_missing_or_misshapen_are_named(name: str) -> None:
    file = Path("stage-0.npz")
    check_arrays(STAGE, {"A": BINS}, 1, file)
    check_arrays({**STAGE, "more": np.zeros(7)}, {"A": BINS}, 1, file)
    less = {key: values for key, values in STAGE.items() if key != name}
    if name != "drive_torque":
        with pytest.raises(InputError, match=f"stage-0.npz: the array {name} is missing"):
            check_arrays(less, {"A": BINS}, 1, file)
    whole = STAGE[name]
    # Contacts are as many as there were.
    for wrong in (whole[np.newaxis], whole[:-1] if name != "A_contacts" else whole[:, 1:]):
        with pytest.raises(InputError, match=r"stage-0\.npz: (\w+ has the shape|angle does not)"):
            check_arrays({**STAGE, name: wrong}, {"A": BINS}, 1, file)
    for value in (np.nan, np.inf, -np.inf, 1e101):
        wrong = whole.copy()
        wrong.flat[-1] = value
        with pytest.raises(InputError, match=f"stage-0.npz: {name} holds a value that is not"):
            check_arrays({**STAGE, name: wrong}, {"A": BINS}, 1, file)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("slider", np.zeros((3, 3)), r"slider has the shape \(3, 3\); \(5, 3\) is expected"),
        ("cycles", np.zeros((3, 8)), r"cycles has the shape \(3, 8\); \(3, 19\) is expected"),
        ("time", -STAGE["time"], "time goes backwards"),
        ("time", STAGE["time"] - 1.0, "time goes backwards"),
        ("angle", np.zeros(BINS), "angle does not hold the middles of 36 bins"),
        ("angle", bin_centres(35), r"angle has the shape \(35,\); \(36\) is expected"),
        ("A_depth_pin", np.full(BINS, -1e-6), "A_depth_pin holds a depth below zero"),
        ("A_wear_bearing", np.full(BINS, -1e-6), "A_wear_bearing holds a depth below zero"),
    ],
)
def test_what_is_wrong_with_an_array_is_said(name: str, value: Any, says: str) -> None:
    with pytest.raises(InputError, match=f"stage-0.npz: {says}"):
        check_arrays({**STAGE, name: value}, {"A": BINS}, 1, Path("stage-0.npz"))
