"""Folders that fill up, are read-only, vanish or have two writers; damaged files."""

import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from random import Random

import pytest

from endurance import subject
from endurance.sameness import folder_differences
from presswear.results.result import load
from presswear.tools.errors import InputError

Runs = Callable[[subject.Subject], subject.Alone]


@contextmanager
def small_disk(folder: Path, size: str, options: str = "") -> Iterator[Path]:
    """Mount a file system of some bytes; skip the test where that is not allowed."""
    folder.mkdir()
    command = [
        "mount",
        "-t",
        "tmpfs",
        "-o",
        f"size={size}{options}",
        "tmpfs",
        str(folder),
    ]
    if (
        not shutil.which("mount")
        or subprocess.run(command, capture_output=True).returncode
    ):
        pytest.skip("no file system can be mounted")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], capture_output=True, check=False)


@pytest.mark.endurance
def test_disk_full(trial: subject.Trial, alone: Runs, tmp_path, is_quick):
    whole = alone(subject.TREE).folder
    for size in ("600k",) if is_quick else ("16k", "300k", "600k", "900k", "1200k"):
        with small_disk(tmp_path / size, size) as disk:
            problems = []
            answer = subject.TREE.finish(disk / "out")
            described = subject.is_one_line(answer.errors) and "space" in answer.errors
            if answer.code not in (1, 2) or not described:
                problems.append(answer.problem)
            subprocess.run(["mount", "-o", "remount,size=200m", str(disk)], check=True)
            answer = subject.TREE.finish(
                disk / "out", *subject.resume_option(disk / "out")
            )
            if answer.code != 0:
                problems.append(f"resumed, {answer.problem}")
            else:
                problems += folder_differences(whole, disk / "out")[:3]
            trial.add(f"{size}: {'; '.join(problems)}" if problems else "")
    trial.check()


@pytest.mark.endurance
def test_read_only_folder(trial: subject.Trial, tmp_path):
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    if os.access(closed, os.W_OK):  # as root
        with small_disk(tmp_path / "disk", "1m", ",ro") as disk:
            answer = subject.TREE.finish(disk / "out")
    else:
        answer = subject.TREE.finish(closed / "out")
    is_named = subject.is_one_line(answer.errors) and "out" in answer.errors
    trial.add("" if answer.code == 2 and is_named else answer.problem)
    trial.check()


@pytest.mark.endurance
def test_folder_deleted_while_running(trial: subject.Trial, tmp_path, is_quick):
    wait = Random(subject.SEED)
    for k in range(1 if is_quick else 5):
        out = tmp_path / f"out-{k}"
        process = subject.TREE.start(out)
        subject.wait_for((out / "result.json").exists)
        time.sleep(wait.uniform(0.0, 1.0))
        shutil.rmtree(out, ignore_errors=True)
        answer = subject.end(process)
        is_named = subject.is_one_line(answer.errors) and str(out) in answer.errors
        wrong = "" if answer.code == 1 and is_named else answer.problem
        trial.add("something was written into its place" if out.exists() else wrong)
    trial.check()


@pytest.mark.endurance
def test_two_runs_into_one_folder(
    trial: subject.Trial, alone: Runs, tmp_path, is_quick
):
    out = tmp_path / "out"
    first = subject.TREE.start(out)
    subject.wait_for(lambda: subject.is_at_work(first, out))
    for k in range(1 if is_quick else 3):
        second = subject.TREE.finish(out, *(("--resume",) if k % 2 else ()))
        is_refused = second.code == 2 and subject.is_one_line(second.errors)
        trial.add("" if is_refused or first.poll() is not None else second.problem)
    answer = subject.end(first)
    assert answer.code == 0, answer.problem
    assert folder_differences(alone(subject.TREE).folder, out) == []
    trial.check()


def missed(check: Callable[[Path], object], file: Path) -> str:
    try:
        check(file.parent)
    except InputError as error:
        return "" if file.name in str(error) else f"{error}"
    return "not noticed"


@pytest.mark.endurance
def test_damaged_files(trial: subject.Trial, alone: Runs, tmp_path, is_quick):
    """Every file of data is cut off, changed in a bit, and removed."""
    whole = tmp_path / "whole"
    stopped = tmp_path / "stopped"
    shutil.copytree(alone(subject.TREE).folder, whole)
    process = subject.TREE.start(stopped)
    subject.wait_for(lambda: subject.checkpoint_of(stopped))
    process.kill()
    subject.end(process)
    files = [*whole.glob("*.json"), *sorted(whole.glob("*.npz"))]
    cases: list[tuple[Callable[[Path], object], Path]] = [
        (load, file) for file in files
    ]
    checkpoint = subject.checkpoint_of(stopped)
    assert checkpoint is not None
    cases.append((subject.check_checkpoint, checkpoint))
    chance = Random(subject.SEED)
    for check, file in cases:
        data = file.read_bytes()
        for _ in range(5 if is_quick else 100):
            place = chance.randrange(len(data))
            flipped = bytes([data[place] ^ (1 << chance.randrange(8))])
            altered = data[:place] + flipped + data[place + 1 :]
            # result.json holds the digests of the arrays and has none of its own.
            for bad in [data[:place]] + (
                [altered] if file.name != "result.json" else []
            ):
                file.write_bytes(bad)
                wrong = missed(check, file)
                trial.add(f"{file.name}, byte {place}: {wrong}" if wrong else "")
        file.unlink()
        wrong = missed(check, file)
        trial.add(f"{file.name} gone: {wrong}" if wrong else "")
        file.write_bytes(data)
        check(file.parent)
    trial.check()
