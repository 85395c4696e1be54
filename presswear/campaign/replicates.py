"""Initial states of runs: the ideal mechanism, or a state close to it."""

import math

import numpy as np

from presswear.engines.base import Start
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.scene.scene import Scene

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
SPREAD = 0.02
"""Range of the replicates' initial states, part of the smallest clearance.  Replicates 1e-9 m apart
share most of their first two cycles, and means of few cycles are too narrow by that."""
SPREAD_CLOSED = 1e-9
"""The same where no joint has clearance, m."""
NEWTON_STEPS = 2
"""Iterations that close the joints: the first leaves the square of a part of the clearance."""


def start_of(scene: Scene, index: int = 0) -> Start:
    """Return the initial state of a replicate.

    The first replicate of seed 0 has its pins centred in their bearings, with positions and
    velocities of the ideal mechanism. All others are moved along a free direction.

    Parameters
    ----------
    index : int
        Number of the replicate.
    """
    motion = scene.ideal.at(np.zeros(1))
    start = Start(motion.position[0], motion.velocity[0])
    # Multiples of two independent irrational numbers leave no two replicates close together.
    part = (index * GOLDEN + scene.seed * math.sqrt(2.0)) % 1.0
    if part == 0.0:
        return start
    linkage = scene.linkage()
    clearances = [joint.clearance for joint in linkage.clearances]
    spread = SPREAD * min(clearances) if clearances else SPREAD_CLOSED
    moved = disturbed(linkage, start, part * spread)
    return start if moved is None else _closed(linkage, moved)


def _closed(linkage: Linkage, start: Start) -> Start:
    """Return the state nearest to ``start`` that satisfies the constraints to round-off."""
    constraints = constraints_of(linkage)
    position = start.position
    for _ in range(NEWTON_STEPS):
        gap, _, _, jacobian = constraints.evaluate(0.0, position, start.velocity)
        position = position - np.linalg.pinv(jacobian) @ gap
    _, error, _, jacobian = constraints.evaluate(0.0, position, start.velocity)
    return Start(position, start.velocity - np.linalg.pinv(jacobian) @ error)


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
    probe = 3 * linkage.index(linkage.output.body)
    along = [math.cos(linkage.output.direction), math.sin(linkage.output.direction)]
    weights = np.array(along) @ free[probe : probe + 2]
    moved = free @ weights if np.linalg.norm(weights) > 1e-6 else free[:, 0]
    position = start.position + distance * moved / np.abs(moved).max()
    # The step along the tangent leaves the constraints by the square of the distance;
    # velocities have to follow the turned tangent.
    _, error, _, jacobian = constraints.evaluate(0.0, position, start.velocity)
    return Start(position, start.velocity - np.linalg.pinv(jacobian) @ error)
