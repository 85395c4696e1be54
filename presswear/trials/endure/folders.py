"""Folders that fill up, cannot be written, vanish or are written by two; files that are damaged."""

import os
import random
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from presswear.results.result import load
from presswear.results.sameness import folder_differences
from presswear.tools.errors import InputError
from presswear.tools.lock import holder
from presswear.trials.endure.subject import SUBJECTS, Progress
from presswear.trials.endure.trial import Trial

_QUICK = SUBJECTS[0]
_PATIENCE = 120.0
"""Longest wait for a process to begin, s."""


def one_line(said: str) -> bool:
    """Whether a program ended with one line of its own and no traceback."""
    return len(said.strip().splitlines()) == 1 and said.startswith("presswear: ")


@contextmanager
def _small_disk(place: Path, size: str, options: str = "") -> Iterator[Path]:
    """A file system of its own of so many bytes; OSError where that is not allowed."""
    folder = place / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}{options}", "tmpfs", str(folder)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise OSError("there is no mount") from None
    if done.returncode != 0:
        raise OSError(done.stderr.strip())
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", str(folder)], capture_output=True, check=False)


def _judged(what: str, problems: list[str], tried: int, note: str) -> Trial:
    return Trial(what, tried, tried - min(len(problems), tried), "; ".join(problems) or note)


def disk_full(sizes: tuple[str, ...], progress: Progress) -> Trial:
    """Disks too small for a run: it ends with one line, and on a larger one it goes on."""
    what = "disk full"
    problems: list[str] = []
    with tempfile.TemporaryDirectory() as text:
        place = Path(text)
        whole = place / "whole"
        if _QUICK.finish(whole)[0] != 0:
            return Trial(what, len(sizes), 0, "the run itself fails")
        for k, size in enumerate(sizes):
            progress(f"{what}: {size}", k / len(sizes))
            own = place / size
            own.mkdir()
            try:
                with _small_disk(own, size) as disk:
                    code, said = _stopped(disk / "out")
                    if code not in (1, 2) or not one_line(said) or "space" not in said:
                        problems.append(f"{size}: code {code}: {said.strip()[-200:]}")
                    subprocess.run(["mount", "-o", "remount,size=200m", str(disk)], check=False)
                    code, said = _QUICK.finish(disk / "out", "--resume")
                    if code != 0:
                        problems.append(f"{size}: gone on with code {code}: {said.strip()[-200:]}")
                    else:
                        apart = folder_differences(whole, disk / "out")
                        problems += [f"{size}: {some}" for some in apart[:3]]
            except OSError as error:
                return Trial(what, 0, 0, f"not tried: no disk of its own could be made ({error})")
    return _judged(what, problems, len(sizes), "one line; with room again it goes on, equal")


def _stopped(out: Path, *more: str) -> tuple[int, str]:
    """A run that ends by itself: its exit code, and what it said of errors."""
    process = _QUICK.start(out, *more)
    _, error = process.communicate()
    return process.returncode, error


def read_only(progress: Progress) -> Trial:
    """A folder that cannot be written is refused before anything is computed."""
    what = "read-only folder"
    progress(what, 0.0)
    problems = []
    with tempfile.TemporaryDirectory() as text:
        try:
            with _small_disk(Path(text), "1m", ",ro") as disk:
                code, said = _stopped(disk / "out")
        except OSError as error:
            folder = Path(text) / "closed"
            folder.mkdir(mode=0o500)
            if os.access(folder, os.W_OK):
                return Trial(what, 0, 0, f"not tried: {error}")
            code, said = _stopped(folder / "out")
        if code != 2 or not one_line(said) or "out" not in said:
            problems.append(f"code {code}: {said.strip()[-200:]}")
    return _judged(what, problems, 1, "refused with one line at the start")


def _wait_for(is_so: Callable[[], object]) -> bool:
    """Wait until something is so."""
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        if is_so():
            return True
        time.sleep(0.02)
    return False


def deleted(count: int, seed: int, progress: Progress) -> Trial:
    """A folder that is deleted while a run is at work in it ends the run with one line."""
    what = "folder deleted while running"
    wait = random.Random(seed)
    problems = []
    for k in range(count):
        progress(what, k / count)
        with tempfile.TemporaryDirectory() as text:
            out = Path(text) / "out"
            process = _QUICK.start(out)
            _wait_for((out / "result.json").exists)
            time.sleep(wait.uniform(0.0, 1.0))
            shutil.rmtree(out, ignore_errors=True)
            _, error = process.communicate()
            if process.returncode != 1 or not one_line(error) or str(out) not in error:
                problems.append(f"code {process.returncode}: {error.strip()[-200:]}")
            if out.exists():
                problems.append("something was written into its place")
    return _judged(what, problems, count, "one line, and nothing is written in its place")


def two_runs(count: int, progress: Progress) -> Trial:
    """A second run into a folder is refused and leaves the first alone."""
    what = "two runs into one folder"
    problems = []
    with tempfile.TemporaryDirectory() as text:
        whole, out = Path(text) / "whole", Path(text) / "out"
        _QUICK.finish(whole)
        first = _QUICK.start(out)
        _wait_for(lambda: holder(out))
        for k in range(count):
            progress(what, k / count)
            if first.poll() is not None:
                break
            code, said = _stopped(out, *(("--resume",) if k % 2 else ()))
            if first.poll() is None and (code != 2 or not one_line(said)):
                problems.append(f"code {code}: {said.strip()[-200:]}")
        _, error = first.communicate()
        if first.returncode != 0:
            problems.append(f"the first ended with code {first.returncode}: {error.strip()[-200:]}")
        else:
            problems += folder_differences(whole, out)[:3]
    return _judged(what, problems, count, "the second is refused, the first ends as if alone")


def damaged(count: int, seed: int, progress: Progress) -> Trial:
    """Every file of data, cut off and with one byte changed: found and named."""
    what = "files cut off or altered"
    chance = random.Random(seed)
    tried = 0
    problems = []
    with tempfile.TemporaryDirectory() as text:
        whole, stopped = Path(text) / "whole", Path(text) / "stopped"
        _QUICK.finish(whole)
        process = _QUICK.start(stopped)
        _wait_for(lambda: (stopped / "checkpoint.npz").exists())
        process.kill()
        process.communicate()
        from presswear.results.checkpoint import read_checkpoint

        cases: list[tuple[Path, Callable[[Path], object]]] = [
            (file, load) for file in sorted(whole.glob("*.[jn][sp]*"))
        ]
        cases.append((stopped / "checkpoint.npz", read_checkpoint))
        for k, (file, read) in enumerate(cases):
            progress(f"{what}: {file.name}", k / len(cases))
            sound = file.read_bytes()
            for turn in range(2 * count):
                place = chance.randrange(len(sound))
                bad = sound[:place]
                if turn % 2:
                    bad += bytes([sound[place] ^ (1 << chance.randrange(8))]) + sound[place + 1 :]
                file.write_bytes(bad)
                tried += 1
                try:
                    read(file.parent)
                    problems.append(f"{file.name}, byte {place}: not noticed")
                except InputError as error:
                    if file.name not in str(error):
                        problems.append(f"{file.name}, byte {place}: {error}")
            file.write_bytes(sound)
            file.unlink()
            tried += 1
            try:
                read(file.parent)
                problems.append(f"{file.name}: not missed")
            except InputError as error:
                if file.name not in str(error):
                    problems.append(f"{file.name} gone: {error}")
            file.write_bytes(sound)
        read_checkpoint(stopped)
        load(whole)
    return _judged(what, problems[:5], tried, f"{len(cases)} files; every one is found and named")
