"""Studies on the command line: options that are refused, and Ctrl-C."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from presswear.__main__ import main
from presswear.studies.plan import is_finished, load_study, waiting


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "runaway", "--jobs", "0"], "--jobs 0: a whole number from 1 to 256"),
        (["run", "paper", "--jobs", "two"], "--jobs two: a whole number from 1 to 256"),
        (["run", "runaway", "--resume"], "--out"),
        (["run", "wear-times", "--jobs", "257"], "--jobs 257: a whole number from 1 to 256"),
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
    """Ctrl-C while two runs are at work: nothing more is run, finished runs stay, one line."""
    out = tmp_path / "study"
    # More variants than a pipe holds.
    command = "-m presswear run paper --engine dae --cycles 1 --jobs 2 --out"
    process = subprocess.Popen(
        [sys.executable, *command.split(), str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 120.0
    while not any(map(is_finished, out.glob("*"))) and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    error = process.communicate(timeout=120)[1]
    assert process.returncode == 130, error
    assert f"presswear run paper --resume --out {out}" in error
    assert error.count("\n") == 1
    study = load_study(out)
    finished = [v for v in study.variants if is_finished(out / v.key)]
    assert finished
    left = waiting(study, out, resume=True)
    assert left
    assert {v.key for v in left} | {v.key for v in finished} == {v.key for v in study.variants}
