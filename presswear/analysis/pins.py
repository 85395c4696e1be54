"""Initial states with changed positions and velocities of pins in their clearances.

Driven bodies and ideal joints do not change.
"""

import numpy as np

from presswear.engines.base import Start, with_velocity
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints, constraints_of
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

NEWTON_STEPS = 8  # Newton steps that move pins; three suffice
CONTACT_GAP = 1e-4  # gap over clearance of a pin that would start in contact


def eccentricities(linkage: Linkage, position: Array) -> Array:
    """Return pin centre minus bearing centre of each joint, shape (joints, 2), m, global."""
    rows, pins = _rows(linkage)
    phi, _, _, _ = rows.evaluate(0.0, position, np.zeros_like(position))
    return -phi[pins].reshape(-1, 2)


def capped(eccentricity: Array, clearance: Array) -> Array:
    """Return eccentricities, shape (joints, 2), that are short enough for a gap at each pin.

    A pin that starts in contact at rest would have a closing speed near zero, for which
    the damping is unbounded. All pins therefore start with a gap.
    """
    excess = np.hypot(*eccentricity.T) / ((1.0 - CONTACT_GAP) * clearance)
    return eccentricity / np.maximum(excess, 1.0)[:, np.newaxis]


def move_pins(linkage: Linkage, position: Array, eccentricity: Array) -> Array:
    """Return the coordinates at t = 0 with given eccentricities of the pins, (3 bodies,)."""
    rows, pins = _rows(linkage)
    moved = position.copy()
    rest = np.zeros_like(position)
    for _ in range(NEWTON_STEPS):
        phi, _, _, jacobian = rows.evaluate(0.0, moved, rest)
        phi[pins] += eccentricity.ravel()
        moved -= np.linalg.lstsq(jacobian, phi, rcond=None)[0]
    return moved


def kick_pins(linkage: Linkage, start: Start, change: Array) -> Start:
    """Return a start whose pins have a changed velocity, shape (joints, 2), m/s, global.

    The velocity is that of the pin relative to its bearing. If joints have redundant
    constraints, the change is the least-squares solution.
    """
    rows, pins = _rows(linkage)
    jacobian = rows.evaluate(0.0, start.position, start.velocity)[3]
    rates = np.zeros(rows.rows)
    rates[pins] = -change.ravel()
    velocity = start.velocity + np.linalg.lstsq(jacobian, rates, rcond=None)[0]
    return with_velocity(linkage, start.position, velocity)


def _rows(linkage: Linkage) -> tuple[Constraints, slice]:
    """Return the constraints of the linkage with ideal joints, and the rows of its pins."""
    for corner in linkage.corners:
        raise InputError(
            f"{corner.guide.name}: allowed is no clearance of a guide where pins are moved"
        )
    ideal = linkage.ideal
    pins = slice(2 * len(linkage.revolutes), 2 * len(ideal.revolutes))
    return constraints_of(ideal), pins
