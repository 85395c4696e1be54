"""Films: readable by others, whole or not there."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from made_up_reel import made_up_reel
from numpy.typing import NDArray
from PIL import Image

from presswear.show.replay.movie import check_movie, pictures, still, write_movie, write_still
from presswear.show.replay.reel import frames_between
from presswear.tools.errors import InputError, RunFailed

REEL = made_up_reel()
SIZE = (320, 214)

needs_ffmpeg = pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is missing")


def moving(count: int) -> Iterator[NDArray[np.uint8]]:
    for k in range(count):
        image = np.full((64, 96, 3), 255, dtype=np.uint8)
        image[10:20, 5 * k : 5 * k + 10] = (200, 30, 30)
        yield image


def test_a_gif_has_every_picture_and_the_asked_speed(tmp_path: Path) -> None:
    told: list[float] = []
    write_movie(tmp_path / "film.gif", moving(7), 7, 10.0, told.append)
    with Image.open(tmp_path / "film.gif") as film:
        assert getattr(film, "n_frames", 1) == 7
        assert film.info["duration"] == 100
        film.seek(4)
        red = np.array(film.convert("RGB"))[15] == (200, 30, 30)
    assert np.flatnonzero(red.all(axis=1)).tolist() == list(range(20, 30))
    assert told[-1] == 1.0
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]


@needs_ffmpeg
def test_an_mp4_has_every_picture(tmp_path: Path) -> None:
    file = tmp_path / "film.mp4"
    write_movie(file, moving(9), 9, 25.0)
    asked = ["ffprobe", "-v", "error", "-count_frames", "-show_entries"]
    asked += ["stream=nb_read_frames,r_frame_rate,width", "-of", "csv=p=0", str(file)]
    said = subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()
    assert said == "96,25/1,9"


@pytest.mark.parametrize("name", ["film.gif", pytest.param("film.mp4", marks=needs_ffmpeg)])
def test_a_film_that_fails_leaves_nothing_and_the_old_one_in_place(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / name).write_bytes(b"old")

    def broken() -> Iterator[NDArray[np.uint8]]:
        yield from moving(3)
        raise RuntimeError("the renderer broke")

    with pytest.raises(RuntimeError, match="the renderer broke"):
        write_movie(tmp_path / name, broken(), 5, 10.0)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_bytes() == b"old"


def test_without_ffmpeg_an_mp4_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(InputError, match=r"film\.mp4: \.mp4 needs ffmpeg.*\.gif works without"):
        check_movie(Path("film.mp4"))
    check_movie(Path("film.gif"))
    with pytest.raises(InputError, match=r"film\.avi: a name that ends in \.mp4 or \.gif"):
        check_movie(Path("film.avi"))


def test_pictures_come_in_order_from_all_processes(tmp_path: Path) -> None:
    frames = frames_between([REEL], 0.0, 0.2 * REEL.period, 2.0, 40.0)
    drawn = list(pictures([REEL], frames, "", SIZE))
    assert len(drawn) == len(frames) > 5
    one = still([REEL], frames[3], SIZE)
    # Head, bar and words on peaks and speed differ; the press must not.
    assert np.array_equal(drawn[3][30:185, :200], one[30:185, :200])
    assert not np.array_equal(drawn[3][30:185, :200], drawn[4][30:185, :200])
    write_still(tmp_path / "one.png", one)
    with Image.open(tmp_path / "one.png") as image:
        assert np.array_equal(np.array(image), one)


class Deadly:
    """Ends the process that receives it."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (1,)


def test_a_process_that_ends_by_itself_ends_the_film() -> None:
    deadly: Any = Deadly()
    with pytest.raises(RunFailed, match="has ended by itself"):
        list(pictures([deadly], [[0]], "", SIZE))


KILLED = """
import time
from made_up_reel import made_up_reel
from presswear.show.replay.movie import pictures

if __name__ == "__main__":
    drawn = pictures([made_up_reel()], [[k] for k in range(4)], "", (160, 160))
    print("begun", flush=True)
    for _ in range({taken}):
        next(drawn)
    print("taken", flush=True)
    time.sleep(60.0)
"""


@pytest.mark.skipif(os.name != "posix", reason="sessions are those of POSIX")
@pytest.mark.parametrize(("taken", "delay"), [(1, 0.0), (4, 0.0), (4, 1.0)])
def test_a_killed_film_leaves_no_process(tmp_path: Path, taken: int, delay: float) -> None:
    """Killed while pictures are drawn, and while those that draw wait for the next."""
    script = tmp_path / "film.py"
    script.write_text(KILLED.format(taken=taken))
    paths = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    process = subprocess.Popen(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": paths},
        stdout=subprocess.PIPE,
        start_new_session=True,
    )

    def left() -> list[int]:
        found = []
        for pid in psutil.pids():
            with suppress(OSError, psutil.Error):
                if os.getsid(pid) == process.pid and psutil.Process(pid).status() != "zombie":
                    found.append(pid)
        return found

    assert process.stdout is not None
    assert [process.stdout.readline() for _ in range(2)] == [b"begun\n", b"taken\n"]
    time.sleep(delay)
    assert len(left()) > 1
    process.kill()
    process.wait()
    try:
        until = time.monotonic() + 10.0
        while left() and time.monotonic() < until:
            time.sleep(0.1)
        assert left() == []
    finally:
        for pid in left():
            os.kill(pid, signal.SIGKILL)
