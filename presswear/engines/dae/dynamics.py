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
from presswear.physics.constraints import DRIVE, Constraints, constraint_rows
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.forces import BRISTLE, JOINT_RATES, add_contacts
from presswear.physics.motion import drive_motion
from presswear.physics.multipliers import Elimination, solve_multipliers, work_out
from presswear.physics.packed import Packed
from presswear.tools.compiled import Records, compiled, copy_to

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

DRIVE_INTEGRALS = 2
"""Integrals before those of the joints: drive work and its absolute value, J."""
JOINT_INTEGRALS = JOINT_RATES
"""Integrals per joint: those of the rates of ``add_contacts``."""


class System(NamedTuple):
    """A linkage as the kernels see it, with working space.

    ``has_work`` tells whether loads or dampers do any; ``inverse_mass`` is (3 bodies,); ``phi``,
    ``phi_t``, ``gamma``, ``right`` and ``multipliers`` are (rows,).
    """

    packed: Packed
    constraints: Records
    motions: Records
    row_start: Indices
    column: Indices
    elimination: Elimination
    inverse_mass: Array
    contacts: Records
    alpha: float
    beta: float
    has_work: bool
    phi: Array
    phi_t: Array
    gamma: Array
    jacobian: Array
    right: Array
    work: Array
    multipliers: Array


@compiled
def evaluate_constraints(system: System, t: float, q: Array, v: Array) -> None:
    """Evaluate Phi, its derivative, gamma and the Jacobian in the system's working space."""
    constraint_rows(
        system.constraints,
        system.motions,
        system.row_start,
        t,
        q,
        v,
        system.phi,
        system.phi_t,
        system.gamma,
        system.jacobian,
    )


@compiled
def solve(system: System) -> None:
    """Solve for the multipliers with the right-hand side in ``right``, which is overwritten."""
    solve_multipliers(
        system.elimination,
        system.jacobian,
        system.inverse_mass,
        system.right,
        system.work,
        system.multipliers,
    )


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
    n = system.inverse_mass.shape[0]
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
    evaluate_constraints(system, t, q, v)
    damping = 2.0 * system.alpha
    stiffness = system.beta * system.beta
    for row in range(system.phi.shape[0]):
        right = damping * system.phi_t[row] + stiffness * system.phi[row] - system.gamma[row]
        for e in range(system.row_start[row], system.row_start[row + 1]):
            c = system.column[e]
            right += system.jacobian[e] * system.inverse_mass[c] * force[c]
        system.right[row] = right
    solve(system)
    for row in range(system.phi.shape[0]):
        multiplier = system.multipliers[row]
        for e in range(system.row_start[row], system.row_start[row + 1]):
            force[system.column[e]] -= system.jacobian[e] * multiplier
    power = 0.0
    for i in range(system.constraints.shape[0]):
        c = system.constraints[i]
        if c.kind == DRIVE:
            power -= system.multipliers[c.row] * drive_motion(system.motions[c.drive], t)[1]
    out[2 * n] = power
    out[2 * n + 1] = abs(power)
    for i in range(n):
        out[i] = v[i]
        force[i] *= system.inverse_mass[i]


@compiled
def project(system: System, t: float, y: Array) -> None:
    """Move a state onto the constraints: one Newton step for q, an exact one for v.

    Both in the metric of the mass matrix, so that the change of kinetic energy is
    of second order in the violation.
    """
    n = system.inverse_mass.shape[0]
    for level in range(2):
        evaluate_constraints(system, t, y[:n], y[n : 2 * n])
        copy_to(system.right, system.phi if level == 0 else system.phi_t)
        solve(system)
        for row in range(system.phi.shape[0]):
            for e in range(system.row_start[row], system.row_start[row + 1]):
                c = system.column[e]
                y[level * n + c] -= (
                    system.inverse_mass[c] * system.jacobian[e] * system.multipliers[row]
                )


def system_of(packed: Packed, constraints: Constraints, alpha: float, beta: float) -> System:
    """The equations of a linkage; ``alpha`` and ``beta`` are Baumgarte's coefficients, 1/s."""
    elimination = work_out(constraints)
    rows = np.zeros((5, constraints.rows))
    return System(
        packed=packed,
        constraints=constraints.records,
        motions=constraints.motions,
        row_start=constraints.row_start,
        column=constraints.column,
        elimination=elimination,
        inverse_mass=1.0 / packed.mass,
        contacts=np.zeros(len(packed.joints), CONTACT),
        alpha=alpha,
        beta=beta,
        has_work=has_work(packed),
        phi=rows[0],
        phi_t=rows[1],
        gamma=rows[2],
        jacobian=constraints.constant.copy(),
        right=rows[3],
        work=np.zeros(elimination.slots),
        multipliers=rows[4],
    )
