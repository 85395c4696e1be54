"""Engine that does nothing but wear by a law, and scenes for it."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from presswear.engines.base import Plan, Run, Start, Status, recorder_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES, bin_centres
from presswear.physics.running_in import RunningIn
from presswear.recording.observer import Observer, Progress
from presswear.recording.soundness import Finding
from presswear.recording.statistics import half_width
from presswear.results.joint_result import JointResult
from presswear.results.life import LifeResult
from presswear.results.stage import StageResult
from presswear.scene.catalog import wear_times
from presswear.tools.arrays import Array, named, part

Law = Callable[[int, Array], Array]
"""Number of the run, and depth of the surfaces, shape (joints, 2, m): depth of one cycle, m."""


@dataclass
class FakeEngine:
    """Engine that wears by a law; runs are numbered from 1, and one of them may fail."""

    law: Law
    fails: int = 0
    runs: int = 0

    def __call__(self, linkage: Linkage, start: Start, plan: Plan) -> Run:
        self.runs += 1
        recorder = recorder_of(linkage, start, plan)
        recorder.records.output["now"] = plan.cycle * plan.cycles
        if plan.resume is not None:
            recorder.load(part(plan.resume, "recorder"))
        status: Status = "completed"
        for cycle in range(len(recorder.cycles), plan.cycles):
            recorder.records.nominal["now"] = (cycle + 0.5) * plan.cycle
            plan.advanced(recorder)
            recorder.records.cycle[:] = 100.0 * self.runs
            worn = recorder.surface_depth
            worn = worn if worn.size else np.zeros(recorder.records.depth.shape)
            recorder.records.depth[...] = self.law(self.runs, worn)
            added = recorder.end_cycle()
            if plan.wear is not None:
                depth = recorder.surface_depth
                recorder.wear(plan.wear(cycle + 1, added, depth), lambda: None)
            state = partial(named, "recorder", recorder.save())
            if any(observer.on_cycle(recorder, state) for observer in plan.observers):
                status = "enough" if cycle + 1 < plan.cycles else "completed"
                break
        finding = None
        if self.runs == self.fails:
            status = "failed"
            finding = Finding("state", "the solver found no step", 0.1, "", "")
        solved: dict[str, Any] = {"model": "none", "steps": 1}
        solved |= {"energy_residual_J": 0.0, "drive_exchange_J": 0.0}
        return Run(status, finding, recorder, start, plan.cycle * plan.cycles, solved)


class Seen(Observer):
    """Stages, progress and outcome of a campaign."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.progress: list[Progress] = []
        self.lives: list[LifeResult] = []
        self.life: LifeResult | None = None
        self.status = self.message = ""

    def on_progress(self, progress: Progress) -> None:
        self.progress.append(progress)

    def on_life(self, life: LifeResult) -> None:
        self.lives.append(life)
        self.life = life

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


class Stops(Observer):
    """Interrupts a campaign after a number of reports of progress with a word."""

    def __init__(self, word: str, reports: int = 1) -> None:
        self.word = word
        self.left = reports

    def on_progress(self, progress: Progress) -> None:
        self.left -= self.word in progress.word
        if not self.left:
            raise KeyboardInterrupt


CLEARANCE = 0.8e-3
CYCLES = 6
REPRESENTED = 4e6
RATE = 0.05 * CLEARANCE / REPRESENTED
"""Depth of one cycle where it is deepest: an update wears a twentieth of the clearance, m."""

SCENE = replace(
    wear_times(),
    cycles=CYCLES,
    wear_updates=2,
    replicates=2,
    cycles_per_update=REPRESENTED,
    extrapolation="steps",
)
JUMPS = replace(SCENE, extrapolation="single")
SHAPE = np.stack(
    [np.exp(np.cos(bin_centres(360)) - 1.0), 0.3 + 0.2 * np.sin(bin_centres(360))]
)
"""Wear of bearing and pin; its largest value is that of the bearing, near 1."""


def constant(run: int, depth: Array) -> Array:
    return np.stack([RATE * SHAPE, 0.4 * RATE * SHAPE])


def uneven(run: int, depth: Array) -> Array:
    """Return rates that come and go from run to run, as in a chaotic motion."""
    return constant(run, depth) * (1.0, 0.3, 2.7, 0.9)[run % 4]


def exponential(run: int, depth: Array) -> Array:
    """Return dh/dN = a + b h: the depth grows to a (exp(b N) - 1) / b."""
    return RATE * SHAPE + depth / REPRESENTED


def depth_of(joint: JointResult) -> Array:
    return np.stack([joint.depth(side) for side in SIDES])


def added_to(joint: JointResult) -> Array:
    return np.stack([joint.wear(side) for side in SIDES])


def half_of(*values: float) -> float:
    return half_width(np.array(values)) or math.nan


Campaign = Callable[..., Seen]
Use = Callable[[FakeEngine], None]


RUNS_IN = RunningIn(30.0, 20e-6)
RUN_IN = {"running_in": 30.0, "running_in_depth": "20 um"}
