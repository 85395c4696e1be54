"""Equations of motion in index-1 form (equations 14 to 20 of the paper).

M q'' + Phi_q^T lambda = g with Phi_q q'' = gamma - 2 alpha Phi' - beta^2 Phi.  The
state is y = (q, q', integrals): positions, velocities, and as quadratures the drive
work, its absolute value, and per clearance joint the rates of ``add_contacts``; last, where
there is any, the work of loads and dampers.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.applied import applied_forces, has_work
from presswear.physics.constraints import DRIVE, Constraints
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.forces import BRISTLE, JOINT_RATES, add_contacts
from presswear.physics.motion import drive_motion
from presswear.physics.multipliers import Held, evaluate_constraints, held_by, solve
from presswear.physics.packed import Packed
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

DRIVE_INTEGRALS = 2
"""Integrals before those of the joints: drive work and its absolute value, J."""
JOINT_INTEGRALS = JOINT_RATES
"""Integrals per joint: those of the rates of ``add_contacts``."""


class System(NamedTuple):
    """A linkage as the kernels see it, with working space.

    ``has_work`` tells whether loads or dampers do any.
    """

    packed: Packed
    held: Held
    contacts: Records
    alpha: float
    beta: float
    has_work: bool


@compiled
def bristle_place(coordinates: int, k: int) -> int:
    """Place in the state of the deflection of the bristles of joint ``k``."""
    return coordinates + DRIVE_INTEGRALS + JOINT_INTEGRALS * k + BRISTLE


@compiled
def note_bristles(contacts: Records, y: Array, n: int) -> None:
    """Fill in the deflections of bristles, which are among the integrals of a state."""
    for k in range(contacts.shape[0]):
        contacts[k].bristle = y[bristle_place(2 * n, k)]


@compiled
def rates(system: System, onset: Array, t: float, y: Array, out: Array) -> None:
    """Fill dy/dt; leaves the multipliers in ``system``."""
    n = system.held.inverse_mass.shape[0]
    q = y[:n]
    v = y[n : 2 * n]
    force = out[n : 2 * n]
    power = applied_forces(system.packed, t, q, v, force)
    if system.has_work:
        out[out.shape[0] - 1] = power
    rest = out[2 * n + DRIVE_INTEGRALS :]
    note_contacts(system.packed, system.contacts, q, v)
    note_bristles(system.contacts, y, n)
    add_contacts(system.packed.joints, onset, system.contacts, force, rest)
    held = system.held
    evaluate_constraints(held, t, q, v)
    damping = 2.0 * system.alpha
    stiffness = system.beta * system.beta
    for row in range(held.phi.shape[0]):
        right = damping * held.phi_t[row] + stiffness * held.phi[row] - held.gamma[row]
        for e in range(held.row_start[row], held.row_start[row + 1]):
            c = held.column[e]
            right += held.jacobian[e] * held.inverse_mass[c] * force[c]
        held.right[row] = right
    solve(held)
    for row in range(held.phi.shape[0]):
        multiplier = held.multipliers[row]
        for e in range(held.row_start[row], held.row_start[row + 1]):
            force[held.column[e]] -= held.jacobian[e] * multiplier
    power = 0.0
    for i in range(held.constraints.shape[0]):
        c = held.constraints[i]
        if c.kind == DRIVE:
            power -= held.multipliers[c.row] * drive_motion(held.motions[c.drive], t)[1]
    out[2 * n] = power
    out[2 * n + 1] = abs(power)
    for i in range(n):
        out[i] = v[i]
        force[i] *= held.inverse_mass[i]


def system_of(packed: Packed, constraints: Constraints, alpha: float, beta: float) -> System:
    """The equations of a linkage; ``alpha`` and ``beta`` are Baumgarte's coefficients, 1/s."""
    return System(
        packed=packed,
        held=held_by(constraints, packed.mass),
        contacts=np.zeros(len(packed.joints), CONTACT),
        alpha=alpha,
        beta=beta,
        has_work=has_work(packed),
    )
