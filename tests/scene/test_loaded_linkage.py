"""Linkage of a scene with its bearings, and its ideal motion."""

import math
from dataclasses import replace

import pytest

from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.normal_law import hertz_stiffness
from presswear.scene.catalog import wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

BASE = replace(wear_times(), name="base", title="a scene")


def test_scene_makes_the_linkage_it_describes():
    scene = changed(BASE, {"joints": "A", "friction": "0.05", "restitution": "0.8"})
    linkage = scene.linkage()
    closed = scene.mechanism.linkage()
    (joint,) = linkage.clearances
    assert joint.name == "A"
    assert linkage.revolutes == tuple(r for r in closed.revolutes if r.name != "A")
    (ideal,) = (r for r in closed.revolutes if r.name == "A")
    assert (joint.bearing, joint.pin) == (ideal.first, ideal.second)
    assert (joint.bearing.body, joint.pin.body) == ("rod 3", "crank 2")
    assert joint.pin_radius == 0.015 - 0.8e-3
    assert joint.normal.damping == pytest.approx(0.75 * 0.36, rel=1e-14)
    assert joint.friction.coefficient == 0.05
    assert (
        changed(BASE, {"wear_coefficient": "0/Pa"}).linkage().clearances[0].wear is None
    )


@pytest.mark.parametrize(
    ("conventions", "expected"),
    [
        ("paper", ("fixed", "radial", "angle", "bin")),
        ("refined", ("body", "foundation", "sliding", "arc")),
    ],
)
def test_conventions_reach_the_joint(conventions, expected):
    joint = replace(BASE, conventions=CONVENTIONS[conventions]).linkage().clearances[0]
    assert joint.wear is not None
    wear = joint.wear
    assert (
        joint.map_frame,
        joint.contact,
        wear.slip,
        wear.wear_distribution,
    ) == expected
    reading = CONVENTIONS[conventions].stiffness
    stiffness = hertz_stiffness(0.015, 0.0142, 2.0 * (1.0 - 0.3**2) / 200e9, reading)
    assert joint.normal.stiffness == pytest.approx(stiffness, rel=1e-14)


@pytest.mark.parametrize(
    ("degrees", "bottom"), [(0, 0.07), (-90, -0.17), (90, 0.07), (-30, -0.17)]
)
def test_bottom_dead_centre_of_a_slider_crank_is_its_lowest_place(degrees, bottom):
    """Rod less crank from O where the slider is beside O or above it, and rod and crank below."""
    scene = Scene(SliderCrank(slide_angle=math.radians(degrees)))
    assert scene.stroke == pytest.approx(0.1, rel=1e-9)
    assert scene.bottom == pytest.approx(bottom, rel=1e-9)
