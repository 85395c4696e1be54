"""Gears between two cranks: closed forms, results, and messages."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slotted import cylinder, geared_five_bar, loose_scene, with_wheel

import presswear as pw
from presswear.engines.base import Start
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive, GearedDrive
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.motor import Motor
from presswear.linkage.topology import branches_of
from presswear.physics.ideal import ideal_motion
from presswear.physics.inverse_dynamics import needed_torques
from presswear.results.drives import drives_of
from presswear.show.report import render_report
from presswear.tools.errors import InputError

FIRST = 0.3  # inertia of the first wheel, kg m^2
SECOND = 0.2  # inertia of the second wheel, kg m^2
RATIO = -2.0
REFLECTED = FIRST + RATIO**2 * SECOND  # inertia of both on the first wheel, kg m^2
NOMINAL = 20.0  # rad/s
MOTOR = Motor(20.0, slip=0.1, inertia=0.1)


def wheels(drive: Drive) -> Linkage:
    """Return two geared wheels whose mass centres are on their axes."""
    return assemble(
        bodies=[Body("first", 5.0, FIRST), Body("second", 4.0, SECOND)],
        joints=[Pin("A", (0.0, 0.0), "first"), Pin("B", (0.5, 0.0), "second")],
        drives=[drive, GearedDrive("second", leader="first", ratio=RATIO, angle=0.4)],
        output="first",
    )


UNEVEN = wheels(Drive("first", NOMINAL, harmonics=[(0.1, 0.3)]))


def uneven_acceleration(time: Any) -> Any:
    """Acceleration of the first wheel of UNEVEN at times, s, rad/s^2."""
    cosine = np.cos(NOMINAL * time)
    sine = np.sin(NOMINAL * time)
    return -(NOMINAL**2) * (0.1 * cosine + 0.3 * sine)


def test_torques_of_two_wheels():
    """The gears give I_2 n alpha, the drive (I_1 + n^2 I_2) alpha."""
    ideal = ideal_motion(UNEVEN, UNEVEN.period)
    time = np.linspace(0.0, UNEVEN.period, 37)
    motion = ideal.at(time)
    expected = 0.4 + RATIO * motion.position[:, 2]
    assert_allclose(motion.position[:, 5], expected, atol=1e-12)
    drive, gears = needed_torques(UNEVEN, ideal, time).T
    acceleration = uneven_acceleration(time)
    assert_allclose(gears, SECOND * RATIO * acceleration, atol=1e-10)
    assert_allclose(drive, REFLECTED * acceleration, atol=1e-10)


@pytest.mark.parametrize("engine", [InHouse(), ExudynJoints()], ids=lambda e: e.word)
def test_a_motor_speeds_up_both_wheels(engine: Engine):
    """w = w_0 (1 - exp(-t / T)), T = (I_1 + n^2 I_2) w_0 s_n / M_n."""
    motor = Motor(10.0, slip=0.1, breakdown=None)
    linkage = wheels(Drive("first", NOMINAL, motor=motor)).released
    start = Start(np.array([0.0, 0.0, 0.0, 0.5, 0.0, 0.4]), np.zeros(6))
    run = pw.simulate(linkage, start, 0.1, engine)
    constant = REFLECTED * NOMINAL * 0.1 / 10.0
    decay = math.exp(-run.time / constant)
    speed = run.end.velocity[2]
    assert speed == pytest.approx(NOMINAL * (1.0 - decay), rel=1e-9)
    assert run.end.velocity[5] == pytest.approx(RATIO * speed, rel=1e-12)
    acceleration = NOMINAL * decay / constant
    expected = [REFLECTED * acceleration, SECOND * RATIO * acceleration]
    assert_allclose(run.recorder.records.torque, expected, rtol=1e-7)
    work = 0.5 * REFLECTED * speed**2
    assert run.diagnostics["drive_work_J"] == pytest.approx(work, rel=1e-8)


def test_free_gears_are_no_tree():
    linkage = loose_scene(geared_five_bar(motor=MOTOR), joints="E").linkage()
    assert branches_of(linkage) == "gears couple driver and follower"


def test_gears_give_no_power(tmp_path):
    """The power of both cranks is that of the motor."""
    scene = loose_scene(
        geared_five_bar(motor=Motor(60.0, slip=0.1, inertia=0.5)),
        joints="E",
        engine="dae",
        cycles=2,
        replicates=1,
        drive_torque="on",
    )
    result = pw.run(scene, tmp_path / "result")
    drives = drives_of(scene, result.stages[0])
    assert drives["follower"].duty.power.rms == 0.0
    assert drives["follower"].ideal.power.rms == 0.0
    assert drives["follower"].duty.torque.rms > 0.0
    assert drives["driver"].duty.power.rms > 0.0
    assert render_report(result)


def test_a_ratio_of_a_half_repeats_after_two_turns():
    linkage = wheels(Drive("first", NOMINAL))
    gears = GearedDrive("second", leader="first", ratio=0.5)
    slow = linkage.changed(drives=[linkage.drives[0], gears])
    assert slow.period == pytest.approx(2.0 * linkage.period)


def test_gears_follow_a_changed_leader():
    faster = UNEVEN.changed(drives=[Drive("first", 30.0), UNEVEN.drives[1]])
    assert faster.drives[1].mean_speed == -60.0
    assert not faster.drives[1].repeats


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"leader": "frist"}, "unknown driven body in drive of second 'frist'.*first"),
        ({"leader": "second"}, "leader of second = second: must be another body"),
        ({"ratio": 0.0}, "ratio of second = 0: must not be 0"),
        ({"ratio": 1e4}, "ratio of second = 10000: allowed is -1000 to 1000"),
        ({"speed": 3.0}, "speed of second: a drive with a leader has none"),
        ({"motor": Motor(stiffness=1e5)}, "motor of second: a drive with a leader has"),
    ],
)
def test_wrong_gears_are_refused_by_name(changes, message):
    values: dict[str, Any] = {"body": "second", "leader": "first", "ratio": 2.0}
    with pytest.raises(InputError, match=message):
        UNEVEN.changed(drives=[UNEVEN.drives[0], GearedDrive(**values | changes)])


def test_a_cylinder_is_no_leader():
    linkage = cylinder()
    gears = GearedDrive("wheel", leader="piston", ratio=2.0)
    words = "drive of wheel: leader = piston: allowed is a"
    with pytest.raises(InputError, match=words):
        with_wheel(linkage, *linkage.drives, gears)
