"""Initial states with changed positions and velocities of pins in their clearances.

Driven bodies and ideal joints do not change. Slides in guides with clearance can be
moved, too. Starts can be spread over the phase space of the clearances.
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.engines.base import Start, with_velocity
from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints, constraints_of
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

NEWTON_STEPS = 8  # Newton steps that move pins; three suffice
INSTANTS = 720  # instants of a cycle at which accelerations are compared
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


@dataclass(frozen=True)
class SpreadStarts:
    """Positions and velocities of the pins relative to their bearings, global, in SI units."""

    eccentricity: Array  # shape (starts, joints, 2), m, within the clearances
    velocity: Array  # shape (starts, joints, 2), m/s, up to ``crossing_speeds``

    def start(self, index: int, linkage: Linkage, ideal: Start) -> Start:
        """Return one initial state: the ideal one with the pins moved in their bearings."""
        clearance = np.array([joint.clearance for joint in linkage.clearances])
        target = capped(self.eccentricity[index], clearance)
        position = move_pins(linkage, ideal.position, target)
        # The pins are at rest relative to their bearings.
        at_rest = with_velocity(linkage.ideal, position, ideal.velocity)
        return kick_pins(linkage, at_rest, self.velocity[index])


def crossing_speeds(scene: Scene) -> Array:
    """Return the speed at which a pin crosses each clearance, shape (joints,), m/s.

    A pin reaches it from rest over the diametral clearance 2 c at an acceleration a:
    v = sqrt(2 a 2 c). Here a is the largest acceleration of a mass centre in the ideal
    motion.
    """
    times = np.linspace(0.0, scene.mechanism.period, INSTANTS, endpoint=False)
    acceleration = scene.ideal.at(times).acceleration
    largest = float(np.hypot(acceleration[:, 0::3], acceleration[:, 1::3]).max())
    clearances = [joint.clearance for joint in scene.linkage().clearances]
    return np.sqrt(4.0 * largest * np.array(clearances))


def spread_starts(scene: Scene, count: int) -> SpreadStarts:
    """Return starts whose pins and velocities fill discs evenly.

    The points are a scrambled Halton sequence (Owen, 2017) with the seed of the scene. A
    larger number of starts therefore contains those of a smaller number.
    """
    from scipy.stats import qmc  # slow to import

    clearance = np.array([joint.clearance for joint in scene.linkage().clearances])
    joints = len(clearance)
    points = qmc.Halton(4 * joints, seed=scene.seed).random(count)
    by_joint = points.reshape(count, 2, joints, 2)
    positions = _in_disc(by_joint[:, 0])
    velocities = _in_disc(by_joint[:, 1])
    return SpreadStarts(
        eccentricity=clearance[:, np.newaxis] * positions,
        velocity=crossing_speeds(scene)[:, np.newaxis] * velocities,
    )


def _in_disc(points: Array) -> Array:
    """Map points of the unit square to the unit disc; equal areas stay equal."""
    radius = np.sqrt(points[..., 0])
    angle = 2.0 * math.pi * points[..., 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
