"""Starts spread over the phase space of the clearances."""

import math
from dataclasses import dataclass

import numpy as np

from presswear.analysis.pins import capped, kick_pins, move_pins
from presswear.engines.base import Start, with_velocity
from presswear.linkage.linkage import Linkage
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

INSTANTS = 720  # instants of a cycle at which accelerations are compared


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
