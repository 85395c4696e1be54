"""Observers that tests of engines share."""

from collections.abc import Callable
from dataclasses import dataclass, field

from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.tools.arrays import State


@dataclass
class EndsAfter(Observer):
    """Ends a run after so many cycles, and notes when it was asked."""

    cycles: int
    asked: list[int] = field(default_factory=list)

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        self.asked.append(len(recorder.cycles))
        return len(recorder.cycles) == self.cycles


@dataclass
class Keeps(Observer):
    """Hands on the state after each cycle."""

    keep: Callable[[State], None]

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        self.keep(state())
        return False
