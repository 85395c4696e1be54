"""Clips, the player, and films: readable by other programs, complete or absent."""

import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from refusals import refused
from synthetic_clip import WithoutMemory, synthetic_clip

import presswear as pw
from presswear.recording.film import FRAMES_PER_CYCLE
from presswear.results.life import LifeResult
from presswear.scene.options import Life
from presswear.show.replay import output
from presswear.show.replay.clip import frames_at, frames_between, life_clip, snapshots
from presswear.tools.errors import RunFailed

CLIP = synthetic_clip()


def test_frames_are_the_nearest_in_time():
    step = CLIP.film.time[1]
    assert [frames_at([CLIP], t * step) for t in (0.0, 10.4, 10.6)] == [
        (0,),
        (10,),
        (11,),
    ]
    slow = 10.0 / CLIP.period
    assert frames_between([CLIP], 0.0, CLIP.period, slow, 5.0) == [
        (2 * k,) for k in range(50)
    ]
    assert CLIP.default_slow == pytest.approx(slow, rel=0.05)
    with refused(r"title, first wear, goes from 0 s to 0\.571"):
        frames_at([CLIP], 2.0 * CLIP.period)
    with refused("at most 20000 are drawn"):
        frames_between([CLIP], 0.0, CLIP.period, 1e5, 25.0)


@pytest.mark.parametrize("previous", [10, 20, 40])
def test_no_peak_between_two_pictures_is_missed(previous):
    peaks = CLIP.film.joints[min(previous + 1, 20) : 21, :, 5].max(axis=0)
    (state,) = snapshots([CLIP], [previous], [20])
    assert state.peaks == pytest.approx(peaks)
    assert [len(CLIP.snapshot(k, k).positions) for k in (0, 100)] == [1, 61]


PLAYED = [  # keys, and the time after another second
    ([], 0.3),
    ([output.SPACE], 0.3),
    ([output.RIGHT, output.RIGHT, output.LEFT], 0.31),
    ([output.SPACE, output.UP], 0.31 + 0.15),
    ([output.DOWN, output.END], 0.0),
    ([output.RIGHT, output.HOME, output.LEFT], 0.0),
]


def test_player_keys():
    player = output.Player(0.0, 1.0, 0.2, slow=10.0, step=0.01)
    for keys, time in PLAYED:
        assert all(map(player.press, keys))
        player.advance(1.0)
        assert player.time == pytest.approx(time)
    player.press(output.END)
    assert player.fraction == 1.0
    assert player.slow == pytest.approx(10.0)
    assert not player.press(ord("X"))


def test_a_life_is_the_last_cycle_of_each_stage():
    scene = pw.scenes.wear_times(
        engine="dae", cycles=3, wear_updates=1, replicates=2, conventions="refined"
    )
    result = pw.run(scene, jobs=1)
    with refused("has no life"):
        life_clip(result)
    life = LifeResult("at_most", "", 3e6, None, None, 0.9, (), (), ())
    result = replace(result, scene=replace(result.scene, life=Life()), life=life)
    clip = life_clip(result)
    assert [each.stage for each in clip.chapters] == [
        "no wear",
        "after 3 million strokes",
    ]
    step = np.diff(clip.film.time)
    assert 0.0 < step.min() < step.max() < 2.0 * clip.period / FRAMES_PER_CYCLE
    assert clip.span[1] - clip.span[0] == pytest.approx(2.0 * clip.period, rel=1e-2)
    assert clip.default_start == clip.span[0]
    start = result.scene.run_up + 2.0 * clip.period  # of the third cycle
    for stage, first, chapter in zip(
        result.stages, clip.firsts, clip.chapters, strict=True
    ):
        row = int(np.flatnonzero(stage.film.time >= start - 1e-9)[0])
        np.testing.assert_array_equal(
            clip.film.position[first], stage.film.position[row]
        )
        depth = chapter.linkage.clearances[0].bearing_surface.depth
        assert depth.max(initial=0.0) == stage.joints["A"].depth("bearing").max()
    second = clip.firsts[1]
    assert [clip.snapshot(k, k).chapter for k in (0, second - 1, second)] == [0, 0, 1]
    assert len(clip.snapshot(second, second - 2).positions) == 1
    film = result.stages[1].film
    half = replace(
        film, time=film.time[:9], position=film.position[:9], joints=film.joints[:9]
    )
    cut = replace(result.stages[1], read_film=lambda: half)
    with refused("its film has no whole cycle"):
        life_clip(replace(result, stages=(result.stages[0], cut)))


SIZE = (320, 214)


def moving(count: int, fails: bool = False) -> Iterator[NDArray[np.uint8]]:
    for k in range(count):
        image = np.full((64, 96, 3), 255, dtype=np.uint8)
        image[10:20, 5 * k : 5 * k + 10] = (200, 30, 30)
        yield image
    if fails:
        raise RuntimeError("the renderer failed")


def test_a_gif_has_every_picture_and_the_requested_speed(tmp_path):
    output.write_movie(tmp_path / "film.gif", moving(7), 10.0)
    with Image.open(tmp_path / "film.gif") as film:
        assert getattr(film, "n_frames", 1) == 7
        assert film.info["duration"] == 100
        film.seek(4)
        red = np.array(film.convert("RGB"))[15] == (200, 30, 30)
    assert np.flatnonzero(red.all(axis=1)).tolist() == list(range(20, 30))


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is missing")
def test_an_mp4_is_complete_or_absent(tmp_path):
    file = tmp_path / "film.mp4"
    output.write_movie(file, moving(9), 25.0)
    command = ["ffprobe", "-v", "error", "-count_frames", "-show_entries"]
    command += ["stream=nb_read_frames,r_frame_rate,width", "-of", "csv=p=0", str(file)]
    shown = subprocess.run(
        command, capture_output=True, text=True, check=True
    ).stdout.strip()
    assert shown == "96,25/1,9"
    film = file.read_bytes()
    with pytest.raises(RuntimeError, match="the renderer failed"):
        output.write_movie(file, moving(3, fails=True), 10.0)
    assert [path.name for path in tmp_path.iterdir()] == [file.name]
    assert file.read_bytes() == film


def test_pictures_of_all_processes_are_in_order():
    frames = frames_between([CLIP], 0.0, 0.2 * CLIP.period, 2.0, 40.0)
    drawn = list(output.pictures([CLIP], frames, "", SIZE))
    assert len(drawn) == len(frames) > 5
    single = output.still([CLIP], frames[3], SIZE)
    # Title, time bar and peaks differ; the mechanism does not.
    assert np.array_equal(drawn[3][30:185, :200], single[30:185, :200])
    assert not np.array_equal(drawn[3][30:185, :200], drawn[4][30:185, :200])


class Deadly:
    """Ends the process that unpickles it."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (1,)


@pytest.mark.parametrize(
    "clip", [Deadly(), WithoutMemory()], ids=lambda clip: type(clip).__name__
)
def test_a_process_that_ends_early_ends_the_film(clip, monkeypatch, capfd):
    """Without a traceback, also from the thread of the pool."""
    failed: list[Any] = []
    monkeypatch.setattr(threading, "excepthook", failed.append)
    with pytest.raises(
        RunFailed, match="unexpectedly, for example because memory ran out"
    ):
        list(output.pictures([clip], [[0]] * 5000, "", SIZE))
    assert failed == []
    assert capfd.readouterr().err == ""
