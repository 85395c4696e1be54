"""Exudyn with bodies and joints, implicit: any linkage.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and
every clearance joint one ``ObjectGenericODE2`` over the nodes of its two bodies: its
Python user function returns the exact generalized forces on both.  (A connector
between two markers cannot: it applies equal and opposite moments, while pin and
bearing have different radii.)

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

from presswear.clearance import joint_load
from presswear.compiled import Records, compiled
from presswear.energy import Ledger, stored_energy
from presswear.engines.base import Accuracy, Plan, Run, Start, Status, described
from presswear.linkage import GROUND, Attachment, Linkage
from presswear.observe import Account
from presswear.stepping import accept_step
from presswear.touch import shorter_step

Array = NDArray[np.float64]

END_TOLERANCE = 1e-10
"""Exudyn ends a run this close to its end time, s; a cycle is closed the same way."""

_PROGRESS_STEPS = 512


@compiled
def connector_force(
    joints: Records, k: int, onset: Array, surfaces: Array, q: Array, v: Array, out: Array
) -> None:
    """Generalized forces of clearance joint ``k`` on bearing body, then pin body; (6,)."""
    load = joint_load(joints, k, onset, surfaces, q, v)
    out[0] = -load.x
    out[1] = -load.y
    out[2] = load.bearing_moment
    out[3] = load.x
    out[4] = load.y
    out[5] = load.pin_moment


@dataclass
class _Model:
    """An assembled Exudyn system; the four views stay live during the solve."""

    container: Any
    system: Any
    q: Any
    v: Any
    a: Any
    multipliers: Any
    joints: dict[str, int]  # object number of each ideal joint and drive


def _assemble(linkage: Linkage, start: Start, account: Account) -> _Model:
    container = exu.SystemContainer()
    system = container.AddSystem()
    nodes, bodies = [], []
    for i, body in enumerate(linkage.bodies):
        # Reference coordinates are zero, so that coordinates are positions.
        node = system.AddNode(
            {
                "nodeType": "RigidBody2D",
                "referenceCoordinates": [0.0, 0.0, 0.0],
                "initialCoordinates": list(start.position[3 * i : 3 * i + 3]),
                "initialVelocities": list(start.velocity[3 * i : 3 * i + 3]),
            }
        )
        rigid = system.AddObject(
            {
                "objectType": "RigidBody2D",
                "mass": body.mass,
                "inertia": body.inertia,
                "nodeNumber": node,
            }
        )
        if linkage.gravity != 0.0:
            marker = system.AddMarker({"markerType": "BodyMass", "bodyNumber": rigid})
            system.AddLoad(
                {
                    "loadType": "MassProportional",
                    "markerNumber": marker,
                    "loadVector": [0.0, -linkage.gravity, 0.0],
                }
            )
        nodes.append(node)
        bodies.append(rigid)
    ground = system.AddObject({"objectType": "Ground"})

    def marker_at(point: Attachment) -> Any:
        owner = ground if point.body == GROUND else bodies[linkage.index(point.body)]
        return system.AddMarker(
            {
                "markerType": "BodyRigid",
                "bodyNumber": owner,
                "localPosition": [point.x, point.y, 0.0],
            }
        )

    constraints: dict[str, int] = {}
    for joint in linkage.revolutes:
        constraints[joint.name] = system.AddObject(
            {
                "objectType": "JointRevolute2D",
                "markerNumbers": [marker_at(joint.first), marker_at(joint.second)],
            }
        )
    for guide in linkage.guides:
        normal = guide.direction - guide.angle + 0.5 * math.pi
        constraints[guide.name] = system.AddObject(
            {
                "objectType": "JointPrismatic2D",
                "markerNumbers": [
                    marker_at(Attachment(GROUND, guide.x, guide.y)),
                    marker_at(Attachment(guide.body, 0.0, 0.0)),
                ],
                "axisMarker0": [math.cos(guide.direction), math.sin(guide.direction), 0.0],
                "normalMarker1": [math.cos(normal), math.sin(normal), 0.0],
                "constrainRotation": True,
            }
        )
    fixed = system.AddMarker(
        {
            "markerType": "NodeCoordinate",
            "nodeNumber": system.AddNode({"nodeType": "PointGround"}),
            "coordinate": 0,
        }
    )
    for drive in linkage.drives:
        turned = system.AddMarker(
            {
                "markerType": "NodeCoordinate",
                "nodeNumber": nodes[linkage.index(drive.body)],
                "coordinate": 2,
            }
        )
        # At velocity level; the trapezoidal rule integrates a constant speed exactly.
        constraints[drive.name] = system.AddObject(
            {
                "objectType": "ConnectorCoordinate",
                "markerNumbers": [fixed, turned],
                "velocityLevel": True,
                "offset": drive.speed,
            }
        )
    for spring in linkage.springs:
        system.AddObject(
            {
                "objectType": "ConnectorSpringDamper",
                "markerNumbers": [marker_at(spring.first), marker_at(spring.second)],
                "stiffness": spring.stiffness,
                "damping": spring.damping,
                "referenceLength": spring.length,
            }
        )
    for load in linkage.loads:
        at_centre = marker_at(Attachment(load.body, 0.0, 0.0))
        for kind, vector in (
            ("ForceVector", [load.x, load.y, 0.0]),
            ("TorqueVector", [0.0, 0.0, load.moment]),
        ):
            system.AddLoad({"loadType": kind, "markerNumber": at_centre, "loadVector": vector})
    model = _Model(container, system, None, None, None, None, constraints)
    for k, clearance in enumerate(linkage.clearances):
        ends = [clearance.bearing.body, clearance.pin.body]
        if GROUND in ends:
            raise ValueError(f"clearance joint {clearance.name}: both ends must be moving bodies")
        system.AddObject(
            {
                "objectType": "GenericODE2",
                "nodeNumbers": [nodes[linkage.index(body)] for body in ends],
                "forceUserFunction": _connector(account, k, model),
            }
        )
    system.Assemble()
    data = system.systemData
    model.q = data.GetODE2Coordinates(copy=False)
    model.v = data.GetODE2Coordinates_t(copy=False)
    model.a = data.GetODE2Coordinates_tt(copy=False)
    model.multipliers = data.GetAECoordinates(copy=False)
    return model


def _connector(account: Account, k: int, model: _Model) -> Callable[..., Array]:
    """User function of clearance joint ``k``: reads the live state, not its arguments."""
    joints, onset, surfaces = account.book.joints, account.book.onset, account.book.surfaces
    out = np.zeros(6)

    def force(system: Any, t: float, item: int, q: Any, v: Any) -> Array:
        connector_force(joints, k, onset, surfaces, model.q, model.v, out)
        return out

    return force


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
    model: _Model, account: Account, steps: Records, drives: Array, plan: Plan
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
    model = _assemble(linkage, start, account)
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
        reactions=_reactions(model, linkage),
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


def _reactions(model: _Model, linkage: Linkage) -> dict[str, tuple[float, ...]]:
    """Reactions at the end from Exudyn's multipliers, see ``Run``."""
    multipliers = {
        name: [float(model.multipliers[i]) for i in model.system.systemData.GetObjectLTGAE(number)]
        for name, number in model.joints.items()
    }
    found: dict[str, tuple[float, ...]] = {}
    for joint in linkage.revolutes:
        # Exudyn's revolute is second point less first, and the signs follow.
        found[joint.name] = (multipliers[joint.name][0], multipliers[joint.name][1])
    for guide in linkage.guides:
        normal, moment = multipliers[guide.name]
        i = 3 * linkage.index(guide.body)
        along = (model.q[i] - guide.x) * math.cos(guide.direction) + (
            model.q[i + 1] - guide.y
        ) * math.sin(guide.direction)
        # Exudyn's moment is about the guide's point on the frame.
        found[guide.name] = (-normal, -moment - normal * float(along))
    for drive in linkage.drives:
        found[drive.name] = (-multipliers[drive.name][0],)
    return found


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
