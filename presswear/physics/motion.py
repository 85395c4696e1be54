"""The motion that drives prescribe."""

import math

import numpy as np

from presswear.linkage.elements import MOST_HARMONICS, Drive
from presswear.tools.compiled import Records, compiled

MOTION = np.dtype(
    [
        ("speed", np.float64),
        ("angle", np.float64),
        ("base", np.float64),  # frequency of the first harmonic, rad/s
        ("count", np.int64),  # of harmonics
        ("cosine", np.float64, (MOST_HARMONICS,)),
        ("sine", np.float64, (MOST_HARMONICS,)),
    ]
)
"""A drive as the kernels see it."""


@compiled
def drive_motion(drive: Records, t: float) -> tuple[float, float, float]:
    """Angle turned since t = 0, rad, speed, rad/s, and acceleration, rad/s^2, of a drive."""
    turned: float = drive.speed * t
    speed: float = drive.speed
    faster = 0.0
    for k in range(drive.count):
        w = (k + 1) * drive.base
        cosine = math.cos(w * t)
        sine = math.sin(w * t)
        turned += drive.cosine[k] * (cosine - 1.0) + drive.sine[k] * sine
        speed += w * (drive.sine[k] * cosine - drive.cosine[k] * sine)
        faster -= w * w * (drive.cosine[k] * cosine + drive.sine[k] * sine)
    return turned, speed, faster


def pack_motion(drive: Drive, motion: Records) -> None:
    """Fill a record of MOTION."""
    motion["speed"], motion["angle"], motion["base"] = drive.speed, drive.angle, drive.base
    motion["count"] = len(drive.harmonics)
    for k, (cosine, sine) in enumerate(drive.harmonics):
        motion["cosine"][k], motion["sine"][k] = cosine, sine


def motion_of(drive: Drive) -> Records:
    """A drive as a record of MOTION."""
    motion = np.zeros(1, MOTION)[0]
    pack_motion(drive, motion)
    return motion


def is_steady(drive: Drive) -> bool:
    """True where a drive turns at constant speed."""
    return not drive.harmonics
