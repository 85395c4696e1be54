"""Starts spread over the phase space of the clearances."""

import math
from dataclasses import dataclass

import numpy as np

from presswear.analysis.pins import capped, kick_pins, move_pins
from presswear.engines.base import Start, with_velocity
from presswear.linkage.linkage import Linkage
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

INSTANTS = 720  # of a cycle at which the largest acceleration is searched


@dataclass(frozen=True)
class SpreadStarts:
    """Positions and velocities of the pins relative to their bearings, global, in SI units."""

    eccentricity: Array  # shape (starts, joints, 2), m, within the clearances
    velocity: Array  # shape (starts, joints, 2), m/s, up to ``crossing_speeds``

    def start(self, index: int, linkage: Linkage, ideal: Start) -> Start:
        """Return one initial state; all but the pins is that of the ideal linkage."""
        clearance = np.array([joint.clearance for joint in linkage.clearances])
        target = capped(self.eccentricity[index], clearance)
        position = move_pins(linkage, ideal.position, target)
        # in the bearings
        at_rest = with_velocity(linkage.ideal, position, ideal.velocity)
        return kick_pins(linkage, at_rest, self.velocity[index])


def crossing_speeds(scene: Scene) -> Array:
    """Return the speed at which a pin crosses each clearance, shape (joints,), m/s.

    It is reached from rest over the diametral clearance 2 c under the largest
    acceleration a of a centre of mass in the ideal motion: v = sqrt(2 a 2 c).
    """
    times = np.linspace(0.0, scene.mechanism.period, INSTANTS, endpoint=False)
    acceleration = scene.ideal.at(times).acceleration
    largest = float(np.hypot(acceleration[:, 0::3], acceleration[:, 1::3]).max())
    clearances = [joint.clearance for joint in scene.linkage().clearances]
    return np.sqrt(4.0 * largest * np.array(clearances))


def spread_starts(scene: Scene, count: int) -> SpreadStarts:
    """Return starts whose pins and velocities fill discs evenly.

    The points are those of a scrambled Halton sequence (Owen, 2017) of the seed of the
    scene, so that more starts begin with the same ones.
    """
    from scipy.stats import qmc  # slow to import

    clearance = np.array([joint.clearance for joint in scene.linkage().clearances])
    joints = len(clearance)
    points = qmc.Halton(4 * joints, seed=scene.seed).random(count)
    places, speeds = np.moveaxis(points.reshape(count, 2, joints, 2), 1, 0)
    return SpreadStarts(
        clearance[:, np.newaxis] * _in_disc(places),
        crossing_speeds(scene)[:, np.newaxis] * _in_disc(speeds),
    )


def _in_disc(points: Array) -> Array:
    """Return points of the unit square as points of the unit disc, even over its area."""
    radius = np.sqrt(points[..., 0])
    angle = 2.0 * math.pi * points[..., 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
