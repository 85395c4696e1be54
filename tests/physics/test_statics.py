"""Linkages at rest under a load: total clearance, deflection, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from closed_form import press_motion
from marks import slow
from upright_press import upright_crank

import presswear as pw
from presswear.engines.base import Plan, Start
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.press import GEOMETRIES
from presswear.physics.dead_centre import bottom_of
from presswear.physics.statics import (
    LEAST_PULL,
    equilibrium,
    heights_at_bottom,
    least_pull,
    pull_of,
    total_clearance,
)
from presswear.scene.conventions import CONVENTIONS
from presswear.tools.arrays import Array
from presswear.validation.cases import finished

LIGHT = pw.Scene(
    pw.SliderCrank(slide_angle=0.0, gravity=0.0),
    bearings=pw.Bearing(clearance=0.8e-3),
    conventions=CONVENTIONS["paper"],
    joints="AB",
    wear_updates=0,
)


def play(joint: ClearanceJoint, force: float, worn: float = 0.0) -> float:
    """How far a pin is out of the middle under a force: its clearance and what the law gives."""
    law = joint.normal
    return joint.clearance + worn + (abs(force) / law.stiffness) ** (1.0 / law.exponent)


@pytest.mark.parametrize(
    ("geometry", "force"),
    [*zip(GEOMETRIES, (20.0, 1000.0, -1000.0), strict=True), ("standard", -1000.0)],
)
def test_press_stands_as_one_with_longer_and_shorter_rods(geometry, force):
    """Pins go to the end of their clearance along rods 3 and 5, which bear two forces each.

    A rod that is pulled is longer by its play, one that is pressed shorter; the forces
    in them are the pull times the change of height with their lengths (virtual work).
    """
    press = pw.Press(geometry=GEOMETRIES[geometry], gravity=0.0)
    scene = replace(pw.scenes.wear_times(), mechanism=press)
    linkage = scene.linkage()
    bottom = bottom_of(scene.ideal)
    assert bottom is not None
    time = np.array([bottom.time])

    def height(longer: Array) -> float:
        rods = press.length_3 + longer[0], press.length_5 + longer[1]
        item = replace(press, length_3=rods[0], length_5=rods[1])
        return float(press_motion(item, time).output(linkage)[0, 0])

    longer = np.zeros(2)
    ways = 1e-6 * np.eye(2)
    for _ in range(20):
        rises = np.array([height(longer + way) - height(longer - way) for way in ways])
        bears = force * rises / 2e-6
        plays = [play(*item) for item in zip(linkage.clearances, bears, strict=True)]
        longer = np.copysign(plays, bears)
    result = equilibrium(linkage, press.period + bottom.time, force)
    assert result.height == pytest.approx(height(longer), abs=1e-12)
    assert result.contacts["normal"] == pytest.approx(np.abs(bears), rel=1e-6)
    assert heights_at_bottom(linkage, [force])[0] == pytest.approx(
        result.height, abs=1e-15
    )


@pytest.mark.parametrize("conventions", ["paper", "refined"])
def test_evenly_worn_surfaces_are_a_larger_clearance(conventions):
    """Closed form of a radial contact; a foundation bears what the law of the round joint does.

    It does so to some part of the penetration over the clearance.
    """
    scene = replace(
        LIGHT, conventions=pw.scenes.wear_times(conventions=conventions).conventions
    )
    worn = {
        "A": (np.full(360, 3e-5), None),
        "B": (np.full(360, 1e-5), np.full(360, 2e-5)),
    }
    linkage = replace(scene, surfaces=worn).linkage()
    force = 50.0
    expected = 2.0 * sum(play(joint, force, 3e-5) for joint in linkage.clearances)
    springs = expected - 2.0 * sum(
        joint.clearance + 3e-5 for joint in linkage.clearances
    )
    allowed = 1e-14 if conventions == "paper" else 0.03 * springs
    result = pw.statics.total_clearance(linkage, force)
    assert result == pytest.approx(expected, abs=allowed)
    assert result > pw.statics.total_clearance(scene.linkage(), force) + 1.1e-4


def held(force: float) -> Linkage:
    """A slider-crank whose crank stands, loaded at the slider."""
    crank = pw.SliderCrank(slide_angle=0.0).linkage()
    drive = replace(crank.drives[0], speed=0.0, angle=2.0)
    load = pw.Load("slider", x=force)
    return crank.changed(drives=[drive], loads=[load], guess={"rod": -0.4}, cycle=0.005)


@pytest.mark.parametrize(
    ("conventions", "force"), [slow("paper", 50.0), ("refined", -50.0)]
)
def test_engine_that_starts_at_rest_stays_there(conventions, force):
    """On uneven surfaces, with weight, over some periods of the contacts."""
    angle = np.radians(np.arange(360) + 0.5)
    worn = 2e-5 * (1.0 + np.cos(angle - 0.3)), 1e-5 * (1.0 + np.sin(2.0 * angle))
    bearing = pw.Bearing(clearance=1e-4, friction=0.0)
    scene = pw.Scene(
        held(force),
        bearings={"A": bearing, "B": bearing},
        surfaces={"A": worn, "B": worn[::-1]},
        conventions=pw.scenes.wear_times(conventions=conventions).conventions,
        engine="dae",
        purpose="trajectory",
        wear_updates=0,
    )
    linkage = scene.linkage()
    result = equilibrium(linkage, 0.0)
    start = Start(result.position, np.zeros(9))
    run = finished(
        scene.solver.for_cycle(0.005).simulate(linkage, start, Plan(0.005, 1))
    )
    assert np.abs(run.end.velocity).max() < 1e-8
    assert np.abs(run.recorder.series("velocity")).max() < 1e-8
    np.testing.assert_allclose(result.position, run.end.position, rtol=0.0, atol=1e-11)
    # The load is as good as a pull at the slider.
    pulled = equilibrium(replace(linkage, loads=()), 0.0, force)
    np.testing.assert_allclose(pulled.position, result.position, rtol=0.0, atol=1e-12)


def test_weight_acts_and_loads_with_a_law_do_not():
    linkage = pw.scenes.wear_times().linkage()
    hanging = heights_at_bottom(linkage, [0.0])[0]
    down, up = heights_at_bottom(linkage, [-100.0, 100.0])
    assert down < hanging < up
    assert hanging - down < 1e-4 < up - hanging
    assert pw.statics.deflection(linkage, 100.0) == up - hanging
    assert pw.statics.deflection(linkage, 100.0, idle=-100.0) == up - down
    assert (
        pw.statics.total_clearance(linkage)
        == pw.statics.total_clearance(linkage, LEAST_PULL)
        == up - down
    )
    law = pw.OverTime([(0.0, -500.0), (0.1, -500.0)])
    pressed = linkage.changed(
        loads=[pw.Force("slider 6.centre", direction=1.57, law=law)]
    )
    assert heights_at_bottom(pressed, [0.0])[0] == hanging
    heavy = linkage.changed(
        bodies=[replace(body, mass=1e3 * body.mass) for body in linkage.bodies]
    )
    assert pull_of(linkage) == LEAST_PULL
    assert pull_of(heavy) == pytest.approx(
        1e4 * 9.81 * sum(item.mass for item in linkage.bodies)
    )


def test_no_clearance_is_no_deflection_and_bad_forces_are_refused():
    ideal = pw.Press().linkage()
    linkage = LIGHT.linkage()
    assert (
        pw.statics.total_clearance(ideal) == pw.statics.deflection(ideal, 500.0) == 0.0
    )
    for force in (0.0, -1.0, 1e12, math.nan):
        with pytest.raises(
            pw.InputError, match=r"force = .* allowed is above 0 up to 1e\+09 N"
        ):
            pw.statics.total_clearance(linkage, force)
    with pytest.raises(pw.InputError, match="idle = inf"):
        pw.statics.deflection(linkage, 1.0, math.inf)
    with pytest.raises(pw.InputError, match="no bottom dead centre: its output point"):
        pw.statics.total_clearance(replace(held(1.0), loads=()))


def test_a_pull_must_lift_the_weight_off_the_joints():
    """At bottom dead centre B carries the slider, and A slider and rod."""
    mechanism = pw.SliderCrank(
        slide_angle=-0.5 * math.pi, slider_mass=100.0, rod_mass=2.0
    )
    linkage = pw.Scene(mechanism, joints="AB", wear_updates=0).linkage()
    weight = 102.0 * 9.81
    assert least_pull(linkage) == pytest.approx(weight, rel=1e-9)
    message = r"force = 1\.00062 kN: allowed is above 1\.00062 kN, the weight that the joints carry"
    with pytest.raises(pw.InputError, match=message):
        pw.statics.total_clearance(linkage, weight - 1e-3)
    plays = 2.0 * sum(joint.clearance for joint in linkage.clearances)
    assert pw.statics.total_clearance(linkage, weight + 1.0) > plays
    assert pw.statics.total_clearance(linkage) > plays


def test_oil_is_squeezed_out_at_rest():
    oil = {"viscosity": "0.1 Pa s", "film": "run"}
    dry, oiled = (
        total_clearance(
            pw.scenes.slider_crank(clearance="30 um", joints="B", **values).linkage()
        )
        for values in ({}, oil)
    )
    assert oiled == dry > 6e-5


def test_a_pin_rests_where_its_groove_lies_beside_the_pull():
    """The offset across the pull begins at zero; a stable linkage rises with each pull."""
    angle = np.radians(np.arange(360) + 0.5)
    above, below = (
        1e-4 * np.exp(-8.0 * (1.0 - np.cos(angle - math.radians(place))))
        for place in (97.0, 262.0)
    )
    groove = above + below
    bearing = pw.Bearing(clearance=1e-4, bearing_radius=0.1, width=0.2)
    scene = pw.Scene(
        upright_crank(slide_angle=-0.5 * math.pi),
        bearings={"A": bearing, "B": bearing},
        surfaces={"A": (groove, 0.2 * groove), "B": (groove, 0.2 * groove)},
        wear_updates=0,
    )
    pulls = np.linspace(-1e6, 1e6, 21)
    heights = heights_at_bottom(scene.linkage(), list(map(float, pulls)))
    assert (np.diff(heights) > 0.0).all()
