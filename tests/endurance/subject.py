"""presswear as the trials meet it: command lines, processes and folders."""

import contextlib
import io
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import presswear
from presswear.__main__ import main
from presswear.results.folder import read_stored
from presswear.tools.files import holder, read_checked

SEED = 20240131  # of all random moments, positions and scenes of the full trials
# s of wall time, after which a command line that must be refused counts as hung
PATIENCE = 60.0
# As ``python -m presswear``; a shell's background jobs have SIGINT ignored.
_PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from presswear.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
Process = subprocess.Popen[str]


@dataclass
class Trial:
    """Counts of attempts of one kind, with the first problem."""

    attempts: int = 0
    passes: int = 0
    allowed: int = 0  # misses that are not failures of the program
    note: str = ""
    first_miss: str = ""

    def add(self, problem: str = "", times: int = 1) -> None:
        self.attempts += times
        self.passes += 0 if problem else times
        self.first_miss = self.first_miss or problem
        if problem:
            print(problem)  # pytest shows it for a trial that fails

    def check(self) -> None:
        assert 0 < self.attempts <= self.passes + self.allowed, self.first_miss


def is_one_line(output: str) -> bool:
    return (
        output.startswith("presswear: ")
        and len(output.removesuffix("\n").splitlines()) == 1
    )


@dataclass(frozen=True)
class Answer:
    """Exit code of a command line, and its standard output and standard error."""

    code: int
    output: str
    errors: str

    @property
    def is_refusal(self) -> bool:
        """True for exit code 2 with one line of errors and no output."""
        return self.code == 2 and is_one_line(self.errors) and not self.output

    @property
    def problem(self) -> str:
        return f"exit code {self.code}, {(self.errors or self.output).strip()[-300:]!r}"


class Ran(BaseException):
    """Something began to compute; no command catches it."""


def answered(line: list[str]) -> Answer:
    """Run a command line in this process; a traceback counts as exit code 1, as in a shell."""
    output = io.StringIO()
    errors = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            code = main(line)
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 1
        except Ran:
            return Answer(0, output.getvalue(), "it ran")
        except Exception as error:
            return Answer(1, output.getvalue(), f"{type(error).__name__}: {error}")
    return Answer(code, output.getvalue(), errors.getvalue())


def start_process(*line: str, program: str = _PROGRAM) -> Process:
    """Start a command line as a person types it, in a new process and session."""
    # The same source as in this process, wherever the other is.
    places = str(Path(presswear.__path__[0]).parent), os.environ.get("PYTHONPATH")
    source = os.pathsep.join(place for place in places if place)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", program, *line],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="backslashreplace",
        start_new_session=True,
        env={**os.environ, "COLUMNS": "200", "PYTHONPATH": source},
    )


def end(process: Process, patience: float | None = None) -> Answer:
    """Wait for a process, and kill it after ``patience``, s."""
    try:
        output, errors = process.communicate(timeout=patience)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return Answer(1, "", f"it still went on after {patience:g} s")
    return Answer(process.returncode, output, errors)


def resume_option(out: Path) -> tuple[str, ...]:
    return ("--resume",) if out.exists() else ()


@dataclass(frozen=True)
class Subject:
    """A short run for trials; settings are those of ``--set``."""

    engine: str
    scene: str
    settings: tuple[str, ...]

    def start(self, out: Path, *more: str) -> Process:
        line = f"run {self.scene} --engine {self.engine} --wear-updates 1 --checkpoint 0".split()
        settings = [f"--set={setting}" for setting in self.settings]
        return start_process(*line, *settings, "--out", str(out), *more)

    def finish(self, out: Path, *more: str) -> Answer:
        return end(self.start(out, *more))


_PRESS = ("speed=60rad/s", "cycles_per_update=1e6", "extrapolation=steps")
_CRANK = ("cycles_per_update=2e4", "steps_per_contact=20", "steps_sustained=5")
TREE = Subject("exudyn-tree", "wear-times", (*_PRESS, "cycles=2"))
IN_HOUSE = Subject("dae", "wear-times", (*_PRESS, "cycles=2", "replicates=2"))
JOINTS = Subject("exudyn-joints", "slider-crank", (*_CRANK, "cycles=1"))
# Each has several cycles, replicates and wear updates, and takes some seconds.
SUBJECTS = (TREE, IN_HOUSE, JOINTS)


@dataclass(frozen=True)
class Alone:
    """The folder of a run that was left alone, and the wall time that it took, s."""

    folder: Path
    lasts: float


def check_checkpoint(folder: Path) -> None:
    checkpoint = read_stored(folder).checkpoint
    if checkpoint is not None:
        read_checked(folder / checkpoint.file, checkpoint.digest)


def checkpoint_of(folder: Path) -> Path | None:
    if not (folder / "result.json").exists():
        return None
    checkpoint = read_stored(folder).checkpoint
    return None if checkpoint is None else folder / checkpoint.file


def wait_for(is_so: Callable[[], object]) -> bool:
    """Wait until a condition holds, at most for twice PATIENCE; return whether it holds."""
    last = time.monotonic() + 2.0 * PATIENCE
    while time.monotonic() < last:
        if is_so():
            return True
        time.sleep(0.02)
    return False


def is_at_work(process: Process, folder: Path) -> bool:
    return f"process {process.pid} " in (holder(folder) or "")
