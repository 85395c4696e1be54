"""Numbers that are followed through a life, from the surfaces and cycles of every start."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.segment import linkage_on
from presswear.linkage.elements import ClearanceJoint
from presswear.physics.bottom import bottom_of
from presswear.physics.statics import total_clearance
from presswear.physics.wear import worn_volume
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

_OF_JOINT: dict[str, Callable[[ClearanceJoint, Array], float]] = {
    "depth": lambda joint, depth: float(depth.max()),
    "wear_volume": worn_volume,
}
"""Levels of a joint, from the depth of its bearing and pin, m, shape (2, bins)."""
_OF_ALL: dict[str, Callable[[Scene, Array], float]] = {
    "total_clearance": lambda scene, worn: total_clearance(linkage_on(scene, worn)),
}
"""Levels of the mechanism, from the depth of all surfaces; dear: only where a limit is on one."""
_BOTTOM: dict[str, Callable[[Array], Array]] = {
    "bdc_error": lambda off: off.mean(axis=1),
    "bdc_drift": lambda off: off.mean(axis=1),
    "repeatability": lambda off: off.var(axis=1, ddof=1),
}
"""Samples from the heights of bottom dead centre over the ideal, m, shape (starts, cycles)."""


def levels(scene: Scene, worn: Array, asked: Sequence[str]) -> dict[str, Array]:
    """What the surfaces of every start decide, by key.

    Parameters
    ----------
    worn : ndarray, shape (starts, joints, 2, m)
        Their depth, m.
    asked : sequence of str
        Names that limits are on.
    """
    found = {}
    for k, joint in enumerate(scene.linkage().clearances):
        for name, of in _OF_JOINT.items():
            found[f"{joint.name}.{name}"] = np.array(
                [of(joint, own[k, :, : joint.bins]) for own in worn]
            )
    for name in asked:
        if name in _OF_ALL:
            found[name] = np.array([_OF_ALL[name](scene, own) for own in worn])
    return found


def samples(scene: Scene, rows: Array) -> dict[str, Array]:
    """What some strokes gave in the mean, by key, each of shape (starts,).

    Parameters
    ----------
    rows : ndarray, shape (starts, cycles, columns)
        Columns CYCLE_FIXED and CYCLE_JOINT.
    """
    found = {}
    for k, joint in enumerate(scene.linkage().clearances):
        place = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k + CYCLE_JOINT.index("force_max")
        found[f"{joint.name}.force_max"] = rows[:, :, place].mean(axis=1)
    ideal = bottom_of(scene.ideal)
    if ideal is not None:
        off = rows[:, :, CYCLE_FIXED.index("bottom_height")] - ideal.height
        found |= {name: of(off) for name, of in _BOTTOM.items()}
    return found
