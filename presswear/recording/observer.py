"""Observers: objects that are notified of what happens while something runs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import State

if TYPE_CHECKING:
    from presswear.recording.film import Film
    from presswear.recording.recorder import Recorder


@dataclass(frozen=True)
class Progress:
    """Progress of a campaign.

    Attributes
    ----------
    stage : int
        Index of the stage that runs.
    part : float
        Completed fraction of that stage and of the wear update after it, 0 to 1.
    whole : float
        Completed fraction of the whole campaign, 0 to 1, as far as it can be estimated.
    word : str
        Short description of the present step, or nothing.
    linkage : Linkage
        Linkage that runs, on its worn surfaces.
    film : Film or None
        Last frames of one of the runs; None where no observer wants frames.
    """

    stage: int
    part: float
    whole: float
    word: str
    linkage: Linkage
    film: "Film | None" = None


class Observer:
    """Object that is notified of a run; a subclass overrides the methods that it needs.

    An engine calls ``on_start``, ``on_advance`` and ``on_cycle``. A campaign passes these on from
    each of its runs, which it then keeps in this process, and calls all others.

    Attributes
    ----------
    frames : int
        Number of film frames that ``on_progress`` needs.
    """

    frames = 0

    @property
    def observes_runs(self) -> bool:
        """True if it overrides a method that an engine calls."""
        names = ("on_start", "on_advance", "on_cycle")
        return any(getattr(type(self), name) is not getattr(Observer, name) for name in names)

    def on_start(self, recorder: "Recorder") -> None:
        """Called when a run starts to fill a recorder."""

    def on_advance(self, part: float) -> None:
        """Called many times a second with the completed fraction of a run, 0 to 1."""

    def on_cycle(self, recorder: "Recorder", state: Callable[[], State]) -> bool:
        """Called after each cycle; True ends the run.

        Parameters
        ----------
        state : callable
            Returns all that another process needs to continue the run.
        """
        return False

    def on_progress(self, progress: Progress) -> None:
        """Called many times a second with the progress of a campaign."""

    def on_compile(self) -> None:
        """Called while a run waits for the compiler."""

    def on_checkpoint(self, checkpoint: Any, is_stage: bool) -> None:
        """Called with the state of a campaign (``Checkpoint``), and after each stage."""

    def on_stage(self, stage: Any) -> None:
        """Called with a finished stage (``StageResult``), the wear update after it included."""

    def on_life(self, life: Any) -> None:
        """Called with the service life (``LifeResult``), before the stages through it run."""


@dataclass
class AdvanceObserver(Observer):
    """Reports the completed fraction of a run.

    Attributes
    ----------
    report : callable
        Called with the fraction, 0 to 1.
    """

    report: Callable[[float], None]

    def on_advance(self, part: float) -> None:
        """Pass the fraction on."""
        self.report(part)
