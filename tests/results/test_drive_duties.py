"""Torques, powers and works of drives in closed form."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from numpy.testing import assert_allclose, assert_array_equal

import presswear as pw
from presswear.results.drives import curves_of, drives_of
from presswear.results.export import table_of, unit_of
from presswear.scene.settings import changed
from presswear.show.stage_tables import drive_table

PENDULUM = pw.assemble(
    bodies=[pw.Bar("crank", length=0.4, mass=2.0)],
    joints=[pw.Pin("O", (0.0, 0.0), "crank.tail")],
    drives=[pw.Drive("crank", speed=5.0, angle=0.3)],
    name="a bar that is turned",
)


def turned(linkage: pw.linkage.Linkage, cycles: int, engine: str = "dae") -> pw.Scene:
    scene = pw.Scene(
        linkage, joints="none", wear_updates=0, cycles=cycles, engine=engine
    )
    return changed(scene, {"drive_torque": "on"})


@pytest.mark.parametrize("run_up", [0, 1])
def test_a_bar_that_is_turned_bears_its_weight(run_up):
    """M = m g r cos a + J a'': closed form, run-up included."""
    scene = turned(replace(PENDULUM, run_up=run_up), cycles=3)
    result = pw.run(scene)
    stage = result.stages[0]
    found = drives_of(scene, stage)["crank"]
    curve = curves_of(scene, stage)["crank"]
    motion = scene.ideal.at(stage.time)
    levels = motion.position, motion.velocity, motion.acceleration
    angle, speed, faster = (level[:, 2] for level in levels)
    inertia = 2.0 * 0.4**2 / 3.0
    torque = 2.0 * 9.81 * 0.2 * np.cos(angle) + inertia * faster
    assert_allclose(curve.torque, torque, atol=1e-6)
    assert_allclose(curve.power, torque * speed, atol=1e-5)
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
        assert (duty.supplied, duty.returned) == pytest.approx(
            (2.0 * weight,) * 2, rel=10 * exact
        )
    columns = table_of(result, 0)
    assert_array_equal(columns["crank_power"], curve.power)
    assert_array_equal(columns["crank_angle"], angle)
    assert unit_of("crank_power") == "W"
    assert unit_of("my_crank_torque") == "N m"


@pytest.mark.parametrize(
    ("engine", "counts"),
    [("dae", [100, 3000]), ("exudyn-tree", [100, 3000]), ("exudyn-joints", [100])],
)
def test_works_of_the_drives_add_up_to_the_ledger_for_any_number_of_rows(
    engine, counts
):
    duties = []
    for rows in counts:
        scene: Any = pw.Scene(FOUR_BAR, joints="B", wear_updates=0, engine=engine)
        settings = {"drive_torque": "on", "rows_per_cycle": rows}
        settings |= {"steps_per_contact": 20, "free_steps": 1000}  # of exudyn-joints
        scene = changed(scene, {"cycles": 1, "replicates": 1, **settings})
        stage = pw.run(scene).stages[0]
        own = {name: found.duty for name, found in drives_of(scene, stage).items()}
        gross = sum(duty.supplied + duty.returned for duty in own.values())
        total = sum(duty.work for duty in own.values())
        assert total == pytest.approx(
            stage.diagnostics["drive_work_J"], abs=1e-6 * gross
        )
        duties.append(own)
    assert duties[0] == duties[-1]


def test_a_run_that_ends_in_its_run_up_has_no_duties():
    """A stage that failed before its first cycle: nothing is whole, and nothing breaks."""
    scene = turned(replace(PENDULUM, run_up=2), cycles=1)
    result = pw.run(scene)
    stage = result.stages[0]
    rows = {
        name: stage.arrays[name][:900] for name in ("time", "slider", "drive_torque")
    }
    assert rows["time"][-1] < scene.run_up
    rows |= {name: stage.arrays[name][:0] for name in ("cycles", "cycle_start")}
    cut = replace(stage, arrays={**stage.arrays, **rows})
    assert drives_of(scene, cut) == {}
    assert drive_table(replace(result, stages=(cut,))) is None
