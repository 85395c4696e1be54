"""Drawings of a mechanism: names of joints and bodies, springs and loads."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from made_up_result import made_up
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba

import presswear as pw
from presswear.scene.catalog import press_blanking, wear_times
from presswear.scene.settings import changed
from presswear.show.figures import drawings
from presswear.show.figures.mechanism import labelled


def words_of(axes: Axes) -> set[str]:
    return {text.get_text() for text in axes.texts}


CRANK = pw.SliderCrank(0.03, 0.45, slide_angle=-0.5 * math.pi)
LABELLED = [wear_times(), press_blanking(), pw.Scene(FOUR_BAR)]
LABELLED += [pw.Scene(CRANK, joints="AB"), pw.Scene(pw.SixBar(), joints="B")]


@pytest.mark.parametrize("scene", LABELLED)
def test_joints_and_bodies_of_a_mechanism_are_named_inside_the_axes(scene):
    (axes,) = (sheet := labelled(scene).sheet).axes
    sheet.draw_without_rendering()
    linkage = scene.mechanism.linkage()
    joints = {
        name for text in words_of(axes) for name in text.split("\n")[0].split(", ")
    }
    assert {joint.name for joint in linkage.revolutes} == joints
    (legend,) = sheet.legends
    bodies = [text.get_text().partition(",")[0] for text in legend.get_texts()]
    assert bodies == [body.name for body in linkage.bodies]
    outer = axes.get_window_extent()
    for box in (text.get_window_extent() for text in axes.texts):
        assert outer.x0 - 1.0 <= box.x0
        assert box.x1 <= outer.x1 + 1.0


def test_a_mechanism_is_labelled_at_its_position():
    scene = changed(wear_times(), {"A.clearance": "0.25mm"})
    (axes,) = (drawing := labelled(scene, 0.1)).sheet.axes
    assert "closed, 100 ms after the start; one" in drawing.caption
    assert "closed, at the start; one" in labelled(scene).caption
    joints = {"B", "D", "E", "O2", "O7", "A\nc = 0.25 mm", "C\nc = 0.8 mm"}
    assert joints == words_of(axes)
    (legend,) = drawing.sheet.legends
    assert legend.get_texts()[0].get_text() == "crank 2, 105 rpm"
    position = scene.ideal.at(np.array([0.1])).position[0].reshape(-1, 3)[:, :2]
    marks = [
        np.ravel(line.get_xydata()) for line in axes.lines if line.get_marker() == "+"
    ]
    np.testing.assert_allclose(marks, position, atol=1e-12)


def test_joints_at_one_place_share_a_label_and_springs_are_drawn():
    spring = pw.Spring("coil", "third.tail", (0.3, 0.2), 100.0, 0.1)
    linkage = FOUR_BAR.changed(
        bodies=[*FOUR_BAR.bodies, pw.Bar("third", 0.1, 0.2)],
        joints=[*FOUR_BAR.joints, pw.Pin("B2", "rocker.head", "third.head")],
        drives=[
            *FOUR_BAR.drives,
            pw.Drive("third", harmonics=[(0.0, 0.1)], frequency=30.0),
        ],
        springs=[spring],
    )
    (axes,) = labelled(
        pw.Scene(linkage, bearings={"B": pw.Bearing(clearance=1e-4)})
    ).sheet.axes
    assert {"B, B2\nc of B = 0.1 mm", "coil"} <= words_of(axes)
    coil = max(axes.lines, key=lambda line: np.asarray(line.get_xydata())[:, 0].max())
    assert np.asarray(coil.get_xydata())[-1] == pytest.approx((0.3, 0.2))


def test_loads_are_drawn_at_their_points():
    scene = pw.Scene(mechanism=FOUR_BAR, joints="B")
    loads: list[Any] = [pw.Force("rocker.head", 0.5, 3.0), pw.Load("coupler", 2.0)]
    loads.append(pw.Moment("crank", pw.Harmonics(1.0)))
    (axes,) = labelled(
        replace(scene, mechanism=FOUR_BAR.changed(loads=loads))
    ).sheet.axes
    red = [
        patch for patch in axes.patches if patch.get_edgecolor() == to_rgba("tab:red")
    ]
    assert len(red) == 3
    position = scene.ideal.at(np.zeros(1)).position[0]
    head = position[6:8] + 0.06 * np.array(
        [math.cos(position[8]), math.sin(position[8])]
    )
    for place in (head, position[3:5]):
        gaps = [
            np.abs(np.asarray(p.get_path().vertices) - place).max(axis=1) for p in red
        ]
        # The head of an arrow is rounded; its tail is 40 mm away.
        assert min(float(gap.min()) for gap in gaps) < 2e-3


def test_names_are_no_formulas():
    """A joint, body or spring named $x^$ ended in an error of mathtext, after the run."""
    body = "$^2$"
    joint = "$x^$"
    bar = pw.Bar(body, 0.05, 0.3)
    bodies = [bar, *(b for b in FOUR_BAR.bodies if b.name != "crank")]
    pins = [
        pw.Pin("O", (0.0, 0.0), f"{body}.tail"),
        pw.Pin(joint, f"{body}.head", "coupler.tail"),
        pw.Pin("B", "coupler.head", "rocker.head"),
        pw.Pin("P", (0.18, 0.0), "rocker.tail"),
    ]
    spring = pw.Spring("$_$", "rocker.head", (0.18, 0.3), stiffness=100.0, length=0.1)
    drives = [pw.Drive(body, 30.0)]
    named: dict[str, Any] = {"name": "$^$", "springs": [spring]}
    linkage = pw.assemble(bodies, pins, drives, body, FOUR_BAR.guess, **named)
    scene = pw.Scene(
        linkage, "$a^$", "$b^$", pw.Bearing(), joints=f"{joint},B", wear_updates=1
    )
    for drawing in drawings(made_up(scene, 2)):
        drawing.sheet.draw_without_rendering()


def test_a_slide_on_a_cylinder_alone_has_a_report(tmp_path):
    """It has no pin to name or to enclose in a picture."""
    press = pw.assemble(
        bodies=[pw.Body("slide", mass=300.0)],
        joints=[pw.Guide("guide", "slide", direction=0.5 * math.pi)],
        drives=[
            pw.LinearDrive(
                "slide",
                along="guide",
                frequency=0.5,
                harmonics=[(0.0, 0.06)],
            )
        ],
    )
    scene = pw.Scene(press, joints="none", cycles=2)
    page = pw.run(scene, tmp_path / "run").report()
    assert "The mechanism in motion" in page.read_text()


def test_labels_of_a_yoke_cover_neither_its_guide_nor_each_other():
    """Crank pin, block and yoke lie on the line y = 0 of the guide of the yoke."""
    yoke = pw.assemble(
        bodies=[
            pw.Bar("crank", 0.01, 1.0),
            pw.Body("block", 0.05, 1e-4),
            pw.Body("yoke", 1.0),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "block"),
            pw.Guide("ways", "yoke"),
            pw.Guide("slot", "block", direction=0.5 * math.pi, on="yoke"),
        ],
        drives=[pw.Drive("crank", 10.0)],
        output="yoke",
        name="yoke",
    )
    scene = pw.Scene(yoke, bearings={"A": pw.Bearing(clearance=0.2e-3)})
    (axes,) = (sheet := labelled(scene).sheet).axes
    sheet.draw_without_rendering()
    boxes = [text.get_window_extent() for text in axes.texts if text.get_text()]
    line = axes.transData.transform((0.0, 0.0))[1]
    assert len(boxes) == 2
    assert not any(box.y0 < line < box.y1 for box in boxes)
    assert not boxes[0].overlaps(boxes[1])
