"""Runs stopped at random moments and resumed, compared with an undisturbed run."""

import contextlib
import json
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from endurance.sameness import folder_differences
from endurance.subject import (
    IN_HOUSE,
    SEED,
    SUBJECTS,
    Alone,
    Subject,
    Trial,
    checkpoint_of,
    end,
    is_at_work,
    is_one_line,
    resume_option,
    wait_for,
)

MOST_RUNS = 4  # runs for each requested stop: some end before they are stopped
Runs = Callable[[Subject], Alone]
STOPS = 4  # of one run, at most


def stop(
    subject: Subject, out: Path, number: signal.Signals, after: float
) -> str | None:
    """Stop a run after a time, s; return the problem, or None if it ended before."""
    process = subject.start(out, *resume_option(out))
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(after)
    had_started = is_at_work(process, out)
    process.send_signal(number)
    answer = end(process)
    if answer.code == 0:
        return None
    # A kill, or a signal while Python itself starts, ends the process at once.
    if answer.code == -number and (number == signal.SIGKILL or not had_started):
        return ""
    is_line = not had_started or "\n" not in answer.errors.strip()
    is_expected = number != signal.SIGKILL and answer.code == 128 + number and is_line
    return "" if is_expected else f"stopped, {answer.problem}"


def kill(
    trial: Trial, number: signal.Signals, count: int, alone: Runs, folder: Path
) -> None:
    """Stop runs of all engines in turn, ``count`` times in all; each is resumed until its end."""
    wait = Random(SEED)
    longest: dict[Subject, float] = {}
    runs = 0
    while trial.attempts < count and runs < MOST_RUNS * count:
        subject = SUBJECTS[runs % len(SUBJECTS)]
        out = folder / f"run-{runs}"
        runs += 1
        whole = alone(subject)
        most = longest.setdefault(subject, whole.lasts)
        stops = 0
        problems: list[str] = []
        while stops < min(STOPS, count - trial.attempts):
            began = time.monotonic()
            problem = stop(subject, out, number, wait.uniform(0.0, most))
            if problem is None:
                break
            stops += 1
            problems.append(problem)
        else:
            answer = subject.finish(out, *resume_option(out))
            problems.append(answer.problem if answer.code else "")
        if not stops:
            # The undisturbed run may have waited for the compiler.
            longest[subject] = min(most, time.monotonic() - began)
            continue
        wrong = [text for text in problems if text] or folder_differences(
            whole.folder, out
        )[:3]
        trial.add(f"{subject.engine}: {'; '.join(wrong)}" if wrong else "", stops)
    trial.check()
    assert trial.attempts == count, f"only {trial.attempts} stops"


@pytest.mark.endurance
@pytest.mark.parametrize(
    ("number", "count", "few"),
    [(signal.SIGKILL, 50, 3), (signal.SIGINT, 20, 2), (signal.SIGTERM, 20, 2)],
)
def test_stops_at_random_moments(
    number: signal.Signals,
    count,
    few,
    trial: Trial,
    alone: Runs,
    tmp_path,
    is_quick,
):
    kill(trial, number, few if is_quick else count, alone, tmp_path)


def test_a_run_stopped_by_a_signal_goes_on(tmp_path):
    """SIGTERM as soon as something is kept: one line, 143, and the command that it names."""
    out = tmp_path / "out"
    process = IN_HOUSE.start(out)
    assert wait_for(lambda: checkpoint_of(out))
    process.send_signal(signal.SIGTERM)
    answer = end(process)
    assert answer.code == 143, answer.problem
    assert is_one_line(answer.errors)
    assert (
        f"continue with: presswear run wear-times --resume --out {out}" in answer.errors
    )
    assert json.loads((out / "result.json").read_text())["status"] == "interrupted"
    assert not (out / "lock").exists()
