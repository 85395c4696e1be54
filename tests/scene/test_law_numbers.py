"""Numbers of user laws as settings: in a file, on the command line, in a sweep."""

from typing import Any

import pytest
from refusals import refused

import presswear as pw
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import settings_of, used_settings_of
from presswear.scene.settings import changed
from presswear.sweeps.parameters import parse_group
from presswear.tools.compiled_law import compile_function
from presswear.tools.quantities import Quantity
from presswear.tools.user_function import UserFunction

LAWS = """
import math

def fading(depth, ratio: "1 to 1000" = 30.0, coefficient=1e-16, fade: "0.1 um to 1 mm" = 2e-6):
    return coefficient * (1.0 + (ratio - 1.0) * math.exp(-depth / fade))

def plain(sliding, normal, coefficient, width=0.5e-3):
    return -coefficient * normal * math.tanh(sliding / width)

def words(depth, coefficient, fade: "long" = 2e-6):
    return coefficient

def reversed(depth, coefficient, fade: "1 mm to 1 um" = 2e-6):
    return coefficient

def outside(depth, coefficient, fade: "1 um to 1 mm" = 1.0):
    return coefficient

def computed(depth, coefficient, fade=2.0 * 3.0):
    return coefficient
"""
FILE = """
[mechanism]
kind = "slider-crank"
[bearings]
B.wear_law = { law = "laws.py:fading", fade = "3 um" }
friction_law = "laws.py:plain"
"friction_law.width" = 1e-3
"""


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "laws.py").write_text(LAWS)
    file = tmp_path / "scene.toml"
    file.write_text(FILE)
    return pw.scene_from(file)


def values_of(scene: Scene) -> dict[str, Any]:
    settings = {setting.key: setting.value for setting in settings_of(scene)}
    return {key: value for key, value in settings.items() if "_law." in key}


def test_a_file_sets_numbers_of_laws(scene):
    bearing = scene.bearing("B")
    assert isinstance(bearing.wear_law, UserFunction)
    assert bearing.wear_law.values == (("fade", 3e-6),)
    expected = {"friction_law.width": 1e-3, "B.wear_law.ratio": 30.0}
    assert values_of(scene) == expected | {"B.wear_law.fade": 3e-6}
    meaning = setting_of(scene, "B.wear_law.fade").meaning
    assert isinstance(meaning, Quantity)
    assert (meaning.unit, meaning.low, meaning.high) == ("m", 1e-7, 1e-3)
    used = {setting.key for setting in used_settings_of(scene)}
    assert values_of(scene).keys() <= used
    assert Scene.from_dict(scene.as_dict()) == scene
    scene.check_user_laws()


def test_a_value_reaches_the_law_in_python_and_compiled(scene):
    """The numbers ratio and fade may stand before or after parameters of the law."""
    scene = changed(scene, {"B.wear_law.ratio": "7", "B.wear_law.fade": "5 um"})
    law = scene.bearing("B").wear_law
    assert isinstance(law, UserFunction)
    assert law.in_python()(depth=0.0, coefficient=2.0) == 14.0
    kernel = compile_function(law, ("depth", "coefficient"))
    assert kernel(0.0, 2.0) == 14.0
    assert f"{law}".startswith("user law fading(fade = 5e-06, ratio = 7), ")
    fresh = changed(scene, {"B.wear_law": UserFunction("fading", LAWS).trusted()})
    assert values_of(fresh)["B.wear_law.ratio"] == 30.0


def test_a_sweep_varies_a_number(scene):
    group = parse_group(scene, "B.wear_law.fade=1um,2um")
    assert group.values.ravel().tolist() == pytest.approx([1e-6, 2e-6])
    (column,) = group.columns
    assert (column.key, column.unit) == ("B.wear_law.fade", "m")
    for value in (1e-6, 2e-6):
        law = changed(scene, {column.key: column.setting(value)}).bearing("B").wear_law
        assert isinstance(law, UserFunction)
        assert law.values == (("fade", value),)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "B.wear_law.fade",
            "5 mm",
            "B.wear_law.fade = 5 mm: allowed is 0.0001 to 1 mm",
        ),
        (
            "B.wear_law.fode",
            "5 um",
            "unknown key of B.wear_law 'fode'; did you mean fade",
        ),
        ("B.wear_law.fade", "5 s", "unknown unit 's'; known are m"),
        (
            "wear_law.fade",
            "5 um",
            "unknown key 'wear_law.fade'; did you mean B.wear_law",
        ),
        (
            "B.wear_law",
            "words",
            "wear_law.fade: 'long': a range such as '0.1 um to 1 mm'",
        ),
        ("B.wear_law", "reversed", "the first end must be below the second"),
        ("B.wear_law", "outside", "wear_law.fade = 1 m: allowed is 1e-06 to 0.001 m"),
        ("B.wear_law", "computed", r"wear_law.fade = 2.0 \* 3.0: a default must be"),
    ],
)
def test_numbers_that_are_refused(scene, key, value, words, tmp_path):
    if f"def {value}(" in LAWS:
        value = f"{tmp_path / 'laws.py'}:{value}"
    with refused(words):
        changed(scene, {key: value})
