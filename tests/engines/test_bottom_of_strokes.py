"""Bottom dead centre of short runs: against the ideal, and in one engine as in the other."""

from dataclasses import replace

import numpy as np
import pytest
from closed_form import press_motion

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.linkage.mechanisms import GEOMETRIES, Press
from presswear.physics.ideal import bottom_of
from presswear.scene.catalog import ideal, wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def bottoms(scene: Scene, engine: Engine, cycles: int) -> Array:
    """Height and time of each stroke's bottom, shape (cycles, 2)."""
    plan = RunSpec(cycles).plan(scene)
    run = engine.for_cycle(scene.mechanism.period).simulate(scene.linkage(), start_of(scene), plan)
    assert run.status == "completed", run.message
    return np.column_stack(
        [run.recorder.each_cycle(f"bottom_{name}") for name in ("height", "time")]
    )


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
@pytest.mark.parametrize("run_up", [0, 1])
def test_ideal_press_comes_to_the_bottom_of_the_closed_form(geometry: str, run_up: int) -> None:
    """With steps of a hundredth of a cycle the lowest accepted state is off by micrometres."""
    press = Press(geometry=GEOMETRIES[geometry], run_up=run_up)
    scene = replace(ideal(), mechanism=press)
    found = bottom_of(scene.ideal)
    assert found is not None
    rows = bottoms(scene, InHouse(free_step=press.period / 100.0), 3)[found.first :]
    height = press_motion(press, np.array([found.time])).output(scene.linkage())[0, 0]
    assert np.abs(rows[:, 0] - height).max() < 1e-10
    strokes = scene.run_up + press.period * np.arange(found.first, 3)
    assert np.abs(rows[:, 1] - found.time - strokes).max() < 1e-8
    assert np.abs(found.delay(rows[:, 1])).max() < 1e-8


def test_both_engines_come_to_the_same_bottom_up_to_the_horizon() -> None:
    """Behind some twenty impacts, here in the second stroke, they are draws of one motion."""
    scene = wear_times()
    one = bottoms(scene, InHouse(integration_tolerance=1e-12), 2)
    other = bottoms(scene, ExudynTree(tree_tolerance=1e-11), 2)
    assert abs(one[0, 0] - other[0, 0]) < 1e-10
    assert abs(one[0, 1] - other[0, 1]) < 1e-7
    found = bottom_of(scene.ideal)
    assert found is not None
    # Below the ideal by less than what both clearances allow.
    assert np.all(one[:, 0] < found.height - 1e-4)
    assert np.all(one[:, 0] > found.height - 2e-3)
