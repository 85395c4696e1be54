"""Exudyn with bodies and joints, implicit: any linkage.

Contact state changes only between accepted steps, in ``PostStep``; the user
functions are pure.  The same call chooses the next step and writes it into the
running solver; ``PostNewton`` sends back a step that ran too far past a touch.
"""

import math
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.compiled import Records
from presswear.energy import Ledger, stored_energy
from presswear.engines.base import Accuracy, Plan, Run, Start, Status, described
from presswear.engines.exudyn_model import Model, assemble, connector_force, reactions_of
from presswear.linkage import Linkage
from presswear.observe import Account
from presswear.stepping import accept_step
from presswear.touch import shorter_step

Array = NDArray[np.float64]

END_TOLERANCE = 1e-10
"""Exudyn ends a run this close to its end time, s; a cycle is closed the same way."""

_PROGRESS_STEPS = 512


def _settings(accuracy: Accuracy, duration: float) -> Any:
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EXUdense
    settings.show.computationTime = True  # fills the timers; the console is off
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.endTime = duration
    integration.numberOfSteps = max(1, math.floor(duration / accuracy.free_step))
    integration.minimumStepSize = 0.1 * accuracy.least_step
    # Steps are chosen by accept_step; Exudyn must not lengthen them behind its back.
    integration.adaptiveStepRecoverySteps = 2**30
    integration.newton.relativeTolerance = accuracy.newton
    integration.newton.absoluteTolerance = accuracy.newton
    integration.newton.modifiedNewtonContractivity = 0.01
    return settings


@dataclass
class _Progress:
    """Where a solve stands; shared by the two functions that Exudyn calls back."""

    last_time: float = 0.0
    cycle_end: float = 0.0
    steps: int = 0
    sent_back: int = 0
    ended: Status = "completed"
    error: BaseException | None = None


def _watch(
    model: Model, account: Account, steps: Records, drives: Array, plan: Plan
) -> tuple[_Progress, Callable[..., bool], Callable[..., list[float]]]:
    """The functions for PostStep (accept, account, choose) and PostNewton (send back)."""
    duration = plan.cycle * plan.cycles
    at = _Progress(cycle_end=plan.cycle)
    book = account.book
    joints, onset, touch, surfaces = book.joints, book.onset, book.touch, book.surfaces
    q, v, a, multipliers = model.q, model.v, model.a, model.multipliers

    def close_cycle() -> bool:
        account.end_cycle()
        done = len(account.cycles)
        at.cycle_end = plan.cycle * (done + 1)
        if done == plan.recorded_cycles:
            account.stop_recording()
        if done < plan.cycles and plan.enough(account):
            at.ended = "enough"
            return False
        return True

    def post_step(system: Any, t: float) -> bool:
        try:
            following = accept_step(book, steps, drives, multipliers, t, t - at.last_time, q, v, a)
            at.last_time = t
            at.steps += 1
            if following != following:
                at.ended = "failed"
                return False
            if t >= at.cycle_end - END_TOLERANCE and not close_cycle():
                return False
            system.sys["dynamicSolver"].it.currentStepSize = min(following, at.cycle_end - t)
            if at.steps % _PROGRESS_STEPS == 0:
                plan.progress(min(t / duration, 1.0))
        except BaseException as error:  # Exudyn would wrap it: kept, raised after the solve
            at.error = error
            return False
        return True

    def post_newton(system: Any, t: float) -> list[float]:
        shorter = shorter_step(joints, onset, touch, steps, surfaces, t, q, v)
        if shorter < 0.0:
            return [0.0, -1.0]
        at.sent_back += 1
        return [2.0, shorter]

    return at, post_step, post_newton


def _warm_up(linkage: Linkage, start: Start, steps: Records) -> None:
    """Compile every kernel, or load it from the cache, on a state thrown away."""
    account = Account.of(linkage, start.position, 1, 1.0)
    q, v = np.array(start.position), np.array(start.velocity)
    nothing = np.zeros((0, 2))
    accept_step(account.book, steps, nothing, np.zeros(0), 0.0, 0.0, q, v, np.zeros_like(q))
    if linkage.clearances:
        joints, onset, surfaces = account.book.joints, account.book.onset, account.book.surfaces
        connector_force(joints, 0, onset, surfaces, q, v, np.zeros(6))
        shorter_step(joints, onset, account.book.touch, steps, surfaces, 0.0, q, v)


def simulate(linkage: Linkage, start: Start, accuracy: Accuracy, plan: Plan) -> Run:
    """Run a linkage from a start; see ``Plan`` and ``Run``."""
    steps = accuracy.packed()
    began = clock.perf_counter()
    _warm_up(linkage, start, steps)
    compiled_at = clock.perf_counter()
    account = Account.of(linkage, start.position, plan.recorded_cycles, plan.cycle)
    model = assemble(linkage, start, account)
    drives = np.array(
        [
            (model.system.systemData.GetObjectLTGAE(model.joints[drive.name])[0], drive.speed)
            for drive in linkage.drives
        ]
    ).reshape(-1, 2)
    at, post_step, post_newton = _watch(model, account, steps, drives, plan)
    depths = account.book.touch["penetration"]
    before = stored_energy(linkage, account.book.joints, depths, start.position, start.velocity)
    model.system.SetPostStepUserFunction(post_step)
    if linkage.clearances:
        model.system.SetPostNewtonUserFunction(post_newton)
    settings = _settings(accuracy, plan.cycle * plan.cycles)
    built = clock.perf_counter()
    message = ""
    try:
        with _quiet():
            model.system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
    except exu.ExudynError as error:
        # An interrupt that arrives inside a connector comes wrapped.
        if "KeyboardInterrupt" in str(error):
            raise KeyboardInterrupt from None
        if not isinstance(error, exu.SolverError):
            raise
        at.ended = "failed"
        message = "Newton's method found no solution at the shortest step"
    if at.error is not None:
        raise at.error
    solver = model.system.sys["dynamicSolver"]
    if solver.output.simulationStoppedByUser and at.ended == "completed":
        raise KeyboardInterrupt
    solved = clock.perf_counter()
    if at.ended == "failed":
        message = message or "the state is no longer finite"
        message = f"{message} (t = {at.last_time:.6g} s); more steps per contact may help"
    q, v = np.array(model.q), np.array(model.v)
    after = stored_energy(linkage, account.book.joints, depths, q, v)
    work, exchange, contact_loss, friction_loss = (float(x) for x in account.book.ledger[:4])
    ledger = Ledger(work, exchange, after - before, contact_loss, friction_loss)
    result = Run(
        status=at.ended,
        message=message,
        account=account,
        end=Start(q, v),
        time=at.last_time,
        reactions=reactions_of(model, linkage),
        diagnostics={
            "model": described(linkage),
            "solver": "Exudyn trapezoidal index 2, step chosen by contact state",
            "steps": at.steps - 1,
            "steps_sent_back": at.sent_back,
            "newton_iterations": int(solver.it.newtonStepsCount),
            "jacobians": int(solver.it.newtonJacobiCount),
            "wall_compile_s": compiled_at - began,
            "wall_build_s": built - compiled_at,
            "wall_solve_s": solved - built,
            **ledger.as_dict(),
            **_wall_shares(solver.timer),
        },
    )
    model.container.Reset()
    return result


def _wall_shares(timer: Any) -> dict[str, float]:
    """Where the solve's time went, as parts of its wall time.

    Forces include the Python connectors; the step's end is contact state, wear,
    recording and the choice of the next step.
    """
    spent = {
        "forces_and_connectors": timer.ODE2RHS,
        "constraints": timer.AERHS + timer.reactionForces,
        "jacobians": timer.totalJacobian + timer.factorization,
        "linear_solves": timer.newtonIncrement,
        "end_of_step": timer.python,
    }
    shares = {f"share_{name}": seconds / timer.total for name, seconds in spent.items()}
    return {**shares, "share_other": 1.0 - sum(shares.values())}


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Exudyn's banners and log files off; errors arrive as exceptions."""
    console, log = exu.config.printToConsole, exu.special.exceptions.writeErrorsToLogFile
    exu.config.printToConsole = False
    exu.special.exceptions.writeErrorsToLogFile = False
    try:
        yield
    finally:
        exu.config.printToConsole = console
        exu.special.exceptions.writeErrorsToLogFile = log
