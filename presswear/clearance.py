"""One clearance joint: states of two bodies in, forces and moments out.

e = pin centre - bearing centre, n = e / |e|, phi its direction, t = n turned by
+90 degrees.  The gap at phi is c + h_bearing + h_pin and the penetration what |e|
exceeds it by.  Both forces act at one common point, so that linear and angular
momentum are exact.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.compiled import Records, compiled
from presswear.laws import ONSET_SPEED_FLOOR, friction_force, normal_force
from presswear.linkage import GROUND, ClearanceJoint, Linkage
from presswear.surface import Surface, curvature, profile

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
    """Geometry of the pin in its bearing at one instant; SI units.

    ``rate`` is that of the penetration, ``approach`` that of |e|; they differ where a
    worn profile slopes.  ``pin_arm`` and ``bearing_arm`` are the distances of the
    contact point from the two centres, along n.
    """

    penetration: float
    rate: float
    sliding: float
    turning: float
    normal_x: float
    normal_y: float
    eccentricity: float
    pin_arm: float
    bearing_arm: float
    approach: float


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
    return math.atan2(contact.normal_y, contact.normal_x)


@compiled
def contact_between(
    joint: Records,
    bearing: Pose,
    pin: Pose,
    bearing_depth: Array,
    bearing_slope: Array,
    pin_depth: Array,
    pin_slope: Array,
) -> Contact:
    """Radial contact of the pin with the surface that faces it.

    The rate of penetration follows the worn profile: delta_dot = e_dot . n minus the
    change of both depths under the moving contact.
    """
    ex = pin.x - bearing.x
    ey = pin.y - bearing.y
    vx = pin.vx - bearing.vx
    vy = pin.vy - bearing.vy
    eccentricity = math.sqrt(ex * ex + ey * ey)
    if eccentricity > 0.0:
        nx = ex / eccentricity
        ny = ey / eccentricity
        turning = (ex * vy - ey * vx) / (eccentricity * eccentricity)
    else:
        # A pin exactly in the centre touches nothing: any direction serves.
        nx, ny, turning = 1.0, 0.0, 0.0
    penetration = eccentricity - joint.clearance
    approach = vx * nx + vy * ny
    rate = approach
    pin_radius = joint.pin_radius
    bearing_radius = joint.bearing_radius
    if bearing_depth.shape[0] > 0:
        turns = joint.map_turns
        direction = math.atan2(ny, nx)
        depth, slope = profile(bearing_depth, bearing_slope, direction - turns * bearing.angle)
        penetration -= depth
        bearing_radius += depth
        rate -= slope * (turning - turns * bearing.spin)
        depth, slope = profile(pin_depth, pin_slope, direction - turns * pin.angle)
        penetration -= depth
        pin_radius -= depth
        rate -= slope * (turning - turns * pin.spin)
    # Half the penetration on either side, so that both arms end at one point.
    indentation = 0.5 * max(penetration, 0.0)
    pin_arm = pin_radius - indentation
    bearing_arm = bearing_radius + indentation
    sliding = vy * nx - vx * ny + pin.spin * pin_arm - bearing.spin * bearing_arm
    return Contact(
        penetration,
        rate,
        sliding,
        turning,
        nx,
        ny,
        eccentricity,
        pin_arm,
        bearing_arm,
        approach,
    )


@compiled
def load_of(joint: Records, onset_speed: float, contact: Contact, bearing: Pose, pin: Pose) -> Load:
    """Forces of the contact; zero when open.

    ``onset_speed`` is the latched closing speed of the touch, or 0 while the joint
    counts as open: a state that penetrates within its first step closes at its
    present rate.
    """
    if contact.penetration <= 0.0:
        return Load(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    onset = max(onset_speed if onset_speed > 0.0 else contact.rate, ONSET_SPEED_FLOOR)
    normal = normal_force(
        contact.penetration, contact.rate, onset, joint.stiffness, joint.exponent, joint.damping
    )
    tangential = 0.0
    if joint.friction > 0.0:
        tangential = friction_force(
            contact.sliding, normal, joint.friction, joint.lower_speed, joint.upper_speed
        )
    nx = contact.normal_x
    ny = contact.normal_y
    fx = -normal * nx - tangential * ny
    fy = -normal * ny + tangential * nx
    px = pin.lever_x + contact.pin_arm * nx
    py = pin.lever_y + contact.pin_arm * ny
    bx = bearing.lever_x + contact.bearing_arm * nx
    by = bearing.lever_y + contact.bearing_arm * ny
    return Load(normal, tangential, fx, fy, px * fy - py * fx, by * fx - bx * fy)


@compiled
def contact_of(
    joints: Records, k: int, surfaces: Array, q: Array, v: Array
) -> tuple[Contact, Pose, Pose]:
    """Contact of joint ``k`` in a state of the whole linkage, with both joint ends.

    Parameters
    ----------
    joints : record array of JOINT
    surfaces : ndarray, shape (joints, 4, m)
        Bearing depth and slope, pin depth and slope; m = 0 when nothing is worn.
    q, v : ndarray, shape (3 bodies,)
    """
    joint = joints[k]
    bearing = joint_end(joint.bearing_body, joint.bearing_x, joint.bearing_y, q, v)
    pin = joint_end(joint.pin_body, joint.pin_x, joint.pin_y, q, v)
    contact = contact_between(
        joint,
        bearing,
        pin,
        surfaces[k, 0],
        surfaces[k, 1],
        surfaces[k, 2],
        surfaces[k, 3],
    )
    return contact, bearing, pin


@compiled
def joint_load(joints: Records, k: int, onset: Array, surfaces: Array, q: Array, v: Array) -> Load:
    """Forces of joint ``k`` in a state of the whole linkage; ``onset`` as in ``load_of``."""
    contact, bearing, pin = contact_of(joints, k, surfaces, q, v)
    return load_of(joints[k], onset[k], contact, bearing, pin)


@compiled
def end_acceleration(body: int, end: Pose, a: Array) -> tuple[float, float, float]:
    """Acceleration of a joint end, m/s^2, and angular acceleration of its body, rad/s^2."""
    if body < 0:
        return 0.0, 0.0, 0.0
    spin_t = a[body + 2]
    square = end.spin * end.spin
    return (
        a[body] - spin_t * end.lever_y - square * end.lever_x,
        a[body + 1] + spin_t * end.lever_x - square * end.lever_y,
        spin_t,
    )


@compiled
def penetration_acceleration(
    joints: Records, k: int, surfaces: Array, q: Array, v: Array, a: Array
) -> float:
    """Second time derivative of the penetration of joint ``k``, m/s^2.

    Follows the worn profile: a pin that runs over a bump is thrown off by the
    profile's curvature times the square of the turning.
    """
    joint = joints[k]
    contact, bearing, pin = contact_of(joints, k, surfaces, q, v)
    if contact.eccentricity == 0.0:
        return 0.0
    pin_x, pin_y, pin_spin_t = end_acceleration(joint.pin_body, pin, a)
    bearing_x, bearing_y, bearing_spin_t = end_acceleration(joint.bearing_body, bearing, a)
    ax = pin_x - bearing_x
    ay = pin_y - bearing_y
    nx = contact.normal_x
    ny = contact.normal_y
    turning = contact.turning
    result = ax * nx + ay * ny + turning * turning * contact.eccentricity
    if surfaces.shape[2] > 0:
        turning_t = (ay * nx - ax * ny - 2.0 * contact.approach * turning) / contact.eccentricity
        turns = joint.map_turns
        direction = direction_of(contact)
        for row, angle, spin, spin_t in (
            (0, bearing.angle, bearing.spin, bearing_spin_t),
            (2, pin.angle, pin.spin, pin_spin_t),
        ):
            depth = surfaces[k, row]
            slope = surfaces[k, row + 1]
            where = direction - turns * angle
            sweep = turning - turns * spin
            result -= curvature(depth, slope, where) * sweep * sweep
            result -= profile(depth, slope, where)[1] * (turning_t - turns * spin_t)
    return result


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
    return joints


def pack_surfaces(linkage: Linkage) -> Array:
    """Depths and slopes of all worn surfaces, shape (joints, 4, m); m = 0 if none is worn."""
    joints: tuple[ClearanceJoint, ...] = linkage.clearances
    worn = [s for joint in joints for s in (joint.bearing_surface, joint.pin_surface) if s.is_worn]
    count = worn[0].depth.size if worn else 0
    packed = np.zeros((len(joints), 4, count))

    def fill(rows: Array, surface: Surface) -> None:
        if surface.is_worn:
            rows[0], rows[1] = surface.depth, surface.slope

    for k, joint in enumerate(joints):
        fill(packed[k, 0:2], joint.bearing_surface)
        fill(packed[k, 2:4], joint.pin_surface)
    return packed
