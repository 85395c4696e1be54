"""A film through a life: a cycle of each stage, with its surfaces and its strokes."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_reel import FRAMES, made_up_reel

from presswear.campaign.single import run
from presswear.recording.film import FRAMES_PER_CYCLE
from presswear.results.life import LifeResult
from presswear.results.result import Result
from presswear.scene.catalog import wear_times
from presswear.scene.life import Life
from presswear.show.replay.picture import Picture
from presswear.show.replay.reel import Chapter, Reel, life_reel
from presswear.tools.errors import InputError

LIFE = LifeResult("at_most", "", 3e6, None, None, 0.9, (), (), ())


@pytest.fixture(scope="module")
def result() -> Result:
    """Two stages of three cycles, as if the second stood at the end of a life."""
    ran = run(
        wear_times(engine="dae", cycles=3, wear_updates=1, replicates=2, conventions="refined")
    )
    return replace(ran, scene=replace(ran.scene, life=Life()), life=LIFE)


def test_the_last_cycle_of_each_stage_follows_the_one_before(result: Result) -> None:
    reel = life_reel(result)
    assert [own.stage for own in reel.chapters] == ["no wear", "after 3 million strokes"]
    assert len(reel.firsts) == 2
    step = np.diff(reel.film.time)
    # Frames are of accepted steps of the run: no two at one time, none left out where stages meet.
    assert step.min() > 0.0
    assert step.max() < 2.0 * reel.period / FRAMES_PER_CYCLE
    assert reel.span[1] - reel.span[0] == pytest.approx(2.0 * reel.period, rel=1e-2)
    assert reel.start == reel.span[0]
    assert reel.whole == pytest.approx(2.0 * reel.period)
    for stage, first in zip(result.stages, reel.firsts, strict=True):
        # The third cycle begins behind the run-up and two cycles.
        begin = result.scene.run_up + 2.0 * reel.period
        row = int(np.flatnonzero(stage.film.time >= begin - 1e-9)[0])
        np.testing.assert_array_equal(reel.film.position[first], stage.film.position[row])
    for chapter, stage in zip(reel.chapters, result.stages, strict=True):
        depth = chapter.linkage.clearances[0].bearing_surface.depth
        assert depth.max(initial=0.0) == stage.joints["A"].depth("bearing").max()


def test_what_has_no_life_or_no_whole_cycle_is_refused(result: Result) -> None:
    with pytest.raises(InputError, match="has no life"):
        life_reel(replace(result, life=None))
    film = result.stages[1].film
    half = replace(
        film, time=film.time[:250], position=film.position[:250], joints=film.joints[:250]
    )
    cut = replace(result.stages[1], read_film=lambda: half)
    with pytest.raises(InputError, match="after 3 million strokes: its film holds no whole cycle"):
        life_reel(replace(result, stages=(result.stages[0], cut)))


def two() -> Reel:
    """A round stage before the worn one, made up."""
    reel = made_up_reel()
    second = FRAMES // 2 + 1
    round_ = made_up_reel(deepest=0.0).linkage
    worn = Chapter("after 3 million strokes", reel.linkage)
    return replace(reel, stage="no wear", linkage=round_, later=(worn,), firsts=(0, second))


def test_a_path_does_not_reach_into_the_stage_before() -> None:
    reel, second = two(), FRAMES // 2 + 1
    assert [reel.instant(k, k).chapter for k in (0, second - 1, second, FRAMES - 1)] == [0, 0, 1, 1]
    assert len(reel.instant(second, second - 2).past) == 1
    assert len(reel.instant(second + 5, second).past) == 6
    peaks = reel.film.joints[second, :, 5]
    assert reel.instant(second, second - 3).peaks == pytest.approx(peaks)


def test_only_the_joints_of_the_stage_are_in_sight() -> None:
    reel = two()
    picture = Picture([reel], (480, 320))
    data = picture.system.systemData
    joints = len(reel.linkage.bodies)
    for frame, words in ((5, "no wear"), (FRAMES - 1, "after 3 million strokes")):
        instant = reel.instant(frame, frame)
        picture.set([instant], 0.5, "")
        place = np.asarray(data.GetODE2Coordinates()).reshape(-1, 3)[joints:, 0]
        is_seen = np.abs(place) < 0.5 * picture.layout.height
        # Four bodies of two joints, in the first stage and then in the second.
        assert is_seen.tolist() == [instant.chapter == k for k in (0, 1) for _ in range(8)]
        told = " ".join(picture.container.renderer.GetGraphicsData()["texts"]["text"])
        assert f"made up, {words}" in told
        assert "t =" not in told
    picture.close()
