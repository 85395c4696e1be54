"""All clearance joints of a state at once: forces on the bodies and what they dissipate."""

import numpy as np
from numpy.typing import NDArray

from presswear.physics.clearance import load_of
from presswear.physics.energy import loss_powers
from presswear.physics.wear import dose_rates
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

JOINT_RATES = 4
"""Per joint: powers of contact loss and friction loss, W; F_n ds/dt, W; p ds/dt, W/m^2."""


@compiled
def add_contacts(
    joints: Records, onset: Array, states: Records, force: Array, rates: Array
) -> None:
    """Add the contact forces to the generalized forces, and fill the rates of all joints.

    Parameters
    ----------
    onset : ndarray, shape (joints,)
        As in ``contact_forces``.
    states : records of STATE
        Noted contacts.
    force : ndarray, shape (3 bodies,)
    rates : ndarray, shape (JOINT_RATES joints,)
    """
    for k in range(joints.shape[0]):
        joint = joints[k]
        base = JOINT_RATES * k
        contact = states[k]
        load = load_of(joint, onset[k], contact)
        rates[base], rates[base + 1] = loss_powers(contact, load.normal, load.tangential)
        rates[base + 2], rates[base + 3] = dose_rates(joint, contact, load.normal)
        if load.normal > 0.0:
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
