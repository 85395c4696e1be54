"""Open trees: linkages without a closed loop that has a freedom, in the fewest coordinates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage, branches_of, prescribed_of
from presswear.physics.links import COORDINATES, GUIDED, LOOSE, pack_links
from presswear.physics.prescribed import Prescribed, pack_prescribed
from presswear.tools.compile import Records

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tree:
    """A linkage as an open tree.

    Attributes
    ----------
    links : records of LINK
    names : tuple of str
        Body of each link.
    prescribed : Prescribed
        What it hangs from.
    """

    links: Records
    names: tuple[str, ...]
    prescribed: Prescribed

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(COORDINATES[kind] for kind in self.links["kind"])

    def coordinates(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Coordinates and rates of the tree in a state of all bodies, each (size,)."""
        x, u = np.zeros(self.size), np.zeros(self.size)
        for link in self.links:
            b, c = link["body"], link["place"]
            if link["kind"] == GUIDED:
                along = np.array([link["cosine"], link["sine"]])
                x[c] = along @ (q[b : b + 2] - [link["before_x"], link["before_y"]])
                u[c] = along @ v[b : b + 2]
                continue
            if link["kind"] == LOOSE:
                x[c : c + 2], u[c : c + 2] = q[b : b + 2], v[b : b + 2]
                c += 2
            x[c], u[c] = q[b + 2], v[b + 2]
            if link["parent"] >= 0:
                x[c] -= q[link["before"] + 2]
                u[c] -= v[link["before"] + 2]
        return x, u


def tree_of(linkage: Linkage) -> Tree | str:
    """Describe a linkage as an open tree, or say in words why it is none."""
    branches = branches_of(linkage)
    if isinstance(branches, str):
        return branches
    return Tree(
        pack_links(linkage, branches),
        tuple(branch.end.body for branch in branches),
        pack_prescribed(linkage, prescribed_of(linkage)),
    )
