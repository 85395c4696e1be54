"""How far a campaign is; how many cycles a wear takes shows only as it goes."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from presswear.linkage.linkage import Linkage
from presswear.recording.film import Film
from presswear.recording.observer import Observer, Progress
from presswear.scene.scene import Scene

_NUMBERS = ("index", "earlier", "done", "later", "worn_by", "_shown", "_shown_whole")
"""Everything of a forecast that changes."""


@dataclass
class Forecast:
    """Cycles of each start that a campaign has run and those that it is expected to run.

    Attributes
    ----------
    observers : sequence of Observer
        Told of the progress.
    index : int
        Of the stage at hand.
    earlier, done : float
        Cycles of earlier stages, and finished ones of this one and the wear after it.
    later : float
        Cycles of this stage and its wear behind those at hand.
    worn_by : float
        Cycles of a stage and its wear, as the last one took; 0 before that is known.
    """

    scene: Scene
    observers: Sequence[Observer]
    index: int = 0
    earlier: float = 0.0
    done: float = 0.0
    later: float = 0.0
    worn_by: float = 0.0
    _shown: float = 0.0
    _shown_whole: float = 0.0

    @property
    def frames(self) -> int:
        """Frames of the film that the observers want to hear of."""
        return max((observer.frames for observer in self.observers), default=0)

    @property
    def near(self) -> tuple[Observer, ...]:
        """The observers that want to hear of single runs."""
        return tuple(observer for observer in self.observers if observer.observes_runs)

    def numbers(self) -> dict[str, float | None]:
        """Give everything that changes, by name; None stands for infinity, as in JSON."""
        values = {name: getattr(self, name) for name in _NUMBERS}
        return {name: None if math.isinf(value) else value for name, value in values.items()}

    def restore(self, numbers: Mapping[str, float | None]) -> None:
        """Go on from ``numbers``; without any from the start."""
        for name, value in numbers.items():
            setattr(self, name, math.inf if value is None else value)

    def begin(self, index: int) -> None:
        """Begin another stage."""
        if index > self.index:
            self.worn_by = self.done
        self.earlier, self.done, self.index = self.earlier + self.done, 0.0, index
        self.later = self._shown = 0.0

    def expect(self, cycles: float) -> None:
        """Expect so many cycles of this stage and its wear behind those at hand."""
        self.later = cycles

    def compiling(self) -> None:
        """Tell the observers that a run waits for the compiler."""
        for observer in self.observers:
            observer.on_compile()

    def tell(
        self, run: float, needed: float, word: str, linkage: Linkage, film: Film | None
    ) -> None:
        """Tell the observers how far the campaign is; no part ever shrinks.

        Parameters
        ----------
        run, needed : float
            Cycles of each start of the ensemble at hand, so far and in all.
        """
        now, stage = self.done + run, self.done + needed + self.later
        self._shown = max(self._shown, min(now / stage, 1.0))
        rest = (self.scene.wear_updates - self.index) * max(self.worn_by, stage)
        whole = (self.earlier + now) / (self.earlier + stage + rest)
        self._shown_whole = max(self._shown_whole, min(whole, 1.0))
        progress = Progress(self.index, self._shown, self._shown_whole, word, linkage, film)
        for observer in self.observers:
            observer.on_progress(progress)
