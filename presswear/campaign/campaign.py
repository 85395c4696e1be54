"""The outer loop: run, wear the surfaces, run again, from every start on its own surfaces."""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.chains import LifeState, growth_between
from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.ensemble import NOTHING, Ensemble, Partial, Runner
from presswear.campaign.growth import (
    FIRST_PASS,
    Growth,
    cycle_by_cycle,
    error_of,
    jump,
    share_of,
)
from presswear.campaign.lifetime import run_life
from presswear.campaign.progress import Forecast
from presswear.campaign.resolution import StepErrors
from presswear.campaign.segment import Task, worn_out
from presswear.campaign.stage import stage_of, without_wear
from presswear.linkage.elements import ClearanceJoint
from presswear.physics.wear import map_shape
from presswear.recording.observer import Observer
from presswear.recording.soundness import Finding
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.life import LifeResult
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene, stage_name
from presswear.tools.errors import RunFailed
from presswear.tools.workers import InProcess, Workers

Array = NDArray[np.float64]

_LOG = logging.getLogger(__name__)


def begun_on(scene: Scene) -> Array:
    """Depth of the surfaces that every start begins on, shape (starts, joints, 2, m), m."""
    joints = scene.linkage().clearances
    worn = np.zeros(map_shape(joints))
    for depth, joint in zip(worn, joints, strict=True):
        for own, surface in zip(depth, (joint.bearing_surface, joint.pin_surface), strict=True):
            own[: joint.bins] = surface.depth if surface.is_worn else 0.0
    return np.repeat(worn[np.newaxis], scene.draws, axis=0)


def stage_task(scene: Scene, index: int) -> Task:
    """The runs of a stage: cycles as given, or until the wear maps are known."""
    if scene.cycles is not None:
        return Task(scene.cycles)
    # A jump multiplies the noise of its map, which moves whatever comes behind long before it
    # shows in the map: all the cycles that may be, as in the paper.  Without a joint that is open
    # there is no map.
    jumps = index < scene.wear_updates and not scene.wears_in_steps
    most = max(scene.max_cycles // scene.draws, 1)
    return Task(most, None if jumps or not scene.clearance_joints else scene.tolerance)


def pass_task(scene: Scene, index: int, growth: Growth | None) -> Task | None:
    """The next pass over the wear after a stage; None where it is known, or as far as it may be.

    With cycles given, half of them and then all; else twice as many in each pass, until
    half-way passes agree.

    Parameters
    ----------
    growth : Growth or None
        The last pass.
    """
    done = 0 if growth is None else len(growth.steps)
    if scene.cycles is not None:
        cycles = scene.cycles if done else max(scene.cycles // 2, 1)
        is_enough = done == scene.cycles
    else:
        cycles = 2 * done or min(FIRST_PASS, max(scene.max_cycles // scene.draws, 1))
        joints = scene.linkage().clearances
        is_enough = growth is not None and (
            error_of(joints, growth) <= scene.tolerance or cycles * scene.draws > scene.max_cycles
        )
    if is_enough:
        return None
    word = f"{stage_name(index + 1)} in {cycles} steps"
    wear = share_of(scene.cycles_per_update, cycles)
    return Task(STARTUP_CYCLES + cycles, wear=wear, number=1 + done, word=word)


def run_stage(
    scene: Scene,
    index: int,
    worn: Array | None = None,
    observers: Sequence[Observer] = (),
    workers: Workers | None = None,
) -> tuple[StageResult, Ensemble]:
    """Run one stage on given surfaces, without the wear after it; gives its runs as well.

    Parameters
    ----------
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces of each run, m; None: those that the scene begins on.
    workers : Workers or None
        Does the runs; None: this process.
    """
    forecast = Forecast(replace(scene, wear_updates=index), observers)
    forecast.begin(index)
    runner = Runner(scene, forecast, workers or InProcess())
    worn = begun_on(scene) if worn is None else worn
    ran = _stage(runner, index, worn)
    stage = without_wear(scene, index, ran)
    for observer in observers:
        observer.on_stage(stage)
    return stage, ran


def _stage(
    runner: Runner,
    index: int,
    worn: Array,
    begun: Partial = NOTHING,
    keep: Callable[[Partial], None] = lambda partial: None,
) -> Ensemble:
    """The runs of a stage; see ``Runner.run``."""
    scene = runner.scene
    task, errors = stage_task(scene, index), StepErrors(scene, worn[0])
    return _counted(runner, runner.run(worn, task, begun, keep, errors))


def _counted(runner: Runner, ran: Ensemble) -> Ensemble:
    """Runs whose cycles the forecast counts as run."""
    runner.forecast.done += ran.cycles / runner.scene.draws
    return ran


def growths(
    runner: Runner,
    index: int,
    ran: Ensemble,
    growth: Growth | None,
    begun: Partial,
    keep: Callable[[Growth | None, Partial], None],
) -> Iterator[tuple[Growth | None, Finding | None]]:
    """Apply the wear after a stage pass by pass; yields each with what is wrong, if anything.

    Parameters
    ----------
    growth : Growth or None
        The last pass that is finished.
    begun : Partial
        What has run of the next one.
    keep : callable
        Told now and then where those runs stand.
    """
    scene, joints = runner.scene, ran.linkage.clearances
    represented = scene.cycles_per_update
    if not scene.wears_in_steps:
        found = jump(ran, represented)
        yield found, _gone(joints, found.worn, f"after stage {index}", ran.time)
        return
    while True:
        task = pass_task(scene, index, growth)
        if task is None:
            return
        runner.forecast.expect(2.0 * task.cycles if growth is None else 0.0)
        _LOG.info("the wear after stage %d begins: %s", index, task.word)
        worn = _counted(runner, runner.run(ran.worn, task, begun, partial(keep, growth)))
        begun = NOTHING
        finding = worn.finding
        if finding:
            yield growth, replace(finding, what=f"{task.word}: {finding.what}")
            return
        finished = np.array([recorder.worn for recorder in worn.recorders])
        gone = _gone(joints, finished, f"the {task.word}:", worn.time)
        if gone:
            yield growth, gone
            return
        growth = cycle_by_cycle(worn, represented, growth)
        yield growth, None


def unknown_wear(scene: Scene, stage: StageResult) -> list[str]:
    """Say where the wear of a stage is known less well than was asked, and what it would take."""
    error = stage.statistics.wear_error
    if scene.cycles is not None or error is None or error <= scene.tolerance:
        return []
    # An error of sampling falls with the square root of the cycles, and passes double.
    more = (error / scene.tolerance) ** 2
    steps, needed = len(stage.wear_steps), more * stage.cycles
    if steps > 1:
        needed = 2.0 ** math.ceil(math.log2(more)) * steps * scene.draws
    return [
        f"the wear of stage {stage.index} is known to {100.0 * error:.2g} % where "
        f"tolerance = {100.0 * scene.tolerance:.2g} % was asked: about max_cycles = "
        f"{needed:.2g} would do"
    ]


def unknown_life(scene: Scene, life: LifeResult) -> list[str]:
    """Say where a life is known less well than was asked, or not at all."""
    if life.ended != "limit":
        return [f"the life is not known: {life.message}"]
    error = math.inf if life.error is None else math.hypot(life.sampling or 0.0, life.step or 0.0)
    if error <= scene.tolerance:
        return []
    known = "not at all" if math.isinf(error) else f"to {100.0 * error:.2g} %"
    return [
        f"the life is known {known} where tolerance = {100.0 * scene.tolerance:.2g} % was asked: "
        "a larger life.max_cycles would do"
    ]


def _gone(joints: Sequence[ClearanceJoint], worn: Array, where: str, time: float) -> Finding | None:
    """A finding on the first start whose surfaces are worn through."""
    for own in worn:
        gone = worn_out(joints, own)
        if gone is not None:
            joint, what = gone
            return Finding(
                "wear", f"{where} {what}", time, joint, "fewer represented_cycles may help"
            )
    return None


def run_campaign(
    scene: Scene,
    observers: Sequence[Observer],
    begun: Checkpoint | None = None,
    workers: Workers | None = None,
) -> tuple[str, str, Finding | None]:
    """Run every stage; returns status (``completed`` or ``failed``), a message and the finding.

    Observers hear of each stage as soon as the wear after it is applied, or as far as that came.

    Parameters
    ----------
    begun : Checkpoint
        Where to go on, as observers were told; None: from the start.
    workers : Workers or None
        Does the runs; None: this process.
    """
    scene.check_own_laws()
    forecast = Forecast(scene, observers)
    runner = Runner(scene, forecast, workers or InProcess())
    at = Checkpoint(worn=begun_on(scene)) if begun is None else begun
    forecast.restore(at.forecast)

    def tell(checkpoint: Checkpoint, is_stage: bool = False) -> None:
        for observer in observers:
            observer.on_checkpoint(checkpoint, is_stage)

    wanting: list[str] = []
    state, strokes = at.life, 0.0
    if scene.life is not None:

        def alive(own: LifeState) -> None:
            tell(Checkpoint(worn=at.worn, forecast=forecast.numbers(), life=own))

        try:
            passes, life = run_life(runner, begun_on(scene), state or LifeState(), alive)
        except RunFailed as error:
            return "failed", f"{error}", error.finding
        for observer in observers:
            observer.on_life(life)
        wanting += unknown_life(scene, life)
        state, strokes = LifeState(passes), life.strokes
        # What a stage tells of its wear is for the part of the life up to the next.
        scene = replace(scene, cycles_per_update=max(strokes / scene.wear_updates, 1.0))
        runner = replace(runner, scene=scene)

    def finish(stage: StageResult) -> None:
        if state is None:
            wanting.extend(unknown_wear(scene, stage))
        how = stage.message or stage.status
        steps = {key: own for key, own in stage.diagnostics.items() if key.startswith("steps")}
        _LOG.info("stage %d ends: %s, %d cycles, %s", stage.index, how, stage.cycles, steps)
        for observer in observers:
            observer.on_stage(stage)

    for index in range(at.index, scene.wear_updates + 1):
        worn = at.worn
        if begun is None or forecast.index != index:
            forecast.begin(index)
        _LOG.info("stage %d begins: %s", index, scene.stage_name(index))

        def keep(
            ran: Ensemble | None,
            growth: Growth | None,
            running: Partial,
            index: int = index,
            worn: Array = worn,
        ) -> None:
            tell(Checkpoint(index, worn, ran, growth, running, forecast.numbers(), state))

        is_last = index == scene.wear_updates
        if scene.wears_in_steps and not is_last and state is None:
            forecast.expect(3.0 * (scene.cycles or FIRST_PASS))
        ran = at.ran or _stage(runner, index, worn, at.partial, partial(keep, None, None))
        if ran.failure or is_last:
            finish(without_wear(scene, index, ran))
            if ran.failure:
                return "failed", f"stage {index}: {ran.failure}", ran.finding
            break
        if state is not None:
            since, until = (strokes * k / scene.wear_updates for k in (index, index + 1))
            joints = ran.linkage.clearances
            part = growth_between(state.passes, joints, begun_on(scene), since, until)
            finish(stage_of(scene, index, ran, part, None))
            at = Checkpoint(index + 1, part.worn, forecast=forecast.numbers(), life=state)
            tell(at, is_stage=True)
            continue
        growth, finding = at.growth, None
        # What has run in part is of the stage itself before its wear has begun.
        running = NOTHING if at.ran is None else at.partial
        keep(ran, growth, running)
        try:
            applied = growths(runner, index, ran, growth, running, partial(keep, ran))
            for reached in applied:
                growth, finding = reached
        finally:
            # The stage ran to its end, even where somebody stops the wear after it.
            finish(stage_of(scene, index, ran, growth, finding))
        if finding:
            return "failed", finding.words, finding
        assert growth is not None, "a wear without a finding has a pass"
        at = Checkpoint(index + 1, growth.worn, forecast=forecast.numbers())
        tell(at, is_stage=True)
    if wanting:
        return "unconverged", "; ".join(wanting), None
    return "completed", "", None
