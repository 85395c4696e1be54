"""A clearance joint as the kernels see it, and what its contact is described by.

e = pin centre - bearing centre, n = e / |e|, phi its direction, t = n turned by
+90 degrees.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, ClearanceJoint, Linkage
from presswear.physics.foundation import foundation_stiffness
from presswear.physics.surface import BEARING, PIN, ROWS, packed_rows
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

JOINT = np.dtype(
    [
        ("bearing_body", np.int64),  # index in q of the body's x; -1 for the frame
        ("pin_body", np.int64),
        ("bearing_x", np.float64),  # centres in the bodies' frames, m
        ("bearing_y", np.float64),
        ("pin_x", np.float64),
        ("pin_y", np.float64),
        ("bearing_radius", np.float64),
        ("pin_radius", np.float64),
        ("clearance", np.float64),
        ("width", np.float64),
        ("stiffness", np.float64),
        ("exponent", np.float64),
        ("damping", np.float64),
        ("friction", np.float64),
        ("lower_speed", np.float64),
        ("upper_speed", np.float64),
        ("map_turns", np.float64),  # 1 where the wear maps turn with their bodies
        ("foundation", np.float64),  # its stiffness k_w b R, N/m^2 per rad; 0 for radial contact
        ("least_depth", np.float64),  # sum of the least depths of both surfaces, m
        ("wear_coefficient", np.float64),  # K_d, 1/Pa; 0 keeps no account
        ("bearing_share", np.float64),  # part of the worn depth that the bearing loses
        ("slip_by_angle", np.bool_),
        ("over_arc", np.bool_),
    ]
)
"""A clearance joint as the kernels see it; SI units."""


class Pose(NamedTuple):
    """Position, angle and rates of one joint end: centre (m, m/s), body angle (rad, rad/s)."""

    x: float
    y: float
    vx: float
    vy: float
    lever_x: float
    lever_y: float
    angle: float
    spin: float


class Contact(NamedTuple):
    """The pin in its bearing at one instant; SI units.

    Attributes
    ----------
    penetration, rate : float
        Greatest overlap of the surfaces, and its rate.
    sliding, turning : float
        v_t at the contact point; rate of the direction of e, rad/s.
    normal_x, normal_y : float
        Direction in which the pin presses on the bearing.
    eccentricity, eccentricity_x, eccentricity_y : float
        e and its length.
    pin_arm, bearing_arm : float
        Distances of the contact point from the two centres, along the normal.
    approach : float
        Speed on which the normal force works.
    elastic, closing : float
        Elastic force, N, and the rate that damps it.
    energy : float
        Elastic energy, J.
    place : float
        On a foundation the direction of the greatest overlap, rad.
    couple : float
        Moment of the elastic pressure on the pin about the contact point, N m; the bearing
        bears the opposite.  A worn surface is not round.
    """

    penetration: float
    rate: float
    sliding: float
    turning: float
    normal_x: float
    normal_y: float
    eccentricity: float
    eccentricity_x: float
    eccentricity_y: float
    pin_arm: float
    bearing_arm: float
    approach: float
    elastic: float
    closing: float
    energy: float
    place: float
    couple: float


class Load(NamedTuple):
    """Forces of a joint: magnitudes normal and tangential, force on the pin, moments.

    The bearing gets the opposite force; both moments are about the mass centres.
    """

    normal: float
    tangential: float
    x: float
    y: float
    pin_moment: float
    bearing_moment: float


@compiled
def joint_end(body: int, local_x: float, local_y: float, q: Array, v: Array) -> Pose:
    """Where a point of a body is and how it moves; the frame for body -1."""
    if body < 0:
        return Pose(local_x, local_y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    angle = q[body + 2]
    spin = v[body + 2]
    cosine = math.cos(angle)
    sine = math.sin(angle)
    lever_x = cosine * local_x - sine * local_y
    lever_y = sine * local_x + cosine * local_y
    return Pose(
        q[body] + lever_x,
        q[body + 1] + lever_y,
        v[body] - spin * lever_y,
        v[body + 1] + spin * lever_x,
        lever_x,
        lever_y,
        angle,
        spin,
    )


@compiled
def direction_of(contact: Contact) -> float:
    """Direction phi of the eccentricity, rad."""
    return math.atan2(contact.eccentricity_y, contact.eccentricity_x)


def pack_joints(linkage: Linkage) -> Records:
    """The clearance joints of a linkage as records for the kernels, shape (joints,)."""
    joints = np.zeros(len(linkage.clearances), JOINT)

    def offset(body: str) -> int:
        return -1 if body == GROUND else 3 * linkage.index(body)

    for record, joint in zip(joints, linkage.clearances, strict=True):
        record["bearing_body"] = offset(joint.bearing.body)
        record["pin_body"] = offset(joint.pin.body)
        record["bearing_x"], record["bearing_y"] = joint.bearing.x, joint.bearing.y
        record["pin_x"], record["pin_y"] = joint.pin.x, joint.pin.y
        record["bearing_radius"], record["pin_radius"] = joint.bearing_radius, joint.pin_radius
        record["clearance"], record["width"] = joint.clearance, joint.width
        record["stiffness"] = joint.normal.stiffness
        record["exponent"] = joint.normal.exponent
        record["damping"] = joint.normal.damping
        record["friction"] = joint.friction.coefficient
        record["lower_speed"], record["upper_speed"] = joint.friction.lower, joint.friction.upper
        record["map_turns"] = float(joint.map_frame == "body")
        if joint.contact == "foundation":
            record["foundation"] = foundation_stiffness(joint.normal.stiffness, joint.clearance)
        record["least_depth"] = sum(
            float(surface.depth.min()) if surface.is_worn else 0.0
            for surface in (joint.bearing_surface, joint.pin_surface)
        )
        if joint.wear is not None:
            record["wear_coefficient"] = joint.wear.coefficient
            record["bearing_share"] = joint.wear.bearing_share
            record["slip_by_angle"] = joint.wear.slip == "angle"
            record["over_arc"] = joint.wear.footprint == "arc"
    return joints


def pack_surfaces(linkage: Linkage) -> Array:
    """The worn surfaces as the kernels see them, shape (joints, ROWS, m); m = 0 if none is."""
    joints: tuple[ClearanceJoint, ...] = linkage.clearances
    worn = [s for joint in joints for s in (joint.bearing_surface, joint.pin_surface) if s.is_worn]
    count = worn[0].depth.size if worn else 0
    packed = np.zeros((len(joints), ROWS, count))
    for k, joint in enumerate(joints):
        packed[k, BEARING:PIN] = packed_rows(joint.bearing_surface, count)
        packed[k, PIN:] = packed_rows(joint.pin_surface, count)
    return packed
