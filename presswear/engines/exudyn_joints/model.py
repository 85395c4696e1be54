"""Linkage as bodies and joints of Exudyn."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from presswear.engines.base import Start
from presswear.engines.exudyn import add
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import (
    Guide,
    Joint,
    Revolute,
    closing_guides,
    ends_of,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Load
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.topology import bodies_of, prescribed_of
from presswear.physics.drive_motion import drive_motion, is_steady
from presswear.tools.compile import Records


def left_out(linkage: Linkage) -> frozenset[str]:
    """Return the prescribed bodies that only clearance joints connect to the others.

    Joints with friction stay, because the friction needs their forces, and loops of
    guides, because only pins close the loops of prescribed bodies.
    """
    omitted = prescribed_of(linkage)
    if len(omitted) == len(linkage.bodies):
        return frozenset()
    closing = closing_guides(linkage.guides)
    retained: list[Joint] = [*linkage.rubbing_pins]
    retained += [guide for guide in linkage.guides if guide.name in closing]
    omitted -= frozenset[str]().union(*map(bodies_of, retained))
    while True:
        joined = [bodies_of(joint) for joint in linkage.joints]
        joined += [gear.coupled_bodies for gear in linkage.gears]
        connected: set[str] = set()
        for bodies in joined:
            if not bodies <= omitted:
                connected |= bodies
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
        bodies[body.name] = rigid = add(
            system,
            "Object",
            "RigidBody2D",
            mass=body.mass,
            inertia=body.effective_inertia,
            nodeNumber=node,
        )
        if linkage.gravity != 0.0:
            marker = add(system, "Marker", "BodyMass", bodyNumber=rigid)
            add(
                system,
                "Load",
                "MassProportional",
                markerNumber=marker,
                loadVector=[0.0, -linkage.gravity, 0.0],  # acceleration, m/s^2
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
    model = _Model(system, linkage, nodes, bodies)
    objects: dict[str, int] = {}
    for joint in linkage.revolutes:
        if not bodies_of(joint) <= omitted:
            objects[joint.name] = model.add_pin(joint)
    for guide in linkage.guides:
        if not bodies_of(guide) <= omitted:
            objects[guide.name] = model.add_guide(guide)
    for drive, motion in zip(linkage.drives, motions, strict=True):
        if drive.body not in omitted and linkage.prescribes(drive):
            objects[drive.name] = model.add_drive(drive, motion)
    for load in linkage.constant_loads:
        if load.body not in omitted:
            model.add_load(load)
    return objects


class _Model:
    """Exudyn's system while joints, drives and loads are added; methods return object numbers."""

    def __init__(
        self,
        system: Any,
        linkage: Linkage,
        nodes: dict[str, Any],
        bodies: dict[str, Any],
    ) -> None:
        self.system = system
        self.linkage = linkage
        self.nodes = nodes
        self.bodies = bodies
        frame = add(system, "Node", "PointGround")
        self.fixed = add(
            system, "Marker", "NodeCoordinate", nodeNumber=frame, coordinate=0
        )

    def _marker_at(self, point: Attachment) -> Any:
        """Add a marker at a point of a body."""
        return add(
            self.system,
            "Marker",
            "BodyRigid",
            bodyNumber=self.bodies[point.body],
            localPosition=[point.x, point.y, 0.0],
        )

    def _marker_of(self, body: str, coordinate: int) -> Any:
        """Add a marker of a coordinate of a body: x, y or angle."""
        return add(
            self.system,
            "Marker",
            "NodeCoordinate",
            nodeNumber=self.nodes[body],
            coordinate=coordinate,
        )

    def add_pin(self, joint: Revolute) -> Any:
        """Add a pin joint."""
        markers = [self._marker_at(joint.first), self._marker_at(joint.second)]
        return add(self.system, "Object", "JointRevolute2D", markerNumbers=markers)

    def add_guide(self, guide: Guide) -> Any:
        """Add a guide without clearance."""
        # Direction of the normal in the frame of the slide, which has the angle of the guide
        normal = guide.direction - guide.angle + 0.5 * math.pi
        return add(
            self.system,
            "Object",
            "JointPrismatic2D",
            markerNumbers=[self._marker_at(point) for point in ends_of(guide)],
            axisMarker0=[math.cos(guide.direction), math.sin(guide.direction), 0.0],
            normalMarker1=[math.cos(normal), math.sin(normal), 0.0],
            constrainRotation=guide.name not in closing_guides(self.linkage.guides),
        )

    def add_drive(self, drive: Drive, motion: Records) -> Any:
        """Add the constraint of a drive on the velocity of its body.

        The trapezoidal rule integrates a constant speed exactly; ``project_state``
        corrects the angle of an uneven one.
        """
        if isinstance(drive, LinearDrive) and self.linkage.guide_of(drive).is_moving:
            return _add_moving_cylinder(
                self.system, self.linkage, drive, motion, self.nodes
            )
        coordinate, factor = _driven_coordinate(self.linkage, drive)
        driven = self._marker_of(drive.body, coordinate)
        markers = [self.fixed, driven]
        speed: dict[str, Any] = {"offset": drive.speed}
        if isinstance(drive, GearedDrive):
            # ``factor1`` multiplies the coordinate of the second marker.
            markers = [driven, self._marker_of(drive.leader, 2)]
            factor = drive.ratio
            speed = {"offset": 0.0}
        elif not is_steady(self.linkage, drive):
            speed = {"offset": 0.0, "offsetUserFunction_t": _speed_function(motion)}
        return add(
            self.system,
            "Object",
            "ConnectorCoordinate",
            markerNumbers=markers,
            velocityLevel=True,
            factor1=factor,
            **speed,
        )

    def add_load(self, load: Load) -> None:
        """Add a constant force and moment at the mass centre of a body."""
        centre = self._marker_at(Attachment(load.body, 0.0, 0.0))
        add(
            self.system,
            "Load",
            "ForceVector",
            markerNumber=centre,
            loadVector=[load.x, load.y, 0.0],
        )
        add(
            self.system,
            "Load",
            "TorqueVector",
            markerNumber=centre,
            loadVector=[0.0, 0.0, load.moment],
        )


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
        ux = math.cos(angle)
        uy = math.sin(angle)
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
