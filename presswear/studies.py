"""Studies: one scene in several variants, run side by side, and an answer drawn from all.

A study's folder holds one result folder for each variant.  Variants run in processes of
their own; one that is finished is kept whatever happens to the others.
"""

import multiprocessing
import queue
import shutil
import signal
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswear.campaign import Watcher, run_campaign
from presswear.errors import InputError
from presswear.results import ResultFolder, StoredResult, load
from presswear.scene import Scene

Told = Callable[[str, float, str], None]
"""Key of a variant, part of it done 0 .. 1, and a word on where it stands."""

_POLL = 0.2
"""Time between two looks at the processes, s."""


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


def run_variant(path: Path, scene: Scene, progress: Callable[[float, str], None]) -> None:
    """Run a scene into a result folder; a run that fails is a result as well."""
    store = ResultFolder(path, scene)
    word = ""

    def told(stage: int, part: float, text: str) -> None:
        nonlocal word
        word = text

    watcher = Watcher(told, store.add, lambda part: progress(part, word))
    status, message = run_campaign(scene, watcher)
    store.close(status, message)


def _work(path: Path, key: str, scene: Scene, messages: Any) -> None:
    """What the process of one variant does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    try:
        run_variant(path, scene, lambda part, word: messages.put((key, part, word, None)))
        messages.put((key, 1.0, "", None))
    except BaseException as error:
        messages.put((key, 1.0, "", f"{type(error).__name__}: {error}"))
        raise


def is_finished(path: Path, scene: Scene) -> bool:
    """Whether a folder holds the whole result of a scene.

    Raises
    ------
    InputError
        Where it holds the result of another scene.
    """
    if not (path / "result.json").exists():
        return False
    found = load(path)
    if found.scene != scene:
        raise InputError(f"{path} holds a run of another scene; name a new folder")
    return found.document["status"] in ("completed", "failed")


def waiting(study: Study, folder: Path, resume: bool) -> list[Variant]:
    """The variants that have to run; what an interrupted one left behind is removed.

    Raises
    ------
    InputError
        Where the folder holds something and nothing is to be resumed, or another study.
    """
    if not resume and folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"--out {folder}: it exists and is not empty; name a new one or --resume")
    left = [v for v in study.variants if not is_finished(folder / v.key, v.scene)]
    for variant in left:
        shutil.rmtree(folder / variant.key, ignore_errors=True)
    return left


def run_study(study: Study, folder: Path, jobs: int, resume: bool, told: Told) -> None:
    """Run the variants of a study that are not finished, so many at a time.

    Raises
    ------
    RuntimeError
        Where a process ended in a way of its own.
    """
    left = waiting(study, folder, resume)
    for variant in study.variants:
        if variant not in left:
            told(variant.key, 1.0, "")
    folder.mkdir(parents=True, exist_ok=True)
    context = multiprocessing.get_context("spawn")
    messages: Any = context.Queue()
    running: dict[str, Any] = {}
    try:
        while left or running:
            while left and len(running) < jobs:
                variant = left.pop(0)
                arguments = (folder / variant.key, variant.key, variant.scene, messages)
                process = context.Process(target=_work, args=arguments, daemon=True)
                process.start()
                running[variant.key] = process
            _listen(messages, told)
            for key in [key for key, process in running.items() if not process.is_alive()]:
                process = running.pop(key)
                if process.exitcode != 0:
                    raise RuntimeError(f"variant {key} ended with code {process.exitcode}")
        _listen(messages, told)
    finally:
        for process in running.values():
            process.terminate()
            process.join()


def _listen(messages: Any, told: Told) -> None:
    """Hand on what the processes say; an error of one ends the study."""
    wait = _POLL
    while True:
        try:
            key, part, word, problem = messages.get(timeout=wait)
        except queue.Empty:
            return
        if problem is not None:
            raise RuntimeError(f"variant {key}: {problem}")
        told(key, part, word)
        wait = 0.0001


def results_of(study: Study, folder: Path) -> Iterator[tuple[Variant, StoredResult | None]]:
    """Each variant with its result; None for one that failed before its first stage ended."""
    for variant in study.variants:
        path = folder / variant.key
        yield variant, load(path) if (path / "result.json").exists() else None
