"""Contacts that are not small, against the laws' values where the pin is as deep as the gap."""

import math
from dataclasses import replace

import pytest

import presswear as pw
from presswear.results.press_analysis import Conformity, deep_contacts


def test_a_pin_as_deep_as_its_clearance_touches_a_third_of_the_turn() -> None:
    """Half the arc is 60 degrees; the foundation's force is 3/4 sqrt(c / 2) (e s - c sin s)."""
    own = Conformity("C", 5e-5, 5e-5, "power")
    half = math.pi / 3.0
    whole = 0.75 * math.sqrt(0.5) * (2.0 * half - math.sin(half))
    assert own.arc == pytest.approx(2.0 * half, rel=1e-12)
    assert own.forces == pytest.approx((1.0 / whole, math.sqrt(0.5) / whole), rel=1e-12)
    assert not own.is_small
    assert own.words == (
        "joint C: the pin sank 50.0 µm into its bearing, 1.00 of the clearance, so that the "
        "surfaces overlap over 120 degrees: no small contact; there K delta^1.5 pushes with 1.54 "
        "and Liu's law with 1.09 of the foundation's force; elasticity = liu or foundation are "
        "made for it"
    )
    assert replace(own, elasticity="liu").words == own.words.rpartition(";")[0]
    assert replace(own, elasticity=None).words == own.words.partition(";")[0]


def test_a_contact_is_small_as_long_as_the_laws_agree() -> None:
    """All laws are one law where the pin hardly sinks in."""
    assert Conformity("A", -1e-4, 5e-5, "power").is_small
    edge = Conformity("A", 0.1 * 8e-4, 8e-4, "power")
    assert edge.is_small
    assert 1.05 < edge.forces[0] < 1.07
    assert Conformity("A", 1e-9, 1e-3, "liu").forces == pytest.approx((1.0, 1.0), rel=1e-5)


@pytest.mark.parametrize(("force", "joints"), [("500 N", 0), ("50 kN", 2)])
def test_a_result_says_where_pins_sink_in_deep(force: str, joints: int) -> None:
    """The paper's press stays in small contact, and is told of where it is overloaded."""
    changes = {"process.force": force, "clearance": "0.5 mm"}
    scene = pw.scenes.press_blanking(
        wear_updates=0, replicates=1, cycles=1, engine="dae", **changes
    )
    result = pw.run(scene)
    told = deep_contacts(scene, result.stages)
    assert [line[:7] for line in told] == ["joint A", "joint C"][:joints]
    assert all(line in str(result).splitlines() for line in told)
