"""Wear updates of the walls of a guide: a press that cuts beside the middle of its slide."""

from pathlib import Path

import numpy as np
import pytest
from endurance.sameness import folder_differences

import presswear as pw
from presswear.linkage.elements import WALL_BINS

STROKES = 3e4  # that wear a wall by a tenth of its clearance
WALLS = {"wear_updates": 1, "cycles_per_update": STROKES, "replicates": 2, "cycles": 3}


def scene_of() -> pw.Scene:
    return pw.scenes.press_off_centre(**WALLS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("walls") / "whole"
    pw.run(scene_of(), path, jobs=1)
    return path


@pytest.fixture(scope="module")
def result(folder: Path) -> pw.Result:
    return pw.load(folder)


def test_walls_wear_by_the_rate_times_the_strokes(result: pw.Result) -> None:
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


def test_the_slide_follows_the_worn_walls(result: pw.Result) -> None:
    """At the fracture it tilts by as much more as the walls are worn there, over its length."""
    new, worn = (result.guide_tilts(k)["guide"].fracture for k in (0, 1))
    assert new is not None
    assert worn is not None
    (guide,) = result.scene.loose_guides
    stage = result.stages[1]
    place, (left, right) = stage.wall_depth("guide")
    strokes, height = result.strokes(1), result.height(1)
    assert strokes is not None
    assert height is not None
    fractures = np.interp(strokes.fracture[:, 0], stage.clock, height)
    middle = result.scene.bottom + float(fractures.mean()) - guide.y
    ends = middle + 0.5 * guide.length, middle - 0.5 * guide.length
    depths = [np.interp(ends, place, wall) for wall in (left, right)]
    # The slide turns to the side on which the corners of the work press.
    wider = max(depths[0][0] + depths[1][1], depths[0][1] + depths[1][0])
    assert worn.mean - new.mean == pytest.approx(wider / guide.length, rel=0.2)
    assert worn.mean - new.mean > 1e-5


def test_a_scene_continues_on_worn_walls_bit_for_bit(result: pw.Result) -> None:
    worn = result.stages[1].surfaces
    assert worn.keys() == {"guide"}
    assert {surface.depth.size for surface in worn["guide"]} == {WALL_BINS}
    settings = {**WALLS, "wear_updates": 0, "cycles": 1, "replicates": 1}
    first = pw.run(pw.scenes.press_off_centre(surfaces=worn, **settings)).stages[0]
    for side, wall in zip(worn["guide"], first.wall_depth("guide")[1], strict=True):
        assert np.array_equal(side.depth, wall)
    assert first.name == "initial surfaces"


class Stops(pw.Observer):
    """Interrupts a campaign at some progress with a word."""

    def __init__(self, word: str, reports: int) -> None:
        self.word, self.left = word, reports

    def on_progress(self, progress: pw.Progress) -> None:
        if self.word in progress.word:
            self.left -= 1
            if not self.left:
                raise KeyboardInterrupt


@pytest.mark.parametrize(("word", "reports"), [("cycle", 4), ("steps", 5)])
def test_an_interrupted_run_resumes_bit_for_bit(
    word: str, reports: int, folder: Path, tmp_path: Path
) -> None:
    path = tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene_of(), path, observers=[Stops(word, reports)], jobs=1)
    pw.run(scene_of(), path, jobs=1)
    assert folder_differences(folder, path) == []
