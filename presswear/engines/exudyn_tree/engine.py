"""Exudyn with an open tree in minimal coordinates, explicit and error-controlled.

For linkages in which the clearance joints cut every loop that has a freedom.  The tree's inertia,
gyroscopic terms and the integration (DOPRI5) are Exudyn's; its Python user function
hands the live state to one compiled kernel, which gives the forces of all contacts,
weights and moving hinges at once.  Contact state changes only between accepted
steps, and steps end where a pin touches or leaves.
"""

import math
import time as clock
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np

from presswear.engines.base import Plan, Start, described, listed
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import Solver, StuckError, add, quiet, settings_of
from presswear.engines.exudyn_tree.kernels import (
    PACE,
    STAGES,
    TreeSystem,
    accept_tree_step,
    hinge_power_integral,
    stage_bristles,
    stage_forces,
    tree_state,
)
from presswear.engines.settings import FINEST, ExudynTree
from presswear.linkage.elements import Body
from presswear.linkage.linkage import Linkage, prescribed_of
from presswear.physics.forces import JOINT_RATES, Ledger, stored_energy
from presswear.physics.prescribed import Tree, begin_motion, tree_of
from presswear.physics.tree import CARRIED, COORDINATES, GUIDED, LOOSE
from presswear.recording.recorder import Recorder
from presswear.tools.arrays import Array
from presswear.tools.compile import bind
from presswear.tools.errors import InputError
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()

SHORTEST_STEP = 1e-13  # s
FIRST_STEP = 1e-7  # s
# Calls for forces without an accepted step after which there is no way on: a thousand steps sent
# back, where thirty reach the shortest.  Exudyn would repeat that one for ever.
MOST_CALLS = 7000
_INSTANT = 1e-12  # length of the step that asks Exudyn for the accelerations at the start, s


def _turned(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def add_tree(
    system: Any, tree: Tree, linkage: Linkage, start: Start, forces: Callable[..., Any]
) -> None:
    """Add a kinematic tree to a system, with a user function for the forces on its coordinates."""
    x, u = tree.coordinates(start.position, start.velocity)
    node = add(
        system,
        "Node",
        "GenericODE2",
        referenceCoordinates=[0.0] * tree.size,
        initialCoordinates=list(x),
        initialCoordinates_t=list(u),
        numberOfODE2Coordinates=tree.size,
    )
    kinds, still = exu.JointType, np.zeros(2)
    # Of each link of Exudyn's: joint, parent, turn and offset of the joint, mass centre, body
    links: list[tuple[Any, int, float, Array, Array, Body | None]] = []
    last = [int(link["place"]) + COORDINATES[link["kind"]] - 1 for link in tree.links]
    for link, name in zip(tree.links, tree.names, strict=True):
        # A link's frame sits in its joint, along the body's axes or along its guide.
        kind, parent, turn, offset = kinds.RevoluteZ, -1, 0.0, still
        if link["kind"] == GUIDED:
            kind, turn = kinds.PrismaticX, math.atan2(link["sine"], link["cosine"])
        elif link["kind"] == LOOSE:
            # Two links without mass carry it across the plane.
            links.append((kinds.PrismaticX, -1, 0.0, still, still, None))
            links.append((kinds.PrismaticY, len(links) - 1, 0.0, still, still, None))
            parent = len(links) - 1
        elif link["parent"] >= 0:
            before, parent = tree.links[link["parent"]], last[link["parent"]]
            offset = np.array([link["before_x"], link["before_y"]])
            offset -= [before["own_x"], before["own_y"]]
            if before["kind"] == GUIDED:
                turn = before["angle"] - math.atan2(before["sine"], before["cosine"])
                offset = _turned(turn)[:2, :2] @ offset
        centre = -np.array([link["own_x"], link["own_y"]])
        links.append((kind, parent, turn, offset, centre, linkage.bodies[linkage.index(name)]))
    types, parents, turns, offsets, centres, bodies = zip(*links, strict=True)
    inertias = [body.effective_inertia if body else 0.0 for body in bodies]
    add(
        system,
        "Object",
        "KinematicTree",
        nodeNumber=node,
        jointTypes=list(types),
        linkParents=list(parents),
        jointTransformations=exu.Matrix3DList([_turned(turn) for turn in turns]),
        jointOffsets=exu.Vector3DList([[*offset, 0.0] for offset in offsets]),
        linkInertiasCOM=exu.Matrix3DList([np.diag([0.0, 0.0, inertia]) for inertia in inertias]),
        linkCOMs=exu.Vector3DList([[*centre, 0.0] for centre in centres]),
        linkMasses=[body.mass if body else 0.0 for body in bodies],
        forceUserFunction=forces,
    )


def system_of(
    tree: Tree, joints: int, start: Start, longest: float, live: tuple[Array, Array, Array]
) -> TreeSystem:
    """Pack a tree in a start for the kernels.

    Parameters
    ----------
    longest : float
        Longest step, s.
    live : tuple of ndarray
        Exudyn's live coordinates, rates and accelerations.
    """
    prescribed = tree.prescribed._replace(work=tree.prescribed.work.copy())
    begin_motion(prescribed, 0.0, start.position)
    pace = np.zeros(1, PACE)
    pace["longest"] = longest
    pace["shortest"] = SHORTEST_STEP
    pace["reach"] = pace["limit"] = FIRST_STEP
    pace["noted"] = np.nan
    return TreeSystem(
        tree.links,
        prescribed,
        *live,
        force=np.zeros(tree.size),
        expected=np.zeros(joints),
        pace=pace,
        stages=np.zeros((STAGES, 2 + JOINT_RATES * joints)),
        state=np.zeros((5, start.position.size)),
        carried=np.zeros((len(tree.links), CARRIED)),
        balance=np.zeros(tree.size),
        start=np.zeros((3, tree.size)),
        inside=np.zeros((3, tree.size)),
        bristles=np.zeros((2, joints)),
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


def _accelerations_at_start(mbs: Any, system: TreeSystem) -> Array:
    """Return the accelerations of the coordinates at t = 0, from one vanishing step of Exudyn's."""
    settings = settings_of(_INSTANT, _INSTANT)
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    x, u = np.array(system.x), np.array(system.u)
    with quiet():
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitEuler)
    system.x[:], system.u[:] = x, u
    return np.array(system.u_t)


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
    finer, remedy = settings.tolerance / 10.0, "engine = dae may help"
    if finer >= FINEST:
        remedy = f"set a smaller tree_tolerance, for example {finer:.3g}"
    records = recorder.records
    packed, contacts = records.packed, records.contacts
    is_bristly = bool((packed.joints["friction"]["bristle_stiffness"] > 0.0).any())
    # Exudyn reads numbers one by one: they come faster out of an array of Python's own.
    out, rates = array("d", bytes(8 * tree.size)), np.zeros(len(contacts))

    # The user functions read the live state, bound below, instead of Exudyn's copies.
    def forces(mbs: Any, t: float, item: int, q: Any, q_t: Any) -> Any:
        if stage(t) > MOST_CALLS:
            raise StuckError
        return out

    def bristly_forces(mbs: Any, *stage: Any) -> Any:
        contacts["bristle"] = deflections
        return forces(mbs, *stage)

    def bristle_rates(mbs: Any, t: float, item: int, z: Any) -> Array:
        # Once more a step than the forces, so that no account can be kept here.
        bristles(t)
        return rates

    def accept(t: float) -> float:
        if is_bristly:
            contacts["bristle"] = deflections
        return end(t) if t > 0.0 else first(t)

    # Compiling, or loading what was compiled, is part of building the model.
    began = clock.perf_counter()
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    add_tree(mbs, tree, linkage, start, bristly_forces if is_bristly else forces)
    if is_bristly:
        node = add(
            mbs,
            "Node",
            "GenericODE1",
            referenceCoordinates=[0.0] * len(contacts),
            initialCoordinates=[0.0] * len(contacts),
            numberOfODE1Coordinates=len(contacts),
        )
        # Exudyn calls for their rates first.
        add(mbs, "Object", "GenericODE1", nodeNumbers=[node], rhsUserFunction=bristle_rates)
    mbs.Assemble()
    names = ("ODE2Coordinates", "ODE2Coordinates_t", "ODE2Coordinates_tt", "ODE1Coordinates")
    *live, deflections = (getattr(mbs.systemData, f"Get{name}")(copy=False) for name in names)
    system = system_of(tree, len(contacts), start, longest, (live[0], live[1], live[2]))
    system.pace["parts"] = settings.impact_steps
    system = system._replace(force=np.frombuffer(out))
    stage = bind(stage_forces, system, records)
    if is_bristly:
        bristles = bind(stage_bristles, system, packed, contacts.copy(), deflections, rates)
    end = bind(accept_tree_step, system, records)
    at_start = system._replace(u_t=_accelerations_at_start(mbs, system))
    first = bind(accept_tree_step, at_start, records)
    solver = Solver(
        recorder,
        plan,
        accept,
        exu.DynamicSolverType.DOPRI5,
        _settings(settings, longest),
        longest,
        remedy,
        {"sent_back": "rejectedAutomaticStepSizeSteps"},
    )
    solver.sums["proposed"] = FIRST_STEP
    solver.install(mbs)
    built = clock.perf_counter() - began

    def energy() -> tuple[float, float]:
        q, v = system.state[0], system.state[1]
        stored = stored_energy(packed, records.memory["energy"], q, v)
        return stored, hinge_power_integral(system)

    stage(0.0)
    system.pace["evaluations"] = 0
    records.memory["energy"] = contacts["energy"]  # of pins that start pressed in
    stored_before, momentum_before = energy()
    state = dict(zip(names[:2], live, strict=False))
    if is_bristly:
        state[names[3]] = deflections

    def ledger() -> Ledger:
        stored, momentum = energy()
        sums = records.ledger[0].copy()
        sums["drive_work"] += momentum - momentum_before
        return Ledger.of(sums, stored - stored_before)

    def diagnostics() -> dict[str, float | int | str]:
        pace = system.pace[0]
        words = f"open tree of {tree.size} coordinates ({listed(tree.names)})"
        return {
            "model": described(linkage, words, prescribed_of(linkage)),
            "solver": f"Exudyn DOPRI5 at tolerance {settings.tolerance:g}, "
            "steps end on touches and separations",
            "steps": int(solver.sums["steps"]),
            "steps_sent_back": int(solver.sums["sent_back"]),
            "evaluations": int(pace["evaluations"]),
            "events": int(pace["events"]),
            "deepest_touch_m": float(pace["deepest_touch"]),
            "wall_build_s": built,
            "wall_solve_s": solver.sums["wall"],
        }

    def positions() -> tuple[float, Array, Array]:
        if not np.isfinite(system.state[:2]).all():
            # A run that failed ends with the state before its last step.
            tree_state(system, records, solver.time, *system.start)
        return solver.time, system.state[0].copy(), system.state[1].copy()

    arrays = {name: np.asarray(array) for name, array in state.items()}
    arrays |= {name: getattr(system, name) for name in ("expected", "pace", "state", "bristles")}
    arrays |= {"prescribed": system.prescribed.work, "step_start": system.start}
    return Simulation(
        lambda until: solver.run(mbs, state, until),
        positions,
        ledger,
        arrays,
        solver.sums,
        diagnostics,
        remedy,
        close=container.Reset,
    )
