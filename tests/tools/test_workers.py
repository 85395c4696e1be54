"""Jobs in processes: the same as in this one, killed, stopped, dropped, and alone at first."""

import math
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import presswear
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.workers import InProcess, Job, Pool, Report, Stopped, Workers, workers_for

PATIENCE = 60.0
"""Wall time after which nothing comes any more, s: a machine may be busy."""


@pytest.fixture(scope="module")
def pool() -> Iterator[Pool]:
    with Pool(2, room=100) as found:
        yield found


@dataclass(frozen=True)
class Adds:
    """Adds up whole numbers, and hands over what it has every ten of them."""

    until: int
    done: int = 0
    total: int = 0

    def __call__(self, report: Report) -> "Adds":
        done, total = self.done, self.total
        while done < min(self.until, self.done + 10):
            done, total = done + 1, total + done
            report(done, f"at {done}", np.full((2, 3), float(done)))
        return Adds(self.until, done, total)


class Heard:
    """Goes on with what is handed over, and notes what it hears."""

    def __init__(self) -> None:
        self.totals: dict[int, int] = {}
        self.told: list[tuple[int, float, str, Any]] = []

    def ended(self, key: int, outcome: Adds) -> Mapping[int, Job | None]:
        if outcome.done < outcome.until:
            return {key: outcome}
        self.totals[key] = outcome.total
        return {}

    def hear(self, key: int, done: float, word: str, rows: Any) -> None:
        self.told.append((key, done, word, rows))


def test_jobs_that_go_on_come_to_the_same_everywhere(pool: Pool) -> None:
    totals = []
    for each in (InProcess(), pool):
        heard = Heard()
        each.run({k: Adds(25 + k) for k in range(5)}, heard.ended, heard.hear)
        totals.append(dict(sorted(heard.totals.items())))
        for key, done, word, rows in heard.told:
            assert 0 <= key < 5
            # What is written may be read half written; it is never more than shown.
            assert 0 < done <= 29
            assert word[:3] in ("", "at ")
            assert rows is None or rows.shape == (2, 3)
    assert totals[0] == totals[1] == {k: sum(range(25 + k)) for k in range(5)}


def test_one_core_takes_no_process() -> None:
    assert isinstance(workers_for(1), InProcess)
    assert isinstance(workers_for(2), Pool)


@dataclass(frozen=True)
class Waits:
    """Tells where it is and goes on until it is stopped, or for a time, s."""

    lasts: float = math.inf

    def __call__(self, report: Report) -> int:
        began, count = time.monotonic(), 0
        try:
            while time.monotonic() < began + self.lasts:
                count += 1
                report(count, f"{os.getpid()}")
                time.sleep(0.01)
        except KeyboardInterrupt:
            raise Stopped(count) from None
        return 0


def nothing(key: int, done: float, word: str, rows: object) -> None:
    """Hears it all."""


def test_a_job_that_is_not_wanted_any_more_is_stopped(pool: Pool) -> None:
    ended: list[int] = []

    def drop(key: int, outcome: object) -> Mapping[int, Job | None]:
        ended.append(key)
        return {1: None, 2: None}

    for each in (pool, InProcess()):
        # In this process the others have not begun when the first has ended.
        each.run({0: Waits(0.3), 1: Waits(), 2: Waits()}, drop, nothing)
    assert ended == [0, 0]


class Presses:
    """Interrupts from the keyboard once both jobs are at work."""

    def __init__(self, jobs: int) -> None:
        self.missing = set(range(jobs))

    def __call__(self, key: int, done: float, word: str, rows: object) -> None:
        self.missing.discard(key)
        if not self.missing:
            raise KeyboardInterrupt


@pytest.mark.parametrize("count", [1, 2])
def test_an_interrupt_hands_over_what_there_is(count: int) -> None:
    came: dict[int, int] = {}

    def ended(key: int, outcome: int) -> Mapping[int, Job | None]:
        came[key] = outcome
        return {}

    with workers_for(count) as each, pytest.raises(KeyboardInterrupt):
        each.run({k: Waits() for k in range(count)}, ended, Presses(count))
    assert sorted(came) == list(range(count))
    assert all(outcome > 0 for outcome in came.values())


@dataclass(frozen=True)
class Raises:
    """Goes wrong as a job may."""

    error: Exception

    def __call__(self, report: Report) -> None:
        raise self.error


def test_an_error_of_a_job_is_that_of_the_program() -> None:
    with Pool(2) as each, pytest.raises(InputError, match="angles = 7"):
        each.run({0: Raises(InputError("angles = 7")), 1: Waits()}, lambda *_: {}, nothing)


@dataclass(frozen=True)
class Dies:
    """Ends its process as a system does that is out of memory: once, or always without a note."""

    noted: Path | None

    def __call__(self, report: Report) -> str:
        report(0.0)
        if self.noted is None or not self.noted.exists():
            if self.noted is not None:
                self.noted.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return "done"


@pytest.mark.parametrize("number", [0, 1])
def test_a_killed_process_is_replaced(number: int, tmp_path: Path) -> None:
    came: dict[int, Any] = {}

    def ended(key: int, outcome: Any) -> Mapping[int, Job | None]:
        came[key] = outcome
        return {}

    lines: list[str] = []
    with workers_for(2, lost=lines.append) as each:
        each.run({number: Dies(tmp_path / "died"), 1 - number: Waits(0.2)}, ended, nothing)
    assert came == {number: "done", 1 - number: 0}
    (line,) = lines
    assert "2 at a time" in line


@dataclass(frozen=True)
class Large:
    """A large result; its process is killed some time after it begins to be sent, s."""

    delay: float

    def __reduce__(self) -> Any:
        threading.Timer(self.delay, os.kill, (os.getpid(), signal.SIGKILL)).start()
        return len, (bytes(200_000_000),)


@dataclass(frozen=True)
class GivesLarge:
    """Returns a large result once, then a small one."""

    noted: Path
    delay: float

    def __call__(self, report: Report) -> Any:
        report(0.0)
        if self.noted.exists():
            return 0
        self.noted.touch()
        return Large(self.delay)


@pytest.mark.parametrize("delay", [0.02, 0.05, 0.1, 0.2])
def test_half_a_result_does_not_stop_the_pool(delay: float, tmp_path: Path) -> None:
    came: list[int] = []

    def ended(key: int, outcome: Any) -> Mapping[int, Job | None]:
        came.append(outcome)
        return {}

    def run() -> None:
        with Pool(2) as each:
            each.run({0: GivesLarge(tmp_path / "given", delay)}, ended, nothing)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    assert came in ([0], [200_000_000])


def test_processes_that_are_killed_again_and_again_end_the_run() -> None:
    with Pool(2) as each, pytest.raises(RunFailed, match=r"out of memory"):
        each.run({0: Dies(None)}, lambda *_: {}, nothing)


@dataclass(frozen=True)
class Notes:
    """Writes down when it began and, a while later, when it first told how far it is."""

    place: Path
    key: int

    def __call__(self, report: Report) -> float:
        (self.place / f"begun-{self.key}").write_text(f"{time.monotonic()}")
        report(math.nan, "getting ready")
        time.sleep(0.5)
        (self.place / f"told-{self.key}").write_text(f"{time.monotonic()}")
        report(1.0)
        time.sleep(0.3)
        return 0.0


def test_the_first_job_is_alone_until_it_tells(tmp_path: Path) -> None:
    heard: dict[str, list[float]] = {}

    def hears(key: int, done: float, word: str, rows: object) -> None:
        heard.setdefault(word, []).append(done)

    with Pool(2) as each:
        each.run({k: Notes(tmp_path, k) for k in range(3)}, lambda *_: {}, hears)
    assert all(map(math.isnan, heard.pop("getting ready")))
    assert set(heard[""]) == {1.0}
    told, begun = (
        [float((tmp_path / f"{name}-{k}").read_text()) for k in range(3)]
        for name in ("told", "begun")
    )
    assert min(begun[1:]) > told[0]
    # Then the others are at work at once.
    assert begun[2] < told[1] or begun[1] < told[2]


_SCRIPT = """
import test_workers
print("begun", flush=True)
test_workers.forever()
"""
"""It does not ask whether it is the main module."""


def forever() -> None:
    def told(key: int, done: float, word: str, rows: object) -> None:
        print(word, flush=True)

    with Pool(2) as each:
        each.run({0: Waits(), 1: Waits()}, lambda *_: {}, told)


def script(tmp_path: Path) -> "subprocess.Popen[str]":
    """The script, in a session of its own."""
    (tmp_path / "script.py").write_text(_SCRIPT)
    places = Path(presswear.__path__[0]).parent, Path(__file__).parent
    path = os.pathsep.join(map(str, (*places, os.environ.get("PYTHONPATH", ""))))
    return subprocess.Popen(
        [sys.executable, str(tmp_path / "script.py")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": path},
    )


def is_running(pid: int) -> bool:
    """Whether there is such a process that has not ended."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def within(is_so: Callable[[], bool]) -> bool:
    """Whether something comes to be so."""
    last = time.monotonic() + PATIENCE
    while not is_so() and time.monotonic() < last:
        time.sleep(0.05)
    return is_so()


@pytest.mark.skipif(sys.platform != "linux", reason="processes are read from Linux's /proc")
def test_no_process_outlives_its_parent(tmp_path: Path) -> None:
    process = script(tmp_path)
    assert process.stdout is not None
    said: list[str] = []
    while len(set(said)) < 3:
        said.append(process.stdout.readline().strip())
        assert said[-1], "it has ended"
    pids = [int(word) for word in set(said) - {"begun"}]
    assert said.count("begun") == 1
    assert all(map(is_running, pids))
    process.kill()
    process.wait()
    assert within(lambda: not any(map(is_running, pids)))
    process.communicate()


def test_nobody_else_says_anything_when_all_are_interrupted(tmp_path: Path) -> None:
    """Ctrl-C reaches every process of a terminal; the parent alone answers."""
    process = script(tmp_path)
    assert process.stdout is not None
    said: set[str] = set()
    while len(said) < 3:
        said.add(process.stdout.readline().strip())
        assert "" not in said, "it has ended"
    os.killpg(process.pid, signal.SIGINT)
    errors = process.communicate(timeout=PATIENCE)[1]
    assert errors.count("Traceback") == 1
    assert errors.strip().endswith("KeyboardInterrupt")


def doers() -> tuple[Workers, ...]:
    """Both kinds keep to the protocol, for the type checker."""
    return InProcess(), Pool(1)


def test_processes_import_from_where_this_one_does(tmp_path: Path) -> None:
    """Not from the working directory, where another version may lie."""
    script, here = tmp_path / "scripts" / "script.py", tmp_path / "here"
    root = Path(__file__).parents[2]
    shutil.copytree(root / "presswear", here / "presswear")
    script.parent.mkdir()
    (script.parent / "jobs.py").write_text(
        "from presswear.tools import workers\ndef where(report): return workers.__file__\n"
    )
    script.write_text(
        "import jobs\n"
        "from presswear.tools import workers\n"
        "def ended(key, path):\n"
        "    print(path == workers.__file__)\n"
        "    return {}\n"
        "with workers.Pool(2, ('presswear.tools.workers',)) as pool:\n"
        "    pool.run({0: jobs.where}, ended, print)\n"
    )
    done = subprocess.run(
        [sys.executable, script],
        cwd=here,
        env={**os.environ, "PYTHONPATH": str(root)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "True\n", done.stderr
