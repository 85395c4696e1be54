"""Campaign: run a stage, wear the surfaces, run again, from every replicate on its own surfaces."""

import logging
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.ensemble import (
    Ensemble,
    EnsembleState,
    ProgressEstimate,
    Runner,
    max_runs,
)
from presswear.campaign.replicates import RunSpec, StepCheck, worn_out
from presswear.campaign.service_life import LifeState, run_life, wear_between
from presswear.campaign.stage_statistics import stage_result
from presswear.campaign.wear_update import (
    FIRST_PASS,
    WearUpdate,
    cycle_by_cycle,
    initial_depth,
    jump,
    wear_error,
    wear_per_cycle,
)
from presswear.engines.settings import Engine
from presswear.linkage.elements import ClearanceJoint
from presswear.recording.observer import Observer, Progress
from presswear.recording.soundness import Finding
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.folder import INTERVAL, ResultFolder, provenance
from presswear.results.life import LifeResult
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene, stage_name
from presswear.tools.errors import InputError, RunFailed, shown
from presswear.tools.files import check_name, inside
from presswear.tools.processes import InProcess, Report, Workers, cores, workers_for

Array = NDArray[np.float64]
Outcome = tuple[str, str, Finding | None]  # status, message, finding

_LOG = logging.getLogger(__name__)

WORK_MODULE = "presswear.campaign.replicates"  # imported by worker processes before the first job
TURN = 1.0  # s, of work units that several processes share: they end together
_UNITS_PER_CHECKPOINT = 4.0  # a state may be so much of the checkpoint interval old


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
    if folder is None:
        stages: list[StageResult] = []
        lives: list[LifeResult] = []

        class Keep(Observer):
            """Keeps the stages in memory."""

            def on_life(self, life: LifeResult) -> None:
                lives.append(life)

            def on_stage(self, stage: StageResult) -> None:
                stages.append(stage)

        with workers_of(scene, jobs, observers) as workers:
            status, message, finding = run_campaign(scene, (Keep(), *observers), workers=workers)
        wall = sum(stage.wall_s for stage in stages)
        life = lives[0] if lives else None
        result = Result(scene, tuple(stages), status, message, provenance(), wall, life=life)
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


def run_scenes(
    scenes: Mapping[str, Scene],
    folder: str | Path,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    on_progress: Any = None,
) -> dict[str, Result]:
    """Run named scenes, several at a time, each into the sub-folder of its name.

    A run that is finished is read. A run that was interrupted resumes. No number depends on
    `jobs` or on the order of the scenes.

    Parameters
    ----------
    scenes : mapping of str to Scene
        Scenes by the names of their sub-folders.
    folder : path
        Folder of all runs.
    engine : str, engine or None
        Engine of every scene, as in `run`; None: each scene's own.
    jobs : int or None
        Scenes that run at a time; None: as many as there are cores.
    on_progress : callable or None
        Called with the name of a scene, the completed fraction of its run, and a few words. At
        1.0 the run has ended and the words are its status.

    Returns
    -------
    dict of str to Result
        Results by name. A scene that failed is a result with the status ``failed``.

    Raises
    ------
    InputError
        If a sub-folder holds the run of another scene, or a scene cannot run.
    """
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: must be at least 1")
    notify: Callable[[str, float, str], object] = on_progress or (lambda *report: None)
    paths = {}
    for name, scene in scenes.items():
        if not name or name != Path(name).name:
            raise InputError(f"{shown(name)} cannot name the folder of a scene")
        paths[name] = inside(Path(folder).resolve(), name)
        check_name(paths[name])
        scene.check_trusted()
    names = list(scenes)
    tasks = {
        key: partial(_run_one, with_engine(scenes[name], engine), paths[name])
        for key, name in enumerate(names)
    }

    def on_end(key: int, status: str) -> dict[int, None]:
        notify(names[key], 1.0, status)
        return {}

    def on_report(key: int, done: float, words: str, _: object) -> None:
        notify(names[key], 0.0 if math.isnan(done) else done, words)

    with workers_for(min(jobs or cores(), len(names)), (WORK_MODULE,)) as workers:
        workers.run(tasks, on_end, on_report)
    return {name: load(path) for name, path in paths.items()}


def _run_one(scene: Scene, path: Path, report: Report) -> str:
    """Run a scene in this process and return its status, with the reason of a failure."""

    class Reports(Observer):
        def on_progress(self, progress: Progress) -> None:
            report(min(progress.whole, 0.999), progress.word)

        def on_compile(self) -> None:
            report(math.nan, "compiling")

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
    """Return the workers for the runs of a scene.

    Parameters
    ----------
    jobs : int or None
        Maximum number of runs at a time; None: as many as there are cores.
    interval : float
        Time between two checkpoints, s.
    """
    count = min(jobs or cores(), max_runs(scene))
    # Frames for a window do not leave the process that runs.
    if any(observer.observes_runs or observer.frames for observer in observers):
        count = 1
    duration = interval / _UNITS_PER_CHECKPOINT
    if count > 1:
        duration = min(duration, TURN)
    return workers_for(count, (WORK_MODULE, scene.solver.module), duration)


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
        workers = workers or InProcess(store.interval / _UNITS_PER_CHECKPOINT)
        outcome = run_campaign(scene, (store, *observers), checkpoint, workers)
        store.close(*outcome[:2])
    return outcome[2]


def run_campaign(
    scene: Scene,
    observers: Sequence[Observer],
    checkpoint: Checkpoint | None = None,
    workers: Workers | None = None,
) -> Outcome:
    """Run every stage; return status, message and finding.

    Observers are notified of each stage once the wear update after it is applied, or has failed.

    Parameters
    ----------
    checkpoint : Checkpoint or None
        State to resume from.
    workers : Workers or None
        None: this process does the runs.
    """
    scene.check_own_laws()
    runner = Runner(scene, ProgressEstimate(scene, observers), workers or InProcess())
    return _Campaign(runner, checkpoint or Checkpoint(depth=initial_depth(scene))).run()


def run_stage(
    scene: Scene,
    index: int,
    depth: Array | None = None,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> tuple[StageResult, Ensemble]:
    """Run one stage, without the wear update after it; return its runs as well.

    Parameters
    ----------
    depth : ndarray, shape (runs, joints, 2, bins)
        Depth of the surfaces of each run, m; None: those that the scene starts on.
    workers : Workers or None
        None: this process does the runs.
    """
    progress = ProgressEstimate(replace(scene, wear_updates=index), observers)
    progress.start_stage(index)
    runner = Runner(scene, progress, workers or InProcess())
    depth = initial_depth(scene) if depth is None else depth
    ensemble = runner.run(depth, stage_spec(scene, index), step_check=StepCheck(scene, depth[0]))
    stage = stage_result(scene, index, ensemble)
    for observer in observers:
        observer.on_stage(stage)
    return stage, ensemble


class _Campaign:
    """Stages of a scene with the wear updates between them."""

    def __init__(self, runner: Runner, checkpoint: Checkpoint) -> None:
        self._runner, self._at = runner, checkpoint
        self._observers = runner.progress.observers
        self._unconverged: list[str] = []

    def _checkpoint(self, checkpoint: Checkpoint, is_stage: bool = False) -> None:
        for observer in self._observers:
            observer.on_checkpoint(checkpoint, is_stage)

    def run(self) -> Outcome:
        """Run the service life, if the scene has one, and all stages."""
        strokes = None
        if self._runner.scene.life is not None:
            try:
                strokes = self._run_life()
            except RunFailed as error:
                return "failed", f"{error}", error.finding
        for index in range(self._at.index, self._runner.scene.wear_updates + 1):
            failure = self._run_stage(index, strokes)
            if failure:
                return failure
        if self._unconverged:
            return "unconverged", "; ".join(self._unconverged), None
        return "completed", "", None

    def _run_life(self) -> float:
        """Run the service life and return its strokes."""
        scene, at = self._runner.scene, self._at

        def keep(life: LifeState) -> None:
            self._checkpoint(Checkpoint(depth=at.depth, life=life))

        passes, life = run_life(self._runner, initial_depth(scene), at.life or LifeState(), keep)
        for observer in self._observers:
            observer.on_life(life)
        self._unconverged += unknown_life(scene, life)
        self._at = replace(at, life=LifeState(passes))
        # The wear update after a stage is for the part of the life up to the next stage.
        part = max(life.strokes / scene.wear_updates, 1.0)
        self._runner = replace(self._runner, scene=replace(scene, cycles_per_update=part))
        return life.strokes

    def _run_stage(self, index: int, strokes: float | None) -> Outcome | None:
        """Run a stage and the wear update after it; return how it failed, or None."""
        runner, scene, at = self._runner, self._runner.scene, self._at
        runner.progress.start_stage(index)
        _LOG.info("stage %d begins: %s", index, scene.stage_name(index))
        spec, is_last = stage_spec(scene, index), index == scene.wear_updates
        if at.stage is not None:
            ensemble = Ensemble.of(scene, spec, at.depth, at.stage)
            runner.progress.done += ensemble.cycles / scene.replicate_count
        else:
            if scene.wears_in_steps and not is_last and strokes is None:
                runner.progress.later = 3.0 * (scene.cycles or FIRST_PASS)

            def keep(running: EnsembleState) -> None:
                self._checkpoint(replace(at, running=running))

            step_check = StepCheck(scene, at.depth[0])
            ensemble = runner.run(at.depth, spec, at.running, keep, step_check)
            at = replace(at, running=EnsembleState())
        if ensemble.failure or is_last:
            self._finish(stage_result(scene, index, ensemble))
            if ensemble.failure:
                return "failed", f"stage {index}: {ensemble.failure}", ensemble.finding
            return None
        if strokes is not None:
            assert at.life is not None
            since, until = (strokes * k / scene.wear_updates for k in (index, index + 1))
            joints, initial = ensemble.linkage.clearances, initial_depth(scene)
            update = wear_between(at.life.passes, joints, initial, since, until)
            self._finish(stage_result(scene, index, ensemble, update))
        else:
            applied, finding = self._apply_wear(index, ensemble, at)
            if finding:
                return "failed", finding.words, finding
            assert applied is not None
            update = applied
        self._at = Checkpoint(index + 1, update.depth, life=at.life)
        self._checkpoint(self._at, is_stage=True)
        return None

    def _apply_wear(
        self, index: int, ensemble: Ensemble, at: Checkpoint
    ) -> tuple[WearUpdate | None, Finding | None]:
        """Apply the wear update after a stage; return it, or the finding that ended it."""
        scene, update, finding = self._runner.scene, at.update, None
        at = replace(at, stage=ensemble.state)
        self._checkpoint(at)
        try:
            for update, finding in self._passes(index, ensemble, at):  # noqa: B007
                pass
        finally:
            # The stage is finished, even if somebody interrupts the wear update after it.
            self._finish(stage_result(scene, index, ensemble, update, finding))
        return update, finding

    def _passes(
        self, index: int, ensemble: Ensemble, at: Checkpoint
    ) -> Iterator[tuple[WearUpdate | None, Finding | None]]:
        """Apply a wear update pass by pass; yield each with the finding that ended it, if any."""
        runner, scene = self._runner, self._runner.scene
        joints, update, running = ensemble.linkage.clearances, at.update, at.running
        if not scene.wears_in_steps:
            update = jump(ensemble, scene.cycles_per_update)
            time = sum(run.time for run in ensemble.runs)
            yield update, _worn_out(joints, update.depth, f"after stage {index}", time)
            return
        while spec := pass_spec(scene, index, update):
            runner.progress.later = 2.0 * spec.cycles if update is None else 0.0
            _LOG.info("the wear after stage %d begins: %s", index, spec.label)

            def keep(running: EnsembleState, update: WearUpdate | None = update) -> None:
                self._checkpoint(replace(at, update=update, running=running))

            ensemble_of_pass = runner.run(ensemble.depth, spec, running, keep)
            running = EnsembleState()
            finding = ensemble_of_pass.finding
            if finding:
                yield update, replace(finding, what=f"{spec.label}: {finding.what}")
                return
            depth = np.array([recorder.surface_depth for recorder in ensemble_of_pass.recorders])
            time = sum(run.time for run in ensemble_of_pass.runs)
            finding = _worn_out(joints, depth, f"the {spec.label}:", time)
            if finding is None:
                update = cycle_by_cycle(ensemble_of_pass, scene.cycles_per_update, update)
            yield update, finding
            if finding:
                return

    def _finish(self, stage: StageResult) -> None:
        if self._at.life is None:
            self._unconverged.extend(unknown_wear(self._runner.scene, stage))
        steps = {key: value for key, value in stage.diagnostics.items() if key.startswith("steps")}
        how = stage.message or stage.status
        _LOG.info("stage %d ends: %s, %d cycles, %s", stage.index, how, stage.cycles, steps)
        for observer in self._observers:
            observer.on_stage(stage)


def stage_spec(scene: Scene, index: int) -> RunSpec:
    """Return the run specification of a stage: its cycles, or the tolerance of its wear maps."""
    if scene.cycles is not None:
        return RunSpec(scene.cycles)
    # A jump multiplies the noise of its map, which changes whatever comes after it long before it
    # shows in the map: all the cycles that are allowed, as in the paper.
    jumps = index < scene.wear_updates and not scene.wears_in_steps
    most = max(scene.max_cycles // scene.replicate_count, 1)
    return RunSpec(most, None if jumps or not scene.clearance_joints else scene.tolerance)


def pass_spec(scene: Scene, index: int, update: WearUpdate | None) -> RunSpec | None:
    """Return the next pass over the wear update after a stage; None if it is known well enough.

    With the number of cycles set, half of them and then all; else twice as many in each pass, until
    two passes agree, or the cycles are used up.

    Parameters
    ----------
    update : WearUpdate or None
        Last pass.
    """
    done = 0 if update is None else len(update.steps)
    if scene.cycles is not None:
        cycles = scene.cycles if done else max(scene.cycles // 2, 1)
        is_enough = done == scene.cycles
    else:
        cycles = 2 * done or min(FIRST_PASS, max(scene.max_cycles // scene.replicate_count, 1))
        is_enough = update is not None and (
            wear_error(scene.linkage().clearances, update) <= scene.tolerance
            or cycles * scene.replicate_count > scene.max_cycles
        )
    if is_enough:
        return None
    label = f"{stage_name(index + 1)} in {cycles} steps"
    wear = wear_per_cycle(scene.cycles_per_update, cycles)
    return RunSpec(STARTUP_CYCLES + cycles, wear=wear, number=1 + done, label=label)


def _worn_out(
    joints: Sequence[ClearanceJoint], depth: Array, where: str, time: float
) -> Finding | None:
    """Return a finding on the first replicate with a surface worn deeper than the clearance."""
    for surfaces in depth:
        worn = worn_out(joints, surfaces)
        if worn is not None:
            what = f"{where} {worn[1]}"
            return Finding("wear", what, time, worn[0], "a smaller cycles_per_update may help")
    return None


def unknown_wear(scene: Scene, stage: StageResult) -> list[str]:
    """Return a message if the wear of a stage is less accurate than requested."""
    error = stage.statistics.wear_error
    if scene.cycles is not None or error is None or error <= scene.tolerance:
        return []
    # The error of sampling falls with the square root of the cycles, and passes double.
    more = (error / scene.tolerance) ** 2
    steps, needed = len(stage.wear_steps), more * stage.cycles
    if steps > 1:
        needed = 2.0 ** math.ceil(math.log2(more)) * steps * scene.replicate_count
    return [
        f"the wear of stage {stage.index} is known to {100.0 * error:.2g} % where "
        f"tolerance = {100.0 * scene.tolerance:.2g} % was asked: about max_cycles = "
        f"{needed:.2g} would do"
    ]


def unknown_life(scene: Scene, life: LifeResult) -> list[str]:
    """Return a message if a life is less accurate than requested, or unknown."""
    if life.ended != "limit":
        return [f"the life is not known: {life.message}"]
    error = math.inf if life.error is None else math.hypot(life.sampling or 0.0, life.step or 0.0)
    if error <= scene.tolerance:
        return []
    accuracy = "not at all" if math.isinf(error) else f"to {100.0 * error:.2g} %"
    return [
        f"the life is known {accuracy} where tolerance = {100.0 * scene.tolerance:.2g} % was "
        "asked: a larger life.max_cycles would do"
    ]
