"""Warnings about numbers that machines hardly have."""

import math
import re
from dataclasses import replace

import pytest

import presswear as pw
from presswear.scene.catalog import SCENES, scene_named
from presswear.scene.plausible import doubts
from presswear.scene.settings import changed


@pytest.mark.parametrize("name", SCENES)
def test_scenes_of_the_catalog_are_plausible(name):
    lines = doubts(scene_named(name))
    if name == "two-point":  # its guide and its rods hold the angle of the slide
        assert "1 of the constraints of joints and drives repeats others" in lines.pop()
    assert lines == []


@pytest.mark.parametrize(
    ("body", "speed", "words"),
    [
        ({"mass": 50.0}, 30.0, ["the mass of rod, 50.0 kg"]),
        ({"mass": 0.5, "inertia": 2.0}, 30.0, ["the radius of gyration of rod"]),
        (
            {"mass": 0.5},
            -3e3,
            ["the speed of crank is 3\u202f000 rad/s (usual: up to 2\u202f000 rad/s)"],
        ),
        (
            {"mass": 0.5, "length": 50.0},
            30.0,
            ["the distance of the joints of rod is 50.0 m (usual: up to 10.0 m)"],
        ),
        ({"mass": 0.5}, 30.0, []),
    ],
)
def test_masses_inertias_and_speeds(body, speed, words):
    linkage = pw.assemble(
        bodies=[
            pw.Bar("crank", length=0.05, mass=0.025),
            pw.Bar("rod", **{"length": 0.06} | body),
            pw.Body("slider", mass=0.5),
        ],
        joints=[
            pw.Pin("O", (0, 0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
            pw.Pin("B", "rod.head", "slider"),
            pw.Guide("guide", "slider"),
        ],
        drives=[pw.Drive("crank", speed=speed)],
        guess={"rod": 0.0},
        output="slider",
    )
    scene = pw.Scene(linkage, bearings={"B": pw.Bearing()})
    assert [re.split(", divided by |;", text)[0] for text in doubts(scene)] == words


def test_clearances_and_process_forces():
    scene = changed(scene_named("press-blanking"), {"clearance": "1.6 mm"})
    assert [text.partition(" is ")[0] for text in doubts(scene)] == [
        "the clearance of joints A and C, divided by the radius of the bearing,"
    ]
    heavy = replace(scene_named("press-blanking"), process=pw.Blanking(force=250e3))
    assert "kg, under the process force of 250 kN is 6" in doubts(heavy)[0]


def test_no_stress_is_doubted_in_a_slide_on_a_cylinder():
    """The slide has a single joint, hence no length."""
    press = pw.assemble(
        bodies=[pw.Body("slide", mass=2500.0)],
        joints=[pw.Guide("guide", "slide", direction=math.pi / 2)],
        drives=[
            pw.LinearDrive(
                "slide",
                along="guide",
                position=0.08,
                frequency=0.75,
                harmonics=[(0.08, 0.0)],
            )
        ],
        output="slide",
    )
    sheet = pw.Blanking(force=1.5e6, height=6e-3, thickness=5e-3, rise=3e-4, snap=5e-4)
    assert doubts(pw.Scene(press, joints="none", process=sheet)) == []


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"clearance": "0.3 mm"}, "the clearance divided by the radius of the oiled"),
        ({"width": "60 mm"}, "the width divided by the diameter of the oiled bearing"),
        ({"width": "2 mm"}, "(usual: at least 0.125)"),
        ({"viscosity": "1e-4 Pa s"}, "the viscosity of joint B is"),
        # water, whose 1 mPa s was written as Pa s
        ({"viscosity": "1 Pa s"}, "is 1.00 Pa s (usual: up to 0.900 Pa s)"),
        ({}, ""),
    ],
)
def test_oil_for_which_no_film_is_known(values, words):
    oiled = {"clearance": "30 um", "viscosity": "0.1 Pa s", **values}
    lines = doubts(pw.scenes.slider_crank(**oiled))
    assert len(lines) == bool(words)
    assert all(words in line for line in lines)


def test_a_torque_limit_beside_a_motor_has_no_effect():
    motor = pw.Motor(2.0, inertia=0.01)
    alone = doubts(pw.Scene(pw.SliderCrank(torque_limit=5.0)))
    beside = doubts(pw.Scene(pw.SliderCrank(torque_limit=5.0, motor=motor)))
    assert not any("torque_limit" in line for line in alone)
    assert any("torque_limit = 5.00 N m has no effect" in line for line in beside)
