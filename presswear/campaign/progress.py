"""How far a campaign is; how many runs a wear takes shows only as it goes."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from presswear.campaign.amplification import Amplification
from presswear.linkage.elements import Linkage
from presswear.record.recorder import Recorder
from presswear.record.tracker import Progress, Tracker
from presswear.scene.scene import Scene, stage_name

_NUMBERS = ("index", "earlier", "done", "expected", "worn_by", "_shown", "_shown_whole")
"""Everything of a forecast that changes."""


@dataclass
class Forecast:
    """Runs that a campaign has made and those that it is expected to make.

    Attributes
    ----------
    trackers : iterable of Tracker
        Told of the progress.
    index : int
        Of the stage at hand.
    earlier, done : int
        Finished runs of earlier stages, and of this one.
    expected : float
        Runs of this stage and the wear after it; infinite before anything is known.
    worn_by : float
        Runs that the last wear took, or that the present one is expected to take.
    """

    scene: Scene
    trackers: Iterable[Tracker]
    index: int = 0
    earlier: int = 0
    done: int = 0
    expected: float = 1.0
    worn_by: float = field(init=False)
    _shown: float = 0.0
    _shown_whole: float = 0.0

    def __post_init__(self) -> None:
        self.worn_by = 1.0 if math.isinf(Amplification.of(self.scene).limit) else math.inf

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
        self.earlier, self.done, self.index = self.earlier + self.done, 0, index
        self.expected = self.worn_by if index < self.scene.wears else 1.0
        self._shown = 0.0

    def expect(self, steps: int) -> None:
        """Expect the present wear to take so many more steps, the present run's included."""
        if self.index < self.scene.wears:
            self.expected = self.worn_by = float(self.done + steps)

    def tell(self, part: float, word: str, linkage: Linkage, recorder: Recorder) -> None:
        """Tell the trackers of the part of the present run that is done; no part ever shrinks."""
        wears = self.scene.wears
        self._shown = max(self._shown, min((self.done + part) / self.expected, 1.0))
        later = 0.0
        if self.index < wears:
            later = 1.0 + (wears - self.index - 1) * self.worn_by
        whole = (self.earlier + self.done + part) / (self.earlier + self.expected + later)
        self._shown_whole = max(self._shown_whole, min(whole, 1.0))
        if self.done > 0 or 1.0 < self.expected < math.inf:
            step = (
                f"step {self.done + 1} of about {self.expected:.0f} of the "
                f"{stage_name(self.index + 1)}"
            )
            word = f"{step}, {word}" if word else step
        now = Progress(self.index, self._shown, self._shown_whole, word, linkage, recorder)
        for tracker in self.trackers:
            tracker.progress(now)
