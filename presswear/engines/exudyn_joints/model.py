"""A linkage as an Exudyn system of rigid bodies, joints and connectors.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and
all clearance joints, and all loads with a law, are one ``ObjectGenericODE2`` over the nodes of
their bodies: its Python user function returns the exact generalized forces on all of them.
(A connector between two markers cannot: it applies equal and opposite moments, while
pin and bearing have different radii.)  Bodies without freedom that only clearance joints
hold on to are left out: their motion is known, and the torques of their drives follow from
the contact forces.
"""

import math
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.engines.exudyn import add_load, add_marker, add_node, add_object
from presswear.engines.exudyn_joints.kernels import Frame, Live, connector_forces
from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage, bodies_of, joints_of, prescribed_of
from presswear.physics.contact import CONTACT
from presswear.physics.drive_motion import drive_motion, is_steady
from presswear.physics.prescribed import begin_motion, pack_prescribed
from presswear.recording.recorder import Recorder
from presswear.tools.compile import Records, bind
from presswear.tools.exudyn import exudyn_module

Array = NDArray[np.float64]

exu = exudyn_module()


# Names that Exudyn gives to what it solves for.
SOLVED = ("ODE2Coordinates", "ODE2Coordinates_t", "ODE2Coordinates_tt", "AECoordinates")


@dataclass(frozen=True)
class JointsModel:
    """An assembled Exudyn system; the views of ``frame`` stay live during the solve."""

    container: Any
    system: Any
    joints: dict[str, int]  # object number of each ideal joint and drive
    solved: tuple[Any, ...]  # live coordinates, rates, accelerations and multipliers
    frame: Frame

    def state(self) -> dict[str, Array]:
        """The live arrays that hold the state between two solves."""
        frame = self.frame
        arrays = dict(zip(("q", "v", "a", "multipliers"), self.solved, strict=True))
        if frame.places.size:
            arrays |= {"all_q": frame.q, "all_v": frame.v, "all_a": frame.a, "axes": frame.axes}
            arrays["prescribed"] = frame.prescribed.work
        return {name: np.asarray(array) for name, array in arrays.items()}


def _speed_function(motion: Records) -> Callable[..., float]:
    """The function that Exudyn calls for the speed of a drive."""
    return lambda system, t, item, offset: drive_motion(motion, t)[1]


def left_out(linkage: Linkage) -> frozenset[str]:
    """Return the prescribed bodies that only clearance joints connect to the others."""
    omitted = prescribed_of(linkage)
    if len(omitted) == len(linkage.bodies):
        return frozenset()
    omitted -= {end.body for spring in linkage.springs for end in spring.ends}
    while True:
        joined = [bodies_of(joint) for joint in joints_of(linkage)]
        held = frozenset[str]().union(*(bodies for bodies in joined if not bodies <= omitted))
        if not held & omitted:
            return omitted
        omitted -= held


def assemble(linkage: Linkage, start: Start, recorder: Recorder) -> JointsModel:
    """Build and assemble the Exudyn system of a linkage in its initial state."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    omitted = left_out(linkage)
    nodes: dict[str, Any] = {}
    bodies: dict[str, Any] = {GROUND: add_object(system, "Ground")}
    for i, body in enumerate(linkage.bodies):
        if body.name in omitted:
            continue
        # Reference coordinates are zero, so that coordinates are positions.
        node = add_node(
            system,
            "RigidBody2D",
            referenceCoordinates=[0.0, 0.0, 0.0],
            initialCoordinates=list(start.position[3 * i : 3 * i + 3]),
            initialVelocities=list(start.velocity[3 * i : 3 * i + 3]),
        )
        rigid = add_object(
            system,
            "RigidBody2D",
            mass=body.mass,
            inertia=body.effective_inertia,
            nodeNumber=node,
        )
        if linkage.gravity != 0.0:
            marker = add_marker(system, "BodyMass", bodyNumber=rigid)
            weight = [0.0, -linkage.gravity, 0.0]
            add_load(system, "MassProportional", markerNumber=marker, loadVector=weight)
        nodes[body.name] = node
        bodies[body.name] = rigid

    def marker_at(point: Attachment) -> Any:
        place = [point.x, point.y, 0.0]
        return add_marker(system, "BodyRigid", bodyNumber=bodies[point.body], localPosition=place)

    constraints: dict[str, int] = {}
    for joint in linkage.revolutes:
        if bodies_of(joint) <= omitted:
            continue
        markers = [marker_at(joint.first), marker_at(joint.second)]
        constraints[joint.name] = add_object(system, "JointRevolute2D", markerNumbers=markers)
    for guide in linkage.guides:
        if guide.body in omitted:
            continue
        normal = guide.direction - guide.angle + 0.5 * math.pi
        on_frame = marker_at(Attachment(GROUND, guide.x, guide.y))
        constraints[guide.name] = add_object(
            system,
            "JointPrismatic2D",
            markerNumbers=[on_frame, marker_at(Attachment(guide.body, 0.0, 0.0))],
            axisMarker0=[math.cos(guide.direction), math.sin(guide.direction), 0.0],
            normalMarker1=[math.cos(normal), math.sin(normal), 0.0],
            constrainRotation=True,
        )
    still = add_node(system, "PointGround")
    fixed = add_marker(system, "NodeCoordinate", nodeNumber=still, coordinate=0)
    for place, drive in enumerate(linkage.drives):
        if drive.body in omitted:
            continue
        turned = add_marker(system, "NodeCoordinate", nodeNumber=nodes[drive.body], coordinate=2)
        # At velocity level; the trapezoidal rule integrates a constant speed exactly, and what it
        # makes of another is put right behind each step (``kernels.hold``).
        turning: dict[str, Any] = {"offset": drive.speed}
        if not is_steady(linkage, drive):
            speed = _speed_function(recorder.records.motions[place])
            turning = {"offset": 0.0, "offsetUserFunction_t": speed}
        markers = [fixed, turned]
        constraints[drive.name] = add_object(
            system, "ConnectorCoordinate", markerNumbers=markers, velocityLevel=True, **turning
        )
    for spring in linkage.springs:
        add_object(
            system,
            "ConnectorSpringDamper",
            markerNumbers=[marker_at(end) for end in spring.ends],
            stiffness=spring.stiffness,
            damping=spring.damping,
            referenceLength=spring.length,
        )
    for load in linkage.dead_loads:
        if load.body in omitted:
            continue
        at_centre = marker_at(Attachment(load.body, 0.0, 0.0))
        force, torque = [load.x, load.y, 0.0], [0.0, 0.0, load.moment]
        add_load(system, "ForceVector", markerNumber=at_centre, loadVector=force)
        add_load(system, "TorqueVector", markerNumber=at_centre, loadVector=torque)
    ends = [end.body for joint in linkage.clearances for end in (joint.bearing, joint.pin)]
    loaded = [load.body for load in linkage.live_loads]
    joined = tuple(name for name in dict.fromkeys(ends + loaded) if name in nodes)
    places = [3 * joined.index(name) if name in joined else -1 for name in ends]
    slots = np.array(places, dtype=np.int64).reshape(-1, 2)
    records = recorder.records
    packed, onset, memory = records.packed, records.onset, records.memory
    # Exudyn reads numbers one by one: they come faster out of an array of Python's own.
    out = array("d", bytes(8 * 3 * len(joined)))
    first = [3 * linkage.index(name) for name in joined]
    owned = np.array([place + c for place in first for c in range(3)], np.int64)
    live = Live(owned, np.zeros(3 * len(linkage.bodies)))

    def forces(system: Any, t: float, item: int, q: Any, v: Any) -> Any:
        # Reads the live state, known once all is assembled, instead of Exudyn's copies.
        fill(t)
        return out

    if joined:
        numbers = [nodes[name] for name in joined]
        add_object(system, "GenericODE2", nodeNumbers=numbers, forceUserFunction=forces)
    system.Assemble()
    data = system.systemData
    solved = tuple(getattr(data, f"Get{name}")(copy=False) for name in SOLVED)
    frame = _frame(solved[:3], linkage, start, omitted)
    if joined:
        arguments = frame, packed, live, slots, onset, memory, np.frombuffer(out)
        fill = bind(connector_forces, *arguments)
    return JointsModel(container, system, constraints, solved, frame)


def _frame(solved: Any, linkage: Linkage, start: Start, omitted: frozenset[str]) -> Frame:
    """Coordinates of all bodies, from Exudyn's live coordinates, rates and accelerations."""
    prescribed = pack_prescribed(linkage, omitted)
    begin_motion(prescribed, 0.0, start.position)
    count = 3 * len(linkage.bodies)
    contacts = np.zeros(len(linkage.clearances), CONTACT)
    solved_bodies = [i for i, body in enumerate(linkage.bodies) if body.name not in omitted]
    places = np.array([3 * i + c for i in solved_bodies for c in range(3)], np.int64)
    q, v, a = np.array(start.position), np.array(start.velocity), np.zeros(count)
    if not omitted:
        places, (q, v, a) = places[:0], solved
    return Frame(
        solved[0], solved[1], solved[2], places, prescribed, q, v, a, np.zeros(count), contacts
    )
