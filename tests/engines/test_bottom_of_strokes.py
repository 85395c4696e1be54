"""Bottom dead centre of short runs, compared between engines and with the ideal motion."""

import numpy as np

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.settings import Engine, ExudynTree, InHouse
from presswear.physics.dead_centre import bottom_of
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def bottoms(scene: Scene, engine: Engine, cycles: int) -> Array:
    """Height, m, and time, s, of the bottom of each stroke, shape (cycles, 2)."""
    plan = RunSpec(cycles).plan(scene)
    run = engine.for_cycle(scene.mechanism.period).simulate(
        scene.linkage(), start_of(scene), plan
    )
    assert run.status == "completed", run.message
    height = run.recorder.each_cycle("bottom_height")
    return np.column_stack([height, run.recorder.each_cycle("bottom_time")])


def test_engines_agree_on_the_bottom_of_the_first_stroke() -> None:
    """In the second stroke, after some twenty impacts, their motions differ."""
    scene = wear_times()
    in_house = bottoms(scene, InHouse(integration_tolerance=1e-12), 1)
    tree = bottoms(scene, ExudynTree(tree_tolerance=1e-11), 1)
    height_difference, time_difference = np.abs(in_house[0] - tree[0])
    assert height_difference < 1e-10
    assert time_difference < 1e-7
    ideal = bottom_of(scene.ideal)
    assert ideal is not None
    # The slider hangs below the ideal height, by less than both clearances allow.
    below = ideal.height - in_house[:, 0]
    assert np.all(below > 1e-4)
    assert np.all(below < 2e-3)
