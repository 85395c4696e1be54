"""Changes of settings by their keys, as text with units, and bad input."""

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refused

import presswear as pw
from presswear.linkage.press import GEOMETRIES
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import settings_of
from presswear.scene.settings import changed
from presswear.tools.errors import AssemblyError
from presswear.tools.symbols import SYMBOLS

CRANK = pw.Scene(mechanism=pw.SliderCrank(), joints="B")
PRESS = replace(pw.scenes.wear_times(), name="base", title="a scene")


def test_changed_sets_every_part_and_nothing_else():
    assert changed(PRESS, {}) == PRESS
    values = {
        "speed": "4pi rad/s",
        "hx": "241mm",
        "clearance": "0.6mm",
        "wear_distribution": "arc",
    }
    scene = changed(
        PRESS, {**values, "joints": "C", "wear_updates": "3", "cycles": "7"}
    )
    geometry = replace(GEOMETRIES["standard"], hx=0.241)
    assert scene.mechanism == pw.Press(geometry=geometry, speed=4.0 * math.pi)
    assert scene.bearings == replace(PRESS.bearings, clearance=0.6e-3)
    assert scene.conventions == replace(
        CONVENTIONS["paper"], wear_maps="smoothed", wear_distribution="arc"
    )
    assert scene.clearance_joints == ("C",)
    assert (scene.wear_updates, scene.cycles) == (3, 7)
    crank = changed(
        CRANK, {"crank_length": "60mm", "speed": "3000rpm", "clearance": "0.2mm"}
    )
    assert crank.mechanism == pw.SliderCrank(crank_length=0.06, speed=100.0 * math.pi)
    assert crank.bearings.clearance == 0.2e-3
    assert replace(pw.scenes.wear_times(), name="base", title="a scene") == PRESS


SCENES_BY_NAME = {"press": PRESS, "crank": CRANK, "ideal": pw.scenes.ideal()}
SCENES_BY_NAME["off-centre"] = pw.scenes.press_off_centre()
SCENES_BY_NAME["oiled"] = pw.scenes.slider_crank(
    film="run", viscosity="0.1 Pa s", clearance="50 um", wear_coefficient=1e-16
)
SCENES_BY_NAME["refined"] = pw.scenes.wear_times(conventions="refined")
# Scene, settings, and pattern of the message.
REFUSED = r"""
press | friction_law=grease | friction_law = 'grease': allowed is .*FUNCTION. Not modelled: grease
press | A.bending=1 | unknown key 'A.bending'. Not modelled: bending of links
press | oil=1 | unknown key 'oil'. An oil film has a viscosity
press | clearence=1mm | unknown key 'clearence'; did you mean clearance\?$
press | rod_length=1m | unknown key 'rod_length'
press | Kd=1/Pa | unknown key 'Kd'; did you mean K_d\?$
press | c_f=0.1 friction=0.2 | c_f and friction are the same setting; set one of them
crank | geometry=standard | unknown key 'geometry'; presswear list SCENE --all shows all keys
crank | hx=1m | unknown key 'hx'; presswear list SCENE --all shows all keys
press | geometry=round | geometry = 'round': allowed is one of standard
press | joints= | joints = '': allowed is one of O2, O7, A, .*, none, several together, as O2,O7,A,
press | joints=F | joints = 'F': allowed is one of O2, O7, A, B, C
press | joints=CC | joints = 'CC': allowed is
press | joints=A, | joints = 'A,': allowed is
press | joints=none,A | joints = 'none,A': allowed is
crank | joints=AC | joints = 'AC': allowed is one of O, A, B, guide, none, several together
press | clearance=15mm | clearance = 15 mm: .* below the bearing radius
press | bearing_radius=0.5mm | clearance = 0\.8 mm:
press | contact_stiffness=1e15N/m parallel_rods=2 | stiffness of the contact = 2e\+15 N/m\^n
press | lower_speed=1mm/s | lower_speed = 1 mm/s
press | lower_speed=0.991mm/s | lower_speed = .*allowed is 0 to 0\.01 mm/s below
press | lower_speed=0m/s upper_speed=9e-6m/s | .*allowed is 1e-05 to 1 m/s
press | mass_6=1000kg mass_3=1e-4kg | mass of slider 6 = 1000 kg, mass of rod 3 = 0.0001 kg: allowed
press | length_3=0.1m | .*joint . does not close
press | contact=foundation exponent=1.2 | exponent = 1\.2.*allowed is 1.5
press | joints=none replicates=2 | replicates = 2: allowed is 1 without
press | joints=A engine=exudyn-tree | engine = 'exudyn-tree'.*closes a loop
press | joints=C A.friction=0.1 | A\.friction: joint A has no clearance; jo
press | static_friction=0.5 | .*it needs friction_law = lugre
press | friction_law=lugre bristle_stiffness=2.1e6/m | .*friction = 0.02 allowed is up to 2e\+06 1/m
press | friction_law=lugre bristle_damping=0.09s/m | .*allowed is from 0\.1 s/m, .* within 1 us
press | normal_law=flores restitution=0 | .*allowed is 0.01 to 1
press | viscous_damping=1Ns/m | .*normal_law = 'lankarani-nikravesh' allowed is 0
press | elasticity=liu exponent=1.2 | .*allowed is 1.5
press | normal_law=hunt-crosley | .*did you mean hunt-crossley
press | materials=chrome-304L | .*did you mean chromed-304L
press | A.friction_law=no.py:f | A.friction_law = 'no.py:f': .*no such file
refined | B.clearance=1mm | B.clearance: joint B has no clearance; joints = AC
refined | F.clearance=1mm | unknown joint in F.clearance: 'F'; known are O2, O7, A
refined | geometry.hx=1mm | unknown key 'geometry.hx'; did you mean geometry\?$
refined | A.clearence=1mm | unknown key 'A.clearence'; did you mean A.clearance\?$
refined | A.angles=8 | A\.angles = 8: allowed is 16 to 100000
refined | A.clearance=20mm | A\.clearance = 20 mm: allowed is below the bearing
refined | A.clearance=1 | A\.clearance = '1' has no unit
refined | elasticity=liu | elasticity = liu: .* allowed is auto or foundation.* = 'radial'
refined | A.elasticity=power | A\.elasticity = power: .* new and worn surfaces have one law
refined | A.exponent=1.2 | A\.exponent = 1\.2: with contact = 'foundation'
ideal | process=blank | .*'blank': .*did you mean blanking
ideal | process.force=1N | process\.force: process = none; it needs process = bla
ideal | process=drawing process.snap=1mm | unknown key of process 'snap'; known are .*bottom
ideal | process=drawing process.force=3 | process\.force = '3' has no unit; known are N, kN, MN
ideal | process=blanking process.height=0.2m | process\.height = 200 mm above bottom dead centre of
ideal | process=coining torque_limit=0.01Nm | torque_limit of crank \d = 0\.01 N m: the ideal motion
ideal | servo=dwel | servo = 'dwel': .*did you mean dwell
ideal | servo.part=0.1 | servo\.part: servo = none; it needs servo = dwell, forming, pend
ideal | servo=dwell servo.stroke=80 | servo\.stroke = '80' has no unit
ideal | servo=dwell servo.part=0.6 | servo\.part = 0\.6: allowed is above 0 up to 0\.5
ideal | servo=forming servo.speed=1mm/s | servo\.speed = 1 mm/s: .* allowed is 32\.66
ideal | servo=forming servo.end=7mm | servo\.height = 6 mm: .* end = 7 mm and stroke
off-centre | guide_length=none | length of guide: a guide with clearance needs it; set length
off-centre | guide_width=0.1mm | guide_width = 0\.1 mm: allowed is 1 to 10000 mm
off-centre | guide_width=15mm clearance=8mm | .* = 8 mm: allowed is up to half .*, 7\.5 mm
off-centre | guide_length=30mm clearance=3mm | .* by 300 mm can turn over
off-centre | clearance=200mm | .* = 200 mm: allowed is up to half .*, 150 mm
off-centre | clearance=120mm | .* by 300 mm can turn over
off-centre | elasticity=liu | guide\.elasticity = liu: in a guide allowed is auto or power
off-centre | process.offset=60 | process\.offset = '60' has no unit
off-centre | process.offset=11m | process\.offset = 11 m: allowed is -10 to 10 m
off-centre | joints=none | process\.offset = 60 mm: allowed is 0, because the slider cannot tilt
oiled | viscosity=none | film = run: it needs a viscosity, such as 0.1 Pa s
oiled | viscosity=5e-5Pa·s | film = run: viscosity = 5e-05 Pa s: allowed is from 0.0001 Pa s
oiled | clearance=0.1mm | .*0.1 mm is 10 per mille .* up to 5 per mille, or film = report
oiled | width=2mm | .*width = 2 mm is 0.1 of the diameter .*; allowed is 0.125 to 1
oiled | clearance=0mm | .*with clearance = 0 allowed is report
oiled | friction_law=lugre | .*friction_law = lugre: with film = run allowed is ramp, threlfall
oiled | pressure_exponent=0.8 | .*pressure_exponent = 0.8: with film = run allowed is 1
oiled | wear_distribution=bin | .*film = run: with wear_distribution = bin allowed is report
ideal | motor.inertia=1kgm^2 | motor.inertia: a motor needs a torque
ideal | motor.torque=20Nm | motor: crank 7 follows the time
ideal | servo.damping=1Nms/rad | servo.damping: servo = none
ideal | servo.stiffness=1Nm/rad | servo.stiffness: the servo follows the
ideal | motor.torque=none | motor.torque = none: a motor has a torque, such
ideal | servo=dwell process=blanking torque_limit=5Nm | torque_limit of crank \d = 5 N m: the ideal
"""


@pytest.mark.parametrize("case", REFUSED.strip().splitlines())
def test_a_setting_that_does_not_fit_is_refused(case):
    name, listed, message = case.split(" | ")
    settings = dict(item.split("=", 1) for item in listed.split())
    with refused(f"^{message}"):
        changed(SCENES_BY_NAME[name], settings).check()


def test_a_scene_without_wear_updates_has_no_life():
    """A file with a life also runs on new surfaces."""
    scene = changed(pw.scenes.press_blanking(conventions="refined"), {"life": "limits"})
    for value in ("0", 0):
        assert changed(scene, {"wear_updates": value}).life is None
    with refused(r"wear_updates = 0 does not fit \[life\]: use 1 to 20"):
        changed(scene, {"wear_updates": "0", "life": "limits"})


FACTORS = ["", "mm", "m", "pi rad/s", "GPa", "/Pa", "kg", "m/s", "m/s^2", "kg m^2"]
values = st.text(max_size=20) | st.builds(
    lambda number, factor: f"{number}{factor}",
    st.integers(-10, 10**7) | st.floats() | st.floats(0.0, 2.0),
    st.sampled_from(FACTORS),
)


EDGES = "clearance=1e-20m clearance=1e-300m width=1e-320m length_7=1e-200m length_2=1e-300m "
EDGES += "bearing_radius=1m poisson_ratio=0.5 restitution=1 upper_speed=1e-4m/s side_bd=0.023m "
EDGES += "angles=16 cycles=none"


@pytest.mark.parametrize("edge", EDGES.split())
def test_an_edge_of_a_range_makes_a_usable_scene_or_one_line(edge):
    key, _, text = edge.partition("=")
    _use_or_refuse(key, text)


@given(st.sampled_from(sorted(setting.key for setting in settings_of(PRESS))), values)
@pytest.mark.filterwarnings("error")
def test_any_text_makes_a_usable_scene_or_one_line(key, text):
    _use_or_refuse(key, text)


def _use_or_refuse(key: str, text: str) -> None:
    sides = dict.fromkeys(("side_bd", "side_bc", "side_cd"), "plate 4")
    names = key, {"bearing_radius": "bearing radius", **sides}.get(key, key)
    for conventions in CONVENTIONS.values():
        refusal: pw.InputError | None = None
        try:
            scene = changed(replace(PRESS, conventions=conventions), {key: text})
            scene.check()
        except pw.InputError as error:
            refusal = error
        if refusal is None:
            _use(scene)
            continue
        assert len(str(refusal).splitlines()) == 1
        is_named = any(name in str(refusal) for name in names)
        assert is_named or (
            isinstance(refusal, AssemblyError) and "joint" in str(refusal)
        )


def _use(scene: pw.Scene) -> None:
    for joint in scene.linkage().clearances:
        for value in (joint.normal.stiffness, joint.pin_radius, joint.width):
            assert math.isfinite(value)
            assert value > 0.0
    assert scene.numerics.joints.longest(scene.mechanism.period) > 0.0
    start = scene.ideal.at(np.zeros(1))
    for level in (start.position, start.velocity, start.acceleration):
        assert all(math.isfinite(value) for value in level[0])
    assert (
        pw.Scene.from_dict(json.loads(json.dumps(scene.as_dict(), allow_nan=False)))
        == scene
    )


def test_a_joint_can_have_other_values():
    scene = changed(
        pw.scenes.wear_times(), {"A.clearance": "0.2mm", "C.friction": "0.05"}
    )
    gaps = {joint.name: joint.clearance for joint in scene.linkage().clearances}
    frictions = {
        joint.name: joint.friction.coefficient for joint in scene.linkage().clearances
    }
    assert gaps == {"A": 0.2e-3, "C": 0.8e-3}
    assert frictions == {"A": 0.02, "C": 0.05}
    values = {
        setting.key: setting.value
        for setting in settings_of(scene)
        if "." in setting.key
    }
    assert values == {"A.clearance": 0.2e-3, "C.friction": 0.05}
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    # Without the name of a joint a key means all joints.
    every = changed(scene, {"clearance": "0.5mm"})
    assert {joint.clearance for joint in every.linkage().clearances} == {0.5e-3}
    assert every.bearing("C").friction == 0.05
    # A joint with the common values has no entry.
    assert not changed(every, {"friction": "0.05"}).joint_bearings


def test_symbols_of_the_paper_are_names_of_settings():
    keys = {setting.key for setting in settings_of(PRESS)}
    assert set(SYMBOLS.values()) <= keys
    scene = changed(
        PRESS, {"omega": "60 spm", "K_d": "2e-15 1/Pa", "A.c_f": "5 %", "E": "210 GPa"}
    )
    names = {"speed": 2.0 * math.pi, "wear_coefficient": 2e-15, "A.friction": 0.05}
    assert scene == changed(PRESS, names | {"youngs_modulus": 210e9})
    assert setting_of(scene, "A.c_f").key == "A.friction"


def test_constructors_take_numbers_with_units():
    face: Any = pw  # annotations promise floats, which texts become
    bar = face.Bar("crank", length="50 mm", mass="300 g")
    assert bar == face.Bar("crank", 0.05, 0.3)
    assert face.Drive("crank", speed="300 spm") == face.Drive("crank", 10.0 * math.pi)
    bearing = face.Bearing(clearance="0.5 mm", friction="5 %")
    assert (bearing.clearance, bearing.friction) == (0.5e-3, 0.05)
    assert face.Press(mass_6="0.5 t").mass_6 == 500.0
    with refused("length of crank = '50' has no unit"):
        face.Bar("crank", length="50", mass="300 g")
    with refused("speed of crank = '1,5 Hz': use a decimal point"):
        face.Drive("crank", speed="1,5 Hz")


def test_a_key_may_have_the_table_of_a_file_before_it():
    base = pw.scenes.slider_crank()
    scene = changed(base, {"bearings.B.clearance": "0.1 mm", "settings.cycles": "7"})
    assert (scene.bearing("B").clearance, scene.cycles) == (1e-4, 7)
    with refused(r"did you mean B\.clearance"):
        changed(base, {"bearings.B.clearence": "0.1 mm"})


def test_a_diametral_clearance_is_halved(tmp_path):
    assert pw.Bearing(diametral_clearance="0.2 mm") == pw.Bearing(clearance=1e-4)
    assert replace(pw.Bearing(diametral_clearance=2e-4), width=0.03).clearance == 1e-4
    assert pw.scenes.wear_times(diametral_clearance="0.4 mm").bearings.clearance == 2e-4
    scene = pw.Scene(pw.FourBar(), bearings={"B": {"diametral_clearance": "0.6 mm"}})
    assert scene.bearing("B").clearance == 3e-4
    assert (
        pw.changed(scene, {"B.diametral_clearance": "0.2 mm"}).bearing("B").clearance
        == 1e-4
    )
    file = tmp_path / "press.toml"
    tables = '[mechanism]\nkind = "press"\n[bearings]\ndiametral_clearance = "0.5 mm"\n'
    file.write_text(tables + 'C.diametral_clearance = "0.2 mm"\n')
    scene = pw.scene_from(file)
    assert [scene.bearing(joint).clearance for joint in "AC"] == [2.5e-4, 1e-4]
    for settings, message in (
        ({"diametral_clearance": "-1 mm"}, "diametral_clearance = -1 mm: allowed is"),
        ({"diametral_clearance": "5"}, "diametral_clearance = '5' has no unit"),
        (
            {"c": "1 mm", "diametral_clearance": "1 mm"},
            "c and diametral_clearance are the same",
        ),
    ):
        with refused(message):
            pw.changed(scene, settings)
    # A word that resembles it does not advise the radial one, half of it.
    for key, meant in (
        ("diameter_clearance", "diametral_clearance"),
        ("A.diametral_clearence", r"A\.diametral_clearance"),
    ):
        with refused(rf"did you mean {meant}\?"):
            pw.changed(pw.scenes.wear_times(), {key: "0.4 mm"})
    with refused(r"use A\.clearance, which is half the diametral"):
        setting_of(scene, "A.diametral_clearance")


def test_a_motor_begins_with_its_torque():
    """The servo of crank 7 beside it turns at a constant speed."""
    keys = {
        "motor.torque": "20 N m",
        "motor.inertia": "0.25 kg m^2",
        "servo.stiffness": "100 kN m/rad",
    }
    scene = changed(pw.scenes.ideal(), keys)
    leader, follower = scene.linkage().drives
    assert leader.motor == pw.Motor(20.0, inertia=0.25)
    assert follower.motor == pw.Motor(stiffness=1e5)
    assert pw.Scene.from_dict(scene.as_dict()) == scene
