"""Bearings whose oil film acts in the run: what is allowed, and what the joint gets."""

import math
import re
from pathlib import Path
from typing import Any

import pytest

import presswear as pw
from presswear.tools.errors import InputError

SCENARIOS = Path(__file__).parents[2] / "scenarios"
OILED = {"film": "run", "viscosity": "0.1 Pa s"}
NARROW_BUSH: dict[str, Any] = {**OILED, "clearance": "50 um"}
NARROW = {**OILED, "clearance": "50 um", "wear_coefficient": 1e-16}


@pytest.mark.parametrize(
    ("values", "words"),
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
def test_what_a_film_in_the_run_needs(values: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)):
        pw.scenes.slider_crank(**values)


def test_guide_has_no_film() -> None:
    sizes: dict[str, Any] = {"guide_length": "0.3 m", "guide_width": "0.2 m"}
    bearings = {"guide": pw.Bearing(**NARROW_BUSH)}
    with pytest.raises(InputError, match="a guide has no oil film; allowed is report"):
        pw.Scene(pw.SliderCrank(**sizes), bearings=bearings)


def test_oil_of_a_joint() -> None:
    press = pw.scene_from(SCENARIOS / "press-250kN.toml")
    dry = press.linkage()
    oiled = pw.changed(press, OILED).linkage()
    assert all(joint.oil is None for joint in dry.clearances)
    oil = oiled.clearances[0].oil
    assert oil is not None
    assert oil.viscosity == 0.1
    assert oil.roughness == pytest.approx(math.sqrt(2.0) * 0.3e-6)
    assert oil.asperity_pressure == 50e6
    assert oiled.clearances[0].deepest_wear == pytest.approx(1e-5)


def test_surfaces_of_a_film_are_hardly_worn() -> None:
    with pytest.raises(InputError, match=r"allowed is 0 to 0\.01 mm"):
        pw.scenes.slider_crank(**NARROW, surfaces={"B": [[0.0] * 359 + [2e-5], None]})
