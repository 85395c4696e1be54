"""List of settings: keys, values in units of engineers, origins, settings that are not read."""

from dataclasses import replace
from typing import Any

import pytest

import presswear as pw
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import applicable_settings_of, settings_of
from presswear.scene.settings import changed
from presswear.tools.quantities import Quantity, parse_quantity

PRESS = replace(pw.scenes.wear_times(), name="base", title="a scene")
CRANK = pw.Scene(mechanism=pw.SliderCrank(), joints="B")


def _described(scene: pw.Scene, key: str) -> str:
    return next(s.described() for s in settings_of(scene) if s.key == key)


@pytest.mark.parametrize("scene", [PRESS, CRANK], ids=["press", "slider-crank"])
def test_settings_have_one_key_and_describe_themselves_in_one_line(scene):
    settings = list(settings_of(scene))
    assert len({setting.key for setting in settings}) == len(settings)
    assert all(len(setting.described().splitlines()) == 1 for setting in settings)
    clearance = "0.3 mm " if scene is CRANK else "0.8 mm "
    assert _described(scene, "clearance").startswith(clearance)
    joints = (
        "O | A | B | guide" if scene is CRANK else "O2 | O7 | A | B | C | D | E | guide"
    )
    assert f"({joints} | none | several together, as " in _described(scene, "joints")
    assert "none  (none | blanking | drawing | coining)" in _described(scene, "process")


@pytest.mark.parametrize("scene", [PRESS, CRANK, pw.scenes.press_blanking()])
def test_described_values_are_in_units_of_engineers_and_can_be_set(scene):
    assert _described(PRESS, "clearance").startswith("0.8 mm  (0 to 1000 mm;")
    assert _described(PRESS, "speed").startswith("105 rpm  (0.1 to 1200 rpm;")
    assert _described(PRESS, "youngs_modulus").startswith("200 GPa  (1 to 1000 GPa;")
    assert "(0 to 1 mm^3/(N m);" in _described(PRESS, "wear_coefficient")
    for setting in settings_of(scene):
        if not isinstance(setting.meaning, Quantity):
            continue
        text = setting.described().partition("  (")[0]
        if setting.value is None:
            assert (
                setting_of(changed(scene, {setting.key: text}), setting.key).value
                is None
            )
        else:
            assert parse_quantity("x", text, setting.meaning) == pytest.approx(
                setting.value, 1e-4
            )


def test_where_a_value_comes_from_follows_it():
    assert "; paper, per study)" in _described(PRESS, "clearance")
    scene = pw.scenes.slider_crank()
    meanings = [
        s.meaning for s in settings_of(scene) if isinstance(s.meaning, Quantity)
    ]
    assert meanings
    assert not [meaning for meaning in meanings if "paper" in meaning.origin]
    assert "; literature, from memory)" in _described(scene, "clearance")
    scene = changed(scene, {"clearance": "0.4mm"})
    assert "; set by the user)" in _described(scene, "clearance")
    assert "; literature, from memory)" in _described(scene, "bearing_radius")


def test_keys_that_nothing_reads_are_not_listed():
    """Of a rigid frame, a guide without clearance, an exact servo and the limit of a motor."""

    def keys(mechanism: Any, **settings: Any) -> set[str]:
        scene = pw.Scene(mechanism, **settings)
        return {setting.key for setting in applicable_settings_of(scene)}

    rigid = keys(pw.SliderCrank())
    frame = {"frame_mass", "frame_damping"}
    guide = {"guide_length", "guide_width"}
    assert not (frame | guide) & rigid
    assert {"frame_stiffness", "torque_limit"} <= rigid
    motor = pw.Motor(20.0)
    elastic = pw.SliderCrank(frame_mass=10.0, frame_stiffness=1e6, motor=motor)
    assert frame <= keys(elastic)
    assert "torque_limit" not in keys(elastic)
    assert guide <= keys(
        pw.SliderCrank(guide_length=0.1, guide_width=0.1),
        bearings={"guide": pw.Bearing(1e-4)},
    )
    exact = keys(pw.Press(servo=pw.linkage.Dwell()))
    assert "servo.stiffness" in exact
    assert "servo.damping" not in exact
    servo = pw.linkage.Dwell(stiffness=1e4)
    assert {"servo.damping", "torque_limit"} <= keys(pw.Press(motor=motor, servo=servo))
