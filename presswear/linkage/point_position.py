"""Position of a point of a body in a position of a linkage."""

import math
from collections.abc import Sequence

from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment


def point_position(
    linkage: Linkage, point: Attachment, position: Sequence[float]
) -> tuple[float, float]:
    """Return the global coordinates of a point of a body or of the frame, m.

    ``position`` are the coordinates of all bodies, (3 bodies,).
    """
    if point.body == GROUND:
        return point.x, point.y
    x, y, angle = position[3 * linkage.index(point.body) :][:3]
    c = math.cos(angle)
    s = math.sin(angle)
    return x + c * point.x - s * point.y, y + s * point.x + c * point.y
