"""Which stored frames a film shows, and how fast."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.record.film import FRAMES_PER_CYCLE
from presswear.show.replay.reel import Instant, Reel
from presswear.tools.errors import InputError

Array = NDArray[np.float64]

CYCLE_SECONDS = 10.0
"""Time that a cycle takes on the screen where nothing else is asked for, s."""

MOST_PICTURES = 20_000
"""A quarter of an hour at 25 a second."""


@dataclass(frozen=True)
class Clip:
    """What is played.

    Attributes
    ----------
    frames : ndarray of int, shape (n, reels)
        Stored frames of each picture.
    rate : float
        Pictures a second.
    slowed : float
        Time on the screen over time of the first reel.
    """

    frames: NDArray[np.int64]
    rate: float
    slowed: float

    @property
    def note(self) -> str:
        """How fast it is played, in words."""
        return played(self.slowed)

    def part(self, picture: int) -> float:
        """Where a picture is in the clip, 0 .. 1."""
        return picture / max(len(self.frames) - 1, 1)


def played(slowed: float) -> str:
    """How fast something is played, in words."""
    if slowed < 1.0:
        return f"{1.0 / slowed:.3g} times as fast as it is"
    return f"slowed {slowed:.3g} times" if slowed > 1.0 else "as fast as it is"


def default_start(reel: Reel) -> float:
    """Where a film begins: after the first cycle, in which pins settle, if there are more, s."""
    return reel.period if reel.span[1] >= 1.98 * reel.period else 0.0


def frames_at(reels: Sequence[Reel], time: float) -> tuple[int, ...]:
    """The frame of each reel at one crank angle: that of the first at a time, s.

    InputError where a reel does not reach so far.
    """
    turns = time / reels[0].period
    found = []
    for reel in reels:
        first, last = reel.span
        own = turns * reel.period
        # Frames are apart: the last one stands for all up to the end of its cycle.
        slack = 2.0 * reel.period / FRAMES_PER_CYCLE
        if not first - slack <= own <= last + slack:
            raise InputError(
                f"time {own:g} s: the film of {reel.subject.title}, {reel.subject.stage}, "
                f"goes from {first:g} s to {last:g} s"
            )
        found.append(reel.frame_at(own))
    return tuple(found)


def clip_of(reels: Sequence[Reel], start: float, end: float, slowed: float, rate: float) -> Clip:
    """Pictures from one time of the first reel to another, s, evenly spaced.

    InputError where they are more than anybody would look at.
    """
    count = max(round((end - start) * slowed * rate), 1)
    if count > MOST_PICTURES:
        raise InputError(
            f"{count} pictures, {slowed:g} times slower at {rate:g} a second: at most "
            f"{MOST_PICTURES} are drawn; choose a smaller --slow or --rate, or a shorter time"
        )
    times = start + np.arange(count) / (slowed * rate)
    frames = np.array([frames_at(reels, float(time)) for time in times])
    return Clip(frames, rate, slowed)


def instants(reels: Sequence[Reel], before: Sequence[int], frames: Sequence[int]) -> list[Instant]:
    """A frame of each reel, where others were shown before."""
    return [
        reel.instant(int(frame), min(int(last), int(frame) - 1))
        for reel, last, frame in zip(reels, before, frames, strict=True)
    ]


def default_slowed(reel: Reel) -> float:
    """Slow enough that a cycle takes CYCLE_SECONDS, to two digits."""
    exact = CYCLE_SECONDS / reel.period
    unit: float = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return round(exact / unit) * unit
