"""Forces on the bodies beside those of joints and contacts: weight, springs and loads."""

import numpy as np
from numpy.typing import NDArray

from presswear.physics.load_modes import settle_loads
from presswear.physics.loads import load_forces
from presswear.physics.packed import Packed
from presswear.physics.springs import spring_forces
from presswear.tools.compile import compiled, copy_to, inlined

Array = NDArray[np.float64]


@inlined
def applied_forces(packed: Packed, t: float, q: Array, v: Array, force: Array) -> float:
    """Fill the generalized forces, shape (3 bodies,), before those of contacts.

    Returns
    -------
    float
        Power that no stored energy stands for, of loads with a law and of dampers, W.
    """
    copy_to(force, packed.weight)
    power = 0.0
    if packed.springs.shape[0] > 0:
        power = spring_forces(packed.springs, q, v, force)
    return power + load_forces(packed.loads, t, q, v, force)


@compiled
def settle_modes(packed: Packed, t: float, q: Array, v: Array, a: Array) -> int:
    """Bring the modes of the loads up to an accepted state; returns how many have changed."""
    return settle_loads(packed.loads, t, q, v, a)


def has_work(packed: Packed) -> bool:
    """True where ``applied_forces`` may return a power."""
    return packed.loads is not None or bool(np.any(packed.springs["damping"] != 0.0))
