"""Forces of contacts on the bodies, their powers, and the ledger of energies.

Both forces of a joint act at one common point, so that linear and angular momentum are exact.

The ledger that every engine keeps: drive work + load work = change of kinetic, potential and
elastic contact energy + contact loss + friction loss + residual. Load work is that of loads with a
law, less what dampers of springs take; constant loads have a potential. The normal force does its
work along n, on the approach e_dot . n; what it does beyond loading the elastic law is the contact
loss: the damping, less what the law makes of nothing where its force is not the gradient of an
energy, as that of radial contact on a sloping profile.
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from presswear.physics.friction_and_normal import (
    ONSET_SPEED_FLOOR,
    bristle_force,
    bristle_rate,
    friction_force,
    normal_force,
)
from presswear.physics.loads import spring_energy
from presswear.physics.packed import Packed, depths_of
from presswear.physics.wear import wear_rates
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, floats, inlined

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
    if not (is_closed and onset_speed >= 0.0):
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
        return JointLoad(normal, tangential, normal, normal, normal, normal)
    nx, ny = contact.normal_x, contact.normal_y
    fx, fy = -normal * nx - tangential * ny, -normal * ny + tangential * nx
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
def loss_powers(contact: Records, normal: float, tangential: float) -> tuple[float, float, float]:
    """Return the powers lost in contact and friction, and made by the normal law, W."""
    if not contact.penetration > 0.0:
        return 0.0, 0.0, 0.0
    stored = contact.elastic * contact.closing
    lost = normal * contact.approach - stored
    made = normal * (contact.closing - contact.approach)
    damped = normal * contact.closing - stored
    # A user law may push harder where it opens.
    if damped < 0.0:
        made -= damped
    return lost, -tangential * contact.sliding, made


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
        contact.normal, contact.tangential = load.normal, load.tangential
        lost, rubbed, made = loss_powers(contact, load.normal, load.tangential)
        work, pressure = wear_rates(joint, contact, load.normal)
        is_held_open = onset[k] < 0.0
        rates[base + CONTACT_LOSS] = 0.0 if is_held_open else lost
        rates[base + FRICTION_LOSS] = 0.0 if is_held_open else rubbed
        rates[base + MADE] = 0.0 if is_held_open else made
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


# Sums that an engine keeps step by step, and the powers they went on from
LEDGER = np.dtype(
    [
        # J; the exchange is the integral of the absolute drive power
        *floats("drive_work", "drive_exchange", "load_work"),
        *floats("contact_loss", "friction_loss", "made"),
        # W, in the last accepted state
        *floats("drive_power", "load_power", "contact_power", "friction_power", "made_power"),
    ]
)


def stored_energy(packed: Packed, elastic: Array, q: Array, v: Array) -> float:
    """Return the kinetic, potential and elastic energy of a state, J; the last of each contact."""
    with np.errstate(over="ignore"):  # a run that failed has no energy worth a warning
        kinetic = 0.5 * float(np.sum(packed.mass * v**2))
    potential = -float(packed.weight @ q)
    springs = spring_energy(packed.springs, q) if len(packed.springs) else 0.0
    return kinetic + potential + springs + float(np.sum(elastic))


# Energy that contacts may make, part of what the drives exchanged, before a run is ended
MAX_MADE = 0.5
SETTLED = 0.05  # part of the first cycle before which that is not judged, nor in a run-up


def has_worn_radial_contact(packed: Packed) -> bool:
    """Return whether a joint with radial contact has a worn surface."""
    return bool(depths_of(packed)[packed.joints["foundation"] == 0.0].any())


def made_energy(packed: Packed, contact_loss: float, exchange: float) -> str:
    """Return a message if contacts created more energy than they dissipated, else nothing.

    A radial force over a steep worn profile is not the gradient of an energy: pin and wall can
    drive each other, ever faster. Losses and exchange are those so far, J; see ``Ledger``.
    """
    # Energies that are no numbers come from a broken state, which is reported elsewhere.
    if not (exchange > 0.0 and contact_loss < -MAX_MADE * exchange):
        return ""
    cause = "the steps are too coarse"
    if has_worn_radial_contact(packed):
        cause = f"the worn surfaces are too steep for contact = radial, or {cause}"
    return (
        f"the contacts created {-contact_loss:.3g} J, where the drives exchanged {exchange:.3g} J: "
        f"{cause}"
    )


def made_remedy(packed: Packed, finer: str) -> str:
    """Return advice where contacts created energy; ``finer`` is that for the steps."""
    if has_worn_radial_contact(packed):
        return f"contact = foundation can follow steep surfaces; else finer steps: {finer}"
    return finer


@dataclass(frozen=True)
class Ledger:
    """Balance of the energy of a run, J."""

    drive_work: float
    drive_exchange: float  # integral of the absolute power of the drives
    stored: float  # change of kinetic, potential and elastic energy
    contact_loss: float  # dissipated by contacts, less what they created
    friction_loss: float
    made: float = 0.0  # by the normal law, positive or negative
    load_work: float = 0.0  # of loads with a law, less the loss in the dampers of springs

    @staticmethod
    def of(sums: Records, stored: float) -> "Ledger":
        """Return the ledger from one record of LEDGER and the change of stored energy, J."""
        names = (field.name for field in fields(Ledger) if field.name != "stored")
        return Ledger(stored=stored, **{name: float(sums[name]) for name in names})

    @property
    def dissipated(self) -> float:
        """Energy that damping and friction turned into heat, J."""
        return self.contact_loss + self.made + self.friction_loss

    @property
    def residual(self) -> float:
        """Residual of the balance, J: the error of the integration."""
        supplied = self.drive_work + self.load_work
        return supplied - self.stored - self.contact_loss - self.friction_loss

    def as_dict(self) -> dict[str, float]:
        """Return the balance with the names of ``result.json``."""
        return {
            "drive_work_J": self.drive_work,
            "drive_exchange_J": self.drive_exchange,
            "load_work_J": self.load_work,
            "stored_energy_change_J": self.stored,
            "contact_loss_J": self.contact_loss,
            "friction_loss_J": self.friction_loss,
            "contact_made_J": self.made,
            "energy_residual_J": self.residual,
        }
