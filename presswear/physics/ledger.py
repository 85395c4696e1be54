"""Balance of energies, which every engine computes.

    drive work + load work = change of stored energy + contact loss + friction loss
                             + residual

The stored energy is kinetic, potential and elastic. The load work is that of loads with
a law, less the losses in the dampers of springs. Constant loads have a potential energy.

The power of a normal force F_n is F_n e_dot . n. Its integral less the change of elastic
energy is the contact loss: the loss by damping, less the energy that the normal law
creates. A law creates energy if its force is not the gradient of an energy, as in radial
contact on a worn profile.
"""

from dataclasses import dataclass

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.equations.layout import ENERGIES
from presswear.physics.interactions.kinds import KINDS
from presswear.physics.packed import Packed, depths_of
from presswear.tools.arrays import Array


def stored_energy(
    linkage: Linkage, packed: Packed, elastic: Array, q: Array, v: Array
) -> float:
    """Return the kinetic, potential and elastic energy of a state, J.

    ``elastic`` are the energies of the contacts.
    """
    with np.errstate(over="ignore"):  # the state of a failed run may be too large
        kinetic = 0.5 * float(np.sum(packed.mass * v**2))
    potential = -float(packed.weight @ q)
    stored = sum(kind.stored_energy(linkage, q) for kind in KINDS)
    return kinetic + potential + stored + float(np.sum(elastic))


# Largest energy that contacts may create, over the energy exchanged by the drives; a run
# with more is ended
MAX_CREATED = 0.5
# Time after the run-up at which this check starts, cycles
CHECK_START = 0.05


def has_worn_radial_contact(packed: Packed) -> bool:
    """Return whether a joint with radial contact has a worn surface."""
    return bool(depths_of(packed)[packed.joints["foundation"] == 0.0].any())


def created_energy_message(packed: Packed, contact_loss: float, exchange: float) -> str:
    """Return a message if contacts created more energy than ``MAX_CREATED`` allows, else "".

    A radial force on a steep worn profile is not the gradient of an energy, so that the
    pin can gain speed in each of its orbits. ``contact_loss`` and ``exchange`` are the
    contact loss and the drive exchange since the start of the run, J; see ``Ledger``.
    """
    # The comparison is false for NaN: another check reports a state that is not finite.
    if not (exchange > 0.0 and contact_loss < -MAX_CREATED * exchange):
        return ""
    cause = "the steps are too coarse"
    if has_worn_radial_contact(packed):
        cause = f"the worn surfaces are too steep for contact = radial, or {cause}"
    return (
        f"the contacts created {-contact_loss:.3g} J, where the drives exchanged {exchange:.3g} J: "
        f"{cause}"
    )


def remedy_for_created_energy(packed: Packed, finer: str) -> str:
    """Return advice for a run whose contacts created energy.

    ``finer`` says how finer steps are selected.
    """
    if has_worn_radial_contact(packed):
        return (
            f"contact = foundation can follow steep surfaces; else finer steps: {finer}"
        )
    return finer


@dataclass(frozen=True)
class Ledger:
    """Balance of the energy of a run, J."""

    drive_work: float
    drive_exchange: float  # integral of the absolute power of the drives
    stored: float  # change of kinetic, potential and elastic energy
    contact_loss: float  # dissipated by contacts, less what they created
    friction_loss: float
    created: float = 0.0  # created by the normal law, positive or negative
    # work of loads with a law, less the loss in the dampers of springs
    load_work: float = 0.0

    @staticmethod
    def of(energies: Array, stored: float) -> "Ledger":
        """Return the ledger from energies in the order of ENERGIES and the stored change, J."""
        by_name = dict(zip(ENERGIES, energies.tolist(), strict=True))
        return Ledger(stored=stored, **by_name)

    @property
    def dissipated(self) -> float:
        """Energy that damping and friction turned into heat, J."""
        return self.contact_loss + self.created + self.friction_loss

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
            "contact_made_J": self.created,
            "energy_residual_J": self.residual,
        }
