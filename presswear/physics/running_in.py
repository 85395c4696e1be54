"""Wear of surfaces that run in: the wear coefficient depends on the worn depth.

A new surface wears rho times as fast as one that has run in, at each point of the
surface on its own:

    dh = K_inf p ds [1 + (rho - 1) exp(-h / h_0)]

The right side without the bracket is Archard's law, by which the engines compute wear.
The equation has a closed form for the depth over any amount of Archard's wear, so that
it does not matter in how many steps the wear is applied.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.physics.user_wear import UserWear
from presswear.tools.arrays import Array


class RunningIn(NamedTuple):
    """Parameters of a pair of surfaces; see ``linkage.materials.Materials``."""

    ratio: float  # rho = K_0 / K_inf, of new surfaces to those that have run in
    depth: float  # h_0, worn depth over which the excess falls to 1/e, m

    def worn(self, depth: Array, archard: Array) -> Array:
        """Return the depth that wears off, m, where Archard's law takes off ``archard``, m.

        h_0 x + h_0 ln[1 + (rho - 1) exp(-h / h_0) (1 - exp(-x))] with x = archard / h_0;
        bumps that stand out of the round surface, h < 0, wear as a new surface.
        """
        x = archard / self.depth
        excess = (self.ratio - 1.0) * np.exp(-np.maximum(depth, 0.0) / self.depth)
        return np.asarray(archard + self.depth * np.log1p(-excess * np.expm1(-x)))

    def archard_depth(self, depth: Array) -> Array:
        """Return the depth that Archard's law takes off a new surface for a worn depth, m.

        Inverse of ``worn`` from h = 0: h + h_0 ln[(1 + (rho - 1) exp(-h / h_0)) / rho].
        """
        fading = np.expm1(-np.maximum(depth, 0.0) / self.depth)
        share = (self.ratio - 1.0) / self.ratio
        return np.asarray(depth + self.depth * np.log1p(share * fading))


DepthLaw = RunningIn | UserWear
Laws = tuple[DepthLaw | None, ...]


def depth_law_of(joint: ClearanceJoint) -> DepthLaw | None:
    """Return the law by which wear depends on the worn depth; None for Archard's."""
    wear = joint.wear
    if wear is None:
        return None
    if wear.user_law is not None:
        return UserWear(wear)
    if wear.running_in == 1.0:
        return None
    return RunningIn(wear.running_in, wear.running_in_depth)


def depth_laws_of(joints: Sequence[ClearanceJoint]) -> Laws:
    """Return the law of each joint by which wear depends on the depth; see ``depth_law_of``."""
    return tuple(map(depth_law_of, joints))


def worn_off(laws: Laws, depth: Array, archard: Array) -> Array:
    """Return the depth that wears off where Archard's law takes off ``archard``, m.

    Parameters
    ----------
    laws : tuple of RunningIn, UserWear or None
        Law of each joint.
    depth : ndarray
        Worn depth before, m, shape (..., joints, 2, bins) of bearings and pins.
    archard : ndarray
        Depth by Archard's law with K_inf, m, of the same shape or broadcast to it.
    """
    if not any(laws):
        return archard
    depth, archard = np.broadcast_arrays(depth, archard)
    worn = archard.copy()
    for k, law in enumerate(laws):
        if law is not None:
            worn[..., k, :, :] = law.worn(depth[..., k, :, :], archard[..., k, :, :])
    return worn


def archard_depth(laws: Laws, depth: Array) -> Array:
    """Return the depth that Archard's law with K_inf takes off new surfaces, m.

    ``depth`` is the depth by which surfaces that run in wear meanwhile, m, shape
    (..., joints, 2, bins).
    """
    if not any(laws):
        return depth
    archard = depth.copy()
    for k, law in enumerate(laws):
        if law is not None:
            archard[..., k, :, :] = law.archard_depth(depth[..., k, :, :])
    return archard
