"""ISO fits in place of a clearance: formulas of the standard, printed values, messages."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
import re
from typing import Any

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.scene.catalog import name_of
from presswear.scene.files import scene_from
from presswear.scene.fits import (
    _DEVIATIONS,
    _SIZES,
    _TOLERANCES,
    clearances_of,
    fit_of,
)
from presswear.scene.setting_keys import setting_of
from presswear.scene.value_ranges import values_of
from presswear.sweeps.parameters import parse_distribution
from presswear.tools.quantities import Quantity

# Formulas of ISO 286-1 before rounding, D in mm and results in um: tolerances in units of i up
# to 500 mm and of I above, and fundamental deviations.
UNITS = {6: 10.0, 7: 16.0, 8: 25.0, 9: 40.0, 10: 64.0, 11: 100.0}
DISTANCES = {
    "d": (16.0, 0.44),
    "e": (11.0, 0.41),
    "f": (5.5, 0.41),
    "g": (2.5, 0.34),
}


def middle(place: int) -> float:
    """Return the geometric mean of a range of nominal sizes, mm."""
    return math.sqrt(_SIZES[place] * (_SIZES[place - 1] if place else 1.0))


@pytest.mark.parametrize("place", range(len(_SIZES)))
def test_tables_are_the_rounded_formulas_of_the_standard(place):
    size = middle(place)
    is_small = _SIZES[place] <= 500
    unit = 0.45 * size ** (1 / 3) + 0.001 * size if is_small else 0.004 * size + 2.1
    for grade, count in UNITS.items():
        expected = count * unit
        # Up to 3 mm the standard has larger values, 25 um for 21.7 um.
        near = 0.16 if place == 0 else 0.07
        assert _TOLERANCES[grade][place] == pytest.approx(expected, rel=near, abs=1.0)
    for letter, (factor, power) in DISTANCES.items():
        expected = factor * size**power
        assert _DEVIATIONS[letter][place] == pytest.approx(expected, rel=0.05, abs=1.1)


@pytest.mark.parametrize(
    ("text", "least", "largest"),
    [
        # limit deviations as printed in ISO 286-2, um in diameter
        ("110 H8/f7", 36, 54 + 71),
        ("90 H9/f7", 36, 87 + 71),  # SBS, the fit of scenarios/press-250kN.toml
        ("50 H7/g6", 9, 25 + 25),
        ("30 H8/e8", 40, 33 + 73),
        ("80 H11/d11", 100, 190 + 290),  # a range contains its upper end
        ("860 F8/h9", 86, 226 + 230),
        ("25 mm H7/h6", 0, 21 + 13),
    ],
)
def test_printed_deviations(text, least, largest):
    fit = fit_of(text)
    assert fit.diameter is not None
    ends = clearances_of(fit, fit.diameter)
    assert [2e6 * end for end in ends] == pytest.approx([least, largest])


def test_a_clearance_is_the_middle_of_a_fit():
    fit: Any = "110 H8/f7"
    short: Any = "H8/f7"
    drawn: Any = "Ø110H8/f7"
    bearing = pw.Bearing(diameter="110 mm", clearance=fit)
    assert bearing.bearing_radius == pytest.approx(0.055)
    assert bearing.clearance == pytest.approx(0.25e-6 * (36 + 125))
    assert pw.Bearing(diameter=0.11, clearance=short) == bearing
    assert pw.Bearing(diameter=0.11, clearance=drawn) == bearing
    assert pw.Bearing(diameter=0.11, diametral_clearance=fit) == bearing
    scene = pw.changed(
        pw.scenes.wear_times(), {"A.diameter": "90 mm", "A.c": "90 H9/f7"}
    )
    assert scene.bearing("A").clearance == pytest.approx(0.25e-6 * (36 + 158))
    assert scene.bearing("C") == pw.scenes.wear_times().bearing("C")
    origin = setting_of(scene, "A.clearance").meaning
    assert isinstance(origin, Quantity)
    assert origin.origin == "set by the user: middle of 90 H9/f7, 0.018 to 0.079 mm"


def test_a_sample_of_a_fit_goes_over_its_field():
    field = parse_distribution("110 H8/f7", "clearance", Quantity("m"))
    ends = field.ppf(np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(ends, [18e-6, 40.25e-6, 62.5e-6], rtol=1e-9)
    with refused("with its diameter is expected"):
        parse_distribution("H8/f7", "clearance", Quantity("m"))


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"clearance": "110 H8/f7"},
            "fit 110 H8/f7: the bearing has a diameter of 30 mm; set diameter = 110 mm, or the "
            "fit without a diameter, H8/f7",
        ),
        (
            {"clearance": "30 H7/p6"},
            "fit 30 H7/p6: allowed are holes D to H and pins d to h",
        ),
        ({"clearance": "30 H7/f14"}, "of the grades 6 to 11, such as 110 H8/f7"),
        ({"diameter": "-3 mm"}, "diameter = -3 mm: allowed is 0.2 to 2000 mm"),
        ({"R_i": "9 mm", "diameter": "9 mm"}, "R_i and diameter are the same setting"),
    ],
)
def test_a_fit_that_does_not_fit_is_refused(settings, message):
    with refused(re.escape(message)):
        pw.changed(pw.scenes.wear_times(), settings)
    with refused("such as 110 H8/f7:5"):
        values_of("clearance", "H8/f7:3", Quantity("m"))


def test_a_fit_in_a_file_is_no_change_of_it(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text("mechanism = 'press'\n[bearings]\nclearance = 'H8/f7'\n")
    scene = scene_from(file)
    assert name_of(scene) == "own"
    assert "clearance" in name_of(pw.changed(scene, {"clearance": "H7/f7"}))
