"""Bearings with other materials, and bearings of rigid joints."""

from dataclasses import replace

import pytest
from refusals import refused

from presswear.linkage.mechanisms import SliderCrank
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import used_settings_of
from presswear.scene.settings import changed
from presswear.sweeps.improve import changes_of

BASE = replace(wear_times(), name="base", title="a scene")


def test_wear_law_stays_with_other_materials():
    """Named materials have no running-in and no pressure exponent: those of the scene stay."""
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


def test_materials_set_the_wear_of_both_sides():
    scene = changed(BASE, {"materials": "nitrided-304L", "C.materials": "paper"})
    law = scene.bearing("A").materials
    assert law.wear_coefficient == pytest.approx(70.1e-15)
    assert law.wear_coefficient * (1.0 - law.bearing_share) == pytest.approx(0.1e-15)
    assert scene.bearing("C") == BASE.bearing("C")
    custom = changed(scene, {"wear_coefficient": "1e-15/Pa"})
    assert setting_of(custom, "A.materials").value == "custom"
    assert custom.bearing("A").materials.bearing_share == law.bearing_share
    assert Scene.from_dict(scene.as_dict()) == scene
    chromed = Bearing(materials="chromed-304L").materials
    assert chromed.wear_coefficient == pytest.approx(50.1e-15)


def test_a_bearing_without_clearance_is_a_rigid_joint_that_rubs():
    rigid = Bearing(clearance=0, friction=0.1, bearing_radius=0.03)
    loose = Bearing()
    scene = Scene(SliderCrank(), bearings={"B": loose, "O": rigid})
    assert scene.joints == "OB"
    assert scene.clearance_joints == ("B",)
    linkage = scene.linkage()
    assert [joint.name for joint in linkage.clearances] == ["B"]
    (joint,) = linkage.rubbing_pins
    assert joint.name == "O"
    assert joint.bearing_radius == 0.03
    assert joint.friction.coefficient == 0.1
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
def test_a_bearing_has_clearance_or_none(values, message):
    with refused(message):
        Bearing(**values)
