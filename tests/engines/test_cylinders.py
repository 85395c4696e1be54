"""Drives along guides on moving bodies: closed forms and messages."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from runs import run_scene
from slotted import (
    BARREL,
    BASE,
    BOOM,
    ROD,
    SPEED,
    STROKE,
    boom,
    loose_scene,
    slider_crank_with_sleeve,
    with_wheel,
)

from presswear.engines.settings import InHouse
from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.topology import prescribed_of
from presswear.physics.ideal import ideal_motion
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError, InputError


def _law_of_cosines(time: Array) -> Array:
    """Return angle of the boom, rad, and two derivatives in time, shape (3, n).

    L^2 = r^2 + d^2 - 2 r d cos phi with the distance L of both pins of the cylinder.
    """
    phase = SPEED * time
    length = BARREL + 0.15 + ROD + STROKE * np.sin(phase)
    speed = STROKE * SPEED * np.cos(phase)
    acceleration = -STROKE * SPEED**2 * np.sin(phase)
    product = BOOM * BASE
    cosine = (BOOM**2 + BASE**2 - length**2) / (2.0 * product)
    angle = np.arccos(cosine)
    sine = np.sin(angle)
    rate = length * speed / (product * sine)
    numerator = speed**2 + length * acceleration - product * cosine * rate**2
    return np.array([angle, rate, numerator / (product * sine)])


@pytest.mark.parametrize("is_reversed", [False, True])
def test_boom_turns_by_the_law_of_cosines(is_reversed):
    linkage = boom(is_reversed=is_reversed)
    time = np.linspace(0.0, linkage.period, 97)
    motion = ideal_motion(linkage, linkage.period).at(time)
    levels = motion.position, motion.velocity, motion.acceleration
    for level, expected in zip(levels, _law_of_cosines(time), strict=True):
        assert_allclose(level[:, 8], expected, atol=1e-11 * SPEED**2)


def test_a_sleeve_driven_along_a_rod_is_prescribed():
    """The motion of the rod and the drive determine the motion of the sleeve."""
    linkage = slider_crank_with_sleeve()
    assert prescribed_of(linkage) == {body.name for body in linkage.bodies}
    ideal = ideal_motion(linkage, linkage.period)
    time = np.linspace(0.0, linkage.period, 13)
    position = ideal.at(time).position.reshape(13, -1, 3)
    distance = np.hypot(*(position[:, 1, :2] - position[:, 3, :2]).T)
    expected = np.abs(0.05 + 0.03 * np.sin(SPEED * time))
    assert_allclose(distance, expected, atol=1e-14)


def test_cylinder_at_rest_is_a_strut():
    """A driven crank then turns the linkage; the strut keeps its length without work."""
    strut = LinearDrive("piston", along="bore", position=0.15)
    linkage = with_wheel(boom(), strut, Drive("wheel", SPEED))
    scene = loose_scene(linkage, joints="A")
    run = run_scene(scene, InHouse(integration_tolerance=1e-11), 0.014)
    assert abs(float(run.diagnostics["drive_work_J"])) < 1e-9
    barrel, piston, *others = linkage.bodies
    with pytest.raises(InputError, match=r"inertia of piston = 0 kg m\^2: must be"):
        linkage.changed(bodies=[barrel, replace(piston, inertia=0.0), *others])


def test_cylinder_out_of_reach_is_refused_with_its_place():
    linkage = boom()
    (drive,) = linkage.drives
    longer = linkage.changed(drives=[replace(drive, harmonics=[(0.0, 0.6)])])
    message = r"with piston at [0-9.]+ mm along bore joint . does not close"
    with pytest.raises(AssemblyError, match=message):
        ideal_motion(longer, longer.period)
