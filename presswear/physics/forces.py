"""Forces of contacts on the bodies, and the powers that go with them.

Both forces of a joint act at one common point, so that linear and angular momentum are
exact.
"""

from typing import NamedTuple

from presswear.physics.energy import loss_powers
from presswear.physics.friction_and_normal import (
    ONSET_SPEED_FLOOR,
    bristle_force,
    bristle_rate,
    friction_force,
    normal_force,
)
from presswear.physics.wear import wear_rates
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, inlined

# Rates of a joint: powers lost in contact and in friction, and made by the normal law, W; of
# its two doses of wear, F_n ds/dt, W, and p ds/dt, W/m^2; of its bristles, m/s
CONTACT_LOSS, FRICTION_LOSS, MADE, WORK, PRESSURE, BRISTLE = range(6)
JOINT_RATES = 6  # their number


class JointLoad(NamedTuple):
    """Magnitudes, N, force on the pin, N, opposite to that on the bearing, and moments, N m.

    The moments are about the mass centres.
    """

    normal: float
    tangential: float
    x: float
    y: float
    pin_moment: float
    bearing_moment: float


@inlined
def contact_forces(joint: Records, onset_speed: float, contact: Records) -> tuple[float, float]:
    """Return the normal and tangential force of the contact, N; zero when open.

    ``onset_speed`` is the latched closing speed of the contact, or 0 while the joint counts as
    open: a state that penetrates within its first step closes at its present rate. Below 0 it is
    held open. Fills in the rate of the bristles, whose deflection the contact holds.
    """
    is_closed = contact.penetration > 0.0
    has_bristles = joint.friction.bristle_stiffness > 0.0
    if has_bristles:
        contact.bristle_rate = bristle_rate(
            contact.sliding, contact.bristle, is_closed, joint.friction
        )
    if not is_closed or onset_speed < 0.0:
        return 0.0, 0.0
    onset = max(onset_speed if onset_speed > 0.0 else contact.rate, ONSET_SPEED_FLOOR)
    normal = normal_force(
        joint.normal, contact.elastic, contact.penetration, contact.closing, onset
    )
    tangential = 0.0
    if has_bristles:
        tangential = bristle_force(
            normal, contact.sliding, contact.bristle, contact.bristle_rate, joint.friction
        )
    elif joint.friction.coefficient > 0.0:
        tangential = friction_force(contact.sliding, normal, joint.friction)
    return normal, tangential


@inlined
def note_forces(joints: Records, onset: Array, contacts: Records) -> None:
    """Fill in the forces of contacts, once ``onset`` is that of their state."""
    for k in range(joints.shape[0]):
        contact = contacts[k]
        contact.normal, contact.tangential = contact_forces(joints[k], onset[k], contact)


@inlined
def load_of(joint: Records, onset_speed: float, contact: Records) -> JointLoad:
    """Return forces and moments of a contact; ``onset_speed`` as in ``contact_forces``."""
    normal, tangential = contact_forces(joint, onset_speed, contact)
    if normal == 0.0:
        return JointLoad(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    nx = contact.normal_x
    ny = contact.normal_y
    fx = -normal * nx - tangential * ny
    fy = -normal * ny + tangential * nx
    # The contact point, the same from both mass centres.
    px = contact.pin_lever_x + contact.pin_arm * nx
    py = contact.pin_lever_y + contact.pin_arm * ny
    bx = contact.bearing_lever_x + contact.eccentricity_x + contact.pin_arm * nx
    by = contact.bearing_lever_y + contact.eccentricity_y + contact.pin_arm * ny
    pin_moment = px * fy - py * fx
    bearing_moment = by * fx - bx * fy
    if contact.elastic > 0.0:
        couple = normal / contact.elastic * contact.couple
        pin_moment += couple
        bearing_moment -= couple
    return JointLoad(normal, tangential, fx, fy, pin_moment, bearing_moment)


@inlined
def add_contacts(
    joints: Records, onset: Array, contacts: Records, force: Array, rates: Array
) -> None:
    """Add the contact forces to the generalized forces, and fill the rates of all joints.

    ``onset`` is as in ``contact_forces``; ``rates`` has the shape (JOINT_RATES joints,).
    """
    for k in range(joints.shape[0]):
        joint = joints[k]
        base = JOINT_RATES * k
        contact = contacts[k]
        load = load_of(joint, onset[k], contact)
        lost = rubbed = made = 0.0
        if onset[k] >= 0.0:
            lost, rubbed, made = loss_powers(contact, load.normal, load.tangential)
        work, pressure = wear_rates(joint, contact, load.normal)
        rates[base + CONTACT_LOSS] = lost
        rates[base + FRICTION_LOSS] = rubbed
        rates[base + MADE] = made
        rates[base + WORK] = work
        rates[base + PRESSURE] = pressure
        rates[base + BRISTLE] = contact.bristle_rate
        # What is no number is applied too, so that it ends the run.
        if load.normal != 0.0:
            b = joint.pin_body
            if b >= 0:
                force[b] += load.x
                force[b + 1] += load.y
                force[b + 2] += load.pin_moment
            b = joint.bearing_body
            if b >= 0:
                force[b] -= load.x
                force[b + 1] -= load.y
                force[b + 2] += load.bearing_moment
