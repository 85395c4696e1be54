"""Clips: frames, service lives, and the player."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic_clip import synthetic_clip

import presswear as pw
from presswear.recording.film import FRAMES_PER_CYCLE
from presswear.results.life import LifeResult
from presswear.scene.options import Life
from presswear.show.replay.clip import frames_at, frames_between, life_clip, snapshots
from presswear.show.replay.output import DOWN, END, HOME, LEFT, RIGHT, SPACE, UP, Player

CLIP = synthetic_clip()


def test_frames_are_the_nearest_in_time() -> None:
    step = CLIP.film.time[1]
    assert [frames_at([CLIP], t * step) for t in (0.0, 10.4, 10.6)] == [(0,), (10,), (11,)]
    slow = 10.0 / CLIP.period
    assert frames_between([CLIP], 0.0, CLIP.period, slow, 5.0) == [(2 * k,) for k in range(50)]
    assert CLIP.default_slow == pytest.approx(slow, rel=0.05)
    with pytest.raises(pw.InputError, match=r"title, first wear, goes from 0 s to 0\.571"):
        frames_at([CLIP], 2.0 * CLIP.period)
    with pytest.raises(pw.InputError, match="at most 20000 are drawn"):
        frames_between([CLIP], 0.0, CLIP.period, 1e5, 25.0)


@pytest.mark.parametrize("previous", [10, 20, 40])
def test_no_peak_between_two_pictures_is_missed(previous: int) -> None:
    peaks = CLIP.film.joints[min(previous + 1, 20) : 21, :, 5].max(axis=0)
    (state,) = snapshots([CLIP], [previous], [20])
    assert state.peaks == pytest.approx(peaks)
    assert [len(CLIP.snapshot(k, k).positions) for k in (0, 100)] == [1, 61]


def test_player_keys() -> None:
    player = Player(0.0, 1.0, 0.2, slow=10.0, step=0.01)
    player.advance(1.0)
    assert player.time == pytest.approx(0.3)
    assert player.press(SPACE)
    player.advance(1.0)
    assert all(map(player.press, (RIGHT, RIGHT, LEFT)))
    assert player.time == pytest.approx(0.31)
    assert player.press(SPACE)
    assert player.press(UP)
    player.advance(1.0)
    assert player.time == pytest.approx(0.31 + 0.15)
    assert player.press(DOWN)
    assert player.slow == pytest.approx(10.0)
    assert player.press(END)
    assert player.part == 1.0
    player.advance(1.0)
    assert player.time == 0.0
    assert all(map(player.press, (RIGHT, HOME, LEFT)))
    assert player.time == 0.0
    assert not player.press(ord("X"))


def test_a_life_is_the_last_cycle_of_each_stage() -> None:
    scene = pw.scenes.wear_times(
        engine="dae", cycles=3, wear_updates=1, replicates=2, conventions="refined"
    )
    result = pw.run(scene, jobs=1)
    with pytest.raises(pw.InputError, match="has no life"):
        life_clip(result)
    life = LifeResult("at_most", "", 3e6, None, None, 0.9, (), (), ())
    result = replace(result, scene=replace(result.scene, life=Life()), life=life)
    clip = life_clip(result)
    assert [each.stage for each in clip.chapters] == ["no wear", "after 3 million strokes"]
    step = np.diff(clip.film.time)
    assert 0.0 < step.min() < step.max() < 2.0 * clip.period / FRAMES_PER_CYCLE
    assert clip.span[1] - clip.span[0] == pytest.approx(2.0 * clip.period, rel=1e-2)
    assert clip.default_start == clip.span[0]
    start = result.scene.run_up + 2.0 * clip.period  # of the third cycle
    for stage, first, chapter in zip(result.stages, clip.firsts, clip.chapters, strict=True):
        row = int(np.flatnonzero(stage.film.time >= start - 1e-9)[0])
        np.testing.assert_array_equal(clip.film.position[first], stage.film.position[row])
        depth = chapter.linkage.clearances[0].bearing_surface.depth
        assert depth.max(initial=0.0) == stage.joints["A"].depth("bearing").max()
    second = clip.firsts[1]
    assert [clip.snapshot(k, k).chapter for k in (0, second - 1, second)] == [0, 0, 1]
    assert len(clip.snapshot(second, second - 2).positions) == 1
    film = result.stages[1].film
    half = replace(film, time=film.time[:9], position=film.position[:9], joints=film.joints[:9])
    cut = replace(result.stages[1], read_film=lambda: half)
    with pytest.raises(pw.InputError, match="its film has no whole cycle"):
        life_clip(replace(result, stages=(result.stages[0], cut)))
