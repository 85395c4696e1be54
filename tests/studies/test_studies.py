"""Studies: running variants, resuming, what is refused; the runaway study's reading."""

import math
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from endurance.sameness import folder_differences

from presswear.__main__ import main
from presswear.campaign.parallel import run_study, run_variant
from presswear.campaign.study import (
    Study,
    Variant,
    is_finished,
    load_study,
    results_of,
    waiting,
)
from presswear.record.tracker import Tracker
from presswear.results.result import load
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.studies import STUDIES
from presswear.studies.runaway.figure import two_wears
from presswear.studies.runaway.variants import Outcome, answer, make, outcome_of
from presswear.tools.errors import InputError


def small(**settings: str) -> Study:
    """Two quick variants: one cycle each in the in-house solver, and one that fails at once."""
    base = changed(
        replace(wear_times(), wears=1, cycles=1), {"engine": "dae", "angles": "16", **settings}
    )
    return Study(
        "small",
        "Two variants",
        "Which?",
        (
            Variant("one", "the first", base),
            Variant("stops", "the paper's step", changed(base, {"integrator": "rk4-paper"})),
        ),
    )


Heard = list[tuple[str, float]]


class Hearing(Tracker):
    """Remembers what it is told of variants."""

    def __init__(self) -> None:
        self.heard: Heard = []

    def variant(self, key: str, part: float, word: str) -> None:
        self.heard.append((key, part))


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Heard]:
    """The small study's folder, and what was told."""
    folder = tmp_path_factory.mktemp("study") / "out"
    hearing = Hearing()
    run_study(small(), folder, 2, False, [hearing])
    return folder, hearing.heard


def test_every_variant_has_its_folder(ran: tuple[Path, Heard]) -> None:
    folder, heard = ran
    found = {v.key: result for v, result in results_of(small(), folder)}
    one, stops = found["one"], found["stops"]
    assert one is not None
    assert one.status == "completed"
    assert len(one.stages) == 2
    assert stops is not None
    assert stops.status == "failed"
    assert ("one", 1.0) in heard
    parts = [part for key, part in heard if key == "one"]
    assert parts == sorted(parts)


def test_resuming_keeps_what_is_finished(ran: tuple[Path, Heard]) -> None:
    folder, _ = ran
    before = (folder / "one" / "result.json").stat().st_mtime_ns
    assert waiting(small(), folder, resume=True) == []
    run_study(small(), folder, 1, True)
    assert (folder / "one" / "result.json").stat().st_mtime_ns == before


def test_an_interrupted_variant_goes_on_where_it_stood(
    ran: tuple[Path, Heard], tmp_path: Path
) -> None:
    folder = tmp_path / "study"
    study = small()
    whole, _ = ran
    heard = 0

    def interrupt(part: float, word: str) -> None:
        nonlocal heard
        heard += part > 0.5
        if heard > 3:
            raise KeyboardInterrupt

    shutil.copytree(whole, folder)
    shutil.rmtree(folder / "one")
    with pytest.raises(KeyboardInterrupt):
        run_variant(folder / "one", study.variants[0].scene, 0.0, interrupt)
    assert list((folder / "one").glob("checkpoint-*.npz"))
    assert [variant.key for variant in waiting(study, folder, resume=True)] == ["one"]
    run_study(study, folder, 1, True)
    assert folder_differences(folder / "one", whole / "one") == []
    assert "resumed" in load(folder / "one").provenance


def test_other_runs_in_the_folder_are_refused(ran: tuple[Path, Heard]) -> None:
    folder, _ = ran
    with pytest.raises(InputError, match="not empty"):
        waiting(small(), folder, resume=False)
    with pytest.raises(InputError, match=r"another study .one differs"):
        waiting(small(friction="0.3"), folder, resume=True)
    assert (folder / "one" / "result.json").exists()


def outcome(label: str, first: float, second: float, failure: str = "") -> Outcome:
    variant = Variant(label, label, wear_times())
    return Outcome(variant, {"A": first}, {"A": second}, (100.0,), 1e-9, failure)


def test_the_answer_names_what_runs_away_and_what_stops() -> None:
    calm, away = outcome("calm", 1e-5, 2e-5), outcome("wild", 1e-5, 3e-4)
    stopped = outcome("broken", math.nan, math.nan, "it stopped")
    assert (calm.runs_away, away.runs_away, stopped.runs_away) == (False, True, None)
    text = answer([calm, away, stopped], 8e-4)
    assert "1 of 2 readings" in text
    assert "does run away under: wild (300 µm, 30 times the first)" in text
    assert "Not to be computed at all: broken" in text
    assert "run away under" not in answer([calm], 8e-4)
    assert "nothing can be said" in answer([stopped], 8e-4)


def test_outcomes_are_read_from_results(ran: tuple[Path, Heard]) -> None:
    folder, _ = ran
    outcomes = [outcome_of(v, result) for v, result in results_of(small(), folder)]
    one, stops = outcomes
    result = next(iter(results_of(small(), folder)))[1]
    assert result is not None
    for wear, stage in ((one.first, 0), (one.second, 1)):
        for joint in ("A", "C"):
            deepest = max(
                result.stages[stage].arrays[f"{joint}_wear_{side}"].max()
                for side in ("bearing", "pin")
            )
            assert wear[joint] == deepest > 0.0
    assert math.isnan(stops.growth)
    assert "t = " in stops.failure
    drawing = two_wears(outcomes, 8e-4)
    assert len(drawing.sheet.axes) == 2


def test_runaway_changes_one_thing_at_a_time_and_only_what_it_says() -> None:
    study = make()
    assert study.name in STUDIES
    paper = study.variants[0].scene
    keys = [variant.key for variant in study.variants]
    assert len(set(keys)) == len(keys)
    for variant in study.variants[1:5]:
        scene = variant.scene
        changes = [
            getattr(scene.conventions, name) != getattr(paper.conventions, name)
            for name in ("stiffness", "slip", "map_frame", "footprint", "contact")
        ]
        assert sum(changes) + (scene.extrapolation != paper.extrapolation) == 1
    for variant in study.variants:
        # The second wear in steps needs the stage behind it.
        assert variant.scene.wears == (2 if variant.scene.wears_in_steps else 1)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "runaway", "--jobs", "0"], "--jobs 0: a whole number from 1 to 256"),
        (["run", "paper", "--jobs", "two"], "--jobs two: a whole number from 1 to 256"),
        (["run", "runaway", "--resume"], "--out"),
        (["run", "wear-times", "--jobs", "2"], "for studies"),
        (["run", "wear-times", "--resume"], "--out"),
        (["run", "wear-times", "--checkpoint", "soon"], "--checkpoint soon: a number of seconds"),
        (["run", "runaway", "--checkpoint", "-1"], "--checkpoint -1: a number of seconds"),
        (["run", "runaway", "--set", "nonsense=1"], "unknown key"),
        (["list", "runaway"], "study"),
    ],
)
def test_bad_options_of_a_study(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    told = capsys.readouterr().err
    assert words in told
    assert len(told.splitlines()) == 1


def test_a_study_stops_at_once_and_keeps_what_is_finished(tmp_path: Path) -> None:
    """Ctrl-C while two runs are at work: out within a second, finished runs stay, one line."""
    out = tmp_path / "study"
    # More variants than a pipe holds.
    command = [
        sys.executable,
        "-m",
        "presswear",
        "run",
        "paper",
        "--engine",
        "dae",
        "--cycles",
        "1",
    ]
    process = subprocess.Popen(
        [*command, "--jobs", "2", "--out", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120.0
    while not any(map(is_finished, out.glob("*"))) and time.monotonic() < deadline:
        time.sleep(0.05)
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    error = process.communicate(timeout=20)[1]
    assert time.monotonic() - began < 5.0
    assert process.returncode == 130, error
    assert f"presswear run paper --resume --out {out}" in error
    assert error.count("\n") == 1
    study = load_study(out)
    finished = [v for v in study.variants if is_finished(out / v.key)]
    assert finished
    left = waiting(study, out, resume=True)
    assert {v.key for v in left} | {v.key for v in finished} == {v.key for v in study.variants}


def test_a_stored_study_is_the_same_study(ran: tuple[Path, Heard]) -> None:
    folder, _ = ran
    assert load_study(folder) == small()
    with pytest.raises(InputError, match="no study"):
        load_study(folder / "one")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "cannot be read"),
        ('{"schema": 99}', "schema 99"),
        ('{"schema": 2}', "missing required field"),
    ],
)
def test_a_damaged_study_is_named(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "study.json").write_text(text)
    with pytest.raises(InputError, match=words):
        load_study(tmp_path)
