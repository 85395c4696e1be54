"""The variants of a study: side by side where there are enough of them, else one by one.

Each variant in a process of its own costs least, as long as there are variants for all; with
fewer, the starts of one at a time share the processes.  One that is finished is kept whatever
happens to the others, and one that is stopped goes on from its checkpoint.
"""

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from presswear.campaign.single import run_into, workers_of
from presswear.campaign.study import FILE, Study, Variant, waiting
from presswear.record.tracker import Progress, Tracker, tell_all
from presswear.results.folder import INTERVAL, ResultFolder
from presswear.results.provenance import provenance
from presswear.tools.documents import write_json
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.folders import FolderLock
from presswear.tools.stopping import is_stopped
from presswear.tools.workers import Job, Report, Workers, cores, workers_for

_LOG = logging.getLogger(__name__)


@dataclass
class _Telling(Tracker):
    """Hands on which part of a variant is done, and where it stands."""

    told: Callable[[float, str], None]

    def progress(self, progress: Progress) -> None:
        self.told(progress.whole, progress.word)

    def compiling(self) -> None:
        self.told(math.nan, "compiling")


@dataclass(frozen=True)
class _Work:
    """A variant as a job.

    Attributes
    ----------
    folder : Path
        The study's.
    interval : float
        Between two checkpoints, s.
    workers : Workers or None
        Does its runs; None: the process that it is in.
    """

    folder: Path
    variant: Variant
    interval: float
    workers: Workers | None = None

    def __call__(self, report: Report) -> None:
        def tell(part: float, word: str) -> None:
            # The end is told once everything is written; NaN stays what it is.
            report(min(part, 0.999), word)

        variant = self.variant
        try:
            path, scene = self.folder / variant.key, variant.scene_in(self.folder)
            if scene is not None:
                store = ResultFolder(path, scene, self.interval, resume=True)
                run_into(store, scene, [_Telling(tell)], self.workers)
        except (InputError, RunFailed, OSError) as error:
            if is_stopped():
                raise KeyboardInterrupt from None
            raise RunFailed(f"variant {variant.key}: {type(error).__name__}: {error}") from error


def run_study(
    study: Study,
    folder: Path,
    jobs: int | None,
    resume: bool,
    trackers: Sequence[Tracker] = (),
    interval: float = INTERVAL,
) -> None:
    """Run the variants of a study that are not finished.

    Parameters
    ----------
    jobs : int or None
        Runs at a time; None: as many as there are cores.
    interval : float
        Between two checkpoints of a variant, s.

    Raises
    ------
    RunFailed
        Where a variant ended in an error, or processes were killed again and again.
    """
    left = waiting(study, folder, resume)
    lock = FolderLock(folder)
    try:
        if not (folder / FILE).exists():
            write_json(folder / FILE, {**study.as_dict(), "provenance": provenance()})
        for variant in study.variants:
            if variant not in left:
                _tell(trackers, variant.key, 1.0, "")
        if left:
            _run_variants(left, folder, jobs, interval, trackers)
    finally:
        lock.release()


def _tell(trackers: Sequence[Tracker], key: str, part: float, word: str) -> None:
    """Tell how far a variant is."""
    for tracker in trackers:
        tracker.variant(key, part, word)


def _run_variants(
    left: Sequence[Variant],
    folder: Path,
    jobs: int | None,
    interval: float,
    trackers: Sequence[Tracker],
) -> None:
    """Run variants in so many processes; all of them end, with checkpoints, where one breaks."""
    # The longest first, so that no process is left with one when the others are done.
    order = sorted(left, key=lambda variant: variant.extent, reverse=True)

    keys = {variant.key for variant in left}

    def ended(index: int, outcome: None) -> dict[int, Job | None]:
        _LOG.info("variant %s has ended", order[index].key)
        _tell(trackers, order[index].key, 1.0, "")
        return {k: job for k, job in work.items() if order[k].source == order[index].key}

    def told(index: int, part: float, word: str, rows: object) -> None:
        _tell(trackers, order[index].key, 0.0 if math.isnan(part) else part, word)

    most = jobs or cores()
    is_wide, lost = len(left) >= most, partial(tell_all, trackers)
    with (
        workers_for(most if is_wide else 1, (__name__,), lost=lost) as variants,
        workers_of([v.scene for v in left], 1 if is_wide else most, trackers, interval) as starts,
    ):
        shared = None if is_wide else starts
        work = {k: _Work(folder, variant, interval, shared) for k, variant in enumerate(order)}
        # Those that begin on the surfaces of another come behind it.
        first = {k: job for k, job in work.items() if order[k].source not in keys}
        variants.run(first, ended, told)
