"""What every Exudyn engine shares: the callback after a step, the solve, how it ends."""

import math
import time as clock
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan
from presswear.physics.energy import MADE_REMEDY, SETTLED, made_energy
from presswear.record.recorder import Account
from presswear.record.soundness import Finding
from presswear.tools.snapshot import Snapshot, numbers, set_numbers

END_TOLERANCE = 1e-10
"""Exudyn ends a run this close to its end time, s; a cycle is closed the same way."""

_PROGRESS_STEPS = 512

STEP_SAFETY = 0.9
"""Exudyn's own factor behind the step that an error of DOPRI5 allows."""

Accept = Callable[[float], float]
"""Called with the time of an accepted step; gives the next step, s, or NaN for a broken state."""

Write = Callable[[Any, float], None]
"""Hands the next step, s, to the running solver, whose ``it`` is given."""


@dataclass
class Watch:
    """Where a run stands, and how the solve of the present cycle ended.

    Attributes
    ----------
    time : float
        Of the last accepted step, s.
    end : float
        Of the present cycle, s.
    sums : dict
        Over all cycles so far: accepted steps (``steps``), and what its engine names.
    following, proposed : float
        Next step as the contacts allow it, and as the solver itself proposes it, s.
    reached : bool
        Whether the cycle ran to its end.
    reason : str
        Why it is to be ended, or nothing.
    """

    account: Account
    plan: Plan
    sums: dict[str, float]
    time: float = 0.0
    end: float = 0.0
    following: float = 0.0
    proposed: float = 0.0
    reached: bool = False
    is_broken: bool = False
    reason: str = ""
    error: BaseException | None = None
    iteration: Any = None

    def begin(self, end: float) -> None:
        """Another cycle begins; Exudyn makes a new solver for it."""
        self.end, self.reached, self.iteration = end, False, None

    def set_span(self, settings: Any, longest: float) -> None:
        """Set the time of a solve that reaches the end of the cycle, in steps up to one, s.

        Exudyn does not say which step it would take behind its own end: that lies further off,
        and PostStep ends the solve.
        """
        steps = math.ceil((self.end - self.time) / longest) + 2
        set_span(settings, self.time, longest, steps)

    def add(self, more: Mapping[str, float]) -> None:
        """Add counts and times of a solve."""
        for name, value in more.items():
            self.sums[name] += value

    def is_sound(self) -> bool:
        """Whether the contacts have made no energy; False ends the run."""
        ledger = self.account.book.ledger
        if self.time > SETTLED * self.plan.cycle:
            self.reason = made_energy(float(ledger[2]), float(ledger[1]))
        return not self.reason

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """What the next cycle begins with."""
        return {
            "steps": np.array([self.time, self.following, self.proposed]),
            "sums": numbers(self.sums),
        }

    def restore(self, stored: Snapshot) -> None:
        """Go on from a snapshot; the sums must have the same names."""
        self.time, self.following, self.proposed = (float(x) for x in stored["steps"])
        set_numbers(self.sums, stored["sums"])


def write_step(iteration: Any, step: float) -> None:
    """The next step of a solver without error control."""
    iteration.currentStepSize = step


class StuckError(RuntimeError):
    """Raised inside Exudyn where it repeats a step for ever."""


def proposed_step(iteration: Any) -> float:
    """Step, s, that error control would take next: Exudyn itself tells only behind PostStep."""
    error = iteration.automaticStepSizeError
    if not error > 0.0:
        return float(iteration.maxStepSize)
    proposed = STEP_SAFETY * iteration.currentStepSize * error ** (-1.0 / 5.0)
    return float(min(proposed, iteration.maxStepSize))


class StepLimit:
    """Limits the next step of a solver with error control.

    Such a solver has chosen its next step before it calls PostStep, so the limit is
    applied in PreStep, to the step and to the time it will end at.  A step that is
    repeated because of its error is Exudyn's own to shorten.
    """

    def __init__(self, watch: Watch):
        self._watch = watch
        self._iteration: Any = None
        self._limit = 0.0

    def write(self, iteration: Any, step: float) -> None:
        """Note the limit, s, for the step to come."""
        self._iteration = iteration
        self._limit = step

    def pre_step(self, system: Any, t: float) -> bool:
        """The function for Exudyn's PreStep."""
        if self._limit > 0.0:
            iteration = self._iteration
            step = min(self._limit, iteration.currentStepSize)
            iteration.currentStepSize = step
            iteration.currentTime = self._watch.time + step
            self._limit = 0.0
        return True


def post_step(watch: Watch, accept: Accept, write: Write = write_step) -> Callable[..., bool]:
    """The function for Exudyn's PostStep: accounts for a step and hands on the next."""
    duration = watch.plan.cycle * watch.plan.cycles
    account = watch.account

    def after(system: Any, t: float) -> bool:
        try:
            iteration = watch.iteration
            if iteration is None:
                iteration = watch.iteration = system.sys["dynamicSolver"].it
                if len(account.cycles):
                    # Exudyn shows the state that a cycle starts from; it is accounted for.
                    write(iteration, min(watch.following, watch.end - t))
                    return True
                watch.sums["steps"] -= 1.0
            following = accept(t)
            watch.time = t
            watch.sums["steps"] += 1.0
            if following != following:
                watch.is_broken = True
                return False
            if t >= watch.end - END_TOLERANCE:
                watch.following, watch.proposed = following, proposed_step(iteration)
                watch.reached = True
                return False
            write(iteration, min(following, watch.end - t))
            if watch.sums["steps"] % _PROGRESS_STEPS == 0:
                watch.plan.progress(min(t / duration, 1.0))
                return watch.is_sound()
        except BaseException as error:  # Exudyn would wrap it: kept, raised after the solve
            watch.error = error
            return False
        return True

    return after


def settings_of(longest: float, shortest: float) -> Any:
    """Settings common to all solvers, with steps of a length at most, s."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    settings.show.computationTime = True  # fills the timers; the console is off
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.minimumStepSize = shortest
    set_span(settings, 0.0, longest, 1)
    return settings


def set_span(settings: Any, begin: float, longest: float, steps: int) -> None:
    """Set the time that a solve begins at, s, and its end: so many longest steps, s, behind."""
    integration = settings.timeIntegration
    integration.startTime = begin
    integration.endTime = begin + steps * longest
    integration.numberOfSteps = steps


def solve(system: Any, settings: Any, solver: Any, watch: Watch, remedy: str) -> Finding | None:
    """Run Exudyn's solver up to the end of a cycle; returns what went wrong, if anything.

    Parameters
    ----------
    remedy : str
        What may help where the solver gives up.
    """
    message = ""
    try:
        with quiet():
            system.SolveDynamic(settings, solverType=solver)
    except exu.ExudynError as error:
        # What a user function raises comes wrapped.
        if not isinstance(error, exu.SolverError) and StuckError.__name__ not in str(error):
            raise
        message = "the solver found no solution at the shortest step"
    if watch.error is not None:
        raise watch.error
    if watch.reached:
        return None
    if watch.reason:
        return Finding("energy", watch.reason, watch.time, "", MADE_REMEDY)
    if system.sys["dynamicSolver"].output.simulationStoppedByUser and not watch.is_broken:
        raise KeyboardInterrupt
    if not message and not watch.is_broken:
        raise RuntimeError(f"Exudyn ended at {watch.time:.17g} s, not at {watch.end:.17g} s")
    message = message or "the state is no longer finite"
    return Finding("state", message, watch.time, "", remedy)


def shares_of(sums: Mapping[str, float], names: Iterable[str]) -> dict[str, float]:
    """Stages of all solves as parts of their wall time; ``share_other`` is the rest."""
    total = sums["total"]
    shares = {f"share_{name}": sums[name] / total if total > 0.0 else 0.0 for name in names}
    return {**shares, "share_other": 1.0 - sum(shares.values())}


@contextmanager
def quiet() -> Iterator[None]:
    """Keep Exudyn's banners and log files off; errors and interrupts arrive as exceptions."""
    console, log = exu.config.printToConsole, exu.special.exceptions.writeErrorsToLogFile
    exu.config.printToConsole = False
    exu.special.exceptions.writeErrorsToLogFile = False
    try:
        yield
    except exu.ExudynError as error:
        # An interrupt that arrives inside a user function comes wrapped.
        if "KeyboardInterrupt" in str(error):
            raise KeyboardInterrupt from None
        raise
    finally:
        exu.config.printToConsole = console
        exu.special.exceptions.writeErrorsToLogFile = log


@contextmanager
def timed(diagnostics: dict[str, Any], name: str) -> Iterator[None]:
    """Note the wall time of a stage of the run under a name, s."""
    began = clock.perf_counter()
    yield
    diagnostics[name] = clock.perf_counter() - began
