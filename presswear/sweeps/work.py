"""One row of a sweep as a job: a scene runs, and what was measured comes back."""

import math
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from presswear.recording.observer import Observer, Progress
from presswear.results.folder import INTERVAL
from presswear.results.provenance import program_digest
from presswear.scene.scene import Scene
from presswear.sweeps.measures import Asked, Found, measured
from presswear.sweeps.plan import Plan, scene_digest
from presswear.sweeps.store import RUNS
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import digest, inside
from presswear.tools.folders import holder
from presswear.tools.stopping import is_stopped
from presswear.tools.workers import Report

_LOOK = 0.2
"""Time between two looks at a folder that somebody is at work in, s."""


@dataclass(frozen=True)
class Outcome:
    """What a row gave.

    Attributes
    ----------
    values : dict of str to Found
        By the keys of measures.
    stages : int
        Stages that ran.
    reason : str
        Why there are no values, or nothing.
    wall_s : float
        What it took, s, without compiling.
    again : bool
        True where it failed by what is around it.
    """

    values: dict[str, Found] = field(default_factory=dict)
    stages: int = 0
    reason: str = ""
    wall_s: float = 0.0
    again: bool = False


class RowJob(Protocol):
    """A job that gives an outcome."""

    def __call__(self, report: Report) -> Outcome:
        """Do it; what is the row's own fault is an outcome, anything else an error."""


class Work(Protocol):
    """The rows of a sweep, and how each is done.

    Attributes
    ----------
    with_folder : bool
        Whether whole results are kept.
    """

    @property
    def rows(self) -> int:
        """Their number."""

    @property
    def with_folder(self) -> bool:
        """Whether whole results are kept."""

    def shortcut(self, row: int) -> str:
        """Digest of how a row is asked for, found without making its scene."""

    def job(self, row: int) -> tuple[str, RowJob]:
        """Digest of a row's scene, and its job; InputError where the scene cannot be made."""


class WrongProgram(InputError):
    """A worker that would give other numbers."""


@dataclass(frozen=True)
class SceneJob:
    """The run of a row.

    Attributes
    ----------
    scene : Scene
    asked : Asked
    folder : Path or None
        Where its whole result is kept.
    program : str
        Digest of the program that asks; see ``program_digest``.
    interval : float
        Time between two checkpoints in the folder, s.
    jobs : int
        Starts that run at a time.
    """

    scene: Scene
    asked: Asked
    folder: Path | None
    program: str
    interval: float = INTERVAL
    jobs: int = 1

    def __call__(self, report: Report) -> Outcome:
        """Run the scene in this process."""
        check_program(self.program, "this worker")
        # Imported where something is computed.
        from presswear.campaign.single import run
        from presswear.tools.compile import on_compiling

        if self.folder is not None:
            _wait_for(self.folder, report)
        compiled: list[float] = []
        began = time.perf_counter()
        try:
            with on_compiling(compiled.append):
                result = run(
                    self.scene,
                    self.folder,
                    jobs=self.jobs,
                    observers=(_Telling(report),),
                    check=False,
                    interval=self.interval,
                )
            wall = time.perf_counter() - began - sum(compiled)
            if result.status == "failed":
                return Outcome(stages=len(result.stages), reason=result.message, wall_s=wall)
            values = measured(result, self.asked.dear, self.asked.own)
            return Outcome(values, len(result.stages), "", wall)
        except OSError:
            raise
        except MemoryError:
            return Outcome(reason="out of memory", again=True)
        except Exception as error:
            # Behind a signal any error is one.
            if is_stopped():
                raise KeyboardInterrupt from None
            # A measure or law of one's own may raise anything: that ends its row, not the sweep.
            is_told = isinstance(error, InputError | RunFailed)
            reason = f"{error}" if is_told else f"{type(error).__name__}: {error}"
            # Without a finding it failed by its folder.
            again = isinstance(error, RunFailed) and error.finding is None
            return Outcome(reason=reason, wall_s=time.perf_counter() - began, again=again)


def _wait_for(folder: Path, report: Report) -> None:
    """Wait while a process is at work in a folder that has outlived whoever asked for it."""
    while holder(folder) is not None:
        report(0.0)
        time.sleep(_LOOK)


@dataclass
class _Telling(Observer):
    """Tells how far a run is, which is also where it is stopped."""

    report: Report

    def on_progress(self, progress: Progress) -> None:
        self.report(min(progress.whole, 0.999), progress.word)

    def on_compile(self) -> None:
        self.report(math.nan, "compiling")


def check_program(asked: str, worker: str) -> None:
    """WrongProgram where this process would give other numbers than the one that asks."""
    here = program_digest()
    if here != asked:
        raise WrongProgram(
            f"{worker} has another program, {here} there and {asked} here: its numbers would not "
            "agree; install the same presswear, Python and packages there"
        )


@dataclass(frozen=True)
class SceneWork:
    """The rows of a plan, run as scenes.

    Attributes
    ----------
    plan : Plan
    asked : Asked
    program : str
        Digest of the program that computes, or computed, them; see ``program_digest``.
    path : Path or None
        Folder of the sweep; None: no whole results are kept.
    """

    plan: Plan
    asked: Asked
    program: str
    path: Path | None = None

    @property
    def rows(self) -> int:
        """Number of runs."""
        return self.plan.rows

    @property
    def with_folder(self) -> bool:
        """Whether whole results are kept."""
        return self.path is not None

    def shortcut(self, row: int) -> str:
        """Digest of how a row is asked for, of this program."""
        return self._named(self.plan.shortcut(row))

    def job(self, row: int) -> tuple[str, SceneJob]:
        """Digest of a row's scene, and its run."""
        scene = self.plan.scene_of(row)
        name = self._named(scene_digest(scene))
        folder = None if self.path is None else inside(self.path, RUNS, name)
        return name, SceneJob(scene, self.asked, folder, self.program)

    def _named(self, what: str) -> str:
        return digest(f"{what} {self.program} {self.asked.further}".encode())
