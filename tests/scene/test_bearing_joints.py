"""Joints of a scene that have a bearing, with clearance or rigid."""

from dataclasses import replace

from four_bar_linkage import FOUR_BAR
from refusals import refused

from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import Press
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

BASE = replace(wear_times(), name="base", title="a scene")


def test_joints_are_those_of_the_mechanism():
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


def test_a_mechanism_has_default_joints_with_clearance():
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
    with refused(r"^bearings: no joint has clearance; .* of O, A, B, P$"):
        Scene(FOUR_BAR, bearings=tight)
    assert Scene(FOUR_BAR, bearings=tight, joints="B").clearance_joints == ("B",)
    with refused("'joints' is missing"):
        Scene.from_dict({**BASE.as_dict(), "joints": None})


def test_bearings_by_joint_open_those_joints():
    """A mapping is the same scene as joints, a common bearing and exceptions."""
    one = Bearing(clearance=0.2e-3)
    other = Bearing(clearance=0.3e-3, friction=0.1)
    scene = Scene(bearings={"A": one, "C": other})
    assert scene == Scene(joints="AC", bearings=one, joint_bearings={"C": other})
    assert scene.bearing("C") == other
    assert Scene(bearings={"C": other}).clearance_joints == ("C",)
    assert Scene(bearings={}, wear_updates=0).clearance_joints == ()
    assert Scene.from_dict(scene.as_dict()) == scene
    with refused("unknown joint in bearings 'F'"):
        Scene(bearings={"F": one})


def test_wear_updates_need_a_joint_that_wears():
    scene = changed(BASE, {"wear_coefficient": "0/Pa"})
    with refused("wear_coefficient = 0: with wear_updates"):
        scene.check()
    changed(scene, {"wear_updates": 0}).check()
    changed(scene, {"A.wear_coefficient": "1e-15/Pa"}).check()
