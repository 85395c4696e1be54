"""The slider's motion with every joint closed, which what is computed is held against."""

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
    return scene.ideal_slider(time)
