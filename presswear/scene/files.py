"""Scenes from TOML files, every number with its unit, and measured surfaces from tables."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from presswear.linkage.linkage import Linkage, linkage_from
from presswear.linkage.press import Press
from presswear.linkage.surface import SIDES
from presswear.scene.bearing import DOUBLED_MEANINGS
from presswear.scene.mechanism_kinds import MECHANISMS, AnyMechanism, Parametric
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import MOTOR, SERVO, TABLES, name_of_key
from presswear.scene.setting_list import DEFAULT, IN_FILE, Setting, settings_of
from presswear.scene.settings import changed, on_surfaces
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array
from presswear.tools.choices import NONE, Choice
from presswear.tools.errors import InputError, shown, unknown
from presswear.tools.files import read_text, separator_of
from presswear.tools.quantities import Quantity, parse_quantity
from presswear.tools.serialize import LARGEST

SUFFIX = ".toml"
TABLE = ".csv"  # ending of a table of measured profiles
# table of the values that a sweep of the scene varies, which the scene ignores
SWEEP = "sweep"
_PARTS = "process", MOTOR, SERVO, "life"
_KEYS = ("title", *TABLES, *_PARTS, "surfaces", SWEEP)

POINTS = "points"
PRESSES = ("eccentric-press", "knuckle-press", "link-drive", "cylinder-press")
"""Examples of heavy presses, with bearings, a process and limits of their own."""
# Names of the example files
EXAMPLES = tuple(dict.fromkeys((*MECHANISMS, *PRESSES, POINTS)))
_COMMENT = 34  # width of an example file before its comments
_OPEN = re.compile(r"^(\w+) =$", re.MULTILINE)  # a line that gets the default value
# the # of a value or a table that is commented out
_OFF = re.compile(r"^#(?=\w+ = |\[)", re.MULTILINE)
# Heading of a table, also of a table that is switched off
_HEADING = re.compile(r"^#?\[+(\w+)", re.MULTILINE)
# Kind of a mechanism: the first kind in the file
_KIND = re.compile(r'^kind = "(.+?)"', re.MULTILINE)


def example_file(kind: str) -> str:
    """Return the text of a file that describes a mechanism, one of EXAMPLES.

    Each value is followed by its meaning.
    """
    if not kind:
        raise InputError(f"name the kind of mechanism: {', '.join(EXAMPLES)}")
    if kind not in EXAMPLES:
        raise unknown("mechanism", kind, EXAMPLES)
    return _with_comments(_with_defaults(_joined(kind)), Path(kind))


def _with_comments(text: str, file: Path) -> str:
    """Return the text of an example file with the meaning of each value behind it."""
    scene = _scene_of(tomllib.loads(_OFF.sub("", text)), file)
    meanings = {setting.key: setting.meaning for setting in settings_of(scene)}
    meanings |= DOUBLED_MEANINGS
    lines = []
    table = ""
    for line in text.splitlines():
        if heading := _HEADING.match(line):
            table = heading[1]
        key = line.lstrip("#").partition(" = ")[0]
        if table in _PARTS:
            key = table if key == "kind" else f"{table}.{key}"
        comment = _comment_on(meanings.get(key))
        if comment and " #" not in line:
            line = f"{line:{_COMMENT}}  # {comment}"
        lines.append(line)
    return "\n".join([*lines, ""])


def _template(name: str) -> str:
    file = files("presswear.scene").joinpath(f"{name}.toml")
    return file.read_text("utf-8").strip()


def _joined(kind: str) -> str:
    """Return the text of an example: its mechanism, and the common tables that it lacks."""
    mechanism = _template(kind)
    tables = set(_HEADING.findall(mechanism))
    blocks = []
    for block in _template("example").split("\n\n"):
        if tables.isdisjoint(_HEADING.findall(block)):
            blocks.append(block)
    joints = getattr(_class_in(mechanism), "default_joints", "B")
    words = {
        "KIND": kind,
        "MECHANISM": mechanism,
        "JOINTS": ", ".join(joints),
        "JOINT": joints[0],
    }
    pattern = re.compile(rf"\b({'|'.join(words)})\b")
    return pattern.sub(lambda match: words[match[1]], "\n\n".join(blocks))


def _with_defaults(text: str) -> str:
    """Return the text of an example with the defaults in its lines without a value."""
    mechanism = _class_in(text) or Press
    by_key = {setting.key: setting for setting in settings_of(Scene(mechanism()))}
    return _OPEN.sub(lambda match: f"{match[0]} {_toml_value(by_key[match[1]])}", text)


def _class_in(text: str) -> type[Parametric] | None:
    """Return the class of the mechanism in a text; None if it consists of bodies."""
    kind = _KIND.search(text)
    return kind and MECHANISMS.get(kind[1])


def _comment_on(meaning: Quantity | Choice | None) -> str:
    """Return the meaning of a value, and the words that are allowed; empty without one."""
    if meaning is None:
        return ""
    if isinstance(meaning, Choice):
        allowed = meaning.allowed() if meaning.several else meaning.words
        words = " | ".join(word for word in allowed if word != NONE)
        first = meaning.text.partition(";")[0]
        return f"{first} ({words})" if words else first
    return meaning.text


def _toml_value(setting: Setting) -> str:
    meaning = setting.meaning
    value = setting.value
    if isinstance(meaning, Choice):
        return f'"{value}"'
    return f'"{meaning.written(value)}"' if meaning.unit else f"{value:.6g}"


_QUOTES = "texts, and numbers with a unit, need quotes; decimals need a point"


def read_toml(file: Path) -> dict[str, Any]:
    """Return the tables of a TOML file; raise InputError for what cannot be read."""
    text = read_text(file)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError: also a too long integer
        message, _, place = f"{error}".partition(" (at ")
        number = re.match(r"line (\d+)", place)
        if number is None:
            raise InputError(f"{file}: {message}") from None
        line = text.splitlines()[int(number[1]) - 1].partition(" #")[0].strip()
        where = f"{file}, line {number[1]}: {line}"
        raise InputError(f"{where}: {message} ({_QUOTES})") from None


@checked_arguments
def scene_from(file: str | Path) -> Scene:
    """Return the scene that a file describes, checked; errors name the file, the key, the value."""
    file = Path(file)
    try:
        scene = _scene_of(read_toml(file), file)
        scene.check()
        return scene
    except (InputError, RecursionError) as error:
        text = f"{error}"
        raise InputError(
            text if text.startswith(f"{file}") else f"{file}: {text}"
        ) from None


def _scene_of(data: dict[str, Any], file: Path) -> Scene:
    for key in data:
        if key not in _KEYS:
            raise unknown("key", key, _KEYS)
    mechanism, parameters = _mechanism(data.pop("mechanism", None), file.parent)
    title = data.get("title", f"The linkage of {file.name}")
    scene = Scene(mechanism, file.stem, title)
    origins = dict.fromkeys((setting.key for setting in settings_of(scene)), DEFAULT)
    settings = _settings({"mechanism": parameters, **data}, file.parent)
    scene = changed(replace(scene, origins=origins), settings, IN_FILE)
    source = data.get("surfaces")
    if source is None:
        return scene
    if not isinstance(source, str) or not source.endswith(TABLE):
        raise InputError(
            f"surfaces = {source!r}: a name that ends in {TABLE} is expected"
        )
    return on_surfaces(scene, read_profiles(file.parent / source), source)


def _mechanism(data: Any, folder: Path) -> tuple[AnyMechanism, Mapping[str, Any]]:
    """Return a mechanism and the settings of its table: a linkage of points has none."""
    table = {"kind": data} if isinstance(data, str) else data
    if not isinstance(table, Mapping) or not table.keys() & {"kind", "bodies"}:
        kinds = ", ".join(MECHANISMS)
        raise InputError(
            f"mechanism: a table with a kind, one of {kinds}, or with bodies is needed"
        )
    kind = table.get("kind", Linkage.kind)
    if kind == Linkage.kind:
        return linkage_from(_texts(table, "mechanism", folder), "mechanism"), {}
    if kind not in MECHANISMS:
        raise unknown("mechanism", kind, MECHANISMS)
    settings = {key: value for key, value in table.items() if key != "kind"}
    return MECHANISMS[kind](), settings


def _texts(value: Any, place: str, folder: Path) -> Any:
    """Return data with numbers as text, because a number in a file needs its unit.

    Files of user laws are looked for in the folder.
    """
    if isinstance(value, Mapping):
        texts = {}
        for key, item in value.items():
            texts[key] = _texts(item, f"{place}.{key}", folder)
        return texts
    if isinstance(value, list):
        return [_texts(item, place, folder) for item in value]
    if isinstance(value, str) and ".py:" in value:
        return f"{folder / value}"
    if isinstance(value, int | float) and not isinstance(value, bool):
        if abs(value) > LARGEST:
            raise InputError(
                f"{place}: a number is too large; allowed is up to {LARGEST:g}"
            )
        return f"{value!r}" if value else value  # a zero needs no unit
    return value


def _settings(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the settings of all tables by key, as on the command line."""
    settings: dict[str, Any] = {}
    for table in (*TABLES, *_PARTS):
        if table not in data:
            continue
        _check_table(table, data[table])
        for name, value in _flat(data[table]):
            key = name_of_key(name)
            if table in _PARTS:
                key = table if key == "kind" else f"{table}.{key}"
            if key in settings:
                raise InputError(f"{key} stands twice; it is allowed in one table only")
            if key == "kind":
                raise InputError(
                    f"{table}: kind belongs to another table; is its # removed?"
                )
            if isinstance(value, list) and key == "joints":
                value = ",".join(map(str, value))
            _check_value(table, key, value)
            settings[key] = _texts(value, f"{table}.{key}", folder)
    return settings


def _check_table(name: str, table: Any) -> None:
    """Raise InputError unless a table of a file is a table, with a kind if it needs one."""
    if not isinstance(table, Mapping):
        raise InputError(f"{name} = {shown(table)}: a table is expected")
    needs_kind = name in ("process", "life")
    if name == SERVO:
        needs_kind = "stiffness" not in table  # else it turns at a constant speed
    if needs_kind and "kind" not in table:
        raise InputError(
            f"{name}: a kind is missing; presswear list SCENE shows the kinds"
        )


def _flat(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield keys and values of a table; TOML reads ``A.clearance`` as a table ``A`` in it."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            for name, inner_value in _flat(value):
                yield f"{key}.{name}", inner_value
        else:
            yield key, value


def _check_value(table: str, key: str, value: Any) -> None:
    """Raise InputError unless the value of a setting is a text or a number."""
    if isinstance(value, list):
        needed = "it needs a mechanism of bodies; presswear new points writes one"
        raise InputError(f"{table}.{key}: {needed}")
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{key} = {shown(value)}: a text or a number is expected")


_HEADER = "joint,side,angle (deg),depth (um)"
_COLUMNS = ["angle", "depth", "joint", "side"]
_COLUMN = re.compile(r"[^\W\d]\w*")  # its name, before its unit
TableRow = tuple[int, dict[str, str]]  # number of its line, and values by column


def read_table(file: Path, header: str) -> tuple[list[str], list[TableRow]]:
    """Return the columns and the rows of a table of measured values.

    The table is text with commas or semicolons: a header such as ``joint,side,angle
    (deg),depth (um)``, the columns in any order, then a row for each reading; lines
    that begin with ``#`` are comments. Values have the unit of their column. Errors
    name the file and the line, and ``header`` as an example.
    """
    lines = []
    for number, line in enumerate(read_text(file).splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            lines.append((number, line))
    if len(lines) < 2:
        raise InputError(
            f"{file}: it has no rows; a header such as {header} is expected"
        )
    separator = separator_of(lines[0][1])
    table = []
    for number, line in lines:
        words = [word.strip().strip('"') for word in line.split(separator)]
        table.append((number, words))
    (_, heads), *rows = table
    names = []
    units = []
    for head in heads:
        match = _COLUMN.match(head)
        name = match[0] if match else ""
        names.append(name)
        units.append(head.removeprefix(name).strip(" ()[]"))
    values = []
    for number, words in rows:
        if len(words) != len(names):
            fault = f"{len(words)} values for {len(names)} columns"
            raise InputError(f"{file}, line {number}: {fault}")
        row = {}
        for name, word, unit in zip(names, words, units, strict=True):
            row[name] = f"{word} {unit}".strip() if word else ""
        values.append((number, row))
    return names, values


def read_profiles(file: Path) -> dict[str, tuple[Array, Array]]:
    """Return profiles measured on bearings and pins, rows of angle, rad, and depth, m, by joint.

    The table is one of ``read_table`` with the columns joint, side, angle and depth. A
    side without a row is round.
    """
    names, rows = read_table(file, _HEADER)
    points: dict[str, tuple[list[Any], list[Any]]] = {}
    if sorted(names) != _COLUMNS:
        raise InputError(
            f"{file}: columns {', '.join(names)}: a header as {_HEADER} is expected"
        )
    for number, row in rows:
        try:
            if row["side"] not in SIDES:
                raise unknown("side", row["side"], SIDES)
            angle = parse_quantity("angle", row["angle"], Quantity("rad"))
            depth = parse_quantity("depth", row["depth"], Quantity("m"))
        except InputError as error:
            raise InputError(f"{file}, line {number}: {error}") from None
        sides = points.setdefault(row["joint"], ([], []))
        sides[SIDES.index(row["side"])].append((angle, depth))
    profiles = {}
    for joint, (bearing, pin) in points.items():
        profiles[joint] = np.array(bearing), np.array(pin)
    return profiles
