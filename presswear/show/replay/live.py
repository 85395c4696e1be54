"""The press in a window while it runs.

The window is a process of its own and is sent frames only when it has shown the last ones:
a window that hangs or is closed does not keep the run from going on.
"""

import time as clock
from multiprocessing.connection import Connection

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.recording.film import FILM_JOINT, Film
from presswear.recording.observer import Observer, Progress
from presswear.scene.catalog import short_name_of
from presswear.scene.scene import Scene
from presswear.show.replay.picture import Picture
from presswear.show.replay.reel import PATH_FRAMES, PEAK, Instant, Subject, deepest
from presswear.show.replay.window import Window, check_display, opened

Array = NDArray[np.float64]

_INTERVAL = 0.04
"""Least time between two pictures, s."""
_LARGEST = 500.0
"""Force whose arrow has the full length, N: that of the run is not known yet."""
_RECENT = 10
"""Frames of which the greatest force is told."""


class Live(Observer):
    """A window that shows a run of a scene.

    Raises
    ------
    RunFailed
        Where no window can be opened.
    """

    frames = PATH_FRAMES

    def __init__(self, scene: Scene, size: tuple[int, int]) -> None:
        check_display()
        self._scene = scene
        times = np.linspace(0.0, scene.mechanism.period, 181)
        self._motion = scene.ideal.at(times).position
        self._linkage: Linkage | None = None
        self._process, self._window = opened(_show, size, self._subject(0, scene.linkage()))
        self._is_open = self._is_ready = True
        self._sent = 0.0

    def on_progress(self, progress: Progress) -> None:
        """Show how a run stands, if the window is there and has shown what it was sent."""
        now = clock.perf_counter()
        if not self._is_open or progress.film is None or now - self._sent < _INTERVAL:
            return
        try:
            while self._window.poll():
                self._window.recv()
                self._is_ready = True
            if self._is_ready:
                self._send(progress, progress.film)
                self._is_ready, self._sent = False, now
        except (EOFError, OSError):
            self._is_open = False

    def _send(self, progress: Progress, film: Film) -> None:
        """Send the last frames of a run, and what runs where that is another."""
        if progress.linkage is not self._linkage:
            self._linkage = progress.linkage
            self._window.send(self._subject(progress.stage, progress.linkage))
        time = float(film.time[-1])
        peaks = film.joints[-_RECENT:, :, PEAK].max(axis=0)
        instant = Instant(time, film.position, film.joints[-1], peaks)
        self._window.send((instant, time / self._scene.mechanism.period % 1.0))

    def _subject(self, stage: int, linkage: Linkage) -> Subject:
        return Subject(
            title=short_name_of(self._scene),
            stage=f"{self._scene.stage_name(stage)}, running",
            linkage=linkage,
            period=self._scene.mechanism.period,
            deepest=deepest(linkage),
            largest={joint.name: _LARGEST for joint in linkage.clearances},
            motion=self._motion,
        )

    def close(self) -> None:
        """Close the window."""
        self._window.close()
        self._process.join(2.0)
        if self._process.is_alive():
            self._process.kill()


def _show(run: Connection, size: tuple[int, int], subject: Subject) -> None:
    """The process of the window."""
    picture, window = _fresh(subject, size)
    run.send("open")
    is_open = True
    try:
        while is_open:
            if run.poll():
                told = run.recv()
                if isinstance(told, Subject):
                    window.close()
                    picture, window = _fresh(told, size)
                else:
                    instant, part = told
                    picture.set([instant], part, "")
                    run.send("shown")
            is_open = window.idle()
    except (EOFError, OSError):
        pass  # the run is over
    window.close()


def _fresh(subject: Subject, size: tuple[int, int]) -> tuple[Picture, Window]:
    picture = Picture([subject], size)
    joints = np.zeros((len(subject.linkage.clearances), len(FILM_JOINT)))
    picture.set([Instant(0.0, subject.motion[:1], joints, joints[:, 0])], 0.0, "")
    return picture, Window(picture, lambda key: False)
