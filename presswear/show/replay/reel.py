"""The film of a stage, all else that is needed to draw it, and which of its frames are shown."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.surface import Surface
from presswear.recording.film import FILM_JOINT, FRAMES_PER_CYCLE, Film
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.catalog import short_name_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError

Array = NDArray[np.float64]

PATH_FRAMES = 60
"""Frames that the path of a pin's centre reaches back."""
CYCLE_SECONDS = 10.0
"""Time that a cycle takes on the screen where nothing else is asked for, s."""
MOST_PICTURES = 20_000
"""Pictures of a film: a quarter of an hour at 25 a second."""
NORMAL, TANGENTIAL, X, Y, PEAK = (
    FILM_JOINT.index(name)
    for name in ("normal", "tangential", "direction_x", "direction_y", "peak")
)


@dataclass(frozen=True)
class Chapter:
    """A stage that is shown: its name, and the linkage with the surfaces that it ran on."""

    stage: str
    linkage: Linkage


@dataclass(frozen=True, kw_only=True)
class Subject:
    """All about a stage that does not change with time.

    Attributes
    ----------
    title, stage : str
        Folder and scene, and the stage.
    linkage : Linkage
        Linkage with the surfaces that the stage ran on.
    period : float
        Duration of a cycle, s.
    deepest, largest : mapping
        Greatest depth, m, and force, N, by joint for which there must be room.
    motion : ndarray, shape (n, 3 bodies)
        Positions for which there must be room.
    later : tuple of Chapter
        Stages that follow it, of a life.
    """

    title: str
    stage: str
    linkage: Linkage
    period: float
    deepest: Mapping[str, float]
    largest: Mapping[str, float]
    motion: Array
    later: tuple[Chapter, ...] = ()

    @property
    def chapters(self) -> tuple[Chapter, ...]:
        """All stages that are shown, one after another."""
        return Chapter(self.stage, self.linkage), *self.later


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
    chapter : int
        Which of the stages it is of.
    """

    time: float
    past: Array
    joints: Array
    peaks: Array
    chapter: int = 0


@dataclass(frozen=True, kw_only=True)
class Reel(Subject):
    """A subject with its stored film.

    Attributes
    ----------
    film : Film
    firsts : tuple of int
        First frame of each stage that is shown.
    """

    film: Film
    firsts: tuple[int, ...] = (0,)

    @property
    def span(self) -> tuple[float, float]:
        """Times of the first and the last frame, s."""
        return float(self.film.time[0]), float(self.film.time[-1])

    @property
    def start(self) -> float:
        """Time, s, after the run-up and, if there are more, the first cycle: pins settle in it.

        Of a life its own beginning: it is of settled cycles.
        """
        if self.later:
            return self.span[0]
        run_up = self.linkage.run_up_time
        return run_up + self.period * (self.span[1] - run_up >= 1.98 * self.period)

    @property
    def whole(self) -> float:
        """Duration of a cycle of each stage that is shown, s."""
        return self.period * len(self.firsts)

    @property
    def slowed(self) -> float:
        """Factor, of two digits, by which a cycle takes ``CYCLE_SECONDS``."""
        exact = CYCLE_SECONDS / self.period
        unit: float = 10.0 ** (math.floor(math.log10(exact)) - 1)
        return round(exact / unit) * unit

    def frame_at(self, time: float) -> int:
        """The frame nearest to a time, s."""
        return int(np.abs(self.film.time - time).argmin())

    def instant(self, frame: int, before: int) -> Instant:
        """A frame, where another was shown before it."""
        chapter = int(np.searchsorted(self.firsts, frame, side="right")) - 1
        first = self.firsts[chapter]
        since = self.film.joints[max(min(before + 1, frame), first) : frame + 1]
        return Instant(
            time=float(self.film.time[frame]),
            past=self.film.position[max(frame - PATH_FRAMES, first) : frame + 1],
            joints=self.film.joints[frame],
            peaks=since[:, :, PEAK].max(axis=0),
            chapter=chapter,
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


def reel_of(result: Result, index: int) -> Reel:
    """The reel of a stored stage; InputError where it has no film."""
    scene, stage = result.scene, result.stage(index)
    film, linkage = stage.film, _linkage(scene, stage)
    forces = np.hypot(film.joints[:, :, NORMAL], film.joints[:, :, TANGENTIAL])
    largest = forces.max(axis=0, initial=0.0).tolist()
    name = short_name_of(scene)
    folder = result.path.resolve().name if result.path else scene.name
    return Reel(
        title=name if folder == scene.name else f"{folder}: {name}",
        stage=result.stage_name(index),
        linkage=linkage,
        period=scene.mechanism.period,
        deepest=_greatest(deepest(_linkage(scene, one)) for one in result.stages),
        largest={joint.name: own for joint, own in zip(linkage.clearances, largest, strict=True)},
        motion=film.position,
        film=film,
    )


def life_reel(result: Result) -> Reel:
    """A reel through a life: the last cycle of each stage, one after another.

    InputError where the result has no life, or a stage no whole cycle.
    """
    if result.life is None:
        raise InputError(
            f"{result.path or result.scene.name} has no life: it was worn until no limit; "
            "presswear life runs one"
        )
    reels = alike([reel_of(result, stage.index) for stage in result.stages])
    cycles = [_last_cycle(reel, place) for place, reel in enumerate(reels)]
    parts = ([getattr(own, name) for own in cycles] for name in ("time", "position", "joints"))
    film = Film(*map(np.concatenate, parts))
    firsts = np.cumsum([0, *(own.time.size for own in cycles[:-1])])
    return replace(
        reels[0],
        film=film,
        motion=film.position,
        later=tuple(Chapter(reel.stage, reel.linkage) for reel in reels[1:]),
        firsts=tuple(map(int, firsts)),
    )


def _last_cycle(reel: Reel, place: int) -> Film:
    """The last whole cycle of a film, as if it ran so many cycles after the first."""
    film, period, run_up = reel.film, reel.period, reel.linkage.run_up_time
    last = int((reel.span[1] - run_up) / period + 2.0 / FRAMES_PER_CYCLE) - 1
    if last < 0:
        raise InputError(f"{reel.title}, {reel.stage}: its film holds no whole cycle")
    ran = (film.time - run_up) / period - last
    rows = (ran > -1e-6) & (ran < 1.0 - 1e-6)
    time = run_up + (ran[rows] + place) * period
    return Film(time, film.position[rows], film.joints[rows])


def _linkage(scene: Scene, stage: StageResult) -> Linkage:
    """The linkage with the surfaces that a stage ran on."""
    return scene.linkage(
        {
            name: (Surface(own.depth("bearing")), Surface(own.depth("pin")))
            for name, own in stage.joints.items()
        }
    )


def deepest(linkage: Linkage) -> dict[str, float]:
    """Greatest depth of the surfaces of each joint, m."""
    return {
        joint.name: max(
            float(surface.depth.max(initial=0.0))
            for surface in (joint.bearing_surface, joint.pin_surface)
        )
        for joint in linkage.clearances
    }


def alike(reels: Sequence[Reel]) -> list[Reel]:
    """The reels with room for the same depths and forces, so that they can be compared."""
    deepest = _greatest(reel.deepest for reel in reels)
    largest = _greatest(reel.largest for reel in reels)
    return [replace(reel, deepest=deepest, largest=largest) for reel in reels]


def _greatest(rooms: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """The greatest number of each joint."""
    found: dict[str, float] = {}
    for room in rooms:
        for joint, number in room.items():
            found[joint] = max(found.get(joint, 0.0), number)
    return found


def played(slowed: float) -> str:
    """The speed at which something is played, in words."""
    if slowed < 1.0:
        return f"{1.0 / slowed:.3g} times as fast as it is"
    return f"slowed {slowed:.3g} times" if slowed > 1.0 else "as fast as it is"


def frames_at(reels: Sequence[Reel], time: float) -> tuple[int, ...]:
    """The frame of each reel at one phase of the cycle: that of the first at a time, s.

    InputError where a reel does not reach so far.
    """
    found = []
    for reel in reels:
        first, last = reel.span
        own = time / reels[0].period * reel.period
        # Frames are apart: the last one stands for all up to the end of its cycle.
        slack = 2.0 * reel.period / FRAMES_PER_CYCLE
        if not first - slack <= own <= last + slack:
            raise InputError(
                f"time {own:g} s: the film of {reel.title}, {reel.stage}, "
                f"goes from {first:g} s to {last:g} s"
            )
        found.append(reel.frame_at(own))
    return tuple(found)


def frames_between(
    reels: Sequence[Reel], start: float, end: float, slowed: float, rate: float
) -> list[tuple[int, ...]]:
    """The frame of each reel in every picture from one time of the first reel to another, s.

    InputError where the pictures are more than anybody would look at.

    Parameters
    ----------
    slowed : float
        Time on the screen over time of the first reel.
    rate : float
        Pictures a second.
    """
    count = max(round((end - start) * slowed * rate), 1)
    if count > MOST_PICTURES:
        raise InputError(
            f"{count} pictures, {slowed:g} times slower at {rate:g} a second: at most "
            f"{MOST_PICTURES} are drawn; choose a smaller --slow or --rate, or a shorter time"
        )
    return [frames_at(reels, start + k / (slowed * rate)) for k in range(count)]


def instants(reels: Sequence[Reel], before: Sequence[int], frames: Sequence[int]) -> list[Instant]:
    """A frame of each reel, where others were shown before."""
    return [
        reel.instant(frame, last) for reel, last, frame in zip(reels, before, frames, strict=True)
    ]
