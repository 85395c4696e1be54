"""The variants of a study as rows, as those of a sweep are.

They run wherever those do, several processes and machines share a folder, and one that fails is a
row with its reason.  What a variant came to stands in its folder, and goes on there.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from pathlib import Path

from presswear.recording.tracker import Tracker, tell_all
from presswear.results.folder import INTERVAL
from presswear.results.provenance import program_digest, provenance
from presswear.studies.plan import FILE, Study, is_study, waiting
from presswear.sweeps.executors import runner_of
from presswear.sweeps.measures import Asked
from presswear.sweeps.plan import scene_digest
from presswear.sweeps.run import run_rows
from presswear.sweeps.store import Store
from presswear.sweeps.work import SceneJob
from presswear.tools.documents import write_shared_json
from presswear.tools.errors import RunFailed
from presswear.tools.files import digest, inside
from presswear.tools.workers import cores


@dataclass(frozen=True)
class StudyWork:
    """The variants of a study as rows.

    Attributes
    ----------
    study : Study
    folder : Path
        The study's.
    program : str
        Digest of the program that computes; see ``program_digest``.
    interval : float
        Time between two checkpoints of a variant, s.
    jobs : int
        Starts of a variant that run at a time.
    """

    study: Study
    folder: Path
    program: str
    interval: float
    jobs: int = 1

    @property
    def rows(self) -> int:
        """Number of variants."""
        return len(self.study.variants)

    @property
    def with_folder(self) -> bool:
        """True: whole results are kept."""
        return True

    def shortcut(self, row: int) -> str:
        """Digest of a variant, of this program."""
        own = self.study.variants[row]
        told = json.dumps([own.key, own.on, scene_digest(own.scene), self.program])
        return digest(told.encode())

    def job(self, row: int) -> tuple[str, SceneJob]:
        """Digest of a variant, and its run; InputError where its surfaces were never reached."""
        own = self.study.variants[row]
        scene, path = own.scene_in(self.folder), self.folder / own.key
        job = SceneJob(scene, Asked((), ()), path, self.program, self.interval, self.jobs)
        return self.shortcut(row), job


def run_study(
    study: Study,
    folder: Path,
    jobs: int | None,
    resume: bool,
    trackers: Sequence[Tracker] = (),
    interval: float = INTERVAL,
    on: str = "",
    shard: tuple[int, int] = (1, 1),
) -> None:
    """Run the variants of a study that are not finished.

    Parameters
    ----------
    jobs : int or None
        Runs at a time; None: as many as there are cores.
    interval : float
        Between two checkpoints of a variant, s.
    on : str
        What does the runs; see ``sweeps.executors``.
    shard : tuple of int
        Which part of how many, from 1: every so many-th variant, and those that they begin on.

    Raises
    ------
    RunFailed
        Where variants failed by what is around them, behind all others.
    """
    for variant in study.variants:
        variant.scene.check_trusted()
        inside(folder, variant.key)
    variants, left = study.variants, {v.key for v in waiting(study, folder, resume)}
    places, say = jobs or cores(), partial(tell_all, trackers)
    work = StudyWork(study, folder.resolve(), program_digest(), interval)

    def begun() -> None:
        if not is_study(folder):
            write_shared_json(folder / FILE, {**study.as_dict(), "provenance": provenance()})

    def heard(row: int, part: float, word: str) -> None:
        for tracker in trackers:
            tracker.variant(variants[row].key, part, word)

    with Store(folder) as store:
        if store.warning:
            say(store.warning)
        rows = [row for row, variant in enumerate(variants) if variant.key in left]
        for row, variant in enumerate(variants):
            if variant.key in left:
                # Its folder tells, which may have been taken away since.
                store.forget(work.shortcut(row))
            else:
                heard(row, 1.0, "")
        for part in _passes(study, _part(study, rows, shard)):
            # With fewer variants than processes here the starts of one at a time share them.
            is_wide = bool(on) or len(part) >= places
            own = work if is_wide else replace(work, jobs=places)
            runner = runner_of(on, jobs if is_wide else 1, say)
            run_rows(own, store, runner, part, begun=begun, heard=heard)
        found = {variants[row].label: store.get(work.shortcut(row)) for row in rows}
    failed = [f"{label}: {own.reason}" for label, own in found.items() if own and own.again]
    if failed:
        raise RunFailed("; ".join(failed))


def _part(study: Study, rows: Sequence[int], shard: tuple[int, int]) -> set[int]:
    """Every so many-th of some rows, with those on whose surfaces they begin."""
    keys = [variant.key for variant in study.variants]
    part = set(range(shard[0] - 1, len(keys), shard[1]))
    for row in reversed(range(len(keys))):
        if row in part and study.variants[row].source:
            part.add(keys.index(study.variants[row].source))
    return part & set(rows)


def _passes(study: Study, rows: Iterable[int]) -> list[list[int]]:
    """Rows one behind the other: those that begin on the surfaces of another behind that.

    The longest first, so that no process is left with one when the others are done.
    """
    depth: dict[str, int] = {"": -1}
    for variant in study.variants:
        depth[variant.key] = depth[variant.source] + 1

    def place(row: int) -> int:
        return depth[study.variants[row].key]

    ordered = sorted(rows, key=lambda row: (place(row), -study.variants[row].extent))
    return [list(part) for _, part in groupby(ordered, place)]
