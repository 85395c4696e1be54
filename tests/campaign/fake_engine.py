"""Engine that does nothing but wear by a law, and an observer of a campaign."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from presswear.engines.base import Plan, Run, Start, recorder_of
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.recording.observer import Observer, Progress
from presswear.recording.soundness import Finding
from presswear.results.stage import StageResult
from presswear.tools.arrays import named, part

Array = NDArray[np.float64]
Law = Callable[[int, Array], Array]
"""Number of the run, and depth of the surfaces, shape (joints, 2, m): depth of one cycle, m."""


@dataclass
class FakeEngine:
    """Engine that wears by a law; runs are numbered from 1, and one of them may fail or stop."""

    law: Law
    fails: int = 0
    stopped: int = 0
    runs: int = 0

    def __call__(self, linkage: Linkage, start: Start, plan: Plan) -> Run:
        self.runs += 1
        recorder = recorder_of(linkage, start, plan)
        recorder.records.output["now"] = plan.cycle * plan.cycles
        if plan.resume is not None:
            recorder.load(part(plan.resume, "recorder"))
        is_enough = False
        for cycle in range(len(recorder.cycles), plan.cycles):
            plan.advanced((cycle + 0.5) * plan.cycle, recorder)
            if self.runs == self.stopped and cycle == 1:
                raise KeyboardInterrupt
            recorder.records.cycle[:] = 100.0 * self.runs
            worn = recorder.surface_depth
            worn = worn if worn.size else np.zeros(recorder.records.depth.shape)
            recorder.records.depth[...] = self.law(self.runs, worn)
            added = recorder.end_cycle()
            if plan.wear is not None:
                recorder.wear(plan.wear(cycle + 1, added), start.position, start.velocity)
            state = partial(named, "recorder", recorder.save())
            is_enough = any(observer.on_cycle(recorder, state) for observer in plan.observers)
            if is_enough and cycle + 1 < plan.cycles:
                break
        else:
            is_enough = False
        failed = self.runs == self.fails
        return Run(
            "failed" if failed else "enough" if is_enough else "completed",
            Finding("state", "the solver found no step", 0.1, "", "") if failed else None,
            recorder,
            start,
            plan.cycle * plan.cycles,
            {"model": "none", "energy_residual_J": 0.0, "drive_exchange_J": 0.0, "steps": 1},
        )


class Seen(Observer):
    """Stages, progress and outcome of a campaign."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.progress: list[Progress] = []
        self.status = self.message = ""

    def on_progress(self, progress: Progress) -> None:
        self.progress.append(progress)

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


def use(engine: FakeEngine, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a fake engine in place of any."""
    for kind in (ExudynTree, ExudynJoints, InHouse):
        monkeypatch.setattr(kind, "simulate", lambda self, *given: engine(*given))
