"""Campaign: run a stage, wear the surfaces, run again, from every replicate on its own surfaces."""

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import Ensemble, EnsembleState, Runner
from presswear.campaign.replicates import RunSpec, StepCheck, worn_out
from presswear.campaign.stage_statistics import stage_result
from presswear.campaign.wear_histories import LifeState, run_life, wear_between
from presswear.campaign.wear_update import (
    FIRST_REFINEMENT,
    WearUpdate,
    cycle_by_cycle,
    cycles_of_update,
    initial_depth,
    jump,
    wear_error,
    wear_per_cycle,
)
from presswear.engines.settings import Engine
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.soundness import Finding
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.folder import INTERVAL, ResultFolder, provenance
from presswear.results.life import LifeResult
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene, stage_name
from presswear.tools.arrays import Array, State
from presswear.tools.errors import InputError, RunFailed, shown
from presswear.tools.files import check_name, inside
from presswear.tools.processes import Report, Workers, cores
from presswear.tools.serialize import checked_names

Outcome = tuple[str, str, Finding | None]  # status, message, finding

_LOG = logging.getLogger(__name__)

WORK_MODULE = "presswear.campaign.replicates"  # imported by worker processes before the first job
TURN = 1.0  # s, of work units that several processes share: they end together
_UNITS_PER_CHECKPOINT = 4.0  # a state may be so much of the checkpoint interval old
_DOCUMENT = "document"  # array of a checkpoint that holds everything but its arrays


@checked_names
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
    if not isinstance(scene, Scene):
        example = "a Scene is expected, such as pw.scenes.ideal() or pw.scene_from('press.toml')"
        raise InputError(f"scene = {shown(scene)}: {example}")
    _check_jobs(jobs)
    scene = with_engine(scene, engine)
    scene.check()
    if folder is None:
        memory = _Memory()
        with workers_of(scene, jobs, observers) as workers:
            status, message, finding = run_campaign(scene, (memory, *observers), workers=workers)
        stages, wall = tuple(memory.stages), sum(stage.wall_s for stage in memory.stages)
        result = Result(scene, stages, status, message, provenance(), wall, life=memory.life)
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
    """Keeps a campaign in memory."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.life: LifeResult | None = None

    def on_life(self, life: LifeResult) -> None:
        self.life = life

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


def run_scenes(
    scenes: Mapping[str, Scene],
    folder: str | Path,
    engine: str | Engine | None = None,
    jobs: int | None = None,
    on_progress: Callable[[str, float, str], object] = lambda name, part, words: None,
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
        Scenes that run at a time; None: as many as there are cores. No number depends on it.
    on_progress : callable
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
    _check_jobs(jobs)
    paths = {}
    for name, scene in scenes.items():
        if not name or name != Path(name).name:
            raise InputError(f"{shown(name)} cannot name the folder of a scene")
        paths[name] = inside(Path(folder).resolve(), name)
        check_name(paths[name])
        scene.check_trusted()
    names = list(scenes)

    def on_end(key: int, status: str) -> dict[int, None]:
        on_progress(names[key], 1.0, status)
        return {}

    def on_report(key: int, done: float, words: str, _: object) -> None:
        on_progress(names[key], 0.0 if math.isnan(done) else done, words)

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
        """Passes the progress on."""

        def on_progress(self, progress: Progress) -> None:
            is_compiling = progress.word == COMPILING
            report(math.nan if is_compiling else min(progress.whole, 0.999), progress.word)

    result = run(scene, path, jobs=1, observers=[Reports()], check=False)
    return f"{result.status}: {result.message}" if result.message else result.status


def _check_jobs(jobs: int | None) -> None:
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: must be at least 1")


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
    is_twice = scene.wear_updates > 0 and not scene.wears_in_steps and scene.replicate_count > 1
    count = min(jobs or cores(), scene.replicate_count * (2 if is_twice else 1))
    # Frames for a window do not leave the process that runs.
    if any(observer.observes_runs or observer.frames for observer in observers):
        count = 1
    duration = interval / _UNITS_PER_CHECKPOINT
    if count > 1:
        duration = min(duration, TURN)
    return Workers(count, (WORK_MODULE, scene.solver.module), duration)


@dataclass(frozen=True)
class Checkpoint:
    """State of a campaign between two cycles, saved as named arrays."""

    index: int = 0  # of the stage that runs
    depth: Array = field(default_factory=lambda: np.zeros(0))  # of the surfaces of its runs, m
    stage: EnsembleState | None = None  # its finished runs, while they wear
    update: WearUpdate | None = None  # last refinement of the wear update after it
    running: EnsembleState = EnsembleState()  # unfinished runs of the stage or of a refinement
    life: LifeState | None = None  # of the service life, which comes before the stages

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""
        if self.life is not None and self.life.running.runs:
            blocks = self.life.refinements[-1].blocks if self.life.refinements else ()
            strokes = blocks[-1].strokes if blocks else 0.0
            return f"refinement {self.life.place[0]} of the life, {strokes:.3g} strokes"
        wear = "" if self.stage is None else ", the wear after it"
        return f"stage {self.index}{wear}, cycle {self.running.cycles}"

    def save(self) -> State:
        """Return the arrays in it by number, and everything else as a document."""
        import msgspec  # slow to import

        arrays: dict[str, NDArray[Any]] = {}

        def number_of(value: Any) -> Any:
            if isinstance(value, np.generic):
                return value.item()
            arrays[f"{len(arrays)}"] = value
            return len(arrays) - 1

        document = msgspec.msgpack.encode(self, enc_hook=number_of)
        return arrays | {_DOCUMENT: np.frombuffer(document, np.uint8)}

    @staticmethod
    def load(arrays: State) -> "Checkpoint":
        """Return the checkpoint that ``save`` gave."""
        import msgspec  # slow to import

        document = arrays[_DOCUMENT].tobytes()
        return msgspec.msgpack.decode(
            document, type=Checkpoint, dec_hook=lambda kind, number: arrays[f"{number}"]
        )


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
        workers = workers or Workers(lasts=store.interval / _UNITS_PER_CHECKPOINT)
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
    """
    scene.check_user_laws()
    runner = Runner(scene, workers or Workers(), observers)
    return _Campaign(runner, checkpoint or Checkpoint(depth=initial_depth(scene))).run()


def run_stage(
    scene: Scene,
    index: int,
    depth: Array | None = None,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> tuple[StageResult, Ensemble]:
    """Run one stage without the wear update after it; return its runs as well."""
    runner = Runner(scene, workers or Workers(), observers)
    runner.start_stage(index)
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
        self._unconverged: list[str] = []

    def _keep(self, is_stage: bool = False, **changes: Any) -> None:
        """Pass the present state on, with what has changed meanwhile."""
        for observer in self._runner.observers:
            observer.on_checkpoint(replace(self._at, **changes), is_stage)

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
        runner, scene = self._runner, self._runner.scene
        refinements, life = run_life(
            runner,
            initial_depth(scene),
            self._at.life or LifeState(),
            lambda life: self._keep(life=life),
        )
        for observer in runner.observers:
            observer.on_life(life)
        self._unconverged += unknown_life(scene, life)
        self._at = replace(self._at, life=LifeState(refinements))
        # The wear update after a stage is for the part of the life up to the next stage.
        part = max(life.strokes / scene.wear_updates, 1.0)
        runner.scene = replace(scene, cycles_per_update=part)
        return life.strokes

    def _run_stage(self, index: int, strokes: float | None) -> Outcome | None:
        """Run a stage and the wear update after it; return how it failed, or None."""
        runner, scene, at = self._runner, self._runner.scene, self._at
        runner.start_stage(index)
        _LOG.info("stage %d begins: %s", index, scene.stage_name(index))
        spec, is_last = stage_spec(scene, index), index == scene.wear_updates
        if at.stage is not None:
            ensemble = Ensemble.of(scene, spec, at.depth, at.stage)
            runner.done += ensemble.state.cycles / scene.replicate_count
        else:
            if scene.wears_in_steps and not is_last and strokes is None:
                runner.later = 3.0 * (scene.cycles or FIRST_REFINEMENT)
            check = StepCheck(scene, at.depth[0])
            ensemble = runner.run(
                at.depth, spec, at.running, lambda state: self._keep(running=state), check
            )
        finding = ensemble.finding
        try:
            if not (is_last or ensemble.failure):
                finding = self._apply_wear(index, ensemble, strokes)
        finally:
            # The stage is finished, even if somebody interrupts the wear update after it.
            update = self._at.update
            self._finish(stage_result(scene, index, ensemble, update, finding))
        if ensemble.failure:
            return "failed", f"stage {index}: {ensemble.failure}", finding
        if finding is not None:
            return "failed", finding.words, finding
        if update is not None:
            self._at = Checkpoint(index + 1, update.depth, life=at.life)
            self._keep(is_stage=True)
        return None

    def _apply_wear(self, index: int, ensemble: Ensemble, strokes: float | None) -> Finding | None:
        """Apply the wear after a stage, by updates or of the life; return the finding."""
        runner, scene, at = self._runner, self._runner.scene, self._at
        joints = ensemble.linkage.clearances
        if strokes is not None:
            assert at.life is not None
            since, until = (strokes * k / scene.wear_updates for k in (index, index + 1))
            initial = initial_depth(scene)
            update = wear_between(at.life.refinements, joints, initial, since, until)
            self._at = replace(at, update=update)
            return None
        if at.stage is None:
            self._at = replace(at, stage=ensemble.state, running=EnsembleState())
        self._keep()
        each = cycles_of_update(scene, ensemble)
        at_end = (index + 1) * each
        if not scene.wears_in_steps:
            update = jump(ensemble, each)
            self._at = replace(self._at, update=update)
            where = f"after stage {index} "
            return worn_out(joints, update.depth, where, ensemble.simulated_s, at_end)
        if self._at.update is None:
            # Surfaces that fit each other better wear more slowly, but hardly at half the rate.
            depth, time = jump(ensemble, 0.5 * each).depth, ensemble.simulated_s
            where = f"in half of the {stage_name(index + 1)} at the present rate "
            finding = worn_out(joints, depth, where, time, at_end - 0.5 * each)
            if finding is not None:
                return finding
        while (spec := refinement_spec(scene, index, each, self._at.update)) is not None:
            runner.later = 2.0 * spec.cycles if self._at.update is None else 0.0
            _LOG.info("the wear after stage %d begins: %s", index, spec.label)
            worn = runner.run(
                ensemble.depth, spec, self._at.running, lambda state: self._keep(running=state)
            )
            if worn.finding is not None:
                return replace(worn.finding, what=f"{spec.label}: {worn.finding.what}")
            time, depth = worn.simulated_s, worn.surface_depth
            finding = worn_out(joints, depth, f"the {spec.label}: ", time, at_end)
            if finding is not None:
                return finding
            update = cycle_by_cycle(worn, each, self._at.update)
            self._at = replace(self._at, update=update, running=EnsembleState())
        return None

    def _finish(self, stage: StageResult) -> None:
        if self._at.life is None:
            self._unconverged += unknown_wear(self._runner.scene, stage)
        steps = {key: value for key, value in stage.diagnostics.items() if key.startswith("steps")}
        how = stage.message or stage.status
        _LOG.info(
            "stage %d ends: %s, %d cycles, %s", stage.index, how, stage.statistics.cycles, steps
        )
        for observer in self._runner.observers:
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


def refinement_spec(
    scene: Scene, index: int, cycles_per_update: float, update: WearUpdate | None
) -> RunSpec | None:
    """Return the next refinement of the wear update after a stage; None if it is known.

    With the number of cycles set, half of them and then all; else twice as many in each refinement,
    until two agree, or the cycles are used up.
    """
    done = 0 if update is None else len(update.steps)
    if scene.cycles is not None:
        cycles = scene.cycles if done else max(scene.cycles // 2, 1)
        is_enough = done == scene.cycles
    else:
        most = scene.max_cycles // scene.replicate_count
        cycles = 2 * done or min(FIRST_REFINEMENT, max(most, 1))
        is_enough = update is not None and (
            cycles > most or wear_error(scene.linkage().clearances, update) <= scene.tolerance
        )
    if is_enough:
        return None
    label = f"{stage_name(index + 1)} in {cycles} steps"
    wear = wear_per_cycle(cycles_per_update / cycles)
    return RunSpec(STARTUP_CYCLES + cycles, wear=wear, number=1 + done, label=label)


def unknown_wear(scene: Scene, stage: StageResult) -> list[str]:
    """Return a message if the wear of a stage is less accurate than requested."""
    error = stage.statistics.wear_error
    if scene.cycles is not None or error is None or error <= scene.tolerance:
        return []
    # The error of sampling falls with the square root of the cycles, and refinements double.
    more = (error / scene.tolerance) ** 2
    steps, needed = len(stage.wear_steps), more * stage.statistics.cycles
    if steps > 1:
        needed = 2.0 ** math.ceil(math.log2(more)) * steps * scene.replicate_count
    return [
        f"the error of the {stage_name(stage.index + 1)}, {100.0 * error:.2g} %, exceeds tolerance "
        f"= {100.0 * scene.tolerance:.2g} %: about max_cycles = {math.ceil(needed)} is needed"
    ]


def unknown_life(scene: Scene, life: LifeResult) -> list[str]:
    """Return a message if a life is less accurate than requested, or unknown."""
    if life.ended != "limit":
        return [f"the life is not known: {life.message}"]
    if life.error is not None and life.error <= scene.tolerance:
        return []
    fault = "is unknown"
    if life.error is not None:
        fault = f"is {100.0 * life.error:.2g} %, above tolerance = {100.0 * scene.tolerance:.2g} %"
    return [f"the error of the life {fault}: a larger life.max_cycles is needed"]
