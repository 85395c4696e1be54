"""Torque and power of drives, against the balance of energy and statics."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswear.campaign.campaign import run
from presswear.linkage.drives import Drive
from presswear.linkage.elements import Bar, Body, Pin
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.mechanisms import FOUR_BAR
from presswear.results.export import table_of, unit_of
from presswear.results.press_analysis import curves_of, drives_of
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.report import drive_table

PENDULUM = assemble(
    bodies=[Bar("crank", length=0.4, mass=2.0)],
    joints=[Pin("O", (0.0, 0.0), "crank.tail")],
    drives=[Drive("crank", speed=5.0, angle=0.3)],
    name="a bar that is turned",
)


def turned(linkage: Linkage, cycles: int, engine: str = "dae") -> Scene:
    """Return a scene without clearance that stores torques."""
    scene = Scene(linkage, joints="none", wear_updates=0, cycles=cycles, engine=engine)
    return changed(scene, {"drive_torque": "on"})


@pytest.mark.parametrize("run_up", [0, 1])
def test_a_bar_that_is_turned_bears_its_weight(run_up: int) -> None:
    """M = m g r cos a + J a'': closed form, run-up included."""
    scene = turned(replace(PENDULUM, run_up=run_up), cycles=3)
    stage = run(scene).stages[0]
    found = drives_of(scene, stage)["crank"]
    curve = curves_of(scene, stage.time, stage.arrays["drive_torque"])["crank"]
    motion = scene.ideal.at(stage.time)
    angle, speed, faster = (
        level[:, 2] for level in (motion.position, motion.velocity, motion.acceleration)
    )
    inertia = 2.0 * 0.4**2 / 3.0
    torque = 2.0 * 9.81 * 0.2 * np.cos(angle) + inertia * faster
    np.testing.assert_allclose(curve.torque, torque, atol=1e-6)
    np.testing.assert_allclose(curve.power, torque * speed, atol=1e-5)
    weight = 2.0 * 9.81 * 0.2
    # Over whole turns at constant speed the weight does no work.
    exact = 1e-6
    assert stage.each_cycle("drive_work") == pytest.approx(np.zeros(3), abs=exact)
    for duty in (found.duty, found.ideal):
        assert duty.torque.mean == pytest.approx(0.0, abs=exact)
        assert duty.torque.rms == pytest.approx(weight / math.sqrt(2.0), rel=exact)
        assert abs(duty.torque.peak) == pytest.approx(weight, rel=1e-4)
        assert abs(duty.power.peak) == pytest.approx(5.0 * weight, rel=1e-4)
        # Half a turn up, half a turn down.
        assert (duty.supplied, duty.returned) == pytest.approx((2.0 * weight,) * 2, rel=10 * exact)
        assert duty.share == (1.0, 1.0, 1.0)
    columns = table_of(run(scene), 0)
    np.testing.assert_array_equal(columns["crank_power"], curve.power)
    np.testing.assert_array_equal(columns["crank_angle"], angle)
    assert unit_of("crank_power") == "W"
    assert unit_of("my_crank_torque") == "N m"


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree", "exudyn-joints"])
def test_works_of_the_drives_add_up_to_the_ledger_for_any_number_of_rows(engine: str) -> None:
    duties = []
    for rows in (100, 3000):
        scene: Any = Scene(mechanism=FOUR_BAR, joints="B", wear_updates=0, cycles=1, engine=engine)
        scene = changed(scene, {"drive_torque": "on", "rows_per_cycle": str(rows)})
        stage = run(scene).stages[0]
        own = {name: found.duty for name, found in drives_of(scene, stage).items()}
        gross = sum(duty.supplied + duty.returned for duty in own.values())
        total = sum(duty.work for duty in own.values())
        assert total == pytest.approx(stage.diagnostics["drive_work_J"], abs=1e-6 * gross)
        duties.append(own)
    assert duties[0] == duties[1]


@pytest.mark.parametrize("engine", ["dae", "exudyn-joints"])
def test_an_uneven_drive_of_a_mere_inertia_has_the_duty_of_its_law(engine: str) -> None:
    """A wheel whose speed is w + a cos(w t): M = -J a w sin(w t), in closed form."""
    speed, part, inertia = 5.0, 2.0, 0.8
    wheel = assemble(
        bodies=[Body("wheel", mass=1.0, inertia=inertia)],
        joints=[Pin("O", (0.0, 0.0), "wheel.centre")],
        drives=[Drive("wheel", speed=speed, harmonics=[(0.0, part / speed)])],
        gravity=0.0,
    )
    scene = turned(wheel, cycles=2, engine=engine)
    duty = drives_of(scene, run(scene).stages[0])["wheel"].duty
    exact = 1e-6 if engine == "dae" else 1e-4  # equal steps of the trapezoidal rule
    assert duty.torque.rms == pytest.approx(inertia * part * speed / math.sqrt(2.0), rel=exact)
    # From the least speed to the greatest, and back.
    work = 0.5 * inertia * ((speed + part) ** 2 - (speed - part) ** 2)
    assert (duty.supplied, duty.returned) == pytest.approx((work, work), rel=exact)
    assert abs(duty.torque.peak) == pytest.approx(inertia * part * speed, rel=1e-4)


def test_a_run_that_ends_in_its_run_up_has_no_duties() -> None:
    """A stage that failed before its first cycle: nothing is whole, and nothing breaks."""
    scene = turned(replace(PENDULUM, run_up=2), cycles=1)
    result = run(scene)
    stage = result.stages[0]
    rows = {name: stage.arrays[name][:900] for name in ("time", "slider", "drive_torque")}
    assert rows["time"][-1] < scene.run_up
    rows |= {name: stage.arrays[name][:0] for name in ("cycles", "cycle_start")}
    cut = replace(stage, arrays={**stage.arrays, **rows})
    assert drives_of(scene, cut) == {}
    assert drive_table(replace(result, stages=(cut,))) is None
