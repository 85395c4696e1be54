"""Observers: objects that are notified of the events of a run or a campaign."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from presswear.tools.arrays import State

if TYPE_CHECKING:
    from presswear.recording.recorder import Recorder

COMPILING = "compiling"  # ``Progress.word`` while a run waits for the compiler


@dataclass(frozen=True)
class Progress:
    """Progress of a campaign."""

    stage: int  # index of the present stage
    # completed fraction of this stage with the wear update after it, 0 to 1
    part: float
    # completed fraction of the campaign, 0 to 1, as far as it can be estimated
    whole: float
    word: str  # short description of the present step, or ""
    # latest estimate of the completed fraction, which may decrease, unlike ``whole``
    estimate: float | None = None


class Observer:
    """Object that is notified of a run; a subclass overrides the methods that it needs."""

    @property
    def observes_runs(self) -> bool:
        """True if it overrides ``on_cycle``: a campaign then runs everything in this process."""
        return type(self).on_cycle is not Observer.on_cycle

    def on_progress(self, progress: Progress) -> None:
        """Called many times a second with the progress of a campaign."""

    def on_cycle(self, recorder: "Recorder", state: Callable[[], State]) -> bool:
        """Called by the engine after each cycle of a run; True ends the run.

        Parameters
        ----------
        state : callable
            Returns the arrays from which another process can continue the run.
        """
        return False

    def on_stage(self, stage: Any) -> None:
        """Called with a finished stage (``StageResult``) after its wear update."""

    def on_life_start(self, cycles: float, seconds: float) -> None:
        """Called after the first strokes of a service life with its expected duration.

        Parameters
        ----------
        cycles : float
            Expected cycles of all replicates.
        seconds : float
            Expected wall time, s.
        """

    def on_life(self, life: Any) -> None:
        """Called with a service life (``LifeResult``) before the stages through it run.

        A preliminary life is reported after each refinement but the last.
        """

    def on_checkpoint(self, checkpoint: Any, is_stage: bool) -> None:
        """Called with the state of a campaign (``Checkpoint``), and after each stage."""
