"""The multiplier system S lambda = r with S = Phi_q M^-1 Phi_q^T, solved sparsely.

The mass matrix is diagonal, so that equation 18 reduces to one equation per
constraint row, and two rows couple only where they share a body.  The elimination
order, the fill and every single product are worked out once for a linkage
(minimum degree); what is left at run time is a list of multiplications.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.constraints import Constraints
from presswear.tools.compiled import compiled

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
