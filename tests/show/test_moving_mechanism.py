"""Picture of the mechanism that a reader of the report moves over the cycle."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import json
import re
from dataclasses import replace

import made_up_result as made
import numpy as np
import pytest

import presswear as pw
from presswear.show.figures.style import Pen, ShownStage
from presswear.show.figures.window import sampled
from presswear.show.moving_mechanism import FRAMES, moving_mechanism
from presswear.show.replay.clip import NORMAL
from presswear.show.report import render_report
from presswear.tools.arrays import Array


@pytest.fixture(scope="module")
def result():
    return pw.run(pw.scenes.press_blanking(engine="dae", cycles=4, wear_updates=0))


def test_a_stroke_moves_in_less_than_100_kb(result):
    moving = moving_mechanism(result)
    assert len(moving.svg) + len(moving.frames) < 100_000
    assert moving.frame_count == FRAMES
    page = render_report(result)
    assert page.count('class="motion"') == 1
    assert "new clearance, much enlarged: A 800 µm, C 800 µm." in page


def test_positions_and_forces_are_those_of_the_film(result):
    """All distances between mass centres are drawn at one scale."""
    moving = moving_mechanism(result)
    frames = json.loads(moving.frames)
    film = result.stages[0].film
    numbers = np.array(frames["numbers"])
    assert frames["names"] == ["crank angle", "A", "C"]
    assert numbers[:, 0].min() >= 0
    assert numbers[:, 0].max() < 360
    period = result.scene.mechanism.period
    _, window = sampled(result, [ShownStage(result.stages[0], Pen("", "black"))])
    start = round(360.0 * window.start / period)
    angles = start + (numbers[:, 0] - start) % 360
    angles[-1] += 360.0  # a whole turn ends at the angle at which it begins
    phase = 360.0 * film.time / period
    bodies = np.array(frames["bodies"]).reshape(FRAMES, -1, 3)
    scales = []
    for angle, drawn, forces in zip(angles, bodies, numbers[:, 1:], strict=True):
        row = int(np.abs(phase - angle).argmin())
        near = slice(max(row - 1, 0), row + 2)  # the angle is rounded to a degree
        real = film.position[row].reshape(-1, 3)
        assert drawn[:, 2] == pytest.approx(np.degrees(real[:, 2]), abs=2.5)
        extent = np.ptp(drawn[:, :2], axis=0)
        scales.append(extent / np.ptp(real[:, :2], axis=0))
        recorded = film.joints[near, :2, NORMAL].round()
        assert (recorded == forces).all(axis=1).any()
    assert np.ptp(scales) < 0.05 * np.mean(scales)


def test_a_pin_lies_in_its_enlarged_clearance(result):
    moving = moving_mechanism(result)
    gaps = [
        float(radius) for radius in re.findall(r'r="([\d.]+)" fill="none"', moving.svg)
    ]
    joints = np.array(json.loads(moving.frames)["joints"]).reshape(FRAMES, 2, 4)
    distance = np.hypot(*joints[..., :2].T)
    assert len(gaps) == 2
    # Pins press by some per cent of the clearance into their bearings.
    for gap, farthest in zip(gaps, distance.max(axis=1), strict=True):
        assert 0.97 * gap < farthest < 1.15 * gap


def radii_of(path: str) -> Array:
    """Return the distances of the points of an SVG path from its origin."""
    points = [point.split() for point in path.split("L")]
    return np.asarray(np.hypot(*np.array(points, float).T))


def test_a_worn_bearing_is_drawn_with_its_groove_and_contains_the_pin():
    depth = np.maximum(1e-3 * np.cos(np.linspace(0.0, 2.0 * np.pi, 360)), 0.0)
    surfaces = {"C": (pw.linkage.Surface(depth), pw.linkage.Surface(0.2 * depth))}
    scene = pw.scenes.press_blanking(
        engine="dae", cycles=4, wear_updates=0, surfaces=surfaces, replicates=1
    )
    result = pw.run(scene)
    moving = moving_mechanism(result)
    worn = re.findall(
        r'<path d="M([^"]*)z"[^>]* class="outline" data-body="(\d)"', moving.svg
    )
    worn = worn[-2:]  # the outlines of joint A come first
    linkage = scene.linkage()
    (joint,) = (joint for joint in linkage.clearances if joint.name == "C")
    bodies = [linkage.index(end.body) for end in (joint.bearing, joint.pin)]
    assert [int(body) for _, body in worn] == bodies
    bearing = radii_of(worn[0][0])
    pin = radii_of(worn[1][0])
    # The groove of 1 mm, 0.2 mm at the pin, is enlarged like the clearance of 0.8 mm.
    (gap,) = re.findall(r'r="([\d.]+)" fill="none"', moving.svg)[1:]
    assert np.ptp(bearing) == pytest.approx(float(gap) / 0.8, abs=0.2)
    assert np.ptp(pin) == pytest.approx(0.2 * float(gap) / 0.8, abs=0.2)
    places = np.array(json.loads(moving.frames)["joints"]).reshape(FRAMES, 2, 4)
    farthest = np.hypot(*places[:, 1, :2].T).max()
    radius = 0.4 * 340.0 / 2.0  # largest radius of a drawn bearing
    assert farthest + pin.max() <= radius + 0.2


def test_without_a_film_nothing_moves():
    assert moving_mechanism(made.made_up(made.BOTH, 2)) is None
    failed = replace(made.made_up(made.BOTH, 1), stages=())
    assert moving_mechanism(failed) is None
