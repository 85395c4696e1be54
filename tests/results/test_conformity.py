"""Contacts that are not small, against the laws' values for a pin as deep as its clearance."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import presswear as pw
from presswear.results.press_analysis import deep_contacts

SCENE = pw.scenes.press_blanking(
    wear_updates=0, replicates=1, cycles=1, engine="dae", clearance="0.5 mm"
)
EQUAL = (
    "joint C: the penetration of 500 µm is 1.00 of the clearance, and the contact extends over 120 "
    "degrees, too wide for a law of a small contact"
)
FORCES = (
    "; K delta^1.5 then has 1.54 and Liu's law 1.09 of the force of an elastic foundation",
    "; use elasticity = liu or foundation",
)


@pytest.mark.parametrize(
    ("law", "text"),
    [
        ({"elasticity": "power"}, "".join((EQUAL, *FORCES))),
        ({"elasticity": "liu"}, EQUAL + FORCES[0]),
        ({"exponent": 1.4}, EQUAL),
    ],
)
def test_a_pin_as_deep_as_its_clearance_touches_a_third_of_the_turn(
    law: dict[str, Any], text: str
) -> None:
    """Half the arc is 60 degrees; the foundation's force is 3/4 sqrt(c / 2) (e s - c sin s)."""
    scene = replace(SCENE, bearings=replace(SCENE.bearings, **law))
    stage = pw.StageResult(0, "completed", "", None, 1.0, (), 0.0, 0.0, {}, STATISTICS)
    arrays = {"cycles": np.zeros((1, 40)), "C_penetration": np.array([-1e-4, 5e-4])}
    assert deep_contacts(scene, [replace(stage, arrays=arrays, joint_names=("A", "C"))]) == [text]


STATISTICS: Any = type("Statistics", (), {"joints": {}})


@pytest.mark.parametrize(("force", "joints"), [("500 N", 0), ("50 kN", 2)])
def test_a_result_names_joints_whose_pins_sink_in_deep(force: str, joints: int) -> None:
    scene = pw.changed(SCENE, {"process.force": force})
    result = pw.run(scene)
    sentences = deep_contacts(scene, result.stages)
    assert [line[:7] for line in sentences] == ["joint A", "joint C"][:joints]
    assert all(line in str(result).splitlines() for line in sentences)
