"""The multiplier system S lambda = r with S = Phi_q M^-1 Phi_q^T, solved sparsely.

The mass matrix is diagonal, so that equation 18 reduces to one equation per
constraint row, and two rows couple only where they share a body.  The elimination
order, the fill and every single product are worked out once for a linkage
(minimum degree); what is left at run time is a list of multiplications.  With the multipliers
a state is moved onto the constraints.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import Constraints, constraint_rows
from presswear.tools.compile import Records, compiled, copy_to

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Elimination(NamedTuple):
    """The worked-out elimination; rows are numbered in elimination order.

    Attributes
    ----------
    order : ndarray, shape (rows,)
        Constraint row that is eliminated k-th.
    products : ndarray, shape (n, 4)
        S[slot] += J[a] J[b] / m[c] as slot, a, b, c.
    column_start : ndarray, shape (rows + 1,)
        Where the entries below each diagonal begin.
    entry_slot, entry_row : ndarray, shape (entries,)
        Slot and row of each entry below the diagonal; slot k is the diagonal of row k.
    update_start : ndarray, shape (entries + 1,)
    updates : ndarray, shape (n, 2)
        S[target] -= l S[source], by entry.
    slots : int
    """

    order: Indices
    products: Indices
    column_start: Indices
    entry_slot: Indices
    entry_row: Indices
    update_start: Indices
    updates: Indices
    slots: int


@compiled
def solve_multipliers(
    plan: Elimination,
    jacobian: Array,
    inverse_mass: Array,
    right: Array,
    work: Array,
    solution: Array,
) -> None:
    """Solve for the multipliers.

    Parameters
    ----------
    right : ndarray, shape (rows,)
        Right-hand side by constraint row; overwritten.
    work : ndarray, shape (slots,)
        Overwritten.
    solution : ndarray, shape (rows,)
        Result by constraint row.
    """
    rows = plan.order.shape[0]
    products = plan.products
    work[:] = 0.0
    for i in range(products.shape[0]):
        product = jacobian[products[i, 1]] * jacobian[products[i, 2]]
        work[products[i, 0]] += product * inverse_mass[products[i, 3]]
    for k in range(rows):
        inverse = 1.0 / work[k]
        work[k] = inverse
        value = right[plan.order[k]]
        for e in range(plan.column_start[k], plan.column_start[k + 1]):
            factor = work[plan.entry_slot[e]] * inverse
            for u in range(plan.update_start[e], plan.update_start[e + 1]):
                work[plan.updates[u, 0]] -= factor * work[plan.updates[u, 1]]
            right[plan.order[plan.entry_row[e]]] -= factor * value
    for k in range(rows - 1, -1, -1):
        value = right[plan.order[k]]
        for e in range(plan.column_start[k], plan.column_start[k + 1]):
            value -= work[plan.entry_slot[e]] * solution[plan.order[plan.entry_row[e]]]
        solution[plan.order[k]] = value * work[k]


def work_out(constraints: Constraints) -> Elimination:
    """Elimination order and products for the constraints of a linkage."""
    rows = constraints.rows
    entries = [
        {int(constraints.column[e]): e for e in range(*constraints.row_start[row : row + 2])}
        for row in range(rows)
    ]
    neighbours = [
        {j for j in range(rows) if j != i and entries[i].keys() & entries[j].keys()}
        for i in range(rows)
    ]
    order: list[int] = []
    below: list[list[int]] = []
    remaining = set(range(rows))
    while remaining:
        row = min(remaining, key=lambda i: (len(neighbours[i] & remaining), i))
        remaining.remove(row)
        joined = neighbours[row] & remaining
        for i in joined:
            neighbours[i] |= joined - {i}
        order.append(row)
        below.append(sorted(joined))
    place = {row: k for k, row in enumerate(order)}
    slot = {(k, k): k for k in range(rows)}
    column_start, entry_slot, entry_row = [0], [], []
    columns = []
    for k in range(rows):
        column = sorted(place[row] for row in below[k])
        columns.append(column)
        for i in column:
            slot[i, k] = len(slot)
            entry_slot.append(slot[i, k])
            entry_row.append(i)
        column_start.append(len(entry_slot))
    update_start, updates = [0], []
    for k, column in enumerate(columns):
        for i in column:
            # Entry (i, k) changes every later entry (i, j) or (j, i) of its column's rows.
            updates += [(slot[i, j], slot[j, k]) for j in column if j <= i]
            update_start.append(len(updates))
    products = []
    for i in range(rows):
        for j in range(i + 1):
            a, b = entries[order[i]], entries[order[j]]
            products += [(slot[i, j], a[c], b[c], c) for c in a.keys() & b.keys()]

    def pairs(values: Sequence[tuple[int, ...]], width: int) -> Indices:
        return np.array(values, dtype=np.int64).reshape(-1, width)

    return Elimination(
        np.array(order, dtype=np.int64),
        pairs(products, 4),
        np.array(column_start, dtype=np.int64),
        np.array(entry_slot, dtype=np.int64),
        np.array(entry_row, dtype=np.int64),
        np.array(update_start, dtype=np.int64),
        pairs(updates, 2),
        len(slot),
    )


class Held(NamedTuple):
    """The constraints that hold a linkage, with the working space to solve for their multipliers.

    Attributes
    ----------
    constraints, motions : records of CONSTRAINT and MOTION
    row_start, column : ndarray of int
        See ``Constraints``.
    elimination : Elimination
    inverse_mass : ndarray, shape (3 bodies,)
    phi, phi_t, gamma, right, multipliers : ndarray, shape (rows,)
    jacobian : ndarray, shape (entries,)
    work : ndarray, shape (slots,)
    """

    constraints: Records
    motions: Records
    row_start: Indices
    column: Indices
    elimination: Elimination
    inverse_mass: Array
    phi: Array
    phi_t: Array
    gamma: Array
    jacobian: Array
    right: Array
    work: Array
    multipliers: Array


def held_by(constraints: Constraints, mass: Array) -> Held:
    """The constraints of a linkage whose mass matrix has a diagonal, shape (3 bodies,)."""
    elimination = work_out(constraints)
    rows = np.zeros((5, constraints.rows))
    return Held(
        constraints=constraints.records,
        motions=constraints.motions,
        row_start=constraints.row_start,
        column=constraints.column,
        elimination=elimination,
        inverse_mass=1.0 / mass,
        phi=rows[0],
        phi_t=rows[1],
        gamma=rows[2],
        jacobian=constraints.constant.copy(),
        right=rows[3],
        work=np.zeros(elimination.slots),
        multipliers=rows[4],
    )


@compiled
def evaluate_constraints(held: Held, t: float, q: Array, v: Array) -> None:
    """Evaluate Phi, its derivative, gamma and the Jacobian in the working space."""
    constraint_rows(
        held.constraints,
        held.motions,
        held.row_start,
        t,
        q,
        v,
        held.phi,
        held.phi_t,
        held.gamma,
        held.jacobian,
    )


@compiled
def solve(held: Held) -> None:
    """Solve for the multipliers with the right-hand side in ``right``, which is overwritten."""
    solve_multipliers(
        held.elimination,
        held.jacobian,
        held.inverse_mass,
        held.right,
        held.work,
        held.multipliers,
    )


@compiled
def move(held: Held, level: Array) -> None:
    """Take from positions, velocities or accelerations what the right-hand side has them off."""
    solve(held)
    for row in range(held.phi.shape[0]):
        for e in range(held.row_start[row], held.row_start[row + 1]):
            c = held.column[e]
            level[c] -= held.inverse_mass[c] * held.jacobian[e] * held.multipliers[row]


@compiled
def project(held: Held, t: float, q: Array, v: Array) -> None:
    """Move a state onto the constraints: one Newton step for q, an exact one for v.

    Both in the metric of the mass matrix, so that the change of kinetic energy is
    of second order in the violation.
    """
    evaluate_constraints(held, t, q, v)
    copy_to(held.right, held.phi)
    move(held, q)
    evaluate_constraints(held, t, q, v)
    copy_to(held.right, held.phi_t)
    move(held, v)


@compiled
def project_acceleration(held: Held, t: float, q: Array, v: Array, a: Array) -> None:
    """Move accelerations onto the constraints of a state; leaves what that adds to multipliers."""
    evaluate_constraints(held, t, q, v)
    for row in range(held.phi.shape[0]):
        held.right[row] = -held.gamma[row]
        for e in range(held.row_start[row], held.row_start[row + 1]):
            held.right[row] += held.jacobian[e] * a[held.column[e]]
    move(held, a)
