"""Scenes: the linkage and the engine that they make, and what is stored of them."""

import json
import math
from dataclasses import replace
from typing import Any

import pytest
from four_bar_linkage import FOUR_BAR

from presswear.campaign.campaign import run
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.drives import Drive
from presswear.linkage.elements import Bar, Pin
from presswear.linkage.laws import hertz_stiffness
from presswear.linkage.linkage import assemble
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import Press
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import SCENES, scene_named, wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import used_settings_of
from presswear.scene.settings import changed
from presswear.sweeps.improve import changes_of
from presswear.tools.errors import InputError

BASE = replace(wear_times(), name="base", title="a scene")


def test_joints_are_those_of_the_mechanism() -> None:
    spelled = {"A": "A", "C": "C", "AC": "AC", "A,C": "AC", "CA": "AC", "none": ""}
    for text, names in spelled.items():
        scene = Scene(joints=text)
        assert tuple(joint.name for joint in scene.linkage().clearances) == tuple(names)
        assert scene.joints == (names or "none")
    assert Scene(SliderCrank(), joints="B , A").joints == "AB"
    joints = [replace(joint, name=f"pin {joint.name}") for joint in FOUR_BAR.joints]
    named = FOUR_BAR.changed(joints=joints)
    assert Scene(named, joints="pin B, pin A").clearance_joints == ("pin A", "pin B")
    assert Scene(named, joints="pin P").joints == "pin P"


def test_a_mechanism_has_default_joints_with_clearance() -> None:
    """A user linkage has none; a bearing without a joint is refused."""
    for mechanism, joints in (
        (Press(), "AC"),
        (SliderCrank(), "B"),
        (FOUR_BAR, "none"),
    ):
        scene = Scene(mechanism)
        assert scene == Scene(mechanism, joints=joints)
        assert scene.joints == joints
    assert Scene(Press().linkage()).joints == "none"
    tight = Bearing(clearance=0.2e-3)
    with pytest.raises(
        InputError, match=r"^bearings: no joint has clearance; .* of O, A, B, P$"
    ):
        Scene(FOUR_BAR, bearings=tight)
    assert Scene(FOUR_BAR, bearings=tight, joints="B").clearance_joints == ("B",)
    with pytest.raises(InputError, match="'joints' is missing"):
        Scene.from_dict({**BASE.as_dict(), "joints": None})


def test_scene_makes_the_linkage_it_describes() -> None:
    scene = changed(BASE, {"joints": "A", "friction": "0.05", "restitution": "0.8"})
    linkage = scene.linkage()
    closed = scene.mechanism.linkage()
    (joint,) = linkage.clearances
    assert joint.name == "A"
    assert linkage.revolutes == tuple(r for r in closed.revolutes if r.name != "A")
    (ideal,) = (r for r in closed.revolutes if r.name == "A")
    assert (joint.bearing, joint.pin) == (ideal.first, ideal.second)
    assert (joint.bearing.body, joint.pin.body) == ("rod 3", "crank 2")
    assert joint.pin_radius == 0.015 - 0.8e-3
    assert joint.normal.damping == pytest.approx(0.75 * 0.36, rel=1e-14)
    assert joint.friction.coefficient == 0.05
    assert (
        changed(BASE, {"wear_coefficient": "0/Pa"}).linkage().clearances[0].wear is None
    )


@pytest.mark.parametrize(
    ("conventions", "expected"),
    [
        ("paper", ("fixed", "radial", "angle", "bin")),
        ("refined", ("body", "foundation", "sliding", "arc")),
    ],
)
def test_conventions_reach_the_joint(
    conventions: str, expected: tuple[str, ...]
) -> None:
    joint = replace(BASE, conventions=CONVENTIONS[conventions]).linkage().clearances[0]
    assert joint.wear is not None
    wear = joint.wear
    assert (
        joint.map_frame,
        joint.contact,
        wear.slip,
        wear.wear_distribution,
    ) == expected
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
def test_the_smallest_model_that_fits_is_used(
    joints: str, engine: str, kind: type
) -> None:
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


WRONG: tuple[tuple[str, Any], ...] = (
    *(
        ("mechanism", "abc"),
        ("mechanism", {}),
        ("origins", {"clearance": 1}),
        ("bearings", None),
    ),
    *(
        ("unknown", 1),
        ("name", 1),
        ("wear_updates", 1.5),
        ("joints", ["A"]),
        ("engine", "none"),
    ),
)


def stored(part: str, **changes: Any) -> dict[str, Any]:
    return {**BASE.as_dict(), part: {**BASE.as_dict()[part], **changes}}


@pytest.mark.parametrize(
    "data",
    [
        {},
        "scene",
        *({**BASE.as_dict(), key: value} for key, value in WRONG),
        stored("mechanism", kind="slider-crank"),
        stored("bearings", clearance=None),
        stored("bearings", friction=math.nan),
    ],
)
def test_data_that_are_no_scene_are_refused_in_one_line(data: Any) -> None:
    with pytest.raises(InputError):
        Scene.from_dict(data)


def test_bearings_by_joint_open_those_joints() -> None:
    """A mapping is the same scene as joints, a common bearing and exceptions."""
    one = Bearing(clearance=0.2e-3)
    other = Bearing(clearance=0.3e-3, friction=0.1)
    scene = Scene(bearings={"A": one, "C": other})
    assert scene == Scene(joints="AC", bearings=one, joint_bearings={"C": other})
    assert scene.bearing("C") == other
    assert Scene(bearings={"C": other}).clearance_joints == ("C",)
    assert Scene(bearings={}, wear_updates=0).clearance_joints == ()
    assert Scene.from_dict(scene.as_dict()) == scene
    with pytest.raises(InputError, match="unknown joint in bearings 'F'"):
        Scene(bearings={"F": one})


def test_numbers_that_no_pair_states_stay_with_other_materials() -> None:
    """Running-in and pressure exponent are not dropped by a comparison of materials."""
    law = {
        "running_in": 30.0,
        "running_in_depth": 2e-6,
        "pressure_exponent": 0.7,
        "pressure_reference": 5e6,
        "wear_scatter": 0.3,
    }
    scene = changed(BASE, law)
    assert setting_of(scene, "materials").value == "paper"
    for key in ("materials", "C.materials"):
        pair = changed(scene, {key: "316L-304L"}).bearing("C").materials
        assert pair.wear_coefficient == pytest.approx(15e-15)
        assert {name: getattr(pair, name) for name in law} == law
    names = [change for change in changes_of(BASE) if "materials" in change]
    assert [change for change in changes_of(scene) if "materials" in change] == names
    reset = changed(scene, {"materials": "316L-304L", "running_in": 1.0})
    assert reset.bearing("C").materials.running_in == 1.0


def test_materials_set_the_wear_of_both_sides() -> None:
    scene = changed(BASE, {"materials": "nitrided-304L", "C.materials": "paper"})
    law = scene.bearing("A").materials
    assert law.wear_coefficient == pytest.approx(70.1e-15)
    assert law.wear_coefficient * (1.0 - law.bearing_share) == pytest.approx(0.1e-15)
    assert scene.bearing("C") == BASE.bearing("C")
    custom = changed(scene, {"wear_coefficient": "1e-15/Pa"})
    assert setting_of(custom, "A.materials").value == "custom"
    assert custom.bearing("A").materials.bearing_share == law.bearing_share
    assert Scene.from_dict(scene.as_dict()) == scene
    assert Bearing(
        materials="chromed-304L"
    ).materials.wear_coefficient == pytest.approx(50.1e-15)


@pytest.mark.parametrize(
    ("settings", "tolerance"),
    [
        ({}, 1e-5),
        ({"tolerance": 0.01}, 1e-6),
        ({"tolerance": 1.0}, 1e-5),
        ({"wear_updates": 0}, 1e-6),
        ({"wear_updates": 0, "cycles": 3}, 1e-6),
        ({"wear_updates": 0, "cycles": 2}, 1e-8),
        ({"purpose": "trajectory"}, 1e-8),
        ({"purpose": "forces"}, 1e-6),
        ({"purpose": "wear", "wear_updates": 0}, 1e-5),
    ],
)
def test_purpose_sets_the_default_tolerance(
    settings: dict[str, Any], tolerance: float
) -> None:
    scene = replace(BASE, **settings)
    assert isinstance(scene.solver, ExudynTree)
    assert scene.solver.tree_tolerance == pytest.approx(tolerance)
    solver = changed(scene, {"tree_tolerance": 1e-8}).solver
    assert isinstance(solver, ExudynTree)
    assert solver.tree_tolerance == 1e-8


@pytest.mark.parametrize(
    ("body", "words"),
    [("ram", "the ram"), ("link 7", "link 7"), ("slider 6", "the slider")],
)
def test_the_body_of_the_output_point_has_an_article_unless_it_has_a_number(
    body: str, words: str
) -> None:
    bars = [Bar(body, 0.1, 1.0)]
    pins = [Pin("O", (0.0, 0.0), f"{body}.tail")]
    assert Scene(assemble(bars, pins, [Drive(body, 10.0)])).output == words


@pytest.mark.parametrize(
    ("degrees", "bottom"), [(0, 0.07), (-90, -0.17), (90, 0.07), (-30, -0.17)]
)
def test_bottom_dead_centre_of_a_slider_crank_is_its_lowest_place(
    degrees: float, bottom: float
) -> None:
    """Rod less crank from O where the slider is beside O or above it, and rod and crank below."""
    scene = Scene(SliderCrank(slide_angle=math.radians(degrees)))
    assert scene.stroke == pytest.approx(0.1, rel=1e-9)
    assert scene.bottom == pytest.approx(bottom, rel=1e-9)


def test_wear_updates_need_a_joint_that_wears() -> None:
    scene = changed(BASE, {"wear_coefficient": "0/Pa"})
    with pytest.raises(InputError, match="wear_coefficient = 0: with wear_updates"):
        scene.check()
    changed(scene, {"wear_updates": 0}).check()
    changed(scene, {"A.wear_coefficient": "1e-15/Pa"}).check()


@pytest.mark.parametrize("conventions", ["paper", "refined"])
def test_without_clearance_no_joint_wears_and_one_stage_runs(conventions: Any) -> None:
    scene = Scene(
        SliderCrank(), bearings={}, conventions=conventions, cycles=1, engine="dae"
    )
    assert scene.wear_updates == 0
    assert len(run(scene).stages) == 1


def test_a_bearing_without_clearance_is_a_rigid_joint_that_rubs() -> None:
    rigid = Bearing(clearance=0, friction=0.1, bearing_radius=0.03)
    loose = Bearing()
    scene = Scene(SliderCrank(), bearings={"B": loose, "O": rigid})
    assert scene.joints == "OB"
    assert scene.clearance_joints == ("B",)
    linkage = scene.linkage()
    assert [joint.name for joint in linkage.clearances] == ["B"]
    (joint,) = linkage.rubbing_pins
    assert (joint.name, joint.bearing_radius, joint.friction.coefficient) == (
        "O",
        0.03,
        0.1,
    )
    assert [joint.name for joint in linkage.bushings] == ["B", "O"]
    assert Scene.from_dict(scene.as_dict()) == scene
    used = {setting.key for setting in used_settings_of(scene)}
    assert {"O.friction", "O.bearing_radius"} <= used
    assert not {"O.restitution", "O.angles"} & used
    moved = changed(scene, {"B.clearance": "0 mm", "O.clearance": "0.2 mm"})
    assert moved.clearance_joints == ("O",)
    assert Scene(SliderCrank(), bearings={"O": rigid}).wear_updates == 0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"clearance": 1e-10},
            "clearance = 1e-07 mm: allowed is 0, a rigid joint, or from 1e-06 mm",
        ),
        (
            {"clearance": 0.0, "friction_law": "lugre"},
            "lugre: with clearance = 0 allowed is ramp",
        ),
    ],
)
def test_a_bearing_has_clearance_or_none(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Bearing(**values)
