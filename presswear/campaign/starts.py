"""Where runs start: the ideal mechanism, or a hair's breadth beside it."""

import math

import numpy as np

from presswear.engines.base import Start
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.scene.scene import Scene

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
APART = 1e-9
"""How far one start is from the next, m; grown to the size of a clearance in a cycle or two."""


def start_of(scene: Scene, index: int = 0) -> Start:
    """Pins centred in their bearings, positions and velocities of the ideal mechanism.

    Parameters
    ----------
    index : int
        Of several starts, each beside the other by APART; the scene's seed moves all of them by
        parts of that.
    """
    motion = scene.ideal.at(np.zeros(1))
    start = Start(motion.position[0], motion.velocity[0])
    # Multiples of the golden ratio leave no two seeds close together.
    distance = (index + scene.seed * GOLDEN % 1.0) * APART
    if distance == 0.0:
        return start
    return disturbed(scene.linkage(), start, distance) or start


def turned_back(end: Start, start: Start) -> Start:
    """Take a state after whole cycles as a start: without the full turns of its bodies."""
    position = end.position.copy()
    turns = np.round((position[2::3] - start.position[2::3]) / (2.0 * math.pi))
    position[2::3] -= 2.0 * math.pi * turns
    return Start(position, end.velocity)


def disturbed(linkage: Linkage, start: Start, distance: float) -> Start | None:
    """The start moved along a direction that the joints leave free; None if there is none.

    Of the free directions the one that moves the slider most is taken.

    Parameters
    ----------
    distance : float
        Change of the coordinate that changes most, m or rad.
    """
    constraints = constraints_of(linkage)
    jacobian = constraints.evaluate(0.0, start.position, start.velocity)[3]
    from scipy.linalg import null_space  # slow to import

    free = null_space(jacobian)
    if free.shape[1] == 0:
        return None
    probe = 3 * linkage.index(linkage.probe.body)
    along = [math.cos(linkage.probe.direction), math.sin(linkage.probe.direction)]
    weights = np.array(along) @ free[probe : probe + 2]
    moved = free @ weights if np.linalg.norm(weights) > 1e-6 else free[:, 0]
    position = start.position + distance * moved / np.abs(moved).max()
    # The step along the tangent leaves the constraints by less than round-off;
    # velocities have to follow the turned tangent.
    _, error, _, jacobian = constraints.evaluate(0.0, position, start.velocity)
    return Start(position, start.velocity - np.linalg.pinv(jacobian) @ error)
