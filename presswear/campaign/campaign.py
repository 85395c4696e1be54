"""Campaign: run a stage, wear the surfaces, run again, from every replicate on its own surfaces."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from presswear.campaign.checkpoint import Checkpoint
from presswear.campaign.ensemble import Ensemble, EnsembleState
from presswear.campaign.life_result import unknown_life
from presswear.campaign.life_wear import wear_between
from presswear.campaign.quick_life import quick_life, rates_of
from presswear.campaign.replicates import RunSpec, StepCheck, worn_out
from presswear.campaign.runner import Runner
from presswear.campaign.stage_statistics import stage_result
from presswear.campaign.wear_histories import LifeState, run_life
from presswear.campaign.wear_update import (
    FIRST_REFINEMENT,
    cycle_by_cycle,
    cycles_of_update,
    initial_depth,
    jump,
    refinement_spec,
    stage_spec,
    start_up_of,
    unknown_wear,
)
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.recording.observer import Observer
from presswear.recording.soundness import Finding
from presswear.results.life import LifeResult
from presswear.results.motions import sentence_of
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.scene.stage_names import stage_name
from presswear.tools.arrays import Array
from presswear.tools.errors import KernelError, RunFailed
from presswear.tools.processes import Job, Workers

Outcome = tuple[str, str, Finding | None]  # status, message, finding

_LOG = logging.getLogger(__name__)


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
    strokes: float | None = None  # length of the service life, if the scene has one
    unconverged: list[str] = field(default_factory=list)  # messages

    def run(self) -> Outcome:
        """Run the service life, if the scene has one, and all stages."""
        scene = self.runner.scene
        if scene.life is not None and not scene.is_quick:
            try:
                self._run_life()
            except KernelError:
                raise
            except RunFailed as error:
                return "failed", f"{error}", error.finding
        for index in range(self.at.index, scene.wear_updates + 1):
            failure = self._run_stage(index)
            if failure:
                return failure
        if self.unconverged:
            return "unconverged", "; ".join(self.unconverged), None
        return "completed", "", None

    def _keep(self, is_stage: bool = False, **changes: Any) -> None:
        """Pass the present state on to the observers, with the changed fields."""
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
        """Run or resume the service life, and report it."""
        runner = self.runner
        scene = runner.scene

        def report(life: LifeResult) -> None:
            for observer in runner.observers:
                observer.on_life(life)

        def announce(cycles: float, seconds: float) -> None:
            for observer in runner.observers:
                observer.on_life_start(cycles, seconds)

        state, life = run_life(
            runner,
            initial_depth(scene),
            self.at.life or LifeState(),
            keep=lambda life: self._keep(life=life),
            report=report,
            announce=announce,
        )
        refinements = state.refinements
        report(life)
        self.unconverged += unknown_life(scene, life)
        stage = self.at.stage
        if scene.cycles is None:
            # The first stage has run, to show whether the motion settles.
            stage = state.watched or stage
        self.at = replace(self.at, life=LifeState(refinements), stage=stage)
        # The life is a mean over the refinements; the surfaces are those of the last
        # one.
        self.strokes = min(life.strokes, float(refinements[-1].strokes[-1]))
        # The wear update after a stage stands for the strokes up to the next stage.
        strokes_per_update = max(self.strokes / scene.wear_updates, 1.0)
        runner.scene = replace(scene, cycles_per_update=strokes_per_update)

    def _run_stage(self, index: int) -> Outcome | None:
        """Run a stage and the wear update after it; return how it failed, or None."""
        runner = self.runner
        scene = runner.scene
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
        scene = self.runner.scene
        joints = ensemble.linkage.clearances
        if self.strokes is not None:
            self._apply_wear_of_life(index, self.strokes, joints)
            return None
        if self.at.stage is None:
            self.at = replace(self.at, stage=ensemble.state, running=EnsembleState())
        self._keep()
        cycles = cycles_of_update(scene, ensemble)  # cycles that the update stands for
        if scene.wears_in_steps:
            return self._refine_update(index, ensemble, cycles)
        update = jump(ensemble, cycles)
        self.at = replace(self.at, update=update)
        where = f"after stage {index} "
        time = ensemble.simulated_s
        return worn_out(joints, update.depth, where, time, (index + 1) * cycles)

    def _apply_wear_of_life(
        self, index: int, strokes: float, joints: Sequence[ClearanceJoint]
    ) -> None:
        """Apply the wear of the service life from a stage to the next one."""
        assert self.at.life is not None
        scene = self.runner.scene
        since = strokes * index / scene.wear_updates
        until = strokes * (index + 1) / scene.wear_updates
        refinements = self.at.life.refinements
        initial = initial_depth(scene)
        update = wear_between(refinements, joints, initial, since, until)
        self.at = replace(self.at, update=update)

    def _refine_update(
        self, index: int, ensemble: Ensemble, cycles: float
    ) -> Finding | None:
        """Apply a wear update in steps, in refinements up to the tolerance."""
        runner = self.runner
        scene = runner.scene
        joints = ensemble.linkage.clearances
        at_end = (index + 1) * cycles
        finding = None
        if self.at.update is None:
            # Surfaces that fit each other better wear more slowly, but hardly at half
            # the rate.
            depth = jump(ensemble, 0.5 * cycles).depth
            where = f"in half of the {stage_name(index + 1)} at the present rate "
            time = ensemble.simulated_s
            finding = worn_out(joints, depth, where, time, at_end - 0.5 * cycles)
        start_up = start_up_of(ensemble.settling)
        while finding is None:
            spec = refinement_spec(scene, index, cycles, self.at.update, start_up)
            if spec is None:
                break
            runner.later = 2.0 * spec.cycles if self.at.update is None else 0.0
            _LOG.info("the wear after stage %d begins: %s", index, spec.label)
            worn = self._run(ensemble.depth, spec)
            if worn.finding is not None:
                return replace(worn.finding, what=f"{spec.label}: {worn.finding.what}")
            where = f"the {spec.label}: "
            time = worn.simulated_s
            finding = worn_out(joints, worn.surface_depth, where, time, at_end)
            if finding is None:
                update = cycle_by_cycle(worn, cycles, self.at.update, start_up)
                self.at = replace(self.at, update=update, running=EnsembleState())
        return finding

    def _finish(self, stage: StageResult) -> None:
        """Log and report a finished stage, and keep the reasons why it is not converged."""
        if self.at.life is None:
            self.unconverged += unknown_wear(self.runner.scene, stage)
        settling = stage.statistics.settling
        if settling and settling.verdict == "mixed":
            self.unconverged.append(f"{stage.name}: {sentence_of(settling)}")
        reason = stage.message or stage.status
        cycles = stage.statistics.cycles
        diagnostics = stage.diagnostics.items()
        steps = {key: value for key, value in diagnostics if key.startswith("steps")}
        text = "stage %d ends: %s, %d cycles, %s"
        _LOG.info(text, stage.index, reason, cycles, steps)
        for observer in self.runner.observers:
            observer.on_stage(stage)
        if not self.runner.scene.is_quick or stage.failed:
            return
        # The wear rates of the first stage are kept for the life after the last one.
        if self.at.new is None:
            self.at = replace(self.at, new=rates_of(self.runner.scene, stage))
            return
        life = quick_life(self.runner.scene, self.at.new, stage)
        for observer in self.runner.observers:
            observer.on_life(life)
