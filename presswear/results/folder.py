"""Result folder: its document ``result.json``, and writing into it.

One process at a time writes into a folder. A finished stage is stored at once. The
state of an unfinished run is stored in a checkpoint after every stage and at an
interval within a stage, so that an interrupted run resumes with the same numbers.
``result.json`` lists every file with its digest. Everything is checked before it is
used, and nothing that is read is executed.
"""

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np

from presswear.recording.observer import Observer
from presswear.results.life import FILE as LIFE
from presswear.results.life import WITHOUT_CURVES, LifeResult
from presswear.results.provenance import Provenance, provenance, versions_of
from presswear.results.stage import StageResult
from presswear.scene.differences import differences
from presswear.scene.scene import Scene
from presswear.tools.arrays import State, read_arrays, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import PART, FolderLock, is_free
from presswear.tools.processes import is_stopped
from presswear.tools.serialize import plain, read_json, typed, write_json

FILE = "result.json"
SCHEMA = 11
# Largest result.json: eight joints with surfaces of 100,000 bins have 43 MB, others 0.5 MB
_MOST_BYTES = 2**26
FINISHED = ("completed", "unconverged", "failed")  # statuses of a run that has ended
INTERVAL = 60.0  # s between two checkpoints within a stage


@dataclass(frozen=True)
class StoredCheckpoint:
    """Checkpoint of an unfinished run; two files take turns, so that one is always complete."""

    file: Literal["checkpoint-1.npz", "checkpoint-2.npz"]
    digest: str
    words: str  # description of the last stored cycle
    index: int  # number of the stage that runs


@dataclass
class StoredResult:
    """Content of ``result.json``."""

    scene: dict[str, Any]
    provenance: Provenance
    status: Literal["running", "interrupted", "completed", "unconverged", "failed"] = (
        "running"
    )
    message: str = ""
    wall_s: float = 0.0
    life: LifeResult | None = None
    stages: list[StageResult] = field(default_factory=list)  # without their arrays
    files: dict[str, str] = field(default_factory=dict)  # digests by name
    checkpoint: StoredCheckpoint | None = None

    def write(self, path: Path) -> None:
        """Write it into a folder."""
        write_json(path / FILE, {"schema": SCHEMA, **plain(self)})


def files_of(index: int) -> tuple[str, str]:
    """Return the files of a stage: its arrays and its film."""
    return f"stage-{index}.npz", f"film-{index}.npz"


def read_stored(path: Path) -> StoredResult:
    """Return the document of a folder; InputError names the first part that is wrong."""
    file = path / FILE
    missing = f"{path} is not a result folder: it has no {FILE}"
    if (path / "sweep.json").exists():
        missing += (
            "; it holds a sweep, which pw.load_sweep reads. A sweep holds whole results "
            "where it ran with keep = results"
        )
    elif (path / "diagram.json").exists():
        missing += "; it holds a bifurcation diagram, which pw.load_diagram reads"
    else:
        files_inside = [*path.glob(f"*/{FILE}"), *path.glob(f"*/*/{FILE}")]
        folders = sorted(f"{inside.parent}" for inside in files_inside)
        if folders:
            missing += f"; name one that it holds: {', '.join(folders[:3])}"
    document = read_json(file, missing, SCHEMA, _MOST_BYTES)
    stored = typed(document, StoredResult, f"{file}")
    indices = [stage.index for stage in stored.stages]
    files = set(chain.from_iterable(map(files_of, indices)))
    if stored.life and stored.life.ended not in WITHOUT_CURVES:
        files.add(LIFE)
    if indices != list(range(len(indices))) or files != stored.files.keys():
        unlike = ", ".join(sorted(files ^ stored.files.keys()))
        raise InputError(f"{file}: the stages {indices} and 'files' differ: {unlike}")
    return stored


def _is_looser(scene: Scene, key: str, old: Any, new: Any) -> bool:
    """Return whether a value is a looser tolerance of a service life."""
    return key == "tolerance" and scene.life is not None and new > old


class ResultFolder(Observer):
    """Result folder that a run writes into; files of others are never changed.

    As a context it is released at the end: an interrupted run can resume, and a run
    that is impossible before anything was computed leaves nothing.

    Parameters
    ----------
    interval : float
        Time between two checkpoints within a stage, s; 0: one after every cycle.
    resume : bool
        Whether to resume a run of the same scene that is in the folder.
    """

    # arrays of the checkpoint to resume from; None: from the start
    resumed: State | None = None
    # last stored cycle, once the folder is released
    stored_part = "stored up to its end"

    def __init__(
        self, path: Path, scene: Scene, interval: float = INTERVAL, resume: bool = False
    ) -> None:
        scene.check_trusted()
        free = is_free(path)
        if not free and not resume:
            remedy = "name a new folder, or resume its run (--resume)"
            raise InputError(f"folder {path}: it exists and is not empty; {remedy}")
        if not free and not (path / FILE).is_file():
            raise InputError(
                f"folder {path}: it contains no run to resume: it has no {FILE}"
            )
        self.path = path
        self.interval = interval
        self.remarks: list[str] = []  # lines for the user
        self._latest: Any = None
        self._lock = FolderLock(path)
        if self._lock.warning:
            self.remarks.append(self._lock.warning)
        try:
            if free:
                self._stored = StoredResult(plain(scene.as_dict()), provenance())
                if resume:
                    self.remarks.append(f"no run to resume in {path}: the run starts")
            else:
                self._stored = read_stored(path)
                self._resume(scene)
            self._saved = time.perf_counter()
            self._started = self._saved - self._stored.wall_s
            if not self.is_finished:
                self._write()
        except BaseException:
            self._lock.release()
            raise

    @property
    def is_finished(self) -> bool:
        """True if the run in it has ended."""
        return self._stored.status in FINISHED

    def _resume(self, scene: Scene) -> None:
        """Prepare to resume the run in the folder from its checkpoint.

        InputError unless the run is of the same scene and program.
        """
        stored = self._stored
        here = provenance()
        start = f"folder {self.path}: it holds a run of another scene: "
        changes = differences(stored.scene, plain(scene.as_dict()))
        looser = [change for change in changes if _is_looser(scene, *change)]
        self._refuse(start, [change for change in changes if change not in looser])
        before = versions_of(stored.provenance)
        now = versions_of(here)
        start = f"folder {self.path}: another program started this run, and numbers would differ: "
        self._refuse(
            start, [(name, before.get(name, "missing"), now[name]) for name in now]
        )
        for _, old, new in looser:
            self._loosen(old, new)
        if self.is_finished:
            return
        self._remove_unused_files()
        checkpoint = stored.checkpoint
        first = 0
        if checkpoint is None:
            self.remarks.append(
                f"{self.path} has no checkpoint yet: the run starts again"
            )
        else:
            self.resumed = read_arrays(self.path / checkpoint.file, checkpoint.digest)
            first = checkpoint.index
            self.remarks.append(f"resuming after {checkpoint.words}")
        # The stage that resumes is stored again, with all of the wear update after it.
        for stage in stored.stages[first:]:
            for name in files_of(stage.index):
                del stored.files[name]
        del stored.stages[first:]
        origin = stored.provenance
        if origin["machine"] != here["machine"]:
            machines = f"started on {origin['machine']}, resumed on {here['machine']}"
            self.remarks.append(f"{machines}: last digits may differ from here on")
        resumed = {"started": here["started"], "machine": here["machine"]}
        origin["resumed"] = [*origin.get("resumed", []), resumed]
        stored.status = "running"
        stored.message = ""

    def _remove_unused_files(self) -> None:
        """Remove files that are written in part, and checkpoints that are not used."""
        checkpoint = self._stored.checkpoint
        used = "" if checkpoint is None else checkpoint.file
        for file in self.path.iterdir():
            is_part = file.name.startswith((FILE, "stage-", "film-", "report.html"))
            is_checkpoint = file.name.startswith("checkpoint") and file.name != used
            if is_checkpoint or (is_part and file.name.endswith(PART)):
                file.unlink()

    def _loosen(self, old: float, new: float) -> None:
        """Continue a service life with a looser tolerance; a known life may meet it already."""
        stored = self._stored
        error = stored.life.error if stored.life else None
        is_met = stored.status == "unconverged" and error is not None and error <= new
        if self.is_finished and not is_met:
            return
        stored.scene["tolerance"] = new
        self.remarks.append(f"the tolerance is {new:g} from here on; it was {old:g}")
        if is_met:
            stored.status = "completed"
            stored.message = ""
            stored.write(self.path)

    @staticmethod
    def _refuse(start: str, pairs: Iterable[tuple[str, Any, Any]]) -> None:
        """Raise InputError if any value there differs from the value here."""
        items = [
            f"{key} is {old} there and {new} here"
            for key, old, new in pairs
            if old != new
        ]
        if items:
            raise InputError(f"{start}{', '.join(items)}; name a new folder")

    def on_stage(self, stage: StageResult) -> None:
        """Store a finished stage."""
        numbers, frames = files_of(stage.index)
        with self._writing():
            self._stored.files[numbers] = write_arrays(
                self.path / numbers, stage.arrays
            )
            # Compressing a film would take longer than the rest and save a tenth.
            film = stage.film.arrays(stage.joint_names)
            self._stored.files[frames] = write_arrays(
                self.path / frames, film, np.savez
            )
        self._stored.stages.append(replace(stage, arrays={}, read_film=None))
        self._write()

    def on_life(self, life: LifeResult) -> None:
        """Store a service life; the curves of a preliminary one are left out."""
        if life.ended not in WITHOUT_CURVES:
            with self._writing():
                self._stored.files[LIFE] = write_arrays(self.path / LIFE, life.curves)
        self._stored.life = life
        self._write()

    def on_checkpoint(self, checkpoint: Any, is_stage: bool) -> None:
        """Store a checkpoint at the end of a stage, or when it is due."""
        self._latest = checkpoint
        self._check()
        if is_stage or time.perf_counter() - self._saved >= self.interval:
            self._save()

    def _save(self) -> None:
        """Write the latest checkpoint; the one before stays until that is done."""
        if self._latest is None:
            return
        before = self._stored.checkpoint
        is_second = before is not None and before.file == "checkpoint-1.npz"
        file: Any = "checkpoint-2.npz" if is_second else "checkpoint-1.npz"
        with self._writing():
            digest = write_arrays(self.path / file, self._latest.save(), np.savez)
        latest = self._latest
        self._replace_checkpoint(
            StoredCheckpoint(file, digest, latest.words, latest.index)
        )
        self._saved = time.perf_counter()

    def _replace_checkpoint(self, checkpoint: StoredCheckpoint | None) -> None:
        before = self._stored.checkpoint
        self._stored.checkpoint = checkpoint
        self._write()
        if before is not None:
            (self.path / before.file).unlink(missing_ok=True)

    def close(self, status: Any, message: str) -> None:
        """Store how the run ended, and release the folder."""
        self._stored.status = status
        self._stored.message = message
        self._replace_checkpoint(None)
        self._lock.release()

    def interrupt(self) -> None:
        """Store the latest checkpoint of an interrupted run, and release the folder."""
        if self._lock.is_released:
            return
        self._save()
        self._stored.status = "interrupted"
        self._stored.message = "stopped by the user; the run can be resumed"
        self._write()
        self._lock.release()
        words = self._latest and f"stored up to {self._latest.words}"
        self.stored_part = words or "nothing was computed yet"

    def store_error(self, error: Exception) -> None:
        """Store the error that stopped the run; the run can be resumed."""
        if self._lock.is_held():
            reason, *_ = f"{type(error).__name__}: {error}".splitlines()
            self._stored.message = f"stopped by {reason}"
            self._write()

    def discard(self) -> None:
        """Remove the files of a run that computed nothing."""
        stored = self._stored
        if not stored.stages and stored.checkpoint is None and self._lock.is_held():
            for name in (FILE, *stored.files):
                (self.path / name).unlink(missing_ok=True)
            self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: object, error: BaseException | None, trace: object
    ) -> None:
        try:
            # After a signal any error is treated as an interrupt.
            is_interrupt = isinstance(error, KeyboardInterrupt)
            if is_interrupt or (error is not None and is_stopped()):
                self.interrupt()
            elif isinstance(error, InputError):
                self.discard()
            elif isinstance(error, Exception) and not isinstance(error, RunFailed):
                self.store_error(error)
        finally:
            self._lock.release()

    def _write(self) -> None:
        self._stored.wall_s = time.perf_counter() - self._started
        with self._writing():
            self._stored.write(self.path)

    def _check(self) -> None:
        """Raise RunFailed if the folder is gone, or has been replaced by another."""
        if not self._lock.is_held():
            raise RunFailed(
                f"the folder {self.path} was removed or replaced; the run has stopped"
            )

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Raise RunFailed if the folder is gone or cannot be written."""
        self._check()
        try:
            yield
        except OSError as error:
            fault = f"{error.filename} cannot be written: {error.strerror}"
            raise RunFailed(
                f"{fault}; the run has stopped, earlier files are intact"
            ) from error
