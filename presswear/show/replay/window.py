"""The window: a process of its own, so that nothing that happens to it harms anybody else."""

import ctypes
import ctypes.util
import multiprocessing
import os
import sys
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from presswear.recording.film import FRAMES_PER_CYCLE
from presswear.show.replay.picture import Picture
from presswear.show.replay.reel import Reel, frames_at, instants, played
from presswear.tools.errors import RunFailed
from presswear.tools.exudyn import exudyn_module
from presswear.tools.workers import undisturbed

exu = exudyn_module()

WITHOUT_WINDOW = "--movie FILE.mp4 makes a film and --still FILE.png --at T a picture without one"
_OPENS_WITHIN = 30.0
"""Time in which a window must have opened, s."""
_TICK = 0.02
"""Time that is left to the window between two pictures, s."""
_BAR_REACH = 0.03
"""Distance from the bar at which a click still means it, part of the picture's height."""
SPACE, RIGHT, LEFT, DOWN, UP, HOME, END = 32, 262, 263, 264, 265, 268, 269
"""Codes of keys as Exudyn's renderer (GLFW) gives them."""
FASTER = 1.5
"""Factor of one change of speed."""


def check_display() -> None:
    """RunFailed where no window can be opened."""
    reason = missing_display()
    if reason:
        raise RunFailed(f"no window can be opened here: {reason}; {WITHOUT_WINDOW}")


def missing_display() -> str:
    """Why no window can be opened, or nothing; elsewhere than on Linux a display is granted.

    Exudyn aborts the process where it finds none, so it is asked before.
    """
    if not sys.platform.startswith("linux"):
        return ""
    name = os.environ.get("DISPLAY", "")
    if not name:
        return "DISPLAY is not set"
    library = ctypes.util.find_library("X11")
    if library is None:
        return "libX11 is missing"
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(name.encode())
    if not display:
        return f"nothing answers at DISPLAY={name}"
    x11.XCloseDisplay(display)
    return ""


def play(reels: Sequence[Reel], size: tuple[int, int], start: float, slowed: float) -> None:
    """Play reels in a window until it is closed; RunFailed where it cannot be opened."""
    check_display()
    process, _ = opened(_show, reels, size, start, slowed)
    try:
        process.join()
    finally:
        if process.is_alive():
            process.kill()
    if process.exitcode != 0:
        raise RunFailed(f"the window ended by itself (exit code {process.exitcode})")


def opened(target: Callable[..., None], *given: Any) -> tuple[Any, Connection]:
    """A process with an open window and a connection to it; RunFailed where it does not open."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=target, args=(theirs, *given), daemon=True)
    try:
        with undisturbed():
            process.start()
        theirs.close()
        if ours.poll(_OPENS_WITHIN):
            ours.recv()
            return process, ours
        why = f"Exudyn's renderer did not start within {_OPENS_WITHIN:g} s"
    except EOFError:  # the process has ended
        process.join(1.0)
        why = f"Exudyn's renderer could not start (exit code {process.exitcode})"
    except BaseException:
        if process.is_alive():
            process.kill()
        raise
    process.kill()
    raise RunFailed(f"no window can be opened here: {why}; {WITHOUT_WINDOW}")


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


class Window:
    """Exudyn's window with a picture in it."""

    def __init__(self, picture: Picture, press: Callable[[int], bool]) -> None:
        self.picture = picture
        self._renderer: Any = picture.container.renderer
        settings = picture.container.visualizationSettings
        # The window's thread could not call Python; with one thread keys arrive in ``idle``.
        settings.general.useMultiThreadedRendering = False
        settings.general.showHelpOnStartup = 0
        settings.openGL.multiSampling = 4
        settings.view0.window.lockModelView = True
        settings.interactive.ignoreKeys = True
        settings.interactive.advanced.selectionHighlights = False
        settings.interactive.keyPressUserFunction = self._key
        self._press = press
        self._quits = False
        self._renderer.Start()
        picture.look()

    def _key(self, key: int, action: int, mods: int) -> bool:
        if action == 0:  # released
            return False
        if key == ord("Q"):
            self._quits = True
            return True
        return self._press(key)

    def idle(self) -> bool:
        """Show the picture as set and let keys and mouse act; False once the window is closed."""
        self._renderer.SendRedrawSignal()
        self._renderer.DoIdleTasks(_TICK, False)
        return bool(
            not self._quits
            and self._renderer.IsActive()
            and not self.picture.system.GetRenderEngineStopFlag()
        )

    def clicked_part(self) -> float | None:
        """The part of the bar of time, 0 .. 1, that was clicked at, if any."""
        item = self._renderer.GetItemSelection(True)
        if item[1] == exu.ItemType._None:
            return None
        x, y = self._renderer.GetMouseCoordinates(True)
        layout = self.picture.layout
        start, end = layout.bar
        if abs(y - start[1]) > _BAR_REACH * layout.height:
            return None
        return float(min(max((x - start[0]) / (end[0] - start[0]), 0.0), 1.0))

    def close(self) -> None:
        """Close it."""
        self._renderer.Stop()
        self.picture.close()


def _show(
    asker: Connection, reels: Sequence[Reel], size: tuple[int, int], start: float, slowed: float
) -> None:
    """The process of the window."""
    first = reels[0]
    # Every reel has frames up to the phase at which the shortest ends.
    last = first.period * min(reel.span[1] / reel.period for reel in reels)
    player = Player(first.span[0], last, start, slowed, first.period / FRAMES_PER_CYCLE)
    window = Window(Picture(reels, size), player.press)
    asker.send("open")
    before = frames_at(reels, player.time)
    shown = clock.perf_counter()
    is_open = True
    while is_open:
        frames = frames_at(reels, player.time)
        note = played(player.slowed) if player.plays else "paused"
        window.picture.set(instants(reels, before, frames), player.part, note)
        before = frames
        is_open = window.idle()
        part = window.clicked_part()
        if part is not None:
            player.jump(player.first + part * (player.last - player.first))
        now = clock.perf_counter()
        player.advance(now - shown)
        shown = now
    window.close()
