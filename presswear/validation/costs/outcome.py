"""What a peer or an engine makes of the press from its start, and the processor time it took."""

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.linkage.linkage import Linkage
from presswear.validation.costs.by_hand import OPEN

Array = NDArray[np.float64]
Touches = Sequence[tuple[int, float]]
"""Joint and time, s, of touches, in the order of time."""
Found = tuple[Array, Touches, int, int]
"""State at the end, touches, steps tried and evaluations."""
MOST_TOUCHES = 64


@dataclass(frozen=True)
class Outcome:
    """A run.

    Attributes
    ----------
    end : ndarray, shape (8,)
        Coordinates of the press by hand and their rates at the end.
    touches : sequence of (int, float)
        The first touches: joint and time, s.
    steps, evaluations : int
        Steps tried, and evaluations of the accelerations.
    seconds : float
        Processor time of the integration alone, s.
    """

    end: Array
    touches: Touches
    steps: int
    evaluations: int
    seconds: float


class Landings:
    """Arrays of ``by_hand.land`` for a run that begins with open pins."""

    def __init__(self) -> None:
        self.onset, self.gaps = np.full(2, OPEN), np.zeros((2, 2, 2))
        self.touches, self.noted = np.zeros((MOST_TOUCHES, 2)), np.zeros(1, np.int64)

    @property
    def told(self) -> Touches:
        """The first touches."""
        return [(int(k), float(t)) for k, t in self.touches[: int(self.noted[0])]]


def measured(run: Callable[[], Found]) -> Outcome:
    """Run, and note the processor time."""
    began = clock.process_time()
    found = run()
    return Outcome(*found, clock.process_time() - began)


def state_of(linkage: Linkage, start: Start) -> Array:
    """Coordinates of the press by hand and their rates in a state of all bodies."""
    places = [
        3 * linkage.index(name) + part
        for name, part in (("plate 4", 2), ("rod 3", 2), ("slider 6", 1), ("rod 5", 2))
    ]
    return np.concatenate([start.position[places], start.velocity[places]])
