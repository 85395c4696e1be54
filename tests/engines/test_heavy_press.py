"""The press of 250 kN from its file: joints that bear a hundred times their links' weight."""

from functools import cache
from pathlib import Path

import pytest
from marks import slow

import presswear as pw
from presswear.results.motor_load import leader_speed, motor_loads
from presswear.scene.files import scene_from
from presswear.scene.settings import changed

FILE = Path(__file__).parents[2] / "scenarios" / "press-250kN.toml"
REAL = scene_from(FILE)
"""With motor, flywheel, servo and elastic frame."""
SCENE = changed(REAL, {"motor": "none", "servo": "none", "frame_stiffness": "none"})
"""Rigid, with both cranks at constant speed."""
ENGINES = "exudyn-tree", "dae"


@pytest.mark.parametrize("engine", ENGINES)
def test_pins_bear_a_load_of_a_hundred_weights_and_energies_add_up(engine):
    """The rod to the slider bears the work, the crank half of it; both sink in deep."""
    result = pw.run(changed(SCENE, {"cycles": "2"}), engine=engine)
    assert (result.stages[0].statistics.energy_residual_fraction or 1.0) < 1e-6
    tonnage = result.tonnage(0)
    process = SCENE.process
    assert tonnage is not None
    assert tonnage.work is not None
    assert process is not None
    assert tonnage.work.mean == pytest.approx(process.work, rel=1e-7)
    joints = result.stages[0].joints
    deep = {name: joint.penetration.max() for name, joint in joints.items()}
    assert 225e3 < joints["C"].force[:, 0].max() < 250e3
    assert 0.9 < deep["C"] / SCENE.bearing("C").clearance < 1.1
    assert 0.4 < deep["A"] / SCENE.bearing("A").clearance < 0.8
    assert str(result).count("The stiffness is that of small contacts") == 1


@cache
def real_press(engine: str) -> pw.Result:
    """Return a run of the press with its motor and its frame."""
    scene = changed(REAL, {"cycles": "2", "replicates": "1"})
    return pw.run(scene, engine=engine)


@pytest.mark.parametrize("engine", ["dae", slow("exudyn-tree")])
def test_the_flywheel_delivers_the_work_and_the_motor_settles(engine):
    """The speed drops by 15 % in the work, as the file says, and is back at the next."""
    result = real_press(engine)
    stage = result.stages[0]
    assert (stage.statistics.energy_residual_fraction or 1.0) < 1e-6
    duration = stage.each_cycle("duration")
    assert duration[0] == pytest.approx(duration[1], rel=3e-3)
    assert 1.01 < duration[1] < 1.03
    speed = leader_speed(REAL, stage)
    assert speed is not None
    assert speed.drop is not None
    assert speed.drop.mean == pytest.approx(0.15, abs=0.005)
    motor = motor_loads(REAL, stage)["crank 2"]
    assert REAL.process is not None
    assert motor.work.mean > 1.2 * REAL.process.work
    assert motor.rms_fraction.mean < 1.0
