"""Who is told how far a campaign is."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from presswear.campaign.amplification import Amplification
from presswear.scene.scene import Scene, stage_name


@dataclass(frozen=True)
class Watcher:
    """Who is told what happens.

    Attributes
    ----------
    progress : callable
        Stage index, part of the stage and of the wear after it done 0 .. 1, a word on where
        it stands.
    stage : callable
        Each finished stage, the wear after it included.
    overall : callable
        Part of the whole campaign done 0 .. 1, counted in runs as far as they are foreseen.
    live : callable
        Stage index, the linkage that runs and what its run has observed so far; called many
        times a second.
    keep : callable
        After each cycle where the campaign stands (``Standing``), and whether it is the end
        of a stage.
    """

    progress: Callable[[int, float, str], None] = lambda stage, part, word: None
    stage: Callable[[Any], None] = lambda stage: None
    overall: Callable[[float], None] = lambda part: None
    live: Callable[[int, Any, Any], None] = lambda stage, linkage, recorder: None
    keep: Callable[[Any, bool], None] = lambda standing, is_stage: None


_NUMBERS = ("index", "earlier", "done", "expected", "worn_by", "_shown", "_shown_overall")
"""Of a pace: everything that changes."""


@dataclass
class Pace:
    """How far a campaign is; how many runs a wear takes shows only as it goes.

    Attributes
    ----------
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
    watcher: Watcher
    index: int = 0
    earlier: int = 0
    done: int = 0
    expected: float = 1.0
    worn_by: float = 1.0
    _shown: float = 0.0
    _shown_overall: float = 0.0

    def __post_init__(self) -> None:
        if math.isfinite(Amplification.of(self.scene).limit):
            self.worn_by = math.inf

    def numbers(self) -> dict[str, float]:
        """Everything that changes, by name."""
        return {name: getattr(self, name) for name in _NUMBERS}

    def restore(self, numbers: Mapping[str, float]) -> None:
        """Go on from ``numbers``; without any from the start."""
        for name, value in numbers.items():
            setattr(self, name, value)

    def begin(self, index: int) -> None:
        """Another stage begins."""
        self.earlier, self.done, self.index = self.earlier + self.done, 0, index
        self.expected = self.worn_by if index < self.scene.wears else 1.0
        self._shown = 0.0

    def expect(self, steps: int) -> None:
        """The present wear will take so many more steps, that of the present run included."""
        if self.index < self.scene.wears:
            self.expected = self.worn_by = float(self.done + steps)

    def tell(self, part: float, word: str) -> None:
        """Tell the watcher of the part of the present run that is done; no part ever shrinks."""
        wears = self.scene.wears
        self._shown = max(self._shown, min((self.done + part) / self.expected, 1.0))
        later = 0.0
        if self.index < wears:
            later = 1.0 + (wears - self.index - 1) * self.worn_by
        overall = (self.earlier + self.done + part) / (self.earlier + self.expected + later)
        self._shown_overall = max(self._shown_overall, min(overall, 1.0))
        if self.done > 0 or 1.0 < self.expected < math.inf:
            step = (
                f"step {self.done + 1} of about {self.expected:.0f} of the "
                f"{stage_name(self.index + 1)}"
            )
            word = f"{step}, {word}" if word else step
        self.watcher.progress(self.index, self._shown, word)
        self.watcher.overall(self._shown_overall)
