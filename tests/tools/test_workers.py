"""Jobs in workers: equal results, workers that are killed or stopped, and spawned ones."""

import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

import presswear
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.processes import (
    GRACE,
    Job,
    Report,
    Stopped,
    Workers,
    end_with_parent,
)

PATIENCE = 60.0  # s, for a busy machine


@pytest.fixture(scope="module")
def pool() -> Iterator[Workers]:
    with Workers(2) as shared:
        yield shared


@dataclass(frozen=True)
class Adds:
    """Add whole numbers and return after every ten of them."""

    until: int
    done: int = 0
    total: int = 0

    def __call__(self, report: Report) -> "Adds":
        done = self.done
        total = self.total
        while done < min(self.until, self.done + 10):
            done, total = done + 1, total + done
            report(done)
        return Adds(self.until, done, total)


def nothing(*arguments: object) -> Mapping[int, Job | None]:
    return {}


class Collects:
    """Store the results of jobs, and continue those that are not complete."""

    def __init__(self) -> None:
        self.results: dict[int, Any] = {}

    def __call__(self, key: int, outcome: Any) -> Mapping[int, Job | None]:
        self.results[key] = outcome
        return (
            {key: outcome}
            if isinstance(outcome, Adds) and outcome.done < outcome.until
            else {}
        )


def test_results_are_equal_in_workers_and_in_this_process(pool: Workers):
    reported: list[tuple[int, float]] = []
    for workers in (Workers(), pool):
        collects = Collects()
        jobs = {k: Adds(25 + k) for k in range(5)}
        workers.run(jobs, collects, lambda key, done, *_: reported.append((key, done)))
        totals = {key: outcome.total for key, outcome in collects.results.items()}
        assert totals == {k: sum(range(25 + k)) for k in range(5)}
    assert all(0 <= key < 5 and 0 < done <= 29 for key, done in reported)


@dataclass(frozen=True)
class Waits:
    """Report and wait until stopped, or for a time, s; then store for another time, s."""

    lasts: float = math.inf
    stores: float = 0.0

    def __call__(self, report: Report) -> int:
        started = time.monotonic()
        count = 0
        try:
            while time.monotonic() < started + self.lasts:
                count += 1
                report(os.getpid())
                time.sleep(0.01)
        except KeyboardInterrupt:
            time.sleep(self.stores)
            raise Stopped(count) from None
        return 0


def gets_ready(report: Report) -> None:
    for done in (0.0, math.nan):
        report(done)
    time.sleep(0.5)


def test_a_job_that_gets_ready_is_reported_at_once(pool: Workers):
    reported: list[float] = []
    pool.run({0: gets_ready}, nothing, lambda key, done, *_: reported.append(done))
    assert math.isnan(reported[-1])


def reports_rows(report: Report) -> None:
    report(0.0, "", np.array([3.0, 4.0]))
    for _ in range(10):
        report(0.5)
        time.sleep(0.05)


def test_rows_of_a_job_are_reported_once(pool: Workers):
    rows: list[Any] = []
    for workers in (Workers(), pool):
        workers.run(
            {0: reports_rows}, nothing, lambda key, done, word, each: rows.append(each)
        )
    assert [each.tolist() for each in rows if each is not None] == [[3.0, 4.0]] * 2


def test_a_dropped_job_is_stopped(pool: Workers):
    ended: list[int] = []

    def drop(key: int, outcome: object) -> Mapping[int, Job | None]:
        ended.append(key)
        return {1: None, 2: None}

    for workers in (pool, Workers()):
        workers.run({0: Waits(0.3), 1: Waits(), 2: Waits()}, drop, nothing)
    assert ended == [0, 0]


@pytest.mark.parametrize("count", [1, 2])
def test_an_interrupt_passes_on_the_results_so_far(count):
    collects = Collects()
    missing = set(range(count))

    def interrupt(key: int, *_: object) -> None:
        missing.discard(key)
        if not missing:
            raise KeyboardInterrupt

    jobs = {k: Waits(stores=(GRACE + 0.5) * k) for k in range(count)}
    with Workers(count) as workers, pytest.raises(KeyboardInterrupt):
        workers.run(jobs, collects, interrupt)
    assert sorted(collects.results) == list(range(count))
    assert all(outcome > 0 for outcome in collects.results.values())


def raises(report: Report) -> None:
    raise InputError("angles = 7")


def dies(report: Report) -> None:
    """End the process as a system does that runs out of memory."""
    report(0.0)
    os.kill(os.getpid(), signal.SIGKILL)


def runs_out_of_memory(report: Report) -> None:
    raise MemoryError


@pytest.mark.parametrize(
    ("job", "error", "words"),
    [
        (raises, InputError, "angles = 7"),
        (dies, RunFailed, "memory ran out"),
        (runs_out_of_memory, RunFailed, "memory ran out"),
    ],
)
def test_an_error_or_a_kill_ends_the_run(job: Job, error, words):
    with Workers(2) as pool, pytest.raises(error, match=words):
        pool.run({0: Waits(), 1: job}, nothing, nothing)


@dataclass(frozen=True)
class Large:
    """A large result; its worker is killed a time after writing of it started, s."""

    delay: float

    def __reduce__(self) -> Any:
        threading.Timer(self.delay, os.kill, (os.getpid(), signal.SIGKILL)).start()
        return len, (bytes(200_000_000),)


def returns_large(delay: float, report: Report) -> Large:
    report(0.0)
    return Large(delay)


@pytest.mark.parametrize("delay", [0.02, 0.1])
def test_half_a_result_does_not_stop_the_pool(delay):
    collects = Collects()
    errors = []

    def run() -> None:
        with Workers(2) as pool:
            try:
                pool.run(
                    {0: partial(returns_large, delay), 1: Waits(1.0)}, collects, nothing
                )
            except RunFailed as error:
                errors.append(str(error))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    assert not thread.is_alive()
    assert collects.results == {0: 200_000_000, 1: 0} or "memory ran out" in errors[0]


# It has no ``if __name__ == "__main__":``.
_SCRIPT = """
import test_workers
print("start", flush=True)
test_workers.forever()
"""
_SIGNALLED = """
import os, signal, threading
from presswear.tools.processes import Workers, stoppable
try:
    with stoppable(), Workers(2, ["presswear.campaign.runs"]) as workers:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGTERM)).start()
        workers.run({0: str, 1: str}, lambda key, outcome: {0: str, 1: str}, print)
except KeyboardInterrupt:
    print("stopped")
"""
# Ctrl-C reaches the server of the workers while it imports their modules.
_IMPORTS = """
from presswear.tools.processes import Workers
if __name__ == "__main__":
    with Workers(2, ["interrupts_itself"]) as workers:
        workers.run({0: str, 1: str}, lambda key, outcome: {}, print)
    print("completed")
"""
# SIGTERM to all processes: it reaches one that has not read its arguments. They exceed
# a pipe.
_ENDS = """
import os, signal, sys
if "--multiprocessing-fork" in sys.orig_argv:
    os.kill(os.getpid(), signal.SIGTERM)
"""
_TERMINATED = """
import multiprocessing
import test_workers
from presswear.tools.processes import starting_processes
context = multiprocessing.get_context("spawn")
process = context.Process(target=test_workers.ends, args=(bytes(1_000_000),), daemon=True)
with starting_processes():
    process.start()
process.join()
print(process.exitcode)
"""
_SPAWNED = """
import multiprocessing, sys
for name in ("fcntl", "resource", "multiprocessing.forkserver"):
    sys.modules[name] = None
multiprocessing.get_all_start_methods = lambda: ["spawn"]
import presswear as pw
import presswear.validation.reference_problems
if __name__ == "__main__":
    scene = pw.scenes.wear_times(cycles=2, wear_updates=0, replicates=2, engine="dae")
    print(pw.run(scene, jobs=2).status)
"""


def forever() -> None:
    def on_progress(key: int, done: float, word: str, rows: object) -> None:
        print(f"{done:.0f}", flush=True)

    with Workers(2) as workers:
        workers.run({0: Waits(), 1: Waits()}, nothing, on_progress)


def ends(data: bytes) -> None:
    end_with_parent()
    time.sleep(PATIENCE)


def started(tmp_path: Path, text: str) -> "subprocess.Popen[str]":
    (tmp_path / "script.py").write_text(text)
    places = Path(presswear.__path__[0]).parent, Path(__file__).parent, tmp_path
    path = os.pathsep.join(map(str, (*places, os.environ.get("PYTHONPATH", ""))))
    options: dict[str, Any] = {
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
        "text": True,
    }
    options |= {"env": {**os.environ, "PYTHONPATH": path}, "start_new_session": True}
    return subprocess.Popen([sys.executable, str(tmp_path / "script.py")], **options)


def workers_of(process: "subprocess.Popen[str]") -> list[int]:
    """Return the processes of the workers once they work."""
    assert process.stdout is not None
    lines: list[str] = []
    while len(set(lines)) < 3:
        lines.append(process.stdout.readline().strip())
        assert lines[-1], "it has ended"
    assert lines.count("start") == 1
    return [int(word) for word in set(lines) - {"start"}]


def test_no_process_outlives_its_parent(tmp_path):
    process = started(tmp_path, _SCRIPT)
    workers = [psutil.Process(pid) for pid in workers_of(process)]
    process.kill()
    process.communicate()
    assert psutil.wait_procs(workers, timeout=PATIENCE)[1] == []


def test_only_the_parent_reports_an_interrupt(tmp_path):
    """Ctrl-C reaches every process of a terminal; only the parent reports it."""
    process = started(tmp_path, _SCRIPT)
    workers_of(process)
    os.killpg(process.pid, signal.SIGINT)
    errors = process.communicate(timeout=PATIENCE)[1]
    assert errors.count("Traceback") == 1
    assert errors.strip().endswith("KeyboardInterrupt")


def test_a_process_that_is_ended_as_it_starts_does_not_keep_its_parent(
    tmp_path,
):
    (tmp_path / "sitecustomize.py").write_text(_ENDS)
    process = started(tmp_path, _TERMINATED)
    try:
        assert process.communicate(timeout=PATIENCE) == (f"-{signal.SIGTERM:d}\n", "")
    finally:
        process.kill()


@pytest.mark.parametrize(
    ("text", "end"),
    [(_SPAWNED, "completed\n"), (_SIGNALLED, "stopped\n"), (_IMPORTS, "completed\n")],
)
def test_a_script_ends_without_an_error(tmp_path, text, end):
    """Where processes can only be spawned, and where a signal comes while workers start."""
    module = "import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n"
    (tmp_path / "interrupts_itself.py").write_text(module)
    process = started(tmp_path, text)
    out, errors = process.communicate(timeout=5 * PATIENCE)
    assert out.endswith(end)
    assert errors == ""


ABANDONED = """
from presswear.tools.processes import Workers
started = Workers(2)._started()
for worker in started:
    worker.pipe.close()
for worker in started:
    worker.process.join()
"""


def test_worker_ends_without_a_traceback_when_its_parent_has_ended():
    command = [sys.executable, "-c", ABANDONED]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ended.stderr == ""
