"""Powers and energies of a linkage in motion.

The ledger that both engines keep: drive work = change of kinetic, potential and
elastic contact energy + contact loss + friction loss + residual.  The normal force
does its work along n, on the approach e_dot . n; what it does beyond loading the
elastic law is the contact loss, which for a round joint is the damping.
"""

import numpy as np
from numpy.typing import NDArray

from presswear.clearance import Contact, Load
from presswear.compiled import Records, compiled

Array = NDArray[np.float64]


@compiled
def elastic_energy(joint: Records, penetration: float) -> float:
    """Energy stored in a contact, J: K delta^(n + 1) / (n + 1)."""
    if penetration <= 0.0:
        return 0.0
    return joint.stiffness * penetration ** (joint.exponent + 1.0) / (joint.exponent + 1.0)


@compiled
def loss_powers(joint: Records, contact: Contact, load: Load) -> tuple[float, float]:
    """Power lost in a contact, and in its friction, W."""
    if contact.penetration <= 0.0:
        return 0.0, 0.0
    stored = joint.stiffness * contact.penetration**joint.exponent * contact.rate
    return load.normal * contact.approach - stored, -load.tangential * contact.sliding


@compiled
def mechanical_energy(mass: Array, weight: Array, q: Array, v: Array) -> float:
    """Kinetic energy plus that of constant generalized forces, J.

    Parameters
    ----------
    mass, weight : ndarray, shape (3 bodies,)
        Diagonal of the mass matrix and constant generalized forces.
    """
    total = 0.0
    for i in range(q.shape[0]):
        total += 0.5 * mass[i] * v[i] * v[i] - weight[i] * q[i]
    return total
