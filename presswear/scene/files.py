"""Scenes from TOML files, every number with its unit, and measured surfaces from tables."""

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from presswear.linkage.linkage import Linkage, linkage_from, toml_of
from presswear.linkage.mechanisms import FOUR_BAR, Press, SliderCrank
from presswear.linkage.surface import SIDES
from presswear.scene.scene import MECHANISMS, OneMechanism, Scene
from presswear.scene.settings import DEFAULT, IN_FILE, changed, on_surfaces, settings_of
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_text
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.serialize import LARGEST

SUFFIX = ".toml"
TABLE = ".csv"  # ending of a table of measured profiles
SWEEP = "sweep"  # table of the values that a sweep of the scene varies, which the scene ignores
_PARTS = "process", "servo", "life"
_KEYS = ("title", "mechanism", *_PARTS, "settings", "surfaces", SWEEP)

EXAMPLES: Mapping[str, tuple[Press | SliderCrank | Linkage, str]] = {
    FOUR_BAR.name: (FOUR_BAR, "B"),
    SliderCrank.kind: (SliderCrank(), "B"),
    Press.kind: (Press(), "A,C"),
}
"""Mechanisms of example files, and the joints that have clearance in them."""


def example_file(kind: str) -> str:
    """Return the text of a file that describes one of EXAMPLES."""
    if kind not in EXAMPLES:
        raise unknown("mechanism", kind, EXAMPLES)
    mechanism, joints = EXAMPLES[kind]
    return (
        f"# A {kind}. Every number has its unit; x points to the right, y upwards, and angles "
        "turn\n# counterclockwise. Points are body.point or coordinates on the frame.\n"
        f"# Try: presswear list FILE, presswear run FILE.\n\n"
        f'title = "My {kind}"\n\n'
        f"{toml_of(mechanism.linkage())}\n"
        "[settings]  # every key that presswear list FILE shows\n"
        f'joints = "{joints}"\nclearance = "0.3 mm"\nfriction = 0.02\n'
        'conventions = "refined"\nwear_updates = 1\n'
    )


def read_toml(file: Path) -> dict[str, Any]:
    """Return the tables of a TOML file; raise InputError for what cannot be read."""
    try:
        return tomllib.loads(read_text(file))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{file}: {error}") from None


def scene_from(file: Path) -> Scene:
    """Return the scene that a file describes, checked; errors name the file, the key, the value."""
    try:
        data = read_toml(file)
        for key in data:
            if key not in _KEYS:
                raise unknown("key", key, _KEYS)
        mechanism = _mechanism(data.get("mechanism"), file.parent)
        settings = _settings(data.get("settings", {}), file.parent)
        for name in data.keys() & set(_PARTS):
            part = data[name]
            if not isinstance(part, Mapping) or "kind" not in part:
                raise InputError(f"{name} = {part!r}: a table with a kind is expected")
            values = {f"{name}.{key}": value for key, value in part.items() if key != "kind"}
            settings |= _settings({name: part["kind"], **values}, file.parent)
        title = data.get("title", f"The linkage of {file.name}")
        scene = Scene(mechanism, file.stem, title, wear_updates=0)  # by default nothing wears
        origins = dict.fromkeys((setting.key for setting in settings_of(scene)), DEFAULT)
        scene = changed(replace(scene, origins=origins), settings)
        scene = replace(scene, origins={**scene.origins, **dict.fromkeys(settings, IN_FILE)})
        source = data.get("surfaces")
        if source is not None:
            if not isinstance(source, str) or not source.endswith(TABLE):
                raise InputError(f"surfaces = {source!r}: a name that ends in {TABLE} is expected")
            scene = on_surfaces(scene, read_profiles(file.parent / source), source)
        scene.check()
        return scene
    except (InputError, RecursionError) as error:
        raise InputError(f"{file}: {f'{error}'.removeprefix(f'{file}: ')}") from None


def _mechanism(data: Any, folder: Path) -> OneMechanism:
    if isinstance(data, str):
        if data not in MECHANISMS:
            raise unknown("mechanism", data, (*MECHANISMS, "a table [mechanism]"))
        return MECHANISMS[data]()
    if not isinstance(data, Mapping):
        raise InputError("mechanism: the name of one or a table [mechanism] is needed")
    return linkage_from(_texts(data, "mechanism", folder), "mechanism")


def _texts(value: Any, place: str, folder: Path) -> Any:
    """Return data with numbers as text, which needs units; user laws stand in the folder."""
    if isinstance(value, Mapping):
        return {key: _texts(one, f"{place}.{key}", folder) for key, one in value.items()}
    if isinstance(value, list):
        return [_texts(one, place, folder) for one in value]
    if isinstance(value, str) and ".py:" in value:
        return f"{folder / value}"
    if isinstance(value, int | float) and not isinstance(value, bool):
        if abs(value) > LARGEST:
            raise InputError(f"{place}: a number is too large; allowed is up to {LARGEST:g}")
        return f"{value!r}" if value else value  # a zero needs no unit
    return value


def _settings(data: Any, folder: Path) -> dict[str, str]:
    """Return settings as text, as on the command line."""
    if not isinstance(data, Mapping):
        raise InputError(f"settings = {data!r}: a table is expected")
    settings = {}
    for key, value in data.items():
        # A.clearance is a table A with a key in TOML.
        inner = value if isinstance(value, Mapping) else {"": value}
        for name, one in inner.items():
            full = f"{key}.{name}" if name else key
            if isinstance(one, bool) or not isinstance(one, str | int | float):
                raise InputError(f"settings.{full} = {one!r}: a text or a number is expected")
            settings[full] = str(_texts(one, f"settings.{full}", folder))
    return settings


_HEADER = "joint,side,angle (deg),depth (um)"
_MEANINGS = {"angle": Quantity("rad"), "depth": Quantity("m")}
_COLUMNS = "joint", "side", *_MEANINGS


def read_profiles(file: Path) -> dict[str, tuple[Array, Array]]:
    """Return profiles measured on bearings and pins, rows of angle, rad, and depth, m, by joint.

    The table is text with commas: a header such as ``joint,side,angle (deg),depth (um)``, the
    columns in any order, then a row for each place; lines that begin with ``#`` are comments. A
    side without a row is round. Errors name the file and the line.
    """
    table = [
        (number, [word.strip().strip('"') for word in line.split(",")])
        for number, line in enumerate(read_text(file).splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if len(table) < 2:
        raise InputError(f"{file}: it has no rows; a header such as {_HEADER} is expected")
    (_, header), *rows = table
    names = ["".join(takewhile(str.isalpha, word)) for word in header]
    units = [word[len(name) :].strip(" ()[]") for name, word in zip(names, header, strict=True)]
    points: dict[str, tuple[list[Any], list[Any]]] = {}
    if sorted(names) != sorted(_COLUMNS):
        raise InputError(f"{file}: columns {', '.join(names)}: a header as {_HEADER} is expected")
    for number, words in rows:
        try:
            if len(words) != len(names):
                raise InputError(f"{len(words)} values for {len(names)} columns")
            row = {n: f"{w} {u}".strip() for n, w, u in zip(names, words, units, strict=True)}
            if row["side"] not in SIDES:
                raise unknown("side", row["side"], SIDES)
            place = [parse_quantity(name, row[name], one) for name, one in _MEANINGS.items()]
            points.setdefault(row["joint"], ([], []))[SIDES.index(row["side"])].append(place)
        except InputError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
    return {name: (np.array(first), np.array(second)) for name, (first, second) in points.items()}
