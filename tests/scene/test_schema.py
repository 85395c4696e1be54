"""JSON schema of scene files: it accepts what the program reads, and names mistakes."""

import re
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft7Validator

import presswear as pw
from presswear.scene.files import EXAMPLES, example_file, scene_from
from presswear.scene.schema import FILE, scene_schema

SCHEMA = scene_schema()
ROOT = Path(__file__).parents[2]
COMMENTED_SETTING = re.compile(r"^#(?=[a-z\\[])", re.MULTILINE)


def mistakes(text: str) -> list[str]:
    """Return the places of mistakes in a file."""
    errors = Draft7Validator(SCHEMA).iter_errors(tomllib.loads(text))
    return [".".join(map(str, error.path)) for error in errors]


def test_the_schema_is_a_schema_of_draft_7():
    Draft7Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("kind", EXAMPLES)
def test_examples_fit_the_schema_that_they_name(kind):
    text = example_file(kind)
    assert text.startswith(f"#:schema ./{FILE}\n")
    assert mistakes(text) == []
    assert mistakes(COMMENTED_SETTING.sub("", text)) == []


@pytest.mark.parametrize("file", sorted((ROOT / "scenarios").glob("*.toml")))
def test_scenarios_fit(file):
    assert mistakes(file.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("[bearings]\nclearence = '1 mm'", "bearings.clearence"),
        ("[bearings]\nclearance = '1'", "bearings.clearance"),
        ("[bearings]\nclearance = 0.3", "bearings.clearance"),
        ("[bearings]\nfriction = 3.0", "bearings.friction"),
        ("[bearings.A]\nwidth = '1 kg'", "bearings.A.width"),
        ("[settings]\nengine = 'dea'", "settings.engine"),
        ("[settings]\ncycles = 2.5", "settings.cycles"),
        ("[process]\nkind = 'blanking'\nforce = '1 mm'", "process"),
        ("[limits]\npressure_limit = '1 N'", "limits.pressure_limit"),
        ("colour = 'red'", ""),
    ],
)
def test_a_mistake_is_marked_where_the_program_refuses_it(text, place, tmp_path):
    assert mistakes(f"mechanism = 'press'\n{text}") == [place]
    file = tmp_path / "wrong.toml"
    file.write_text(f"mechanism = 'press'\n{text}")
    with pytest.raises(pw.InputError):
        scene_from(file)


def test_forms_of_values_that_the_program_reads_are_accepted(tmp_path):
    text = """mechanism = "press"
[bearings]
joints = ["A", "C"]
clearance = "90 H9/f7"
diameter = "90mm"
c_f = "5 %"
wear_coefficient = "1e-9 mm²/N"
[bearings.C]
clearance = "90H8/f7"
[settings]
speed = "2pi rad/s"
inertia_3 = "1e3 kg*mm2"
cycles_per_update = "none"
gravity = 0
"""
    file = tmp_path / "right.toml"
    file.write_text(text)
    assert scene_from(file).bearing("C").friction == 0.05
    assert mistakes(text) == []
