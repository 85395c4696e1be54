"""Work-precision diagrams as data: methods, their errors, their cost, their failures."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from presswear.engines.settings import Engine


@dataclass(frozen=True)
class Method:
    """An engine and an integrator at one step or tolerance.

    Attributes
    ----------
    engine : str
        ``exudyn-joints``, ``exudyn-tree`` or ``dae``.
    integrator : str
        As people call it: trapezoidal rule, DOPRI5, DOP853, RK4.
    knob : str
        What is varied, with its unit: ``tolerance``, ``step (s)``, ``steps in an impact``.
    value : float
        Of it.
    accuracy : Engine
        What the engine takes.
    is_paper : bool
        Whether it is the paper's own setting: RK4 at 1e-4 s.
    is_default : bool
        Whether scenes take it by themselves.
    """

    engine: str
    integrator: str
    knob: str
    value: float
    accuracy: Engine
    is_paper: bool = False
    is_default: bool = False

    @property
    def family(self) -> str:
        """What its curve in a diagram is called."""
        return f"{self.engine}, {self.integrator}"

    @property
    def label(self) -> str:
        """The method in a few words."""
        return f"{self.family}, {self.knob.partition(' (')[0]} {self.value:g}"


@dataclass(frozen=True)
class Effort:
    """What a run cost; every repeat takes the same steps.

    Attributes
    ----------
    walls : tuple of float
        Wall times of the solve of each repeat, s.
    warm_up : float
        Of the first run, whose compiling and loading is no part of the others, s.
    simulated : float
        s.
    steps, sent_back : int
        Accepted steps, and steps that were repeated with a shorter length.
    evaluations : int or None
        Evaluations of the accelerations, where the engine counts them.
    """

    walls: tuple[float, ...]
    warm_up: float
    simulated: float
    steps: int
    sent_back: int
    evaluations: int | None = None

    @property
    def wall(self) -> float:
        """Median wall time, s."""
        return median(self.walls)

    @property
    def spread(self) -> tuple[float, float]:
        """Least and greatest wall time, s."""
        return min(self.walls), max(self.walls)

    @property
    def per_step(self) -> float:
        """Wall time of an attempted step, s."""
        return self.wall / max(self.steps + self.sent_back, 1)


@dataclass(frozen=True)
class Point:
    """A method on one task.

    Attributes
    ----------
    errors : mapping of str to float
        By the names of the diagram's quantities; empty for a failure.
    effort : Effort or None
        None where nothing could be timed.
    failure : str
        Why it failed, or nothing.
    values : mapping of str to float
        What else was measured, by its name with its unit: ``steps in the contact``,
        ``contact time (s)``; empty for a failure.
    """

    method: Method
    errors: Mapping[str, float] = field(default_factory=dict)
    effort: Effort | None = None
    failure: str = ""
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Diagram:
    """A work-precision diagram of one task.

    Attributes
    ----------
    key : str
        Of its file.
    title, task : str
        What was run.
    quantities : mapping of str to str
        Unit by name of each error.
    reference : str
        What the errors are errors from.
    reference_errors : mapping of str to float
        How far the reference is known itself; 0 for a closed form.
    points : tuple of Point
    """

    key: str
    title: str
    task: str
    quantities: Mapping[str, str]
    reference: str
    reference_errors: Mapping[str, float]
    points: tuple[Point, ...]

    def families(self) -> dict[str, list[Point]]:
        """Points of each curve, from coarse to fine, failures included."""
        found: dict[str, list[Point]] = {}
        for point in self.points:
            found.setdefault(point.method.family, []).append(point)
        return found

    def order(self, family: str, quantity: str) -> float:
        """Observed order: slope of log error over log number of steps; nan for fewer than two.

        Points whose error is not ten times that of the reference are left out, as are those
        that failed.
        """
        floor = 10.0 * self.reference_errors.get(quantity, 0.0)
        usable = [
            (point.effort.steps, point.errors[quantity])
            for point in self.families().get(family, [])
            if point.effort is not None and point.errors.get(quantity, 0.0) > floor
        ]
        return slope(usable)


def slope(pairs: Sequence[tuple[float, float]]) -> float:
    """Order from pairs of steps and errors, by least squares; nan for fewer than two."""
    if len({steps for steps, _ in pairs}) < 2:
        return math.nan
    steps, errors = np.log(np.array(pairs)).T
    return -float(np.polyfit(steps, errors, 1)[0])
