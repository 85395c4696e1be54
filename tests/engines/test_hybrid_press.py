"""The named scene press-hybrid: a motor with a flywheel, and a servo that follows it."""

import numpy as np
import pytest
from marks import slow

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.results.export import table_of
from presswear.results.motor_load import leader_speed, motor_loads

SCENE = pw.scenes.press_hybrid(wear_updates=0, cycles=3, replicates=1)
UNTIL = 0.04
"""s; both pins fall on their bearings and rebound, before chaos separates engines."""


def run_of(engine: Engine) -> Run:
    """Run the first part of a cycle."""
    engine = engine.for_cycle(SCENE.mechanism.period)
    return engine.simulate(SCENE.linkage(), start_of(SCENE), Plan(UNTIL, 1))


@pytest.mark.parametrize(
    ("engine", "error"),
    [
        (ExudynTree(tree_tolerance=1e-10), 1e-9),
        slow(ExudynJoints(), 1e-6),
    ],
)
def test_every_engine_moves_both_free_cranks_alike(engine: Engine, error):
    expected = run_of(InHouse(integration_tolerance=1e-12))
    assert expected.recorder.series("normal", 0).max() > 0.0
    assert run_of(engine).end.position == pytest.approx(
        expected.end.position, abs=error
    )


def test_the_motor_does_the_work_and_the_servo_shapes_the_stroke():
    """The servo gives back what it takes, as in the ideal motion; the speed settles."""
    result = pw.run(SCENE, engine="dae")
    stage = result.stages[0]
    assert (stage.statistics.energy_residual_fraction or 1.0) < 1e-6
    (motor,) = motor_loads(SCENE, stage).values()
    servo = result.drives(0)["crank 7"].duty
    # The servo swings about its motion: its speed is not that of the motion.
    columns = table_of(result, 0)
    for body, duty in ((name, one.duty) for name, one in result.drives(0).items()):
        late = stage.time >= 2.0 * SCENE.mechanism.period
        power = columns[f"{body}_power"][late]
        clock = stage.clock[late]
        net = np.trapezoid(power, clock)
        assert net == pytest.approx(
            duty.supplied - duty.returned, abs=0.02 * duty.supplied
        )
        assert np.abs(power).max() == pytest.approx(abs(duty.power.peak), rel=0.05)
        moved = np.trapezoid(columns[f"{body}_speed"], stage.clock)
        angle = columns[f"{body}_angle"]
        assert angle[-1] - angle[0] == pytest.approx(moved, abs=1e-3)
    assert SCENE.process is not None
    assert motor.work.mean > SCENE.process.work
    assert abs(servo.supplied - servo.returned) < 0.1 * motor.work.mean
    speed = leader_speed(SCENE, stage)
    assert speed is not None
    assert speed.drop is not None
    assert speed.drop.mean == pytest.approx(0.147, abs=0.01)
    duration = stage.each_cycle("duration")
    assert np.ptp(duration) < 5e-3 * duration[-1]
