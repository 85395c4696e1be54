"""A linkage as an Exudyn system of rigid bodies, joints and connectors.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and
every clearance joint one ``ObjectGenericODE2`` over the nodes of its two bodies: its
Python user function returns the exact generalized forces on both.  (A connector
between two markers cannot: it applies equal and opposite moments, while pin and
bearing have different radii.)
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.clearance import joint_load
from presswear.compiled import Records, compiled
from presswear.engines.base import Start
from presswear.linkage import GROUND, Attachment, Linkage
from presswear.observe import Account

Array = NDArray[np.float64]


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
class Model:
    """An assembled Exudyn system; the four views stay live during the solve."""

    container: Any
    system: Any
    q: Any
    v: Any
    a: Any
    multipliers: Any
    joints: dict[str, int]  # object number of each ideal joint and drive


def assemble(linkage: Linkage, start: Start, account: Account) -> Model:
    """Build and assemble the Exudyn system of a linkage in its initial state."""
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
    model = Model(container, system, None, None, None, None, constraints)
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


def _connector(account: Account, k: int, model: Model) -> Callable[..., Array]:
    """User function of clearance joint ``k``: reads the live state, not its arguments."""
    joints, onset, surfaces = account.book.joints, account.book.onset, account.book.surfaces
    out = np.zeros(6)

    def force(system: Any, t: float, item: int, q: Any, v: Any) -> Array:
        connector_force(joints, k, onset, surfaces, model.q, model.v, out)
        return out

    return force


def reactions_of(model: Model, linkage: Linkage) -> dict[str, tuple[float, ...]]:
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
