"""Motion, torques and energy of linkages in all engines; more trees are in ``test_linkages``."""

from typing import Any

import pytest
from marks import slow_in
from runs import compare_engines
from slotted import (
    boom_press,
    cylinder,
    geared_five_bar,
    loose_scene,
    scotch_yoke,
    shaper,
    skew_quick_return,
    slider_crank_with_sleeve,
    slotted_crank,
    swinging_block,
    table,
)
from test_wedges import turning_wedge, wedge

from presswear.engines.settings import ExudynJoints
from presswear.linkage.linkage import Linkage
from presswear.linkage.motor import Motor

MOTOR = Motor(20.0, slip=0.1, inertia=0.1)
# Each duration has some touchdowns.
SLOTTED: dict[str, Any] = {"duration": 0.01, "joints": (1e-6, 1e-5, 3e-4)}
BOOMS: dict[str, Any] = {
    "duration": 0.014,
    "exudyn": ExudynJoints(steps_per_contact=320),
}
GEARS: dict[str, Any] = {
    "duration": 0.006,
    "energy": 1e-8,
    "joints": (3e-6, 3e-5, 3e-5),
}
CYLINDER: dict[str, Any] = {"duration": 0.006}
REVERSED = boom_press(is_reversed=True)
HEAVY = {"gravity": 9.81}
# Linkages, joints with clearance, and durations and bounds of the comparison
CASES: dict[str, tuple[Linkage, str, dict[str, Any]]] = {
    "Scotch yoke": (scotch_yoke().changed(**HEAVY), "A", SLOTTED),
    "swinging block": (swinging_block().changed(**HEAVY), "A", SLOTTED),
    "slotted crank": (slotted_crank().changed(**HEAVY), "Q", SLOTTED),
    "quick return, loose crank": (skew_quick_return(), "O2", SLOTTED),
    "shaper, a loop is left": (shaper(), "A", SLOTTED),
    # The cylinder is free, the link, or no body.
    "boom, free cylinder": (REVERSED, "A, P", BOOMS),
    "boom, free link": (boom_press(), "B", BOOMS),
    "boom, rigid joints": (boom_press(), "none", BOOMS),
    "boom, free slide": (boom_press(), "C", BOOMS),
    "reversed boom, free slide": (REVERSED, "C", BOOMS),
    "guide on a guide": (table(), "E", BOOMS),
    "sleeve on a rod": (slider_crank_with_sleeve(), "E", BOOMS),
    # The drive gives hardly any work in this part of a cycle.
    "wedge": (wedge(), "E", BOOMS | {"joints": (3e-6, 1e-5, 2e-3)}),
    "turning wedge": (turning_wedge(), "none", BOOMS),
    # The piston alone is prescribed, or with its loop, or all bodies are.
    **{f"cylinder, {joint}": (cylinder(), joint, CYLINDER) for joint in "ABC"},
    "cylinder, rigid joints": (cylinder(), "none", CYLINDER),
    "gears, E": (geared_five_bar(), "E", GEARS),
    "gears, O1": (geared_five_bar(), "O1", GEARS),
    "gears with a motor": (geared_five_bar(motor=MOTOR), "C", GEARS),
}
SLOW = (
    "swinging block",
    "quick return, loose crank",
    "boom, free slide",
    "reversed boom, free slide",
)


@pytest.mark.parametrize("name", slow_in(SLOW, CASES))
def test_engines_agree_and_keep_the_energy(name):
    linkage, joints, bounds = CASES[name]
    compare_engines(loose_scene(linkage, joints=joints), **bounds)
