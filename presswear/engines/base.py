"""What every engine takes and gives back."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.compiled import Records
from presswear.observe import Account
from presswear.touch import STEPS

Array = NDArray[np.float64]

Status = Literal["completed", "enough", "failed"]


@dataclass(frozen=True)
class Start:
    """Initial state: coordinates and rates of all bodies, each (3 bodies,), at t = 0."""

    position: Array
    velocity: Array


@dataclass(frozen=True)
class Accuracy:
    """How finely an implicit fixed-order run is stepped.

    Attributes
    ----------
    steps_per_contact : int
        Steps in one impact.
    steps_sustained : int
        Steps in half a period of a pin that rests on its bearing; its steps grow up
        to this as its error allows.
    free_step : float
        Longest step in free flight, s.
    newton : float
        Relative and absolute tolerance of Newton's method.
    least_step : float
        Shortest step, s.
    """

    steps_per_contact: int
    steps_sustained: int
    free_step: float
    newton: float = 1e-6
    least_step: float = 1e-9

    def packed(self) -> Records:
        """As the kernels see it: one record of STEPS."""
        steps = np.zeros(1, STEPS)
        steps["free"] = self.free_step
        steps["per_contact"] = self.steps_per_contact
        steps["sustained"] = self.steps_sustained
        steps["least"] = self.least_step
        return steps


@dataclass(frozen=True)
class Plan:
    """How long to run and what to keep.

    Attributes
    ----------
    cycle : float
        Duration of one cycle, s.
    cycles : int
        Most cycles to run.
    recorded_cycles : int
        Cycles at the start whose series and episodes are kept.
    enough : callable
        Asked after each cycle; True ends the run.
    progress : callable
        Told the part of the most cycles that is done, 0 .. 1, a few times a second.
    """

    cycle: float
    cycles: int
    recorded_cycles: int = 5
    enough: Callable[[Account], bool] = lambda account: False
    progress: Callable[[float], None] = lambda part: None


@dataclass(frozen=True)
class Run:
    """What one engine run gave.

    Attributes
    ----------
    status : {"completed", "enough", "failed"}
        ``enough``: ended by the plan's question before the most cycles.
    message : str
        What was modelled and how, or what went wrong.
    account : Account
        Everything observed.
    end : Start
        State at the end.
    time : float
        Simulated time, s.
    diagnostics : dict
        Steps, Newton iterations, wall time by stage and the like.
    """

    status: Status
    message: str
    account: Account
    end: Start
    time: float
    diagnostics: dict[str, float | int | str] = field(default_factory=dict)
