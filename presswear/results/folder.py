"""A result folder being written, one process at a time, and going on in one.

What is finished is stored at once; where the run stands is kept in a checkpoint after
every stage and at an interval within one, so that a run that is stopped in any way goes on
with the same numbers.  ``result.json`` lists every file with its digest and ends with its own.
"""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from presswear.campaign.campaign import Stage
from presswear.results.checkpoint import FILE as CHECKPOINT
from presswear.results.checkpoint import read_checkpoint, write_checkpoint
from presswear.tools.errors import InputError, RunError
from presswear.tools.files import PART, sealed_json, write_arrays, write_bytes
from presswear.tools.lock import is_free, make_folder, remove_empty, take_folder
from presswear.results.provenance import provenance, provenance_differs
from presswear.results.results import FILE, FINISHED, SCHEMA, plain, read_document, stage_arrays
from presswear.scene.scene import Scene
from presswear.scene.settings import differences
from presswear.campaign.standing import Standing

INTERVAL = 60.0
"""Between two checkpoints within a stage, s."""
LEAST_WAIT = 100.0
"""A checkpoint waits at least so many times as long as the last one took to write, so that all
of them cost less than 1 % of a run."""


class ResultFolder:
    """A result folder being written; nobody else's files are ever touched.

    Attributes
    ----------
    path : Path
    begun : Standing or None
        Where a run that is gone on with stands; None: from the start.
    remarks : list of str
        What a person has to know about it.
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
            Whether a run of the same scene in it is gone on with.
        """
        free = is_free(path)
        if not free and not resume:
            raise InputError(
                f"--out {path}: it exists and is not empty; name a new folder, or go on with the "
                "run in it by --resume"
            )
        if not free and not (path / FILE).is_file():
            raise InputError(f"--out {path}: it holds no run to go on with: it has no {FILE}")
        self.path = path
        self.begun: Standing | None = None
        self.remarks: list[str] = []
        self._scene = scene
        self._interval = interval
        self._latest: Standing | None = None
        self._took = 0.0
        new = make_folder(path)
        self._lock = take_folder(path)
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
            remove_empty(new)
            raise

    @property
    def is_finished(self) -> bool:
        """Whether the run in it has come to its end."""
        return self._document["status"] in FINISHED

    @property
    def outcome(self) -> tuple[str, str]:
        """Status and message."""
        return self._document["status"], self._document["message"]

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
            "stages": [],
            "files": {},
        }

    def _stored(self) -> dict[str, Any]:
        """The document of the run that is gone on with, and where that stands."""
        document = read_document(self.path)
        here = provenance()
        _check_same(self.path, document, self._scene, here)
        if document["status"] in FINISHED:
            return document
        for item in self.path.glob(f"*{PART}"):
            if item.name.startswith((FILE, CHECKPOINT, "stage-", "film-", "report.html")):
                item.unlink()
        if (self.path / CHECKPOINT).exists():
            told, arrays = read_checkpoint(self.path)
            if told["started"] != document["provenance"]["started"]:
                raise InputError(f"{self.path / CHECKPOINT} belongs to another run")
            self.begun = self._latest = Standing.restored(self._scene, told, arrays)
            document["wall_s"] = max(told["wall_s"], document["wall_s"])
            self.remarks.append(f"going on after {self.begun.words()}")
        else:
            self.remarks.append(f"{self.path} has no checkpoint yet: the run begins anew")
        first = 0 if self.begun is None else self.begun.index
        document["stages"] = [stage for stage in document["stages"] if stage["index"] < first]
        kept = [name for k in range(first) for name in _files_of(k)]
        document["files"] = {name: document["files"][name] for name in kept}
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

    def add(self, stage: Stage) -> None:
        """Store a finished stage."""
        ensemble = stage.ensemble
        joints = [joint.name for joint in ensemble.linkage.clearances]
        arrays = stage_arrays(self._scene, stage)
        film = ensemble.recorders[0].film.arrays(joints)
        numbers, frames = _files_of(stage.index)
        with self._writing():
            files = self._document["files"]
            files[numbers] = write_arrays(self.path / numbers, arrays)
            # Compressing would take longer than all else about a film and win a tenth.
            files[frames] = write_arrays(self.path / frames, film, np.savez)
        self._document["stages"].append(
            {
                "index": stage.index,
                "status": ensemble.status,
                "message": ensemble.failure,
                "finding": stage.finding.as_dict() if stage.finding else None,
                "amplification": stage.amplification,
                "wear_steps": [step.as_dict() for step in stage.steps],
                "simulated_s": ensemble.time,
                "wall_s": ensemble.wall,
                "diagnostics": ensemble.diagnostics(),
                "statistics": stage.statistics,
            }
        )
        self._write()

    def keep(self, standing: Standing, is_stage: bool) -> None:
        """Note where the run stands, and write it down at the end of a stage or when it is due."""
        self._latest = standing
        self._check()
        waited = time.perf_counter() - self._saved
        due = self._interval == 0.0 or waited >= max(self._interval, LEAST_WAIT * self._took)
        if is_stage or due:
            self._save()

    def _save(self) -> None:
        """Write down where the run stands."""
        if self._latest is None:
            return
        began = time.perf_counter()
        document, arrays = self._latest.stored()
        started = self._document["provenance"]["started"]
        with self._writing():
            write_checkpoint(
                self.path, {**document, "started": started, "wall_s": self._wall()}, arrays
            )
        self._saved = time.perf_counter()
        self._took = self._saved - began

    def close(self, status: str, message: str) -> None:
        """State how the run ended, and give the folder free."""
        self._document["status"], self._document["message"] = status, message
        self._write()
        (self.path / CHECKPOINT).unlink(missing_ok=True)
        self._lock.release()

    def interrupt(self) -> str:
        """Write down where the run stands when somebody stops it; says what is kept."""
        if self._lock.is_released:
            return "its end"
        self._save()
        self._document["status"] = "interrupted"
        self._document["message"] = "stopped by the user; it can be gone on with"
        self._write()
        self._lock.release()
        return "nothing was computed yet" if self._latest is None else self._latest.words()

    def discard(self) -> None:
        """Remove what a run left that turned out to be impossible before anything came of it."""
        if not self._document["stages"] and self._lock.is_held():
            for name in (FILE, CHECKPOINT):
                (self.path / name).unlink(missing_ok=True)
            self._lock.release()
            if not any(self.path.iterdir()):
                self.path.rmdir()

    def release(self) -> None:
        """Give the folder free as it is."""
        self._lock.release()

    def _wall(self) -> float:
        return self._earlier + time.perf_counter() - self._began

    def _write(self) -> None:
        self._document["wall_s"] = self._wall()
        with self._writing():
            write_bytes(self.path / FILE, sealed_json(plain(self._document)))

    def _check(self) -> None:
        """RunError where the folder is gone, or is another than the one that was begun in."""
        if not self._lock.is_held():
            raise RunError(
                f"the folder {self.path} was removed or replaced while the run was at work in it: "
                "the run has stopped, and nothing was written elsewhere"
            )

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """RunError where the folder is gone or cannot be written."""
        self._check()
        try:
            yield
        except OSError as error:
            raise RunError(
                f"{error.filename} cannot be written: {error.strerror}; the run has stopped, what "
                "was stored before is whole"
            ) from error


def _files_of(index: int) -> tuple[str, str]:
    """Files of a stage: its arrays and its film."""
    return f"stage-{index}.npz", f"film-{index}.npz"


def _check_same(path: Path, document: dict[str, Any], scene: Scene, here: dict[str, Any]) -> None:
    """InputError naming what differs unless a folder's run is one of this scene and program."""
    # Through JSON, as the folder's own has gone.
    wanted = json.loads(json.dumps(plain(scene.as_dict())))
    apart = differences(document["scene"], wanted)
    if apart:
        told = ", ".join(f"{key} is {there} there and {own} here" for key, there, own in apart)
        raise InputError(f"--out {path}: it holds a run of another scene: {told}")
    versions = provenance_differs(document["provenance"], here)
    if versions:
        raise InputError(
            f"--out {path}: it was begun by another program, with which its numbers would not "
            f"agree: {versions}"
        )
