"""Studies: scenes in several variants, run side by side, and an answer drawn from all.

A study's folder holds ``study.json``, which says what is to be run, and one result folder
for each variant.  Variants run in processes of their own; one that is finished is kept
whatever happens to the others, and one that is stopped goes on from its checkpoint.
"""

import json
import multiprocessing
import queue
import re
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

from presswear.campaign.run import run_into
from presswear.record.tracker import Progress, Tracker
from presswear.results.folder import INTERVAL, ResultFolder
from presswear.results.provenance import provenance, provenance_differs
from presswear.results.result import FINISHED, Result, load, plain
from presswear.results.stored import schema_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import read_json, write_bytes
from presswear.tools.lock import is_free, make_folder, take_folder
from presswear.tools.typed import misfits

Told = Callable[[str, float, str], None]
"""Key of a variant, part of it done 0 .. 1, and a word on where it stands."""

Change = Callable[[Scene], Scene]
"""What a person wants changed in the scene that a study starts from."""

FILE = "study.json"
SCHEMA = 1
_KEY = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+=,_-]*")
_PATIENCE = 20.0
"""Time in which a process that is stopped writes its checkpoint, s."""
_POLL = 0.2
"""Time between two looks at the processes, s."""
_CYCLES_OF_MAPS = 0.06
"""Cycles until wear maps are known to a tolerance, times its square: a rough measure."""


def unchanged(scene: Scene) -> Scene:
    """The change that is none."""
    return scene


@dataclass(frozen=True)
class Variant:
    """One way of running the scene of a study.

    Attributes
    ----------
    key : str
        Name of its folder.
    label : str
        What is varied, in a few words.
    """

    key: str
    label: str
    scene: Scene

    @property
    def extent(self) -> float:
        """Simulated time that it takes, s: of a run that ends by itself a rough guess."""
        scene = self.scene
        cycles = scene.cycles
        if cycles is None:
            cycles = min(round(_CYCLES_OF_MAPS / scene.tolerance**2) + 9, scene.most_cycles)
        # Worn surfaces take more steps.
        return cycles * scene.mechanism.period * (1.0 + 1.5 * scene.wears)


@dataclass(frozen=True)
class Study:
    """A question that takes more than one run.

    Attributes
    ----------
    variants : tuple of Variant
        The first is the one that the others are compared with.
    """

    name: str
    title: str
    question: str
    variants: tuple[Variant, ...]

    def as_dict(self) -> dict[str, Any]:
        """The study as plain data."""
        return {
            "schema": SCHEMA,
            "name": self.name,
            "title": self.title,
            "question": self.question,
            "variants": [
                {"key": v.key, "label": v.label, "scene": v.scene.as_dict()} for v in self.variants
            ],
        }


def is_study(folder: Path) -> bool:
    """Whether a folder is that of a study."""
    return (folder / FILE).exists()


def load_study(folder: Path) -> Study:
    """The study of a folder; InputError says what is wrong with it."""
    file = folder / FILE
    data = read_json(file, f"{folder} is no study's folder: it has no {FILE}")
    schema_of(data, file, SCHEMA)
    try:
        variants = tuple(
            Variant(v["key"], v["label"], Scene.from_dict(v["scene"])) for v in data["variants"]
        )
        study = Study(data["name"], data["title"], data["question"], variants)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    except (LookupError, TypeError) as error:
        raise InputError(f"{file} is not whole: {error!r}") from None
    wrong = next(misfits(study), None)
    if wrong is not None:
        raise InputError(f"{file}: {wrong} is not what it should be")
    keys = [variant.key for variant in variants]
    # A key names a folder: it must not lead anywhere else.
    strange = [key for key in keys if not _KEY.fullmatch(key) or keys.count(key) > 1]
    if strange or not keys:
        raise InputError(f"{file}: {strange[:1] or 'nothing'} cannot name a variant's folder")
    return study


@dataclass
class _Telling(Tracker):
    """Hands on which part of a variant is done, and where it stands."""

    told: Callable[[float, str], None]

    def progress(self, progress: Progress) -> None:
        self.told(progress.whole, progress.word)


def run_variant(
    path: Path, scene: Scene, interval: float, progress: Callable[[float, str], None]
) -> None:
    """Run a scene into a result folder, or go on in it; a run that fails is a result as well.

    Parameters
    ----------
    interval : float
        Between two checkpoints, s.
    """
    run_into(ResultFolder(path, scene, interval, resume=True), scene, [_Telling(progress)])


def _stop(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _work(folder: Path, interval: float, tasks: Any, messages: Any) -> None:
    """What one process does: variants, until there are none left or it is told to stop."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    signal.signal(signal.SIGTERM, _stop)
    parent = multiprocessing.parent_process()

    def tell(key: str, part: float, word: str) -> None:
        if parent is not None and not parent.is_alive():
            raise KeyboardInterrupt  # nobody waits for this any more
        # The end is told once everything is written.
        messages.put((key, min(part, 0.999), word, None))

    try:
        while (task := tasks.get()) is not None:
            key, scene = task
            try:
                tell(key, 0.0, "")
                run_variant(folder / key, scene, interval, partial(tell, key))
                messages.put((key, 1.0, "", None))
            except Exception as error:
                messages.put((key, 1.0, "", f"{type(error).__name__}: {error}"))
                raise
    except KeyboardInterrupt:
        messages.cancel_join_thread()


def is_finished(path: Path) -> bool:
    """Whether a folder holds the whole result of a scene."""
    return (path / "result.json").exists() and load(path).status in FINISHED


def waiting(study: Study, folder: Path, resume: bool) -> list[Variant]:
    """The variants that have to run, or to go on.

    Raises
    ------
    InputError
        Where the folder holds something and nothing is to be resumed, or another study, or one
        begun with other versions.
    """
    if not resume:
        if not is_free(folder):
            raise InputError(
                f"--out {folder}: it exists and is not empty; name a new one or --resume"
            )
        return list(study.variants)
    if is_free(folder):
        return list(study.variants)
    found = load_study(folder)
    wanted = {v.key: v.scene for v in study.variants}
    there = {v.key: v.scene for v in found.variants}
    for key in dict.fromkeys([*wanted, *there]):
        if wanted.get(key) != there.get(key):
            raise InputError(
                f"--out {folder}: it holds another study ({key} differs); "
                "give the options of the first start, or name a new folder"
            )
    here = provenance()
    versions = provenance_differs(read_json(folder / FILE, "").get("provenance", here), here)
    if versions:
        raise InputError(
            f"--out {folder}: it was begun by another program, with which its numbers would not "
            f"agree: {versions}"
        )
    return [v for v in study.variants if not is_finished(folder / v.key)]


def run_study(
    study: Study,
    folder: Path,
    jobs: int,
    resume: bool,
    told: Told,
    interval: float = INTERVAL,
) -> None:
    """Run the variants of a study that are not finished, so many at a time.

    Parameters
    ----------
    interval : float
        Between two checkpoints of a variant, s.

    Raises
    ------
    RunFailed
        Where a process ended in a way of its own.
    """
    left = waiting(study, folder, resume)
    make_folder(folder)
    lock = take_folder(folder)
    try:
        if not (folder / FILE).exists():
            stored = {**study.as_dict(), "provenance": provenance()}
            write_bytes(folder / FILE, json.dumps(plain(stored), indent=1).encode())
        for variant in study.variants:
            if variant not in left:
                told(variant.key, 1.0, "")
        _run_variants(left, folder, jobs, interval, told)
    finally:
        lock.release()


def _run_variants(
    left: Sequence[Variant], folder: Path, jobs: int, interval: float, told: Told
) -> None:
    """Run variants in so many processes."""
    context = multiprocessing.get_context("spawn")
    tasks: Any = context.Queue()
    messages: Any = context.Queue()
    # The longest first, so that no process is left with one when the others are done.
    for variant in sorted(left, key=lambda v: v.extent, reverse=True):
        tasks.put((variant.key, variant.scene))
    workers = [
        context.Process(target=_work, args=(folder, interval, tasks, messages), daemon=True)
        for _ in range(min(jobs, len(left)))
    ]
    try:
        for worker in workers:
            tasks.put(None)
            worker.start()
        while any(worker.is_alive() for worker in workers):
            _listen(messages, told)
            for worker in workers:
                if worker.exitcode not in (None, 0):
                    _listen(messages, told)
                    raise RunFailed(f"a process ended with code {worker.exitcode}")
        _listen(messages, told)
    finally:
        # What nobody will fetch any more must not keep the program from ending.
        tasks.cancel_join_thread()
        for worker in workers:
            if worker.is_alive():
                worker.terminate()
        for worker in workers:
            if worker.pid is not None:
                worker.join(_PATIENCE)
                worker.kill()


def _listen(messages: Any, told: Told) -> None:
    """Hand on what the processes say; an error of one ends the study."""
    wait = _POLL
    while True:
        try:
            key, part, word, problem = messages.get(timeout=wait)
        except queue.Empty:
            return
        if problem is not None:
            raise RunFailed(f"variant {key}: {problem}")
        told(key, part, word)
        wait = 0.0001


def results_of(study: Study, folder: Path) -> Iterator[tuple[Variant, Result | None]]:
    """Each variant with its result; None for one that failed before its first stage ended."""
    for variant in study.variants:
        path = folder / variant.key
        yield variant, load(path) if (path / "result.json").exists() else None
