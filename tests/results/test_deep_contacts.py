"""Deep contacts and sheets that do not break: sentences, and peak forces of the contact laws."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import presswear as pw
from presswear.results.deep_contacts import deep_contacts, forces_by_law
from presswear.results.run_warnings import run_warnings
from presswear.show.key_numbers import key_numbers

SCENE = pw.scenes.press_blanking(
    conventions="paper", wear_updates=0, cycles=1, clearance="0.5 mm"
)
EQUAL = (
    "Contacts are deep: pins penetrate their bearings at joint C by 500 µm, 1.00 times the "
    "clearance, over 120 degrees. The stiffness is that of small contacts; here bottom dead "
    "centre under load may be wrong, forces less so."
)
ADVICE = (
    "Use stiffness = conforming with contact = foundation, which is for deep contacts, or a "
    "measured contact_stiffness."
)


def deep_stage() -> pw.results.StageResult:
    """A stage with a penetration of 0.5 mm at C."""
    stage = pw.results.StageResult(
        0, "completed", "", None, 1.0, (), 0.0, 0.0, {}, STATISTICS
    )
    arrays = {"cycles": np.zeros((1, 40)), "C_penetration": np.array([-1e-4, 5e-4])}
    return replace(stage, arrays=arrays, joint_names=("A", "C"))


@pytest.mark.parametrize("law", [{"elasticity": "power"}, {"exponent": 1.4}])
def test_a_deep_pin_touches_a_third_of_the_turn(law):
    """Half the arc is 60 degrees."""
    scene = replace(SCENE, bearings=replace(SCENE.bearings, **law))
    stage = deep_stage()
    assert deep_contacts(scene, [stage]) == [f"{EQUAL} {ADVICE}"]
    assert deep_contacts(scene, [replace(stage, status="failed")]) == []


def test_a_foundation_of_conforming_pins_is_for_deep_contacts():
    """A given contact stiffness takes the place of that of conforming pins."""
    scene = pw.changed(SCENE, {"contact": "foundation", "stiffness": "conforming"})
    stage = deep_stage()
    assert deep_contacts(scene, [stage]) == []
    given = pw.changed(scene, {"contact_stiffness": 1e10})
    assert len(deep_contacts(given, [stage])) == 1


@pytest.mark.parametrize("share", [0.0, 0.6])
@pytest.mark.parametrize(
    ("used", "part"), [("power", 0.3), ("liu", 2.0), ("foundation", 1e-4)]
)
def test_peak_forces_of_the_laws_store_the_same_energy(used, part, share):
    """Forces and energies by quadrature of each law as printed, with K of small contacts."""
    c = 5e-5
    stiffness = 2e11
    settings = {"clearance": c, "contact_stiffness": stiffness, "elasticity": used}
    scene = pw.changed(SCENE, {**settings, "contact": "radial"})

    def foundation(depth: float) -> float:
        half = math.acos(c / (c + depth))
        bed = 0.75 * stiffness * math.sqrt(0.5 * c)
        return bed * ((c + depth) * half - c * math.sin(half))

    laws = {
        "power": lambda depth: stiffness * depth**1.5,
        "liu": lambda depth: stiffness * depth**1.5 / math.sqrt(1.0 + depth / c),
        "foundation": foundation,
    }
    # beyond a prescribed force, from its equilibrium on
    given = share * laws[used](part * c)
    forces = forces_by_law(scene, "C", laws[used](part * c), given)
    assert forces[used] == pytest.approx(laws[used](part * c), rel=1e-9)

    def start_of(law: str) -> float:
        return float(brentq(lambda x: laws[law](x) - given, 0.0, 10.0 * part * c))

    def beyond(depth: float, law: str, energy: float = 0.0) -> float:
        work = quad(lambda x: laws[law](x) - given, start_of(law), depth)[0]
        return float(work) - energy

    energy = beyond(part * c, used)
    for law, force in laws.items():
        ends = start_of(law), 10.0 * part * c
        depth = brentq(beyond, *ends, args=(law, energy), xtol=1e-16)
        assert forces[law] == pytest.approx(force(depth), rel=1e-6)
    all_by_load = forces_by_law(scene, "C", 1e5, 2e5)
    assert [*all_by_load.values()] == pytest.approx([1e5] * 3, rel=1e-9)


def test_the_range_of_the_laws_has_the_stiffness_of_each():
    """Without a contact stiffness Liu's law has that of the width; others have no range."""
    scene = pw.changed(SCENE, {"conventions": "refined", "width": "0.1 mm"})
    forces = forces_by_law(scene, "C", 1000.0)
    assert forces["foundation"] == pytest.approx(1000.0, rel=1e-12)
    assert forces["liu"] < 0.5 * forces["foundation"] < forces["power"]
    bent = pw.changed(SCENE, {"exponent": 1.4})
    assert forces_by_law(bent, "C", 1000.0) == {}


def test_a_press_that_gives_way_does_not_break_its_sheet():
    """A frame of 1 MN/m bends by 1 mm under 1 kN, so that a sheet is touched 1 mm longer.

    It breaks 0.4 mm + 0.1 mm deep: with 1.3 mm the press stops 0.3 mm deep in it, and
    with 1.6 mm it breaks it.
    """
    mechanism = pw.SliderCrank(
        crank_length=0.05,
        rod_length=0.3,
        slide_angle=-0.5 * math.pi,
        gravity=0.0,
        speed=5.0 * math.pi / 30.0,
        frame_mass=100.0,
        frame_stiffness=1e6,
        frame_damping=0.5,
    )
    process = pw.Blanking(force=1e3, height=1.3e-3)
    scene = pw.Scene(
        mechanism, joints="none", process=process, cycles=3, wear_updates=0
    )
    result = pw.run(scene, engine="dae")
    (sentence,) = run_warnings(scene, result.stages)
    assert sentence.startswith(
        "The sheet does not break in 1 of 1 strokes: the slider goes "
    )
    depth = float(sentence.split("goes ")[1].split(" mm")[0])
    assert depth == pytest.approx(0.3, abs=0.005)
    assert "Use process.height = 1.53 mm or more" in sentence
    assert sentence in str(result).splitlines()
    result = pw.run(pw.changed(scene, {"process.height": "1.6 mm"}), engine="dae")
    assert run_warnings(scene, result.stages) == []


STATISTICS: Any = type("Statistics", (), {"joints": {}})


@pytest.mark.parametrize(
    ("force", "joints", "struck"),
    [("500 N", 0, ""), ("50 kN", 2, ""), ("5 kN", 2, "A")],
)
def test_a_result_names_joints_whose_pins_sink_in_deep(force, joints, struck):
    """Laws differ where pins strike; at 50 kN the load prescribes both peaks, at 5 kN that at C."""
    scene = pw.changed(SCENE, {"process.force": force, "replicates": 2})
    result = pw.run(scene)
    sentences = deep_contacts(scene, result.stages)
    assert sum("an impact of the same" in line for line in sentences) == len(struck)
    assert all(f"energy is, at joint {struck}," in line for line in sentences if struck)
    assert all("; at joint" not in line for line in sentences)
    card = next(
        number for number in key_numbers(result) if number.name == "Peak joint force"
    )
    assert "by contact law" not in card.interval  # of C
    assert len(sentences) == min(joints, 1)
    assert all(
        "at joint A by " in line and "and joint C by" in line for line in sentences
    )
    assert all(line in str(result).splitlines() for line in sentences)
