"""The press with a servo in runs: slider and torques against closed forms, in two engines."""

import math

import numpy as np
import pytest
from closed_form import Turning, needed_by_virtual_work, press_motion, servo_turning
from scipy.interpolate import BPoly

import presswear as pw
from presswear.linkage.drives import Servo
from presswear.linkage.loads import Process
from presswear.physics.statics import needed_torques
from presswear.tools.arrays import Array

W = pw.Press().speed
TURN = 2.0 * math.pi
NEAR = 1e-8
"""Of a place, and of a step behind an event, m."""
SERVOS: list[Servo] = [pw.Dwell(law="cycloidal"), pw.Forming(), pw.Pendulum()]
PROCESSES: list[Process] = [pw.Blanking(cushion=30.0), pw.Coining(stiffness=2e5, height=1e-3)]


def dwelling(servo: pw.Dwell, phase: Array) -> Array:
    """Slider over bottom dead centre, which is at phase 0; shape (n, 3)."""
    half = math.pi * servo.part
    length = math.pi - half
    # Upwards and downwards are mirrored.
    away = np.abs((phase + math.pi) % TURN - math.pi)
    sign = np.where(phase % TURN < math.pi, 1.0, -1.0)
    x = np.clip((away - half) / length, 0.0, 1.0)
    rate = W / length
    return servo.stroke * np.column_stack(
        [
            x - np.sin(TURN * x) / TURN,
            sign * rate * (1.0 - np.cos(TURN * x)),
            rate**2 * TURN * np.sin(TURN * x),
        ]
    )


def forming(servo: pw.Forming, phase: Array) -> Array:
    """The same of a constant speed, and of the polynomials through what is prescribed."""
    stopping = 2.0 * servo.end / servo.speed
    slow = stopping + (servo.height - servo.end) / servo.speed
    top = [servo.stroke, 0.0, 0.0]
    curve = BPoly.from_derivatives(
        [-math.pi / W, -slow, -stopping, 0.0, math.pi / W],
        [top, [servo.height, -servo.speed, 0.0], [servo.end, -servo.speed, 0.0], [0.0] * 3, top],
    )
    time = ((phase + math.pi) % TURN - math.pi) / W
    return np.column_stack([curve(time), curve.derivative(1)(time), curve.derivative(2)(time)])


def moved(servo: Servo, time: Array) -> tuple[Array, Turning]:
    """Slider, shape (n, 3), and turning of crank 7 in closed form."""
    press = pw.Press()
    if isinstance(servo, pw.Pendulum):
        phase = W * time - servo.phase
        swing = servo.amplitude * np.array(
            [np.sin(phase), W * np.cos(phase), -W * W * np.sin(phase)]
        )
        turning = servo.middle + swing[0], swing[1], swing[2]
        return press_motion(press, time, None, turning).output(press.linkage()), turning
    phase = W * np.append(0.0, time) - servo.bottom
    slider = dwelling(servo, phase) if isinstance(servo, pw.Dwell) else forming(servo, phase)
    still = np.zeros(1)
    begun = press_motion(press, still, None, (still + servo.angle, still, still))
    slider[:, 0] += begun.output(press.linkage())[0, 0] - slider[0, 0]
    return slider[1:], servo_turning(press, time, slider[1:], servo.angle)


def force_on(process: Process, slider: Array, bottom: float) -> Array:
    """Upwards force of the work, N: of a sheet on the way in alone."""
    depth = process.height - (slider[:, 0] - bottom)
    if isinstance(process, pw.Coining):
        return process.stiffness * np.maximum(depth, 0.0)
    places, forces = np.array(process.curve).T
    held = process.cushion * np.clip(depth / places[1], 0.0, 1.0)
    return np.interp(depth, places, forces, 0.0, 0.0) * (slider[:, 1] < 0.0) + held


@pytest.mark.parametrize("engine", ["dae", "exudyn-joints"])
@pytest.mark.parametrize("process", PROCESSES, ids=lambda own: own.kind)
@pytest.mark.parametrize("servo", SERVOS, ids=lambda own: own.kind)
def test_the_ideal_press_with_a_servo_works_as_closed_forms_say(
    servo: Servo, process: Process, engine: str
) -> None:
    scene = pw.Scene(
        pw.Press(servo=servo),
        joints="none",
        wear_updates=0,
        cycles=1,
        engine=engine,
        drive_torque="on",
        process=process,
    )
    stage = pw.run(scene).stages[0]
    exact, turning = moved(servo, stage.time)
    begun = moved(servo, np.zeros(1))[0][0, 0]
    assert np.abs(stage.displacement - (exact[:, 0] - begun)).max() < NEAR
    fine, _ = moved(servo, np.linspace(0.0, TURN / W, 20001))
    bottom = float(fine[:, 0].min())
    assert scene.bottom == pytest.approx(bottom, abs=NEAR)
    force = force_on(process, exact, scene.bottom)
    torque = needed_by_virtual_work(pw.Press(), stage.time, force, turning)
    depth = process.height - (exact[:, 0] - scene.bottom)
    nodes = [place for place, _ in process.curve]
    # A step ends a little behind the node of a table, under the piece before it.
    inside = np.abs(np.subtract.outer(depth, nodes)).min(axis=1) > NEAR
    assert np.count_nonzero(~inside) <= 4 * len(nodes)
    off = np.abs(stage.arrays["drive_torque"] - torque)[inside]
    assert off.max() < 1e-6 * np.abs(torque).max()
    needed = needed_torques(scene.linkage(), scene.ideal, stage.time)
    assert np.abs(needed - torque)[inside].max() < 1e-6 * np.abs(torque).max()
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    work = -float(stage.diagnostics["load_work_J"] or 0.0)
    assert work == pytest.approx(process.work, abs=1e-6 * exchange)
    assert abs(float(stage.diagnostics["energy_residual_J"] or 0.0)) < 1e-6 * exchange
