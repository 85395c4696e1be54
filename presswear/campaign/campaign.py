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
from presswear.campaign.quick_life import WearRates, quick_life, rates_of
from presswear.campaign.replicates import RunSpec, StepCheck, worn_out
from presswear.campaign.stage_statistics import stage_result
from presswear.campaign.wear_histories import (
    LifeState,
    run_life,
    unknown_life,
    wear_between,
)
from presswear.campaign.wear_update import (
    FIRST_REFINEMENT,
    WearUpdate,
    cycle_by_cycle,
    cycles_of_update,
    initial_depth,
    jump,
    refinement_spec,
    stage_spec,
    start_up_of,
    unknown_wear,
)
from presswear.engines.settings import Engine
from presswear.recording.observer import COMPILING, Observer, Progress
from presswear.recording.soundness import Finding
from presswear.results.folder import INTERVAL, ResultFolder, provenance
from presswear.results.life import LifeResult
from presswear.results.motions import sentence_of
from presswear.results.result import Result, load
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.scene.stage_names import stage_name
from presswear.tools.arrays import Array, State
from presswear.tools.errors import InputError, RunFailed, shown
from presswear.tools.files import check_name, inside
from presswear.tools.numbers import large
from presswear.tools.processes import Job, Report, Workers, check_jobs, cores
from presswear.tools.serialize import checked_arguments

Outcome = tuple[str, str, Finding | None]  # status, message, finding

_LOG = logging.getLogger(__name__)

# imported by worker processes before the first job
WORK_MODULE = "presswear.campaign.replicates"
TURN = 1.0  # s, of work units that several processes share: they end together
_UNITS_PER_CHECKPOINT = 4.0  # a state may be so much of the checkpoint interval old
_DOCUMENT = "document"  # array of a checkpoint that holds everything but its arrays


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
    """Keeps a campaign in memory."""

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
    on_progress: Callable[[str, float, str], object] = lambda name, part, words: None,
    on_life_start: Callable[
        [str, float, float], object
    ] = lambda name, cycles, seconds: None,
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
        Called with the name of a scene, the completed fraction of its run, and a few
        words. At 1.0 the run has ended and the words are its status.
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
        """Passes the progress on."""

        def on_progress(self, progress: Progress) -> None:
            is_compiling = progress.word == COMPILING
            report(
                math.nan if is_compiling else min(progress.whole, 0.999), progress.word
            )

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
    is_twice = (
        scene.wear_updates > 0
        and not scene.wears_in_steps
        and scene.replicate_count > 1
    )
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
    # of the surfaces of its runs, m
    depth: Array = field(default_factory=lambda: np.zeros(0))
    stage: EnsembleState | None = None  # its finished runs, while they wear
    update: WearUpdate | None = None  # last refinement of the wear update after it
    # unfinished runs of the stage or of a refinement
    running: EnsembleState = EnsembleState()
    life: LifeState | None = None  # of the service life, which comes before the stages
    new: WearRates | None = None  # of the new surfaces, in a quick life

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""
        if self.life is not None and self.life.running.runs:
            blocks = self.life.refinements[-1].blocks if self.life.refinements else ()
            strokes = blocks[-1].strokes if blocks else 0.0
            number = self.life.place[0]
            return (
                f"refinement {number} of the life, {large(strokes, digits=2)} strokes"
            )
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
        # A jump adds replicates on surfaces of their own.
        if checkpoint and checkpoint.depth.shape[1:] != initial_depth(scene).shape[1:]:
            raise InputError(f"{store.path}: its checkpoint is of another scene")
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

    Observers are notified of each stage once the wear update after it is applied, or
    has failed.
    """
    scene.check_user_laws()
    runner = Runner(scene, workers or Workers(), observers)
    return _Campaign(runner, checkpoint or Checkpoint(depth=initial_depth(scene))).run()


def run_stage(
    scene: Scene,
    depth: Array | None = None,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> tuple[StageResult, Ensemble]:
    """Run the first stage without the wear update after it; return its runs as well."""
    depth = initial_depth(scene) if depth is None else depth
    runner = Runner(scene, workers or Workers(), observers)
    check = StepCheck(scene, depth[0])
    ensemble = runner.run(depth, stage_spec(scene, 0), step_check=check)
    return stage_result(scene, 0, ensemble), ensemble


@dataclass
class _Campaign:
    """Stages of a scene with the wear updates between them."""

    runner: Runner
    at: Checkpoint
    strokes: float | None = None  # of the service life, if the scene has one
    unconverged: list[str] = field(default_factory=list)  # messages

    def run(self) -> Outcome:
        """Run the service life, if the scene has one, and all stages."""
        if self.runner.scene.life is not None and not self.runner.scene.is_quick:
            try:
                self._run_life()
            except RunFailed as error:
                return "failed", f"{error}", error.finding
        for index in range(self.at.index, self.runner.scene.wear_updates + 1):
            failure = self._run_stage(index)
            if failure:
                return failure
        if self.unconverged:
            return "unconverged", "; ".join(self.unconverged), None
        return "completed", "", None

    def _keep(self, is_stage: bool = False, **changes: Any) -> None:
        """Pass the present state on, with what has changed meanwhile."""
        for observer in self.runner.observers:
            observer.on_checkpoint(replace(self.at, **changes), is_stage)

    def _run(
        self, depth: Array, spec: RunSpec, step_check: Job | None = None
    ) -> Ensemble:
        """Run an ensemble, or resume it, and keep its state."""
        return self.runner.run(
            depth,
            spec,
            self.at.running,
            lambda state: self._keep(running=state),
            step_check,
        )

    def _run_life(self) -> None:
        runner = self.runner
        scene = self.runner.scene
        state = self.at.life or LifeState()
        initial = initial_depth(scene)

        def report(life: LifeResult) -> None:
            for observer in runner.observers:
                observer.on_life(life)

        def announce(cycles: float, seconds: float) -> None:
            for observer in runner.observers:
                observer.on_life_start(cycles, seconds)

        refinements, life = run_life(
            runner, initial, state, lambda life: self._keep(life=life), report, announce
        )
        report(life)
        self.unconverged += unknown_life(scene, life)
        self.at = replace(self.at, life=LifeState(refinements))
        # The life is a mean over the refinements; the surfaces are those of the last
        # one.
        self.strokes = min(life.strokes, float(refinements[-1].strokes[-1]))
        # The wear update after a stage is for the part of the life up to the next
        # stage.
        part = max(self.strokes / scene.wear_updates, 1.0)
        runner.scene = replace(scene, cycles_per_update=part)

    def _run_stage(self, index: int) -> Outcome | None:
        """Run a stage and the wear update after it; return how it failed, or None."""
        runner = self.runner
        scene = self.runner.scene
        at = self.at
        runner.start_stage(index)
        _LOG.info("stage %d begins: %s", index, scene.stage_name(index))
        spec = stage_spec(scene, index)
        is_last = index == scene.wear_updates
        if at.stage is not None:
            ensemble = Ensemble.of(scene, spec, at.depth, at.stage)
            runner.done += ensemble.state.cycles / scene.replicate_count
        else:
            if scene.wears_in_steps and not is_last and self.strokes is None:
                runner.later = 3.0 * (scene.cycles or FIRST_REFINEMENT)
            ensemble = self._run(at.depth, spec, StepCheck(scene, at.depth[0]))
        runner.before = max(float(run.cycles) for run in ensemble.state.runs if run)
        finding = ensemble.finding
        try:
            if not (is_last or ensemble.failure):
                finding = self._apply_wear(index, ensemble)
        finally:
            # The stage is finished, even if somebody interrupts the wear update after
            # it.
            update = self.at.update
            self._finish(stage_result(scene, index, ensemble, update, finding))
        if ensemble.failure:
            return "failed", f"stage {index}: {ensemble.failure}", finding
        if finding is not None:
            return "failed", finding.words, finding
        if update is not None:
            self.at = Checkpoint(index + 1, update.depth, life=at.life, new=self.at.new)
            self._keep(is_stage=True)
        return None

    def _apply_wear(self, index: int, ensemble: Ensemble) -> Finding | None:
        """Apply the wear after a stage, by updates or of the life; return the finding."""
        runner = self.runner
        scene = self.runner.scene
        joints = ensemble.linkage.clearances
        if self.strokes is not None:
            assert self.at.life is not None
            since, until = (
                self.strokes * k / scene.wear_updates for k in (index, index + 1)
            )
            refinements = self.at.life.refinements
            initial = initial_depth(scene)
            update = wear_between(refinements, joints, initial, since, until)
            self.at = replace(self.at, update=update)
            return None
        if self.at.stage is None:
            self.at = replace(self.at, stage=ensemble.state, running=EnsembleState())
        self._keep()
        each = cycles_of_update(scene, ensemble)
        time = ensemble.simulated_s
        at_end = (index + 1) * each
        if not scene.wears_in_steps:
            update = jump(ensemble, each)
            self.at = replace(self.at, update=update)
            return worn_out(joints, update.depth, f"after stage {index} ", time, at_end)
        finding = None
        if self.at.update is None:
            # Surfaces that fit each other better wear more slowly, but hardly at half
            # the rate.
            depth = jump(ensemble, 0.5 * each).depth
            where = f"in half of the {stage_name(index + 1)} at the present rate "
            finding = worn_out(joints, depth, where, time, at_end - 0.5 * each)
        start_up = start_up_of(ensemble.settling)
        while not finding and (
            spec := refinement_spec(scene, index, each, self.at.update, start_up)
        ):
            runner.later = 2.0 * spec.cycles if self.at.update is None else 0.0
            _LOG.info("the wear after stage %d begins: %s", index, spec.label)
            worn = self._run(ensemble.depth, spec)
            if worn.finding is not None:
                return replace(worn.finding, what=f"{spec.label}: {worn.finding.what}")
            where = f"the {spec.label}: "
            time = worn.simulated_s
            finding = worn_out(joints, worn.surface_depth, where, time, at_end)
            if finding is None:
                update = cycle_by_cycle(worn, each, self.at.update, start_up)
                self.at = replace(self.at, update=update, running=EnsembleState())
        return finding

    def _finish(self, stage: StageResult) -> None:
        if self.at.life is None:
            self.unconverged += unknown_wear(self.runner.scene, stage)
        settling = stage.statistics.settling
        if settling and settling.verdict == "mixed":
            self.unconverged.append(f"{stage.name}: {sentence_of(settling)}")
        steps = {
            key: value
            for key, value in stage.diagnostics.items()
            if key.startswith("steps")
        }
        how = stage.message or stage.status
        cycles = stage.statistics.cycles
        _LOG.info("stage %d ends: %s, %d cycles, %s", stage.index, how, cycles, steps)
        for observer in self.runner.observers:
            observer.on_stage(stage)
        if self.runner.scene.is_quick and stage.status != "failed":
            self._add_to_quick_life(stage)

    def _add_to_quick_life(self, stage: StageResult) -> None:
        """Keep the wear rates of the first stage; report the life after the last one."""
        if self.at.new is None:
            self.at = replace(self.at, new=rates_of(self.runner.scene, stage))
            return
        life = quick_life(self.runner.scene, self.at.new, stage)
        for observer in self.runner.observers:
            observer.on_life(life)
