"""Film clips: stored frames with everything else that is needed to draw them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.recording.film import FILM_JOINT, FRAMES_PER_CYCLE, Film
from presswear.results.result import Result
from presswear.scene.catalog import short_name_of
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

PATH_FRAMES = 60  # frames in the path of a pin centre
CYCLE_SECONDS = 10.0  # default duration of a cycle on the screen, s
# Largest number of pictures in a film: a quarter of an hour at 25 per second
MAX_PICTURES = 20_000
_FRAME_PART = 0.02  # part of a cycle that is longer than the time between two frames
_ROUND_OFF = 1e-6  # of the time of a frame, over a cycle
# Columns of the joints of a film
NORMAL, TANGENTIAL, X, Y, PEAK = (
    FILM_JOINT.index(name)
    for name in ("normal", "tangential", "direction_x", "direction_y", "peak")
)


class Chapter(NamedTuple):
    """Name of a stage and the linkage with its surfaces."""

    stage: str
    linkage: Linkage


class Snapshot(NamedTuple):
    """State of a mechanism at one time, s."""

    time: float
    # positions in the last frames, the present frame last, shape (n, 3 bodies)
    positions: Array
    joints: Array  # columns ``FILM_JOINT``
    peaks: Array  # largest normal forces since the previous picture, N
    chapter: int = 0


@dataclass(frozen=True)
class Clip:
    """Frames of one stage, or of successive stages, and limits for drawing them."""

    title: str
    chapters: tuple[Chapter, ...]  # stages; more than one for a service life
    period: float  # duration of a cycle, s
    max_depth: Mapping[str, float]  # wear depth by joint that the drawing must hold, m
    max_force: Mapping[str, float]  # N
    film: Film
    firsts: tuple[int, ...] = (0,)  # first frame of each chapter

    @property
    def linkage(self) -> Linkage:
        """Linkage of the first chapter."""
        return self.chapters[0].linkage

    @property
    def span(self) -> tuple[float, float]:
        """Times of the first and the last frame, s."""
        return float(self.film.time[0]), float(self.film.time[-1])

    @property
    def default_start(self) -> float:
        """Time at which a film starts, s: after the run-up, and after the first of two cycles.

        A service life starts with its first frame, because all its cycles are samples.
        """
        if len(self.chapters) > 1:
            start, _ = self.span
            return start
        run_up = self.linkage.run_up_time
        # The last frame may be a frame before the end of the cycle.
        _, end = self.span
        has_two_cycles = end - run_up >= (2.0 - _FRAME_PART) * self.period
        return run_up + self.period if has_two_cycles else run_up

    @property
    def default_slow(self) -> float:
        """Factor of two digits for which a cycle takes ``CYCLE_SECONDS``."""
        return float(f"{CYCLE_SECONDS / self.period:.1e}")

    def snapshot(self, frame: int, previous: int) -> Snapshot:
        """Return the state at a frame; ``previous`` is the frame of the previous picture."""
        chapter = int(np.searchsorted(self.firsts, frame, side="right")) - 1
        first = self.firsts[chapter]
        recent = self.film.joints[max(min(previous + 1, frame), first) : frame + 1]
        positions = self.film.position[max(frame - PATH_FRAMES, first) : frame + 1]
        peaks = recent[:, :, PEAK].max(axis=0)
        time = float(self.film.time[frame])
        return Snapshot(time, positions, self.film.joints[frame], peaks, chapter)


def stage_clip(result: Result, index: int) -> Clip:
    """Return the clip of a stored stage; raises InputError if it has no film."""
    scene = result.scene
    stage = result.stage(index)
    film = stage.film
    name = short_name_of(scene)
    forces = np.hypot(film.joints[:, :, NORMAL], film.joints[:, :, TANGENTIAL])
    largest = forces.max(axis=0, initial=0.0).tolist()
    folder = result.path.resolve().name if result.path else scene.name
    title = name if folder == scene.name else f"{folder}: {name}"
    depths = [max_depths(scene.linkage(stage.surfaces)) for stage in result.stages]
    return Clip(
        title=title,
        chapters=(Chapter(result.stage_name(index), scene.linkage(stage.surfaces)),),
        period=scene.mechanism.period,
        max_depth=_largest(depths),
        max_force=dict(zip(scene.clearance_joints, largest, strict=True)),
        film=film,
    )


def life_clip(result: Result) -> Clip:
    """Return the clip of a service life: the last cycle of each stage, one after another."""
    if result.life is None:
        raise InputError(
            f"{result.path or result.scene.name} has no life: the run had no wear limit; "
            "use presswear life"
        )
    clips = equal_limits([stage_clip(result, stage.index) for stage in result.stages])
    cycles = [_last_cycle(clip, number) for number, clip in enumerate(clips)]
    film = Film(
        time=np.concatenate([cycle.time for cycle in cycles]),
        position=np.concatenate([cycle.position for cycle in cycles]),
        joints=np.concatenate([cycle.joints for cycle in cycles]),
    )
    counts = [cycle.time.size for cycle in cycles]
    firsts = np.cumsum([0, *counts[:-1]])
    return replace(
        clips[0],
        chapters=tuple(clip.chapters[0] for clip in clips),
        film=film,
        firsts=tuple(map(int, firsts)),
    )


def _last_cycle(clip: Clip, number: int) -> Film:
    """Return the last whole cycle of a clip, shifted in time to the cycle of a number."""
    film = clip.film
    period = clip.period
    run_up = clip.linkage.run_up_time
    _, end = clip.span
    # The last frame may be two frames before the end of the cycle.
    last = int((end - run_up) / period + 2.0 / FRAMES_PER_CYCLE) - 1
    if last < 0:
        raise InputError(
            f"{clip.title}, {clip.chapters[0].stage}: its film has no whole cycle"
        )
    phase = (film.time - run_up) / period - last
    rows = (phase > -_ROUND_OFF) & (phase < 1.0 - _ROUND_OFF)
    time = run_up + (phase[rows] + number) * period
    return Film(time, film.position[rows], film.joints[rows])


def max_depths(linkage: Linkage) -> dict[str, float]:
    """Return the largest wear depth of each joint, m."""
    depths = {}
    for joint in linkage.clearances:
        sides = joint.bearing_surface, joint.pin_surface
        depths[joint.name] = max(float(side.depth.max(initial=0.0)) for side in sides)
    return depths


def equal_limits(clips: Sequence[Clip]) -> list[Clip]:
    """Return the clips with the same limits of depth and force, so that they can be compared."""
    depths = _largest([clip.max_depth for clip in clips])
    forces = _largest([clip.max_force for clip in clips])
    return [replace(clip, max_depth=depths, max_force=forces) for clip in clips]


def _largest(values: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Return the largest of the values of each joint; the values are not negative."""
    largest: dict[str, float] = {}
    for by_joint in values:
        for joint, value in by_joint.items():
            largest[joint] = max(value, largest.get(joint, 0.0))
    return largest


def speed_text(slow: float) -> str:
    """Return the playing speed in words; ``slow`` is time on the screen over time of the clip."""
    if slow < 1.0:
        return f"{1.0 / slow:.3g} times real speed"
    return f"slowed {slow:.3g} times" if slow > 1.0 else "real speed"


def frames_at(clips: Sequence[Clip], time: float) -> tuple[int, ...]:
    """Return the frame of each clip at the phase that the first clip has at a time, s."""
    frames = []
    for clip in clips:
        first, last = clip.span
        clip_time = time / clips[0].period * clip.period
        # Times within two frames of the film are shown by its first or last frame.
        margin = 2.0 * clip.period / FRAMES_PER_CYCLE
        if not first - margin <= clip_time <= last + margin:
            raise InputError(
                f"time {clip_time:g} s: the film of {clip.title}, {clip.chapters[0].stage}, "
                f"goes from {first:g} s to {last:g} s"
            )
        frames.append(int(np.abs(clip.film.time - clip_time).argmin()))
    return tuple(frames)


def frames_between(
    clips: Sequence[Clip], start: float, end: float, slow: float, rate: float
) -> list[tuple[int, ...]]:
    """Return the frame of each clip in every picture between two times of the first clip, s.

    ``slow`` is time on the screen over time of the clip, ``rate`` are pictures per
    second.
    """
    count = max(round((end - start) * slow * rate), 1)
    if count > MAX_PICTURES:
        raise InputError(
            f"{count} pictures for slow = {slow:g} and rate = {rate:g}: at most {MAX_PICTURES} "
            "are drawn; use a smaller slow or rate, or a shorter time"
        )
    return [frames_at(clips, start + k / (slow * rate)) for k in range(count)]


def snapshots(
    clips: Sequence[Clip], previous: Sequence[int], frames: Sequence[int]
) -> list[Snapshot]:
    """Return the state of each clip at its frame."""
    states = []
    for clip, frame, previous_frame in zip(clips, frames, previous, strict=True):
        states.append(clip.snapshot(frame, previous_frame))
    return states
