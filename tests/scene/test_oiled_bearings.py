"""Bearings whose oil film acts in the run: allowed settings, and the film of the joint."""

import math
import re
from pathlib import Path
from typing import Any

import pytest

import presswear as pw
from presswear.tools.errors import InputError

SCENARIOS = Path(__file__).parents[2] / "scenarios"
OILED = {"film": "run", "viscosity": "0.1 Pa s"}
# A film needs a smaller clearance than the dry bearings of the scenes.
NARROW_BEARING: dict[str, Any] = {**OILED, "clearance": "50 um"}
# Settings of a scene; its wear coefficient is a setting of the materials.
NARROW: dict[str, Any] = {**NARROW_BEARING, "wear_coefficient": 1e-16}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"film": "run"}, "film = run: it needs a viscosity, such as 0.1 Pa s"),
        (
            {**NARROW, "viscosity": 5e-5},
            "film = run: viscosity = 5e-05 Pa s: allowed is from 0.0001 Pa s",
        ),
        (
            {**OILED, "clearance": "0.1 mm"},
            "clearance = 0.1 mm is 10 per mille of the radius of the bearing; allowed is "
            "up to 5 per mille, or film = report",
        ),
        (
            {**NARROW, "width": "2 mm"},
            "width = 2 mm is 0.1 of the diameter of the bearing; allowed is 0.125 to 1",
        ),
        ({**OILED, "clearance": 0.0}, "with clearance = 0 allowed is report"),
        (
            {**NARROW, "friction_law": "lugre"},
            "friction_law = lugre: with film = run allowed is ramp, threlfall",
        ),
        (
            {**NARROW, "pressure_exponent": 0.8},
            "pressure_exponent = 0.8: with film = run allowed is 1",
        ),
        (
            {**NARROW, "wear_distribution": "bin"},
            "film = run: with wear_distribution = bin allowed is report",
        ),
    ],
)
def test_setting_that_a_film_in_the_run_does_not_allow(
    settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        pw.scenes.slider_crank(**settings)


def test_guide_has_no_film() -> None:
    sizes: dict[str, Any] = {"guide_length": "0.3 m", "guide_width": "0.2 m"}
    bearings = {"guide": pw.Bearing(**NARROW_BEARING)}
    with pytest.raises(InputError, match="a guide has no oil film; allowed is report"):
        pw.Scene(pw.SliderCrank(**sizes), bearings=bearings)


def test_oil_of_a_joint() -> None:
    press = pw.scene_from(SCENARIOS / "press-250kN.toml")
    assert all(joint.oil is None for joint in press.linkage().clearances)
    joint = pw.changed(press, OILED).linkage().clearances[0]
    assert joint.oil is not None
    assert joint.oil.viscosity == 0.1
    # Roughness of two surfaces of 0.3 um
    assert joint.oil.roughness == pytest.approx(math.sqrt(2.0) * 0.3e-6)
    assert joint.oil.asperity_pressure == 50e6
    assert joint.deepest_wear == pytest.approx(1e-5)


def test_wear_beyond_the_deepest_wear_of_a_film_is_refused() -> None:
    bearing = [0.0] * 359 + [2e-5]
    with pytest.raises(InputError, match=r"allowed is 0 to 0\.01 mm"):
        pw.scenes.slider_crank(**NARROW, surfaces={"B": [bearing, None]})
