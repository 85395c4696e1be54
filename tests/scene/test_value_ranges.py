"""Values of a setting as a list or a range."""

import pytest
from refusals import refused

import presswear as pw
from presswear.scene.setting_keys import setting_of
from presswear.scene.value_ranges import values_of
from presswear.tools.quantities import Quantity


def read(text: str) -> list[float]:
    """Return the values of ``KEY=VALUES``."""
    key, _, values = text.partition("=")
    meaning = setting_of(pw.scenes.wear_times(), key).meaning
    assert isinstance(meaning, Quantity)
    return values_of(key, values, meaning)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("clearance=0.2mm:1.0mm:3", [2e-4, 6e-4, 1e-3]),
        ("clearance=0.2:1.0:3 mm", [2e-4, 6e-4, 1e-3]),
        ("clearance=1.0:0.2:3 mm", [1e-3, 6e-4, 2e-4]),
        ("contact_stiffness=1e8:1e10:3 N/m^1.5:log", [1e8, 1e9, 1e10]),
        ("contact_stiffness=1e8:1e10:3:log N/m^1.5", [1e8, 1e9, 1e10]),
        ("clearance=0.2mm, 0.5 mm", [2e-4, 5e-4]),
        ("friction=0:0.1:3", [0.0, 0.05, 0.1]),
        ("restitution=0,1", [0.0, 1.0]),
        ("clearance=0,0.1mm", [0.0, 1e-4]),
        ("clearance=0, 1 mm", [0.0, 1e-3]),
        ("clearance=0mm,1mm", [0.0, 1e-3]),
    ],
)
def test_a_range_or_a_list_of_values_is_read(text, values):
    assert read(text) == values


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("clearance=0.2:1.0:3", "has no unit"),
        ("clearance=0.2mm:1.0mm:3 mm", "unknown unit 'mm mm'"),
        ("clearance=1mm:2m:3", "clearance = 2 m: allowed is"),
        ("clearance=1mm:2mm", "FIRST:LAST:COUNT"),
        ("clearance=1:2:1 mm", "a number of values from 2"),
        ("clearance=1:2:3:lin mm", "FIRST:LAST:COUNT:log"),
        ("clearance=1:1:3 mm", "two ends that differ"),
        ("friction=0:0.1:3:log", "ends above 0"),
        (
            "clearance=0,1mm",
            r"use a decimal point, 0\.1mm; a 0 of a list needs its unit",
        ),
        ("clearance=0,1 mm,0,2 mm", r"use a decimal point, 0\.1 mm,0\.2 mm;"),
        ("replicates=2:5:3", r"replicates = 3\.5: a whole number is expected"),
    ],
)
def test_a_range_that_does_not_fit_is_refused(text, message):
    with refused(message):
        read(text)
