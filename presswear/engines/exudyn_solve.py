"""What every Exudyn engine shares: the callback after a step, the solve, how it ends."""

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import exudyn as exu

from presswear.energy import SETTLED, made_energy
from presswear.engines.base import Plan, Status
from presswear.observe import Account

END_TOLERANCE = 1e-10
"""Exudyn ends a run this close to its end time, s; a cycle is closed the same way."""

_PROGRESS_STEPS = 512

Accept = Callable[[float], float]
"""Called with the time of an accepted step; gives the next step, s, or NaN for a broken state."""

Write = Callable[[Any, float], None]
"""Hands the next step, s, to the running solver, whose ``it`` is given."""


@dataclass
class Watch:
    """Where a solve stands: cycles, progress, and why it ended."""

    account: Account
    plan: Plan
    time: float = 0.0
    cycle_end: float = 0.0
    steps: int = -1
    ended: Status = "completed"
    reason: str = ""
    error: BaseException | None = None

    def is_sound(self) -> bool:
        """Whether the contacts have made no energy; False ends the run."""
        ledger = self.account.book.ledger
        if self.time > SETTLED * self.plan.cycle:
            self.reason = made_energy(float(ledger[2]), float(ledger[1]))
        if self.reason:
            self.ended = "failed"
        return not self.reason

    def close_cycle(self) -> bool:
        """File the present cycle; False ends the run."""
        self.account.end_cycle()
        done = len(self.account.cycles)
        self.cycle_end = self.plan.cycle * (done + 1)
        if done == self.plan.recorded_cycles:
            self.account.stop_recording()
        if done < self.plan.cycles and self.plan.enough(self.account):
            self.ended = "enough"
            return False
        return True


def write_step(iteration: Any, step: float) -> None:
    """The next step of a solver without error control."""
    iteration.currentStepSize = step


class StuckError(RuntimeError):
    """Raised inside Exudyn where it repeats a step for ever."""


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
    watch.cycle_end = watch.plan.cycle
    iteration: Any = None

    def after(system: Any, t: float) -> bool:
        nonlocal iteration
        try:
            if iteration is None:
                iteration = system.sys["dynamicSolver"].it
            following = accept(t)
            watch.time = t
            watch.steps += 1
            if following != following:
                watch.ended = "failed"
                return False
            if t >= watch.cycle_end - END_TOLERANCE and not watch.close_cycle():
                return False
            write(iteration, min(following, watch.cycle_end - t))
            if watch.steps % _PROGRESS_STEPS == 0:
                watch.plan.progress(min(t / duration, 1.0))
                return watch.is_sound()
        except BaseException as error:  # Exudyn would wrap it: kept, raised after the solve
            watch.error = error
            return False
        return True

    return after


def settings_of(plan: Plan, longest: float, shortest: float) -> Any:
    """Settings common to all solvers, with steps of a length at most, s."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    settings.show.computationTime = True  # fills the timers; the console is off
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.endTime = plan.cycle * plan.cycles
    integration.numberOfSteps = max(1, int(integration.endTime / longest))
    integration.minimumStepSize = shortest
    return settings


def solve(system: Any, settings: Any, solver: Any, watch: Watch, remedy: str) -> str:
    """Run Exudyn's solver; returns what went wrong, or nothing.

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
        # An interrupt that arrives inside a connector comes wrapped.
        if "KeyboardInterrupt" in str(error):
            raise KeyboardInterrupt from None
        # So does what a user function raises.
        if not isinstance(error, exu.SolverError) and StuckError.__name__ not in str(error):
            raise
        watch.ended = "failed"
        message = "the solver found no solution at the shortest step"
    if watch.error is not None:
        raise watch.error
    if system.sys["dynamicSolver"].output.simulationStoppedByUser and watch.ended == "completed":
        raise KeyboardInterrupt
    if watch.ended != "failed":
        return ""
    if watch.reason:
        return f"{watch.reason} (t = {watch.time:.6g} s)"
    message = message or "the state is no longer finite"
    return f"{message} (t = {watch.time:.6g} s); {remedy}"


def share_of(timer: Any, seconds: dict[str, float]) -> dict[str, float]:
    """Stages of a solve as parts of its wall time; ``share_other`` is the rest."""
    shares = {f"share_{name}": spent / timer.total for name, spent in seconds.items()}
    return {**shares, "share_other": 1.0 - sum(shares.values())}


@contextmanager
def quiet() -> Iterator[None]:
    """Keep Exudyn's banners and log files off; errors arrive as exceptions."""
    console, log = exu.config.printToConsole, exu.special.exceptions.writeErrorsToLogFile
    exu.config.printToConsole = False
    exu.special.exceptions.writeErrorsToLogFile = False
    try:
        yield
    finally:
        exu.config.printToConsole = console
        exu.special.exceptions.writeErrorsToLogFile = log


@contextmanager
def timed(diagnostics: dict[str, Any], name: str) -> Iterator[None]:
    """Note the wall time of a stage of the run under a name, s."""
    began = clock.perf_counter()
    yield
    diagnostics[name] = clock.perf_counter() - began
