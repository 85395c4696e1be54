"""A linkage as an Exudyn system of rigid bodies, joints and connectors.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and
all clearance joints together are one ``ObjectGenericODE2`` over the nodes of their
bodies: its Python user function returns the exact generalized forces on all of them.
(A connector between two markers cannot: it applies equal and opposite moments, while
pin and bearing have different radii.)  A driven crank that only clearance joints hold
on to is left out: its motion is known, and its torque follows from the contact force.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.engines.exudyn import Solve
from presswear.engines.exudyn_joints.kernels import Frame, connector_forces
from presswear.linkage.elements import GROUND, Attachment, Drive, Linkage
from presswear.linkage.topology import cranks_of, hinge_of
from presswear.physics.contact import CONTACT
from presswear.physics.motion import drive_motion, is_steady, motion_of
from presswear.physics.prescribed import pack_cranks
from presswear.record.observe import Book
from presswear.record.recorder import Recorder
from presswear.tools.compiled import Records, specialised

Array = NDArray[np.float64]


@dataclass
class JointsModel:
    """An assembled Exudyn system; the views of ``frame`` stay live during the solve."""

    container: Any
    system: Any
    joints: dict[str, int]  # object number of each ideal joint and drive
    cranks: Records  # driven bodies that are left out
    frame: Any = None
    multipliers: Any = None

    def state(self) -> dict[str, Array]:
        """The live arrays that hold the state between two solves."""
        frame = self.frame
        solved = {"q": frame.solved_q, "v": frame.solved_v, "a": frame.solved_a}
        arrays = {**solved, "multipliers": self.multipliers}
        if frame.places.size:
            arrays |= {"all_q": frame.q, "all_v": frame.v, "all_a": frame.a, "axes": frame.axes}
        return {name: np.asarray(array) for name, array in arrays.items()}

    def begin(self, settings: Any, solve: Solve, longest: float) -> None:
        """Let the next solve begin from the present state, up to the end of the cycle."""
        data = self.system.systemData
        initial = exu.ConfigurationType.Initial
        data.SetODE2Coordinates(np.array(self.frame.solved_q), initial)
        data.SetODE2Coordinates_t(np.array(self.frame.solved_v), initial)
        data.SetODE2Coordinates_tt(np.array(self.frame.solved_a), initial)
        data.SetAECoordinates(np.array(self.multipliers), initial)
        solve.set_span(settings, longest)


def _speed_function(drive: Drive) -> Callable[..., float]:
    """The function that Exudyn calls for the speed of a drive."""
    motion = motion_of(drive)
    return lambda system, t, item, offset: drive_motion(motion, t)[1]


def left_out(linkage: Linkage) -> frozenset[str]:
    """Cranks that hold on to the rest by clearance joints only: their motion is known."""
    held = {
        end.body
        for joint in linkage.revolutes
        for end in (joint.first, joint.second)
        if GROUND not in (joint.first.body, joint.second.body)
    }
    held |= {end.body for spring in linkage.springs for end in (spring.first, spring.second)}
    held |= {guide.body for guide in linkage.guides}
    return cranks_of(linkage) - held


def assemble(linkage: Linkage, start: Start, recorder: Recorder) -> JointsModel:
    """Build and assemble the Exudyn system of a linkage in its initial state."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    omitted = left_out(linkage)
    hinges = {id(hinge_of(linkage, name)) for name in omitted}
    nodes: dict[str, Any] = {}
    bodies: dict[str, Any] = {}
    for i, body in enumerate(linkage.bodies):
        if body.name in omitted:
            continue
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
        nodes[body.name] = node
        bodies[body.name] = rigid
    ground = system.AddObject({"objectType": "Ground"})

    def marker_at(point: Attachment) -> Any:
        owner = ground if point.body == GROUND else bodies[point.body]
        return system.AddMarker(
            {
                "markerType": "BodyRigid",
                "bodyNumber": owner,
                "localPosition": [point.x, point.y, 0.0],
            }
        )

    constraints: dict[str, int] = {}
    for joint in linkage.revolutes:
        if id(joint) in hinges:
            continue
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
        if drive.body in omitted:
            continue
        turned = system.AddMarker(
            {
                "markerType": "NodeCoordinate",
                "nodeNumber": nodes[drive.body],
                "coordinate": 2,
            }
        )
        # At velocity level; the trapezoidal rule integrates a constant speed exactly.
        turning = {
            "objectType": "ConnectorCoordinate",
            "markerNumbers": [fixed, turned],
            "velocityLevel": True,
            "offset": drive.speed,
        }
        if not is_steady(drive):
            turning |= {"offset": 0.0, "offsetUserFunction_t": _speed_function(drive)}
        constraints[drive.name] = system.AddObject(turning)
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
        if load.body in omitted:
            continue
        at_centre = marker_at(Attachment(load.body, 0.0, 0.0))
        for kind, vector in (
            ("ForceVector", [load.x, load.y, 0.0]),
            ("TorqueVector", [0.0, 0.0, load.moment]),
        ):
            system.AddLoad({"loadType": kind, "markerNumber": at_centre, "loadVector": vector})
    model = JointsModel(container, system, constraints, pack_cranks(linkage, omitted))
    connector = _Connector.of(linkage, nodes, recorder.book)
    if linkage.clearances:
        system.AddObject(
            {
                "objectType": "GenericODE2",
                "nodeNumbers": [nodes[name] for name in connector.bodies],
                "forceUserFunction": connector.function(),
            }
        )
    system.Assemble()
    model.frame = _frame(model, linkage, start, omitted)
    model.multipliers = system.systemData.GetAECoordinates(copy=False)
    connector.connect(model.frame)
    return model


def _frame(model: JointsModel, linkage: Linkage, start: Start, omitted: frozenset[str]) -> Frame:
    data = model.system.systemData
    solved = (
        data.GetODE2Coordinates(copy=False),
        data.GetODE2Coordinates_t(copy=False),
        data.GetODE2Coordinates_tt(copy=False),
    )
    count = 3 * len(linkage.bodies)
    contacts = np.zeros(len(linkage.clearances), CONTACT)
    if not omitted:
        nowhere = np.zeros(0, dtype=np.int64)
        return Frame(*solved, nowhere, model.cranks, *solved, np.zeros(count), contacts)
    kept = [i for i, body in enumerate(linkage.bodies) if body.name not in omitted]
    places = np.array([3 * i + c for i in kept for c in range(3)])
    q, v = np.array(start.position), np.array(start.velocity)
    return Frame(*solved, places, model.cranks, q, v, np.zeros(count), np.zeros(count), contacts)


@dataclass
class _Connector:
    """The object of all clearance joints and its user function.

    The function reads the live state instead of Exudyn's copies, so it is complete only
    when the system is assembled.
    """

    bodies: tuple[str, ...]
    arguments: tuple[Any, ...]  # packed, slots, onset
    out: Array
    frame: Any = None
    kernel: Any = None

    @staticmethod
    def of(linkage: Linkage, nodes: dict[str, Any], book: Book) -> "_Connector":
        ends = [end.body for joint in linkage.clearances for end in (joint.bearing, joint.pin)]
        bodies = tuple(name for name in dict.fromkeys(ends) if name in nodes)
        slots = [3 * bodies.index(name) if name in bodies else -1 for name in ends]
        arguments = (
            book.packed,
            np.array(slots, dtype=np.int64).reshape(-1, 2),
            book.onset,
        )
        return _Connector(bodies, arguments, np.zeros(3 * len(bodies)))

    def connect(self, frame: Frame) -> None:
        self.frame = frame
        self.kernel = specialised(connector_forces, frame, *self.arguments, 0.0, self.out)

    def function(self) -> Callable[..., Array]:
        packed, slots, onset = self.arguments

        def force(system: Any, t: float, item: int, q: Any, v: Any) -> Array:
            self.kernel(self.frame, packed, slots, onset, t, self.out)
            return self.out

        return force
