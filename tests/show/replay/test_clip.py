"""What is played: which frames, how fast, and what keys do."""

import pytest
from made_up_reel import made_up_reel

from presswear.show.replay.reel import frames_at, frames_between, instants, played
from presswear.show.replay.window import DOWN, END, HOME, LEFT, RIGHT, SPACE, UP, Player
from presswear.tools.errors import InputError

REEL = made_up_reel()
PERIOD = REEL.period


def test_a_frame_is_the_nearest_in_time() -> None:
    step = REEL.film.time[1]
    assert REEL.frame_at(0.0) == 0
    assert REEL.frame_at(10.4 * step) == 10
    assert REEL.frame_at(10.6 * step) == 11
    assert REEL.frame_at(99.0) == 100


def test_a_clip_takes_its_time_and_ends_in_time() -> None:
    frames = frames_between([REEL], 0.0, PERIOD, 10.0 / PERIOD, 5.0)
    assert frames == [(2 * k,) for k in range(50)]
    assert REEL.slowed == pytest.approx(10.0 / PERIOD, rel=0.05)
    assert REEL.start == 0.0  # a film of one cycle


def test_a_time_outside_the_film_is_refused_by_name() -> None:
    with pytest.raises(InputError, match=r"made up, first wear, goes from 0 s to 0\.571"):
        frames_at([REEL], 2.0 * PERIOD)
    with pytest.raises(InputError, match="time -0"):
        frames_at([REEL], -0.1)


def test_a_film_that_nobody_would_see_the_end_of_is_refused() -> None:
    with pytest.raises(InputError, match="at most 20000 are drawn"):
        frames_between([REEL], 0.0, PERIOD, 1e5, 25.0)


def test_no_peak_between_two_pictures_is_missed() -> None:
    peaks = REEL.film.joints[:, :, 5]
    (instant,) = instants([REEL], [10], [20])
    assert instant.peaks == pytest.approx(peaks[11:21].max(axis=0))
    (same,) = instants([REEL], [20], [20])
    assert same.peaks == pytest.approx(peaks[20])
    (back,) = instants([REEL], [40], [20])
    assert back.peaks == pytest.approx(peaks[20])


def test_the_speed_is_said_in_words() -> None:
    assert played(18.0) == "slowed 18 times"
    assert played(0.5) == "2 times as fast as it is"
    assert played(1.0) == "as fast as it is"


def test_a_player_plays_pauses_steps_and_begins_again() -> None:
    player = Player(0.0, 1.0, 0.2, slowed=10.0, step=0.01)
    player.advance(1.0)
    assert player.time == pytest.approx(0.3)
    assert player.press(SPACE)
    player.advance(1.0)
    assert player.time == pytest.approx(0.3)
    assert player.press(RIGHT)
    assert player.press(RIGHT)
    assert player.press(LEFT)
    assert player.time == pytest.approx(0.31)
    assert player.press(SPACE)
    assert player.press(UP)
    player.advance(1.0)
    assert player.time == pytest.approx(0.31 + 0.15)
    assert player.press(DOWN)
    assert player.slowed == pytest.approx(10.0)
    assert player.press(END)
    assert player.part == 1.0
    player.advance(1.0)
    assert player.time == 0.0
    assert player.press(RIGHT)
    assert player.press(HOME)
    assert player.press(LEFT)
    assert player.time == 0.0
    assert not player.press(ord("X"))
