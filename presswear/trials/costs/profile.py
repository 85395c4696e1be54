"""The time of a run of the open tree by its parts: Exudyn, Python, compiled kernels.

Three looks at the same run.  Timed: a clock around the three functions that Exudyn
calls.  Recorded: every call of the two kernels with its arguments, so that they
and their parts are timed in compiled loops (``replay``).  Idle: Exudyn's own steps with
functions that do nothing and without any, whose difference a call into Python takes.
Kernels in a loop find their data in the cache more often than between two calls of
Exudyn's; what they lose there counts as Python.  The end of a step is compiled as one
function, and takes longer than its parts one by one in a loop.
"""

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from statistics import median
from typing import Any, Literal

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import recorder_of
from presswear.engines.exudyn import Solve, StepLimit, post_step, quiet, set_span, settings_of
from presswear.engines.exudyn_tree import engine
from presswear.engines.exudyn_tree.kernels import TreeSystem, accept_tree_step, stage_forces
from presswear.engines.exudyn_tree.model import assemble
from presswear.engines.settings import ExudynTree
from presswear.physics.tree import Tree, tree_of
from presswear.record.observe import Book
from presswear.tools.compiled import specialised
from presswear.tools.errors import InputError
from presswear.trials.costs.features import warm_up
from presswear.trials.costs.replay import (
    STAGE_PARTS,
    STEP_PARTS,
    StageCalls,
    StepCalls,
    replay_stages,
    replay_steps,
)
from presswear.trials.runs import Told
from presswear.trials.timing import TimedRun, Timing, time_runs

Array = NDArray[np.float64]
Kind = Literal["Exudyn", "Python", "kernel"]

LARGEST_PYTHON_SHARE = 0.3
"""Share of a run that no part of Python may be above."""

_IDLE_STEP, _IDLE_STEPS, _IDLE_REPEATS = 1e-9, 4000, 7
_EMPTY_CALLS = 20_000


@dataclass(frozen=True)
class PartOfRun:
    """A part of a run, its wall time, s, and its share of the run."""

    name: str
    kind: Kind
    seconds: float
    share: float


@dataclass(frozen=True)
class Profile:
    """The time of a run by its parts.

    Attributes
    ----------
    timing : Timing
        Timing of the run without any clock in it.
    calls : int
        Calls of the force function.
    parts : tuple of PartOfRun
        They add up to the median wall time.
    """

    timing: Timing
    calls: int
    parts: tuple[PartOfRun, ...]

    def share_of(self, *kinds: Kind) -> float:
        """Share of the run that parts of these kinds take."""
        return sum(part.share for part in self.parts if part.kind in kinds)

    @property
    def largest_python(self) -> PartOfRun:
        """The longest part of Python."""
        return max((p for p in self.parts if p.kind == "Python"), key=lambda p: p.seconds)


@dataclass
class _Spent:
    """Calls of a function and the time inside them, ns."""

    calls: int = 0
    nanoseconds: int = 0

    def around(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function with a clock around it."""
        now = clock.perf_counter_ns

        def timed(*arguments: Any) -> Any:
            began = now()
            result = function(*arguments)
            self.nanoseconds += now() - began
            self.calls += 1
            return result

        return timed

    def seconds(self, overhead: float) -> float:
        """Time inside, s, less that of the clock, s a call."""
        return 1e-9 * self.nanoseconds - overhead * self.calls


def clock_overhead() -> float:
    """Time that a clock finds around a function that does nothing, s."""
    spent = _Spent()
    empty = spent.around(lambda *arguments: None)
    for _ in range(_EMPTY_CALLS):
        empty(None, 0.0, 0, None, None)
    return 1e-9 * spent.nanoseconds / spent.calls


@contextmanager
def _replaced(**new: Any) -> Iterator[None]:
    """Put other functions in the place of some that the engine of the tree calls.

    The engine itself has no hooks: they would be paid for in every run.
    """
    module = vars(engine)
    old = {name: module[name] for name in new}
    module.update(new)
    try:
        yield
    finally:
        module.update(old)


def inside_calls(timed: TimedRun, overhead: float) -> tuple[float, float]:
    """Time inside the function for forces, and inside those before and after a step, s."""
    force, ends = _Spent(), _Spent()

    def limit(solve: Solve) -> StepLimit:
        found = StepLimit(solve)
        vars(found).update(pre_step=ends.around(found.pre_step))
        return found

    with _replaced(
        assemble=lambda tree, linkage, start, function, rates: assemble(
            tree, linkage, start, force.around(function), rates
        ),
        StepLimit=limit,
        post_step=lambda *arguments: ends.around(post_step(*arguments)),
    ):
        timed.run()
    return force.seconds(overhead), ends.seconds(overhead)


def record(timed: TimedRun) -> tuple[StageCalls, StepCalls]:
    """Run and keep the arguments of every call of the kernels."""
    stages: list[tuple[Any, ...]] = []
    steps: list[tuple[Any, ...]] = []

    def noting(kernel: Any, *arguments: Any) -> Any:
        entry = specialised(kernel, *arguments)

        def noted_stage(system: TreeSystem, *rest: Any) -> None:
            *_, t, x, u, _ = rest
            pace = system.pace[0]
            times = t, float(pace["noted"]), int(pace["evaluations"])
            stages.append((*times, x.copy(), u.copy(), system.expected.copy()))
            entry(system, *rest)

        def noted_step(system: TreeSystem, book: Book, t: float, *state: Array) -> float:
            times = t, float(system.pace[0]["noted"])
            copies = (each.copy() for each in (*state, system.stages, book.contacts))
            steps.append((*times, *copies))
            return float(entry(system, book, t, *state))

        if kernel is stage_forces:
            return noted_stage
        return noted_step if kernel is accept_tree_step else entry

    with _replaced(specialised=noting):
        timed.run()
    return StageCalls(*_columns(stages)), StepCalls(*_columns(steps))


def _columns(rows: list[tuple[Any, ...]]) -> list[Any]:
    """Recorded rows as one array for each of their parts."""
    return [np.array(column) for column in zip(*rows, strict=True)]


def _tree(timed: TimedRun) -> tuple[Tree, ExudynTree]:
    tree = tree_of(timed.linkage)
    if isinstance(tree, str) or not isinstance(timed.engine, ExudynTree):
        raise InputError(f"{timed.name} is no run of the open tree")
    return tree, timed.engine


def kernel_times(
    timed: TimedRun, stages: StageCalls, steps: StepCalls, repeats: int
) -> tuple[list[float], dict[str, float]]:
    """Wall times of the kernels over a run, s: medians of loops that run in turn.

    Returns
    -------
    list of float
        Time of each of ``STAGE_PARTS`` with those before it.
    dict of str to float
        Time of each part of the end of a step alone; the last is that by which the whole is
        above its parts.
    """
    tree, settings = _tree(timed)
    out = np.zeros(tree.size)
    longest = settings.longest(timed.plan.cycle)

    def wall(replay: Any, *arguments: Any) -> float:
        book = recorder_of(timed.linkage, timed.start, timed.plan).book
        system = engine.system_of(tree, timed.linkage, timed.start, longest)
        began = clock.perf_counter()
        replay(system, book, *arguments)
        return clock.perf_counter() - began

    loops: list[tuple[Any, ...]] = [
        *((replay_stages, stages, out, part) for part in range(len(STAGE_PARTS))),
        *((replay_steps, steps, part, True) for part in range(len(STEP_PARTS))),
        # Without doses there is nothing to deposit.
        *((replay_steps, steps, part, False) for part in (3, 4)),
    ]
    # The first round compiles.
    walls = [[wall(*loop) for loop in loops] for _ in range(repeats + 1)][1:]
    found = [median(column) for column in zip(*walls, strict=True)]
    count = len(STAGE_PARTS)
    whole, contact, series = found[count:-2], found[-2], found[-1]
    parts = dict(zip(STEP_PARTS[1:], np.diff(whole).tolist(), strict=True))
    observed = parts.pop("series, peaks and maps")
    after = {name: parts.pop(name) for name in ("choice of the next step", "whole")}
    return found[:count], {
        **parts,
        "series and peaks": series - contact,
        "wear maps": observed - (series - contact),
        "choice of the next step": after["choice of the next step"],
        "the whole above its parts": after["whole"],
    }


def idle_wall(timed: TimedRun, solver: Any, forces: bool, steps: bool) -> tuple[float, int]:
    """Wall time, s, of ``_IDLE_STEPS`` steps of Exudyn's with idle functions or without.

    Returns also how often the force function was called.
    """
    tree, _ = _tree(timed)
    out = np.zeros(tree.size)
    calls = 0

    def count(*arguments: Any) -> Array:
        nonlocal calls
        calls += 1
        return out

    # Exudyn takes 0 for no function.
    function: Any = count if forces else 0
    model = assemble(tree, timed.linkage, timed.start, function)
    if steps:
        model.system.SetPreStepUserFunction(lambda system, t: True)
        model.system.SetPostStepUserFunction(lambda system, t: True)
    settings = settings_of(_IDLE_STEP, 1e-3 * _IDLE_STEP)
    set_span(settings, 0.0, _IDLE_STEP, _IDLE_STEPS)
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    settings.timeIntegration.explicit.computeMassMatrixInversePerBody = False
    began = clock.perf_counter()
    with quiet():
        model.system.SolveDynamic(settings, solverType=solver)
    spent = clock.perf_counter() - began
    model.container.Reset()
    return spent, calls


def call_costs(timed: TimedRun) -> tuple[float, float]:
    """Time that Exudyn needs to call Python, s: for a force, and for the functions of a step.

    Differences of the least times: whatever disturbs them only adds.  Explicit Euler has
    the least work beside the calls of a step.
    """
    five, euler = exu.DynamicSolverType.DOPRI5, exu.DynamicSolverType.ExplicitEuler
    kinds = ((five, True, False), (five, False, False), (euler, False, True), (euler, False, False))
    idle = [[idle_wall(timed, *kind) for kind in kinds] for _ in range(_IDLE_REPEATS)]
    calls = idle[0][0][1]
    force, no_force, step, no_step = (
        min(wall for wall, _ in column) for column in zip(*idle, strict=True)
    )
    return (force - no_force) / calls, (step - no_step) / _IDLE_STEPS


def profile(timed: TimedRun, repeats: int, told: Told) -> Profile:
    """Find where the time of a run of the open tree goes."""
    told(f"{timed.name}: recorded", 0.0)
    warm_up(timed)
    stages, steps = record(timed)
    overhead = clock_overhead()
    shares: list[float] = []
    inside: list[tuple[float, float]] = []
    plain: list[Timing] = []
    for repeat in range(repeats):
        told(f"{timed.name}: timed", 0.1 + 0.5 * repeat / repeats)
        plain += time_runs([timed], 1, lambda name, part: None)
        inside.append(inside_calls(timed, overhead))
        shares.append(float(timed.run().diagnostics["share_mass_matrix"]))
    told(f"{timed.name}: kernels", 0.6)
    (placed, with_contacts, forces), ends = kernel_times(timed, stages, steps, repeats)
    told(f"{timed.name}: calls", 0.9)
    call, step_call = call_costs(timed)
    timing = replace(plain[0], walls=tuple(wall for each in plain for wall in each.walls))
    force_inside, step_inside = (median(column) for column in zip(*inside, strict=True))
    calls, contacts = len(stages.time), with_contacts - placed
    matrix = median(shares) * timing.wall
    known: list[tuple[str, Kind, float]] = [
        ("calls of the force function", "Python", calls * call),
        ("inside it, up to the kernel", "Python", force_inside - forces),
        ("calls before and after a step", "Python", timing.attempts * step_call),
        ("inside them, up to the kernel", "Python", step_inside - sum(ends.values())),
        ("forces: contacts", "kernel", contacts),
        ("forces: all else", "kernel", forces - contacts),
        *((f"end of step: {name}", "kernel", seconds) for name, seconds in ends.items()),
    ]
    rest = timing.wall - matrix - sum(seconds for _, _, seconds in known)
    exudyn: list[tuple[str, Kind, float]] = [
        ("mass matrix and its factors", "Exudyn", matrix),
        ("tree, integrator, steps", "Exudyn", rest),
    ]
    return Profile(
        timing,
        calls,
        tuple(PartOfRun(*part, part[2] / timing.wall) for part in (*exudyn, *known)),
    )
