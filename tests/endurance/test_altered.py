"""Results that were altered and sealed anew: refused in one line, and nothing in them executed."""

import shutil
from pathlib import Path
from random import Random

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
    line = ["run", "wear-times", "--engine", "dae", "--cycles", "1", "--wear-updates", "1"]
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
