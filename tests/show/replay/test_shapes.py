"""Outlines of bodies contain the points at which they are connected."""

import numpy as np
import pytest

import presswear as pw
from presswear.show.replay.shapes import attachments, body_outline


@pytest.mark.parametrize("mechanism", [pw.SliderCrank(), pw.TwoPoint()])
def test_a_slide_reaches_to_its_joints(mechanism: pw.SliderCrank | pw.TwoPoint) -> None:
    linkage = mechanism.linkage()
    outline = body_outline(linkage, "slider", 0.01)
    for point in attachments(linkage, "slider"):
        assert np.all(outline.min(axis=0) <= [point.x, point.y])
        assert np.all(outline.max(axis=0) >= [point.x, point.y])
