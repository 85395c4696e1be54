"""Drives along guides on moving bodies: closed forms, energy, all engines, and messages."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from closed_form import needed_power
from marks import slow
from numpy.testing import assert_allclose
from runs import compare_engines, run_scene
from slotted import (
    BARREL,
    BASE,
    BOOM,
    ROD,
    SPEED,
    STROKE,
    boom,
    boom_press,
    slider_crank_with_sleeve,
    table,
)

import presswear as pw
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.linkage import Linkage, linkage_from
from presswear.linkage.topology import prescribed_of
from presswear.physics.ideal import Motion, ideal_motion
from presswear.physics.inverse_dynamics import needed_torques
from presswear.results.export import table_of
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError, InputError

BEARING = Bearing(clearance=0.5e-3, friction=0.05, bearing_radius=0.02)
DURATION = 0.014  # s, with some touchdowns
FINE = ExudynJoints(steps_per_contact=320)
_scene = partial(Scene, bearings=BEARING, wear_updates=0)


def _motion_of(linkage: Linkage) -> tuple[Motion, Array]:
    """Return the ideal motion at instants of a cycle, and the torques of its drives."""
    ideal = ideal_motion(linkage, linkage.period)
    time = np.linspace(0.0, linkage.period, 97)
    return ideal.at(time), needed_torques(linkage, ideal, time)


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
    motion, _ = _motion_of(boom(is_reversed=is_reversed))
    levels = motion.position, motion.velocity, motion.acceleration
    for level, expected in zip(levels, _law_of_cosines(motion.time), strict=True):
        assert_allclose(level[:, 8], expected, atol=1e-11 * SPEED**2)


@pytest.mark.parametrize("is_reversed", [False, True])
@pytest.mark.parametrize("make", [boom, boom_press])
def test_force_has_the_power_of_the_motion(make: Callable[..., Linkage], is_reversed):
    """Force times speed of the piston is the power that the motion and the weights need."""
    linkage = make(is_reversed=is_reversed)
    motion, force = _motion_of(linkage)
    speed = STROKE * SPEED * np.cos(SPEED * motion.time)
    power = needed_power(linkage, motion)
    allowed = 1e-9 * np.abs(power).max()
    assert_allclose(force[:, 0] * speed, power, atol=allowed)


def test_force_of_a_light_cylinder():
    """By virtual work the force is (I_O phi'' + m g x_C) phi' / L'.

    The law of cosines gives phi' / L' = L / (r d sin phi).
    """
    linkage = boom()
    cylinder = linkage.bodies[:2]
    light = [replace(body, mass=1e-9, inertia=1e-12) for body in cylinder]
    linkage = linkage.changed(bodies=[*light, linkage.bodies[2]])
    motion, force = _motion_of(linkage)
    angle, _, angular_acceleration = _law_of_cosines(motion.time)
    length = np.sqrt(BOOM**2 + BASE**2 - 2.0 * BOOM * BASE * np.cos(angle))
    mass = 20.0
    centre = 0.3  # distance of the mass centre of the boom from its pivot, m
    inertia = 1.5 + mass * centre**2
    moment = inertia * angular_acceleration
    moment += mass * linkage.gravity * centre * np.cos(angle)
    expected = moment * length / (BOOM * BASE * np.sin(angle))
    assert_allclose(force[:, 0], expected, atol=1e-5)


def test_forces_of_a_table():
    """The force of a drive accelerates the saddle, 40 kg, or the table on it, 25 kg.

    Each of them moves relative to its support by the harmonics of ``slotted.table``.
    """
    whole = table()
    linkage = whole.changed(
        bodies=whole.bodies[:2], joints=whole.guides, drives=whole.drives[:2]
    )
    motion, force = _motion_of(linkage)
    phase = SPEED * motion.time
    sine, cosine, twice = np.sin(phase), np.cos(phase), np.sin(2.0 * phase)
    x_rate = -0.06 * SPEED**2 * sine
    y_rate = -(SPEED**2) * (0.01 * cosine + 0.02 * sine + 4.0 * 0.01 * twice)
    along_x = np.array([math.cos(0.2), math.sin(0.2)])
    # The saddle stands at 0.3 rad, and the upper guide at 1.9 rad on the saddle.
    angle = 0.3 + 1.9
    along_y = np.array([math.cos(angle), math.sin(angle)])
    weight = np.array([0.0, linkage.gravity])
    of_saddle = np.outer(x_rate, along_x) + weight
    of_table = of_saddle + np.outer(y_rate, along_y)
    assert_allclose(force[:, 1], 25.0 * of_table @ along_y, atol=1e-8)
    both = 40.0 * of_saddle + 25.0 * of_table
    assert_allclose(force[:, 0], both @ along_x, atol=1e-8)


@pytest.mark.parametrize(
    ("joints", "is_reversed"),
    [
        ("A, P", True),
        ("B", False),
        ("none", False),
        *(slow("C", is_reversed) for is_reversed in (False, True)),
    ],
)
def test_engines_agree_and_keep_the_energy(joints, is_reversed):
    """Joints with clearance free the cylinder, the link, or no body."""
    compare_engines(_scene(boom_press(is_reversed), joints=joints), DURATION, FINE)


def test_engines_agree_on_a_table():
    """A guide on a guide, without a closed loop, moves the pin of a driven arm."""
    compare_engines(_scene(table(), joints="E"), DURATION, FINE)


def test_a_sleeve_driven_along_a_rod_is_prescribed():
    """The rod carries no guide, but its motion and the drive give that of the sleeve."""
    linkage = slider_crank_with_sleeve()
    assert prescribed_of(linkage) == {body.name for body in linkage.bodies}
    ideal = ideal_motion(linkage, linkage.period)
    time = np.linspace(0.0, linkage.period, 13)
    position = ideal.at(time).position.reshape(13, -1, 3)
    distance = np.hypot(*(position[:, 1, :2] - position[:, 3, :2]).T)
    expected = np.abs(0.05 + 0.03 * np.sin(SPEED * time))
    assert_allclose(distance, expected, atol=1e-14)
    compare_engines(_scene(linkage, joints="E"), DURATION, FINE)


def test_cylinder_at_rest_is_a_strut():
    """A driven crank then turns the linkage; the strut keeps its length without work."""
    linkage = boom()
    strut = LinearDrive("piston", along="bore", position=0.15)
    wheel = Body("wheel", 5.0, 0.2)
    linkage = linkage.changed(
        bodies=[*linkage.bodies, wheel],
        joints=[*linkage.joints, pw.Pin("W", (2.0, 0.0), "wheel")],
        drives=[strut, Drive("wheel", SPEED)],
    )
    scene = _scene(linkage, joints="A")
    run = run_scene(scene, InHouse(integration_tolerance=1e-11), DURATION)
    assert abs(float(run.diagnostics["drive_work_J"])) < 1e-9
    barrel, piston, *others = linkage.bodies
    with pytest.raises(InputError, match=r"inertia of piston = 0 kg m\^2: must be"):
        linkage.changed(bodies=[barrel, replace(piston, inertia=0.0), *others])


def test_results_have_distance_and_force_of_the_cylinder(tmp_path):
    scene = _scene(boom_press(is_reversed=True), joints="B", cycles=2, replicates=1)
    scene = pw.changed(scene, {"drive_torque": "on", "engine": "dae"})
    result = pw.run(scene, tmp_path / "result")
    columns = table_of(result, 0)
    phase = SPEED * columns["time"]
    place = 0.15 + STROKE * np.sin(phase)
    assert_allclose(columns["barrel_distance"], place, atol=1e-12)
    speed = STROKE * SPEED * np.cos(phase)
    assert_allclose(columns["barrel_velocity"], speed, atol=1e-11)
    power = columns["barrel_drive_force"] * speed
    assert_allclose(columns["barrel_power"], power, rtol=1e-9, atol=1e-6)
    assert "Peak drive force" in result.report().read_text(encoding="utf-8")


def test_a_linear_drive_is_stored_and_read_back():
    linkage = boom_press()
    assert linkage_from(linkage.as_plain(), "mechanism") == linkage


def test_cylinder_out_of_reach_is_refused_with_its_place():
    linkage = boom()
    (drive,) = linkage.drives
    longer = linkage.changed(drives=[replace(drive, harmonics=[(0.0, 0.6)])])
    message = r"with piston at [0-9.]+ mm along bore joint . does not close"
    with pytest.raises(AssemblyError, match=message):
        ideal_motion(longer, longer.period)
