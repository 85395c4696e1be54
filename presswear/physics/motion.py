"""The motion that drives prescribe."""

from dataclasses import fields

import numpy as np

from presswear.linkage.elements import Drive
from presswear.tools.compiled import Records, compiled

MOTION = np.dtype([(item.name, np.float64) for item in fields(Drive) if item.type is float])
"""The numbers of a drive as the kernels see them, by the names of its fields."""

_TIMES = (0.0, 0.0271, 0.169, 0.577, 1.41, 3.14)
"""Times at which a drive is looked at that may turn steadily, s."""


@compiled
def drive_motion(drive: Records, t: float) -> tuple[float, float, float]:
    """Angle turned since t = 0, rad, speed, rad/s, and acceleration, rad/s^2, of a drive."""
    return drive.speed * t, drive.speed, 0.0


def pack_motion(drive: Drive, motion: Records) -> None:
    """Fill a record of MOTION."""
    for name in MOTION.names or ():
        motion[name] = getattr(drive, name)


def motion_of(drive: Drive) -> Records:
    """A drive as a record of MOTION."""
    motion = np.zeros(1, MOTION)[0]
    pack_motion(drive, motion)
    return motion


def is_steady(drive: Drive) -> bool:
    """True where a drive turns at constant speed."""
    motion = motion_of(drive)
    return all(drive_motion(motion, t)[2] == 0.0 for t in _TIMES)
