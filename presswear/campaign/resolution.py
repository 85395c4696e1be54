"""Whether a stage is resolved: short pieces of it again, a hundred times finer.

Two runs at different tolerances part after some touches, and then their difference says how
chaotic the motion is, not how well it was integrated.  So each piece begins in a state of the
run itself, contact by contact, and is too short for that: the pieces' differences in wear add up
to the error that the steps of a whole cycle make.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.segment import linkage_on
from presswear.campaign.starts import start_of
from presswear.engines.base import Plan
from presswear.record.recorder import Recorder
from presswear.record.tracker import Telling, Tracker
from presswear.scene.scene import Scene
from presswear.tools.arrays import State
from presswear.tools.workers import Report

PIECES = 100
"""Pieces of a cycle: between two touches of a joint lie some of them."""
EACH = 4
"""One piece in so many is run again."""
FINER = 100.0
"""Times finer that it is run."""
SETTLING = 2
"""Cycles before the one whose pieces are run again."""
WORTH = 50
"""Cycles of a stage that are enough for this to cost a twentieth of it at most."""


@dataclass
class _Again(Tracker):
    """Runs pieces of a run again behind its back."""

    run: Callable[[int, State], Recorder]
    first: int
    last: int
    finer: list[Recorder] = field(default_factory=list)
    pieces: list[int] = field(default_factory=list)

    def cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        done = len(recorder.cycles)
        if self.first <= done < self.last and (done - self.first) % EACH == 0:
            self.pieces.append(done)
            self.finer.append(self.run(done + 1, state()))
        return False


@dataclass(frozen=True)
class StepErrors:
    """What finer steps would change on some surfaces, as a job.

    Attributes
    ----------
    scene : Scene
    worn : ndarray, shape (joints, 2, m)
        Depth of the surfaces, m.
    start : int
        Of several; those of stages are not negative.
    """

    scene: Scene
    worn: NDArray[np.float64]
    start: int = -1

    def __call__(self, report: Report) -> dict[str, float]:
        """Run a cycle, and pieces of it again with finer steps.

        Returns
        -------
        dict of str to float
            Part by which finer steps change the force times slip that wears a joint, and the
            greatest forces of the pieces: the most of all joints, under their names among the
            statistics of a stage.  Empty where the engine has no tolerance or a run failed.
        """
        scene, linkage = self.scene, linkage_on(self.scene, self.worn)
        cycle = scene.mechanism.period
        engine = scene.solver.over(cycle)
        finer = engine.finer(FINER)
        if finer is None or not linkage.clearances:
            return {}
        start = start_of(scene, self.start)
        first, last = PIECES * SETTLING, PIECES * (SETTLING + 1)
        plan = Plan(cycle / PIECES, last, 0, torques=False, run_up=scene.run_up)

        def again(cycles: int, state: State) -> Recorder:
            own = replace(plan, cycles=cycles, resume=state)
            return finer.simulate(linkage, start, own).recorder

        tracker = _Again(again, first, last)
        run = engine.simulate(linkage, start, replace(plan, trackers=(tracker, Telling(report))))
        pairs = list(zip(tracker.pieces, tracker.finer, strict=True))
        if run.status == "failed" or any(len(fine.cycles) <= piece for piece, fine in pairs):
            return {}

        def change(name: str) -> float:
            usual, fine = (
                np.array([[own.each_cycle(name, k)[i] for k in joints] for i, own in each])
                for each in ([(i, run.recorder) for i, _ in pairs], pairs)
            )
            whole = usual.sum(axis=0)
            loaded = whole > 0.0
            changed = np.abs(fine.sum(axis=0) - whole)[loaded] / whole[loaded]
            return float(changed.max(initial=0.0))

        joints = range(len(linkage.clearances))
        return {"step_error_of_dose": change("dose"), "step_error_of_force": change("force_max")}
