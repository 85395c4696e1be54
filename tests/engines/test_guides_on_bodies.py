"""Guides on moving bodies in all engines; the open tree is in ``test_linkages``."""

import pytest
from marks import slow_in
from runs import compare_engines, run_scene
from slotted import (
    loose_scene,
    scotch_yoke,
    shaper,
    skew_quick_return,
    slotted_crank,
    swinging_block,
)

from presswear.engines.settings import ExudynJoints, ExudynTree
from presswear.tools.errors import InputError

SCENES = {
    "Scotch yoke": (scotch_yoke(), "A"),
    "swinging block": (swinging_block(), "A"),
    "slotted crank, rocker": (slotted_crank(), "Q"),
    "quick return, loose crank": (skew_quick_return(), "O2"),
    "shaper, a loop is left": (shaper(), "A"),
}
# Other linkages here and in test_linkages also have a block with a loose pin.
SLOW = ("swinging block", "quick return, loose crank")
DURATION = 0.01  # s, some touchdowns


@pytest.mark.parametrize(
    "name",
    slow_in(SLOW, SCENES),
)
def test_engines_agree_and_keep_the_energy(name):
    mechanism, joints = SCENES[name]
    scene = loose_scene(mechanism.changed(gravity=9.81), joints=joints)
    compare_engines(scene, DURATION, joints=(1e-6, 1e-5, 3e-4))


def test_a_slot_on_a_driven_body_is_explained():
    scene = loose_scene(slotted_crank(), joints="A", engine="exudyn-tree")
    with pytest.raises(
        InputError, match="slot is on crank, whose motion drives prescribe"
    ):
        run_scene(scene, ExudynTree(), DURATION)
    assert isinstance(
        loose_scene(slotted_crank(), joints="A", engine="exudyn").solver, ExudynJoints
    )
