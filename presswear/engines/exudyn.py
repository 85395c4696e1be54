"""Solver of Exudyn for both Exudyn engines: functions of each step, the solve, its end."""

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from presswear.engines.base import Plan
from presswear.physics.equations.layout import CONTACT_LOSS, DRIVE_EXCHANGE
from presswear.physics.ledger import created_energy_message, remedy_for_created_energy
from presswear.recording.nominal_time import SECTION_TOL
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding, Progress, check_motor
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()

# Exudyn ends a run if the time left is shorter, s; a cycle ends by the same tolerance.
END_TOLERANCE = 1e-10
# Longest first step of a section that ends at an angle, over the expected time to its end
FIRST_PART = 0.5
# Number of longest steps up to the end time of such a section: PostStep ends it earlier
MOST_STEPS = 10**9
# Factor by which Exudyn shortens the step that the error of DOPRI5 allows
STEP_SAFETY = 0.9
_PROGRESS_STEPS = 512


class StuckError(RuntimeError):
    """A step that Exudyn would repeat without end."""


@dataclass
class Solver:
    """Exudyn's solver in one run; each cycle is a new solve.

    With error control Exudyn chooses its next step before it calls PostStep. The step
    that contacts allow is therefore applied in PreStep: it limits the step and sets the
    time at which the step ends. A step that is repeated because of its error is
    shortened by Exudyn only.
    """

    recorder: Recorder
    plan: Plan
    # records the step that ends at a time, s; returns the next step, s, or NaN if the
    # state is not finite
    accept: Callable[[float], float]
    kind: Any  # exudyn.DynamicSolverType
    settings: Any
    longest: float  # step, s
    remedy: str  # advice if the solver gives up
    counts: Mapping[str, str]  # attributes of Exudyn's iteration by name of a count
    # Sums over all cycles so far: accepted steps (``steps``), repeated steps
    # (``sent_back``), the names of ``counts``, and the wall time (``wall``), s. Values of
    # the last accepted step: its time (``time``), and the next step that contacts allow
    # (``following``) and that the solver proposes (``proposed``), s
    sums: dict[str, float] = field(init=False)
    _end: float = 0.0  # end of the present section, s; a nominal time with a leader
    # The present section ends at an angle of the leader. Stored here, because reading it
    # from the recorder takes as long as a stage of the method.
    _ends_by_angle: bool = False
    _has_ended: bool = False  # the cycle ran to its end
    _is_broken: bool = False  # the state is not finite
    _limit: float = 0.0  # longest next step, s; 0: no limit
    _finding: Finding | None = None  # reason to end the run within a cycle
    _progress: Progress = field(init=False)
    # Error in a function that Exudyn calls. It is raised after the solve, because Exudyn
    # would replace it by an error of its own.
    error: BaseException | None = None
    _iteration: Any = None

    def __post_init__(self) -> None:
        names = (
            "steps",
            "sent_back",
            *self.counts,
            "wall",
            "time",
            "following",
            "proposed",
        )
        self.sums = dict.fromkeys(names, 0.0)
        self._progress = Progress(self.plan.cycle)

    @property
    def time(self) -> float:
        """Time of the last accepted step, s."""
        return self.sums["time"]

    def install(self, system: Any) -> None:
        """Set the functions that Exudyn calls before and after a step."""
        if self.kind == exu.DynamicSolverType.DOPRI5:
            system.SetPreStepUserFunction(self._pre_step)
        system.SetPostStepUserFunction(self._post_step)

    def _limit_next(self, step: float) -> None:
        """Limit the next step, s."""
        if self.kind == exu.DynamicSolverType.DOPRI5:
            self._limit = step
        else:
            self._iteration.currentStepSize = step

    def _pre_step(self, system: Any, t: float) -> bool:
        if self._limit > 0.0:
            iteration = self._iteration
            step = min(self._limit, iteration.currentStepSize)
            iteration.currentStepSize = step
            iteration.currentTime = self.time + step
            self._limit = 0.0
        return True

    def _post_step(self, system: Any, t: float) -> bool:
        """Record a step and limit the next one; return False to end the solve."""
        try:
            if self._iteration is None:
                self._iteration = system.sys["dynamicSolver"].it
                if self.time > 0.0:
                    # The first call of a cycle has its initial state, which the last
                    # cycle has recorded.
                    first_step = min(self.sums["following"], self._first_step(t))
                    self._limit_next(first_step)
                    return True
                self.sums["steps"] -= 1.0
            return self._accept(t)
        except BaseException as error:
            self.error = error
            return False

    def _accept(self, t: float) -> bool:
        """Record a step that ended at a time, s; return False to end the solve."""
        sums = self.sums
        following = self.accept(t)
        sums["time"] = t
        sums["steps"] += 1.0
        self._is_broken = math.isnan(following)
        if self._is_broken:
            return False
        if self._is_at_end(t):
            self._has_ended = True
            sums["following"] = following
            sums["proposed"] = self._proposed_step()
            return False
        if not self._ends_by_angle:
            following = min(following, self._end - t)
        self._limit_next(following)
        if sums["steps"] % _PROGRESS_STEPS == 0:
            self.plan.advanced(self.recorder)
            self._finding = self._judge(t)
            return self._finding is None
        return True

    def _proposed_step(self) -> float:
        """Return the next step of Exudyn's error control, s.

        Exudyn computes it after PostStep, so that it is computed here, too.
        """
        iteration = self._iteration
        error = iteration.automaticStepSizeError
        if not error > 0.0:
            return float(iteration.maxStepSize)
        factor = error ** (-1.0 / 5.0)
        proposed = STEP_SAFETY * iteration.currentStepSize * factor
        return float(min(proposed, iteration.maxStepSize))

    def _is_at_end(self, t: float) -> bool:
        """Return whether the section has ended at a time, s, or at its angle."""
        if self._ends_by_angle:
            return self.recorder.nominal_time >= self._end - SECTION_TOL
        return t >= self._end - END_TOLERANCE

    def _first_step(self, t: float) -> float:
        """Return the longest first step of a section, s."""
        if not self._ends_by_angle:
            return self._end - t
        # The proposed step of the last section does not know the end of this section.
        rate = float(self.recorder.records.nominal["rate"][0])
        nominal_step = FIRST_PART * (self._end - self.recorder.nominal_time)
        return nominal_step / rate if rate > 0.0 else self.longest

    def _judge(self, t: float) -> Finding | None:
        """Return a finding if contacts created energy, a motor stalled or steps became tiny."""
        records = self.recorder.records
        if self.recorder.nominal_time > self.plan.settled:
            loss, exchange = records.energies[[CONTACT_LOSS, DRIVE_EXCHANGE]]
            if message := created_energy_message(records.packed, loss, exchange):
                return Finding(
                    "energy",
                    message,
                    t,
                    "",
                    remedy_for_created_energy(records.packed, self.remedy),
                )
        stalled = check_motor(self.recorder, t)
        return stalled or self._progress.judge(int(self.sums["steps"]), t)

    def run(self, system: Any, live: Mapping[str, Any], end: float) -> Finding | None:
        """Run from the present state up to the end of a section; return what went wrong.

        The end time of Exudyn is later than that of the section, and PostStep ends the
        solve. If Exudyn shortened the last step to meet its end time, it would propose
        too short a step for the next section.

        Parameters
        ----------
        live : mapping of str to ndarray
            Live arrays of the initial state, by their names in Exudyn.
        end : float
            End of the section, s; with a leader its nominal time.
        """
        self._end = end
        self._has_ended = False
        self._iteration = None
        self._ends_by_angle = self.recorder.ends_by_angle
        initial = exu.ConfigurationType.Initial
        for name, values in live.items():
            set_values = getattr(system.systemData, f"Set{name}")
            set_values(np.array(values), initial)
        self._set_times(end)
        began = clock.perf_counter()
        message = self._solve(system)
        self.sums["wall"] += clock.perf_counter() - began
        solver = system.sys["dynamicSolver"]
        for name, counter in self.counts.items():
            self.sums[name] += getattr(solver.it, counter)
        if self._has_ended:
            return None
        if self._finding is not None:
            return self._finding
        if solver.output.simulationStoppedByUser and not self._is_broken:
            raise KeyboardInterrupt
        if not message and not self._is_broken:
            raise RuntimeError(
                f"Exudyn ended at {self.time:.17g} s, not at {end:.17g} s"
            )
        message = message or "the state is no longer finite"
        return Finding("state", message, self.time, "", self.remedy)

    def _set_times(self, end: float) -> None:
        """Set start and end of a solve, and its first step."""
        integration = self.settings.timeIntegration
        steps = MOST_STEPS
        if not self._ends_by_angle:
            steps = math.ceil((end - self.time) / self.longest) + 2
        integration.startTime = self.time
        integration.endTime = self.time + steps * self.longest
        integration.numberOfSteps = steps
        if integration.automaticStepSize:
            integration.initialStepSize = self.sums["proposed"]

    def _solve(self, system: Any) -> str:
        """Call Exudyn's solver; return the reason if it found no solution."""
        message = ""
        try:
            with quiet():
                system.SolveDynamic(self.settings, solverType=self.kind)
        except (exu.ExudynError, StuckError) as error:
            is_stuck = isinstance(self.error, StuckError)
            if is_stuck or (isinstance(error, exu.SolverError) and self.error is None):
                message = "the solver found no solution at the shortest step"
                self.error = None
            elif "not factorized" in str(error):
                message = "the matrix of the equations is singular or not finite"
            elif self.error is None:
                raise
        if self.error is not None:
            raise self.error from None
        return message


def add(system: Any, item: str, kind: str, **values: Any) -> Any:
    """Add a Node, Object, Marker or Load of a kind to a system; return its number."""
    return getattr(system, f"Add{item}")({f"{item.lower()}Type": kind, **values})


def settings_of(longest: float, shortest: float) -> Any:
    """Return the settings common to all solvers, for a solve of one longest step, s."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    # the timers take a sixteenth of the time of an explicit step
    settings.show.computationTime = False
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.minimumStepSize = shortest
    integration.startTime = 0.0
    integration.endTime = longest
    integration.numberOfSteps = 1
    return settings


@contextmanager
def quiet() -> Iterator[None]:
    """Suppress messages and log files of Exudyn; raise errors and interrupts as exceptions."""
    console = exu.config.printToConsole
    log = exu.special.exceptions.writeErrorsToLogFile
    exu.config.printToConsole = False
    exu.special.exceptions.writeErrorsToLogFile = False
    try:
        yield
    except exu.ExudynError as error:
        # Exudyn wraps an interrupt inside a user function.
        if "KeyboardInterrupt" in str(error):
            raise KeyboardInterrupt from None
        raise
    finally:
        exu.config.printToConsole = console
        exu.special.exceptions.writeErrorsToLogFile = log
