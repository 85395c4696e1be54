"""Process forces in runs: motion, torque, work and moments against closed forms, and balances."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from closed_form import Turning, needed_by_virtual_work, press_motion
from marks import slow
from scipy.optimize import brentq

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.linkage.process import Process
from presswear.linkage.servos import Servo
from presswear.physics.inverse_dynamics import needed_torques
from presswear.tools.arrays import Array

PRESS = pw.Press()
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


LOWEST = brentq(lambda time: slider(time)[0, 1], 0.04, 0.08, xtol=1e-15)
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
    stage: pw.results.StageResult,
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


@pytest.mark.parametrize(
    ("process", "engine"),
    [
        *((process, "dae") for process in PROCESSES),
        slow(PROCESSES[0], "exudyn-joints"),
        slow(PROCESSES[1], "exudyn-joints"),
        (PROCESSES[2], "exudyn-joints"),
    ],
    ids=lambda value: getattr(value, "kind", value),
)
def test_the_ideal_press_works_as_closed_forms_say(process: Process, engine):
    strokes = 2 if engine == "dae" else 1
    scene = replace(
        pw.scenes.ideal(),
        process=process,
        engine=engine,
        drive_torque="on",
        cycles=strokes,
    )
    stage = pw.run(scene).stages[0]
    exact = slider(stage.time)
    start = slider(np.zeros(1))[0, 0]
    assert np.abs(stage.displacement - (exact[:, 0] - start)).max() < LARGE
    check_work(stage, process, exact, BOTTOM, strokes=strokes)


@pytest.mark.parametrize(
    ("engine", "name"), [("exudyn-tree", "press_blanking"), ("dae", "press_drawing")]
)
def test_energies_balance_with_clearances_and_moments_have_rows(name, engine):
    scene: Any = replace(
        getattr(pw.scenes, name)(),
        engine=engine,
        wear_updates=0,
        replicates=1,
        cycles=1,
    )
    # A cushion would be held down at the end of a cycle.
    scene = replace(scene, process=replace(scene.process, cushion=0.0))
    result = pw.run(scene)
    stage = result.stages[0]
    strokes = result.strokes(0)
    assert strokes is not None
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    assert abs(float(stage.diagnostics["energy_residual_J"] or 0.0)) < 1e-6 * exchange
    # What is loose in its joints bounces on the work, which gives back what is elastic
    # in it.
    work = -float(stage.diagnostics["load_work_J"] or 0.0)
    assert work == pytest.approx(scene.process.work, abs=1e-6 * exchange)
    assert len(strokes.contact) == 1
    assert f"forces: {scene.process.kind}" in str(stage.diagnostics["model"])
    height = stage.displacement + slider(np.zeros(1))[0, 0] - BOTTOM
    for moment, place in [*strokes.contact, *strokes.fracture]:
        if not np.isnan(moment):
            row = int(np.abs(stage.time - moment).argmin())
            assert height[row] == pytest.approx(place, abs=2e-11)


def test_the_implicit_engine_goes_on_where_surfaces_wear():
    """What is freed at the end of a run is not freed when the surfaces change."""
    scene = replace(pw.scenes.clearance_a(), engine="exudyn-joints")
    plan = Plan(1e-4, 3, wear=lambda cycles, added, depth: np.zeros_like(added))
    assert (
        scene.solver.simulate(scene.linkage(), start_of(scene), plan).status
        == "completed"
    )


SERVOS: list[Servo] = [
    pw.linkage.Dwell(law="cycloidal"),
    pw.linkage.Forming(),
    pw.linkage.Pendulum(),
]


@pytest.mark.parametrize(
    ("servo", "process", "engine"),
    [
        pytest.param(
            *(servo, PROCESSES[2 * ((k + j) % 2)], engine),
            # The motion is the same in both; that of Forming runs always in both.
            marks=[pytest.mark.slow] if j and k != 1 else [],
        )
        for k, servo in enumerate(SERVOS)
        for j, engine in enumerate(ENGINES)
    ],
    ids=lambda value: getattr(value, "kind", value),
)
def test_the_ideal_press_with_a_servo_needs_torques_of_virtual_work(
    servo: Servo, process: Process, engine
):
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
    linkage = scene.linkage()
    exact = scene.ideal.at(stage.time).output(linkage)
    assert np.abs(stage.displacement - (exact[:, 0] - exact[0, 0])).max() < LARGE
    turning: Any = linkage.drives[1].motion(stage.time)
    torque, smooth = check_work(stage, process, exact, scene.bottom, turning)
    needed = needed_torques(linkage, scene.ideal, stage.time)
    assert np.abs(needed - torque)[smooth].max() < 1e-6 * np.abs(torque).max()
