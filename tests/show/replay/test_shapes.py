"""Outlines of bodies contain their joints; slides with sizes and walls are to scale."""

import numpy as np
import pytest

import presswear as pw
from presswear.linkage.elements import GROUND
from presswear.show.replay.shapes import (
    attachments,
    body_outline,
    bounding_box,
    frame_shapes,
    loose_pins,
)


@pytest.mark.parametrize("mechanism", [pw.SliderCrank(), pw.TwoPoint()])
def test_a_slide_reaches_to_its_joints(mechanism: pw.SliderCrank | pw.TwoPoint) -> None:
    linkage = mechanism.linkage()
    outline = body_outline(linkage, "slider", 0.01)
    for point in attachments(linkage, "slider"):
        assert np.all(outline.min(axis=0) <= [point.x, point.y])
        assert np.all(outline.max(axis=0) >= [point.x, point.y])


def test_a_slide_and_its_walls_are_to_scale() -> None:
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
