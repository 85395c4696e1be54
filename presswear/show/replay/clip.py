"""Which stored frames are shown, and how fast: in a film, and in a window."""

from collections.abc import Sequence
from dataclasses import dataclass

from presswear.record.film import FRAMES_PER_CYCLE
from presswear.show.replay.reel import Instant, Reel
from presswear.tools.errors import InputError

MOST_PICTURES = 20_000
"""A quarter of an hour at 25 a second."""

SPACE, RIGHT, LEFT, DOWN, UP, HOME, END = 32, 262, 263, 264, 265, 268, 269
"""Codes of keys as Exudyn's renderer (GLFW) gives them."""

FASTER = 1.5
"""Factor of one change of speed."""


def played(slowed: float) -> str:
    """The speed at which something is played, in words."""
    if slowed < 1.0:
        return f"{1.0 / slowed:.3g} times as fast as it is"
    return f"slowed {slowed:.3g} times" if slowed > 1.0 else "as fast as it is"


def frames_at(reels: Sequence[Reel], time: float) -> tuple[int, ...]:
    """The frame of each reel at one crank angle: that of the first at a time, s.

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


@dataclass
class Player:
    """A place in time that moves on.

    Attributes
    ----------
    first, last, time : float
        Ends of the film and the present place, s.
    slowed : float
        Time on the screen over time of the run.
    step : float
        One frame, s.
    plays : bool
    """

    first: float
    last: float
    time: float
    slowed: float
    step: float
    plays: bool = True

    def advance(self, seconds: float) -> None:
        """Let time on the screen pass, s; from the end it begins again."""
        if not self.plays:
            return
        self.time += seconds / self.slowed
        if self.time > self.last:
            self.time = self.first

    def press(self, key: int) -> bool:
        """Do what a key stands for; False where it stands for nothing."""
        if key == SPACE:
            self.plays = not self.plays
        elif key in (LEFT, RIGHT):
            self.plays = False
            self.jump(self.time + (self.step if key == RIGHT else -self.step))
        elif key in (UP, DOWN):
            self.slowed *= FASTER if key == DOWN else 1.0 / FASTER
        elif key in (HOME, END):
            self.jump(self.first if key == HOME else self.last)
        else:
            return False
        return True

    def jump(self, time: float) -> None:
        """Go to a time, s."""
        self.time = min(max(time, self.first), self.last)

    @property
    def part(self) -> float:
        """Its place between both ends, 0 .. 1."""
        return (self.time - self.first) / (self.last - self.first)
