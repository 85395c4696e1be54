"""Bottom dead centre: against closed forms."""

import math
from typing import Any

import numpy as np
import pytest
from closed_form import press_motion
from scipy.optimize import brentq

from presswear.linkage.bodies import Bar
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.points import OutputPoint
from presswear.linkage.press import GEOMETRIES, Press
from presswear.physics.curve_following import motion_of
from presswear.physics.dead_centre import bottom_of


def bar(angle: float = 0.0, **changes: Any) -> Linkage:
    """A bar that turns about its tail; its head is watched upright."""
    return assemble(
        bodies=[Bar("bar", length=0.2, mass=1.0)],
        joints=[Pin("O", (0.0, 0.0), "bar.tail")],
        drives=[Drive("bar", speed=10.0, angle=angle)],
        output=OutputPoint("bar", 0.5 * math.pi, x=0.1),
        **changes,
    )


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
def test_press_is_lowest_where_the_closed_form_stands(geometry):
    press = Press(geometry=GEOMETRIES[geometry])
    linkage = press.linkage()
    result = bottom_of(motion_of(press))
    assert result is not None

    def level(time: float, which: int) -> float:
        return float(press_motion(press, np.array([time])).output(linkage)[0, which])

    time = brentq(level, result.time - 0.02, result.time + 0.02, args=(1,), xtol=1e-16)
    assert result.time == pytest.approx(time, abs=1e-14)
    assert result.height == pytest.approx(level(time, 0), abs=1e-15)
    everywhere = np.linspace(0.0, press.period, 20_001)
    height, speed, _ = press_motion(press, everywhere).output(linkage).T
    assert result.height <= height.min() + 1e-15
    assert result.stroke == pytest.approx(float(np.ptp(height)), rel=1e-5)
    begin, end = result.window
    assert begin < result.time < end <= press.period
    # The window is the lower half of the stroke, to within a node of 1440.
    half = height.min() + 0.5 * np.ptp(height)
    for edge in (begin, end):
        assert abs(level(edge, 0) - half) < np.abs(speed).max() * press.period / 1440


@pytest.mark.parametrize(
    ("angle", "place"), [(0.0, 0.75), (0.4, 0.75 - 0.4 / math.tau)]
)
@pytest.mark.parametrize("run_up", [0, 2])
def test_bar_is_lowest_at_three_quarters(angle, place, run_up):
    linkage = bar(angle, run_up=run_up)
    result = bottom_of(motion_of(linkage))
    assert result is not None
    back = 1.0 if place + 0.25 > 1.0 else 0.0
    assert result.time == pytest.approx((place - back) * linkage.period, abs=1e-13)
    assert result.height == pytest.approx(-0.2, abs=1e-15)
    assert result.first == int(back)
    late = result.delay(
        linkage.run_up_time + linkage.period * np.array([place, 7.0 + place, 0.9])
    )
    assert late[:2] == pytest.approx(0.0, abs=1e-13)
    assert late[2] == pytest.approx((0.9 - place) * linkage.period, abs=1e-13)


def test_what_stands_has_none():
    linkage = bar().changed(output=OutputPoint("bar", 0.5 * math.pi, x=-0.1))
    assert bottom_of(motion_of(linkage)) is None
