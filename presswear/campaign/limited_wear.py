"""Wear that a limit of a quick life bounds, as numbers that are linear in the depths."""

from dataclasses import dataclass

import numpy as np

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner, tilting_clearance
from presswear.linkage.linkage import Linkage
from presswear.physics.wall_wear import openings_between, wall_volume, walls_of
from presswear.physics.wear import worn_volume
from presswear.scene.options import Limit
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class LimitedWear:
    """Wear of a pin and its bearing, or of both walls of a guide, under a limit."""

    limit: Limit
    number: int  # index of the clearance joint; for a guide the index of a corner
    joint: ClearanceJoint

    @property
    def bound(self) -> float:
        """Largest value of ``numbers``, SI; of a tilt the depth of two opposite walls, m."""
        if isinstance(self.joint, GuideCorner) and self.limit.name == "tilt":
            needed = tilting_clearance(self.joint.guide, self.limit.value)
            return 2.0 * (needed - self.joint.clearance)
        return self.limit.value

    def numbers(self, depth: Array) -> Array:
        """Return the numbers that are bounded, from depths of both surfaces, m, (2, bins)."""
        if not isinstance(self.joint, GuideCorner):
            is_volume = self.limit.name == "wear_volume"
            return np.array([worn_volume(self.joint, depth)]) if is_volume else depth
        if self.limit.name == "tilt":
            return openings_between(self.joint, depth)
        if self.limit.name == "wear_volume":
            return np.array([wall_volume(self.joint, depth)])
        return depth

    def depth_of(self, linkage: Linkage, maps: Array) -> Array:
        """Return depths of both surfaces, m, (2, bins), from maps of all joints."""
        if isinstance(self.joint, GuideCorner):
            return walls_of(linkage, maps)[self.joint.guide.name]
        return np.asarray(maps[self.number, :, : self.joint.bins])


def limited_wear(linkage: Linkage, limit: Limit) -> LimitedWear:
    """Return the wear under a limit of a quick life."""
    for number, joint in enumerate(linkage.clearances):
        owner = joint.guide.name if isinstance(joint, GuideCorner) else joint.name
        if owner == limit.joint:
            return LimitedWear(limit, number, joint)
    raise AssertionError(limit.key)
