"""Outlines of bodies contain their joints; slides with sizes and walls are to scale."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import numpy as np
import pytest
from slotted import quick_return, sized

import presswear as pw
from presswear.linkage.guide_corner import WALL_BINS
from presswear.linkage.points import GROUND
from presswear.linkage.surface import Surface
from presswear.show.replay.shapes import (
    attachments,
    body_outline,
    body_shapes,
    bounding_box,
    frame_shapes,
    loose_pins,
    slot_outline,
    wall_factor,
    worn_walls,
)


def test_a_slide_and_its_walls_are_to_scale():
    crank = pw.SliderCrank(guide_length=0.12, guide_width=0.08)
    play = pw.Bearing(clearance=2e-3)
    scene = pw.Scene(crank, bearings={"B": pw.Bearing(), "guide": play})
    linkage = scene.linkage()
    assert [joint.name for joint in loose_pins(linkage)] == ["B"]
    outline = body_outline(linkage, "slider", 0.005)
    assert sorted(np.ptp(outline, axis=0)) == pytest.approx([0.08, 0.12])
    # corners are no joints: only the crank has a pedestal
    assert len(attachments(linkage, GROUND)) == 1
    positions = scene.ideal.at(np.zeros(1)).position
    low, high = bounding_box(linkage, positions)
    assert np.all(high - low > [0.08, 0.12])
    bar = 0.005
    walls = [
        shape.points[:, 0]
        for shape in frame_shapes(linkage, positions, bar)
        if np.ptp(shape.points[:, 1]) > 0.12 and np.ptp(shape.points[:, 0]) < 2e-3
    ]
    inner = sorted(float(np.abs(wall).min()) for wall in walls)
    assert inner == pytest.approx([0.042, 0.042], abs=1e-9)


def test_the_wear_of_walls_is_enlarged():
    """A trench of 10 um in the left wall, of one bin, is a bar of four half widths."""
    scene = pw.scenes.press_off_centre()
    depth = np.zeros(WALL_BINS)
    depth[100] = 1e-5
    linkage = scene.linkage({"guide": (Surface(depth), Surface())})
    factor = wall_factor(1e-5, 0.005)
    assert 1900.0 <= factor <= 2000.0  # rounded down to two digits
    assert wall_factor(0.0, 0.005) == 0.0
    drawn = np.concatenate([shape.points for shape in worn_walls(linkage, factor)])
    assert drawn[:, 0].min() == pytest.approx(-0.15 - 0.05e-3 - factor * 1e-5)
    deep = drawn[drawn[:, 0] < -0.165, 1]
    (corner, *_) = linkage.corners
    place = corner.wall.start + 100.5 * corner.wall.bin_length
    assert deep.min() < place < deep.max()
    assert not worn_walls(scene.linkage(), factor)


def test_a_slot_with_clearance_and_its_worn_walls_move_with_their_body():
    """The slot is to scale over the travel of the block, 200 mm; its walls are worn by 10 um."""
    scene = pw.Scene(
        sized(quick_return(), "slot", 0.06, 0.04),
        joints="slot",
        bearings=pw.Bearing(clearance=2e-3),
    )
    depth = np.zeros(WALL_BINS)
    depth[500] = 1e-5
    linkage = scene.linkage({"slot": (Surface(depth), Surface())})
    positions = scene.ideal.position.reshape(-1, 9)
    (guide,) = linkage.loose_guides
    bar = 0.005
    low, _, high, _ = slot_outline(linkage, positions, guide, bar)
    assert high - low == pytest.approx([0.26 + 2.0 * bar, 0.044], abs=1e-6)
    shapes = [len(body_shapes(linkage, positions, k, bar)) for k in range(3)]
    ideal = [
        len(body_shapes(scene.ideal.rows.linkage, positions, k, bar)) for k in range(3)
    ]
    assert shapes == ideal
    factor = wall_factor(1e-5, bar)
    assert not worn_walls(linkage, factor)
    drawn = np.concatenate(
        [wall.points for wall in worn_walls(linkage, factor, "rocker")]
    )
    assert drawn[:, 1].max() == pytest.approx(0.022 + factor * 1e-5)
    deep = drawn[drawn[:, 1] > 0.025, 0]
    assert deep.min() < 0.1 < deep.max()
