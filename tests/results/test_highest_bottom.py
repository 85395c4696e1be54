"""Bottom dead centre at the highest place, compared with the press turned by half a turn."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import presswear as pw
from presswear.scene.options import Numerics

CRANK = pw.SliderCrank(slide_angle=0.0, speed=30.0, gravity=0.0)
THIN_SHEET = pw.Blanking(height=3e-3, force=50.0)
SOFT = pw.Bearing(clearance=1e-4, friction=0.0, normal_law="flores", restitution=0.1)
"""Pins come to rest on it, and nothing grows."""


@pytest.fixture(scope="module")
def both():
    """Of the highest place as it stands, and of the lowest turned by half a turn."""
    linkage = CRANK.linkage()
    turned = linkage.changed(
        drives=(replace(linkage.drives[0], angle=math.pi),),
        guess={"crank": math.pi, "rod": math.pi},
    )
    exact = Numerics(dae=pw.engines.InHouse(integration_tolerance=1e-12))
    short: dict[str, Any] = {"wear_updates": 0, "cycles": 3, "engine": "dae"}
    short |= {"numerics": exact, "conventions": "paper"}
    scenes = [
        pw.Scene(mechanism, process=process, bearings={"B": SOFT}, **short)
        for mechanism, process in (
            (linkage, replace(THIN_SHEET, bottom="highest")),
            (turned, THIN_SHEET),
        )
    ]
    return [pw.run(scene) for scene in scenes]


def test_the_highest_place_is_bottom_dead_centre_everywhere(both):
    scenes = [result.scene for result in both]
    # Rod and crank in line, farthest from the axis.
    for scene in scenes:
        assert scene.bottom == pytest.approx(
            -CRANK.rod_length - CRANK.crank_length, abs=1e-15
        )
    near = 1e-9
    stages: list[pw.results.StageResult] = [result.stages[0] for result in both]
    one, other = (stage.bdc for stage in stages)
    assert one.strokes == other.strokes == 1
    for name in ("height", "error", "delay"):
        assert getattr(one, name).mean == pytest.approx(
            getattr(other, name).mean, abs=near
        )
    assert one.ideal_height == pytest.approx(other.ideal_height, abs=near)
    # Pulled away from the work the pin gives way by its clearance; below 1 mm either
    # way.
    assert -1e-3 < one.error.mean < 0.0
    for name in ("contact", "fracture", "separation"):
        first, second = (getattr(result.strokes(0), name) for result in both)
        np.testing.assert_allclose(first, second, atol=1e-9)
    tonnages = [result.tonnage(0) for result in both]
    forces = [
        own.joints["B"].peak_by_phase["work"].mean
        for own in tonnages
        if own is not None
    ]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
    heights = [result.height(0) for result in both]
    assert heights[0].max() == pytest.approx(2.0 * CRANK.crank_length, abs=1e-3)
    # Rows are apart by a 2000th of a cycle.
    for end in (np.min, np.max):
        assert end(heights[0]) == pytest.approx(end(heights[1]), abs=1e-6)


def test_what_is_pushed_away_from_the_work_rises(both):
    loose = [result.scene.linkage() for result in both]
    total = [pw.statics.total_clearance(linkage, force=100.0) for linkage in loose]
    rise = [pw.statics.deflection(linkage, force=50.0, idle=-10.0) for linkage in loose]
    assert total[0] == pytest.approx(total[1], rel=1e-9)
    assert rise[0] == pytest.approx(rise[1], rel=1e-9)
    assert total[0] > 2e-4
    assert rise[0] > 2e-4
