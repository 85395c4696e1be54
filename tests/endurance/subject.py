"""presswear as the trials meet it: command lines, processes and folders.

What they take from its inside, but for scenes and their settings, stands here and nowhere else.
"""

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
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.physics.packed import mass_of
from presswear.results.folder import read_stored
from presswear.results.result import load
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.tools.files import holder, read_checked
from presswear.validation.cases import sound

PATIENCE = 60.0  # Wall time after which a command line that must be refused counts as hung, s
# As ``python -m presswear``; a shell's background jobs have SIGINT ignored.
_PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from presswear.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
Process = subprocess.Popen[str]


def is_one_line(output: str) -> bool:
    return output.startswith("presswear: ") and len(output.removesuffix("\n").splitlines()) == 1


@dataclass(frozen=True)
class Answer:
    """Outcome of a command line."""

    code: int
    output: str
    errors: str

    @property
    def is_refusal(self) -> bool:
        return self.code == 2 and is_one_line(self.errors) and not self.output

    @property
    def problem(self) -> str:
        return f"exit code {self.code}, {(self.errors or self.output).strip()[-300:]!r}"


class Ran(BaseException):
    """Something began to compute; no command catches it."""


def answered(line: list[str]) -> Answer:
    """A command line in this process; a traceback counts as exit code 1, as in a shell."""
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            code = main(line)
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 1
        except Ran:
            return Answer(0, output.getvalue(), "it ran")
        # Whatever gets out of the program is a traceback to its user, which the trials count.
        except Exception as error:
            return Answer(1, output.getvalue(), f"{type(error).__name__}: {error}")
    return Answer(code, output.getvalue(), errors.getvalue())


def start_process(*line: str, program: str = _PROGRAM) -> Process:
    """A command line as a person types it, in a process and a session of its own."""
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
    """A short run that is put through trials."""

    engine: str
    scene: str
    settings: tuple[str, ...]

    def start(self, out: Path, *more: str) -> Process:
        """Start it with a checkpoint after every cycle."""
        changes = [f"--set={setting}" for setting in self.settings]
        return start_process(
            *(
                "run",
                self.scene,
                "--engine",
                self.engine,
                "--wear-updates",
                "1",
                "--checkpoint",
                "0",
            ),
            *(*changes, "--out", str(out), *more),
        )

    def finish(self, out: Path, *more: str) -> Answer:
        return end(self.start(out, *more))


_PRESS = ("speed=60rad/s", "cycles_per_update=1e6", "extrapolation=steps")
_CRANK = ("cycles_per_update=2e4", "steps_per_contact=20", "steps_sustained=5")
TREE = Subject("exudyn-tree", "wear-times", (*_PRESS, "cycles=2"))
IN_HOUSE = Subject("dae", "wear-times", (*_PRESS, "cycles=2", "replicates=2"))
JOINTS = Subject("exudyn-joints", "slider-crank", (*_CRANK, "cycles=1"))
# One for each engine: several cycles, starts and steps of a wear, a few seconds each.
SUBJECTS = (TREE, IN_HOUSE, JOINTS)


@dataclass(frozen=True)
class Alone:
    """The folder of a run that was left alone, and the wall time that it took, s."""

    folder: Path
    lasts: float


Check = Callable[[Path], object]
check_result: Check = load  # Reads a result folder whole; InputError names what is wrong with it


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
    last = time.monotonic() + 2.0 * PATIENCE
    while time.monotonic() < last:
        if is_so():
            return True
        time.sleep(0.02)
    return False


def is_at_work(process: Process, folder: Path) -> bool:
    return f"process {process.pid} " in (holder(folder) or "")


class OutsideError(RunFailed):
    """A run of a scene that no law of contact covers: a pin sank in deeper than it is thick."""


@dataclass(frozen=True)
class Energy:
    """Energy of a run, J: missing, exchanged by the drives, and kinetic at its end."""

    missing: float
    exchanged: float
    kinetic: float


def run_part(scene: Scene, part: float, look: Callable[[float], None]) -> Energy:
    """Run a part of a cycle; RunFailed where it fails, or does not end sound and finite."""
    period, linkage = scene.mechanism.period, scene.linkage()
    plan = Plan(part * period, 1, 1, report=lambda part, recorder: look(part))
    run = scene.solver.for_cycle(period).simulate(linkage, start_of(scene), plan)
    if run.finding and run.finding.kind == "penetration":
        raise OutsideError(run.message)
    described = sound(run, plan).diagnostics
    missing, exchanged = float(described["energy_residual_J"]), float(described["drive_exchange_J"])
    # Where weights fall, their energy turns into heat without the drives.
    dissipated = float(described["contact_loss_J"]) + float(described["friction_loss_J"])
    exchanged = max(exchanged, dissipated)
    return Energy(abs(missing), exchanged, 0.5 * float(mass_of(linkage) @ run.end.velocity**2))
