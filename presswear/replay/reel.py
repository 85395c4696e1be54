"""What a replay shows: the film of a stage, the surfaces it ran on, and their names."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.film import Film
from presswear.linkage import Attachment, ClearanceJoint, Linkage
from presswear.results import StoredResult, load_film
from presswear.scene import stage_name

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Surfaces:
    """Wear depth of a bearing and its pin by angle, bin centres, shape (m,) each, m."""

    bearing: Array
    pin: Array

    @property
    def deepest(self) -> float:
        """m."""
        return float(max(self.bearing.max(), self.pin.max()))


@dataclass(frozen=True)
class Reel:
    """A film with what is needed to draw it.

    Attributes
    ----------
    title, stage : str
        Folder and scene, and the stage.
    linkage : Linkage
        Without its wear; ``surfaces`` has that.
    film : Film
    period : float
        Of a cycle, s.
    surfaces : tuple of Surfaces
        That the stage ran on, of each clearance joint.
    deepest : tuple of float
        Greatest depth that each joint has in any stage of the run, m.
    """

    title: str
    stage: str
    linkage: Linkage
    film: Film
    period: float
    surfaces: tuple[Surfaces, ...]
    deepest: tuple[float, ...]

    def angle(self, frame: int) -> float:
        """Angle that the driven crank has turned since the start, rad."""
        return 2.0 * math.pi * float(self.film.time[frame]) / self.period

    def at(self, time: float) -> int:
        """The frame nearest to a time, s."""
        times = self.film.time
        after = int(np.clip(np.searchsorted(times, time), 1, len(times) - 1))
        return after - 1 if time - times[after - 1] < times[after] - time else after

    def eccentricity(self, k: int) -> Array:
        """Pin minus bearing centre of joint ``k`` in every frame, shape (n, 2), m."""
        joint = self.linkage.clearances[k]
        return (self.pose(joint.pin) - self.pose(joint.bearing))[:, :2]

    def pose(self, point: Attachment) -> Array:
        """A point, m, and angle of its body, rad, in every frame, shape (n, 3)."""
        return points_of(self.linkage, self.film.position, point)


def points_of(linkage: Linkage, position: Array, point: Attachment) -> Array:
    """A point, m, and angle of its body, rad, in each of some positions; shape (n, 3).

    Parameters
    ----------
    position : ndarray, shape (n, 3 bodies)
    """
    if point.body not in {body.name for body in linkage.bodies}:
        return np.tile([point.x, point.y, 0.0], (len(position), 1))
    base = 3 * linkage.index(point.body)
    x, y, angle = position[:, base : base + 3].T
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack(
        [x + c * point.x - s * point.y, y + s * point.x + c * point.y, angle]
    )


def reel_of(result: StoredResult, stage: int) -> Reel:
    """The reel of a stored stage; InputError where it has no film."""
    scene = result.scene
    linkage = scene.linkage()
    return Reel(
        title=f"{result.path.resolve().name}: {scene.name}",
        stage=stage_name(stage),
        linkage=linkage,
        film=load_film(result, stage),
        period=scene.mechanism.period,
        surfaces=tuple(_surfaces(result, stage, joint) for joint in linkage.clearances),
        deepest=tuple(
            max(_surfaces(result, k, joint).deepest for k in range(len(result.stages)))
            for joint in linkage.clearances
        ),
    )


def _surfaces(result: StoredResult, stage: int, joint: ClearanceJoint) -> Surfaces:
    arrays = result.stages[stage]
    return Surfaces(arrays[f"{joint.name}_depth_bearing"], arrays[f"{joint.name}_depth_pin"])
