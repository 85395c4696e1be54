"""Process forces in runs: motion, torque, work and moments against closed forms, and balances."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from closed_form import Turning, needed_by_virtual_work, press_motion, servo_turning
from scipy.interpolate import BPoly
from scipy.optimize import brentq

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.linkage.drives import Servo
from presswear.linkage.loads import Process
from presswear.physics.statics import needed_torques
from presswear.results.press_analysis import Strokes
from presswear.tools.arrays import Array

PRESS = pw.Press()
PERIOD = PRESS.period
LINKAGE = PRESS.linkage()
PROCESSES: list[Process] = [
    pw.Blanking(cushion=30.0),
    pw.Drawing(),
    pw.Coining(stiffness=2e5, height=1e-3),
]
ENGINES = "dae", "exudyn-joints"
LARGE = 1e-8
"""Of a place and a step behind an event, m."""


def slider(time: Array) -> Array:
    """Place, velocity and acceleration of the slider in closed form, shape (n, 3)."""
    return press_motion(PRESS, np.atleast_1d(time)).output(LINKAGE)


def turning(begin: float, end: float) -> float:
    """Time between two others at which the slider stands still, s."""
    return float(brentq(lambda time: slider(time)[0, 1], begin, end, xtol=1e-15))


LOWEST = turning(0.04, 0.08)
BOTTOM = float(slider(np.array(LOWEST))[0, 0])


def force_on(process: Process, slider: Array, bottom: float) -> Array:
    """Upwards force of the work, N: of a sheet on the way in alone."""
    depth = process.height - (slider[:, 0] - bottom)
    if isinstance(process, pw.Coining):
        return process.stiffness * np.maximum(depth, 0.0)
    places, forces = np.array(process.curve).T
    held = process.cushion * np.clip(depth / places[1], 0.0, 1.0)
    return np.interp(depth, places, forces, 0.0, 0.0) * (slider[:, 1] < 0.0) + held


def check_work(
    stage: pw.StageResult,
    process: Process,
    exact: Array,
    bottom: float,
    turning: Turning | None = None,
    strokes: int = 1,
) -> tuple[Array, Array]:
    """Check torque, work and energy; returns the torque and the rows away from events."""
    force = force_on(process, exact, bottom)
    torque = needed_by_virtual_work(PRESS, stage.time, force, turning)
    nodes = [place for place, _ in process.curve]
    depth = process.height - (exact[:, 0] - bottom)
    # A step ends a little behind the node of a table, under the piece before it.
    smooth = np.abs(np.subtract.outer(depth, nodes)).min(axis=1) > LARGE
    assert np.count_nonzero(~smooth) <= 4 * len(nodes)
    off = np.abs(stage.arrays["drive_torque"] - torque)[smooth]
    assert off.max() < 1e-6 * np.abs(torque).max()
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    work = -float(stage.diagnostics["load_work_J"] or 0.0)
    assert work == pytest.approx(strokes * process.work, abs=1e-6 * exchange)
    assert abs(float(stage.diagnostics["energy_residual_J"] or 0.0)) < 1e-6 * exchange
    return torque, smooth


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("process", PROCESSES, ids=lambda own: own.kind)
def test_the_ideal_press_works_as_closed_forms_say(process: Process, engine: str) -> None:
    scene = replace(pw.scenes.ideal(), process=process, engine=engine, drive_torque="on", cycles=2)
    result = pw.run(scene)
    stage, strokes = result.stages[0], result.strokes(0)
    assert strokes is not None
    exact = slider(stage.time)
    start = slider(np.zeros(1))[0, 0]
    assert np.abs(stage.displacement - (exact[:, 0] - start)).max() < LARGE
    check_work(stage, process, exact, BOTTOM, strokes=2)
    check_moments(process, stage, strokes)


def check_moments(process: Process, stage: pw.StageResult, strokes: Strokes) -> None:
    """Moments of strokes as closed forms have them, and a row at each."""

    def passes(height: float, begin: float, end: float) -> float:
        def off(time: float) -> float:
            return float(slider(np.array(time))[0, 0]) - BOTTOM - height

        return float(brentq(off, begin, end, xtol=1e-15))

    top = turning(0.25, 0.45)
    down = passes(process.height, top - PERIOD, LOWEST)
    up = passes(process.height, LOWEST, top)
    # The run begins behind the contact of the work that is thicker.
    first = 0 if down > 0.0 else 1
    expected: dict[str, float] = {"contact": down, "separation": up}
    if process.fracture is not None:
        expected["fracture"] = passes(process.height - process.fracture, top - PERIOD, LOWEST)
    for name in ("contact", "fracture", "separation"):
        found = getattr(strokes, name)
        if name not in expected:
            assert np.isnan(found).all()
            continue
        times = [t for k in range(first, 4) if (t := expected[name] + k * PERIOD) < stage.time[-1]]
        assert found[: len(times), 0] == pytest.approx(times, abs=1e-7)
        assert np.isnan(found[len(times) :]).all()
        height = process.height - (process.fracture or 0.0) * (name == "fracture")
        assert found[: len(times), 1] == pytest.approx(height, abs=1e-12)
        # Nothing happens where a blank that was worked through is left.
        for moment in found[: len(times), 0] if name != "separation" else ():
            assert np.abs(stage.time - moment).min() < 1e-7


def test_work_of_an_elastic_load_needs_no_short_steps() -> None:
    """Loose on the sheet, the slider swings in some sixteen steps: its work stays the sheet's."""
    scene = pw.scenes.press_blanking(wear_updates=0, replicates=1, cycles=1, steps_per_contact=50)
    diagnostics = pw.run(scene, engine="exudyn-joints").stages[0].diagnostics
    assert scene.process is not None
    exchange = float(diagnostics["drive_exchange_J"] or 0.0)
    assert -float(diagnostics["load_work_J"] or 0.0) == pytest.approx(
        scene.process.work, abs=1e-7 * exchange
    )


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
@pytest.mark.parametrize("name", ["press_blanking", "press_drawing"])
def test_energies_balance_with_clearances_and_moments_have_rows(name: str, engine: str) -> None:
    scene: Any = replace(
        getattr(pw.scenes, name)(), engine=engine, wear_updates=0, replicates=1, cycles=2
    )
    # A cushion would be held down at the end of a cycle.
    scene = replace(scene, process=replace(scene.process, cushion=0.0))
    result = pw.run(scene)
    stage, strokes = result.stages[0], result.strokes(0)
    assert strokes is not None
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    assert abs(float(stage.diagnostics["energy_residual_J"] or 0.0)) < 1e-6 * exchange
    # What is loose in its joints bounces on the work, which gives back what is elastic in it.
    work = -float(stage.diagnostics["load_work_J"] or 0.0)
    assert work == pytest.approx(2.0 * scene.process.work, abs=1e-6 * exchange)
    assert len(strokes.contact) == 2
    assert f"forces: {scene.process.kind}" in str(stage.diagnostics["model"])
    height = stage.displacement + slider(np.zeros(1))[0, 0] - BOTTOM
    for moment, place in [*strokes.contact, *strokes.fracture]:
        if not np.isnan(moment):
            row = int(np.abs(stage.time - moment).argmin())
            assert height[row] == pytest.approx(place, abs=2e-11)


@pytest.mark.parametrize("engine", ENGINES)
def test_work_under_the_highest_place_is_worked_through_as_well(engine: str) -> None:
    """Of a slider-crank, whose slider is farthest where it starts: closed form of the moments."""
    crank = pw.SliderCrank(speed=30.0)
    sheet = pw.Blanking(height=3e-3, bottom="highest", cushion=20.0)
    scene = pw.Scene(crank, process=sheet, joints="none", wear_updates=0, cycles=2, engine=engine)
    result = pw.run(scene)
    stage, strokes = result.stages[0], result.strokes(0)
    assert strokes is not None
    work = -float(stage.diagnostics["load_work_J"] or 0.0)
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    assert work == pytest.approx(2.0 * sheet.work, abs=1e-6 * exchange)

    def angle(place: float) -> float:
        """Crank angle at which the slider is at a place, by the law of cosines, rad."""
        r, length = crank.crank_length, crank.rod_length
        return float(np.arccos((r * r + place * place - length**2) / (2.0 * r * place)))

    touched, broken = angle(0.167), angle(0.167 + sheet.fracture)
    turn = 2.0 * np.pi
    for found, expected in (
        (strokes.contact, [turn - touched, 2.0 * turn - touched]),
        (strokes.fracture, [turn - broken, 2.0 * turn - broken]),
        (strokes.separation, [turn + touched, np.nan]),
    ):
        times = np.array(expected) / crank.speed
        np.testing.assert_allclose(found[:, 0], times, atol=1e-7)


def test_the_implicit_engine_goes_on_where_surfaces_wear() -> None:
    """What is freed at the end of a run is not freed when the surfaces change."""
    scene = replace(pw.scenes.clearance_a(), engine="exudyn-joints")
    plan = Plan(1e-4, 3, wear=lambda cycles, added: np.zeros_like(added))
    assert scene.solver.simulate(scene.linkage(), start_of(scene), plan).status == "completed"


W = PRESS.speed
TURN = 2.0 * math.pi
SERVOS: list[Servo] = [pw.Dwell(law="cycloidal"), pw.Forming(), pw.Pendulum()]


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
    initial = press_motion(press, still, None, (still + servo.angle, still, still))
    slider[:, 0] += initial.output(press.linkage())[0, 0] - slider[0, 0]
    return slider[1:], servo_turning(press, time, slider[1:], servo.angle)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("process", [PROCESSES[0], PROCESSES[2]], ids=lambda own: own.kind)
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
    start = moved(servo, np.zeros(1))[0][0, 0]
    assert np.abs(stage.displacement - (exact[:, 0] - start)).max() < LARGE
    fine, _ = moved(servo, np.linspace(0.0, TURN / W, 20001))
    bottom = float(fine[:, 0].min())
    assert scene.bottom == pytest.approx(bottom, abs=LARGE)
    torque, smooth = check_work(stage, process, exact, scene.bottom, turning)
    needed = needed_torques(scene.linkage(), scene.ideal, stage.time)
    assert np.abs(needed - torque)[smooth].max() < 1e-6 * np.abs(torque).max()
