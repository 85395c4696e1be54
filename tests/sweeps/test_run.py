"""Rows that run, on every executor: sealed once, in any order, with the same numbers."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import psutil
import pytest
from distributed import Nanny
from made_up_rows import KEY, MadeUpJob, MadeUpWork, marked

from presswear.sweeps import cluster, executors, work
from presswear.sweeps.cluster import RETRIES
from presswear.sweeps.executors import Runner, runner_of
from presswear.sweeps.run import Standing, run_rows
from presswear.sweeps.store import Records, Store
from presswear.tools.errors import InputError, RunFailed

P = ParamSpec("P")
T = TypeVar("T")
HERE = Path(__file__).resolve().parents[1]
ON = ["", "dask", "concurrent.futures:ThreadPoolExecutor"]


def silent(line: str) -> None:
    pass


def ran(path: Path, own: MadeUpWork, runner: Runner, rows: range | None = None) -> Standing:
    with Store(path) as store:
        return run_rows(own, store, runner, rows or range(own.rows))


def values(path: Path, own: MadeUpWork) -> list[float | None]:
    records = Records(path)
    records.refresh()
    found = [records.get(own.shortcut(row)) for row in range(own.rows)]
    return [None if record is None else record.values[KEY][0] for record in found]


@pytest.mark.parametrize("on", ON)
def test_every_row_runs_once_wherever_it_runs(tmp_path: Path, on: str) -> None:
    own = MadeUpWork(40, marks=str(tmp_path / "marks"))
    standing = ran(tmp_path / "sweep", own, runner_of(on, 2, silent))
    assert standing == Standing(rows=40, found=0, ran=40, failed=1, parts=0.0)
    assert values(tmp_path / "sweep", own) == [float(row) for row in range(40)]
    again = ran(tmp_path / "sweep", own, runner_of("", 1, silent))
    assert again == Standing(rows=40, found=40, ran=0, failed=1, parts=0.0)
    assert marked(tmp_path / "marks") == dict.fromkeys(range(40), 1)


def test_each_row_is_heard_of_with_its_reason(tmp_path: Path) -> None:
    own, heard = MadeUpWork(14, refused=3), dict[int, tuple[float, str]]()

    def hear(row: int, part: float, word: str) -> None:
        heard[row] = part, word

    with Store(tmp_path) as store:
        run_rows(own, store, runner_of("", 1, silent), range(14), heard=hear)
    reasons = {3: "this row cannot be made", 13: "odd luck"}
    assert heard == {row: (1.0, reasons.get(row, "")) for row in range(14)}


class Untouched(MadeUpWork):
    """Rows whose scenes are not to be made."""

    def job(self, row: int) -> tuple[str, MadeUpJob]:
        raise AssertionError(f"the scene of row {row} is made")


def test_no_scene_is_made_of_a_row_that_is_sealed(tmp_path: Path) -> None:
    ran(tmp_path, MadeUpWork(5), runner_of("", 1, silent))
    standing = ran(tmp_path, Untouched(5), runner_of("", 1, silent))
    assert (standing.found, standing.ran) == (5, 0)
    with pytest.raises(AssertionError, match="row 5"):
        ran(tmp_path, Untouched(6), runner_of("", 1, silent))


def test_shards_share_the_rows(tmp_path: Path) -> None:
    own = MadeUpWork(20, marks=str(tmp_path / "marks"))
    for part in (0, 1, 2):
        ran(tmp_path / "sweep", own, runner_of("", 1, silent), range(part, 20, 3))
    assert marked(tmp_path / "marks") == dict.fromkeys(range(20), 1)
    assert None not in values(tmp_path / "sweep", own)


def test_a_sweep_is_widened_and_a_row_found_under_either_name(tmp_path: Path) -> None:
    own = MadeUpWork(5, marks=str(tmp_path / "marks"))

    class Renamed(MadeUpWork):
        def shortcut(self, row: int) -> str:
            return super().shortcut(row + 1000)

    ran(tmp_path / "sweep", own, runner_of("", 1, silent))
    wider = Renamed(8, marks=str(tmp_path / "marks"))
    standing = ran(tmp_path / "sweep", wider, runner_of("", 1, silent))
    assert (standing.found, standing.ran) == (5, 3)
    assert marked(tmp_path / "marks") == dict.fromkeys(range(8), 1)
    assert values(tmp_path / "sweep", wider) == [float(row) for row in range(8)]


def test_a_row_that_cannot_be_made_is_a_row_with_its_reason(tmp_path: Path) -> None:
    own = MadeUpWork(5, refused=3)
    standing = ran(tmp_path, own, runner_of("", 1, silent))
    assert (standing.ran, standing.failed) == (5, 1)
    records = Records(tmp_path)
    records.refresh()
    record = records.get(own.shortcut(3))
    assert record is not None
    assert record.reason == "this row cannot be made"


def test_two_processes_in_one_folder_share_the_rows(tmp_path: Path) -> None:
    marks, folder = tmp_path / "marks", tmp_path / "sweep"
    words = [folder, "60", "0.02", marks, "", ""]
    command = [sys.executable, str(HERE / "submit_rows.py"), *map(str, words)]
    both = [
        subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) for _ in range(2)
    ]
    told = [process.communicate(timeout=60)[0] for process in both]
    assert [process.returncode for process in both] == [0, 0]
    assert all("rows=60" in own for own in told)
    assert marked(marks) == dict.fromkeys(range(60), 1)
    lines = [own.read_text().count("\n") for own in folder.glob("records/*/records.jsonl")]
    assert sum(lines) == 60


class TooLong(InputError):
    pass


def test_the_cost_is_told_behind_one_run_which_is_kept(tmp_path: Path) -> None:
    heard: list[tuple[float, int, int]] = []

    def gate(seconds: float, left: int, places: int) -> None:
        heard.append((seconds, left, places))
        raise TooLong("too long")

    own = MadeUpWork(30, seconds=0.01, marks=str(tmp_path / "marks"))
    ran(tmp_path / "sweep", MadeUpWork(10), runner_of("", 1, silent), range(5, 10))
    with Store(tmp_path / "sweep") as store, pytest.raises(TooLong):
        run_rows(own, store, runner_of("", 2, silent), range(30), gate=gate)
    assert heard == [(0.01, 24, 2)]
    assert marked(tmp_path / "marks") == {0: 1}
    assert values(tmp_path / "sweep", own)[0] == 0.0
    assert not (tmp_path / "sweep" / "claims").exists()


@pytest.mark.parametrize("on", ["", "dask"])
def test_a_worker_that_is_killed_costs_no_row(tmp_path: Path, on: str) -> None:
    deadly = tmp_path / "deadly"
    deadly.write_text("")
    told: list[str] = []
    own = MadeUpWork(12, 0.01, marks=str(tmp_path / "marks"), deadly=str(deadly))
    standing = ran(tmp_path / "sweep", own, runner_of(on, 2, told.append))
    assert not deadly.exists()
    assert (standing.ran, standing.failed) == (12, 0)
    assert marked(tmp_path / "marks").keys() == set(range(12))
    assert on or "a worker process was ended from outside" in " ".join(told)


class Breaks(ThreadPoolExecutor):
    """Breaks now and then."""

    left = 0

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> "Future[T]":
        if Breaks.left:
            Breaks.left -= 1
            raise BrokenExecutor("it broke")
        return super().submit(fn, *args, **kwargs)


def not_an_executor() -> str:
    return "no"


def test_an_executor_that_breaks_is_made_anew(tmp_path: Path) -> None:
    Breaks.left = cluster.RETRIES
    told: list[str] = []
    own = MadeUpWork(9, marks=str(tmp_path / "marks"))
    ran(tmp_path / "sweep", own, runner_of("test_run:Breaks", None, told.append))
    assert len(told) == cluster.RETRIES
    assert marked(tmp_path / "marks") == dict.fromkeys(range(9), 1)
    Breaks.left = cluster.RETRIES + 1
    with pytest.raises(RunFailed, match="lost again and again: it broke"):
        ran(tmp_path / "other", own, runner_of("test_run:Breaks", None, told.append))
    assert issubclass(Breaks, Executor)


@pytest.mark.parametrize(
    ("on", "told"),
    [
        ("dsk", "dask, dask://HOST:PORT or MODULE:FACTORY is expected"),
        ("dask://head", "dask://HOST:PORT is expected"),
        ("nothing_there:make", "No module named 'nothing_there'"),
        ("concurrent.futures:Pool", "no attribute 'Pool'"),
        ("test_run:not_an_executor", "gives str, not an Executor"),
    ],
)
def test_what_does_no_rows_is_refused_and_nothing_written(
    tmp_path: Path, on: str, told: str
) -> None:
    with pytest.raises(InputError, match=told):
        ran(tmp_path / "sweep", MadeUpWork(3), runner_of(on, 1, silent))
    assert not (tmp_path / "sweep").exists()


def test_a_scheduler_that_does_not_answer_is_told_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "ANSWER", 1.0)
    began = time.monotonic()
    with pytest.raises(InputError, match=r"--on dask://127\.0\.0\.1:9: no scheduler answers"):
        ran(tmp_path / "sweep", MadeUpWork(3), runner_of("dask://127.0.0.1:9", 1, silent))
    assert time.monotonic() - began < 8.0
    assert not (tmp_path / "sweep").exists()


def test_a_local_cluster_accepts_connections_from_this_machine_only() -> None:
    """Addresses that this process and its workers listen at, as the system lists them."""
    with cluster.cluster("", 1, 10.0, silent):
        owners = [psutil.Process(), *psutil.Process().children(recursive=True)]
        found = [own for process in owners for own in process.net_connections()]
    listening = [own.laddr.ip for own in found if own.status == psutil.CONN_LISTEN]
    assert len(listening) > 2  # scheduler, dashboard, worker
    assert set(listening) == {"127.0.0.1"}


@pytest.mark.parametrize("kills", [1, RETRIES + 1])
def test_a_cluster_whose_workers_end_while_they_start_is_begun_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kills: int
) -> None:
    """Once it goes on; again and again the sweep ends with one line."""
    left = [kills]
    instantiate = Nanny.instantiate

    async def killed(nanny: Nanny) -> Any:
        started = asyncio.ensure_future(instantiate(nanny))
        if left[0]:
            left[0] -= 1
            while nanny.process is None or nanny.process.pid is None:
                await asyncio.sleep(0.01)
            os.kill(nanny.process.pid, signal.SIGKILL)
        return await started

    monkeypatch.setattr(Nanny, "instantiate", killed)
    own, lines = MadeUpWork(3), list[str]()
    runner = runner_of("dask", 1, lines.append)
    if kills == 1:
        assert ran(tmp_path / "sweep", own, runner).ran == 3
        assert any("the cluster did not start" in line for line in lines)
    else:
        with pytest.raises(RunFailed, match="the cluster did not start") as told:
            ran(tmp_path / "sweep", own, runner)
        assert "\n" not in str(told.value)


def test_workers_of_another_program_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = os.getpid()
    digest = lambda: "here" if os.getpid() == here else "there"  # noqa: E731 - pickled by value
    monkeypatch.setattr(cluster, "program_digest", digest)
    with pytest.raises(work.WrongProgram, match=r"has another program \(there; here here\)"):
        ran(tmp_path / "sweep", MadeUpWork(3), runner_of("dask", 1, silent))
    assert not (tmp_path / "sweep").exists()
    with pytest.raises(work.WrongProgram, match="has another program"):
        work.check_program("another", "this worker")


def test_a_signal_stops_and_gives_all_claims_free(tmp_path: Path) -> None:
    marks, folder = tmp_path / "marks", tmp_path / "sweep"
    words = [folder, "500", "0.02", marks, "", ""]
    command = [sys.executable, str(HERE / "submit_rows.py"), *map(str, words)]
    process = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL)
    while len(marked(marks)) < 5:
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    assert process.wait(20.0) != 0
    assert not (folder / "claims").exists()
    sealed = [row for row, own in enumerate(values(folder, MadeUpWork(500))) if own is not None]
    assert len(sealed) >= 4
