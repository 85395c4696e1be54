"""Exudyn with an open tree in minimal coordinates, explicit and error-controlled.

For linkages in which the clearance joints cut every loop that has a freedom.  The tree's inertia,
gyroscopic terms and the integration (DOPRI5) are Exudyn's; its Python user function
hands the live state to one compiled kernel, which gives the forces of all contacts,
weights and moving hinges at once.  Contact state changes only between accepted
steps, and steps end where a pin touches or leaves.
"""

from array import array
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Start, described, listed
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import (
    Accept,
    Solve,
    StepLimit,
    StuckError,
    post_step,
    quiet,
    run_to_end,
    settings_of,
    timed,
)
from presswear.engines.exudyn_tree.kernels import (
    PACE,
    STAGES,
    Inside,
    TreeSystem,
    accept_tree_step,
    hinge_power_integral,
    stage_bristles,
    stage_forces,
)
from presswear.engines.exudyn_tree.model import TreeModel, assemble
from presswear.engines.settings import ExudynTree
from presswear.linkage.linkage import Linkage, prescribed_of
from presswear.physics.energy import Ledger, stored_energy
from presswear.physics.forces import JOINT_RATES
from presswear.physics.prescribed import Tree, begin_motion, tree_of
from presswear.physics.tree import CARRIED
from presswear.recording.observe import RecorderState
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.tools.compile import PackedArguments, bind, specialised
from presswear.tools.errors import InputError
from presswear.tools.exudyn import exudyn_module

Array = NDArray[np.float64]

exu = exudyn_module()

REMEDY = "a smaller tree_tolerance may help"  # advice that makes a run finer
SHORTEST_STEP = 1e-13  # s
FIRST_STEP = 1e-7  # s
MOST_CALLS = 7000
"""Calls for forces without an accepted step after which there is no way on: a thousand steps
sent back, where thirty reach the shortest.  Exudyn would repeat that one for ever."""
_INSTANT = 1e-12  # length of the step that asks Exudyn for the accelerations at the start, s


def system_of(tree: Tree, linkage: Linkage, start: Start, longest: float) -> TreeSystem:
    """Pack a tree in a start for the kernels; ``longest`` is its longest step, s."""
    prescribed = tree.prescribed._replace(work=tree.prescribed.work.copy())
    begin_motion(prescribed, 0.0, start.position)
    count, joints = 3 * len(linkage.bodies), len(linkage.clearances)
    pace = np.zeros(1, PACE)
    pace["longest"] = longest
    pace["shortest"] = SHORTEST_STEP
    pace["reach"] = pace["asked"] = FIRST_STEP
    pace["noted"] = np.nan
    return TreeSystem(
        links=tree.links,
        prescribed=prescribed,
        expected=np.zeros(joints),
        pace=pace,
        stages=np.zeros((STAGES, 2 + JOINT_RATES * joints)),
        state=np.zeros((5, count)),
        carried=np.zeros((len(tree.links), CARRIED)),
        balance=np.zeros(tree.size),
    )


def inside_of(system: TreeSystem, records: RecorderState) -> Inside:
    """Working space for the states inside a step of a tree."""
    state = np.zeros((3, system.balance.size))
    prescribed = system.prescribed._replace(work=system.prescribed.work.copy())
    return Inside(
        system=system._replace(
            prescribed=prescribed,
            pace=system.pace.copy(),
            stages=np.zeros_like(system.stages),
            state=np.zeros_like(system.state),
            carried=np.zeros_like(system.carried),
            balance=np.zeros_like(system.balance),
        ),
        records=records._replace(contacts=records.contacts.copy(), torque=records.torque.copy()),
        start=state,
        state=state.copy(),
        bristles=np.zeros(len(records.contacts)),
    )


def _settings(accuracy: ExudynTree, longest: float) -> Any:
    settings = settings_of(longest, SHORTEST_STEP)
    integration = settings.timeIntegration
    integration.automaticStepSize = True
    integration.stepSizeMaxIncrease = 1e9  # growth is limited by next_tree_step
    # Exudyn's relative part takes the state with its sign; only an absolute one is sound.
    integration.absoluteTolerance = accuracy.tolerance
    integration.relativeTolerance = 0.0
    # The seventh stage of DOPRI5 already is the acceleration at the end of the step.
    integration.explicit.computeEndOfStepAccelerations = False
    integration.explicit.computeMassMatrixInversePerBody = False
    return settings


def _accelerations_at_start(model: TreeModel) -> Array:
    """Accelerations of the coordinates at t = 0, from one vanishing step of Exudyn's."""
    settings = settings_of(_INSTANT, _INSTANT)
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    x, u = np.array(model.x), np.array(model.u)
    with quiet():
        model.system.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitEuler)
    model.x[:], model.u[:] = x, u
    return np.array(model.u_t)


def _build(
    tree: Tree,
    linkage: Linkage,
    start: Start,
    system: TreeSystem,
    records: RecorderState,
    inside: Inside,
) -> tuple[TreeModel, Accept]:
    """The tree with its user function, and what accounts for a step and chooses the next."""
    packed, contacts = records.packed, records.contacts
    # Exudyn reads numbers one by one: they come faster out of an array of Python's own.
    out = array("d", bytes(8 * tree.size))
    filled, rates = np.frombuffer(out), np.zeros(len(contacts))

    def forces(mbs: Any, t: float, item: int, q: Any, q_t: Any) -> Any:
        # Reads the live state, known once the model is assembled, instead of Exudyn's copies.
        if stage(t) > MOST_CALLS:
            raise StuckError
        return out

    def bristly_forces(mbs: Any, *stage: Any) -> Any:
        contacts["bristle"] = model.bristles
        return forces(mbs, *stage)

    def bristle_rates(mbs: Any, t: float, item: int, z: Any) -> Array:
        # Once more a step than the forces, so that no account can be kept here.
        bristles(t)
        return rates

    is_bristly = bool((packed.joints["friction"]["bristle_stiffness"] > 0.0).any())
    functions = (bristly_forces, bristle_rates) if is_bristly else (forces,)
    model = assemble(tree, linkage, start, *functions)
    x, u = model.x, model.u
    stage = bind(stage_forces, system, records, x, u, model.u_t, filled)
    if is_bristly:
        arguments = system, packed, contacts.copy(), x, u, model.bristles, rates
        bristles = bind(stage_bristles, *arguments)
    end = bind(accept_tree_step, system, records, inside, x, u, model.u_t)
    at_start = _accelerations_at_start(model)
    first = bind(accept_tree_step, system, records, inside, x, u, at_start)
    system.pace["evaluations"] = 0

    def accept(t: float) -> float:
        if is_bristly:
            contacts["bristle"] = model.bristles
        return end(t) if t > 0.0 else first(t)

    return model, accept


def prepare(
    linkage: Linkage, start: Start, settings: ExudynTree, plan: Plan, recorder: Recorder
) -> Simulation:
    """Build the tree in a start; see ``Simulation``.

    Raises
    ------
    InputError
        Where the linkage is no open tree.
    """
    tree = tree_of(linkage)
    if isinstance(tree, str):
        raise InputError(f"engine exudyn-tree needs a linkage without free loops: {tree}")
    longest = settings.longest(plan.cycle)
    times: dict[str, float] = {}
    with timed(times, "wall_compile_s"):
        _warm_up(tree, linkage, start)
    with timed(times, "wall_build_s"):
        records = recorder.records
        system = system_of(tree, linkage, start, longest)
        inside = inside_of(system, records)
        model, accept = _build(tree, linkage, start, system, records, inside)
        counts = {"sent_back": "rejectedAutomaticStepSizeSteps"}
        solve = Solve.of(recorder, plan, counts, FIRST_STEP)
        limit = StepLimit(solve)
        model.system.SetPreStepUserFunction(limit.pre_step)
        model.system.SetPostStepUserFunction(post_step(solve, accept, limit.write))

    def energy() -> tuple[float, float]:
        q, v = system.state[0], system.state[1]
        stored = stored_energy(records.packed, records.memory["energy"], q, v)
        return stored, hinge_power_integral(system)

    bind(stage_forces, system, records, model.x, model.u, model.u_t, np.zeros(tree.size))(0.0)
    system.pace["evaluations"] = 0
    records.memory["energy"] = records.contacts["energy"]  # of pins that start pressed in
    stored_before, momentum_before = energy()
    exudyn = _settings(settings, longest)

    def advance(end: float) -> Finding | None:
        kind, live = exu.DynamicSolverType.DOPRI5, model.state()
        return run_to_end(model.system, live, exudyn, kind, solve, longest, end, REMEDY)

    def ledger() -> Ledger:
        stored, momentum = energy()
        sums = records.ledger[0].copy()
        sums["drive_work"] += momentum - momentum_before
        return Ledger.of(sums, stored - stored_before)

    def diagnostics() -> dict[str, float | int | str]:
        sums, pace = solve.sums, system.pace[0]
        words = f"open tree of {tree.size} coordinates ({listed(tree.names)})"
        return {
            "model": described(linkage, words, prescribed_of(linkage)),
            "solver": f"Exudyn DOPRI5 at tolerance {settings.tolerance:g}, "
            "steps end on touches and separations",
            "steps": int(sums["steps"]),
            "steps_sent_back": int(sums["sent_back"]),
            "evaluations": int(pace["evaluations"]),
            "events": int(pace["events"]),
            "deepest_touch_m": float(pace["deepest_touch"]),
            **times,
            "wall_solve_s": sums["wall"],
        }

    return Simulation(
        advance,
        lambda: (solve.time, system.state[0].copy(), system.state[1].copy()),
        ledger,
        {
            **model.state(),
            "expected": system.expected,
            "pace": system.pace,
            "state": system.state,
            "prescribed": system.prescribed.work,
            "step_start": inside.start,
            "bristles": inside.bristles,
        },
        solve.sums,
        diagnostics,
        REMEDY,
        close=model.container.Reset,
    )


def _warm_up(tree: Tree, linkage: Linkage, start: Start) -> None:
    """Compile every kernel, or load it from the cache, on a state thrown away."""
    records = Recorder.of(linkage, start.position, 1, 1.0).records
    system = system_of(tree, linkage, start, 1.0)
    x = np.zeros(tree.size)
    run = PackedArguments()
    run.arguments = system, records, inside_of(system, records), x, x, x
    specialised(accept_tree_step, run, 0.0)
    run = PackedArguments()
    run.arguments = system, records, x, x, x, x
    specialised(stage_forces, run, 0.0)
    specialised(hinge_power_integral, system)
