"""Exudyn with bodies and joints, implicit: any linkage.

Contact state changes only between accepted steps, in ``PostStep``; the user
functions are pure.  The same call chooses the next step and writes it into the
running solver; ``PostNewton`` sends back a step that ran too far past a touch.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Start, described
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import (
    Solve,
    post_step,
    run_to_end,
    settings_of,
    timed,
)
from presswear.engines.exudyn_joints.kernels import (
    Drives,
    Frame,
    accept_joint_step,
    shorter_joint_step,
)
from presswear.engines.exudyn_joints.model import SOLVED, JointsModel, assemble, left_out
from presswear.engines.settings import ExudynJoints
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import OverPosition
from presswear.physics.constraints import constraints_of
from presswear.physics.drive_motion import is_steady
from presswear.physics.energy import Ledger, stored_energy
from presswear.physics.forces import JOINT_RATES
from presswear.physics.touchdown import STEPS
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.tools.compile import Records, bind
from presswear.tools.exudyn import exudyn_module

Array = NDArray[np.float64]

exu = exudyn_module()

REMEDY = "more steps_per_contact may help"  # advice that makes a run finer

_COUNTS = {"newton": "newtonStepsCount", "jacobians": "newtonJacobiCount"}


def _settings(accuracy: ExudynJoints, longest: float) -> Any:
    settings = settings_of(longest, 0.1 * accuracy.least_step)
    integration = settings.timeIntegration
    # Steps are chosen by accept_joint_step; Exudyn must not lengthen them behind its back.
    integration.adaptiveStepRecoverySteps = 2**30
    integration.newton.relativeTolerance = accuracy.newton
    integration.newton.absoluteTolerance = accuracy.newton
    integration.newton.modifiedNewtonContractivity = 0.01
    return settings


def pack_steps(accuracy: ExudynJoints, cycle: float) -> Records:
    """Step lengths in a cycle of a duration, s, as the kernels see them: one record of STEPS."""
    steps = np.zeros(1, STEPS)
    steps["free"] = accuracy.longest(cycle)
    steps["per_contact"] = accuracy.steps_per_contact
    steps["sustained"] = accuracy.steps_sustained
    steps["least"] = accuracy.least_step
    return steps


def _drives(model: JointsModel, linkage: Linkage, mass: Array) -> Drives:
    """Return the sources of the drive torques, with the projection where it is needed."""
    number = model.system.systemData.GetObjectLTGAE
    modelled = [drive for drive in linkage.drives if drive.name in model.joints]
    are_steady = all(is_steady(linkage, drive) for drive in modelled)
    # Behind the short step to a bend in a load the accelerations would swing about the right ones.
    bends = any(isinstance(load.law, OverPosition) for load in linkage.live_loads)
    count = 3 * len(linkage.bodies)
    return Drives(
        multiplier=np.array(
            [
                number(model.joints[drive.name])[0] if drive.name in model.joints else -1
                for drive in linkage.drives
            ],
            dtype=np.int64,
        ),
        multipliers=model.solved[3],
        force=np.zeros(count),
        rates=np.zeros(JOINT_RATES * len(linkage.clearances)),
        held=None if are_steady and not bends else constraints_of(linkage).held(mass),
    )


def _send_back(frame: Frame, solve: Solve, steps: Records) -> Callable[[Any, float], list[float]]:
    """The function for PostNewton: repeats a step that ran too far past a touch or bend."""
    kernel = bind(shorter_joint_step, frame, solve.recorder.records, steps)

    def send_back(system: Any, t: float) -> list[float]:
        shorter = kernel(t)
        if shorter < 0.0:
            return [0.0, -1.0]
        solve.sums["sent_back"] += 1.0
        return [2.0, shorter]

    return send_back


def prepare(
    linkage: Linkage, start: Start, settings: ExudynJoints, plan: Plan, recorder: Recorder
) -> Simulation:
    """Build bodies and joints in a start; see ``Simulation``."""
    longest = settings.longest(plan.cycle)
    steps = pack_steps(settings, plan.cycle)
    times: dict[str, float] = {}
    # Compiling, or loading what was compiled, is part of building the model.
    with timed(times, "wall_build_s"):
        records = recorder.records
        model = assemble(linkage, start, recorder)
        solve = Solve.of(recorder, plan, _COUNTS)
        drives = _drives(model, linkage, records.packed.mass)
        accept = bind(accept_joint_step, model.frame, drives, records, steps)
        model.system.SetPostStepUserFunction(post_step(solve, accept))
        if linkage.clearances or linkage.live_loads:
            model.system.SetPostNewtonUserFunction(_send_back(model.frame, solve, steps))
    energies = records.memory["energy"]
    before = stored_energy(records.packed, energies, start.position, start.velocity)
    exudyn = _settings(settings, longest)

    def advance(end: float) -> Finding | None:
        kind = exu.DynamicSolverType.TrapezoidalIndex2
        live = dict(zip(SOLVED, model.solved, strict=True))
        # Exudyn's own are those of even drives; a cycle goes on with what the last one ended with.
        compute = drives.held is None or solve.time == 0.0
        exudyn.timeIntegration.generalizedAlpha.computeInitialAccelerations = compute
        return run_to_end(model.system, live, exudyn, kind, solve, longest, end, REMEDY)

    def state() -> tuple[float, Array, Array]:
        return solve.time, np.array(model.frame.q), np.array(model.frame.v)

    def ledger() -> Ledger:
        stored = stored_energy(records.packed, energies, *state()[1:])
        return Ledger.of(records.ledger[0], stored - before)

    def diagnostics() -> dict[str, float | int | str]:
        sums, omitted = solve.sums, left_out(linkage)
        bodies = len(linkage.bodies) - len(omitted)
        words = f"{bodies} bodies, {len(model.joints)} joints and drives"
        return {
            "model": described(linkage, words, omitted),
            "solver": "Exudyn trapezoidal index 2, step chosen by contact state",
            "steps": int(sums["steps"]),
            "steps_sent_back": int(sums["sent_back"]),
            "newton_iterations": int(sums["newton"]),
            "jacobians": int(sums["jacobians"]),
            **times,
            "wall_solve_s": sums["wall"],
        }

    return Simulation(
        advance,
        state,
        ledger,
        {**model.state(), "force": drives.force},
        solve.sums,
        diagnostics,
        REMEDY,
        constraints_of(linkage),
        close=model.container.Reset,
    )
