"""Torques and forces of several drives under the work alone, by virtual work."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from presswear.linkage.drives import GearedDrive
from presswear.results.rigid_joints import static_torques
from presswear.scene.scene import Scene
from presswear.show.drive_numbers import STATIC, drive_numbers
from presswear.tools import numbers
from presswear.tools.arrays import Array

sys.path.append(str(Path(__file__).parents[1]))
from slotted import BARREL, BASE, BOOM, ROD, SPEED, STROKE, boom, table

STIFFNESS = 1e6  # of the stop, N/m
HEIGHT = 5e-3  # of the stop above bottom dead centre, m
STOP = pw.Coining(stiffness=STIFFNESS, height=HEIGHT)


def _stop_force(scene: Scene, height: Array) -> Array:
    """Return the force of the stop, N, at heights of the output, m."""
    return STIFFNESS * np.maximum(scene.bottom + HEIGHT - height, 0.0)


def test_force_of_a_cylinder_under_the_work():
    """F dx/dphi dphi/dL, with dphi/dL = L / (r d sin phi) by the law of cosines."""
    scene = Scene(boom(), joints="none", process=STOP, cycles=2)
    time = np.linspace(0.0, scene.mechanism.period, 721)
    length = BARREL + 0.15 + ROD + STROKE * np.sin(SPEED * time)
    cosine = (BOOM**2 + BASE**2 - length**2) / (2.0 * BOOM * BASE)
    sine = np.sqrt(1.0 - cosine**2)
    place = 0.8 * cosine - 0.1 * sine
    assert scene.bottom == pytest.approx(place.min(), abs=1e-8)
    slope = (0.8 * sine + 0.1 * cosine) * length / (BOOM * BASE * sine)
    expected = float((_stop_force(scene, place) * slope).max())
    assert static_torques(scene) == {"piston": pytest.approx(expected, rel=1e-5)}
    (force, _) = drive_numbers(scene, list(pw.run(scene).stages))
    assert force.name == "Peak drive force"
    assert dict(force.compared)[STATIC] == numbers.quantity_text(expected, "N")


def test_forces_of_two_cylinders_under_the_work():
    """Each moves the table along its own guide: its force is F cos of the angle to the work."""
    linkage = table().changed(output="table", direction=0.9)
    scene = Scene(linkage, joints="none", process=STOP)
    along = {"saddle": 0.2, "table": 0.3 + 1.9}
    time = np.linspace(0.0, scene.mechanism.period, 721)
    height = scene.ideal.at(time).output(linkage)[:, 0]
    force = float(_stop_force(scene, height).max())
    torques = static_torques(scene)
    for body, direction in along.items():
        expected = force * abs(math.cos(direction - 0.9))
        assert torques[body] == pytest.approx(expected, rel=1e-5)
    assert torques["arm"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("is_geared", [False, True])
def test_drives_of_a_two_point_press_share_the_work(is_geared):
    """Each drive does half of the work; the leader of gears does all of it."""
    linkage = pw.TwoPoint().linkage()
    first, second = linkage.drives
    if is_geared:
        gears = GearedDrive(
            second.body, leader=first.body, ratio=-1.0, angle=second.angle
        )
        linkage = linkage.changed(drives=[first, gears])
    scene = Scene(linkage, joints="none", process=STOP)
    time = np.linspace(0.0, scene.mechanism.period, 721)
    motion = scene.ideal.at(time)
    height, speed, _ = motion.output(linkage).T
    slope = speed / motion.velocity[:, 3 * linkage.index(first.body) + 2]
    work = float(np.abs(_stop_force(scene, height) * slope).max())
    torques = static_torques(scene)
    leading = work if is_geared else 0.5 * work
    assert torques[first.body] == pytest.approx(leading, rel=1e-6)
    # Two rods and a guide hold the slide more than once: the share of gears is not unique.
    allowed = 2e-4 if is_geared else 1e-6
    assert torques[second.body] == pytest.approx(0.5 * work, rel=allowed)


def test_no_torque_without_work():
    assert static_torques(Scene(boom(), joints="none")) == {}
