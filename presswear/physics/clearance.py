"""One clearance joint: states of two bodies in, forces and moments out.

Both forces act at one common point, so that linear and angular
momentum are exact.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.physics.joint_data import Contact, Load, Pose, joint_end
from presswear.physics.laws import ONSET_SPEED_FLOOR, damped_force, friction_force
from presswear.physics.packed import Packed
from presswear.physics.surface import BEARING, PIN, SLOPE, curvature, profile
from presswear.physics.surface_contact import foundation_contact, radial_contact
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

STATE = np.dtype(
    [
        *((name, np.float64) for name in Contact._fields),
        ("bearing_angle", np.float64),  # rad
        ("bearing_spin", np.float64),  # rad/s
        ("pin_angle", np.float64),
        ("pin_spin", np.float64),
        ("bearing_x", np.float64),  # lever of the bearing's centre, m
        ("bearing_y", np.float64),
        ("pin_x", np.float64),
        ("pin_y", np.float64),
        ("normal", np.float64),  # N
        ("tangential", np.float64),
    ]
)
"""Contact and forces of one joint in an accepted state, which many ask for."""


@compiled
def contact_of(packed: Packed, k: int, q: Array, v: Array) -> tuple[Contact, Pose, Pose]:
    """Contact of joint ``k`` in a state of the whole linkage, with both joint ends.

    Parameters
    ----------
    q, v : ndarray, shape (3 bodies,)
    """
    joint = packed.joints[k]
    surfaces = packed.surfaces
    bearing = joint_end(joint.bearing_body, joint.bearing_x, joint.bearing_y, q, v)
    pin = joint_end(joint.pin_body, joint.pin_x, joint.pin_y, q, v)
    if joint.foundation > 0.0 and surfaces.shape[2] > 0:
        return foundation_contact(joint, bearing, pin, surfaces[k]), bearing, pin
    contact = radial_contact(
        joint,
        bearing,
        pin,
        surfaces[k, BEARING],
        surfaces[k, BEARING + SLOPE],
        surfaces[k, PIN],
        surfaces[k, PIN + SLOPE],
    )
    return contact, bearing, pin


@compiled
def contact_forces(joint: Records, onset_speed: float, contact: Contact) -> tuple[float, float]:
    """Normal and tangential force of the contact, N; zero when open.

    ``onset_speed`` is the latched closing speed of the touch, or 0 while the joint
    counts as open: a state that penetrates within its first step closes at its
    present rate.
    """
    if contact.penetration <= 0.0:
        return 0.0, 0.0
    onset = max(onset_speed if onset_speed > 0.0 else contact.rate, ONSET_SPEED_FLOOR)
    normal = damped_force(contact.elastic, contact.closing, onset, joint.damping)
    tangential = 0.0
    if joint.friction > 0.0:
        tangential = friction_force(
            contact.sliding, normal, joint.friction, joint.lower_speed, joint.upper_speed
        )
    return normal, tangential


@compiled
def load_of(joint: Records, onset_speed: float, state: Records) -> Load:
    """Forces of a noted contact and their moments; ``onset_speed`` as in ``contact_forces``."""
    normal, tangential = contact_forces(joint, onset_speed, state)
    if normal == 0.0:
        return Load(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    nx = state.normal_x
    ny = state.normal_y
    fx = -normal * nx - tangential * ny
    fy = -normal * ny + tangential * nx
    # The contact point, the same from both mass centres.
    px = state.pin_x + state.pin_arm * nx
    py = state.pin_y + state.pin_arm * ny
    bx = state.bearing_x + state.eccentricity_x + state.pin_arm * nx
    by = state.bearing_y + state.eccentricity_y + state.pin_arm * ny
    pin_moment = px * fy - py * fx
    bearing_moment = by * fx - bx * fy
    if state.elastic > 0.0:
        couple = normal / state.elastic * state.couple
        pin_moment += couple
        bearing_moment -= couple
    return Load(normal, tangential, fx, fy, pin_moment, bearing_moment)


@compiled
def note_contacts(packed: Packed, states: Records, q: Array, v: Array) -> None:
    """Fill the states of all joints but for their forces; see ``note_forces``."""
    for k in range(states.shape[0]):
        contact, bearing, pin = contact_of(packed, k, q, v)
        s = states[k]
        s.penetration = contact.penetration
        s.rate = contact.rate
        s.sliding = contact.sliding
        s.turning = contact.turning
        s.normal_x = contact.normal_x
        s.normal_y = contact.normal_y
        s.eccentricity = contact.eccentricity
        s.eccentricity_x = contact.eccentricity_x
        s.eccentricity_y = contact.eccentricity_y
        s.pin_arm = contact.pin_arm
        s.bearing_arm = contact.bearing_arm
        s.approach = contact.approach
        s.elastic = contact.elastic
        s.closing = contact.closing
        s.energy = contact.energy
        s.place = contact.place
        s.couple = contact.couple
        s.bearing_angle = bearing.angle
        s.bearing_spin = bearing.spin
        s.pin_angle = pin.angle
        s.pin_spin = pin.spin
        s.bearing_x = bearing.lever_x
        s.bearing_y = bearing.lever_y
        s.pin_x = pin.lever_x
        s.pin_y = pin.lever_y


@compiled
def note_forces(joints: Records, onset: Array, states: Records) -> None:
    """Fill in the forces, once ``onset`` is that of the states."""
    for k in range(joints.shape[0]):
        s = states[k]
        s.normal, s.tangential = contact_forces(joints[k], onset[k], s)


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
    packed: Packed, k: int, place: float, q: Array, v: Array, a: Array
) -> float:
    """Second time derivative of the penetration of joint ``k``, m/s^2.

    Follows the worn profile: a pin that runs over a bump is thrown off by the
    profile's curvature times the square of the turning.

    Parameters
    ----------
    place : float
        ``Contact.place`` of the state.
    """
    joint = packed.joints[k]
    surfaces = packed.surfaces
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
        nx = math.cos(place)
        ny = math.sin(place)
        second = ax * nx + ay * ny
        mixed = vy * nx - vx * ny
        across = -(ex * nx + ey * ny)
        for row, angle, spin, spin_t in (
            (BEARING, bearing.angle, bearing.spin, bearing_spin_t),
            (PIN, pin.angle, pin.spin, pin_spin_t),
        ):
            where = place - turns * angle
            bend = curvature(surfaces[k, row], surfaces[k, row + SLOPE], where)
            slope = profile(surfaces[k, row], surfaces[k, row + SLOPE], where)[1]
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
            (BEARING, bearing.angle, bearing.spin, bearing_spin_t),
            (PIN, pin.angle, pin.spin, pin_spin_t),
        ):
            depth = surfaces[k, row]
            slopes = surfaces[k, row + SLOPE]
            where = direction - turns * angle
            sweep = turning - turns * spin
            result -= curvature(depth, slopes, where) * sweep * sweep
            result -= profile(depth, slopes, where)[1] * (turning_t - turns * spin_t)
    return result
