"""JSON schema of scene files, with which editors complete, explain and check them."""

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

from presswear.linkage.motor import Motor
from presswear.linkage.process import PROCESSES
from presswear.linkage.servos import SERVOS
from presswear.scene.bearing import DOUBLED_MEANINGS, Bearing
from presswear.scene.mechanism_kinds import MECHANISMS
from presswear.scene.options import LIVES
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import MOTOR, SERVO
from presswear.scene.setting_list import Setting, settings_in
from presswear.tools.choices import NONE, Choice
from presswear.tools.quantities import Quantity
from presswear.tools.symbols import SYMBOLS
from presswear.tools.units import UNITS

FILE = "presswear.schema.json"  # the schema beside the files of ``presswear new``

_NUMBER = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?"
_FIT = r"[Øø⌀]?\s*[0-9.]*\s*[A-Z]{1,2}[0-9]+\s*/\s*[a-z]{1,2}[0-9]+"
_LIMITS = ("pressure_limit", "pv_limit")
_ANY: dict[str, Any] = {"type": "object"}

Node = dict[str, Any]


def scene_schema() -> Node:
    """Return the schema of a scene file, draft 7.

    A number with a unit is a text. Only its description states its range. Tables of a
    mechanism of bodies are not described.
    """
    scene = Scene()
    bearing = _properties(settings_in(Bearing()))
    mechanisms = {}
    for kind, mechanism in MECHANISMS.items():
        mechanisms[kind] = _fields(mechanism())
    all_settings = bearing | _properties(settings_in(scene))
    for settings in mechanisms.values():
        all_settings |= settings
    tables = {
        "process": _table_of_kinds(PROCESSES),
        "life": _table_of_kinds(LIVES),
        SERVO: _table_of_kinds(SERVOS),
        MOTOR: _table(_fields(Motor(torque=0.0))),
    }
    of_bodies = {"type": "object", "required": ["bodies"]}
    kinds = [_kind(kind, settings) for kind, settings in mechanisms.items()]
    bearings = bearing | {"joints": all_settings["joints"]}
    properties = {
        "title": _text("title of the report"),
        "mechanism": {"anyOf": [*kinds, of_bodies, {"enum": [*mechanisms]}]},
        "bearings": _table(bearings, _table(bearing)),
        "limits": _table({key: bearing[key] for key in _LIMITS}),
        "settings": _table(all_settings, _table(bearing)),
        "surfaces": _text("file of measured surfaces, .csv"),
        "sweep": _ANY | {"description": "values that presswear sweep varies"},
    }
    schema: Node = {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of presswear",
        "type": "object",
        "additionalProperties": False,
        "properties": properties | tables,
    }
    definitions: dict[str, Node] = {}
    schema = _with_references(schema, definitions, {})
    return schema | {"definitions": definitions}


def _text(description: str) -> Node:
    return {"type": "string", "description": description}


def _with_references(
    node: Any, definitions: dict[str, Node], names: dict[str, str]
) -> Any:
    """Return a node with a reference in place of each setting, which is defined once.

    ``names`` are the names of definitions by their text.
    """
    if isinstance(node, list):
        return [_with_references(item, definitions, names) for item in node]
    if not isinstance(node, dict):
        return node
    result = {}
    for key, value in node.items():
        if isinstance(value, dict) and "default" in value:
            name = names.setdefault(json.dumps(value), f"{key}-{len(names)}")
            definitions[name] = value
            result[key] = {"$ref": f"#/definitions/{name}"}
        else:
            result[key] = _with_references(value, definitions, names)
    return result


def _kind(kind: str, properties: Mapping[str, Node]) -> Node:
    """Return the table of a mechanism with its kind."""
    table = _table({"kind": {"const": kind}, **properties})
    return table | {"required": ["kind"]}


def _table_of_kinds(kinds: Mapping[str, Any]) -> Node:
    """Return the table of a part of a scene that can have several kinds."""
    tables = []
    for kind, data_class in kinds.items():
        tables.append(_table({"kind": {"const": kind}, **_fields(data_class())}))
    return {"anyOf": tables}


def _fields(owner: Any) -> dict[str, Node]:
    return _properties(settings_in(owner))


def _table(properties: Mapping[str, Node], of_joints: Node | None = None) -> Node:
    """Return a table of some keys; ``of_joints`` are tables under the names of joints."""
    return {
        "type": "object",
        "properties": dict(properties),
        "additionalProperties": of_joints or False,
    }


def _properties(settings: Iterable[Setting]) -> dict[str, Node]:
    """Return the value of each setting by its key, and by its symbol."""
    values = {}
    for setting in settings:
        values[setting.key] = _value(setting.meaning, setting.value)
    if "clearance" in values:
        for key, meaning in DOUBLED_MEANINGS.items():
            values[key] = _value(meaning, 0.0)
        for key in ("clearance", "diametral_clearance"):
            pattern = values[key]["pattern"]
            values[key]["pattern"] = f"{pattern}|^\\s*{_FIT}\\s*$"
    for symbol, name in SYMBOLS.items():
        if name in values:
            values[symbol] = values[name]
    return values


def _value(meaning: Quantity | Choice, value: Any) -> Node:
    """Return the allowed values of a setting, with its meaning and its default."""
    if isinstance(meaning, Choice):
        node: Node = {"description": meaning.text, "default": value}
        if meaning.several or meaning.parameters or meaning.example:
            return node | {"type": ["string", "array", "object"]}
        return node | {"enum": [*meaning.words]}
    typical = meaning.low if value is None else value
    limits = meaning.in_unit_of(typical).range_text()
    remarks = f"{limits}; {meaning.origin}" if meaning.origin else limits
    default = NONE if value is None else meaning.written(value)
    node = {"description": f"{meaning.text} ({remarks})", "default": default}
    if not meaning.unit:
        return node | _plain_number(meaning)
    units: list[str] = []
    for name in meaning.unit.split(" or "):
        units += UNITS.get(name, [name])
    # A long unit comes before a short unit with which it begins.
    unit_pattern = "|".join(map(_pattern_of, sorted(units, key=len, reverse=True)))
    pi = r"\s*(pi)?" if "rad" in meaning.unit else ""
    pattern = rf"^\s*({_NUMBER}{pi}\s*({unit_pattern})|[+-]?0|none)\s*$"
    zero = {"minimum": 0.0, "maximum": 0.0}  # the only number that needs no unit
    return node | {"type": ["string", "number"], "pattern": pattern} | zero


def _plain_number(meaning: Quantity) -> Node:
    """Return the allowed values of a number without a unit."""
    pattern = rf"^\s*({_NUMBER}\s*(%|percent)?|none)\s*$"
    node: Node = {"type": ["number", "string"], "pattern": pattern}
    if meaning.whole:
        node["multipleOf"] = 1
    return node | {"minimum": meaning.low, "maximum": meaning.high}


def _pattern_of(unit: str) -> str:
    """Return the pattern of a unit in the forms in which people write it."""
    text = re.escape(unit).replace("\\ ", "[ ·*_]+")
    return text.replace("\\^2", "(\\^?2|²)").replace("\\^3", "(\\^?3|³)")
