"""The drawing of a mechanism."""

import math
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgba

from presswear.linkage.drives import Drive
from presswear.linkage.elements import Bar, Pin
from presswear.linkage.loads import AnyLoad, Force, Harmonics, Load, Moment, Spring
from presswear.linkage.mechanisms import FOUR_BAR
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import press_blanking, slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.figures.mechanism import labelled


def test_no_label_of_the_mechanism_hides_another() -> None:
    for scene in (wear_times(), press_blanking(), slider_crank(), Scene(FOUR_BAR)):
        drawing = labelled(scene)
        canvas: Any = FigureCanvasAgg(drawing.sheet)
        canvas.draw()
        renderer = canvas.get_renderer()
        (axes,) = drawing.sheet.axes
        names = {text.get_text().split("\n")[0] for text in axes.texts}
        assert {body.name for body in scene.mechanism.linkage().bodies} <= names
        boxes = [text.get_window_extent(renderer) for text in axes.texts]
        assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def test_the_mechanism_is_labelled_where_it_stands() -> None:
    """Every body and joint by its name, at its place; drives in their senses."""
    scene = changed(wear_times(), {"A.clearance": "0.25mm"})
    drawing = labelled(scene, 0.1)
    (axes,) = drawing.sheet.axes
    words = [text.get_text() for text in axes.texts]
    linkage = scene.linkage()
    for body in linkage.bodies:
        assert body.name in words
    assert {"B", "D", "E", "O2", "O7", "A\nc = 0.25 mm", "C\nc = 0.8 mm"} <= set(words)
    motion = scene.ideal.at(np.array([0.1]))
    for k in range(len(linkage.bodies)):
        centre = motion.position[0, 3 * k : 3 * k + 2]
        marks = [np.ravel(line.get_xydata()) for line in axes.lines if line.get_marker() == "+"]
        assert any(np.allclose(mark, centre, atol=1e-12) for mark in marks)
    assert words.count("11 rad/s") == 2


def test_a_run_up_leaves_the_paths_whole() -> None:
    """The joints' paths are those of a cycle at speed, wherever the mechanism is drawn."""
    slow, plain = (
        labelled(Scene(mechanism=FOUR_BAR.changed(run_up=run_up), joints="B")).sheet.axes[0]
        for run_up in (3, 0)
    )
    for one, other in zip(slow.lines[:4], plain.lines[:4], strict=True):
        lengths = [
            np.hypot(*np.diff(np.asarray(own.get_xydata()), axis=0).T).sum() for own in (one, other)
        ]
        assert lengths[0] == pytest.approx(lengths[1], rel=1e-9)


def test_pins_at_one_place_share_a_text_and_springs_are_drawn() -> None:
    """Two pins join three bars in one place; nothing is written over."""
    third = Bar("third", 0.1, 0.2)
    spring = Spring("coil", "third.tail", (0.3, 0.2), 100.0, 0.1)
    linkage = FOUR_BAR.changed(
        bodies=[*FOUR_BAR.bodies, third],
        joints=[*FOUR_BAR.joints, Pin("B2", "rocker.head", "third.head")],
        drives=[*FOUR_BAR.drives, Drive("third", harmonics=[(0.0, 0.1)], frequency=30.0)],
        springs=[spring],
    )
    scene = Scene(linkage, bearings={"B": Bearing(clearance=1e-4)})
    (axes,) = labelled(scene).sheet.axes
    words = [text.get_text() for text in axes.texts]
    assert "B, B2\nc of B = 0.1 mm" in words
    assert "coil" in words
    places = [text.get_position() for text in axes.texts if text.get_fontweight() == "bold"]
    gaps = [math.dist(*pair) for pair in combinations(places, 2)]
    assert len(places) == 4
    assert min(gaps) > 0.01
    coil = max(axes.lines, key=lambda line: np.asarray(line.get_xydata())[:, 0].max())
    assert np.asarray(coil.get_xydata())[-1] == pytest.approx((0.3, 0.2))


def test_loads_are_drawn_where_they_act() -> None:
    """A force as an arrow to its point, a moment as a bent one around the mass centre."""
    scene = Scene(mechanism=FOUR_BAR, joints="B")
    loads: list[AnyLoad] = [
        Force("rocker.head", 0.5, 3.0),
        Moment("crank", Harmonics(1.0)),
        Load("coupler", 2.0),
    ]
    loaded = replace(scene, mechanism=FOUR_BAR.changed(loads=loads))
    (axes,), (plain,) = (labelled(own).sheet.axes for own in (loaded, scene))
    assert len(axes.patches) == len(plain.patches) + 3
    red = [own for own in axes.patches if own.get_edgecolor() == to_rgba("tab:red")]
    position = scene.ideal.at(np.zeros(1)).position[0]
    angle = position[8]
    head = position[6:8] + 0.06 * np.array([math.cos(angle), math.sin(angle)])
    assert len(red) == 3
    for place in (head, position[3:5]):
        gaps = [np.abs(np.asarray(own.get_path().vertices) - place).max(axis=1) for own in red]
        # The head's corner is rounded; its tail is 40 mm away.
        assert min(float(gap.min()) for gap in gaps) < 2e-3
