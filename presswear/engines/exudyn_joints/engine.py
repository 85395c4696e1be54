"""Exudyn with bodies and joints, implicit: any linkage.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and
all clearance joints, and all loads with a law, are one ``ObjectGenericODE2`` over the nodes of
their bodies: its Python user function returns the exact generalized forces on all of them.
(A connector between two markers cannot: it applies equal and opposite moments, while
pin and bearing have different radii.)  Bodies without freedom that only clearance joints
hold on to are left out: their motion is prescribed, and the torques of their drives follow from
the contact forces.

Contact state changes only between accepted steps, in ``PostStep``; the user
functions are pure.  The same call chooses the next step and writes it into the
running solver; ``PostNewton`` sends back a step that ran too far past a touchdown.
"""

import math
import time as clock
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np

from presswear.engines.base import Plan, Start, described
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import Solver, add, settings_of
from presswear.engines.exudyn_joints.kernels import (
    Drives,
    Frame,
    Friction,
    Indices,
    accept_joint_step,
    begin_friction,
    connector_forces,
    refresh,
    shorter_joint_step,
)
from presswear.engines.settings import ExudynJoints
from presswear.linkage.elements import GROUND, Attachment, Bushing
from presswear.linkage.linkage import Linkage, bodies_of, prescribed_of
from presswear.linkage.loads import OverPosition
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.drive_motion import drive_motion, is_steady
from presswear.physics.forces import JOINT_RATES, Ledger, stored_energy
from presswear.physics.packed import Packed, spring_period
from presswear.physics.prescribed import begin_motion, pack_prescribed
from presswear.physics.step_length import STEPS
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, bind
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()

REMEDY = "more steps_per_contact, or engine = dae, may help"  # advice that makes a run finer

# Where rigid joints have friction: most iterations of a step, smallest tolerance
NEWTON_STEPS, LEAST_NEWTON = 50, 1e-10
SPRING_STEPS = 100  # fewest steps in the period of a body on its spring

# Names that Exudyn gives to coordinates, rates, accelerations and multipliers
_SOLVED = ("ODE2Coordinates", "ODE2Coordinates_t", "ODE2Coordinates_tt", "AECoordinates")


def left_out(linkage: Linkage) -> frozenset[str]:
    """Return the prescribed bodies that only clearance joints connect to the others.

    Joints with friction stay, because the friction needs their forces.
    """
    omitted = prescribed_of(linkage)
    if len(omitted) == len(linkage.bodies):
        return frozenset()
    omitted -= {end.body for spring in linkage.springs for end in spring.ends}
    omitted -= frozenset[str]().union(*map(bodies_of, linkage.rubbing_pins))
    while True:
        joined = [bodies_of(joint) for joint in linkage.joints]
        held = frozenset[str]().union(*(bodies for bodies in joined if not bodies <= omitted))
        if not held & omitted:
            return omitted
        omitted -= held


def add_bodies(
    system: Any, linkage: Linkage, start: Start, omitted: frozenset[str]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Add the bodies in their initial state; returns nodes and objects by body name."""
    nodes: dict[str, Any] = {}
    bodies: dict[str, Any] = {GROUND: add(system, "Object", "Ground")}
    for i, body in enumerate(linkage.bodies):
        if body.name in omitted:
            continue
        # Reference coordinates are zero, so that coordinates are positions.
        nodes[body.name] = node = add(
            system,
            "Node",
            "RigidBody2D",
            referenceCoordinates=[0.0, 0.0, 0.0],
            initialCoordinates=list(start.position[3 * i : 3 * i + 3]),
            initialVelocities=list(start.velocity[3 * i : 3 * i + 3]),
        )
        inertia = body.effective_inertia
        bodies[body.name] = rigid = add(
            system, "Object", "RigidBody2D", mass=body.mass, inertia=inertia, nodeNumber=node
        )
        if linkage.gravity != 0.0:
            marker = add(system, "Marker", "BodyMass", bodyNumber=rigid)
            weight = [0.0, -linkage.gravity, 0.0]
            add(system, "Load", "MassProportional", markerNumber=marker, loadVector=weight)
    return nodes, bodies


def add_joints(
    system: Any,
    linkage: Linkage,
    motions: Records,
    omitted: frozenset[str],
    nodes: dict[str, Any],
    bodies: dict[str, Any],
) -> dict[str, int]:
    """Add ideal joints, drives, springs and constant loads.

    Returns the object numbers of joints and drives by name.
    """

    def marker_at(point: Attachment) -> Any:
        place = [point.x, point.y, 0.0]
        return add(
            system, "Marker", "BodyRigid", bodyNumber=bodies[point.body], localPosition=place
        )

    objects: dict[str, int] = {}
    for joint in linkage.revolutes:
        if not bodies_of(joint) <= omitted:
            markers = [marker_at(joint.first), marker_at(joint.second)]
            objects[joint.name] = add(system, "Object", "JointRevolute2D", markerNumbers=markers)
    for guide in linkage.guides:
        if guide.body in omitted:
            continue
        normal = guide.direction - guide.angle + 0.5 * math.pi
        on_frame = marker_at(Attachment(GROUND, guide.x, guide.y))
        objects[guide.name] = add(
            system,
            "Object",
            "JointPrismatic2D",
            markerNumbers=[on_frame, marker_at(Attachment(guide.body, 0.0, 0.0))],
            axisMarker0=[math.cos(guide.direction), math.sin(guide.direction), 0.0],
            normalMarker1=[math.cos(normal), math.sin(normal), 0.0],
            constrainRotation=True,
        )
    still = add(system, "Node", "PointGround")
    fixed = add(system, "Marker", "NodeCoordinate", nodeNumber=still, coordinate=0)
    for drive, motion in zip(linkage.drives, motions, strict=True):
        if drive.body in omitted:
            continue
        turned = add(system, "Marker", "NodeCoordinate", nodeNumber=nodes[drive.body], coordinate=2)
        # At velocity level; the trapezoidal rule integrates a constant speed exactly, and what it
        # makes of another is put right behind each step (``kernels.hold``).
        turning: dict[str, Any] = {"offset": drive.speed}
        if not is_steady(linkage, drive):
            turning = {"offset": 0.0, "offsetUserFunction_t": _speed_function(motion)}
        objects[drive.name] = add(
            system,
            "Object",
            "ConnectorCoordinate",
            markerNumbers=[fixed, turned],
            velocityLevel=True,
            **turning,
        )
    for spring in linkage.springs:
        add(
            system,
            "Object",
            "ConnectorSpringDamper",
            markerNumbers=[marker_at(end) for end in spring.ends],
            stiffness=spring.stiffness,
            damping=spring.damping,
            referenceLength=spring.length,
        )
    for load in linkage.dead_loads:
        if load.body not in omitted:
            at = marker_at(Attachment(load.body, 0.0, 0.0))
            add(system, "Load", "ForceVector", markerNumber=at, loadVector=[load.x, load.y, 0.0])
            add(system, "Load", "TorqueVector", markerNumber=at, loadVector=[0.0, 0.0, load.moment])
    return objects


def _speed_function(motion: Records) -> Callable[..., float]:
    """Return the function that Exudyn calls for the speed of a drive."""
    return lambda system, t, item, offset: drive_motion(motion, t)[1]


def frame_of(
    linkage: Linkage,
    start: Start,
    omitted: frozenset[str],
    solved: list[Any],
    friction: Friction | None,
) -> Frame:
    """Return the coordinates of all bodies from Exudyn's live coordinates and derivatives."""
    prescribed = pack_prescribed(linkage, omitted)
    begin_motion(prescribed, 0.0, start.position)
    count = 3 * len(linkage.bodies)
    places = [
        3 * i + c
        for i, body in enumerate(linkage.bodies)
        for c in range(3)
        if omitted and body.name not in omitted
    ]
    q, v, a = solved
    if omitted:
        q, v, a = np.array(start.position), np.array(start.velocity), np.zeros(count)
    contacts = np.zeros(len(linkage.clearances), CONTACT)
    rows = np.array(places, np.int64)
    live = solved[0], solved[1], solved[2]
    return Frame(*live, rows, prescribed, q, v, a, np.zeros(count), contacts, friction)


def _settings(accuracy: ExudynJoints, longest: float, rubs: bool) -> Any:
    settings = settings_of(longest, 0.1 * accuracy.least_step)
    integration = settings.timeIntegration
    # Steps are chosen by accept_joint_step; Exudyn must not lengthen them behind its back.
    integration.adaptiveStepRecoverySteps = 2**30
    integration.newton.relativeTolerance = accuracy.newton
    integration.newton.absoluteTolerance = accuracy.newton
    integration.newton.modifiedNewtonContractivity = 0.01
    if rubs:
        # No Jacobian knows how friction depends on joint forces: convergence is linear, and ends
        # at the round-off of the joint forces.
        tolerance = max(accuracy.newton, LEAST_NEWTON)
        integration.newton.relativeTolerance = tolerance
        integration.newton.absoluteTolerance = tolerance
        integration.newton.maxIterations = NEWTON_STEPS
        integration.newton.maxModifiedNewtonIterations = NEWTON_STEPS
        integration.newton.maxModifiedNewtonRestartIterations = NEWTON_STEPS
    return settings


def _drives(
    system: Any, linkage: Linkage, objects: dict[str, int], multipliers: Any, mass: Array
) -> Drives:
    """Return the sources of the drive torques, with the projection where it is needed."""
    number = system.systemData.GetObjectLTGAE
    names = [drive.name for drive in linkage.drives]
    rows = [number(objects[name])[0] if name in objects else -1 for name in names]
    modelled = [drive for drive in linkage.drives if drive.name in objects]
    are_steady = all(is_steady(linkage, drive) for drive in modelled)
    # Behind the short step to a bend in a load the accelerations would swing about the right ones.
    bends = any(isinstance(load.law, OverPosition) for load in linkage.live_loads)
    return Drives(
        multiplier=np.array(rows, np.int64),
        multipliers=multipliers,
        force=np.zeros(3 * len(linkage.bodies)),
        rates=np.zeros(JOINT_RATES * len(linkage.clearances)),
        held=None if are_steady and not bends else constraints_of(linkage).held(mass),
    )


def _friction(
    system: Any,
    linkage: Linkage,
    objects: dict[str, int],
    slots: Indices,
    multipliers: Any,
    packed: Packed,
) -> Friction | None:
    """Return the friction in rigid joints; ``slots`` are those of their bearings and pins."""
    if packed.rubbing is None:
        return None
    number, names = system.systemData.GetObjectLTGAE, [one.name for one in linkage.rubbing_pins]
    rows = np.array([number(objects[name])[0] for name in names], np.int64)
    return Friction(packed.rubbing, rows, slots, multipliers)


def prepare(
    linkage: Linkage, start: Start, settings: ExudynJoints, plan: Plan, recorder: Recorder
) -> Simulation:
    """Build the bodies and joints in a start; see ``Simulation``."""
    longest = min(settings.longest(plan.cycle), spring_period(linkage) / SPRING_STEPS)
    steps = np.zeros(1, STEPS)
    steps["free"], steps["least"] = longest, settings.least_step
    steps["per_contact"], steps["sustained"] = settings.steps_per_contact, settings.steps_sustained
    records, omitted = recorder.records, left_out(linkage)
    joints: list[Bushing] = [*linkage.clearances, *linkage.rubbing_pins]
    ends = [end.body for joint in joints for end in (joint.bearing, joint.pin)]
    loaded = [load.body for load in linkage.live_loads]
    joined = [name for name in dict.fromkeys(ends + loaded) if name not in {GROUND, *omitted}]
    slots = [3 * joined.index(name) if name in joined else -1 for name in ends]
    places = [3 * linkage.index(name) + c for name in joined for c in range(3)]
    # Exudyn reads numbers one by one: they come faster out of an array of Python's own.
    out = array("d", bytes(8 * len(places)))

    # The user functions read the live state, bound below, instead of Exudyn's copies.
    def forces(system: Any, t: float, item: int, q: Any, v: Any) -> Any:
        fill(t)
        return out

    def send_back(system: Any, t: float) -> list[float]:
        shorter_step = shorter(t)
        if shorter_step < 0.0:
            return [0.0, -1.0]
        solver.sums["sent_back"] += 1.0
        return [2.0, shorter_step]

    # Compiling, or loading what was compiled, is part of building the model.
    began = clock.perf_counter()
    container = exu.SystemContainer()
    system = container.AddSystem()
    nodes, bodies = add_bodies(system, linkage, start, omitted)
    objects = add_joints(system, linkage, records.motions, omitted, nodes, bodies)
    if joined:
        numbers = [nodes[name] for name in joined]
        add(system, "Object", "GenericODE2", nodeNumbers=numbers, forceUserFunction=forces)
    system.Assemble()
    solved = [getattr(system.systemData, f"Get{name}")(copy=False) for name in _SOLVED]
    room = np.array(slots, np.int64).reshape(-1, 2)
    loose, rubbing = np.split(room, [len(linkage.clearances)])
    friction = _friction(system, linkage, objects, rubbing, solved[3], records.packed)
    frame = frame_of(linkage, start, omitted, solved[:3], friction)
    drives = _drives(system, linkage, objects, solved[3], records.packed.mass)
    solver = Solver(
        recorder,
        plan,
        bind(accept_joint_step, frame, drives, records, steps),
        exu.DynamicSolverType.TrapezoidalIndex2,
        _settings(settings, longest, rubs=friction is not None),
        longest,
        REMEDY,
        {"newton": "newtonStepsCount", "jacobians": "newtonJacobiCount"},
    )
    solver.install(system)
    if joined:
        where = loose, np.array(places, np.int64)
        arguments = frame, records, *where, np.zeros_like(drives.force), np.frombuffer(out)
        fill = bind(connector_forces, *arguments)
        shorter = bind(shorter_joint_step, frame, records, steps)
        system.SetPostNewtonUserFunction(send_back)
    built = clock.perf_counter() - began
    note_contacts(records.packed, records.contacts, start.position, start.velocity)
    if friction is not None:
        held = constraints_of(linkage).held(records.packed.mass)
        begin_friction(friction, held, records, drives, start.position, start.velocity)
    energies = records.memory["energy"]
    energies[:] = records.contacts["energy"]  # of pins that start pressed in
    before = stored_energy(records.packed, energies, start.position, start.velocity)

    def advance(end: float) -> Finding | None:
        # Exudyn's own are those of even drives; a cycle goes on with what the last one ended with.
        compute = drives.held is None or solver.time == 0.0
        integration = solver.settings.timeIntegration
        integration.generalizedAlpha.computeInitialAccelerations = compute
        return solver.run(system, dict(zip(_SOLVED, solved, strict=True)), end)

    def state() -> tuple[float, Array, Array]:
        if not (np.isfinite(frame.q).all() and np.isfinite(frame.v).all()):
            # A run that failed ends with the state before its last step.
            for name, values in zip(_SOLVED[:3], solved, strict=False):
                get = getattr(system.systemData, f"Get{name}")
                values[:] = get(exu.ConfigurationType.StartOfStep)
            refresh(frame, solver.time)
        return solver.time, np.array(frame.q), np.array(frame.v)

    def ledger() -> Ledger:
        stored = stored_energy(records.packed, energies, *state()[1:])
        return Ledger.of(records.ledger[0], stored - before)

    def diagnostics() -> dict[str, float | int | str]:
        words = f"{len(nodes)} bodies, {len(objects)} joints and drives"
        return {
            "model": described(linkage, words, omitted),
            "solver": "Exudyn trapezoidal index 2, step chosen by contact state",
            "steps": int(solver.sums["steps"]),
            "steps_sent_back": int(solver.sums["sent_back"]),
            "newton_iterations": int(solver.sums["newton"]),
            "jacobians": int(solver.sums["jacobians"]),
            "wall_build_s": built,
            "wall_solve_s": solver.sums["wall"],
        }

    arrays = dict(zip(("q", "v", "a", "multipliers"), solved, strict=True))
    arrays["force"] = drives.force
    if omitted:
        arrays |= {"all_q": frame.q, "all_v": frame.v, "all_a": frame.a, "axes": frame.axes}
        arrays["prescribed"] = frame.prescribed.work
    return Simulation(
        advance,
        state,
        ledger,
        {name: np.asarray(array) for name, array in arrays.items()},
        solver.sums,
        diagnostics,
        REMEDY,
        constraints_of(linkage),
        close=container.Reset,
    )
