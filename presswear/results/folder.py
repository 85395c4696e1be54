"""Result folder: its document ``result.json`` with provenance and checks, and writing into it.

One process at a time writes into a folder.  A finished stage is stored at once.  The state of an
unfinished run is stored in a checkpoint after every stage and at an interval within one, so that a
run that is stopped in any way resumes with the same numbers.  ``result.json`` lists every file with
its digest.

Files may be damaged, of another version or made by somebody else: everything is checked before it
is used, and nothing in them is executed.
"""

import hashlib
import logging
import os
import platform
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NotRequired, Protocol, Self, TypedDict

import numpy as np

from presswear.linkage.surface import SIDES
from presswear.recording.observer import Observer, Progress
from presswear.results.life import FILE as LIFE
from presswear.results.life import LifeResult
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.scene.settings import differences
from presswear.tools.arrays import State, read_arrays, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.exudyn import requested
from presswear.tools.files import PART, FolderLock, is_free
from presswear.tools.processes import is_stopped
from presswear.tools.serialize import plain, read_json, typed, write_json

_LOG = logging.getLogger(__name__)

FILE = "result.json"
SCHEMA = 9
FINISHED = ("completed", "unconverged", "failed")  # statuses of a run that has ended
INTERVAL = 60.0  # s between two checkpoints within a stage
MIN_WAIT = 100.0  # times that a checkpoint took to write, before the next: they cost below 1 %
CHECKPOINT = "checkpoint"  # key of the document
MAX_NAMED = 3  # results that a message names

PACKAGES = ("presswear", "exudyn", "numpy", "scipy", "numba", "matplotlib")
_SOURCE = Path(__file__).resolve().parents[1]


class Provenance(TypedDict):
    """Versions, revision, machine and date (UTC); ``resumed``: machine and date of each resume."""

    python: str
    packages: dict[str, str]
    revision: str
    source: str
    machine: str
    started: str
    resumed: NotRequired[list[dict[str, str]]]


def provenance() -> Provenance:
    """Return the provenance of numbers that are computed here and now."""
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "revision": source_revision(),
        "source": source_digest(),
        "machine": f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores",
        "started": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


def _version(package: str) -> str:
    """Return a version; of Exudyn also its module, since last digits differ between modules."""
    return f"{version(package)}, {requested()}" if package == "exudyn" else version(package)


def source_revision() -> str:
    """Return the git revision of the source, or ``unknown``."""
    try:
        process = subprocess.run(
            ["git", "-C", str(_SOURCE), "describe", "--always", "--dirty", "--abbrev=12"],
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return process.stdout.strip()


def source_digest() -> str:
    """Return the digest of the package's modules: it distinguishes changes of one revision."""
    sha = hashlib.sha256()
    for path in sorted(_SOURCE.rglob("*.py")):
        sha.update(path.relative_to(_SOURCE).as_posix().encode())
        sha.update(path.read_bytes())
    return sha.hexdigest()[:16]


@cache
def program_digest() -> str:
    """Return the digest of source and versions that must agree for two processes to agree.

    The package that draws the figures is left out.
    """
    parts = [platform.python_version(), source_digest(), *map(_version, PACKAGES[:-1])]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def provenance_differs(stored: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Return a text on differences that change numbers, or nothing.

    The same source may be installed in one place and checked out in another, where git knows its
    revision: if the source is the same, so is the revision.
    """
    names = ["python", "source"]
    if stored["source"] != here["source"]:
        names.insert(1, "revision")
    pairs = {name: (stored[name], here[name]) for name in names}
    for name in PACKAGES[:-1]:
        pairs[name] = (stored["packages"].get(name), here["packages"][name])
    return ", ".join(
        f"{name} {there} there and {item} here"
        for name, (there, item) in pairs.items()
        if there != item
    )


@dataclass(frozen=True)
class StoredCheckpoint:
    """Checkpoint of an unfinished run: turn of its file, last stored cycle, index of the stage."""

    turn: Literal[1, 2]
    words: str
    index: int


@dataclass(frozen=True)
class StoredResult:
    """Content of ``result.json``; the scene is checked by ``Scene`` itself.

    Attributes
    ----------
    stages : tuple of StageResult
        Without their arrays.
    files : dict
        Digests by the names of files.
    """

    scene: dict[str, Any]
    conventions: dict[str, str]
    engine: str
    provenance: Provenance
    status: Literal["running", "interrupted", "completed", "unconverged", "failed"]
    message: str
    wall_s: float
    life: LifeResult | None
    stages: tuple[StageResult, ...]
    files: dict[str, str]
    checkpoint: StoredCheckpoint | None


def files_of(index: int) -> tuple[str, str]:
    """Return the files of a stage: its arrays and its film."""
    return f"stage-{index}.npz", f"film-{index}.npz"


def checkpoint_file(turn: int) -> str:
    """Return the name of a checkpoint's file; two take turns, so that one is always complete."""
    return f"checkpoint-{turn}.npz"


def read_document(path: Path) -> dict[str, Any]:
    """Return the content of ``result.json``; InputError if it is missing, damaged or too new."""
    missing = ""
    if not (path / FILE).exists():
        missing = f"{path} is no result folder: it has no {FILE}"
        inner = sorted(
            item.parent for depth in ("*", "*/*") for item in path.glob(f"{depth}/{FILE}")
        )
        if inner:
            more = f" and {len(inner) - MAX_NAMED} more" if len(inner) > MAX_NAMED else ""
            missing += f"; name one that it holds: {', '.join(map(str, inner[:MAX_NAMED]))}{more}"
        elif (path / "sweep.json").exists():
            missing += "; a sweep holds whole results where it ran with --keep all"
    return read_json(path / FILE, missing, SCHEMA)


def stored_result(document: Any, file: Path) -> StoredResult:
    """Return the document of a result; InputError names the first part that is wrong.

    Joints are left for ``check_joints``, which needs the scene's.
    """
    stored = typed(document, StoredResult, f"{file}")
    files = set() if stored.checkpoint is None else {checkpoint_file(stored.checkpoint.turn)}
    files |= set() if stored.life is None else {LIFE}
    for place, stage in enumerate(stored.stages):
        # Readers take the place for the number of wear updates.
        if stage.index != place:
            where = f"{file}: stages[{place}]"
            raise InputError(f"{where}.index is {stage.index}; {place} is expected")
        files |= {*files_of(place)}
    for name in sorted(files ^ stored.files.keys()):
        how = "lacks" if name in files else "has"
        raise InputError(f"{file}: 'files' {how} {name!r}, unlike its stages and checkpoint")
    return stored


def check_joints(
    stored: StoredResult, joints: tuple[str, ...], wear_updates: int, file: Path
) -> None:
    """Raise InputError if a result and the joints with clearance of its scene do not agree."""
    count = len(stored.stages)
    if count > wear_updates + 1:
        raise InputError(
            f"{file}: {count} stages, where the scene has wear_updates = {wear_updates}"
        )
    for stage in stored.stages:
        groups: list[Mapping[str, Any]] = []
        if stage.statistics.output is not None:
            groups.append(stage.statistics.joints)
        for step in stage.wear_steps:
            groups += [step.max_depth, step.peak_force]
        for group in groups:
            if set(group) != set(joints):
                raise InputError(
                    f"{file}: stages[{stage.index}] tells of joints {', '.join(group) or 'none'}, "
                    f"where the scene has clearance at {', '.join(joints) or 'none'}"
                )
        for sides in (item for step in stage.wear_steps for item in step.max_depth.values()):
            if set(sides) != set(SIDES):
                raise InputError(
                    f"{file}: stages[{stage.index}].wear_steps tells of {', '.join(sides)}; "
                    f"{', '.join(SIDES)} are expected"
                )


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
    """Result folder that a run writes into; files of others are never changed.

    As a context it is released at the end: an interrupted run can resume, and a run that is
    impossible before anything was computed leaves nothing.

    Attributes
    ----------
    path : Path
    resumed : State or None
        Arrays of the checkpoint to resume from; None: from the start.
    remarks : list of str
        Lines for the user.
    kept : str
        Last stored cycle, once it is released.
    interval : float
        Time between two checkpoints within a stage, s.
    """

    def __init__(
        self, path: Path, scene: Scene, interval: float = INTERVAL, resume: bool = False
    ) -> None:
        """Start in a new folder, or resume in one.

        Parameters
        ----------
        interval : float
            Time between two checkpoints within a stage, s; 0: one after every cycle.
        resume : bool
            Whether to resume a run of the same scene that is in it.
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
        self.path, self.interval, self._scene = path, interval, scene
        self.resumed: State | None = None
        self.remarks: list[str] = []
        self.kept = "kept up to its end"
        self._latest: Storable | None = None
        self._write_time = 0.0
        self._lock = FolderLock(path)
        if self._lock.warning:
            self.remarks.append(self._lock.warning)
        try:
            self._document = self._new_document() if free else self._resume()
            self._started = self._saved = time.perf_counter()
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
        """True if the run in it has ended."""
        return self._document["status"] in FINISHED

    def _new_document(self) -> dict[str, Any]:
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

    def _resume(self) -> dict[str, Any]:
        """Return the document of the run to resume, and read its checkpoint."""
        document = read_document(self.path)
        stored_result(document, self.path / FILE)
        here = provenance()
        self._check_same(document, here)
        if document["status"] in FINISHED:
            return document
        checkpoint = document[CHECKPOINT]
        name = "" if checkpoint is None else checkpoint_file(checkpoint["turn"])
        for item in self.path.iterdir():
            ours = item.name.startswith((FILE, CHECKPOINT, "stage-", "film-", "report.html"))
            is_left = item.name.startswith(CHECKPOINT) and item.name != name
            if ours and (item.name.endswith(PART) or is_left):
                item.unlink()
        first = 0
        if checkpoint is None:
            self.remarks.append(f"{self.path} has no checkpoint yet: the run begins anew")
        else:
            self.resumed = read_arrays(self.path / name, document["files"][name])
            first = checkpoint["index"]
            self.remarks.append(f"going on after {checkpoint['words']}")
        # The stage that resumes is stored again, with all of the wear update after it.
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

    def _check_same(self, document: dict[str, Any], here: Provenance) -> None:
        """Raise InputError unless the run in the folder is of the same scene and program."""
        changes = differences(document["scene"], plain(self._scene.as_dict()))
        if changes:
            text = ", ".join(
                f"{key} is {there} there and {item} here" for key, there, item in changes
            )
            raise InputError(f"--out {self.path}: it holds a run of another scene: {text}")
        versions = provenance_differs(document["provenance"], here)
        if versions:
            raise InputError(
                f"--out {self.path}: it was begun by another program, with which its numbers would "
                f"not agree: {versions}"
            )

    def on_stage(self, stage: StageResult) -> None:
        """Store a finished stage."""
        numbers, frames = files_of(stage.index)
        with self._writing():
            files = self._document["files"]
            files[numbers] = write_arrays(self.path / numbers, stage.arrays)
            # Compressing a film would take longer than the rest and save a tenth.
            film = stage.film.arrays(stage.joint_names)
            files[frames] = write_arrays(self.path / frames, film, np.savez)
        self._document["stages"].append(stage.as_dict())
        self._write()

    def on_life(self, life: LifeResult) -> None:
        """Store a service life."""
        with self._writing():
            digest = write_arrays(self.path / LIFE, life.curves)
        self._document["files"][LIFE] = digest
        self._document["life"] = life.as_dict()
        self._write()

    def on_progress(self, progress: Progress) -> None:
        """Check that the folder is still there."""
        self._check()

    def on_checkpoint(self, checkpoint: Storable, is_stage: bool) -> None:
        """Store a checkpoint at the end of a stage, or when it is due."""
        self._latest = checkpoint
        self._check()
        waited = time.perf_counter() - self._saved
        wait = max(self.interval, MIN_WAIT * self._write_time)
        if is_stage or self.interval == 0.0 or waited >= wait:
            self._save()

    def _save(self) -> None:
        """Write the latest checkpoint; the one before stays until that is done."""
        if self._latest is None:
            return
        start = time.perf_counter()
        before = self._document[CHECKPOINT]
        turn = 1 if before is None else 3 - before["turn"]
        name = checkpoint_file(turn)
        with self._writing():
            digest = write_arrays(self.path / name, self._latest.save(), np.savez)
        self._remove_checkpoint()
        self._document["files"][name] = digest
        words = self._latest.words
        self._document[CHECKPOINT] = {"turn": turn, "words": words, "index": self._latest.index}
        self._write()
        if before is not None:
            (self.path / checkpoint_file(before["turn"])).unlink(missing_ok=True)
        self._saved = time.perf_counter()
        self._write_time = self._saved - start
        _LOG.info("checkpoint in %s: %s", self.path, words)

    def _remove_checkpoint(self) -> str:
        """Remove the checkpoint from the document; return the name of its file, or nothing."""
        checkpoint = self._document[CHECKPOINT]
        if checkpoint is None:
            return ""
        name = checkpoint_file(checkpoint["turn"])
        del self._document["files"][name]
        self._document[CHECKPOINT] = None
        return name

    def close(self, status: str, message: str) -> None:
        """Store how the run ended, and release the folder."""
        self._document["status"], self._document["message"] = status, message
        last = self._remove_checkpoint()
        self._write()
        if last:
            (self.path / last).unlink(missing_ok=True)
        self._lock.release()

    def interrupt(self) -> None:
        """Store the latest checkpoint of an interrupted run, and release the folder."""
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
        """Remove the files of a run that computed nothing."""
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
            # After a signal any error is treated as an interrupt.
            if isinstance(error, KeyboardInterrupt) or (error is not None and is_stopped()):
                self.interrupt()
            elif isinstance(error, InputError):
                self.discard()
        finally:
            self._lock.release()

    def _write(self) -> None:
        self._document["wall_s"] = self._earlier + time.perf_counter() - self._started
        with self._writing():
            write_json(self.path / FILE, self._document)

    def _check(self) -> None:
        """Raise RunFailed if the folder is gone, or has been replaced by another."""
        if not self._lock.is_held():
            raise RunFailed(
                f"the folder {self.path} was removed or replaced while the run was at work in it: "
                "the run has stopped, and nothing was written elsewhere"
            )

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Raise RunFailed if the folder is gone or cannot be written."""
        self._check()
        try:
            yield
        except OSError as error:
            raise RunFailed(
                f"{error.filename} cannot be written: {error.strerror}; the run has stopped, what "
                "was stored before is whole"
            ) from error
