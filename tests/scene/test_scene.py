"""Scenes: the linkage and the engine that they make, and what is stored of them."""

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.laws import hertz_stiffness
from presswear.linkage.mechanisms import FOUR_BAR, Press, SliderCrank
from presswear.scene.bearing import CONVENTIONS, Bearing
from presswear.scene.catalog import SCENES, scene_named, wear_times
from presswear.scene.options import Numerics
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError

BASE = Scene(name="base", title="a scene")


def test_joints_are_those_of_the_mechanism() -> None:
    spelled = {"A": "A", "C": "C", "AC": "AC", "A,C": "AC", "CA": "AC", "none": ""}
    for given, names in spelled.items():
        scene = Scene(joints=given)
        assert tuple(joint.name for joint in scene.linkage().clearances) == tuple(names)
        assert scene.joints == (names or "none")
    assert Scene(SliderCrank(), joints="B , A").joints == "AB"
    named = FOUR_BAR.changed(
        joints=[replace(own, name=f"pin {own.name}") for own in FOUR_BAR.joints]
    )
    assert Scene(named, joints="pin B, pin A").clearance_joints == ("pin A", "pin B")
    assert Scene(named, joints="pin P").joints == "pin P"
    for wrong in ("", "AA", "AB", "A,", "none,A", "B"):
        with pytest.raises(InputError, match=r"allowed is one of A, C, none, several, as AC"):
            Scene(joints=wrong)


def test_a_mechanism_says_which_joints_have_clearance_where_nobody_else_does() -> None:
    """A linkage of one's own has ideal joints; a bearing that would be in none is refused."""
    for mechanism, joints in ((Press(), "AC"), (SliderCrank(), "B"), (FOUR_BAR, "none")):
        scene = Scene(mechanism)
        assert scene == Scene(mechanism, joints=joints)
        assert scene.joints == joints
    # Those of another press are no default of its own linkage.
    assert Scene(Press().linkage()).joints == "none"
    tight = Bearing(clearance=0.2e-3)
    with pytest.raises(InputError, match=r"^bearings: no joint has clearance; .* of O, A, B, P$"):
        Scene(FOUR_BAR, bearings=tight)
    assert Scene(FOUR_BAR, bearings=tight, joints="B").clearance_joints == ("B",)
    with pytest.raises(InputError, match="'joints' is missing"):
        Scene.from_dict({**BASE.as_dict(), "joints": None})


def test_scene_makes_the_linkage_it_describes() -> None:
    scene = changed(BASE, {"joints": "A", "friction": "0.05", "restitution": "0.8"})
    linkage, closed = scene.linkage(), scene.mechanism.linkage()
    (joint,) = linkage.clearances
    assert joint.name == "A"
    assert linkage.revolutes == tuple(r for r in closed.revolutes if r.name != "A")
    (own,) = (r for r in closed.revolutes if r.name == "A")
    assert (joint.bearing, joint.pin) == (own.first, own.second)
    assert (joint.bearing.body, joint.pin.body) == ("rod 3", "crank 2")
    assert joint.pin_radius == 0.015 - 0.8e-3
    assert joint.normal.damping == pytest.approx(0.75 * 0.36, rel=1e-14)
    assert joint.friction.coefficient == 0.05
    assert changed(BASE, {"wear_coefficient": "0/Pa"}).linkage().clearances[0].wear is None


@pytest.mark.parametrize(
    ("conventions", "expected"),
    [
        ("paper", ("fixed", "radial", "angle", "bin")),
        ("refined", ("body", "foundation", "sliding", "arc")),
    ],
)
def test_conventions_reach_the_joint(conventions: str, expected: tuple[str, ...]) -> None:
    joint = replace(BASE, conventions=CONVENTIONS[conventions]).linkage().clearances[0]
    assert joint.wear is not None
    told = (joint.map_frame, joint.contact, joint.wear.slip, joint.wear.wear_distribution)
    assert told == expected
    reading = CONVENTIONS[conventions].stiffness
    stiffness = hertz_stiffness(0.015, 0.0142, 2.0 * (1.0 - 0.3**2) / 200e9, reading)
    assert joint.normal.stiffness == pytest.approx(stiffness, rel=1e-14)


@pytest.mark.parametrize(
    ("joints", "engine", "kind"),
    [
        ("AC", "exudyn", ExudynTree),
        ("A", "exudyn", ExudynJoints),
        ("none", "exudyn", ExudynJoints),
        ("AC", "exudyn-joints", ExudynJoints),
        ("AC", "dae", InHouse),
    ],
)
def test_the_smallest_model_that_fits_is_taken(joints: str, engine: str, kind: type) -> None:
    assert type(replace(BASE, joints=joints, engine=engine).solver) is kind


@pytest.mark.parametrize("name", list(SCENES))
def test_named_scenes_survive_storage(name: str) -> None:
    scene = scene_named(name)
    data = scene.as_dict()
    assert Scene.from_dict(data) == scene
    assert data == scene.as_dict()
    assert Scene.from_dict(json.loads(json.dumps(data, allow_nan=False))) == scene


def test_a_stored_scene_that_lost_a_value_is_refused() -> None:
    """What got lost is not today's default."""
    data = json.loads(json.dumps(BASE.as_dict()))
    for part in ("bearings", "numerics", "conventions", "mechanism"):
        for key in data[part]:
            less = {**data, part: {k: v for k, v in data[part].items() if k != key}}
            with pytest.raises(InputError, match=f"'?{key}|missing"):
                Scene.from_dict(less)


def stored(**other: Any) -> dict[str, Any]:
    return {**BASE.as_dict(), **other}


def stored_part(part: str, **other: Any) -> dict[str, Any]:
    return stored(**{part: {**BASE.as_dict()[part], **other}})


@pytest.mark.parametrize(
    "data",
    [
        pytest.param({}, id="empty"),
        pytest.param("scene", id="a word"),
        pytest.param(stored(mechanism="abc"), id="mechanism a word"),
        pytest.param(stored(mechanism={}), id="mechanism of no kind"),
        pytest.param(stored_part("mechanism", kind="slider-crank"), id="another kind"),
        pytest.param(stored(origins={"clearance": 1}), id="status a number"),
        pytest.param(stored(bearings=None), id="no bearings"),
        pytest.param(stored(unknown=1), id="unknown field"),
        pytest.param(stored_part("bearings", clearance=None), id="no clearance"),
        pytest.param(stored_part("bearings", friction=math.nan), id="friction nan"),
        pytest.param(stored(name=1), id="a number for a name"),
        pytest.param(stored(wear_updates=1.5), id="one and a half wears"),
        pytest.param(stored(joints=["A"]), id="joints a list"),
        pytest.param(stored(engine="none"), id="unknown engine"),
    ],
)
def test_what_is_no_stored_scene_is_refused_in_one_line(data: Any) -> None:
    with pytest.raises(InputError) as refusal:
        Scene.from_dict(data)
    assert len(str(refusal.value).splitlines()) == 1


def test_bearings_by_joint_open_those_joints() -> None:
    """A mapping is the same scene as joints, a common bearing and those apart."""
    one, other = Bearing(clearance=0.2e-3), Bearing(clearance=0.3e-3, friction=0.1)
    scene = Scene(bearings={"A": one, "C": other})
    assert scene == Scene(joints="AC", bearings=one, joint_bearings={"C": other})
    assert scene.bearing("C") == other
    assert Scene(bearings={"C": other}).clearance_joints == ("C",)
    assert Scene(bearings={}, wear_updates=0).clearance_joints == ()
    assert Scene.from_dict(scene.as_dict()) == scene
    with pytest.raises(InputError, match="unknown joint in bearings 'D'"):
        Scene(bearings={"D": one})


def test_materials_set_the_wear_of_both_sides() -> None:
    """A pair by name, and single values on top of it."""
    scene = changed(BASE, {"materials": "nitrided-304L", "C.materials": "paper"})
    law = scene.bearing("A").materials
    assert law.wear_coefficient == pytest.approx(70.1e-15)
    assert law.wear_coefficient * (1.0 - law.bearing_share) == pytest.approx(0.1e-15)
    assert scene.bearing("C") == BASE.bearing("C")
    own = changed(scene, {"wear_coefficient": "1e-15/Pa"}).bearing("A").materials
    assert (own.name, own.bearing_share) == ("custom", law.bearing_share)
    assert Scene.from_dict(scene.as_dict()) == scene
    assert Bearing(materials="chromed-304L").materials.wear_coefficient == pytest.approx(50.1e-15)
    with pytest.raises(InputError, match="did you mean chromed-304L"):
        Bearing(materials="chrome-304L")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"normal_law": "flores", "restitution": "0"}, "allowed is 0.01 to 1"),
        ({"viscous_damping": "10N s/m"}, "with normal_law = 'lankarani-nikravesh' allowed is 0"),
        ({"elasticity": "liu", "exponent": "1.2"}, "allowed is 1.5"),
        ({"normal_law": "hunt-crosley"}, "did you mean hunt-crossley"),
        ({"A.friction_law": "stribeck.py:f"}, "A.friction_law = 'stribeck.py:f': there is no file"),
    ],
)
def test_laws_that_do_not_fit_are_refused(settings: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        changed(BASE, settings)


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ({}, 1e-5),
        ({"tolerance": 0.01}, 1e-6),
        ({"tolerance": 1.0}, 1e-5),
        ({"wear_updates": 0}, 1e-8),
        ({"purpose": "trajectory"}, 1e-8),
        ({"purpose": "forces"}, 1e-6),
        ({"purpose": "wear", "wear_updates": 0}, 1e-5),
    ],
)
def test_a_tolerance_that_is_not_given_follows_from_what_the_numbers_are_for(
    settings: dict[str, Any], tolerance: float
) -> None:
    scene = replace(BASE, **settings)
    assert isinstance(scene.solver, ExudynTree)
    assert scene.solver.tree_tolerance == pytest.approx(tolerance)
    given = replace(scene, numerics=Numerics().having(tree_tolerance=1e-8)).solver
    assert isinstance(given, ExudynTree)
    assert given.tree_tolerance == 1e-8


def test_ideal_slider_is_the_closed_form() -> None:
    scene = wear_times()
    slider = scene.ideal_slider(np.linspace(0.0, scene.mechanism.period, 2001))
    assert slider[0, 0] == 0.0
    assert slider[:, 0].max() == pytest.approx(0.1061, abs=1e-4)
    assert slider[:, 1].min() == pytest.approx(-0.889, abs=1e-3)
    assert slider[:, 2].min() == pytest.approx(-20.0, abs=0.1)
