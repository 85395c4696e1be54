"""Settings as text: what they change, what is refused and how, for any text at all."""

import json
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import presswear as pw
from presswear.linkage.mechanisms import GEOMETRIES, Press, SliderCrank
from presswear.scene.bearing import CONVENTIONS, Conventions
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import AssemblyError, InputError
from presswear.tools.quantities import Quantity

PRESS = Scene(name="base", title="a scene")
CRANK = Scene(mechanism=SliderCrank(), joints="B")


def _described(scene: Scene, key: str) -> str:
    return next(s.described() for s in settings_of(scene) if s.key == key)


@pytest.mark.parametrize("scene", [PRESS, CRANK], ids=["press", "slider-crank"])
def test_settings_have_one_key_and_describe_themselves_in_one_line(scene: Scene) -> None:
    settings = list(settings_of(scene))
    assert len({setting.key for setting in settings}) == len(settings)
    assert all(len(setting.described().splitlines()) == 1 for setting in settings)
    assert "0.0008 m" in _described(scene, "clearance")
    others = "A | C | none | several, as AC", "A | B | none | several, as AB"
    assert f"({others[scene is CRANK]})" in _described(scene, "joints")


def test_where_a_value_comes_from_follows_it() -> None:
    assert "; paper, per study)" in _described(PRESS, "clearance")
    scene = slider_crank()
    meanings = [s.meaning for s in settings_of(scene) if isinstance(s.meaning, Quantity)]
    assert meanings
    assert not [meaning for meaning in meanings if "paper" in meaning.origin]
    assert "; literature, from memory)" in _described(scene, "clearance")
    scene = changed(scene, {"clearance": "0.4mm"})
    assert "; set by the user)" in _described(scene, "clearance")
    assert "; literature, from memory)" in _described(scene, "bearing_radius")


def test_changed_sets_every_part_and_nothing_else() -> None:
    assert changed(PRESS, {}) == PRESS
    values = {"speed": "4pi rad/s", "hx": "241mm", "clearance": "0.6mm", "wear_distribution": "arc"}
    scene = changed(PRESS, {**values, "joints": "C", "wear_updates": "3", "cycles": "7"})
    geometry = replace(GEOMETRIES["standard"], hx=0.241)
    assert scene.mechanism == Press(geometry=geometry, speed=4.0 * math.pi)
    assert scene.bearings == replace(PRESS.bearings, clearance=0.6e-3)
    assert scene.conventions == replace(Conventions(), wear_distribution="arc")
    assert scene.clearance_joints == ("C",)
    assert (scene.wear_updates, scene.cycles) == (3, 7)
    crank = changed(CRANK, {"crank_length": "60mm", "speed": "3000rpm", "clearance": "0.2mm"})
    assert crank.mechanism == SliderCrank(crank_length=0.06, speed=100.0 * math.pi)
    assert crank.bearings.clearance == 0.2e-3
    assert Scene(name="base", title="a scene") == PRESS


@pytest.mark.parametrize(
    ("scene", "settings", "says"),
    [
        (
            PRESS,
            {"clearence": "1mm"},
            r"unknown key 'clearence'; did you mean clearance\?; known are ",
        ),
        (PRESS, {"rod_length": "1m"}, "unknown key 'rod_length'"),
        (CRANK, {"geometry": "standard"}, "unknown key 'geometry'.*; known are .*rod_length"),
        (CRANK, {"hx": "1m"}, "unknown key 'hx'.*; known are .*rod_length"),
        (PRESS, {"geometry": "round"}, "geometry = 'round': allowed is one of standard"),
        *(
            (scene, {"joints": word}, f"joints = '{word}': allowed is one of {allowed}($|; did)")
            for scene, words, allowed in (
                (PRESS, ("B", "CC", ""), "A, C, none, several, as AC"),
                (CRANK, ("AC", "O"), "A, B, none, several, as AB"),
            )
            for word in words
        ),
        (PRESS, {"clearance": "15mm"}, r"clearance = 0\.015 m: .* below the bearing radius"),
        (PRESS, {"bearing_radius": "0.5mm"}, r"clearance = 0\.0008 m"),
        (PRESS, {"lower_speed": "1mm/s"}, r"lower_speed = 0\.001 m/s"),
        (PRESS, {"lower_speed": "0.991mm/s"}, "lower_speed = .*allowed is 0 to 1e-05 m/s below"),
        (PRESS, {"lower_speed": "0m/s", "upper_speed": "9e-6m/s"}, ".*allowed is 1e-05 to 1 m/s"),
        (
            PRESS,
            {"mass_6": "1000kg", "mass_3": "1e-4kg"},
            "mass of slider 6 = 1000 kg beside mass of rod 3 = 0.0001 kg: allowed is",
        ),
        (
            CRANK,
            {"slider_mass": "1000kg", "rod_mass": "1e-4kg"},
            "mass of slider = 1000 kg beside mass of rod = 0.0001 kg: allowed is",
        ),
        (PRESS, {"length_3": "0.1m"}, ".*joint . does not close"),
        (
            PRESS,
            {"contact": "foundation", "exponent": "1.2"},
            r"exponent = 1\.2.*allowed is 1.5",
        ),
        (PRESS, {"joints": "none", "replicates": "2"}, "replicates = 2: without a clearance joint"),
        (PRESS, {"joints": "A", "engine": "exudyn-tree"}, "engine = 'exudyn-tree'.*closes a loop"),
    ],
)
def test_what_names_nothing_or_does_not_fit_together_is_refused(
    scene: Scene, settings: Mapping[str, str], says: str
) -> None:
    with pytest.raises(InputError, match=f"^{says}"):
        changed(scene, settings).check()


FACTORS = ["", "mm", "m", "pi rad/s", "GPa", "/Pa", "kg", "m/s", "m/s^2", "kg m^2"]
values = st.text(max_size=20) | st.builds(
    lambda number, factor: f"{number}{factor}",
    st.integers(-10, 10**7) | st.floats() | st.floats(0.0, 2.0),
    st.sampled_from(FACTORS),
)


@given(st.sampled_from(sorted(setting.key for setting in settings_of(PRESS))), values)
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
        _use_or_refuse(replace(PRESS, conventions=conventions), key, text)


def _use_or_refuse(base: Scene, key: str, text: str) -> None:
    refusal: InputError | None = None
    try:
        scene = changed(base, {key: text})
        scene.check()
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
    other = {"bearing_radius": "bearing radius"} | dict.fromkeys(
        ("side_bd", "side_bc", "side_cd"), "plate 4"
    )
    return key in str(refusal) or other.get(key, key) in str(refusal)


def _use(scene: Scene) -> None:
    """Everything that is made of a scene before it runs is finite, and it can be stored."""
    for joint in scene.linkage().clearances:
        for value in (joint.normal.stiffness, joint.pin_radius, joint.width):
            assert math.isfinite(value)
            assert value > 0.0
    assert scene.numerics.joints.longest(scene.mechanism.period) > 0.0
    start = scene.ideal.at(np.zeros(1))
    for level in (start.position, start.velocity, start.acceleration):
        assert all(math.isfinite(value) for value in level[0])
    assert Scene.from_dict(json.loads(json.dumps(scene.as_dict(), allow_nan=False))) == scene


def test_one_joint_can_be_set_apart() -> None:
    scene = changed(wear_times(), {"A.clearance": "0.2mm", "C.friction": "0.05"})
    gaps = {joint.name: joint.clearance for joint in scene.linkage().clearances}
    frictions = {joint.name: joint.friction.coefficient for joint in scene.linkage().clearances}
    assert gaps == {"A": 0.2e-3, "C": 0.8e-3}
    assert frictions == {"A": 0.02, "C": 0.05}
    told = {setting.key: setting for setting in settings_of(scene) if "." in setting.key}
    assert {key: setting.value for key, setting in told.items()} == {
        "A.clearance": 0.2e-3,
        "C.friction": 0.05,
    }
    assert Scene.from_dict(scene.as_dict()) == scene
    # Without a joint's name it means all of them.
    every = changed(scene, {"clearance": "0.5mm"})
    assert {joint.clearance for joint in every.linkage().clearances} == {0.5e-3}
    assert every.bearing("C").friction == 0.05
    # What is alike is not apart.
    assert not changed(every, {"friction": "0.05"}).joint_bearings


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("B.clearance", "1mm", "unknown joint in B.clearance 'B'"),
        ("geometry.hx", "1mm", "unknown joint in geometry.hx 'geometry'"),
        ("A.clearence", "1mm", "unknown key of a joint in A.clearence 'clearence'; did you mean"),
        ("A.angles", "8", r"A\.angles = 8: allowed is 16 to 100000"),
        ("A.clearance", "20mm", r"A\.clearance = 0\.02 m: allowed is .* below the bearing"),
        ("A.clearance", "1", r"A\.clearance = '1' has no unit"),
        ("A.exponent", "1.2", r"A\.exponent = 1\.2: with contact = 'foundation'"),
    ],
)
def test_what_does_not_fit_one_joint_is_told_with_its_name(key: str, value: str, says: str) -> None:
    with pytest.raises(InputError, match=f"^{says}"):
        changed(wear_times(), {"conventions": "refined", key: value})


def test_a_named_law_replaces_one_of_ones_own(tmp_path: Path) -> None:
    """And the other way round; what joints without clearance are set to is refused."""
    (tmp_path / "laws.py").write_text("def soft(penetration):\n    return 1e9 * penetration\n")
    own = changed(PRESS, {"normal_law": f"{tmp_path}/laws.py:soft", "C.normal_law": "flores"})
    assert str(own.bearing("A").normal_law).startswith("user law soft")
    assert own.bearing("C").normal_law == "flores"
    assert changed(own, {"normal_law": "gonthier"}).bearing("A").normal_law == "gonthier"
    with pytest.raises(InputError, match=r"A\.friction: joint A has no clearance; joints = C"):
        changed(PRESS, {"joints": "C", "A.friction": "0.1"})
    with pytest.raises(InputError, match="it needs friction_law = lugre"):
        changed(PRESS, {"static_friction": "0.5"})


def test_constructors_take_numbers_with_units() -> None:
    face: Any = pw  # annotations promise floats, which texts become
    bar = face.Bar("crank", length="50 mm", mass="300 g")
    assert bar == face.Bar("crank", 0.05, 0.3)
    assert face.Drive("crank", speed="300 spm") == face.Drive("crank", 10.0 * math.pi)
    bearing = face.Bearing(clearance="0.5 mm", friction="5 %")
    assert (bearing.clearance, bearing.friction) == (0.5e-3, 0.05)
    assert face.Press(mass_6="0.5 t").mass_6 == 500.0
    with pytest.raises(InputError, match="length of crank = '50' has no unit"):
        face.Bar("crank", length="50", mass="300 g")
    with pytest.raises(InputError, match="speed of crank = '1,5 Hz': use a decimal point"):
        face.Drive("crank", speed="1,5 Hz")
