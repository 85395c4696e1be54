"""The slider's motion with every joint closed, which what is computed is held against."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.scene.scene import Scene

Array = NDArray[np.float64]


def ideal_slider(scene: Scene, time: Array) -> Array:
    """Displacement from the start, velocity and acceleration of the ideal slider, closed form.

    Parameters
    ----------
    time : ndarray, shape (n,)
        s.

    Returns
    -------
    ndarray, shape (n, 3)
        m, m/s, m/s^2.
    """
    linkage = scene.mechanism.linkage()
    column = 3 * linkage.index(linkage.probe.body)
    along = np.array([math.cos(linkage.probe.direction), math.sin(linkage.probe.direction)])
    motion = scene.mechanism.ideal_motion(np.append(0.0, time))
    levels = (motion.position, motion.velocity, motion.acceleration)
    slider = np.column_stack([level[:, column : column + 2] @ along for level in levels])
    slider[:, 0] -= slider[0, 0]
    return slider[1:]
