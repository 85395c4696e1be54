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

from presswear.campaign.replicates import start_of
from presswear.campaign.segment import linkage_on
from presswear.engines.base import Plan
from presswear.recording.observer import AdvanceObserver, Observer
from presswear.recording.recorder import Recorder
from presswear.scene.scene import Scene
from presswear.tools.arrays import State
from presswear.tools.workers import Report

Array = NDArray[np.float64]

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

_TOLD = {"load_distance": "load_distance_step_error", "force_max": "peak_force_step_error"}
"""Numbers of a piece that are compared, and the names of what changes them."""


@dataclass
class _Again(Observer):
    """Runs pieces of a run again behind its back."""

    run: Callable[[int, State], Array]
    first: int
    last: int
    finer: dict[int, Array] = field(default_factory=dict)

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        done = len(recorder.cycles)
        if self.first <= done < self.last and (done - self.first) % EACH == 0:
            self.finer[done] = self.run(done, state())
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
    worn: Array
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

        def told(recorder: Recorder, piece: int) -> Array:
            """Numbers of a piece, of each joint; no number where it was not finished."""
            if piece >= len(recorder.cycles):
                return np.full((len(_TOLD), len(linkage.clearances)), np.nan)
            joints = range(len(linkage.clearances))
            return np.array([[recorder.each_cycle(n, k)[piece] for k in joints] for n in _TOLD])

        def again(piece: int, state: State) -> Array:
            own = replace(plan, cycles=piece + 1, resume=state)
            return told(finer.simulate(linkage, start, own).recorder, piece)

        observer = _Again(again, first, last)
        observed = replace(plan, observers=(observer, AdvanceObserver(report)))
        run = engine.simulate(linkage, start, observed)
        usual = np.array([told(run.recorder, piece) for piece in observer.finer])
        fine = np.array(list(observer.finer.values()))
        if run.status == "failed" or np.isnan(fine).any():
            return {}

        def change(usual: Array, fine: Array) -> float:
            whole = usual.sum(axis=0)
            loaded = whole > 0.0
            changed = np.abs(fine.sum(axis=0) - whole)[loaded] / whole[loaded]
            return float(changed.max(initial=0.0))

        return {
            name: change(usual[:, row], fine[:, row]) for row, name in enumerate(_TOLD.values())
        }
