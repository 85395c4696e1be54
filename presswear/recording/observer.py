"""Observers: objects that are notified of what happens while something runs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import State

if TYPE_CHECKING:
    from presswear.recording.film import Film
    from presswear.recording.recorder import Recorder

COMPILING = "compiling"  # word of the progress while a run waits for the compiler


@dataclass(frozen=True)
class Progress:
    """Progress of a campaign."""

    stage: int  # index of the stage that runs
    # completed fraction of that stage and of the wear update after it, 0 to 1
    part: float
    # completed fraction of the campaign, 0 to 1, as far as it can be estimated
    whole: float
    word: str  # short description of the present step, or nothing
    linkage: Linkage  # that runs, on its worn surfaces
    film: "Film | None" = (
        None  # last frames of one of the runs, if an observer needs frames
    )
    # ``whole`` by the latest estimate alone, which may fall
    estimate: float | None = None


class Observer:
    """Object that is notified of a run; a subclass overrides the methods that it needs.

    Attributes
    ----------
    frames : int
        Number of film frames that ``on_progress`` needs.
    """

    frames = 0

    @property
    def observes_runs(self) -> bool:
        """True if it overrides ``on_cycle``: a campaign then keeps its runs in this process."""
        return type(self).on_cycle is not Observer.on_cycle

    def on_progress(self, progress: Progress) -> None:
        """Called many times a second with the progress of a campaign."""

    def on_cycle(self, recorder: "Recorder", state: Callable[[], State]) -> bool:
        """Called by the engine after each cycle of a run; True ends the run.

        Parameters
        ----------
        state : callable
            Returns all that another process needs to continue the run.
        """
        return False

    def on_stage(self, stage: Any) -> None:
        """Called with a finished stage (``StageResult``), the wear update after it included."""

    def on_life_start(self, cycles: float, seconds: float) -> None:
        """Called after the first strokes of a service life with what it will still take.

        Parameters
        ----------
        cycles : float
            Of all replicates.
        seconds : float
            Wall time at the speed so far.
        """

    def on_life(self, life: Any) -> None:
        """Called with a service life (``LifeResult``) before the stages through it run.

        A preliminary one is reported after each refinement that another one follows.
        """

    def on_checkpoint(self, checkpoint: Any, is_stage: bool) -> None:
        """Called with the state of a campaign (``Checkpoint``), and after each stage."""
