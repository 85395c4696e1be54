"""Linkage as bodies and joints of Exudyn."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from presswear.engines.base import Start
from presswear.engines.exudyn import add
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import ends_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.topology import bodies_of, prescribed_of
from presswear.physics.drive_motion import drive_motion, is_steady
from presswear.tools.compile import Records


def left_out(linkage: Linkage) -> frozenset[str]:
    """Return the prescribed bodies that only clearance joints connect to the others.

    Joints with friction stay, because the friction needs their forces.
    """
    omitted = prescribed_of(linkage)
    if len(omitted) == len(linkage.bodies):
        return frozenset()
    omitted -= frozenset[str]().union(*map(bodies_of, linkage.rubbing_pins))
    while True:
        joined = [bodies_of(joint) for joint in linkage.joints]
        joined += [gear.coupled_bodies for gear in linkage.gears]
        connected = frozenset[str]().union(
            *(bodies for bodies in joined if not bodies <= omitted)
        )
        if not connected & omitted:
            return omitted
        omitted -= connected


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
            system,
            "Object",
            "RigidBody2D",
            mass=body.mass,
            inertia=inertia,
            nodeNumber=node,
        )
        if linkage.gravity != 0.0:
            marker = add(system, "Marker", "BodyMass", bodyNumber=rigid)
            weight = [0.0, -linkage.gravity, 0.0]
            add(
                system,
                "Load",
                "MassProportional",
                markerNumber=marker,
                loadVector=weight,
            )
    return nodes, bodies


def add_joints(
    system: Any,
    linkage: Linkage,
    motions: Records,
    omitted: frozenset[str],
    nodes: dict[str, Any],
    bodies: dict[str, Any],
) -> dict[str, int]:
    """Add ideal joints, drives and constant loads.

    Returns the object numbers of joints and drives by name.
    """

    def marker_at(point: Attachment) -> Any:
        place = [point.x, point.y, 0.0]
        return add(
            system,
            "Marker",
            "BodyRigid",
            bodyNumber=bodies[point.body],
            localPosition=place,
        )

    objects: dict[str, int] = {}
    for joint in linkage.revolutes:
        if not bodies_of(joint) <= omitted:
            markers = [marker_at(joint.first), marker_at(joint.second)]
            objects[joint.name] = add(
                system, "Object", "JointRevolute2D", markerNumbers=markers
            )
    for guide in linkage.guides:
        if bodies_of(guide) <= omitted:
            continue
        normal = guide.direction - guide.angle + 0.5 * math.pi
        line, centre = map(marker_at, ends_of(guide))
        objects[guide.name] = add(
            system,
            "Object",
            "JointPrismatic2D",
            markerNumbers=[line, centre],
            axisMarker0=[math.cos(guide.direction), math.sin(guide.direction), 0.0],
            normalMarker1=[math.cos(normal), math.sin(normal), 0.0],
            constrainRotation=True,
        )
    still = add(system, "Node", "PointGround")
    fixed = add(system, "Marker", "NodeCoordinate", nodeNumber=still, coordinate=0)
    for drive, motion in zip(linkage.drives, motions, strict=True):
        if drive.body in omitted or not linkage.prescribes(drive):
            continue
        if isinstance(drive, LinearDrive) and linkage.guide_of(drive).is_moving:
            cylinder = _add_moving_cylinder(system, linkage, drive, motion, nodes)
            objects[drive.name] = cylinder
            continue
        coordinate, factor = _driven_coordinate(linkage, drive)
        driven = add(
            system,
            "Marker",
            "NodeCoordinate",
            nodeNumber=nodes[drive.body],
            coordinate=coordinate,
        )
        # The constraint is on the velocity. The trapezoidal rule integrates a constant
        # speed exactly; ``project_state`` corrects the angle of an uneven one.
        turning: dict[str, Any] = {"offset": drive.speed}
        if not is_steady(linkage, drive):
            turning = {"offset": 0.0, "offsetUserFunction_t": _speed_function(motion)}
        markers = [fixed, driven]
        if isinstance(drive, GearedDrive):
            leader = add(
                system,
                "Marker",
                "NodeCoordinate",
                nodeNumber=nodes[drive.leader],
                coordinate=2,
            )
            # Exudyn has a factor of the second marker only.
            markers, factor, turning = [driven, leader], drive.ratio, {"offset": 0.0}
        objects[drive.name] = add(
            system,
            "Object",
            "ConnectorCoordinate",
            markerNumbers=markers,
            velocityLevel=True,
            factor1=factor,
            **turning,
        )
    for load in linkage.dead_loads:
        if load.body not in omitted:
            at = marker_at(Attachment(load.body, 0.0, 0.0))
            add(
                system,
                "Load",
                "ForceVector",
                markerNumber=at,
                loadVector=[load.x, load.y, 0.0],
            )
            add(
                system,
                "Load",
                "TorqueVector",
                markerNumber=at,
                loadVector=[0.0, 0.0, load.moment],
            )
    return objects


def _add_moving_cylinder(
    system: Any,
    linkage: Linkage,
    drive: LinearDrive,
    motion: Records,
    nodes: dict[str, Any],
) -> Any:
    """Add a drive along a guide on a moving body; return its object.

    The constraint is that of ``Rows``: the rate of the distance along the guide.
    """
    guide = linkage.guide_of(drive)
    speed = _speed_function(motion)

    def row(q: Any) -> tuple[float, ...]:
        """Return the derivatives of the distance by the coordinates of carrier and slide."""
        angle = q[2] + guide.direction
        ux, uy = math.cos(angle), math.sin(angle)
        return -ux, -uy, (q[4] - q[1]) * ux - (q[3] - q[0]) * uy, ux, uy, 0.0

    def constraint(
        system: Any, t: float, item: int, q: Any, v: Any, level: bool
    ) -> list[float]:
        rate = sum(a * b for a, b in zip(row(q), v, strict=True))
        return [rate - speed(system, t, item, 0.0)]

    def jacobian(
        system: Any, t: float, item: int, q: Any, v: Any, level: bool
    ) -> list[list[float]]:
        return [[*row(q)]]

    markers = [
        add(system, "Marker", "NodeCoordinates", nodeNumber=nodes[body])
        for body in (guide.on, guide.body)
    ]
    return add(
        system,
        "Object",
        "ConnectorCoordinateVector",
        markerNumbers=markers,
        velocityLevel=True,
        scalingMarker0=np.zeros((1, 1)),  # its rows are the number of equations
        constraintUserFunction=constraint,
        jacobianUserFunction=jacobian,
    )


def _driven_coordinate(linkage: Linkage, drive: Drive) -> tuple[int, float]:
    """Return the coordinate of a body that a drive prescribes, and a factor.

    The factor times x or y is the distance along a guide.
    """
    if not isinstance(drive, LinearDrive):
        return 2, 1.0
    direction = linkage.guide_of(drive).direction
    unit_vector = math.cos(direction), math.sin(direction)
    coordinate = 0 if abs(unit_vector[0]) >= abs(unit_vector[1]) else 1
    return coordinate, 1.0 / unit_vector[coordinate]


def _speed_function(motion: Records) -> Callable[..., float]:
    """Return the function that Exudyn calls for the speed of a drive."""
    return lambda system, t, item, offset: drive_motion(motion, t)[1]
