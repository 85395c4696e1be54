"""Scenes from files: those that ``presswear new`` writes, and any other text."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from presswear.campaign.campaign import run
from presswear.engines.settings import InHouse
from presswear.scene.catalog import wear_times
from presswear.scene.files import EXAMPLES, example_file, scene_from
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction


@pytest.mark.parametrize("kind", EXAMPLES)
def test_every_example_is_a_scene_and_keeps_all(kind: str, tmp_path: Path) -> None:
    file = tmp_path / "my-own.toml"
    file.write_text(example_file(kind))
    scene = scene_from(file)
    mechanism, joints = EXAMPLES[kind]
    assert scene.name == "my-own"
    assert scene.mechanism == mechanism.linkage()
    assert scene.clearance_joints == tuple(joints.split(","))
    assert scene.bearings.clearance == 0.3e-3
    assert Scene.from_dict(scene.as_dict()) == scene
    assert scene.origins["clearance"] == "set by the user, in the file"
    assert scene.origins["restitution"] == "default"


def test_the_press_from_a_file_is_the_named_one_bit_for_bit(tmp_path: Path) -> None:
    file = tmp_path / "press.toml"
    file.write_text(example_file("press"))
    named = replace(wear_times(), engine=InHouse.word, cycles=1, wear_updates=0)
    read = replace(named, mechanism=scene_from(file).mechanism, joints="A,C")
    one, other = (run(scene).stages[0].arrays for scene in (named, read))
    assert one.keys() == other.keys()
    assert all(array.tobytes() == other[name].tobytes() for name, array in one.items())


LAW = "def rub(sliding, normal):\n    return -normal * sliding\n"
FRICTION = "mechanism = 'press'\n[settings]\nC.friction_law = "


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "mechanism: the name of one or a table"),
        ("mechanism = 'pres'", "unknown mechanism 'pres'; did you mean press"),
        ("mechanism = 'press'\nsetings = 1", "unknown key 'setings'; did you mean settings"),
        ("mechanism = 'press'\n[settings]\nclearence = '1 mm'", "did you mean clearance"),
        ("mechanism = 'press'\n[settings]\nclearance = 0.001", "clearance = '0.001' has no unit"),
        ("mechanism = 'press'\n[settings]\nwear_updates = true", "a text or a number is expected"),
        ("mechanism = 'press'\nsettings = 1", "settings = 1: a table is expected"),
        ("mechanism = 'press'\ntitle = 1", "title = 1: a text is expected"),
        ("[mechanism", "Expected ']' at the end of a table"),
        ("mechanism = 'press'\nmechanism = 'press'", "Cannot overwrite a value"),
        # A law stands beside the file of the scene.
        (f"{FRICTION}'laws.py:rob'", "friction_law.*did you mean rub"),
        (f"{FRICTION}'law.py:rub'", "friction_law.*there is no file"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "laws.py").write_text(LAW)
    file = tmp_path / "wrong.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=f"^{re.escape(str(file))}: .*{message}") as refusal:
        scene_from(file)
    assert "\n" not in str(refusal.value)


LOADS = """
[[mechanism.loads]]
point = "rocker.head"
direction = "30 deg"
law.kind = "over-position"
law.table = [["-20 mm", "0 N"], ["0 mm", "-0.1 kN"], ["10 mm", "-50 N"]]
law.sense = "along"
law.release = true
[[mechanism.loads]]
body = "crank"
law.kind = "over-position"
law.table = [["0 deg", "0 N m"], ["90 deg", "0.1 N m"]]
law.outside = "hold"
[[mechanism.loads]]
body = "rocker"
law = { kind = "over-time", table = [["0 s", "0 N m"], ["10 ms", "0.1 N m"]], period = "20 ms" }
"""


def test_a_file_may_hold_loads(tmp_path: Path) -> None:
    file = tmp_path / "loaded.toml"
    file.write_text(f"{example_file('four-bar')}{LOADS}")
    scene = scene_from(file)
    assert [len(getattr(load.law, "table", ())) for load in scene.linkage().live_loads] == [3, 2, 2]
    assert Scene.from_dict(scene.as_dict()) == scene


def test_a_user_law_is_read_from_the_folder_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "laws.py").write_text(LAW)
    file = tmp_path / "mine.toml"
    file.write_text(f"{FRICTION}'laws.py:rub'")
    law = scene_from(file).bearing("C").friction_law
    assert isinstance(law, UserFunction)
    assert law.name == "rub"
