"""One scene, run in memory or into a folder."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from presswear.campaign.campaign import run_campaign
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.ensemble import most_runs
from presswear.engines.settings import Engine
from presswear.recording.film import columns_of
from presswear.recording.observer import Observer
from presswear.recording.soundness import Finding
from presswear.results.folder import INTERVAL, ResultFolder
from presswear.results.life import LifeResult
from presswear.results.provenance import provenance
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.workers import InProcess, Pool, Workers, cores, workers_for


class _Kept(Observer):
    """Keeps the stages of a run in memory."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.lived: LifeResult | None = None

    def on_life(self, life: LifeResult) -> None:
        self.lived = life

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


def run(
    scene: Scene,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    observers: Sequence[Observer] = (),
    check: bool = True,
    interval: float = INTERVAL,
) -> Result:
    """Run a scene through all its stages.

    Parameters
    ----------
    scene : Scene
    folder : path or None
        Folder of the result. An interrupted run of the same scene in it resumes, and a finished
        one is read. None: the result is kept in memory only.
    engine : str, engine or None
        A name, such as ``dae``, or an engine with its settings, such as
        ``ExudynTree(tree_tolerance=1e-10)``; None: the scene's.
    jobs : int or None
        Replicates that run at a time; None: as many as there are cores. No number depends on it.
    observers : sequence of Observer
        Notified of what happens.
    check : bool
        Whether a failed run raises `RunFailed`.
    interval : float
        Time between two checkpoints in the folder, s.

    Returns
    -------
    Result

    Raises
    ------
    RunFailed
        With its finding, if the run failed and `check` is set, or if its folder is lost.
    InputError
        If the scene, or the content of the folder, does not allow the run.
    """
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: must be at least 1")
    scene = with_engine(scene, engine)
    scene.check()
    if folder is None:
        kept = _Kept()
        with workers_of(scene, jobs, observers) as workers:
            status, message, finding = run_campaign(scene, (kept, *observers), workers=workers)
        wall = sum(stage.wall_s for stage in kept.stages)
        stages, life = tuple(kept.stages), kept.lived
        result = Result(scene, stages, status, message, provenance(), wall, life=life)
    else:
        store = ResultFolder(Path(folder), scene, interval, resume=True)
        with workers_of(scene, jobs, observers, store.interval) as workers:
            finding = run_into(store, scene, observers, workers)
        result = load(store.path)
        if finding is None and result.stages:
            finding = result.stages[-1].finding
    if check and result.status == "failed":
        raise RunFailed(result.message, finding)
    return result


def workers_of(
    scene: Scene,
    jobs: int | None,
    observers: Sequence[Observer] = (),
    interval: float = math.inf,
) -> InProcess | Pool:
    """What does the runs of a scene.

    Parameters
    ----------
    jobs : int or None
        Runs at a time, at most; None: as many as there are cores.
    interval : float
        Between two checkpoints, s.
    """
    frames, room = max((own.frames for own in observers), default=0), 0
    if frames:
        linkage = scene.linkage()
        room = frames * columns_of(len(linkage.bodies), len(linkage.clearances))
    count = min(jobs or cores(), most_runs(scene))
    if any(own.observes_runs for own in observers):
        count = 1
    needed = (_SEGMENT, scene.solver.room)

    def lost(line: str) -> None:
        for observer in observers:
            observer.on_message(line)

    lasts = interval / _SHARES
    # Alone, a process hands over to nobody; and a run that is watched does not wait for others.
    if count > 1 and not frames:
        lasts = min(lasts, TURN)
    return workers_for(count, needed, lasts, room, lost)


_SEGMENT = "presswear.campaign.segment"
TURN = 1.0
"""Segments of runs that several processes share, s: they come to their ends together."""
_SHARES = 4.0
"""Segments of a run between two checkpoints: so much of the interval a state may be old."""


def run_into(
    store: ResultFolder,
    scene: Scene,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> Finding | None:
    """Run a scene into its folder, or go on in it, to the end; returns what ended a failed run."""
    with store:
        if store.is_finished:
            return None
        begun = None if store.resumed is None else Checkpoint.restored(scene, *store.resumed)
        workers = workers or InProcess(store.interval / _SHARES)
        status, message, finding = run_campaign(scene, (store, *observers), begun, workers)
        store.close(status, message)
    return finding


def with_engine(scene: Scene, engine: str | Engine | None) -> Scene:
    """The scene with an engine by its word, or as an object with its settings."""
    if engine is None:
        return scene
    if isinstance(engine, str):
        return replace(scene, engine=engine)
    return replace(scene, engine=engine.word, numerics=scene.numerics.of(engine))
