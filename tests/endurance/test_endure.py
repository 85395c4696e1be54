"""Trials of endurance: that they see a loss, the command, and a few of them for real."""

import json
import signal
import time
from pathlib import Path

import pytest

from presswear.__main__ import main
from presswear.trials.endure import kills, memory, trials
from presswear.trials.endure.folders import (
    damaged,
    deleted,
    disk_full,
    one_line,
    read_only,
    two_runs,
)
from presswear.trials.endure.memory import Size, bounded
from presswear.trials.endure.subject import SUBJECTS, Progress
from presswear.trials.endure.trial import Trial


def silent(word: str, part: float) -> None:
    assert 0.0 <= part <= 1.0


def test_a_run_stopped_by_a_signal_goes_on(tmp_path: Path) -> None:
    """SIGTERM as soon as something is kept: one line, 143, and the command that it names."""
    subject = SUBJECTS[1]
    out = tmp_path / "out"
    process = subject.start(out)
    end = time.monotonic() + 100.0
    while not (out / "checkpoint.npz").exists() and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(signal.SIGTERM)
    _, error = process.communicate(timeout=60)
    assert process.returncode == 143, error
    assert one_line(error)
    assert f"go on with: presswear run wear-times --resume --out {out}" in error
    document = json.loads((out / "result.json").read_text())
    assert document["status"] == "interrupted"
    assert not (out / "lock").exists()


def test_a_kill_that_loses_something_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the folders differ at the end no stop of that run counts as survived."""

    def stopped(chain: kills._Chain, number: signal.Signals, most: int, *rest: object) -> None:
        chain.stops = most

    monkeypatch.setattr(kills._Chain, "run", stopped)
    monkeypatch.setattr(type(SUBJECTS[0]), "finish", lambda *arguments: (0, ""))
    for apart, survived in (([], 5), (["stage-0.npz: slider differs"], 0)):
        monkeypatch.setattr(kills, "folder_differences", lambda *paths, apart=apart: apart)
        trial = kills.killed(signal.SIGKILL, 5, 1, silent)
        assert (trial.tried, trial.survived) == (5, survived)
    assert "slider differs" in trial.note


@pytest.mark.parametrize(
    ("second", "survived"),
    [(Size(1090, 109), 1), (Size(1110, 100), 0), (Size(1000, 111), 0)],
)
def test_growth_of_memory_and_files_is_seen(
    second: Size, survived: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sizes = {1: Size(5000, 1), 10: Size(1000, 100), 100: second}
    monkeypatch.setattr(memory, "size_of", lambda engine, cycles: sizes[cycles])
    assert bounded("dae", 10, 100, silent).survived == survived


def test_one_line_is_one_line() -> None:
    assert one_line("presswear: no space\n")
    assert not one_line("presswear: no space\nTraceback\n")
    assert not one_line("Traceback\n")
    assert not one_line("")


@pytest.mark.parametrize("survived", [2, 1])
def test_the_command_prints_and_stores_its_table(
    survived: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def attempts(quick: bool) -> tuple[trials.Attempt, ...]:
        assert quick

        def attempt(progress: Progress) -> Trial:
            return Trial("a flood", 2, survived, "wet")

        return (attempt, lambda progress: Trial("a fire", 0, 0, "not tried"))

    monkeypatch.setattr(trials, "attempts", attempts)
    out = tmp_path / "endured.json"
    assert main(["endure", "--quick", "--out", str(out)]) == 2 - survived
    assert "a flood" in capsys.readouterr().out
    stored = json.loads(out.read_text())["trials"]
    assert stored[0] == {"what": "a flood", "tried": 2, "survived": survived, "note": "wet"}
    assert main(["endure", "--out", str(out)]) == 2
    assert "a new file" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_random_stops_are_survived(number: signal.Signals) -> None:
    trial = kills.killed(number, 6, trials.SEED, silent)
    assert trial.tried == 6
    assert trial.survived == 6, trial.note


@pytest.mark.slow
def test_folders_are_survived() -> None:
    found = [
        disk_full(("600k",), silent),
        read_only(silent),
        deleted(1, 1, silent),
        two_runs(2, silent),
        damaged(10, 1, silent),
    ]
    for trial in found:
        assert trial.survived == trial.tried, trial


@pytest.mark.slow
def test_ten_times_the_cycles_take_no_more_memory() -> None:
    trial = bounded("dae", 20, 200, silent)
    assert trial.survived == 1, trial.note
