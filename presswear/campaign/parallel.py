"""The variants of a study, side by side in processes of their own.

One that is finished is kept whatever happens to the others, and one that is stopped goes on
from its checkpoint.
"""

import multiprocessing
import queue
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswear.campaign.single import run_into
from presswear.campaign.study import FILE, Study, Variant, waiting
from presswear.record.tracker import Progress, Tracker
from presswear.results.folder import INTERVAL, ResultFolder
from presswear.results.provenance import provenance
from presswear.scene.scene import Scene
from presswear.tools.documents import write_json
from presswear.tools.errors import RunFailed
from presswear.tools.folders import FolderLock

_POLL = 0.2
"""Time between two looks at the processes, s."""


@dataclass
class _Telling(Tracker):
    """Hands on which part of a variant is done, and where it stands."""

    told: Callable[[float, str], None]

    def progress(self, progress: Progress) -> None:
        self.told(progress.whole, progress.word)


def run_variant(
    path: Path, scene: Scene, interval: float, told: Callable[[float, str], None]
) -> None:
    """Run a scene into a result folder, or go on in it; a run that fails is a result as well.

    Parameters
    ----------
    interval : float
        Between two checkpoints, s.
    """
    run_into(ResultFolder(path, scene, interval, resume=True), scene, [_Telling(told)])


_SHARED: dict[str, Any] = {}
"""In a process of its own: the queue for messages, and the event that ends all of them."""


def _begin(messages: Any, stop: Any) -> None:
    """Prepare a process of the pool."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    _SHARED.update(messages=messages, stop=stop)


def _work(folder: Path, variant: Variant, interval: float) -> None:
    """Run a variant in a process of the pool."""
    parent = multiprocessing.parent_process()

    def tell(part: float, word: str) -> None:
        if _SHARED["stop"].is_set() or (parent is not None and not parent.is_alive()):
            raise KeyboardInterrupt  # nobody waits for this any more
        # The end is told once everything is written.
        _SHARED["messages"].put((variant.key, min(part, 0.999), word))

    try:
        tell(0.0, "")
        scene = variant.scene_in(folder)
        if scene is not None:
            run_variant(folder / variant.key, scene, interval, tell)
    except KeyboardInterrupt:
        _SHARED["messages"].cancel_join_thread()


def run_study(
    study: Study,
    folder: Path,
    jobs: int,
    resume: bool,
    trackers: Sequence[Tracker] = (),
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
    lock = FolderLock(folder)

    def tell(key: str, part: float, word: str) -> None:
        for tracker in trackers:
            tracker.variant(key, part, word)

    try:
        if not (folder / FILE).exists():
            write_json(folder / FILE, {**study.as_dict(), "provenance": provenance()})
        for variant in study.variants:
            if variant not in left:
                tell(variant.key, 1.0, "")
        if left:
            _run_variants(left, folder, jobs, interval, tell)
    finally:
        lock.release()


def _run_variants(
    left: Sequence[Variant],
    folder: Path,
    jobs: int,
    interval: float,
    tell: Callable[[str, float, str], None],
) -> None:
    """Run variants in so many processes; all of them end, with checkpoints, where one breaks."""
    context = multiprocessing.get_context("spawn")
    messages, stop = context.Queue(), context.Event()
    pool = ProcessPoolExecutor(min(jobs, len(left)), context, _begin, (messages, stop))
    try:
        # The longest first, so that no process is left with one when the others are done.
        order = sorted(left, key=lambda variant: variant.extent, reverse=True)
        unfinished = {variant.key for variant in left}
        running: dict[Future[None], Variant] = {}
        while order or running:
            for each in [own for own in order if own.source not in unfinished]:
                order.remove(each)
                running[pool.submit(_work, folder, each, interval)] = each
            done, _ = wait(running, _POLL, return_when="FIRST_COMPLETED")
            _listen(messages, tell)
            for future in done:
                variant = running.pop(future)
                unfinished.remove(variant.key)
                _check(future, variant, tell)
    finally:
        stop.set()
        pool.shutdown(cancel_futures=True)


def _check(future: Future[None], variant: Variant, tell: Callable[[str, float, str], None]) -> None:
    """Tell that a variant has ended; RunFailed where its process broke."""
    try:
        future.result()
    except BrokenProcessPool:
        raise RunFailed("a process of the study was ended from outside") from None
    # A variant may fail with any error of its process, and the user must learn which variant.
    except Exception as error:
        raise RunFailed(f"variant {variant.key}: {type(error).__name__}: {error}") from error
    tell(variant.key, 1.0, "")


def _listen(messages: Any, tell: Callable[[str, float, str], None]) -> None:
    """Hand on all that the processes have said."""
    while True:
        try:
            tell(*messages.get_nowait())
        except queue.Empty:
            return
