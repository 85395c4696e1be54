"""Where the time of a run of the open tree goes: Exudyn, Python, compiled kernels.

Three looks at the same run.  Timed: a clock around the three functions that Exudyn
calls.  Recorded: every call of the two kernels with what it was given, so that they
and their parts are timed in compiled loops (``replay``).  Idle: Exudyn's own steps with
functions that do nothing and without any, which is what a call into Python takes.
Kernels in a loop find their data in the cache more often than between two calls of
Exudyn's; what they lose there counts as Python.  The end of a step is compiled as one
function, and takes longer than its parts one by one in a loop.
"""

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
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
from presswear.trials.costs.replay import (
    StageCalls,
    StepCalls,
    StepParts,
    replay_stages,
    replay_steps,
)
from presswear.trials.costs.timing import Case, Progress, Timing, time_cases

Array = NDArray[np.float64]
Kind = Literal["Exudyn", "Python", "kernel"]
KERNEL: Kind = "kernel"

LARGEST_PYTHON_SHARE = 0.3
"""Of a run, that no stage of Python may be above."""

_IDLE_STEP, _IDLE_STEPS, _IDLE_REPEATS = 1e-9, 4000, 7
_EMPTY_CALLS = 20_000


@dataclass(frozen=True)
class Stage:
    """A part of a run and its wall time, s."""

    name: str
    kind: Kind
    seconds: float


@dataclass(frozen=True)
class Profile:
    """Where the time of a run went.

    Attributes
    ----------
    timing : Timing
        Of the run without any clock in it.
    evaluations : int
        Calls of the force function.
    stages : tuple of Stage
        They add up to the median wall time.
    """

    timing: Timing
    evaluations: int
    stages: tuple[Stage, ...]

    def share(self, seconds: float) -> float:
        """Part of the run."""
        return seconds / self.timing.wall

    def share_of(self, *kinds: Kind) -> float:
        """Part of the run that stages of these kinds take."""
        return self.share(sum(stage.seconds for stage in self.stages if stage.kind in kinds))

    @property
    def largest_python(self) -> Stage:
        """The longest stage of Python."""
        return max((s for s in self.stages if s.kind == "Python"), key=lambda s: s.seconds)


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
    """What a clock finds around a function that does nothing, s."""
    spent = _Spent()
    empty = spent.around(lambda *arguments: None)
    for _ in range(_EMPTY_CALLS):
        empty(None, 0.0, 0, None, None)
    return 1e-9 * spent.nanoseconds / spent.calls


@contextmanager
def _replaced(**new: Any) -> Iterator[None]:
    """Other functions in the place of some that the engine of the tree calls.

    The engine itself has no hooks: they would be paid for in every run.
    """
    module = vars(engine)
    old = {name: module[name] for name in new}
    module.update(new)
    try:
        yield
    finally:
        module.update(old)


def inside_calls(case: Case) -> tuple[_Spent, _Spent, _Spent]:
    """Run with a clock around the functions for forces, before a step and after a step."""
    force, before, after = _Spent(), _Spent(), _Spent()

    class Limit(StepLimit):
        def __init__(self, solve: Solve):
            super().__init__(solve)
            self._timed = before.around(super().pre_step)

        def pre_step(self, system: Any, t: float) -> bool:
            return bool(self._timed(system, t))

    with _replaced(
        assemble=lambda tree, linkage, start, function: assemble(
            tree, linkage, start, force.around(function)
        ),
        StepLimit=Limit,
        post_step=lambda *arguments: after.around(post_step(*arguments)),
    ):
        case.run()
    return force, before, after


@dataclass
class _Record:
    """What the kernels of a run were given, call by call: rows of StageCalls and StepCalls."""

    stages: list[tuple[Any, ...]] = field(default_factory=list)
    steps: list[tuple[Any, ...]] = field(default_factory=list)

    def specialised(self, kernel: Any, *arguments: Any) -> Any:
        """As ``compiled.specialised``, with the calls noted."""
        entry = specialised(kernel, *arguments)
        if kernel is stage_forces:

            def noted_stage(system: TreeSystem, *rest: Any) -> None:
                *_, t, x, u, _ = rest
                pace = system.pace[0]
                times = t, float(pace["noted"]), int(pace["evaluations"])
                self.stages.append((*times, x.copy(), u.copy(), system.expected.copy()))
                entry(system, *rest)

            return noted_stage
        if kernel is accept_tree_step:

            def noted_step(system: TreeSystem, book: Book, t: float, *state: Array) -> float:
                times = t, float(system.pace[0]["noted"])
                copies = (each.copy() for each in (*state, system.stages, book.contacts))
                self.steps.append((*times, *copies))
                return float(entry(system, book, t, *state))

            return noted_step
        return entry

    @property
    def stage_calls(self) -> StageCalls:
        """All calls of the force function."""
        return StageCalls(*_columns(self.stages))

    @property
    def step_calls(self) -> StepCalls:
        """All ends of steps."""
        return StepCalls(*_columns(self.steps))


def record(case: Case) -> _Record:
    """Run and keep what the kernels were given."""
    kept = _Record()
    with _replaced(specialised=kept.specialised):
        case.run()
    return kept


def _columns(rows: list[tuple[Any, ...]]) -> list[Any]:
    """Recorded rows as one array for each of their parts."""
    return [np.array(column) for column in zip(*rows, strict=True)]


def _tree(case: Case) -> tuple[Tree, ExudynTree]:
    tree = tree_of(case.linkage)
    if isinstance(tree, str) or not isinstance(case.accuracy, ExudynTree):
        raise InputError(f"{case.name} is no run of the open tree")
    return tree, case.accuracy


def _timed_loop(case: Case, loop: Callable[[TreeSystem, Book], None], unaware: bool) -> float:
    """Wall time, s, of a compiled loop on a new system and book."""
    tree, accuracy = _tree(case)
    book = recorder_of(case.linkage, case.start, case.plan).book
    if unaware:
        book.packed.joints["wear_coefficient"] = 0.0
    system = engine.system_of(tree, case.linkage, accuracy.longest(case.plan.cycle))
    began = clock.perf_counter()
    loop(system, book)
    return clock.perf_counter() - began


def kernel_times(case: Case, kept: _Record, repeats: int) -> dict[str, float]:
    """Wall times of the kernels and their parts over a run, s: medians, loops in turn."""
    tree, _ = _tree(case)
    stages, steps = kept.stage_calls, kept.step_calls
    out = np.zeros(len(tree.links))

    def stage(forces: bool, contacts: bool) -> Callable[[TreeSystem, Book], None]:
        return lambda system, book: replay_stages(system, book, stages, out, forces, contacts)

    def step(count: int, whole: bool = False, sums: bool = True) -> Callable[..., None]:
        parts = StepParts(sums and count > 0, count > 1, count > 2, count > 3, count > 4, whole)
        return lambda system, book: replay_steps(system, book, steps, parts)

    loops: dict[str, Callable[[TreeSystem, Book], None]] = {
        "stage": stage(True, True),
        "placed": stage(False, False),
        "placed and contacts": stage(False, True),
        "nothing": step(0),
        "sums": step(1),
        "to bodies": step(2),
        "to contact": step(3),
        "to series": step(4),
        "to the next step": step(5),
        "whole": step(0, whole=True),
        # Without doses there is nothing to deposit.
        "to contact, no sums": step(3, sums=False),
        "to series, no sums": step(4, sums=False),
    }
    walls: dict[str, list[float]] = {name: [] for name in loops}
    for repeat in range(repeats + 1):
        for name, loop in loops.items():
            spent = _timed_loop(case, loop, name.endswith("no sums"))
            # The first round compiles.
            if repeat > 0:
                walls[name].append(spent)
    found = {name: median(spent) for name, spent in walls.items()}
    series = found["to series, no sums"] - found["to contact, no sums"]
    return {
        "forces": found["stage"],
        "contacts": found["placed and contacts"] - found["placed"],
        "steps": found["whole"] - found["nothing"],
        "doses and energies": found["sums"] - found["nothing"],
        "bodies and drives": found["to bodies"] - found["sums"],
        "contact state": found["to contact"] - found["to bodies"],
        "series and peaks": series,
        "wear maps": found["to series"] - found["to contact"] - series,
        "choice of the next step": found["to the next step"] - found["to series"],
        "the whole above its parts": found["whole"] - found["to the next step"],
    }


def idle_wall(case: Case, solver: Any, forces: bool, steps: bool) -> tuple[float, int]:
    """Wall time, s, of ``_IDLE_STEPS`` steps of Exudyn's with idle functions or without.

    Returns also how often the force function was called.
    """
    tree, _ = _tree(case)
    out = np.zeros(len(tree.links))
    calls = 0

    def count(*arguments: Any) -> Array:
        nonlocal calls
        calls += 1
        return out

    # Exudyn takes 0 for no function.
    function: Any = count if forces else 0
    model = assemble(tree, case.linkage, case.start, function)
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


def call_costs(case: Case) -> tuple[float, float]:
    """What Exudyn needs to call Python, s: a force, and the functions of one step.

    Differences of the least times: whatever disturbs them only adds.  Explicit Euler has
    the least work beside the calls of a step.
    """
    five, euler = exu.DynamicSolverType.DOPRI5, exu.DynamicSolverType.ExplicitEuler
    idle: list[tuple[float, ...]] = []
    calls = 1
    for _ in range(_IDLE_REPEATS):
        with_forces, calls = idle_wall(case, five, forces=True, steps=False)
        idle.append(
            (
                with_forces,
                idle_wall(case, five, forces=False, steps=False)[0],
                idle_wall(case, euler, forces=False, steps=True)[0],
                idle_wall(case, euler, forces=False, steps=False)[0],
            )
        )
    force, no_force, step, no_step = (min(column) for column in zip(*idle, strict=True))
    return (force - no_force) / calls, (step - no_step) / _IDLE_STEPS


def profile(case: Case, repeats: int, progress: Progress) -> Profile:
    """Find where the time of a run of the open tree goes."""
    progress(f"{case.name}: recorded", 0.0)
    case.warm_up()
    kept = record(case)
    overhead = clock_overhead()
    shares: list[float] = []
    inside: list[tuple[float, float]] = []
    plain: list[Timing] = []
    for repeat in range(repeats):
        progress(f"{case.name}: timed", 0.1 + 0.5 * repeat / repeats)
        plain += time_cases([case], 1, lambda name, part: None)
        force, before, after = inside_calls(case)
        ends = before.seconds(overhead) + after.seconds(overhead)
        inside.append((force.seconds(overhead), ends))
        shares.append(float(case.run().diagnostics["share_mass_matrix"]))
    progress(f"{case.name}: kernels", 0.6)
    kernels = kernel_times(case, kept, repeats)
    progress(f"{case.name}: calls", 0.9)
    call, step_call = call_costs(case)
    timing = replace(plain[0], walls=tuple(wall for each in plain for wall in each.walls))
    force_inside, step_inside = (median(column) for column in zip(*inside, strict=True))
    evaluations, attempts = len(kept.stages), timing.attempts
    stages: tuple[tuple[str, Kind, float], ...] = (
        ("calls of the force function", "Python", evaluations * call),
        ("inside it, up to the kernel", "Python", force_inside - kernels["forces"]),
        ("calls before and after a step", "Python", attempts * step_call),
        ("inside them, up to the kernel", "Python", step_inside - kernels["steps"]),
        ("forces: contacts", "kernel", kernels["contacts"]),
        ("forces: all else", "kernel", kernels["forces"] - kernels["contacts"]),
        *(
            (f"end of step: {name}", KERNEL, kernels[name])
            for name in (
                "doses and energies",
                "bodies and drives",
                "contact state",
                "series and peaks",
                "wear maps",
                "choice of the next step",
                "the whole above its parts",
            )
        ),
    )
    matrix = median(shares) * timing.wall
    rest = timing.wall - matrix - sum(seconds for _, _, seconds in stages)
    return Profile(
        timing,
        evaluations,
        (
            Stage("mass matrix and its factors", "Exudyn", matrix),
            Stage("tree, integrator, steps", "Exudyn", rest),
            *(Stage(*stage) for stage in stages),
        ),
    )
