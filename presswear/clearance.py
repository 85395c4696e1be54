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
from presswear.foundation import Bed, foundation_stiffness, press
from presswear.laws import ONSET_SPEED_FLOOR, damped_force, elastic_force, friction_force
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
        ("foundation", np.float64),  # its stiffness k_w b R, N/m^2 per rad; 0 for radial contact
        ("least_depth", np.float64),  # sum of the least depths of both surfaces, m
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


@compiled
def radial_contact(
    joint: Records,
    bearing: Pose,
    pin: Pose,
    bearing_depth: Array,
    bearing_slope: Array,
    pin_depth: Array,
    pin_slope: Array,
) -> Contact:
    """Contact of the pin with the point of the surface that faces it.

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
    elastic = elastic_force(penetration, joint.stiffness, joint.exponent)
    energy = elastic * penetration / (joint.exponent + 1.0)
    return Contact(
        penetration,
        rate,
        sliding,
        turning,
        nx,
        ny,
        eccentricity,
        ex,
        ey,
        pin_arm,
        bearing_arm,
        approach,
        elastic,
        rate,
        energy,
        0.0,
    )


@compiled
def bed_between(
    joint: Records, bearing: Pose, pin: Pose, surfaces: Array, ex: float, ey: float
) -> tuple[Bed, float, float, float]:
    """The foundation's bed, with the direction of e and those of the maps' zeros, rad."""
    direction = math.atan2(ey, ex)
    bearing_zero = joint.map_turns * bearing.angle
    pin_zero = joint.map_turns * pin.angle
    bed = press(
        surfaces,
        math.sqrt(ex * ex + ey * ey),
        joint.clearance,
        joint.least_depth,
        direction - bearing_zero,
        direction - pin_zero,
    )
    return bed, direction, bearing_zero, pin_zero


@compiled
def foundation_contact(joint: Records, bearing: Pose, pin: Pose, surfaces: Array) -> Contact:
    """Contact of the pin with all of the worn arc, through an elastic foundation.

    Force and couples are the gradient of the elastic energy in e and in both bodies'
    angles.  The pin's couple follows from the bearing's: turned together, nothing
    changes.  Damping multiplies all of them, with the rate at which they are worked
    against.
    """
    ex = pin.x - bearing.x
    ey = pin.y - bearing.y
    vx = pin.vx - bearing.vx
    vy = pin.vy - bearing.vy
    eccentricity = math.sqrt(ex * ex + ey * ey)
    turning = (ex * vy - ey * vx) / (eccentricity * eccentricity) if eccentricity > 0.0 else 0.0
    bed, direction, bearing_zero, pin_zero = bed_between(joint, bearing, pin, surfaces, ex, ey)
    turns = joint.map_turns
    place = direction + bed.place
    nx = math.cos(place)
    ny = math.sin(place)
    _, bearing_slope = profile(surfaces[0], surfaces[1], place - bearing_zero)
    pin_depth, pin_slope = profile(surfaces[2], surfaces[3], place - pin_zero)
    rate = vx * nx + vy * ny
    rate += turns * (bearing_slope * bearing.spin + pin_slope * pin.spin)
    elastic = 0.0
    closing = approach = rate
    couple = 0.0
    if bed.overlap > 0.0:
        size = math.sqrt(bed.along * bed.along + bed.across * bed.across)
        if size > 0.0:
            k = joint.foundation
            elastic = k * size
            cosine = math.cos(direction)
            sine = math.sin(direction)
            nx = (cosine * bed.along - sine * bed.across) / size
            ny = (sine * bed.along + cosine * bed.across) / size
            on_bearing = -k * turns * bed.slope
            couple = elastic * (ex * ny - ey * nx) - on_bearing
            turned = (couple * pin.spin + on_bearing * bearing.spin) / elastic
            approach = vx * nx + vy * ny - turned
            # Maps fixed in direction store no energy when the bodies turn.
            closing = approach if turns > 0.0 else approach + turned
    pin_arm = joint.pin_radius - pin_depth - 0.5 * max(bed.overlap, 0.0)
    bearing_arm = pin_arm + ex * nx + ey * ny
    sliding = vy * nx - vx * ny + pin.spin * pin_arm - bearing.spin * bearing_arm
    return Contact(
        bed.overlap,
        rate,
        sliding,
        turning,
        nx,
        ny,
        eccentricity,
        ex,
        ey,
        pin_arm,
        bearing_arm,
        approach,
        elastic,
        closing,
        0.5 * joint.foundation * bed.square,
        couple,
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
    normal = damped_force(contact.elastic, contact.closing, onset, joint.damping)
    tangential = 0.0
    if joint.friction > 0.0:
        tangential = friction_force(
            contact.sliding, normal, joint.friction, joint.lower_speed, joint.upper_speed
        )
    nx = contact.normal_x
    ny = contact.normal_y
    fx = -normal * nx - tangential * ny
    fy = -normal * ny + tangential * nx
    # The contact point, the same from both mass centres.
    px = pin.lever_x + contact.pin_arm * nx
    py = pin.lever_y + contact.pin_arm * ny
    bx = bearing.lever_x + contact.eccentricity_x + contact.pin_arm * nx
    by = bearing.lever_y + contact.eccentricity_y + contact.pin_arm * ny
    pin_moment = px * fy - py * fx
    bearing_moment = by * fx - bx * fy
    if contact.elastic > 0.0:
        couple = normal / contact.elastic * contact.couple
        pin_moment += couple
        bearing_moment -= couple
    return Load(normal, tangential, fx, fy, pin_moment, bearing_moment)


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
    if joint.foundation > 0.0 and surfaces.shape[2] > 0:
        return foundation_contact(joint, bearing, pin, surfaces[k]), bearing, pin
    contact = radial_contact(
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
    bearing = joint_end(joint.bearing_body, joint.bearing_x, joint.bearing_y, q, v)
    pin = joint_end(joint.pin_body, joint.pin_x, joint.pin_y, q, v)
    pin_x, pin_y, pin_spin_t = end_acceleration(joint.pin_body, pin, a)
    bearing_x, bearing_y, bearing_spin_t = end_acceleration(joint.bearing_body, bearing, a)
    ex = pin.x - bearing.x
    ey = pin.y - bearing.y
    vx = pin.vx - bearing.vx
    vy = pin.vy - bearing.vy
    ax = pin_x - bearing_x
    ay = pin_y - bearing_y
    eccentricity = math.sqrt(ex * ex + ey * ey)
    if eccentricity == 0.0:
        return 0.0
    turns = joint.map_turns
    if joint.foundation > 0.0 and surfaces.shape[2] > 0:
        # The greatest overlap follows its place: p_tt - p_ts^2 / p_ss.
        bed, direction, _, _ = bed_between(joint, bearing, pin, surfaces[k], ex, ey)
        place = direction + bed.place
        nx = math.cos(place)
        ny = math.sin(place)
        second = ax * nx + ay * ny
        mixed = vy * nx - vx * ny
        across = -(ex * nx + ey * ny)
        for row, angle, spin, spin_t in (
            (0, bearing.angle, bearing.spin, bearing_spin_t),
            (2, pin.angle, pin.spin, pin_spin_t),
        ):
            where = place - turns * angle
            bend = curvature(surfaces[k, row], surfaces[k, row + 1], where)
            slope = profile(surfaces[k, row], surfaces[k, row + 1], where)[1]
            second += turns * (slope * spin_t - bend * spin * spin)
            mixed += turns * bend * spin
            across -= bend
        return second - mixed * mixed / across if across < 0.0 else second
    nx = ex / eccentricity
    ny = ey / eccentricity
    turning = (vy * nx - vx * ny) / eccentricity
    result = ax * nx + ay * ny + turning * turning * eccentricity
    if surfaces.shape[2] > 0:
        approach = vx * nx + vy * ny
        turning_t = (ay * nx - ax * ny - 2.0 * approach * turning) / eccentricity
        direction = math.atan2(ny, nx)
        for row, angle, spin, spin_t in (
            (0, bearing.angle, bearing.spin, bearing_spin_t),
            (2, pin.angle, pin.spin, pin_spin_t),
        ):
            depth = surfaces[k, row]
            slopes = surfaces[k, row + 1]
            where = direction - turns * angle
            sweep = turning - turns * spin
            result -= curvature(depth, slopes, where) * sweep * sweep
            result -= profile(depth, slopes, where)[1] * (turning_t - turns * spin_t)
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
        if joint.contact == "foundation":
            record["foundation"] = foundation_stiffness(joint.normal.stiffness, joint.clearance)
        record["least_depth"] = sum(
            float(surface.depth.min()) if surface.is_worn else 0.0
            for surface in (joint.bearing_surface, joint.pin_surface)
        )
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
