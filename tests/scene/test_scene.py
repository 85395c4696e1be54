"""Scenes: settings as text, storage, and what does not fit together."""

import json
import math
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.laws import hertz_stiffness
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.slider_crank import SliderCrank
from presswear.scene.catalog import SCENES, scene_named, slider_crank, wear_times
from presswear.scene.scene import (
    CONVENTIONS,
    Bearings,
    Conventions,
    Numerics,
    Scene,
    joint_words,
)
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import AssemblyError, InputError
from presswear.tools.quantities import Choice

BASE = Scene("base", "a scene")
OTHER = Scene("other", "a slider-crank", mechanism=SliderCrank(), joints="B")
SETTINGS = {setting.key: setting for setting in settings_of(BASE)}
scenes = pytest.mark.parametrize("name", list(SCENES))


@pytest.mark.parametrize("scene", [BASE, OTHER], ids=["press", "slider-crank"])
def test_keys_are_unique(scene: Scene) -> None:
    keys = [setting.key for setting in settings_of(scene)]
    assert len(keys) == len(set(keys))


def test_settings_describe_themselves_in_one_line() -> None:
    for setting in SETTINGS.values():
        assert len(setting.described().splitlines()) == 1
    assert "0.0008 m" in SETTINGS["clearance"].described()
    assert "(A | C | AC | none)" in SETTINGS["joints"].described()


def test_changed_sets_every_part() -> None:
    scene = changed(
        BASE,
        {
            "speed": "4pi rad/s",
            "hx": "241mm",
            "clearance": "0.6mm",
            "footprint": "arc",
            "joints": "C",
            "wears": "3",
            "cycles": "7",
        },
    )
    assert scene.mechanism.speed == 4.0 * math.pi
    assert isinstance(scene.mechanism, Press)
    assert scene.mechanism.geometry.hx == 0.241
    assert scene.mechanism.geometry.name == "standard, changed"
    assert scene.bearings.clearance == 0.6e-3
    assert scene.conventions == replace(Conventions(), footprint="arc")
    assert scene.clearance_joints == ("C",)
    assert (scene.wears, scene.cycles) == (3, 7)
    # Nothing else.
    assert replace(scene.bearings, clearance=0.8e-3) == BASE.bearings
    assert Scene("base", "a scene") == BASE


def test_changed_without_settings_changes_nothing() -> None:
    assert changed(BASE, {}) == BASE


@pytest.mark.parametrize("name", list(GEOMETRIES))
def test_every_geometry_can_be_named(name: str) -> None:
    assert changed(BASE, {"geometry": name}).mechanism == Press(geometry=GEOMETRIES[name])
    moved = changed(BASE, {"hy": f"{GEOMETRIES[name].hy + 1e-4} m", "geometry": name})
    assert isinstance(moved.mechanism, Press)
    assert moved.mechanism.geometry.side_bd == GEOMETRIES[name].side_bd
    assert moved.mechanism.geometry.hy == GEOMETRIES[name].hy + 1e-4
    assert moved.mechanism.geometry.name == f"{name}, changed"


def test_unknown_names_are_refused_with_what_is_known() -> None:
    with pytest.raises(InputError, match=r"key 'clearence'; did you mean clearance\?; known are "):
        changed(BASE, {"clearence": "1mm"})
    with pytest.raises(InputError, match="geometry = 'round': allowed is one of standard"):
        changed(BASE, {"geometry": "round"})
    with pytest.raises(InputError, match="unknown scene 'nothing'; known are ideal"):
        scene_named("nothing")


def test_joints_are_those_of_the_mechanism() -> None:
    assert joint_words(Press()) == {"A": ("A",), "C": ("C",), "AC": ("A", "C"), "none": ()}
    assert list(joint_words(SliderCrank())) == ["A", "B", "AB", "none"]
    for mechanism in (Press(), SliderCrank()):
        for word, names in joint_words(mechanism).items():
            scene = Scene("", "", mechanism=mechanism, joints=word)
            assert tuple(joint.name for joint in scene.linkage().clearances) == names
    assert "(A | B | AB | none)" in _described(OTHER, "joints")


@pytest.mark.parametrize(
    ("scene", "word", "allowed"),
    [
        (BASE, "B", "A, C, AC, none"),
        (BASE, "CA", "A, C, AC, none"),
        (BASE, "", "A, C, AC, none"),
        (OTHER, "AC", "A, B, AB, none"),
        (OTHER, "O", "A, B, AB, none"),
    ],
)
def test_joints_that_stay_closed_are_refused(scene: Scene, word: str, allowed: str) -> None:
    expected = f"joints = '{word}': allowed is one of {allowed}"
    with pytest.raises(InputError, match=f"^{expected}(; did you mean .*)?$"):
        changed(scene, {"joints": word})
    with pytest.raises(InputError, match=f"^{expected}(; did you mean .*)?$"):
        replace(scene, joints=word)


def test_each_mechanism_has_its_own_keys() -> None:
    scene = changed(OTHER, {"crank_length": "60mm", "speed": "3000rpm", "clearance": "0.2mm"})
    assert scene.mechanism == SliderCrank(crank_length=0.06, speed=100.0 * math.pi)
    assert scene.bearings.clearance == 0.2e-3
    for key in ("geometry", "hx", "length_2"):
        with pytest.raises(InputError, match=f"unknown key '{key}'.*; known are .*rod_length"):
            changed(OTHER, {key: "standard"})
    with pytest.raises(InputError, match="unknown key 'rod_length'"):
        changed(BASE, {"rod_length": "1m"})


def _described(scene: Scene, key: str) -> str:
    return next(s.described() for s in settings_of(scene) if s.key == key)


def test_where_a_value_comes_from_follows_it() -> None:
    assert "; paper, per study)" in _described(BASE, "clearance")
    scene = slider_crank()
    assert "; literature, from memory)" in _described(scene, "clearance")
    scene = changed(scene, {"clearance": "0.4mm"})
    assert "; set by the user)" in _described(scene, "clearance")
    assert "; literature, from memory)" in _described(scene, "bearing_radius")
    assert Scene.from_dict(json.loads(json.dumps(scene.as_dict()))) == scene


def test_a_slider_crank_owes_nothing_to_the_paper() -> None:
    statuses = [
        setting.meaning.status
        for setting in settings_of(slider_crank())
        if not isinstance(setting.meaning, Choice)
    ]
    assert statuses
    assert not [status for status in statuses if "paper" in status]


def test_named_scenes_differ_from_the_central_study_as_they_say() -> None:
    for letter in "AC":
        scene = scene_named(f"clearance-{letter.lower()}")
        study = replace(wear_times(), joints=letter, wears=0, cycles=5)
        assert scene == replace(study, name=scene.name, title=scene.title)
        assert f"at {letter} alone" in scene.title


def test_stiffness_of_the_slider_crank_is_the_printed_one() -> None:
    joint = slider_crank().linkage().clearances[0]
    assert joint.name == "B"
    assert f"{joint.normal.stiffness:.2e}" == "6.61e+10"
    assert (joint.bearing.body, joint.pin.body) == ("rod", "slider")


def test_clearance_stays_below_the_bearing_radius() -> None:
    with pytest.raises(InputError, match=r"clearance = 0\.015 m: .* below the bearing radius"):
        changed(BASE, {"clearance": "15mm"})
    with pytest.raises(InputError, match=r"clearance = 0\.0008 m"):
        changed(BASE, {"bearing_radius": "0.5mm"})
    both = changed(BASE, {"clearance": "15mm", "bearing_radius": "16mm"})
    assert both.bearings.bearing_radius - both.bearings.clearance == pytest.approx(1e-3)


def test_friction_speeds_stay_in_order() -> None:
    with pytest.raises(InputError, match=r"lower_speed = 0\.001 m/s"):
        changed(BASE, {"lower_speed": "1mm/s"})


def test_the_ramp_of_friction_is_wide_enough_to_be_followed() -> None:
    close = {"lower_speed": "0.991mm/s", "upper_speed": "1mm/s"}
    with pytest.raises(InputError, match=r"lower_speed = .*allowed is 0 to 1e-05 m/s below"):
        changed(BASE, close)
    changed(BASE, {**close, "lower_speed": "0.99mm/s"})
    with pytest.raises(InputError, match=r"upper_speed = 9e-06 m/s: allowed is 1e-05 to 1 m/s"):
        changed(BASE, {"lower_speed": "0m/s", "upper_speed": "9e-6m/s"})


@pytest.mark.parametrize(
    ("scene", "heavy", "light"), [(BASE, "mass_6", "mass_3"), (OTHER, "slider_mass", "rod_mass")]
)
def test_masses_that_cannot_move_together_are_refused(scene: Scene, heavy: str, light: str) -> None:
    changed(scene, {heavy: "100kg", light: "1.1e-4kg"})
    with pytest.raises(InputError, match=f"^{heavy} = 1000 kg beside {light} = 0.0001 kg: allowed"):
        changed(scene, {heavy: "1000kg", light: "1e-4kg"})


def test_a_stored_scene_that_lost_a_value_is_refused() -> None:
    """What got lost is not today's default."""
    data = json.loads(json.dumps(BASE.as_dict()))
    for part in ("bearings", "numerics", "conventions", "mechanism"):
        for key in data[part]:
            less = {**data, part: {k: v for k, v in data[part].items() if k != key}}
            with pytest.raises(InputError, match=f"'{key}'|missing"):
                Scene.from_dict(less)


def test_a_press_that_does_not_assemble_is_no_scene() -> None:
    with pytest.raises(AssemblyError, match="joint B does not close"):
        changed(BASE, {"length_3": "0.1m"})


FACTORS = ["", "mm", "m", "pi rad/s", "GPa", "/Pa", "kg", "m/s", "m/s^2", "kg m^2"]
values = st.text(max_size=20) | st.builds(
    lambda number, factor: f"{number}{factor}",
    st.integers(-10, 10**7) | st.floats() | st.floats(0.0, 2.0),
    st.sampled_from(FACTORS),
)


@given(st.sampled_from(sorted(SETTINGS)), values)
@example("clearance", "1e-20m")
@example("clearance", "1e-300m")
@example("width", "1e-320m")
@example("length_7", "1e-200m")
@example("length_2", "1e-300m")
@example("bearing_radius", "1m")
@example("poisson_ratio", "0.5")
@example("restitution", "1")
@example("upper_speed", "1e-4m/s")
@example("side_bd", "0.023m")
@example("angles", "16")
@example("cycles", "none")
@pytest.mark.filterwarnings("error")
def test_any_text_makes_a_usable_scene_or_one_line_of_refusal(key: str, text: str) -> None:
    for conventions in CONVENTIONS.values():
        _use_or_refuse(replace(BASE, conventions=conventions), key, text)


@given(st.sampled_from(sorted(setting.key for setting in settings_of(OTHER))), values)
@example("crank_length", "120mm")
@example("crank_length", "119.99mm")
@example("rod_length", "50mm")
@example("rod_length", "1e-3m")
@example("speed", "0 rpm")
@pytest.mark.filterwarnings("error")
def test_any_text_makes_a_usable_slider_crank_or_one_line_of_refusal(key: str, text: str) -> None:
    _use_or_refuse(OTHER, key, text)


def _use_or_refuse(base: Scene, key: str, text: str) -> None:
    refusal: InputError | None = None
    try:
        scene = changed(base, {key: text})
    except InputError as error:
        refusal = error
    if refusal is None:
        _use(scene)
    else:
        assert len(str(refusal).splitlines()) == 1
        assert _names(key, refusal), refusal


def _names(key: str, refusal: InputError) -> bool:
    """Whether a refusal says what is wrong: the key, or the joint or plate it breaks."""
    if isinstance(refusal, AssemblyError):
        return "joint" in str(refusal)
    other = {"bearing_radius": "bearing radius", "side_bd": "plate 4", "side_bc": "plate 4"}
    other["side_cd"] = "plate 4"
    return key in str(refusal) or other.get(key, key) in str(refusal)


def _use(scene: Scene) -> None:
    """Everything that is made of a scene before it runs is finite."""
    for joint in scene.linkage().clearances:
        for value in (joint.normal.stiffness, joint.pin_radius, joint.width):
            assert math.isfinite(value)
            assert value > 0.0
    assert scene.numerics.joints.longest(scene.mechanism.period) > 0.0
    start = scene.mechanism.ideal_motion(np.zeros(1))
    for level in (start.position, start.velocity, start.acceleration):
        assert all(math.isfinite(value) for value in level[0])
    assert Scene.from_dict(json.loads(json.dumps(scene.as_dict()))) == scene


@scenes
def test_named_scenes_survive_storage(name: str) -> None:
    scene = scene_named(name)
    assert Scene.from_dict(scene.as_dict()) == scene
    stored = json.dumps(scene.as_dict(), allow_nan=False)
    assert Scene.from_dict(json.loads(stored)) == scene


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
@pytest.mark.parametrize("conventions", list(CONVENTIONS))
def test_changed_scenes_survive_storage(geometry: str, conventions: str) -> None:
    scene = changed(
        replace(BASE, conventions=CONVENTIONS[conventions]),
        {"geometry": geometry, "clearance": "0.1234567890123456789mm", "cycles": "11"},
    )
    assert Scene.from_dict(json.loads(json.dumps(scene.as_dict()))) == scene


def test_storage_is_not_changed_by_reading() -> None:
    data = BASE.as_dict()
    Scene.from_dict(data)
    assert data == BASE.as_dict()


def _stored(**other: Any) -> dict[str, Any]:
    return {**BASE.as_dict(), **other}


def _stored_part(part: str, **other: Any) -> dict[str, Any]:
    return _stored(**{part: {**BASE.as_dict()[part], **other}})


@pytest.mark.parametrize(
    "data",
    [
        pytest.param({}, id="empty"),
        pytest.param([1, 2], id="a list"),
        pytest.param("scene", id="a word"),
        pytest.param(_stored(mechanism="abc"), id="mechanism a word"),
        pytest.param(_stored(mechanism=[1]), id="mechanism a list"),
        pytest.param(_stored(mechanism={}), id="mechanism of no kind"),
        pytest.param(_stored_part("mechanism", kind="crane"), id="unknown kind"),
        pytest.param(_stored_part("mechanism", kind=["press"]), id="kind a list"),
        pytest.param(_stored_part("mechanism", kind="slider-crank"), id="another kind"),
        pytest.param(_stored(statuses={"clearance": 1}), id="status a number"),
        pytest.param(_stored(statuses="chosen"), id="statuses a word"),
        pytest.param(_stored(bearings=None), id="no bearings"),
        pytest.param(_stored(unknown=1), id="unknown field"),
        pytest.param(_stored_part("bearings", colour=1), id="unknown bearing field"),
        pytest.param(_stored_part("bearings", clearance="0.8mm"), id="a length as text"),
        pytest.param(_stored_part("bearings", clearance=None), id="no clearance"),
        pytest.param(_stored_part("bearings", width=None), id="no width"),
        pytest.param(_stored_part("bearings", friction=math.nan), id="friction nan"),
        pytest.param(_stored_part("bearings", angles=360.5), id="part of a bin"),
        pytest.param(_stored_part("mechanism", geometry="standard"), id="geometry a word"),
        pytest.param(_stored_part("mechanism", speed=None), id="no speed"),
        pytest.param(_stored(wears=None), id="no wears"),
        pytest.param(_stored(wears=1.5), id="one and a half wears"),
        pytest.param(_stored(cycles="many"), id="cycles a word"),
        pytest.param(_stored(joints=["A"]), id="joints a list"),
        pytest.param(_stored(engine="none"), id="unknown engine"),
        pytest.param(_stored_part("conventions", slip="none"), id="unknown slip"),
    ],
)
def test_what_is_no_stored_scene_is_refused_in_one_line(data: Any) -> None:
    with pytest.raises(InputError) as refusal:
        Scene.from_dict(data)
    assert len(str(refusal.value).splitlines()) == 1


def test_scene_makes_the_linkage_it_describes() -> None:
    scene = changed(BASE, {"joints": "A", "friction": "0.05", "restitution": "0.8"})
    linkage = scene.linkage()
    assert [joint.name for joint in linkage.clearances] == ["A"]
    assert "A" not in [joint.name for joint in linkage.revolutes]
    assert "C" in [joint.name for joint in linkage.revolutes]
    joint = linkage.clearances[0]
    assert (joint.bearing.body, joint.pin.body) == ("rod 3", "crank 2")
    assert joint.pin_radius == 0.015 - 0.8e-3
    assert joint.normal.damping == pytest.approx(0.75 * 0.36, rel=1e-14)
    assert joint.friction.coefficient == 0.05
    assert joint.map_frame == "fixed"
    assert joint.wear is not None
    assert (joint.wear.slip, joint.wear.footprint) == ("angle", "bin")
    closed = {r.name: r for r in scene.mechanism.linkage().revolutes}
    assert (joint.bearing, joint.pin) == (closed["A"].first, closed["A"].second)


def test_conventions_reach_the_joint() -> None:
    scene = replace(BASE, conventions=CONVENTIONS["refined"])
    joint = scene.linkage().clearances[0]
    assert joint.map_frame == "body"
    assert joint.wear is not None
    assert (joint.wear.slip, joint.wear.footprint) == ("sliding", "arc")
    refined = hertz_stiffness(0.015, 0.0142, 200e9, 0.3, "refined")
    assert joint.normal.stiffness == pytest.approx(refined, rel=1e-14)


def test_no_wear_coefficient_keeps_no_account() -> None:
    joint = changed(BASE, {"wear_coefficient": "0/Pa"}).linkage().clearances[0]
    assert joint.wear is None


def test_every_convention_is_a_choice_of_its_own() -> None:
    for item in fields(Conventions):
        words = SETTINGS[item.name].meaning
        assert isinstance(words, Choice)
        for word in words.words:
            scene = changed(BASE, {item.name: word})
            assert getattr(scene.conventions, item.name) == word


def test_conventions_are_named_as_described() -> None:
    assert CONVENTIONS["paper"] == Conventions("paper", "angle", "fixed", "bin", "radial")
    assert CONVENTIONS["refined"] == Conventions("refined", "sliding", "body", "arc", "foundation")


def test_a_foundation_needs_the_exponent_of_hertz() -> None:
    steep = replace(BASE, bearings=replace(BASE.bearings, exponent=1.2))
    with pytest.raises(InputError, match=r"exponent = 1\.2.*allowed is 1.5"):
        changed(steep, {"contact": "foundation"})


@pytest.mark.parametrize(
    ("joints", "engine", "solver", "kind"),
    [
        ("AC", "exudyn", "exudyn-tree", ExudynTree),
        ("A", "exudyn", "exudyn-joints", ExudynJoints),
        ("none", "exudyn", "exudyn-joints", ExudynJoints),
        ("AC", "exudyn-joints", "exudyn-joints", ExudynJoints),
        ("AC", "dae", "dae", InHouse),
    ],
)
def test_the_smallest_model_that_fits_is_taken(
    joints: str, engine: str, solver: str, kind: type
) -> None:
    scene = replace(BASE, joints=joints, engine=engine)
    assert scene.solver.word == solver
    assert isinstance(scene.solver, kind)


def test_an_open_tree_is_refused_where_a_loop_is_closed() -> None:
    with pytest.raises(InputError, match=r"engine = 'exudyn-tree'.*closes a loop"):
        replace(BASE, joints="C", engine="exudyn-tree")


def test_steps_follow_the_speed() -> None:
    scene = Scene(
        "fast",
        "",
        mechanism=Press(speed=8.0 * math.pi),
        numerics=Numerics().having(free_steps=5000),
    )
    assert scene.numerics.joints.longest(scene.mechanism.period) == pytest.approx(
        0.25 / 5000, rel=1e-14
    )


def test_defaults_are_the_papers() -> None:
    bearings = Bearings()
    assert (bearings.youngs_modulus, bearings.poisson_ratio) == (200e9, 0.3)
    assert (bearings.restitution, bearings.exponent) == (0.9, 1.5)
    assert (bearings.lower_speed, bearings.upper_speed) == (1e-4, 1e-3)
    assert BASE.mechanism.speed == 3.5 * math.pi
