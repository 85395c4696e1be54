"""Bearings whose oil film acts in the run: allowed settings, and the film of the joint."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from pathlib import Path
from typing import Any

import pytest
from refusals import refused

import presswear as pw

SCENARIOS = Path(__file__).parents[2] / "scenarios"
OILED = {"film": "run", "viscosity": "0.1 Pa s"}
# A film needs a smaller clearance than the dry bearings of the scenes.
NARROW_BEARING: dict[str, Any] = {**OILED, "clearance": "50 um"}
# Settings of a scene; its wear coefficient is a setting of the materials.
NARROW: dict[str, Any] = {**NARROW_BEARING, "wear_coefficient": 1e-16}


def test_guide_has_no_film():
    sizes: dict[str, Any] = {"guide_length": "0.3 m", "guide_width": "0.2 m"}
    bearings = {"guide": pw.Bearing(**NARROW_BEARING)}
    with refused("a guide has no oil film; allowed is report"):
        pw.Scene(pw.SliderCrank(**sizes), bearings=bearings)


def test_oil_of_a_joint():
    press = pw.scene_from(SCENARIOS / "press-250kN.toml")
    assert all(joint.oil is None for joint in press.linkage().clearances)
    joint = pw.changed(press, OILED).linkage().clearances[0]
    assert joint.oil.viscosity == 0.1
    # Roughness of two surfaces of 0.3 um
    assert joint.oil.roughness == pytest.approx(math.sqrt(2.0) * 0.3e-6)
    assert joint.oil.asperity_pressure == 50e6
    assert joint.deepest_wear == pytest.approx(1e-5)


def test_wear_beyond_the_deepest_wear_of_a_film_is_refused():
    bearing = [0.0] * 359 + [2e-5]
    with refused(r"allowed is 0 to 0\.01 mm"):
        pw.scenes.slider_crank(**NARROW, surfaces={"B": [bearing, None]})
