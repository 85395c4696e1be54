"""Errors of the paper with their effects on the wear depth."""

import math

import pytest
from known_results import every_evidence

from presswear.paper import errors
from presswear.paper.evidence import Evidence
from presswear.paper.settings import SENSITIVITIES, WEAR, base_scene
from presswear.physics.wear import contact_area


def test_half_the_chord_belongs_to_the_pin():
    """Two circles: half their common chord is the height of the triangle e, R_i, R_j over e."""
    bearing = base_scene(WEAR).bearing("A")
    radius = bearing.bearing_radius
    pin = 0.0142
    penetration = 2e-6
    e = radius - pin + penetration
    half = (
        math.sqrt((pin + radius + e) * (pin + radius - e) * (radius + e - pin))
        * math.sqrt(e + pin - radius)
        / (2.0 * e)
    )
    printed = contact_area(penetration, e, radius, pin, bearing.width)
    assert pin == pytest.approx(radius - bearing.clearance)
    assert printed / (2.0 * bearing.width * half) == pytest.approx(
        radius / pin, rel=1e-9
    )
    assert errors.chord_ratio(base_scene(WEAR)) == pytest.approx(1.0563, abs=1e-4)


def test_every_effect_is_computed():
    """Depths are the same in all made-up runs, so that every computed effect is near zero."""
    ((_, rows),) = errors.error_table(every_evidence()).groups
    assert all(all(row) for row in rows)
    effects = {row[0]: row[-1] for row in rows}
    assert effects["26"] == "5.63"
    for place in ("24", "30, 31", "section 5.1"):
        assert (
            abs(float(effects[place].split()[0].replace("\N{MINUS SIGN}", "-"))) < 5.0
        )
    cases = [name.partition("--")[0] for name in errors.RUNS[1:]]
    assert set(cases) <= set(SENSITIVITIES)
    ((_, rows),) = errors.error_table(Evidence({})).groups
    assert {row[0]: row[-1] for row in rows}["24"] == "\N{EN DASH}"
