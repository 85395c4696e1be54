"""Wear updates of the walls of a guide: a press that cuts beside the middle of its slide."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import re
from dataclasses import replace

import numpy as np
import pytest
from endurance.sameness import folder_differences
from refusals import refused

import presswear as pw
from campaign.fake_engine import Stops
from presswear.linkage.guide_corner import (
    WALL_BINS,
    WallMap,
    largest_tilt,
    tilting_clearance,
)
from presswear.physics.wall_wear import tilt_between, wall_volume
from presswear.show.report import render_report

pytestmark = pytest.mark.usefixtures("unwatched")
STROKES = 3e4  # that wear a wall by a tenth of its clearance
WALLS = {"wear_updates": 1, "cycles_per_update": STROKES, "replicates": 2, "cycles": 3}


def scene_of() -> pw.Scene:
    return pw.scenes.press_off_centre(**WALLS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("walls") / "whole"
    pw.run(scene_of(), path, jobs=1)
    return path


@pytest.fixture(scope="module")
def result(folder):
    return pw.load(folder)


def test_walls_wear_by_the_rate_times_the_strokes(result):
    """The wear of 30,000 strokes changes the load distance of a stroke by little."""
    new, worn = result.stages
    assert not new.is_worn
    assert worn.is_worn
    place, depth = worn.wall_depth("guide")
    _, rate = new.wall_wear("guide")
    assert not new.wall_depth("guide")[1].any()
    assert depth.max(axis=1) == pytest.approx(STROKES * rate.max(axis=1), rel=0.05)
    volume = 0.1 * (place[1] - place[0]) * depth.sum(axis=1)
    walls = new.statistics.walls["guide"]
    for side, each in zip(("left", "right"), volume, strict=True):
        per_stroke = walls[side].volume_per_cycle.mean
        assert each == pytest.approx(STROKES * per_stroke, rel=0.03)


def test_the_slide_follows_the_worn_walls(result):
    """At the fracture it tilts by as much more as the walls are worn there, over its length."""
    new, worn = (result.guide_tilts(k)["guide"].fracture for k in (0, 1))
    (guide,) = result.scene.loose_guides
    stage = result.stages[1]
    place, (left, right) = stage.wall_depth("guide")
    strokes, height = result.strokes(1), result.height(1)
    fractures = np.interp(strokes.fracture[:, 0], stage.clock, height)
    middle = result.scene.bottom + float(fractures.mean()) - guide.y
    ends = middle + 0.5 * guide.length, middle - 0.5 * guide.length
    depths = [np.interp(ends, place, wall) for wall in (left, right)]
    # The slide turns to the side on which the corners of the work press.
    wider = max(depths[0][0] + depths[1][1], depths[0][1] + depths[1][0])
    assert worn.mean - new.mean == pytest.approx(wider / guide.length, rel=0.2)
    assert worn.mean - new.mean > 1e-5


def test_a_scene_continues_on_worn_walls_bit_for_bit(result):
    worn = result.stages[1].surfaces
    assert worn.keys() == {"guide"}
    assert {surface.depth.size for surface in worn["guide"]} == {WALL_BINS}
    settings = {**WALLS, "wear_updates": 0, "cycles": 1, "replicates": 1}
    first = pw.run(pw.scenes.press_off_centre(surfaces=worn, **settings)).stages[0]
    for side, wall in zip(worn["guide"], first.wall_depth("guide")[1], strict=True):
        assert np.array_equal(side.depth, wall)
    assert first.name == "initial surfaces"


def test_the_life_of_a_wall_is_the_limit_over_the_wear_rate(result, tmp_path):
    """Two limits in one life; at 3 um the rate is within a few parts in a hundred."""
    (guide,) = result.scene.loose_guides
    new = largest_tilt(guide, 0.05e-3)
    tilt = new + 10e-6  # both walls are then worn by 4 um together, over 0.4 m
    until = f"guide.depth > 3 um, guide.tilt > {1e6 * tilt!r} um/m"
    life = pw.Life(until=f"{until}, guide.force_max > 1 MN")
    scene = pw.scenes.press_off_centre(
        wear_updates=1, life=life, tolerance=0.1, cycles=3, replicates=2
    )
    worn = pw.run(scene, tmp_path / "life", jobs=1)
    assert worn.life.ended == "limit"
    deepest = max(
        wall.depth_per_cycle.mean
        for wall in result.stages[0].statistics.walls["guide"].values()
    )
    depth, opening, force = worn.life.limits
    assert (depth.key, depth.unit) == ("guide.depth", "m")
    assert (opening.key, opening.unit) == ("guide.tilt", "m/m")
    reached = [limit for limit in worn.life.limits if limit.strokes is not None]
    assert opening in reached
    sides = result.stages[0].statistics.walls["guide"].values()
    both = sum(wall.depth_per_cycle.mean for wall in sides)
    assert opening.strokes == pytest.approx(10e-6 * guide.length / both, rel=0.1)
    strokes = worn.life.curves["strokes"]
    curve = worn.life.curves["guide.depth"][:, 0]
    assert curve == pytest.approx(deepest * strokes, rel=0.1)
    volumes = worn.life.curves["guide.wear_volume"][:, 0]
    rate = sum(wall.volume_per_cycle.mean for wall in sides)
    assert volumes == pytest.approx(rate * strokes, rel=0.05)
    # The force of a corner hardly changes while 3 um wear off.
    peaks = result.guide_tilts(0)["guide"].corner_force
    assert force.strokes is None
    assert force.last == pytest.approx(peaks.mean, rel=0.05)
    end = worn.stages[1].wall_depth("guide")[1].max()
    assert end == pytest.approx(np.interp(worn.life.strokes, strokes, curve), rel=0.05)
    assert "tilt of guide over" in render_report(worn)


def test_new_walls_wear_as_the_first_ones(result):
    """The life is the strokes up to the replacement, and those of a life without it."""
    life = pw.Life(until="guide.depth > 3 um", replaced="guide@1e4")
    scene = pw.scenes.press_off_centre(**WALLS | {"life": life, "tolerance": 0.2})
    worn = pw.run(scene, jobs=1)
    walls = result.stages[0].statistics.walls["guide"].values()
    rate = max(wall.depth_per_cycle.mean for wall in walls)
    assert worn.life.strokes == pytest.approx(1e4 + 3e-6 / rate, rel=0.1)
    assert worn.life.services == ("walls of guide replaced after 1e+04 strokes",)
    strokes, depth = worn.life.curves["strokes"], worn.life.curves["guide.depth"][:, 0]
    before, after = depth[strokes == 1e4]
    assert before == pytest.approx(1e4 * rate, rel=0.1)
    assert after == 0.0


@pytest.mark.parametrize("place", [0, 300, 599])
def test_a_tilt_between_worn_walls_has_a_closed_form(place):
    """The front of the slide lies at a trench of one wall, its back at one of the second."""
    (guide,) = pw.scenes.press_off_centre().loose_guides
    # 400 bins of the wall are as long as the slide.
    wall = WallMap(1e-13, -0.5, 0.001 * WALL_BINS)
    corner = replace(pw.scenes.press_off_centre().linkage().corners[0], wall=wall)
    walls = np.zeros((2, WALL_BINS))
    assert tilt_between(corner, walls) == largest_tilt(guide, 0.05e-3)
    walls[0, place + 400], walls[1, place] = 7e-6, 5e-6
    wider = largest_tilt(guide, 0.05e-3 + 6e-6)
    assert tilt_between(corner, walls) == pytest.approx(wider, rel=1e-9)
    assert tilt_between(corner, walls[::-1]) == pytest.approx(wider, rel=1e-9)
    assert tilting_clearance(guide, wider) == pytest.approx(0.056e-3, rel=1e-9)
    walls[0] = np.roll(walls[0], 1)
    assert tilt_between(corner, walls) < wider - 1e-6


TILT = "250.023 um/m"


@pytest.mark.parametrize(
    ("until", "rotated", "message"),
    [
        (
            "guide.tilt > 200 um/m",
            "",
            f"'guide.tilt > 200 um/m': allowed is above {TILT}",
        ),
        ("radial_clearance > 1 mm", "", "radial_clearance is of a pin, and none has"),
        ("depth > 0.6 mm", "", "allowed is below 0.5 mm, with wear of 10 clearances"),
        ("depth > 6 um", "guide@2e4", "the walls of a guide can be replaced only"),
        ("depth > 6 um", "guid@2e4", "did you mean guide"),
    ],
)
def test_a_limit_that_does_not_fit_is_refused_in_one_line(until, rotated, message):
    life = pw.Life(until=until, rotated=rotated)
    with refused(re.escape(message)):
        pw.scenes.press_off_centre(wear_updates=1, life=life)


def test_a_quick_life_of_walls_is_the_limits_over_two_wear_rates(result):
    """Half of the first limit wears off at the rate when new, the rest at the second rate."""
    (guide,) = result.scene.loose_guides
    tilt = largest_tilt(guide, 0.05e-3) + 30e-6
    until = (
        f"guide.depth > 6 um, guide.tilt > {1e6 * tilt!r} um/m, wear_volume > 5 mm^3"
    )
    life = pw.Life(until=until, quick="on")
    quick = pw.run(pw.scenes.press_off_centre(**WALLS | {"life": life}), jobs=1)
    assert quick.life.ended == "quick"
    sides = result.stages[0].statistics.walls["guide"].values()
    deepest = max(wall.depth_per_cycle.mean for wall in sides)
    depth, opening, lost = (limit.strokes for limit in quick.life.limits)
    assert depth == pytest.approx(6e-6 / deepest, rel=0.1)
    # With constant rates all limits are exceeded by the depth of the walls at that time.
    worn = quick.stages[1]
    since = quick.life.wear_rates[1].since
    _, first = worn.wall_depth("guide")
    _, rate = worn.wall_wear("guide")
    assert first.max() == pytest.approx(3e-6, rel=1e-9)
    corner = quick.scene.linkage().corners[0]

    def walls(strokes: float) -> np.ndarray:
        return np.asarray(first + (strokes - since) * rate)

    assert walls(depth).max() == pytest.approx(6e-6, rel=1e-12)
    assert tilt_between(corner, walls(opening)) == pytest.approx(tilt, rel=1e-9)
    assert wall_volume(corner, walls(lost)) == pytest.approx(5e-9, rel=1e-12)


def test_limits_of_guides_and_pins_are_named():
    def limits(until: str) -> list[tuple[str, float]]:
        life = pw.Life(until=until).limits({"A": 1e-4}, {"guide": 2e-4})
        return [(limit.key, limit.value) for limit in life]

    ((key, value),) = limits("tilt > 1.5 x new")
    assert key == "guide.tilt"
    assert value == pytest.approx(3e-4)
    both = [limit[0] for limit in limits("depth > 0.05 mm")]
    assert both == ["A.depth", "guide.depth"]
    both = [limit[0] for limit in limits("force_max > 1 kN")]
    assert both == ["A.force_max", "guide.force_max"]
    with refused("tilt is of a guide, such as guide"):
        limits("A.tilt > 1 mm/m")


@pytest.mark.parametrize(("word", "reports"), [("cycle", 4), ("steps", 5)])
def test_an_interrupted_run_resumes_bit_for_bit(word, reports, folder, tmp_path):
    path = tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene_of(), path, observers=[Stops(word, reports)], jobs=1)
    pw.run(scene_of(), path, jobs=1)
    assert folder_differences(folder, path) == []
