"""Corners of a slide in a guide with clearance, and the wear maps of its walls."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from presswear.linkage.clearance_joint import ClearanceJoint, deepest_wear
from presswear.linkage.joints import Guide
from presswear.linkage.points import Attachment

# Bins of a wall along its length; those of a press are half a millimetre long
WALL_BINS = 1000
WALLS = ("left", "right")  # walls of a guide, seen along its direction


@dataclass(frozen=True)
class WallMap:
    """Map of the wear along a wall, which both corners of the slide on its side share."""

    coefficient: float  # K_d, 1/Pa
    start: float  # start of the map along the guide, from the point of the guide, m
    length: float  # m

    @property
    def bin_length(self) -> float:
        """Length of a bin, m."""
        return self.length / WALL_BINS


@dataclass(frozen=True)
class GuideCorner(ClearanceJoint):
    """Corner of a slide in a guide with clearance, which touches one of the two walls.

    ``pin`` is the corner. ``bearing`` is a point on the guide's body, half the width of
    the slide beside the guide's line. The clearance lies between this point and the
    wall. The pin radius is half the width. The surface of the bearing is the wall, over
    the bins of its map; both corners on a side share it. The slide does not wear.
    """

    guide: Guide = field(kw_only=True)
    # side of the wall: 1 left of the direction, -1 right
    side: float = field(kw_only=True)
    # None: no wear of the wall is computed
    wall: WallMap | None = field(default=None, kw_only=True)

    @property
    def deepest_wear(self) -> float:
        """Depth up to which the model of a worn wall holds, m."""
        return deepest_wear("foundation", self.clearance, self.pin_radius)

    @property
    def map_area(self) -> float:
        """Area of the map of the wall, m^2; zero without a map."""
        return 0.0 if self.wall is None else self.width * self.wall.length

    @property
    def bins(self) -> int:
        """Bins of the map of the wall; one without a map."""
        return 1 if self.wall is None else WALL_BINS


def slide_inertia(mass: float, guide: Guide) -> float:
    """Return the inertia of a slide, kg m^2, as a block of the size that its guide has."""
    length, width = guide.size
    return mass * (length**2 + width**2) / 12.0


def turning_clearance(guide: Guide) -> float:
    """Return the clearance, m, with which the walls are as far apart as the slide's diagonal."""
    length, width = guide.size
    return 0.5 * (math.hypot(length, width) - width)


def largest_tilt(guide: Guide, clearance: float) -> float:
    """Return the tilt at which two opposite corners touch rigid walls, rad.

    It solves (W / 2) (1 - cos p) = (L / 2) sin p - c.
    """
    length, width = guide.size
    diagonal = math.hypot(length, width)
    return math.asin((width + 2.0 * clearance) / diagonal) - math.atan2(width, length)


def tilting_clearance(guide: Guide, tilt: float) -> float:
    """Return the clearance, m, with which the largest tilt is ``tilt``, rad."""
    length, width = guide.size
    diagonal = math.hypot(length, width)
    return 0.5 * (diagonal * math.sin(tilt + math.atan2(width, length)) - width)


CORNERS: Mapping[str, tuple[float, float]] = {
    "left front": (1.0, 1.0),
    "left back": (-1.0, 1.0),
    "right front": (1.0, -1.0),
    "right back": (-1.0, -1.0),
}
"""Corners of a slide by name: place along the guide and side, parts of half its size."""


def corner_ends(
    guide: Guide, along: float, side: float
) -> tuple[Attachment, Attachment]:
    """Return the point beside which a corner of a slide stands, and the corner.

    ``along`` and ``side`` are a value of ``CORNERS``. The point is on the frame, or on the
    body that carries the walls.
    """
    length, width = guide.size
    y = 0.5 * side * width
    cosine = math.cos(guide.direction)
    sine = math.sin(guide.direction)
    beside = Attachment(guide.on, guide.x - sine * y, guide.y + cosine * y)
    x = 0.5 * along * length
    turn = guide.direction - guide.angle
    cosine = math.cos(turn)
    sine = math.sin(turn)
    corner = Attachment(guide.body, cosine * x - sine * y, sine * x + cosine * y)
    return beside, corner
