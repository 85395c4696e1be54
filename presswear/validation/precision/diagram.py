"""Work-precision diagrams: a task that every method runs, its errors and its cost.

Errors are those of the first run, times those of the repeats.
"""

import math
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from presswear.engines.base import Plan, Run, Start
from presswear.linkage.linkage import Linkage
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.precision.methods import Method, grouped
from presswear.validation.runs import Told, finished, guarded, order_of, part_of
from presswear.validation.timing import TimedRun, Timing, time_runs

Numbers = Mapping[str, float]

FIRST_ROUND = 2.0
"""Time of the first runs, which compile and load, in rounds of repeats, roughly."""


@dataclass(frozen=True)
class TaskPoint:
    """A method on one task.

    Attributes
    ----------
    errors : mapping
        By the names of the diagram's quantities; empty for a failure.
    values : mapping
        Other numbers, by their names with units: ``steps in the contact``,
        ``contact time (s)``; empty for a failure.
    warm_up : float or None
        Time of the first run, whose compiling and loading is no part of the others, s.
    timing : Timing or None
        None where nothing could be timed.
    failure : str
        Why it failed, or nothing.
    """

    method: Method
    errors: Numbers = field(default_factory=dict)
    values: Numbers = field(default_factory=dict)
    warm_up: float | None = None
    timing: Timing | None = None
    failure: str = ""


@dataclass(frozen=True)
class Quantity:
    """An error that a diagram shows.

    Attributes
    ----------
    known : float
        How far the reference is known itself; 0 for a closed form.
    """

    name: str
    unit: str
    known: float = 0.0

    @property
    def title(self) -> str:
        """Its name with its unit."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def error(self) -> str:
        """Name of a column of it."""
        return replace(self, name=f"{self.name} error").title


@dataclass(frozen=True)
class Diagram:
    """A work-precision diagram of one task.

    Attributes
    ----------
    key : str
        Its name in files.
    title, task : str
        The task in a few words, and at length.
    reference : str
        Origin of the values that errors are distances from.
    """

    DERIVED: ClassVar = ("orders",)

    key: str
    title: str
    task: str
    quantities: tuple[Quantity, ...]
    reference: str
    points: tuple[TaskPoint, ...] = ()

    @property
    def families(self) -> dict[str, list[TaskPoint]]:
        """Points of each curve, from coarse to fine, failures included."""
        return grouped(self.points)

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the other numbers."""
        return tuple(dict.fromkeys(name for point in self.points for name in point.values))

    def order(self, family: str, quantity: Quantity) -> float:
        """Observed order: slope of log error over log number of steps; nan for fewer than two.

        Points whose error is not ten times that of the reference are left out, as are those
        that failed.
        """
        usable = [
            (1.0 / point.timing.steps, point.errors[quantity.name])
            for point in self.families.get(family, [])
            if point.timing is not None
            and point.errors.get(quantity.name, 0.0) > 10.0 * quantity.known
        ]
        return order_of([step for step, _ in usable], [error for _, error in usable])

    @property
    def orders(self) -> dict[str, dict[str, float]]:
        """Observed orders by family and quantity."""
        return {
            family: {own.name: self.order(family, own) for own in self.quantities}
            for family in self.families
        }


@dataclass(frozen=True)
class Task:
    """A run that every method makes, and what it is held against.

    Attributes
    ----------
    diagram : Diagram
        Still without points.
    plan : Plan
        Its trackers are not told.
    assess : callable
        Errors and other values of a run that ended well; RunFailed where it lacks what
        errors are taken from.
    """

    diagram: Diagram
    linkage: Linkage
    start: Start
    plan: Plan
    methods: tuple[Method, ...]
    assess: Callable[[Run], tuple[Numbers, Numbers]]


def first_run(task: Task, method: Method) -> TaskPoint:
    """Run a method once; whatever it does, it gives a point, without a timing."""
    # Guarded anew: patience counts from the plan's first progress.
    guard = guarded(task.plan.cycle, task.plan.cycles)
    plan = replace(task.plan, trackers=guard.trackers)
    began = clock.perf_counter()
    try:
        # A run that blows up overflows on its way to the failure that it ends in.
        with np.errstate(all="ignore"):
            run = method.engine.simulate(task.linkage, task.start, plan)
            spent = clock.perf_counter() - began
            errors, values = (
                {name: float(value) for name, value in found.items()}
                for found in task.assess(check_finite(run))
            )
        for quantity in task.diagram.quantities:
            if not math.isfinite(errors.get(quantity.name, math.nan)):
                raise RunFailed(f"no number for {quantity.name}")
    except (InputError, RunFailed, ArithmeticError) as error:
        return TaskPoint(method, failure=str(error) or type(error).__name__)
    iterations = run.diagnostics.get("newton_iterations")
    if iterations is not None:
        values["Newton iterations"] = float(iterations)
    return TaskPoint(method, errors, values, spent)


def check_finite(run: Run) -> Run:
    """Give back a run; RunFailed where it failed or ended in a state that is not finite."""
    end = finished(run).end
    if not (np.all(np.isfinite(end.position)) and np.all(np.isfinite(end.velocity))):
        raise RunFailed(f"the state is no longer finite (t = {run.time:.6g} s)")
    return run


def measure(task: Task, repeats: int, told: Told) -> Diagram:
    """Run all methods of a task: once for their errors, then in turn for their times.

    A method that fails in the first run stays in as a failure and is not timed.
    """
    whole = FIRST_ROUND + repeats
    firsts = []
    for i, method in enumerate(task.methods):
        told(method.label, FIRST_ROUND / whole * i / len(task.methods))
        firsts.append(first_run(task, method))
    runs = [
        TimedRun(point.method.label, task.linkage, task.start, point.method.engine, task.plan)
        for point in firsts
        if not point.failure
    ]
    timings = iter(time_runs(runs, repeats, part_of(told, FIRST_ROUND, repeats, whole)))
    points = tuple(
        point if point.failure else replace(point, timing=next(timings)) for point in firsts
    )
    told("done", 1.0)
    return replace(task.diagram, points=points)
