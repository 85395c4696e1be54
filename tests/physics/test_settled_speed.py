"""Settled speed of a motor, from which a run starts, against closed forms."""

import math
from dataclasses import replace
from typing import Any

import pytest

import presswear as pw
from presswear.campaign.replicates import start_of

TURN = 2.0 * math.pi
RATED = 20.0  # torque, N m
SLIP = 0.08  # at the rated torque
RATIO = 24.0  # speed of the motor over that of the crank
LINE: dict[str, Any] = {"torque": RATED, "slip": SLIP, "breakdown": None}


def braked(moment: float, motor: pw.Motor, speed: float = TURN) -> pw.Scene:
    """A crank with a constant moment against its motion, N m."""
    crank = pw.Bar("crank", 0.1, 1.0, 0.5)
    brake = pw.Load("crank", moment=-math.copysign(moment, speed))
    linkage = pw.assemble(
        [crank],
        [pw.Pin("O", (0.0, 0.0), "crank.tail")],
        [pw.Drive("crank", speed, motor=motor)],
        "crank.head",
        direction=0.0,
        loads=[brake],
    )
    return pw.Scene(linkage, cycles=1)


def rate_of(scene: pw.Scene, speed: float = TURN) -> float:
    """Return the speed of the first body at the start over its nominal speed."""
    return float(start_of(scene).velocity[2]) / speed


@pytest.mark.parametrize(
    ("speed", "ratio", "moment"),
    [(TURN, 1.0, 200.0), (-TURN, 1.0, 200.0), (TURN, 1.1, 480.0)],
)
def test_a_line_motor_under_a_constant_moment(speed, ratio, moment):
    """``ratio`` is the speed without load; the weight of the crank does no work in a turn."""
    motor = pw.Motor(**LINE, ratio=RATIO, no_load_speed=ratio * RATIO * TURN)
    settled = ratio * (1.0 - SLIP * moment / (RATIO * RATED))
    rate = rate_of(braked(moment, motor, speed), speed)
    assert rate == pytest.approx(settled, abs=1e-12)


def test_an_induction_motor_under_a_constant_moment():
    """The slip of the start is below breakdown and satisfies Kloss's equation."""
    motor = pw.Motor(RATED, slip=SLIP, breakdown=2.75, ratio=RATIO)
    peak = motor.breakdown_slip or 0.0
    for moment in (100.0, 480.0, 1300.0):
        slip = 1.0 - rate_of(braked(moment, motor))
        torque = RATIO * RATED * 2.75 * 2.0 * slip * peak / (slip**2 + peak**2)
        assert torque == pytest.approx(moment, rel=1e-12)
        assert slip < peak
    assert 1.0 - rate_of(braked(480.0, motor)) == pytest.approx(SLIP, rel=1e-12)


def push(time: float) -> float:
    return 1.0


def test_free_cranks_user_laws_and_runs_from_rest_do_not_settle():
    for motor in (pw.Motor(0), pw.Motor(law=push)):
        assert rate_of(braked(1e5, motor)) == 1.0
    scene = braked(100.0, pw.Motor(**LINE, ratio=RATIO))
    at_rest = replace(scene, mechanism=replace(scene.mechanism, run_up=2))
    assert not start_of(at_rest).velocity.any()


def test_a_motor_that_is_too_weak_is_refused():
    for motor, greatest in (
        (pw.Motor(**LINE, ratio=RATIO), "6 kN m"),
        (pw.Motor(RATED, breakdown=2.75, ratio=RATIO), "1.32 kN m"),
    ):
        with pytest.raises(pw.InputError, match=f"20 N m: the ideal .* {greatest}"):
            braked(6001.0, motor).check()
        braked(1300.0, motor).check()
