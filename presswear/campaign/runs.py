"""Runs of scenes: one in memory or into its folder, or several at a time."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from presswear.campaign.campaign import run_campaign
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.wear_update import initial_depth
from presswear.engines.settings import Engine
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.soundness import Finding
from presswear.results.folder import INTERVAL, ResultFolder
from presswear.results.life import LifeResult
from presswear.results.provenance import provenance
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed, shown
from presswear.tools.files import check_name, inside
from presswear.tools.processes import Report, Workers, check_jobs, cores

# imported by worker processes before the first job
WORK_MODULE = "presswear.campaign.replicates"
# Longest work unit with several processes, s: the processes then end nearly together
TURN = 1.0
_UNITS_PER_CHECKPOINT = 4.0  # work units in the interval between two checkpoints


def run(
    scene: Scene,
    folder: str | Path | None = None,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    observers: Sequence[Observer] = (),
    check: bool = True,
    interval: float = INTERVAL,
) -> Result:
    """Run a scene through all its stages, without showing its progress; see ``api.run``."""
    check_jobs(jobs)
    if not interval >= 0.0:
        raise InputError(f"interval = {interval:g}: must be at least 0 s")
    scene = with_engine(scene, engine)
    scene.check()
    if folder is None:
        memory = _Memory()
        with workers_of(scene, jobs, observers) as workers:
            status, message, finding = run_campaign(
                scene, (memory, *observers), workers=workers
            )
        stages = tuple(memory.stages)
        wall = sum(stage.wall_s for stage in memory.stages)
        result = Result(
            scene, stages, status, message, provenance(), wall, life=memory.life
        )
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


class _Memory(Observer):
    """Observer that stores the stages and the life of a campaign in memory."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.life: LifeResult | None = None

    def on_life(self, life: LifeResult) -> None:
        self.life = life

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


@checked_arguments
def run_scenes(
    scenes: Mapping[str, Scene],
    folder: str | Path,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    on_progress: Callable[[str, float, str], object] = lambda name, share, words: None,
    on_life_start: Callable[[str, float, float], object] = lambda name, cycles, s: None,
) -> dict[str, Result]:
    """Run named scenes, several at a time, each into the sub-folder of its name.

    Parameters
    ----------
    scenes : mapping of str to Scene
    folder : path
        Folder of all runs. Finished runs in it are read, and interrupted ones resume.
    engine : str, engine or None
        Engine of every scene, as in `run`; None: each scene's own.
    jobs : int or None
        Scenes that run at a time; None: as many as there are cores. No number depends
        on it.
    on_progress : callable
        Called with the name of a scene, the latest estimate of the completed fraction of
        its run, and a few words. At 1.0 the run has ended and the words are its status.
    on_life_start : callable
        Called with the name of a scene, and the cycles and seconds that its service
        life will still take in one process, after the first strokes.

    Returns
    -------
    dict of str to Result
        Results by name. A scene that failed is a result with the status ``failed``.

    Raises
    ------
    InputError
        If a sub-folder holds the run of another scene, or a scene cannot run.
    """
    check_jobs(jobs)
    paths = {}
    for name, scene in scenes.items():
        if not name or name != Path(name).name:
            raise InputError(f"{shown(name)} cannot name the folder of a scene")
        paths[name] = inside(Path(folder).resolve(), name)
        check_name(paths[name])
        scene.check_trusted()
    names = list(scenes)
    done_so_far = [0.0] * len(names)

    def on_end(key: int, status: str) -> dict[int, None]:
        on_progress(names[key], 1.0, status)
        return {}

    def on_report(key: int, done: float, words: str, need: Array | None) -> None:
        if need is not None:
            on_life_start(names[key], *need.tolist())
        if not math.isnan(done):  # kernels may be compiled in the middle of a run
            done_so_far[key] = done
        on_progress(names[key], done_so_far[key], words)

    tasks = {
        key: partial(_run_one, with_engine(scenes[name], engine), paths[name])
        for key, name in enumerate(names)
    }
    with Workers(min(jobs or cores(), len(names)), (WORK_MODULE,)) as workers:
        workers.run(tasks, on_end, on_report)
    return {name: load(path) for name, path in paths.items()}


def _run_one(scene: Scene, path: Path, report: Report) -> str:
    """Run a scene in this process and return its status, with the reason of a failure."""

    class Reports(Observer):
        """Observer that reports the progress to the process that started this one."""

        def on_progress(self, progress: Progress) -> None:
            completed = min(progress.estimate or progress.whole, 0.999)
            if progress.word == COMPILING:
                completed = math.nan
            report(completed, progress.word)

        def on_life_start(self, cycles: float, seconds: float) -> None:
            report(math.nan, "", np.array([cycles, seconds]))

    result = run(scene, path, jobs=1, observers=[Reports()], check=False)
    return f"{result.status}: {result.message}" if result.message else result.status


def with_engine(scene: Scene, engine: str | Engine | None) -> Scene:
    """Return a scene with an engine by its name, or by an object with its settings."""
    if engine is None:
        return scene
    if isinstance(engine, str):
        return replace(scene, engine=engine)
    return replace(scene, engine=engine.word, numerics=scene.numerics.of(engine))


def workers_of(
    scene: Scene,
    jobs: int | None,
    observers: Sequence[Observer] = (),
    interval: float = math.inf,
) -> Workers:
    """Return the workers for the runs of a scene, with checkpoints at an interval, s."""
    runs = scene.replicate_count
    if scene.wear_updates > 0 and not scene.wears_in_steps and runs > 1:
        runs *= 2  # two sets of runs, see ``ensemble``
    count = min(jobs or cores(), runs)
    # Observers of runs need them in this process.
    if any(observer.observes_runs for observer in observers):
        count = 1
    duration = interval / _UNITS_PER_CHECKPOINT
    if count > 1:
        duration = min(duration, TURN)
    return Workers(count, (WORK_MODULE, scene.solver.module), duration)


def run_into(
    store: ResultFolder,
    scene: Scene,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> Finding | None:
    """Run a scene into its folder, or resume it there; return the finding of a failed run."""
    with store:
        if store.is_finished:
            return None
        checkpoint = None if store.resumed is None else Checkpoint.load(store.resumed)
        # The number of runs (first axis) differs between the stages of a scene.
        if checkpoint and checkpoint.depth.shape[1:] != initial_depth(scene).shape[1:]:
            raise InputError(f"{store.path}: its checkpoint is of another scene")
        workers = workers or Workers(
            job_duration=store.interval / _UNITS_PER_CHECKPOINT
        )
        outcome = run_campaign(scene, (store, *observers), checkpoint, workers)
        store.close(*outcome[:2])
    return outcome[2]
