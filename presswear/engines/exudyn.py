"""Parts that both Exudyn engines share: the callback after a step, the solve, how it ends."""

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswear.engines.base import Plan
from presswear.physics.energy import made_energy, made_remedy
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()

# Exudyn ends a run this close to its end time, s; a cycle is closed the same way.
END_TOLERANCE = 1e-10

_PROGRESS_STEPS = 512

STEP_SAFETY = 0.9  # Exudyn's own factor behind the step that an error of DOPRI5 allows


@dataclass
class Solve:
    """State of the solve of the present cycle, and its end."""

    recorder: Recorder
    plan: Plan
    counts: Mapping[str, str]  # attributes of Exudyn's iteration by name of a count
    # Over all cycles so far: accepted steps (``steps``), those counts, and the wall time, s; the
    # time of the last accepted step, and the next step as the contacts allow it (``following``)
    # and as the solver proposes it, s
    sums: dict[str, float]
    end: float = 0.0  # of the present cycle, s
    has_ended: bool = False  # the cycle ran to its end
    is_broken: bool = False
    reason: str = ""  # why the contacts end the run
    error: BaseException | None = None
    iteration: Any = None

    @staticmethod
    def of(recorder: Recorder, plan: Plan, counts: Mapping[str, str]) -> "Solve":
        """Return the initial state of a solve."""
        names = ("steps", "sent_back", *counts, "wall", "time", "following", "proposed")
        return Solve(recorder, plan, counts, dict.fromkeys(names, 0.0))

    @property
    def time(self) -> float:
        """Time of the last accepted step, s."""
        return self.sums["time"]

    def is_sound(self) -> bool:
        """Return whether the contacts have made no energy."""
        records = self.recorder.records
        ledger = records.ledger[0]
        if self.time > self.plan.settled:
            lost, exchange = ledger["contact_loss"], ledger["drive_exchange"]
            self.reason = made_energy(records.packed, lost, exchange)
        return not self.reason


class StuckError(RuntimeError):
    """Raised inside Exudyn where it repeats a step for ever."""


def proposed_step(iteration: Any) -> float:
    """Return the step, s, that error control takes next; Exudyn tells only behind PostStep."""
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

    def __init__(self, solve: Solve):
        self._solve = solve
        self._iteration: Any = None
        self._limit = 0.0

    def write(self, iteration: Any, step: float) -> None:
        """Note the limit, s, for the step to come."""
        self._iteration, self._limit = iteration, step

    def pre_step(self, system: Any, t: float) -> bool:
        """Apply the limit; the function for Exudyn's PreStep."""
        if self._limit > 0.0:
            iteration = self._iteration
            step = min(self._limit, iteration.currentStepSize)
            iteration.currentStepSize = step
            iteration.currentTime = self._solve.sums["time"] + step
            self._limit = 0.0
        return True


def post_step(
    solve: Solve, accept: Callable[[float], float], limit: StepLimit | None = None
) -> Callable[..., bool]:
    """Return the function for PostStep: accounts for a step and hands on the next.

    Parameters
    ----------
    accept : callable
        Returns the next step, s, from the time of an accepted one; NaN for a broken state.
    limit : StepLimit or None
        Takes the next step of a solver with error control.
    """
    sums = solve.sums

    def write(iteration: Any, step: float) -> None:
        if limit is None:
            iteration.currentStepSize = step
        else:
            limit.write(iteration, step)

    def after(system: Any, t: float) -> bool:
        try:
            iteration = solve.iteration
            if iteration is None:
                iteration = solve.iteration = system.sys["dynamicSolver"].it
                if solve.time > 0.0:
                    # Exudyn shows the state that a cycle starts from; it is accounted for.
                    write(iteration, min(sums["following"], solve.end - t))
                    return True
                sums["steps"] -= 1.0
            following = accept(t)
            sums["time"] = t
            sums["steps"] += 1.0
            solve.is_broken = following != following
            solve.has_ended = not solve.is_broken and t >= solve.end - END_TOLERANCE
            if solve.has_ended:
                sums["following"], sums["proposed"] = following, proposed_step(iteration)
            if solve.is_broken or solve.has_ended:
                return False
            write(iteration, min(following, solve.end - t))
            if sums["steps"] % _PROGRESS_STEPS == 0:
                solve.plan.advanced(t, solve.recorder)
                return solve.is_sound()
        except BaseException as error:  # Exudyn would wrap it: kept, raised after the solve
            solve.error = error
            return False
        return True

    return after


def add_node(system: Any, kind: str, **values: Any) -> Any:
    """Add a node to a system; gives its number."""
    return system.AddNode({"nodeType": kind, **values})


def add_object(system: Any, kind: str, **values: Any) -> Any:
    """Add an object to a system; gives its number."""
    return system.AddObject({"objectType": kind, **values})


def add_marker(system: Any, kind: str, **values: Any) -> Any:
    """Add a marker to a system; gives its number."""
    return system.AddMarker({"markerType": kind, **values})


def add_load(system: Any, kind: str, **values: Any) -> Any:
    """Add a load to a system; gives its number."""
    return system.AddLoad({"loadType": kind, **values})


def settings_of(longest: float, shortest: float) -> Any:
    """Return the settings common to all solvers, for a solve of one longest step, s."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    settings.show.computationTime = False  # its timers take a sixteenth of an explicit step
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.minimumStepSize = shortest
    integration.startTime, integration.endTime = 0.0, longest
    integration.numberOfSteps = 1
    return settings


def run_to_end(
    system: Any,
    live: Mapping[str, Any],
    settings: Any,
    kind: Any,
    solve: Solve,
    longest: float,
    end: float,
    remedy: str,
) -> Finding | None:
    """Run Exudyn's solver from the present state up to the end of a cycle.

    Exudyn makes a new solver for every cycle.  It does not say which step it would take behind
    its own end: that lies further off, and PostStep ends the solve.

    Parameters
    ----------
    live : mapping of str to ndarray
        Live arrays that the solver begins from, by the names that Exudyn gives them.
    kind : exudyn.DynamicSolverType
    longest : float
        Longest step, s.
    end : float
        End of the cycle, s.
    remedy : str
        What may help where the solver gives up.

    Returns
    -------
    Finding or None
        What went wrong, if anything.
    """
    solve.end, solve.has_ended, solve.iteration = end, False, None
    data, initial = system.systemData, exu.ConfigurationType.Initial
    for name, values in live.items():
        getattr(data, f"Set{name}")(np.array(values), initial)
    integration = settings.timeIntegration
    steps = math.ceil((end - solve.time) / longest) + 2
    integration.startTime, integration.endTime = solve.time, solve.time + steps * longest
    integration.numberOfSteps = steps
    if integration.automaticStepSize:
        integration.initialStepSize = solve.sums["proposed"]
    message = ""
    began = clock.perf_counter()
    try:
        with quiet():
            system.SolveDynamic(settings, solverType=kind)
    except (exu.ExudynError, StuckError) as error:
        # What a user function raises comes wrapped from the safe module, as it is from the fast.
        stuck = isinstance(error, StuckError) or StuckError.__name__ in str(error)
        if stuck or isinstance(error, exu.SolverError):
            message = "the solver found no solution at the shortest step"
        elif "not factorized" in str(error):
            message = "the matrix of the equations is singular or not finite"
        else:
            raise
    if solve.error is not None:
        raise solve.error
    solver = system.sys["dynamicSolver"]
    solve.sums["wall"] += clock.perf_counter() - began
    for name, counter in solve.counts.items():
        solve.sums[name] += getattr(solver.it, counter)
    if solve.has_ended:
        return None
    if solve.reason:
        advice = made_remedy(solve.recorder.records.packed, remedy)
        return Finding("energy", solve.reason, solve.time, "", advice)
    if solver.output.simulationStoppedByUser and not solve.is_broken:
        raise KeyboardInterrupt
    if not message and not solve.is_broken:
        raise RuntimeError(f"Exudyn ended at {solve.time:.17g} s, not at {solve.end:.17g} s")
    message = message or "the state is no longer finite"
    return Finding("state", message, solve.time, "", remedy)


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
