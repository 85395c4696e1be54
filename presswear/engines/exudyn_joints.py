"""Exudyn with bodies and joints, implicit: any linkage.

Contact state changes only between accepted steps, in ``PostStep``; the user
functions are pure.  The same call chooses the next step and writes it into the
running solver; ``PostNewton`` sends back a step that ran too far past a touch.
"""

from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.compiled import Records
from presswear.energy import Ledger, stored_energy
from presswear.engines.base import Accuracy, Plan, Run, Start, described
from presswear.engines.exudyn_model import Model, assemble, connector_force, reactions_of
from presswear.engines.exudyn_solve import (
    Accept,
    Watch,
    post_step,
    settings_of,
    share_of,
    solve,
    timed,
)
from presswear.linkage import Linkage
from presswear.observe import Account, Book
from presswear.stepping import accept_step
from presswear.touch import shorter_step

Array = NDArray[np.float64]


def _settings(accuracy: Accuracy, plan: Plan) -> Any:
    settings = settings_of(plan, accuracy.free_step, 0.1 * accuracy.least_step)
    integration = settings.timeIntegration
    # Steps are chosen by accept_step; Exudyn must not lengthen them behind its back.
    integration.adaptiveStepRecoverySteps = 2**30
    integration.newton.relativeTolerance = accuracy.newton
    integration.newton.absoluteTolerance = accuracy.newton
    integration.newton.modifiedNewtonContractivity = 0.01
    return settings


def _accept(model: Model, book: Book, steps: Records, drives: Array) -> Accept:
    """Account for accepted steps and choose the next."""
    q, v, a, multipliers = model.q, model.v, model.a, model.multipliers
    last = 0.0

    def accept(t: float) -> float:
        nonlocal last
        h, last = t - last, t
        return accept_step(book, steps, drives, multipliers, t, h, q, v, a)

    return accept


class _SendBack:
    """The function for PostNewton: repeats a step that ran too far past a touch."""

    def __init__(self, model: Model, book: Book, steps: Records):
        self.count = 0
        self._arguments = book.joints, book.onset, book.touch, steps, book.surfaces
        self._state = model.q, model.v

    def __call__(self, system: Any, t: float) -> list[float]:
        shorter = shorter_step(*self._arguments, t, *self._state)
        if shorter < 0.0:
            return [0.0, -1.0]
        self.count += 1
        return [2.0, shorter]


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
    times: dict[str, float] = {}
    with timed(times, "wall_compile_s"):
        _warm_up(linkage, start, steps)
    with timed(times, "wall_build_s"):
        account = Account.of(linkage, start.position, plan.recorded_cycles, plan.cycle)
        book = account.book
        model = assemble(linkage, start, account)
        drives = np.array(
            [
                (model.system.systemData.GetObjectLTGAE(model.joints[drive.name])[0], drive.speed)
                for drive in linkage.drives
            ]
        ).reshape(-1, 2)
        watch = Watch(account, plan)
        send_back = _SendBack(model, book, steps)
        model.system.SetPostStepUserFunction(post_step(watch, _accept(model, book, steps, drives)))
        if linkage.clearances:
            model.system.SetPostNewtonUserFunction(lambda system, t: send_back(system, t))
    depths = book.touch["penetration"]
    before = stored_energy(linkage, book.joints, depths, start.position, start.velocity)
    with timed(times, "wall_solve_s"):
        message = solve(
            model.system,
            _settings(accuracy, plan),
            exu.DynamicSolverType.TrapezoidalIndex2,
            watch,
            "more steps per contact may help",
        )
    solver = model.system.sys["dynamicSolver"]
    q, v = np.array(model.q), np.array(model.v)
    after = stored_energy(linkage, book.joints, depths, q, v)
    result = Run(
        status=watch.ended,
        message=message,
        account=account,
        end=Start(q, v),
        time=watch.time,
        reactions=reactions_of(model, linkage),
        diagnostics={
            "model": described(linkage),
            "solver": "Exudyn trapezoidal index 2, step chosen by contact state",
            "steps": watch.steps,
            "steps_sent_back": send_back.count,
            "newton_iterations": int(solver.it.newtonStepsCount),
            "jacobians": int(solver.it.newtonJacobiCount),
            **times,
            **Ledger.of(book.ledger, after - before).as_dict(),
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
    return share_of(
        timer,
        {
            "forces_and_connectors": timer.ODE2RHS,
            "constraints": timer.AERHS + timer.reactionForces,
            "jacobians": timer.totalJacobian + timer.factorization,
            "linear_solves": timer.newtonIncrement,
            "end_of_step": timer.python,
        },
    )
