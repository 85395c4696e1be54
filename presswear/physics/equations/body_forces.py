"""Forces of contacts, springs and loads on all bodies in any state, one state at a time."""

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.contact import CONTACT
from presswear.physics.equations.function import END, FORCE, function_of, model_of
from presswear.physics.equations.layout import WEAR_INTEGRAL_COUNT
from presswear.physics.equations.writer import write_body_forces
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.packing import pack_arguments


class BodyForces:
    """Forces on all bodies of a linkage as a Python function; it calls the written forces.

    Attributes
    ----------
    contacts : ndarray of CONTACT
        Contacts of the state evaluated last, with their forces.
    energies, wear_rates : ndarray
        Powers in that state, W, in the order of ``layout.ENERGIES``; rates of wear of
        the joints, shape (joints, WEAR_INTEGRAL_COUNT).
    states : ndarray
        States of interactions that the next evaluation takes, m.
    """

    def __init__(
        self, linkage: Linkage, packed: Packed, onset: Array | None = None
    ) -> None:
        """Write the forces; without ``onset``, all contacts close at their present rate."""
        count = len(packed.joints)
        onset = np.zeros(count) if onset is None else onset
        equations = write_body_forces(linkage, packed)
        self.contacts = np.zeros(count, CONTACT)
        self._model = model_of(linkage, equations, packed, onset, self.contacts)
        self._arguments = pack_arguments(self._model)
        self._function = function_of(equations.text)
        layout = equations.layout
        self._y = np.zeros(layout.size)
        self._rates = np.zeros(layout.size)
        self.states = self._y[layout.first_state : layout.first_energy]
        self.energies = self._rates[layout.first_energy : layout.first_wear_integral]
        self.wear_rates = self._rates[
            layout.first_wear_integral : layout.first_torque
        ].reshape(count, WEAR_INTEGRAL_COUNT)

    def __call__(self, t: float, q: Array, v: Array) -> Array:
        """Return forces and moments on the bodies, N and N m, shape (3 bodies,)."""
        n = q.size
        self._y[:n] = q
        self._y[n : 2 * n] = v
        self._function(self._arguments, t, self._y, self._rates, END)
        return self._model.bodies[FORCE]
