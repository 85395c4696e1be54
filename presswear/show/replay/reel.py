"""What a replay shows: the film of a stage, the surfaces it ran on, and their names."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment, ClearanceJoint, Linkage
from presswear.record.film import FILM_JOINT, Film
from presswear.results.result import Result
from presswear.scene.scene import stage_name

Array = NDArray[np.float64]

PATH_FRAMES = 60
"""Frames that the path of a pin's centre reaches back."""
_NORMAL, _TANGENTIAL, _PEAK = (FILM_JOINT.index(name) for name in ("normal", "tangential", "peak"))


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
class Subject:
    """What is drawn: everything about it that does not change with time.

    Attributes
    ----------
    title, stage : str
        Folder and scene, and the stage.
    linkage : Linkage
        Without its wear; ``surfaces`` has that.
    period : float
        Of a cycle, s.
    surfaces : tuple of Surfaces
        That the stage ran on, of each clearance joint.
    deepest, largest : tuple of float
        Greatest depth, m, and force, N, of each joint for which there must be room.
    motion : ndarray, shape (n, 3 bodies)
        Positions for which there must be room.
    """

    title: str
    stage: str
    linkage: Linkage
    period: float
    surfaces: tuple[Surfaces, ...]
    deepest: tuple[float, ...]
    largest: tuple[float, ...]
    motion: Array


@dataclass(frozen=True)
class Instant:
    """One moment of a subject.

    Attributes
    ----------
    time : float
        s.
    past : ndarray, shape (n, 3 bodies)
        Positions of the last frames, the present one at the end.
    joints : ndarray, shape (joints, 6)
        Columns FILM_JOINT.
    peaks : ndarray, shape (joints,)
        Greatest normal force of each joint since the picture before, N.
    """

    time: float
    past: Array
    joints: Array
    peaks: Array


@dataclass(frozen=True)
class Reel:
    """A stored film and its subject."""

    subject: Subject
    film: Film

    @property
    def period(self) -> float:
        """Of a cycle, s."""
        return self.subject.period

    @property
    def span(self) -> tuple[float, float]:
        """Times of the first and the last frame, s."""
        return float(self.film.time[0]), float(self.film.time[-1])

    def frame_at(self, time: float) -> int:
        """The frame nearest to a time, s."""
        times = self.film.time
        after = int(np.clip(np.searchsorted(times, time), 1, max(len(times) - 1, 1)))
        after = min(after, len(times) - 1)
        return after - 1 if time - times[after - 1] < times[after] - time else after

    def instant(self, frame: int, before: int) -> Instant:
        """A frame, where another was shown before it."""
        since = self.film.joints[min(before + 1, frame) : frame + 1]
        return Instant(
            time=float(self.film.time[frame]),
            past=self.film.position[max(frame - PATH_FRAMES, 0) : frame + 1],
            joints=self.film.joints[frame],
            peaks=since[:, :, _PEAK].max(axis=0),
        )


def points_of(linkage: Linkage, position: Array, point: Attachment) -> Array:
    """A point, m, and angle of its body, rad, in each of some positions; shape (n, 3).

    Parameters
    ----------
    position : ndarray, shape (n, 3 bodies)
    """
    if point.body == GROUND:
        return np.tile([point.x, point.y, 0.0], (len(position), 1))
    base = 3 * linkage.index(point.body)
    x, y, angle = position[:, base : base + 3].T
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([x + c * point.x - s * point.y, y + s * point.x + c * point.y, angle])


def reel_of(result: Result, stage: int) -> Reel:
    """The reel of a stored stage; InputError where it has no film."""
    scene = result.scene
    linkage = scene.linkage()
    film = result.stages[stage].film
    subject = Subject(
        title=f"{result.path.resolve().name}: {scene.name}" if result.path else scene.name,
        stage=stage_name(stage),
        linkage=linkage,
        period=scene.mechanism.period,
        surfaces=tuple(_surfaces(result, stage, joint) for joint in linkage.clearances),
        deepest=tuple(
            max(_surfaces(result, k, joint).deepest for k in range(len(result.stages)))
            for joint in linkage.clearances
        ),
        largest=tuple(
            float(np.hypot(rows[:, _NORMAL], rows[:, _TANGENTIAL]).max(initial=0.0))
            for rows in film.joints.transpose(1, 0, 2)
        ),
        motion=film.position,
    )
    return Reel(subject, film)


def alike(reels: Sequence[Reel]) -> list[Reel]:
    """The same reels with room for the same depths and forces, so that they can be compared."""
    depth: dict[str, float] = {}
    force: dict[str, float] = {}
    for reel in reels:
        for k, joint in enumerate(reel.subject.linkage.clearances):
            depth[joint.name] = max(depth.get(joint.name, 0.0), reel.subject.deepest[k])
            force[joint.name] = max(force.get(joint.name, 0.0), reel.subject.largest[k])
    found = []
    for reel in reels:
        names = [joint.name for joint in reel.subject.linkage.clearances]
        subject = replace(
            reel.subject,
            deepest=tuple(depth[name] for name in names),
            largest=tuple(force[name] for name in names),
        )
        found.append(Reel(subject, reel.film))
    return found


def _surfaces(result: Result, stage: int, joint: ClearanceJoint) -> Surfaces:
    arrays = result.stages[stage].arrays
    return Surfaces(arrays[f"{joint.name}_depth_bearing"], arrays[f"{joint.name}_depth_pin"])
