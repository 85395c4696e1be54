"""Groups of constraint rows that can be solved one after the other."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Group = tuple[NDArray[np.int64], NDArray[np.int64]]  # rows, and as many coordinates
# Least rows of a group. With fewer rows numpy takes longer than LAPACK; with hundreds of
# rows LAPACK starts threads for each of thousands of small matrices.
MIN_GROUP = 30


def row_groups(pattern: NDArray[np.bool_]) -> list[Group]:
    """Return groups of rows and coordinates of a square Jacobian, in the order of solution.

    The rows of a group depend only on the coordinates of this group and of the groups
    before it. The groups are the irreducible blocks of the Jacobian, joined to at least
    ``MIN_GROUP`` rows. A Jacobian that is singular for any values is one group.

    Parameters
    ----------
    pattern : array of bool, (rows, coordinates)
        Elements of the Jacobian that can differ from zero.
    """
    rows = np.arange(len(pattern))
    columns = matched_columns(pattern)
    if columns is None:
        return [(rows, rows)]
    # Element (i, j) is true if row i contains the coordinate that row j determines.
    needs = pattern[:, columns]
    # Also true if it does so through other rows.
    for _ in range(rows.size.bit_length()):
        needs = needs @ needs
    block = (needs & needs.T).argmax(axis=1)
    order = np.lexsort((block, needs.sum(axis=1)))
    cuts = [0]
    for before in map(int, np.flatnonzero(np.diff(block[order]))):
        if before + 1 - cuts[-1] >= MIN_GROUP:
            cuts.append(before + 1)
    groups = [order[first:last] for first, last in pairwise([*cuts, rows.size])]
    return [(group, columns[group]) for group in groups]


def matched_columns(pattern: NDArray[np.bool_]) -> NDArray[np.int64] | None:
    """Return a coordinate for each row that contains it, each coordinate once.

    None if there is no such choice. It is the maximum matching of a bipartite graph, by
    augmenting paths.
    """
    row_of: dict[int, int] = {}  # row that determines a coordinate

    def augment(row: int, tried: set[int]) -> bool:
        for column in map(int, np.flatnonzero(pattern[row])):
            if column in tried:
                continue
            tried.add(column)
            if column not in row_of or augment(row_of[column], tried):
                row_of[column] = row
                return True
        return False

    for row in range(len(pattern)):
        if not augment(row, set()):
            return None
    return np.array(sorted(row_of, key=row_of.__getitem__))
