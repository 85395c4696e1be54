"""Initial states with changed positions and velocities of pins in their clearances.

Driven bodies and ideal joints do not change. Slides in guides with clearance can be
moved, too.
"""

import numpy as np

from presswear.engines.base import Start, with_velocity
from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints, constraints_of
from presswear.tools.arrays import Array

NEWTON_STEPS = 8  # Newton steps that move pins; three suffice
CONTACT_GAP = 1e-4  # gap over clearance of a pin that would start in contact


def eccentricities(linkage: Linkage, position: Array) -> Array:
    """Return pin centre minus bearing centre of each pin, shape (pins, 2), m, global."""
    rows, pins, _ = _rows(linkage)
    phi, _, _, _ = rows.evaluate(0.0, position, np.zeros_like(position))
    return -phi[pins].reshape(-1, 2)


def slides(linkage: Linkage, position: Array) -> Array:
    """Return place across the guide, m, and tilt, rad, of each slide in a guide with clearance.

    The shape is (guides, 2).
    """
    rows, _, guides = _rows(linkage)
    phi, _, _, _ = rows.evaluate(0.0, position, np.zeros_like(position))
    return phi[guides].reshape(-1, 2)


def capped(eccentricity: Array, clearance: Array) -> Array:
    """Return eccentricities, shape (pins, 2), that are short enough for a gap at each pin.

    A pin that starts in contact at rest would have a closing speed near zero, for which
    the damping is unbounded. All pins therefore start with a gap.
    """
    excess = np.hypot(*eccentricity.T) / ((1.0 - CONTACT_GAP) * clearance)
    return eccentricity / np.maximum(excess, 1.0)[:, np.newaxis]


def capped_slides(linkage: Linkage, places: Array) -> Array:
    """Return places and tilts of slides, (guides, 2), that leave a gap at each corner."""
    gaps = [corner.clearance for corner in linkage.corners[:: len(CORNERS)]]
    lengths = [guide.length or 0.0 for guide in linkage.loose_guides]
    reach = np.abs(places[:, 0]) + 0.5 * np.array(lengths) * np.abs(places[:, 1])
    excess = reach / ((1.0 - CONTACT_GAP) * np.array(gaps))
    return places / np.maximum(excess, 1.0)[:, np.newaxis]


def move_pins(
    linkage: Linkage,
    position: Array,
    eccentricity: Array,
    places: Array | None = None,
) -> Array:
    """Return the coordinates at t = 0 with given eccentricities of the pins, (3 bodies,).

    ``places`` are those of the slides as ``slides`` returns them; None: in the middle.
    """
    rows, pins, guides = _rows(linkage)
    moved = position.copy()
    at_rest = np.zeros_like(position)
    for _ in range(NEWTON_STEPS):
        phi, _, _, jacobian = rows.evaluate(0.0, moved, at_rest)
        phi[pins] += eccentricity.ravel()
        if places is not None:
            phi[guides] -= places.ravel()
        moved -= np.linalg.lstsq(jacobian, phi, rcond=None)[0]
    return moved


def kick_pins(linkage: Linkage, start: Start, change: Array) -> Start:
    """Return a start whose pins have a changed velocity, shape (joints, 2), m/s, global.

    The velocity is that of the pin relative to its bearing. If joints have redundant
    constraints, the change is the least-squares solution.
    """
    rows, pins, _ = _rows(linkage)
    jacobian = rows.evaluate(0.0, start.position, start.velocity)[3]
    rates = np.zeros(rows.rows)
    rates[pins] = -change.ravel()
    velocity = start.velocity + np.linalg.lstsq(jacobian, rates, rcond=None)[0]
    return with_velocity(linkage, start.position, velocity)


def _rows(linkage: Linkage) -> tuple[Constraints, slice, slice]:
    """Return the constraints of the linkage with ideal joints, and the rows of pins and slides.

    Guides with clearance are the last ones before the drives.
    """
    ideal = linkage.ideal
    rows = constraints_of(ideal)
    first_pin = 2 * len(linkage.revolutes)
    pins = len(linkage.clearances) - len(linkage.corners)
    end = rows.rows - len(ideal.prescribed_drives)
    guides = slice(end - 2 * len(linkage.loose_guides), end)
    return rows, slice(first_pin, first_pin + 2 * pins), guides
