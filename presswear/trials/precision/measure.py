"""A task run by every method: errors from the first run, times from the repeats."""

import math
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from presswear.engines.base import Plan, Run, Start
from presswear.linkage.elements import Linkage
from presswear.tools.errors import InputError, RunFailed
from presswear.trials.costs.timing import Case, Progress, time_cases
from presswear.trials.hard.case import guarded
from presswear.trials.precision.points import Diagram, Effort, Method, Point

Errors = Mapping[str, float]
Values = Mapping[str, float]

FIRST_ROUND = 2.0
"""Time of the first runs, which compile and load, in rounds of repeats, roughly."""


@dataclass(frozen=True)
class Task:
    """What every method runs, and what its run is held against.

    Attributes
    ----------
    key, title, words : str
        Of the diagram; the words say what is run.
    linkage, start, plan :
        As engines take them; the plan's progress is not used.
    methods : tuple of Method
    quantities : mapping of str to str
        Unit by name of each error.
    reference : str
        What the errors are errors from.
    reference_errors : mapping of str to float
    assess : callable
        Errors and other values of a run that ended well; RunFailed where it lacks what
        errors are taken from.
    """

    key: str
    title: str
    words: str
    linkage: Linkage
    start: Start
    plan: Plan
    methods: tuple[Method, ...]
    quantities: Mapping[str, str]
    reference: str
    reference_errors: Errors
    assess: Callable[[Run], tuple[Errors, Values]]

    def case(self, method: Method) -> Case:
        """The method as a case for timing."""
        return Case(method.label, self.linkage, self.start, method.accuracy, self.plan)


@dataclass(frozen=True)
class _First:
    """What the first run of a method gave."""

    point: Point
    warm_up: float = math.nan
    evaluations: int | None = None


def first_run(task: Task, method: Method) -> _First:
    """Run a method once; whatever it does, it gives a point, without times."""
    # Guarded anew: patience counts from the plan's first progress.
    guard = guarded(task.plan.cycle, task.plan.cycles)
    plan = replace(task.plan, trackers=guard.trackers)
    began = clock.perf_counter()
    try:
        # A run that blows up overflows on its way to the failure that it ends in.
        with np.errstate(all="ignore"):
            run = method.accuracy.simulate(task.linkage, task.start, plan)
            spent = clock.perf_counter() - began
            check_finite(run)
            errors, values = (
                {name: float(value) for name, value in found.items()} for found in task.assess(run)
            )
        lost = [name for name in task.quantities if not math.isfinite(errors.get(name, math.nan))]
        if lost:
            raise RunFailed(f"no number for {lost[0]}")
    except (InputError, RunFailed, ArithmeticError) as error:
        return _First(Point(method, failure=str(error) or type(error).__name__))
    iterations = run.diagnostics.get("newton_iterations")
    if iterations is not None:
        values["Newton iterations"] = float(iterations)
    counted = run.diagnostics.get("evaluations")
    evaluations = None if counted is None else int(counted)
    return _First(Point(method, errors, values=values), spent, evaluations)


def check_finite(run: Run) -> None:
    """RunFailed where a run failed or ended in a state that is not finite."""
    if run.status == "failed":
        raise RunFailed(run.message)
    if not (np.all(np.isfinite(run.end.position)) and np.all(np.isfinite(run.end.velocity))):
        raise RunFailed(f"the state is no longer finite (t = {run.time:.6g} s)")


def measure(task: Task, repeats: int, progress: Progress) -> Diagram:
    """Run all methods of a task: once for their errors, then in turn for their times.

    What fails in the first run stays in as a failure and is not timed.
    """
    share = FIRST_ROUND / (FIRST_ROUND + repeats)
    firsts = []
    for i, method in enumerate(task.methods):
        progress(method.label, share * i / len(task.methods))
        firsts.append(first_run(task, method))
    cases = [task.case(first.point.method) for first in firsts if not first.point.failure]
    timings = iter(
        time_cases(cases, repeats, lambda name, part: progress(name, share + (1.0 - share) * part))
    )
    points = []
    for first in firsts:
        point = first.point
        if not point.failure:
            timing = next(timings)
            effort = Effort(
                timing.walls,
                first.warm_up,
                timing.simulated,
                timing.steps,
                timing.sent_back,
                first.evaluations,
            )
            point = replace(point, effort=effort)
        points.append(point)
    progress("done", 1.0)
    return Diagram(
        task.key,
        task.title,
        task.words,
        task.quantities,
        task.reference,
        task.reference_errors,
        tuple(points),
    )
