"""Powers and energies of a linkage in motion.

The ledger that both engines keep: drive work = change of kinetic, potential and
elastic contact energy + contact loss + friction loss + residual.  The normal force
does its work along n, on the approach e_dot . n; what it does beyond loading the
elastic law is the contact loss, which for a round joint is the damping.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment, Linkage, Spring
from presswear.physics.joint_data import Contact
from presswear.tools.compiled import compiled

Array = NDArray[np.float64]


@compiled
def loss_powers(contact: Contact, normal: float, tangential: float) -> tuple[float, float]:
    """Power lost in a contact, and in its friction, W."""
    if contact.penetration <= 0.0:
        return 0.0, 0.0
    stored = contact.elastic * contact.closing
    return normal * contact.approach - stored, -tangential * contact.sliding


def mass_of(linkage: Linkage) -> Array:
    """Diagonal of the mass matrix, shape (3 bodies,): m, m, I of each body."""
    return np.array([x for body in linkage.bodies for x in (body.mass, body.mass, body.inertia)])


def weight_of(linkage: Linkage) -> Array:
    """Constant generalized forces, shape (3 bodies,): gravity and loads."""
    weight = np.zeros(3 * len(linkage.bodies))
    weight[1::3] = [-linkage.gravity * body.mass for body in linkage.bodies]
    for load in linkage.loads:
        i = 3 * linkage.index(load.body)
        weight[i : i + 3] += load.x, load.y, load.moment
    return weight


def _place(linkage: Linkage, point: Attachment, q: Array) -> tuple[float, float]:
    if point.body == GROUND:
        return point.x, point.y
    x, y, angle = q[3 * linkage.index(point.body) :][:3]
    c, s = math.cos(angle), math.sin(angle)
    return x + c * point.x - s * point.y, y + s * point.x + c * point.y


def _spring_energy(linkage: Linkage, spring: Spring, q: Array) -> float:
    ends = _place(linkage, spring.first, q), _place(linkage, spring.second, q)
    return 0.5 * spring.stiffness * (math.dist(*ends) - spring.length) ** 2


def stored_energy(linkage: Linkage, elastic: Array, q: Array, v: Array) -> float:
    """Kinetic, potential and elastic energy of a state, J.

    Parameters
    ----------
    elastic : ndarray, shape (joints,)
        Elastic energies of the contacts, J.
    q, v : ndarray, shape (3 bodies,)
    """
    with np.errstate(over="ignore"):  # a run that failed has no energy worth a warning
        kinetic = 0.5 * float(np.sum(mass_of(linkage) * v**2))
    potential = -float(weight_of(linkage) @ q)
    springs = sum(_spring_energy(linkage, spring, q) for spring in linkage.springs)
    return kinetic + potential + springs + float(np.sum(elastic))


MADE = 0.5
"""Energy that contacts may make, part of what the drives exchanged, before a run is ended."""
SETTLED = 0.05
"""Part of the first cycle before which that is not judged."""


def made_energy(contact_loss: float, exchange: float) -> str:
    """What is wrong where contacts gave back more than they took, or nothing.

    A radial force over a steep worn profile is not the gradient of an energy: pin and
    wall can drive each other, ever faster.

    Parameters
    ----------
    contact_loss, exchange : float
        So far, J; see ``Ledger``.
    """
    # Of energies that are not numbers nothing is said: the state is broken.
    if not (exchange > 0.0 and contact_loss < -MADE * exchange):
        return ""
    return (
        f"the contacts made {-contact_loss:.3g} J, where the drives exchanged {exchange:.3g} J: "
        "the worn surfaces are too steep for contact = radial, or the steps are too coarse"
    )


MADE_REMEDY = "contact = foundation can follow steep surfaces; else finer steps"
"""What may help where contacts made energy."""


@dataclass(frozen=True)
class Ledger:
    """Where the energy of a run came from and went, J.

    Attributes
    ----------
    drive_work, drive_exchange : float
        Work of the drives, and the integral of their power's absolute value.
    stored : float
        Change of kinetic, potential and elastic energy.
    contact_loss, friction_loss : float
    """

    drive_work: float
    drive_exchange: float
    stored: float
    contact_loss: float
    friction_loss: float

    @staticmethod
    def of(sums: Array, stored: float) -> "Ledger":
        """From the sums that an engine kept step by step (``Book.ledger``)."""
        work, exchange, contact_loss, friction_loss = (float(x) for x in sums[:4])
        return Ledger(work, exchange, stored, contact_loss, friction_loss)

    @property
    def residual(self) -> float:
        """What does not add up, J: the integration's error."""
        return self.drive_work - self.stored - self.contact_loss - self.friction_loss

    def as_dict(self) -> dict[str, float]:
        """Ready for ``result.json``."""
        return {
            "drive_work_J": self.drive_work,
            "drive_exchange_J": self.drive_exchange,
            "stored_energy_change_J": self.stored,
            "contact_loss_J": self.contact_loss,
            "friction_loss_J": self.friction_loss,
            "energy_residual_J": self.residual,
        }
