"""Service lives and wear updates by user laws, against those of the built-in laws."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

from typing import Any

import numpy as np
import pytest
from bush import bush
from refusals import refused

import presswear as pw
from presswear.scene.settings import changed
from presswear.tools.user_function import UserFunction

pytestmark = pytest.mark.usefixtures("unwatched")
GAP = 1e-3  # clearance of the bushing, m
LAWS = """
import math

def fading(depth, coefficient):
    return coefficient * (1.0 + 19.0 * math.exp(-depth / 4e-6))
"""
BUILT_IN: dict[str, Any] = {"running_in": 20.0, "running_in_depth": "4 um"}


def scene_of(settings: dict[str, Any]) -> pw.Scene:
    """Return a bushing worn until it has lost a hundredth of its clearance."""
    limits = pw.Life(until=f"B.depth > {0.01 * GAP!r} m", at_most=1e12)
    scene = bush(life=limits, replicates=2, wear_updates=1, cycles=3, tolerance=0.5)
    return changed(scene, settings)


def test_a_life_is_that_of_the_built_in_law():
    law = UserFunction("fading", LAWS).trusted()
    lives = []
    for settings in ({"wear_law": law}, BUILT_IN):
        life = pw.run(scene_of(settings), jobs=1, check=False).life
        assert life.ended == "limit"
        lives.append(life)
    ours, built_in = lives
    assert ours.strokes == pytest.approx(built_in.strokes, rel=1e-9)
    for key, curve in built_in.curves.items():
        np.testing.assert_allclose(ours.curves[key], curve, rtol=1e-9, atol=1e-15)


def test_a_quick_life_needs_a_constant_rate():
    law = UserFunction("fading", LAWS).trusted()
    scene = scene_of({})
    with refused("wear_law = user law fading"):
        changed(scene, {"wear_law": law, "life.quick": "on"})
