"""Bumps on surfaces after a wear update in one jump, compared with the penetration.

A jump multiplies the noise of a wear map by millions of cycles. A bump that is higher than
the penetration interrupts the contact: contacts, peak forces and accelerations are then
those of the bumps of this map, and not those of a worn surface. The load distance is hardly
affected.
"""

from collections.abc import Sequence

import numpy as np

from presswear.campaign.ensemble import Ensemble
from presswear.recording.recorder import Recorder
from presswear.results.stage_statistics import Bumps
from presswear.tools.arrays import Array


def bumps_of(ensemble: Ensemble, recorders: Sequence[Recorder]) -> list[Bumps | None]:
    """Return the bumps of each joint beside the penetration in some runs.

    None if the surfaces are not those of a jump, if one replicate does not show their
    noise, or if no contact was recorded.
    """
    joints = ensemble.linkage.clearances
    # The second set of replicates, each on its own surfaces, runs after a jump only.
    surfaces = ensemble.depth[ensemble.replicates :]
    if len(surfaces) < 2:
        return [None] * len(joints)
    bumps: list[Bumps | None] = []
    for k, joint in enumerate(joints):
        penetration = median_penetration(recorders, k)
        if penetration is None:
            bumps.append(None)
        else:
            height = noise_of(surfaces[:, k, :, : joint.bins])
            bumps.append(Bumps(height, penetration))
    return bumps


def noise_of(depth: Array) -> float:
    """Return the rms noise of the mean of the surfaces of all replicates, m.

    It is the standard deviation between the surfaces at each angle, divided by the square
    root of their number. The variances of bearing and pin are added, because the gap is
    the sum of both depths.

    Parameters
    ----------
    depth : ndarray, shape (replicates, 2, bins)
        Worn depth of bearing and pin, m.
    """
    variance = depth.var(axis=0, ddof=1) / len(depth)
    return float(np.sqrt(variance.sum(axis=0).mean()))


def median_penetration(recorders: Sequence[Recorder], joint: int) -> float | None:
    """Return the penetration that is exceeded for half of the time in contact, m.

    The time is that of the recorded series. None if no contact was recorded.
    """
    times = [np.diff(recorder.series("time")) for recorder in recorders]
    depths = [recorder.series("penetration", joint)[1:] for recorder in recorders]
    duration = np.concatenate(times)
    depth = np.concatenate(depths)
    closed = depth > 0.0
    if not closed.any():
        return None
    order = np.argsort(depth[closed])
    time = np.cumsum(duration[closed][order])
    return float(depth[closed][order][np.searchsorted(time, 0.5 * time[-1])])
