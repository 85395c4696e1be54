"""A result folder being written, one process at a time, and going on in one.

What is finished is stored at once; where the run stands is kept in a checkpoint after
every stage and at an interval within one, so that a run that is stopped in any way goes on
with the same numbers.  ``result.json`` lists every file with its digest, the checkpoint's
included, and ends with its own.
"""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

import numpy as np

from presswear.recording.observer import Observer, Progress
from presswear.results.life import FILE as LIFE
from presswear.results.life import LifeResult
from presswear.results.provenance import Provenance, provenance, provenance_differs
from presswear.results.result import FILE, FINISHED, SCHEMA, read_document
from presswear.results.stage import StageResult
from presswear.results.stored import checkpoint_file, files_of, stored_result
from presswear.scene.scene import Scene
from presswear.scene.settings import differences
from presswear.tools.arrays import State, read_arrays, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import PART, FolderLock, is_free
from presswear.tools.processes import is_stopped
from presswear.tools.serialize import plain, write_json

_LOG = logging.getLogger(__name__)

INTERVAL = 60.0
"""Between two checkpoints within a stage, s."""
LEAST_WAIT = 100.0
"""A checkpoint waits at least so many times as long as the last one took to write, so that all
of them cost less than 1 % of a run."""

CHECKPOINT = "checkpoint"
"""Key of ``result.json``."""


class Storable(Protocol):
    """Checkpoint of a campaign."""

    @property
    def index(self) -> int:
        """Index of the stage that runs."""

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""

    def save(self) -> State:
        """Return it as named arrays of numbers."""


class ResultFolder(Observer):
    """A result folder being written; nobody else's files are ever touched.

    As a context it is given free at the end: interrupted it can be gone on with, and a run that
    turned out to be impossible before anything came of it leaves nothing.

    Attributes
    ----------
    path : Path
    resumed : State or None
        Arrays of the checkpoint to resume from; None: from the start.
    remarks : list of str
        Lines for the person who started it.
    kept : str
        Up to where everything is kept, once it is given free.
    interval : float
        Time between two checkpoints within a stage, s.
    """

    def __init__(
        self, path: Path, scene: Scene, interval: float = INTERVAL, resume: bool = False
    ) -> None:
        """Begin in a new folder, or go on in one.

        Parameters
        ----------
        interval : float
            Time between two checkpoints within a stage, s; 0: one after every cycle.
        resume : bool
            True: go on with a run of the same scene that is in it.
        """
        scene.check_trusted()
        free = is_free(path)
        if not free and not resume:
            raise InputError(
                f"--out {path}: it exists and is not empty; name a new folder, or go on with the "
                "run in it by --resume"
            )
        if not free and not (path / FILE).is_file():
            raise InputError(f"--out {path}: it holds no run to go on with: it has no {FILE}")
        self.path = path
        self.resumed: State | None = None
        self.remarks: list[str] = []
        self.kept = "kept up to its end"
        self._scene = scene
        self.interval = interval
        self._latest: Storable | None = None
        self._took = 0.0
        self._lock = FolderLock(path)
        if self._lock.warning:
            self.remarks.append(self._lock.warning)
        try:
            self._document = self._new() if free else self._stored()
            self._began = self._saved = time.perf_counter()
            self._earlier = float(self._document["wall_s"])
            if free and resume:
                self.remarks.append(f"nothing to go on with in {path}: the run begins")
            if not self.is_finished:
                self._write()
        except BaseException:
            self._lock.release()
            raise

    @property
    def is_finished(self) -> bool:
        """True where the run in it has come to its end."""
        return self._document["status"] in FINISHED

    def _new(self) -> dict[str, Any]:
        scene = self._scene.as_dict()
        return {
            "schema": SCHEMA,
            "scene": scene,
            "conventions": scene["conventions"],
            "engine": self._scene.engine,
            "provenance": provenance(),
            "status": "running",
            "message": "",
            "wall_s": 0.0,
            "life": None,
            "stages": [],
            "files": {},
            CHECKPOINT: None,
        }

    def _stored(self) -> dict[str, Any]:
        """The document of the run that is gone on with, and its checkpoint."""
        document = read_document(self.path)
        stored_result(document, self.path / FILE)
        here = provenance()
        _check_same(self.path, document, self._scene, here)
        if document["status"] in FINISHED:
            return document
        told = document[CHECKPOINT]
        name = "" if told is None else checkpoint_file(told["turn"])
        for item in self.path.iterdir():
            ours = item.name.startswith((FILE, CHECKPOINT, "stage-", "film-", "report.html"))
            is_left = item.name.startswith(CHECKPOINT) and item.name != name
            if ours and (item.name.endswith(PART) or is_left):
                item.unlink()
        first = 0
        if told is None:
            self.remarks.append(f"{self.path} has no checkpoint yet: the run begins anew")
        else:
            arrays = read_arrays(self.path / name, document["files"][name])
            self.resumed = arrays
            first = told["index"]
            self.remarks.append(f"going on after {told['words']}")
        # The stage that is gone on with is stored again, with all of the wear after it.
        for stage in document["stages"][first:]:
            for name in files_of(stage["index"]):
                del document["files"][name]
        del document["stages"][first:]
        if document["provenance"]["machine"] != here["machine"]:
            self.remarks.append(
                f"begun on {document['provenance']['machine']}, going on on {here['machine']}: "
                "from here on last digits may differ"
            )
        again = {"started": here["started"], "machine": here["machine"]}
        resumed = [*document["provenance"].get("resumed", []), again]
        document["provenance"] = {**document["provenance"], "resumed": resumed}
        document["status"], document["message"] = "running", ""
        return document

    def on_stage(self, stage: StageResult) -> None:
        """Store a finished stage."""
        numbers, frames = files_of(stage.index)
        with self._writing():
            files = self._document["files"]
            files[numbers] = write_arrays(self.path / numbers, stage.arrays)
            # Compressing would take longer than all else about a film and win a tenth.
            film = stage.film.arrays(stage.joint_names)
            files[frames] = write_arrays(self.path / frames, film, np.savez)
        self._document["stages"].append(stage.as_dict())
        self._write()

    def on_life(self, life: LifeResult) -> None:
        """Store a life that is known."""
        with self._writing():
            digest = write_arrays(self.path / LIFE, life.curves)
        self._document["files"][LIFE] = digest
        self._document["life"] = life.as_dict()
        self._write()

    def on_progress(self, progress: Progress) -> None:
        """See whether the folder is still there."""
        self._check()

    def on_checkpoint(self, checkpoint: Storable, is_stage: bool) -> None:
        """Note where the run stands, and write it down at the end of a stage or when it is due."""
        self._latest = checkpoint
        self._check()
        waited = time.perf_counter() - self._saved
        due = self.interval == 0.0 or waited >= max(self.interval, LEAST_WAIT * self._took)
        if is_stage or due:
            self._save()

    def _save(self) -> None:
        """Write down where the run stands; the last checkpoint stays until that is done."""
        if self._latest is None:
            return
        began = time.perf_counter()
        arrays = self._latest.save()
        before = self._document[CHECKPOINT]
        turn = 1 if before is None else 3 - before["turn"]
        name = checkpoint_file(turn)
        with self._writing():
            digest = write_arrays(self.path / name, arrays, np.savez)
        self._forget_checkpoint()
        self._document["files"][name] = digest
        words = self._latest.words
        self._document[CHECKPOINT] = {"turn": turn, "words": words, "index": self._latest.index}
        self._write()
        if before is not None:
            (self.path / checkpoint_file(before["turn"])).unlink(missing_ok=True)
        self._saved = time.perf_counter()
        self._took = self._saved - began
        _LOG.info("checkpoint in %s: %s", self.path, words)

    def close(self, status: str, message: str) -> None:
        """State how the run ended, and give the folder free."""
        self._document["status"], self._document["message"] = status, message
        last = self._forget_checkpoint()
        self._write()
        if last:
            (self.path / last).unlink(missing_ok=True)
        self._lock.release()

    def _forget_checkpoint(self) -> str:
        """Take the checkpoint out of the document; returns the name of its file, or nothing."""
        checkpoint = self._document[CHECKPOINT]
        if checkpoint is None:
            return ""
        name = checkpoint_file(checkpoint["turn"])
        del self._document["files"][name]
        self._document[CHECKPOINT] = None
        return name

    def interrupt(self) -> None:
        """Write down where the run stands when somebody stops it, and give the folder free."""
        if self._lock.is_released:
            return
        self._save()
        self._document["status"] = "interrupted"
        self._document["message"] = "stopped by the user; it can be gone on with"
        self._write()
        self._lock.release()
        words = self._latest and f"kept up to {self._latest.words}"
        self.kept = words or "nothing was computed yet"

    def discard(self) -> None:
        """Remove what a run left that turned out to be impossible before anything came of it."""
        if not self._document["stages"] and self._lock.is_held():
            for name in (FILE, *self._document["files"]):
                (self.path / name).unlink(missing_ok=True)
            self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            # Behind a signal any error is an interrupt.
            if isinstance(error, KeyboardInterrupt) or (error is not None and is_stopped()):
                self.interrupt()
            elif isinstance(error, InputError):
                self.discard()
        finally:
            self._lock.release()

    def _write(self) -> None:
        self._document["wall_s"] = self._earlier + time.perf_counter() - self._began
        with self._writing():
            write_json(self.path / FILE, self._document)

    def _check(self) -> None:
        """RunFailed where the folder is gone, or is another than the one that was begun in."""
        if not self._lock.is_held():
            raise RunFailed(
                f"the folder {self.path} was removed or replaced while the run was at work in it: "
                "the run has stopped, and nothing was written elsewhere"
            )

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """RunFailed where the folder is gone or cannot be written."""
        self._check()
        try:
            yield
        except OSError as error:
            raise RunFailed(
                f"{error.filename} cannot be written: {error.strerror}; the run has stopped, what "
                "was stored before is whole"
            ) from error


def _check_same(path: Path, document: dict[str, Any], scene: Scene, here: Provenance) -> None:
    """InputError naming what differs unless a folder's run is one of this scene and program."""
    apart = differences(document["scene"], plain(scene.as_dict()))
    if apart:
        told = ", ".join(f"{key} is {there} there and {own} here" for key, there, own in apart)
        raise InputError(f"--out {path}: it holds a run of another scene: {told}")
    versions = provenance_differs(document["provenance"], here)
    if versions:
        raise InputError(
            f"--out {path}: it was begun by another program, with which its numbers would not "
            f"agree: {versions}"
        )
