"""Results that were altered and sealed anew: refused in one line, and nothing in them executed."""

import math
import shutil
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from endurance.forgery import (
    ALTERATIONS,
    MARK,
    arrays_of,
    document_of,
    executable_array,
    no_document,
)
from endurance.subject import answered
from endurance.trial import SEED, Trial


def readers(folder: Path, table: Path) -> tuple[list[str], ...]:
    """The commands that read a result folder, ``table`` being one to compare with."""
    return (
        ["report", str(folder)],
        ["export", str(folder), str(table.with_name("new.csv"))],
        ["crosscheck", str(folder), "--against", str(table)],
    )


def copied(sound: Path, place: Path) -> Path:
    """A copy of what a result is read from."""
    return Path(shutil.copytree(sound, place, ignore=shutil.ignore_patterns("figures", "*.html")))


def refuse(trial: Trial, sound: Path, here: Path, count: int, seed: int) -> None:
    """Alter so many copies of a result and give them to the commands that read it, in turn."""
    trial.what = "altered results, sealed anew, refused with one line and exit code 2"
    copy, table = here / "copy", here / "table.csv"
    assert answered(["export", str(sound), str(table)]).code == 0
    commands = readers(copy, table)
    trial.note = f"read by {len(commands)} commands in turn; nothing executed, nothing written"
    for place in range(count):
        alter = ALTERATIONS[place % len(ALTERATIONS)]
        shutil.rmtree(copy, ignore_errors=True)
        alter(Random(f"{seed} {place}"), copied(sound, copy))
        before = sorted(here.rglob("*"))
        found = answered(commands[place // len(ALTERATIONS) % len(commands)])
        wrong = "" if found.is_refusal else found.problem
        if "checksum" in found.errors and alter is not no_document:
            wrong = "its checksum does not fit: nothing behind that was tried"
        if sorted(here.rglob("*")) != before:
            wrong = wrong or "something was written"
        trial.add(f"{alter.__name__}, case {place} of seed {seed}: {wrong}" if wrong else "")


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result folder: a cycle, a wear, a cycle, in the in-house solver."""
    folder = tmp_path_factory.mktemp("sound") / "out"
    line = ["run", "wear-times", "--engine", "dae", "--cycles", "1", "--wears", "1"]
    assert answered([*line, "--out", str(folder)]).code == 0
    return folder


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to be in, in which what is executed leaves its mark."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def copy(sound: Path, here: Path) -> Path:
    return copied(sound, here / "copy")


def test_altered_results_are_refused_in_one_line(sound: Path, here: Path) -> None:
    trial = Trial()
    refuse(trial, sound, here, 10 * len(ALTERATIONS), seed=1)
    assert trial.passed, trial.miss


@pytest.mark.endurance
def test_many_altered_results(trial: Trial, sound: Path, here: Path, is_quick: bool) -> None:
    refuse(trial, sound, here, 120 if is_quick else 3000, SEED)
    assert trial.passed, trial.miss


def test_a_result_sealed_anew_is_read(copy: Path, here: Path) -> None:
    """What is altered and refused is so for its alteration alone."""
    table = here / "table.csv"
    with arrays_of(copy, "stage-0.npz") as arrays:
        arrays["extra"] = np.zeros(3)
    with document_of(copy) as document:
        document["scene"]["title"] = "Another"
    assert answered(["export", str(copy), str(table)]).code == 0
    for line in readers(copy, table):
        answer = answered(line)
        assert answer.code == 0, answer.problem
    assert "Another" in (copy / "report.html").read_text()


def test_what_would_be_executed_is_not(copy: Path, here: Path) -> None:
    """The trap works for whoever allows pickles, and does not for us."""
    executable_array(Random(3), copy)
    answer = answered(["report", str(copy)])
    assert answer.is_refusal
    assert "npz cannot be read" in answer.errors
    assert not (here / MARK).exists()
    for file in copy.glob("stage-*.npz"):
        with np.load(file, allow_pickle=True) as stored:
            for name in stored.files:
                _ = stored[name]
    assert (here / MARK).exists()


@pytest.mark.parametrize(
    ("part", "edit", "says"),
    [
        ("", {"schema": True}, "schema True; this version reads 4"),
        ("", {"schema": 5}, "schema 5; this version reads 4"),
        ("", {"engine": "exudyn"}, "'engine' is not what it is in 'scene', 'dae'"),
        ("", {"conventions": {}}, "'conventions' is not what it is in 'scene'"),
        ("", {"wall_s": "1"}, "wall_s: Expected `float`, got `str`"),
        ("", {"provenance": {}}, "provenance: Object missing required field `python`"),
        ("stages", {"index": -1}, "stages[0].index is -1; 0 is expected"),
        ("stages", {"index": 1}, "stages[0].index is 1; 0 is expected"),
        ("stages", {"index": "../0"}, "stages[0].index: Expected `int`, got `str`"),
        ("stages", {"statistics": {"cycles": True}}, "stages[0].statistics.cycles: Expected `int`"),
        ("stages", {"statistics": {"cycles": 1}}, "missing required field `energy_residual_J`"),
        ("scene", {"wears": 0}, "2 stages, where the scene has wears = 0"),
        ("scene", {"cycles": 10**400}, "is no finite number up to 1e+300"),
        ("scene", {"bearings": {}}, "'clearance' is missing"),
    ],
)
def test_what_is_wrong_with_a_document_is_said(
    copy: Path, part: str, edit: dict[str, Any], says: str
) -> None:
    with document_of(copy) as document:
        owner = document[part] if part else document
        (owner[0] if isinstance(owner, list) else owner).update(edit)
    answer = answered(["report", str(copy)])
    assert answer.is_refusal
    assert "result.json" in answer.errors
    assert says in answer.errors


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("time", None, "the array time is missing"),
        ("slider", np.zeros((3, 3)), "slider has the shape (3, 3); ("),
        ("angle", np.zeros(360), "angle does not hold the middles of 360 bins"),
        ("angle", np.arange(359.0), "angle does not hold"),
        ("A_depth_pin", np.full(360, -1e-6), "A_depth_pin holds a depth below zero"),
        ("C_wear_pin", np.full(360, math.nan), "C_wear_pin holds a value that is not finite"),
        ("extra", np.array(["a"]), "extra holds no real numbers"),
        ("time", np.array([0.0, 0.2, 0.1]), "time goes backwards"),
    ],
)
def test_what_is_wrong_with_the_arrays_is_said(
    copy: Path, name: str, value: Any, says: str
) -> None:
    with arrays_of(copy, "stage-1.npz") as arrays:
        if value is None:
            del arrays[name]
        else:
            arrays[name] = value
    answer = answered(["report", str(copy)])
    assert answer.is_refusal
    assert "stage-1.npz" in answer.errors
    assert says in answer.errors
