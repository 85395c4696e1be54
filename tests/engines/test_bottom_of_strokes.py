"""Bottom dead centre of short runs: against the ideal, and in one engine as in the other."""

import numpy as np

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.physics.dead_centre import bottom_of
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def bottoms(scene: Scene, engine: Engine, cycles: int) -> Array:
    """Height and time of each stroke's bottom, shape (cycles, 2)."""
    plan = RunSpec(cycles).plan(scene)
    run = engine.for_cycle(scene.mechanism.period).simulate(
        scene.linkage(), start_of(scene), plan
    )
    assert run.status == "completed", run.message
    return np.column_stack(
        [run.recorder.each_cycle(f"bottom_{name}") for name in ("height", "time")]
    )


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
