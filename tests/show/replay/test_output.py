"""Films: readable by other programs, complete or absent, without orphan processes."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from numpy.typing import NDArray
from PIL import Image
from synthetic_clip import synthetic_clip

from presswear.show.replay.clip import frames_between
from presswear.show.replay.output import check_movie, pictures, still, write_movie, write_still
from presswear.tools.errors import InputError, RunFailed

CLIP = synthetic_clip()
SIZE = (320, 214)


def moving(count: int, fails: bool = False) -> Iterator[NDArray[np.uint8]]:
    for k in range(count):
        image = np.full((64, 96, 3), 255, dtype=np.uint8)
        image[10:20, 5 * k : 5 * k + 10] = (200, 30, 30)
        yield image
    if fails:
        raise RuntimeError("the renderer failed")


def test_a_gif_has_every_picture_and_the_requested_speed(tmp_path: Path) -> None:
    write_movie(tmp_path / "film.gif", moving(7), 10.0)
    with Image.open(tmp_path / "film.gif") as film:
        assert getattr(film, "n_frames", 1) == 7
        assert film.info["duration"] == 100
        film.seek(4)
        red = np.array(film.convert("RGB"))[15] == (200, 30, 30)
    assert np.flatnonzero(red.all(axis=1)).tolist() == list(range(20, 30))


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is missing")
def test_an_mp4_is_complete_or_absent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "film.mp4"
    write_movie(file, moving(9), 25.0)
    command = ["ffprobe", "-v", "error", "-count_frames", "-show_entries"]
    command += ["stream=nb_read_frames,r_frame_rate,width", "-of", "csv=p=0", str(file)]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    assert output == "96,25/1,9"
    film = file.read_bytes()
    with pytest.raises(RuntimeError, match="the renderer failed"):
        write_movie(file, moving(3, fails=True), 10.0)
    assert [path.name for path in tmp_path.iterdir()] == [file.name]
    assert file.read_bytes() == film
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(InputError, match=r"film\.mp4: \.mp4 needs ffmpeg.* write a \.gif"):
        check_movie(file)


def test_pictures_of_all_processes_are_in_order(tmp_path: Path) -> None:
    frames = frames_between([CLIP], 0.0, 0.2 * CLIP.period, 2.0, 40.0)
    drawn = list(pictures([CLIP], frames, "", SIZE))
    assert len(drawn) == len(frames) > 5
    single = still([CLIP], frames[3], SIZE)
    # Title, time bar and peaks differ; the mechanism does not.
    assert np.array_equal(drawn[3][30:185, :200], single[30:185, :200])
    assert not np.array_equal(drawn[3][30:185, :200], drawn[4][30:185, :200])
    write_still(tmp_path / "one.png", single)
    with Image.open(tmp_path / "one.png") as image:
        assert np.array_equal(np.array(image), single)


class Deadly:
    """Ends the process that unpickles it."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (1,)


def test_a_process_that_ends_early_ends_the_film() -> None:
    deadly: Any = Deadly()
    with pytest.raises(RunFailed, match="ended unexpectedly"):
        list(pictures([deadly], [[0]], "", SIZE))


KILLED = """
import time
from synthetic_clip import synthetic_clip
from presswear.show.replay.output import pictures

if __name__ == "__main__":
    drawn = pictures([synthetic_clip()], [[k] for k in range(4)], "", (160, 160))
    for _ in range({count}):
        next(drawn)
    print("ready", flush=True)
    time.sleep(60.0)
"""


@pytest.mark.parametrize("count", [1, 4])
def test_a_killed_film_leaves_no_process(tmp_path: Path, count: int) -> None:
    """Killed while pictures are drawn, and while workers wait for the next."""
    script = tmp_path / "film.py"
    script.write_text(KILLED.format(count=count))
    paths = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    environment = {**os.environ, "PYTHONPATH": paths}
    command = [sys.executable, str(script)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"ready\n"
        children = psutil.Process(process.pid).children(recursive=True)
        process.kill()
    assert children
    _, alive = psutil.wait_procs(children, timeout=10.0)
    for child in alive:
        child.kill()
    assert alive == []
