"""Forces of contacts, springs and loads on all bodies in any state, one state at a time."""

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.physics.contact import CONTACT
from presswear.physics.equations.function import END, FORCE, function_of, model_of
from presswear.physics.equations.integrals import Layout
from presswear.physics.equations.writer import write_body_forces
from presswear.physics.forces import BRISTLE, JOINT_RATES
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import pack_arguments


class BodyForces:
    """Written forces of a linkage as a function of Python.

    Attributes
    ----------
    contacts : ndarray of CONTACT
        Contacts of the state evaluated last, with their forces.
    joint_rates : ndarray
        Rates of losses and wear in that state, shape (joints, JOINT_RATES), see ``physics.forces``.
    bristles : ndarray
        Deflections of the bristles of the joints' friction, m, shape (joints,).
    """

    def __init__(self, linkage: Linkage, packed: Packed, onset: Array | None = None) -> None:
        """Write the forces; without ``onset``, all contacts close at their present rate."""
        count = len(packed.joints)
        onset = np.zeros(count) if onset is None else onset
        equations = write_body_forces(linkage, packed)
        self.contacts = np.zeros(count, CONTACT)
        self._model = model_of(linkage, equations, packed, onset, self.contacts)
        self._arguments = pack_arguments(self._model)
        self._function = function_of(equations.text)
        self._layout = Layout.of(packed.mass.size, packed)
        self._y, self._rates = np.zeros((2, equations.size))
        joints = slice(self._layout.first_joint, self._layout.first_torque)
        self.joint_rates = self._rates[joints].reshape(count, JOINT_RATES)
        self.bristles = self._y[joints].reshape(count, JOINT_RATES)[:, BRISTLE]

    def __call__(self, t: float, q: Array, v: Array) -> Array:
        """Return forces and moments on the bodies, N and N m, shape (3 bodies,)."""
        n = self._layout.coordinates
        self._y[:n] = q
        self._y[n : 2 * n] = v
        self._function(self._arguments, t, self._y, self._rates, END)
        return self._model.bodies[FORCE]

    @property
    def power(self) -> float:
        """Power of loads with a law and of dampers in the state evaluated last, W."""
        return float(self._rates[self._layout.load_work]) if self._layout.has_work else 0.0
