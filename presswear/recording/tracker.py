"""Trackers: objects that are told what happens while something runs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import State

if TYPE_CHECKING:
    from presswear.recording.film import Film
    from presswear.recording.recorder import Recorder


@dataclass(frozen=True)
class Progress:
    """How far a campaign has come.

    Attributes
    ----------
    stage : int
        Index of the stage at hand.
    part : float
        Part of that stage and of the wear after it that is done, 0 .. 1.
    whole : float
        Part of the whole campaign, 0 .. 1, counted in runs as far as they are foreseen.
    word : str
        Where it stands, in a few words, or nothing.
    linkage : Linkage
        What runs, worn surfaces included.
    film : Film or None
        Its last frames, of a run among several that is shown; None where no tracker wants some.
    """

    stage: int
    part: float
    whole: float
    word: str
    linkage: Linkage
    film: "Film | None" = None


class Tracker:
    """Told what happens; a tracker overrides what it wants to know.

    An engine tells of one run: ``begun``, ``advanced`` and ``cycle``.  A campaign hands these on
    from each of its runs, which it then keeps in this process, and tells ``progress``,
    ``checkpoint``, ``stage`` and ``remark`` besides.

    Attributes
    ----------
    frames : int
        Frames of the film that ``progress`` is to bring.
    """

    frames = 0

    @property
    def hears_runs(self) -> bool:
        """True where it overrides something that an engine tells."""
        told = ("begun", "advanced", "cycle")
        return any(getattr(type(self), name) is not getattr(Tracker, name) for name in told)

    def begun(self, recorder: "Recorder") -> None:
        """Hear that a run begins to fill a recorder."""

    def advanced(self, part: float) -> None:
        """Hear the part of a run's most cycles that is done, 0 .. 1, many times a second."""

    def cycle(self, recorder: "Recorder", state: Callable[[], State]) -> bool:
        """Hear that a cycle has ended; True ends the run as long enough.

        Parameters
        ----------
        state : callable
            Gives all that another process needs to go on with the run.
        """
        return False

    def progress(self, progress: Progress) -> None:
        """Hear how far a campaign has come, many times a second."""

    def compiling(self) -> None:
        """Hear that a run waits for the compiler, until it tells of progress."""

    def checkpoint(self, checkpoint: Any, is_stage: bool) -> None:
        """Hear where a campaign stands (``Checkpoint``): now and then, and after each stage."""

    def stage(self, stage: Any) -> None:
        """Hear of a finished stage (``StageResult``), the wear after it included."""

    def life(self, life: Any) -> None:
        """Hear of a life that is known (``LifeResult``), before the stages through it run."""

    def remark(self, line: str) -> None:
        """Hear a line for the person who waits, such as that a process was lost."""

    def variant(self, key: str, part: float, word: str) -> None:
        """Hear which part of a variant of a study is done, 0 .. 1, and where it stands."""


def tell_all(trackers: Iterable[Tracker], line: str) -> None:
    """Tell trackers a remark."""
    for tracker in trackers:
        tracker.remark(line)


@dataclass
class Telling(Tracker):
    """Hands on the part of a run that is done.

    Attributes
    ----------
    told : callable
        Called with the part, 0 .. 1.
    """

    told: Callable[[float], None]

    def advanced(self, part: float) -> None:
        """Hand the part on."""
        self.told(part)
