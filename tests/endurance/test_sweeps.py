"""Sweeps whose workers, scheduler or submitter are killed at random moments, gone on with."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from random import Random

import pytest
from made_up_rows import MadeUpWork, marked

from endurance.trial import SEED, Trial
from presswear.sweeps.store import Records

pytestmark = pytest.mark.endurance

HERE = Path(__file__).resolve().parents[1]
ROWS, SECONDS = 1000, 0.02


def start(folder: Path, rows: int, on: str = "", deadly: str = "") -> "subprocess.Popen[str]":
    """A process that runs what is left of a sweep."""
    words = [folder / "sweep", f"{rows}", f"{SECONDS}", folder / "marks", deadly, on]
    command = [sys.executable, HERE / "submit_rows.py", *words]
    return subprocess.Popen(
        list(map(str, command)),
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def sealed(folder: Path, rows: int) -> set[int]:
    """Rows that stand in a folder."""
    records = Records(folder / "sweep")
    records.refresh()
    own = MadeUpWork(rows)
    found = {row for row in range(rows) if records.is_sealed(own.shortcut(row))}
    records.close()
    return found


def children(process: int) -> list[int]:
    """Processes that a process has begun, and theirs."""
    with suppress(OSError):
        own = Path(f"/proc/{process}/task/{process}/children").read_text().split()
        return [found for child in map(int, own) for found in (child, *children(child))]
    return []


def problem_of(folder: Path, rows: int, kept: Sequence[tuple[set[int], Mapping[int, int]]]) -> str:
    """What is wrong at the end: a row that is lost, or that ran again once it was sealed."""
    lost = set(range(rows)) - sealed(folder, rows)
    if lost:
        return f"{len(lost)} rows are lost"
    ended = marked(folder / "marks")
    for there, before in kept:
        twice = [row for row in there if ended[row] != before[row]]
        if twice:
            return f"{len(twice)} sealed rows ran again"
    return ""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_submitter(number: signal.Signals, trial: Trial, is_quick: bool, tmp_path: Path) -> None:
    """Nothing is lost, and nothing that is sealed runs again."""
    trial.what = f"{number.name} of a sweep's submitter at a random moment, gone on with"
    rows, stops = (200, 3) if is_quick else (ROWS, 10)
    wait, kept = Random(SEED + number), []
    while trial.tried < stops:
        process = start(tmp_path, rows)
        with suppress(subprocess.TimeoutExpired):
            process.wait(wait.uniform(0.3, 2.0))
        process.send_signal(number)
        out, _ = process.communicate(timeout=30)
        # Processes of a pool end with their parent.
        time.sleep(1.5)
        kept.append((sealed(tmp_path, rows), marked(tmp_path / "marks")))
        trial.add("" if process.returncode else f"it had ended: {out[-200:]}")
        if not process.returncode:
            break
    last = start(tmp_path, rows)
    out, _ = last.communicate(timeout=120)
    assert last.returncode == 0, out
    trial.miss = problem_of(tmp_path, rows, kept)
    again = sum(own - 1 for own in marked(tmp_path / "marks").values())
    trial.note = f"{rows} rows; {again} of those at work ran again"
    assert not trial.miss
    assert again <= 2 * trial.tried
    assert trial.tried >= 2


def test_workers(trial: Trial, is_quick: bool, tmp_path: Path) -> None:
    """A worker that is killed costs what it was at work on."""
    trial.what = "SIGKILL of a sweep's worker at a random moment"
    rows, kills = (200, 2) if is_quick else (ROWS, 8)
    wait, process = Random(SEED), start(tmp_path, rows)
    begun = marked(tmp_path / "marks")
    while process.poll() is None and trial.tried < kills:
        time.sleep(wait.uniform(0.5, 1.0))
        if len(marked(tmp_path / "marks")) <= len(begun):
            continue  # nobody works yet
        begun = marked(tmp_path / "marks")
        # The last are workers: what they come from was there before.
        for worker in children(process.pid)[-1:]:
            with suppress(ProcessLookupError):
                os.kill(worker, signal.SIGKILL)
                trial.add()
    out, _ = process.communicate(timeout=120)
    assert process.returncode == 0, out
    trial.miss = problem_of(tmp_path, rows, [])
    again = sum(own - 1 for own in marked(tmp_path / "marks").values())
    trial.note = f"{rows} rows; {again} of those at work ran again"
    assert not trial.miss
    assert again <= 2 * trial.tried
    assert trial.passed
    assert "ended from outside" in out


MEMORY = """
import resource, sys
from pathlib import Path
from made_up_rows import MadeUpWork
from presswear.sweeps.executors import runner_of
from presswear.sweeps.run import run_rows
from presswear.sweeps.store import Store
work = MadeUpWork(int(sys.argv[2]))
for _ in range(2):
    with Store(Path(sys.argv[1])) as store:
        run_rows(work, store, runner_of("", 1, print), range(work.rows))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
"""


def test_memory(trial: Trial, is_quick: bool, tmp_path: Path) -> None:
    """What a submitter holds does not grow with the rows."""
    few, many = 2000, 20_000 if is_quick else 100_000
    trial.what = f"a sweep of {many} rows beside one of {few}: peak memory of the submitter"
    peaks = []
    for rows in (few, many):
        command = [sys.executable, "-c", MEMORY, str(tmp_path / f"{rows}"), str(rows)]
        path = os.pathsep.join([str(HERE), os.environ.get("PYTHONPATH", "")])
        environment = {**os.environ, "PYTHONPATH": path}
        peaks.append(float(subprocess.check_output(command, env=environment)))
    trial.note = f"{peaks[0]:.0f} and {peaks[1]:.0f} MB"
    trial.add("" if peaks[1] < peaks[0] + 16.0 else "it grows")
    assert trial.passed, trial.note


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator["Cluster"]:
    pytest.importorskip("distributed")
    found = Cluster(tmp_path)
    yield found
    found.end()


class Cluster:
    """A scheduler and two workers of Dask in processes of their own."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._count = folder, 0
        self.scheduler = self._begin("dask_scheduler", "--port", "0", "--no-dashboard")
        self.address = self._told(self.scheduler, r"Scheduler at:\s+tcp://(\S+)")
        self.workers = [self.worker(), self.worker()]

    def _begin(self, tool: str, *words: str) -> "subprocess.Popen[bytes]":
        self._count += 1
        command = [sys.executable, "-m", f"distributed.cli.{tool}", *words]
        path = os.pathsep.join([str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])])
        with (self._folder / f"log-{self._count}").open("wb") as log:
            return subprocess.Popen(
                command,
                cwd=self._folder,
                stdout=log,
                stderr=log,
                env={**os.environ, "PYTHONPATH": path},
            )

    def _told(self, process: "subprocess.Popen[bytes]", pattern: str) -> str:
        log = self._folder / f"log-{self._count}"
        until = time.monotonic() + 30.0
        while time.monotonic() < until and process.poll() is None:
            if found := re.search(pattern, log.read_text()):
                return found[1]
            time.sleep(0.1)
        raise RuntimeError(log.read_text())

    def worker(self) -> "subprocess.Popen[bytes]":
        """Another worker, without anybody who would begin it anew."""
        return self._begin(
            "dask_worker", self.address, "--no-nanny", "--nthreads", "1", "--no-dashboard"
        )

    def restart(self) -> None:
        """Kill the scheduler and begin another one at its address."""
        self.scheduler.kill()
        self.scheduler.wait()
        for worker in self.workers:
            worker.kill()
            worker.wait()
        port = self.address.rpartition(":")[2]
        self.scheduler = self._begin("dask_scheduler", "--port", port, "--no-dashboard")
        self._told(self.scheduler, r"Scheduler at:\s+tcp://(\S+)")
        self.workers = [self.worker(), self.worker()]

    def end(self) -> None:
        """End all of it."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


def test_dask(cluster: Cluster, trial: Trial, is_quick: bool, tmp_path: Path) -> None:
    """Workers, scheduler and submitter are killed in turn."""
    trial.what = "SIGKILL of Dask's workers, its scheduler and the submitter in turn"
    rows, kills = (300, 3) if is_quick else (ROWS, 9)
    wait, kept = Random(SEED), []
    process = start(tmp_path, rows, f"dask://{cluster.address}")
    while trial.tried < kills:
        before = len(marked(tmp_path / "marks"))
        until = time.monotonic() + 90.0
        while len(marked(tmp_path / "marks")) < before + rows // (4 * kills):
            assert time.monotonic() < until, "nothing goes on"
            assert process.poll() is None, process.communicate()[0]
            time.sleep(0.02)
        time.sleep(wait.uniform(0.0, 0.2))
        kept.append((sealed(tmp_path, rows), marked(tmp_path / "marks")))
        if trial.tried % 3 == 0:
            cluster.workers[0].kill()
            cluster.workers[0].wait()
            cluster.workers = [*cluster.workers[1:], cluster.worker()]
        elif trial.tried % 3 == 1:
            cluster.restart()
        else:
            process.kill()
            process.communicate()
            process = start(tmp_path, rows, f"dask://{cluster.address}")
        trial.add()
    out, _ = process.communicate(timeout=180)
    assert process.returncode == 0, out
    trial.miss = problem_of(tmp_path, rows, kept)
    again = sum(own - 1 for own in marked(tmp_path / "marks").values())
    trial.note = f"{rows} rows; {again} of those at work or waiting ran again"
    assert not trial.miss
    assert trial.passed
