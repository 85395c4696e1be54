"""Stills and films without a display, and windows in a process of their own."""

import multiprocessing
import os
import subprocess
import time as clock
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass
from itertools import chain
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from presswear.recording.film import FRAMES_PER_CYCLE
from presswear.show.replay.clip import Clip, frames_at, snapshots, speed_text
from presswear.show.replay.picture import Picture, exu
from presswear.tools.errors import RunFailed
from presswear.tools.files import write_whole
from presswear.tools.processes import cores, end_with_parent, starting_processes

Pixels = NDArray[np.uint8]
Frames = Sequence[Sequence[int]]

LOST_PICTURE = (
    "a process that draws pictures ended unexpectedly, "
    "for example because memory ran out"
)
GIF_COLOURS = 64  # flat colours need few
NO_WINDOW = "--movie FILE.mp4 and --still FILE.png --at T need no window"
MAX_START = 30.0  # longest time for a window to open, s
IDLE_TIME = 0.02  # idle time of the window between two pictures, s
BAR_REACH = 0.03  # distance of a click from the time bar over the height of the picture
# Codes of keys in GLFW
SPACE = 32
RIGHT = 262
LEFT = 263
DOWN = 264
UP = 265
HOME = 268
END = 269
SPEED_STEP = 1.5  # ratio of two playing speeds


def still(
    clips: Sequence[Clip], frames: Sequence[int], size: tuple[int, int]
) -> Pixels:
    """Return one picture, shape (height, width, 3)."""
    clip = clips[0]
    first, last = clip.span
    time = clip.film.time[frames[0]]
    fraction = float((time - first) / (last - first))
    with closing(Picture(clips, size)) as picture:
        picture.show(snapshots(clips, frames, frames), fraction, "")
        return picture.image()


_worker: list[Any] = []  # picture, clips, frames and note of a worker process


def _start_worker(
    clips: Sequence[Clip], frames: Frames, note: str, size: tuple[int, int]
) -> None:
    """Prepare a worker process: build its picture and store what it draws."""
    end_with_parent()
    try:
        picture = Picture(clips, size)
    except MemoryError:
        os._exit(1)  # the pool would print a traceback
    picture.container.visualizationSettings.raytracer.numberOfThreads = 1
    _worker[:] = picture, clips, frames, note


def _draw(number: int) -> Pixels:
    """Return a picture by its number, in a worker process."""
    picture, clips, frames, note = _worker
    states = snapshots(clips, frames[max(number - 1, 0)], frames[number])
    picture.show(states, number / max(len(frames) - 1, 1), note)
    image: Pixels = picture.image()
    return image


def pictures(
    clips: Sequence[Clip], frames: Frames, note: str, size: tuple[int, int]
) -> Iterator[Pixels]:
    """Draw pictures of the frames of each clip, in order, with one process per core.

    ``note`` is a text on the playing speed. RunFailed: a process ended early.
    """
    context = multiprocessing.get_context("spawn")
    jobs = min(cores(), len(frames))
    pool = ProcessPoolExecutor(
        jobs, context, _start_worker, (clips, frames, note, size)
    )
    try:
        with starting_processes():
            images = deque(pool.submit(_draw, k) for k in range(len(frames)))
        # ``pool.map`` cancels the other pictures at an error, and a pool that has lost a
        # process then fails in a thread of its own.
        while images:
            yield images.popleft().result()
    except BrokenProcessPool:
        raise RunFailed(LOST_PICTURE) from None
    finally:
        pool.shutdown(cancel_futures=True)


def write_movie(file: Path, images: Iterator[Pixels], rate: float) -> None:
    """Write pictures as a film of ``rate`` pictures per second; replace a file by a whole one."""
    encode = _gif if file.suffix.lower() == ".gif" else _mp4
    write_whole(file, lambda opened: encode(opened, images, rate))


def _gif(file: BinaryIO, images: Iterator[Pixels], rate: float) -> None:
    """Write pictures one by one with the palette of the first."""
    first = Image.fromarray(next(images)).quantize(GIF_COLOURS)
    following = (
        Image.fromarray(image).quantize(palette=first, dither=Image.Dither.NONE)
        for image in images
    )
    # Duration of a picture, ms; GIF counts in hundredths of a second
    duration = 10 * max(round(100.0 / rate), 2)
    first.save(
        file,
        format="gif",
        save_all=True,
        append_images=following,
        duration=duration,
        loop=0,
    )


def _mp4(file: BinaryIO, images: Iterator[Pixels], rate: float) -> None:
    """Write pictures with ffmpeg; RunFailed with its last message if it fails."""
    first = next(images)
    height, width, _ = first.shape
    source = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {rate:g} -i -"
    # Players need even sizes and this colour format.
    target = "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2 -pix_fmt yuv420p -movflags +faststart"
    options = ["-loglevel", "error", "-y", *source.split(), *target.split()]
    command = ["ffmpeg", *options, "-f", "mp4", file.name]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stderr=subprocess.PIPE
    ) as encoder:
        assert encoder.stdin is not None
        assert encoder.stderr is not None
        try:
            for image in chain([first], images):
                encoder.stdin.write(image.tobytes())
            encoder.stdin.close()
        except BrokenPipeError:
            pass  # the reason is in the error output
        except BaseException:
            encoder.kill()
            raise
        errors = encoder.stderr.read().decode(errors="replace").strip().splitlines()
    if encoder.returncode != 0:
        reason = errors[-1] if errors else "no reason"
        raise RunFailed(f"ffmpeg could not write the film: {reason}")


def _start_window(*arguments: Any) -> Any:
    """Return a process with an open window, which plays clips; see ``_play``."""
    context = multiprocessing.get_context("spawn")
    connection, end_of_window = context.Pipe()
    process = context.Process(
        target=_play, args=(end_of_window, *arguments), daemon=True
    )
    with starting_processes():
        process.start()
    end_of_window.close()
    reason = f"Exudyn's renderer did not start within {MAX_START:g} s"
    try:
        if connection.poll(MAX_START):
            connection.recv()
            return process
    except EOFError:  # Exudyn ends the process if there is no display
        process.join(1.0)
        display = f"DISPLAY is {os.environ.get('DISPLAY') or 'not set'}"
        reason = f"Exudyn's renderer could not start (exit code {process.exitcode}; {display})"
    except BaseException:
        process.kill()
        raise
    process.kill()
    raise RunFailed(f"no window can be opened here: {reason}; {NO_WINDOW}")


class Window:
    """Exudyn's window with a picture in it."""

    def __init__(self, picture: Picture, press: Callable[[int], bool]) -> None:
        self.picture = picture
        self._renderer: Any = picture.container.renderer
        settings = picture.container.visualizationSettings
        # The thread of the window could not call Python; without it keys arrive in
        # ``idle``.
        settings.general.useMultiThreadedRendering = False
        settings.general.showHelpOnStartup = 0
        settings.openGL.multiSampling = 4
        settings.view0.window.lockModelView = True
        settings.interactive.ignoreKeys = True
        settings.interactive.advanced.selectionHighlights = False
        settings.interactive.keyPressUserFunction = self._key
        self._press = press
        self._quits = False
        # for the messages of Exudyn's renderer
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        self._renderer.Start()
        picture.set_view()

    def _key(self, key: int, action: int, mods: int) -> bool:
        if action == 0:  # released
            return False
        if key == ord("Q"):
            self._quits = True
            return True
        return self._press(key)

    def idle(self) -> bool:
        """Draw the picture and process input; return False once the window is closed."""
        self._renderer.SendRedrawSignal()
        self._renderer.DoIdleTasks(IDLE_TIME, False)
        is_stopped = self.picture.system.GetRenderEngineStopFlag()
        return bool(not self._quits and self._renderer.IsActive() and not is_stopped)

    def clicked_fraction(self) -> float | None:
        """Return the position, 0 to 1, of a click on the time bar, if any."""
        _, kind, *_ = self._renderer.GetItemSelection(True)
        if kind == exu.ItemType._None:
            return None
        x, y = self._renderer.GetMouseCoordinates(True)
        (start_x, bar_y), (end_x, _) = self.picture.layout.bar
        if abs(y - bar_y) > BAR_REACH * self.picture.layout.height:
            return None
        return float(np.clip((x - start_x) / (end_x - start_x), 0.0, 1.0))

    def close(self) -> None:
        """Close the window."""
        self._renderer.Stop()
        self.picture.close()


@dataclass
class Player:
    """Time that advances, with its limits and the duration of a frame, s."""

    first: float
    last: float
    time: float
    slow: float  # time on the screen over time of the clip
    step: float
    plays: bool = True

    def advance(self, seconds: float) -> None:
        """Advance by a time on the screen, s; restart after the end."""
        if self.plays:
            self.time += seconds / self.slow
            if self.time > self.last:
                self.time = self.first

    def press(self, key: int) -> bool:
        """Perform the action of a key; return False for other keys."""
        if key == SPACE:
            self.plays = not self.plays
        elif key == LEFT:
            self.plays = False
            self.jump(self.time - self.step)
        elif key == RIGHT:
            self.plays = False
            self.jump(self.time + self.step)
        elif key == UP:
            self.slow *= 1.0 / SPEED_STEP
        elif key == DOWN:
            self.slow *= SPEED_STEP
        elif key == HOME:
            self.time = self.first
        elif key == END:
            self.time = self.last
        else:
            return False
        return True

    def jump(self, time: float) -> None:
        """Go to a time, s, within the clip."""
        self.time = min(max(time, self.first), self.last)

    @property
    def fraction(self) -> float:
        """Position between both ends, 0 to 1."""
        return (self.time - self.first) / (self.last - self.first)


def play(
    clips: Sequence[Clip], size: tuple[int, int], start: float, slow: float
) -> None:
    """Play clips in a window until it is closed; raises RunFailed if it cannot be opened."""
    process = _start_window(clips, size, start, slow)
    try:
        process.join()
    finally:
        process.kill()
    if process.exitcode != 0:
        raise RunFailed(f"the window ended unexpectedly (exit code {process.exitcode})")


def _play(
    caller: Connection,
    clips: Sequence[Clip],
    size: tuple[int, int],
    start: float,
    slow: float,
) -> None:
    """Play clips in a window of this process, and notify the caller when it is open."""
    end_with_parent()
    first, _ = clips[0].span
    period = clips[0].period
    # All clips have frames up to the phase at which the shortest ends.
    phases = []
    for clip in clips:
        _, end = clip.span
        phases.append(end / clip.period)
    last = period * min(phases)
    player = Player(first, last, start, slow, step=period / FRAMES_PER_CYCLE)
    window = Window(Picture(clips, size), player.press)
    caller.send("open")
    previous = frames_at(clips, player.time)
    shown = clock.perf_counter()
    is_open = True
    while is_open:
        frames = frames_at(clips, player.time)
        note = speed_text(player.slow) if player.plays else "paused"
        window.picture.show(snapshots(clips, previous, frames), player.fraction, note)
        previous = frames
        is_open = window.idle()
        fraction = window.clicked_fraction()
        if fraction is not None:
            player.jump(player.first + fraction * (player.last - player.first))
        now = clock.perf_counter()
        player.advance(now - shown)
        shown = now
    window.close()
