"""Roughness of surfaces after a wear update in one jump, and the penetration beside it.

A jump multiplies the noise of a wear map by millions of cycles.  A bump that is higher than the
penetration breaks the contact: contacts, peak forces and accelerations are then those of the bumps
of this map, and not those of a worn surface.  The forces that wear it are hardly affected.
"""

from collections.abc import Sequence

import numpy as np

from presswear.campaign.ensemble import Ensemble
from presswear.recording.recorder import Recorder
from presswear.results.stage import Roughness
from presswear.tools.arrays import Array


def roughness_of(ensemble: Ensemble, recorders: Sequence[Recorder]) -> list[Roughness]:
    """Return the roughness of the surfaces of each joint; the penetration is that of some runs."""
    return [
        Roughness(float(height), median_penetration(recorders, k))
        for k, height in enumerate(surface_noise(ensemble))
    ]


def surface_noise(ensemble: Ensemble) -> Array:
    """Return the rms noise of the mean surfaces, bearing and pin together, m, shape (joints,).

    It is the standard deviation between the surfaces of the replicates at each angle, over the root
    of their number, because the mean surface is that of all their maps.  Zero for one replicate.
    """
    joints, depth = ensemble.linkage.clearances, ensemble.alone.depth
    count = len(depth)
    if count < 2:
        return np.zeros(len(joints))
    variance = depth.var(axis=0, ddof=1) / count
    gaps = [variance[k, :, : joint.bins].sum(axis=0).mean() for k, joint in enumerate(joints)]
    return np.sqrt(gaps)


def median_penetration(recorders: Sequence[Recorder], joint: int) -> float | None:
    """Return the penetration that is exceeded for half of the time in contact, m; None: no contact.

    The time is that of the recorded series.
    """
    depth, weight = [], []
    for recorder in recorders:
        time, penetration = recorder.series("time"), recorder.series("penetration", joint)
        depth.append(penetration[1:])
        weight.append(np.diff(time))
    values, weights = np.concatenate(depth), np.concatenate(weight)
    closed = values > 0.0
    if not closed.any():
        return None
    order = np.argsort(values[closed])
    time_below = np.cumsum(weights[closed][order])
    middle = int(np.searchsorted(time_below, 0.5 * time_below[-1]))
    return float(values[closed][order][middle])
