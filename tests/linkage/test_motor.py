"""Motors as data: their ranges, the leader, the ideal and the released linkage, files."""

import math
from dataclasses import replace
from typing import Any

import pytest

import presswear as pw
from presswear.linkage.linkage import Linkage, linkage_from

TURN = 2.0 * math.pi
SERVO = pw.Motor(stiffness=2e3, damping=10.0)
_PLATE: dict[str, Any] = {"torque": "20 N m", "inertia": "0.25 kg m^2"}
INDUCTION = pw.Motor(ratio=24, **_PLATE)


def two_cranks(first: pw.Motor | None, second: pw.Motor | None) -> Linkage:
    """Two cranks on the frame, each with a drive."""
    bodies = [pw.Bar("one", 0.1, 1.0, 0.5), pw.Bar("two", 0.1, 1.0, 0.5)]
    joints = [
        pw.Pin("O", (0.0, 0.0), "one.tail"),
        pw.Pin("P", (1.0, 0.0), "two.tail"),
    ]
    drives = [
        pw.Drive("one", TURN, motor=first),
        pw.Drive("two", TURN, motor=second),
    ]
    return pw.assemble(bodies, joints, drives)


def test_a_motor_has_the_values_of_its_plate():
    assert (INDUCTION.torque, INDUCTION.slip, INDUCTION.breakdown) == (20.0, 0.08, 2.75)
    slip = 0.08 * (2.75 + math.sqrt(2.75**2 - 1.0))
    assert INDUCTION.breakdown_slip == pytest.approx(slip, rel=1e-15)
    assert INDUCTION.reflected_inertia == 144.0
    line: dict[str, Any] = {"torque": 20.0, "breakdown": "none"}
    assert pw.Motor(**line).breakdown_slip is None
    assert not pw.Motor(0).has_slip


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"torque": 1e-4}, "torque = 0.0001 N m: allowed is 0.001 to 1e.07 N m, or 0"),
        ({"torque": -1.0}, "torque = -1 N m: allowed is 0 to 1e.07 N m"),
        ({"torque": 20.0, "slip": 0.0}, "slip = 0: allowed is 0.001 to 0.5"),
        ({"torque": 20.0, "breakdown": 1.0}, "breakdown = 1: allowed is 1.01 to 10"),
        ({"torque": 20.0, "inertia": -1.0}, "inertia = -1 kg m.2: allowed is 0 to"),
        ({"torque": 20.0, "stiffness": 1.0}, "torque and stiffness are given; one is"),
        ({"torque": 20.0, "damping": 1.0}, "damping = 1 N m s/rad: only a servo has"),
        ({}, "motor: no law is given; one is expected"),
    ],
)
def test_bad_motors_are_refused(arguments, message):
    with pytest.raises(pw.InputError, match=message):
        pw.Motor(**arguments)


def test_a_motor_with_a_slip_has_no_torque_limit():
    message = "torque_limit of crank = 5 N m: only a servo saturates"
    with pytest.raises(pw.InputError, match=message):
        pw.Drive("crank", 6.0, motor=pw.Motor(2.0), torque_limit=5.0)
    assert pw.Drive("crank", 6.0, motor=pw.Motor(stiffness=1e3), torque_limit=5.0)


def test_the_leader_is_the_first_motor_that_is_no_servo():
    for first, second, leader in (
        (None, None, None),
        (INDUCTION, SERVO, "one"),
        (SERVO, INDUCTION, "two"),
        (SERVO, SERVO, None),
        (INDUCTION, pw.Motor(0), "one"),
    ):
        found = two_cranks(first, second).leader
        assert (found.body if found else None) == leader


def test_released_and_ideal_linkages():
    linkage = two_cranks(INDUCTION, SERVO)
    released = linkage.released
    assert (len(linkage.prescribed_drives), len(linkage.motor_drives)) == (2, 0)
    assert (len(released.prescribed_drives), len(released.motor_drives)) == (0, 2)
    assert [body.inertia for body in released.bodies] == [144.5, 0.5]
    assert released.released == released
    ideal = released.ideal
    assert ideal.prescribed_drives == ideal.drives
    assert (ideal.leader, ideal.period) == (None, linkage.period)
    assert released.changed(gravity=1.0).motor_drives == released.drives
    even = two_cranks(None, None)
    assert even.released == even


def test_drives_that_do_not_fit_a_motor_are_refused():
    with pytest.raises(
        pw.InputError, match="drive of two: its motion follows the time"
    ):
        two_cranks(INDUCTION, None)
    message = "motor of two: a servo follows the angle of a motor, and one has none"
    with pytest.raises(pw.InputError, match=message):
        two_cranks(None, SERVO)
    with pytest.raises(pw.InputError, match="motor of crank: with harmonics a servo"):
        pw.Drive("crank", 1.0, harmonics=[(0.0, 0.1)], motor=INDUCTION)
    with pytest.raises(pw.InputError, match="speed of crank = 0 rad/s: a motor needs"):
        pw.Drive("crank", motor=INDUCTION)


def test_motors_are_stored_with_the_linkage():
    linkage = two_cranks(INDUCTION, SERVO)
    assert linkage_from(linkage.as_plain(), "file") == linkage
    drive: Any = {"body": "crank", "speed": "60 spm", "motor": {"torque": "20 N m"}}
    assert pw.Drive(**drive).motor == pw.Motor(20.0)


def law(time: float) -> float:
    return 1.0


def test_scenes_of_motors():
    """A servo may saturate, and user laws are found by their keys."""
    servo = pw.Motor(stiffness=1e3)
    beside = pw.Drive("two", TURN, motor=pw.Motor(0))
    linkage = two_cranks(INDUCTION, SERVO)
    limited = pw.Drive("one", TURN, torque_limit=1e-3, motor=servo)
    pw.Scene(linkage.changed(drives=[limited, beside])).check()
    fixed = [replace(limited, motor=None), replace(beside, motor=None)]
    with pytest.raises(pw.InputError, match="torque_limit of one"):
        pw.Scene(linkage.changed(drives=fixed)).check()
    scene = pw.Scene(two_cranks(pw.Motor(law=law), SERVO))
    assert list(scene.user_laws) == ["drives[0].motor.law"]
