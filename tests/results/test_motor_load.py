"""Loads of motors: closed forms of a braked rotor, and stored series of a press."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from typing import Any

import numpy as np
import pytest
from upright_press import SHEET, UP, upright_press

import presswear as pw
from presswear.results.frame_load import frame_loads
from presswear.results.motor_load import (
    leader_speed,
    mean_period,
    motor_loads,
    saturated_servos,
)
from presswear.results.strokes import sampled_strokes
from presswear.show.key_numbers import key_numbers
from presswear.show.limits import limit_lines
from presswear.show.report import render_report
from presswear.show.stage_tables import stage_tables
from presswear.show.warnings import warnings
from presswear.sweeps.responses import available, request, responses_of
from presswear.tools.numbers import quantity_text

TURN = 2.0 * math.pi
FRAME = 0.5e9
WEIGHT = 9.81 * 1010.0
INERTIA = 24.0**2 * 0.25  # of rotor and flywheel at the crank, kg m^2


def press(
    inertia: float, on_frame: bool = False, torque: float = 20.0, **settings: Any
) -> pw.Result:
    """Run an upright slider-crank with a motor of 24 times a torque at a slip of 0.08."""
    frame = pw.Guide("frame", "crown", direction=UP, stiffness=FRAME, damping=0.05)
    motor = pw.Motor(torque, slip=0.08, ratio=24, inertia=inertia, **settings)
    linkage = upright_press(motor, frame if on_frame else None)
    return pw.run(
        pw.Scene(linkage, process=SHEET, cycles=4, drive_torque="on"), engine="dae"
    )


def verdict(result: pw.Result, name: str) -> str:
    """Return the verdict on a number beside its limit."""
    lines = limit_lines(result.scene, result.stages[0])
    return next(line.verdict.word for line in lines if line.number.name == name)


def drop_on_the_line(result: pw.Result) -> float:
    """Return the mean drop of the speed, from torques on the line of the motor.

    The speed is least where the force of the work vanishes, on a row.
    """
    stage = result.stages[0]
    drops = []
    omega = 1.0 - 0.08 / 480.0 * stage.arrays["drive_torque"][:, 0]
    for stroke in sampled_strokes(result.scene, stage):
        first = np.abs(stage.clock - stroke.contact).argmin()
        last = np.flatnonzero(stage.clock > stroke.done)[0]
        drops.append(1.0 - omega[first : last + 1].min() / omega[first])
    return float(np.mean(drops))


def test_loads_are_those_of_the_stored_series():
    result = press(0.25, breakdown=None)
    scene = result.scene
    stage = result.stages[0]
    (load,) = motor_loads(scene, stage).values()
    speed = leader_speed(scene, stage)
    # Of the last two of four cycles, from the series: T = 480 N m s / 0.08 on a line.
    rows = stage.time >= 2.0 - 1e-9
    clock = stage.clock[rows]
    torque = stage.arrays["drive_torque"][rows, 0]
    omega = TURN * (1.0 - 0.08 * torque / 480.0)
    length = clock[-1] - clock[0]
    assert speed.stroke_rate.mean == pytest.approx(2.0 / length, rel=1e-4)
    work = np.trapezoid(torque * omega, clock) / 2.0
    assert mean_period(result) == pytest.approx(length / 2.0, rel=1e-4)
    assert abs(mean_period(result) - 1.0) > 1e-3  # the nominal period
    assert load.work.mean == pytest.approx(work, rel=1e-3)
    loss = np.trapezoid(torque * (TURN - omega), clock) / 2.0
    assert load.slip_loss.mean == pytest.approx(loss, rel=1e-3)
    rms = math.sqrt(np.trapezoid(torque**2, clock) / length)
    assert load.rms_fraction.mean == pytest.approx(rms / 480.0, rel=1e-3)
    assert load.peak_fraction is None
    least = drop_on_the_line(result)
    assert speed.drop.mean == pytest.approx(least, rel=1e-7)
    assert speed.recovery is not None
    assert "slip loss per cycle" in f"{stage_tables(result)['motor']}"
    contacts = [stroke.contact for stroke in sampled_strokes(scene, stage)]
    assert speed.touch.mean * TURN == pytest.approx(
        np.interp(contacts, clock, omega).mean(), rel=1e-4
    )
    (flywheel,) = [
        number for number in key_numbers(result) if number.name == "Flywheel energy"
    ]
    given = 0.5 * INERTIA * TURN**2 * speed.touch.mean**2 * (1.0 - (1.0 - least) ** 2)
    assert (
        f"Its drop in the work gives {quantity_text(given, 'J')}." in flywheel.meaning
    )
    requested = request(scene, ["strokes_per_minute", "speed_drop", "slip_loss"])
    values = responses_of(result, requested)
    assert values["strokes_per_minute"].value == pytest.approx(120.0 / length, rel=1e-4)
    assert values["slip_loss"].value == load.slip_loss.mean
    assert "frame_stretch" not in available(scene)
    assert verdict(result, "Rms torque of the motor") == "within the limit"
    _, _, power_axes, _ = result.plot("drives")  # each with its working zone
    time, power = (np.asarray(one) for one in power_axes.lines[0].get_data())
    expected = np.interp(time, stage.time, stage.arrays["drive_torque"][:, 0])
    expected *= TURN * (1.0 - 0.08 * expected / 480.0)
    assert power == pytest.approx(expected, rel=1e-6, abs=1e-3)
    speed_axes, _, torque_axes, _ = result.plot("motor")
    torque = torque_axes.lines[0].get_ydata()
    expected = 60.0 * (1.0 - 0.08 * np.asarray(torque) / 480.0)
    assert speed_axes.lines[0].get_ydata() == pytest.approx(expected, rel=1e-6)
    (rated,) = set(np.asarray(torque_axes.lines[-1].get_ydata()).tolist())
    assert rated == 480.0
    (nominal,) = set(np.asarray(speed_axes.lines[-1].get_ydata()).tolist())
    assert nominal == pytest.approx(60.0)


def test_a_light_flywheel_is_slowed_too_much():
    result = press(0.01)
    (load,) = motor_loads(result.scene, result.stages[0]).values()
    peak = np.abs(result.stages[0].arrays["drive_torque"][:, 0]).max()
    assert load.peak_fraction.mean == pytest.approx(peak / (480.0 * 2.75), rel=1e-3)
    assert verdict(result, "Drop of the speed") == "above the limit"


@pytest.mark.parametrize(("inertia", "excessive"), [(0.0181, False), (0.0178, True)])
def test_a_drop_above_20_percent_is_warned_of(inertia, excessive):
    result = press(inertia, breakdown=None)
    drop = drop_on_the_line(result)
    assert drop == pytest.approx(0.201 if excessive else 0.199, abs=5e-4)
    warned = verdict(result, "Drop of the speed") == "above the limit"
    assert warned == excessive == (drop > 0.2)


@pytest.mark.parametrize(("torque", "overloaded"), [(0.84, False), (0.82, True)])
def test_a_torque_above_the_rated_one_is_warned_of(torque, overloaded):
    result = press(0.25, torque=torque, breakdown=None)
    stage = result.stages[0]
    rows = stage.time >= 2.0 - 1e-9
    # from the speeds, on the line of the motor
    square = ((1.0 - stage.nominal_rate[rows]) / 0.08) ** 2
    clock = stage.clock[rows]
    rms = math.sqrt(np.trapezoid(square, clock) / (clock[-1] - clock[0]))
    assert rms == pytest.approx(1.0, abs=0.03)
    warned = verdict(result, "Rms torque of the motor") == "above the limit"
    assert warned == overloaded == (rms > 1.0)


def test_the_work_stretches_the_frame_while_the_motor_slows():
    """The work lasts by the clock, which lags behind the nominal time."""
    result = press(0.02, on_frame=True)
    (load,) = frame_loads(result.scene, result.stages[0]).values()
    stretch = result.stages[0].arrays["stretch"][:, 0]
    assert load.force.mean == pytest.approx(FRAME * stretch.max() + WEIGHT, rel=1e-3)
    axes, zone = result.plot("frame")
    drawn = np.asarray(axes.lines[0].get_ydata())
    assert drawn.max() == pytest.approx(1e6 * stretch[stretch.size // 2 :].max())
    (scale,) = zone.child_axes
    ends = 1e-6 * np.array(zone.get_ylim())
    assert scale.get_ylim() == pytest.approx(1e-3 * (FRAME * ends + WEIGHT))
    # Without clearance the frame alone moves bottom dead centre.
    (axes,) = result.plot("bottom")
    drawn = np.asarray(axes.lines[0].get_ydata())
    lowest = [
        result.height(0)[(stage.time >= cycle + 0.25) & (stage.time < cycle + 0.75)]
        for stage in result.stages
        for cycle in range(4)
    ]
    expected = [1e6 * float(heights.min()) for heights in lowest]
    assert drawn == pytest.approx(expected, abs=1.0)
    page = " ".join(render_report(result).split())
    assert "bottom dead centre is the ideal one" not in page


@pytest.mark.parametrize(("limit", "saturates"), [(0.74, False), (0.72, True)])
def test_a_servo_that_saturates_is_warned_of(limit, saturates):
    """The weight of its crank needs 0.49 N m, and 0.73 N m at the start."""
    bodies = [pw.Bar("even", 0.1, 1.0, 0.5), pw.Bar("servo", 0.1, 1.0, 0.5)]
    joints = [
        pw.Pin("O", (0.0, 0.0), "even.tail"),
        pw.Pin("P", (1.0, 0.0), "servo.tail"),
    ]
    servo = pw.Motor(stiffness=1e3, damping=10.0)
    drives = [
        pw.Drive("even", TURN, motor=pw.Motor(0, inertia=1e3)),
        pw.Drive("servo", TURN, motor=servo, torque_limit=limit),
    ]
    result = pw.run(
        pw.Scene(pw.assemble(bodies, joints, drives), cycles=1, drive_torque="on"),
        engine="dae",
    )
    stage = result.stages[0]
    greatest = np.abs(stage.arrays["drive_torque"][:, 1]).max()
    # It starts without a lag, under its weight: the step response of a damped spring.
    inertia = 0.5 + 0.25 * 0.1**2
    ratio = 10.0 / (2.0 * math.sqrt(1e3 * inertia))
    overshoot = math.exp(-math.pi * ratio / math.sqrt(1.0 - ratio**2))
    peak = 9.81 * 0.05 * (1.0 + overshoot)
    assert greatest == pytest.approx(min(limit, peak), rel=0.01)
    found = saturated_servos(result.scene, stage)
    assert found == ({"servo": limit} if saturates else {})
    warned = any("reaches its torque_limit" in line for line in warnings(result))
    assert warned == saturates


def test_a_linkage_without_a_motor_has_no_load():
    scene = pw.Scene(pw.SliderCrank(), joints="none", cycles=1)
    result = pw.run(scene, engine="dae")
    assert motor_loads(result.scene, result.stages[0]) == {}
    assert leader_speed(result.scene, result.stages[0]) is None
    assert stage_tables(result)["motor"] is None
    assert "speed_drop" not in available(scene)
