"""Where a replay is: plays, pauses, steps, and is moved by keys."""

from dataclasses import dataclass

SPACE, RIGHT, LEFT, DOWN, UP, HOME, END = 32, 262, 263, 264, 265, 268, 269
"""Codes of keys as Exudyn's renderer (GLFW) gives them."""

FASTER = 1.5
"""Factor of one change of speed."""


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
        """What a key does; False where it does nothing."""
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
        """Where it is between both ends, 0 .. 1."""
        return (self.time - self.first) / (self.last - self.first)
