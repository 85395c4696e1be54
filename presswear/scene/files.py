"""Scenes from TOML files: a mechanism and settings, every number with its unit."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.linkage import Linkage
from presswear.linkage.press import Press
from presswear.linkage.reading import read
from presswear.linkage.slider_crank import SliderCrank
from presswear.linkage.written import toml_of
from presswear.scene.scene import MECHANISMS, OneMechanism, Scene
from presswear.scene.settings import DEFAULT, IN_FILE, changed, on_surfaces, settings_of
from presswear.scene.surfaces import TABLE, read_profiles
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import read_checked
from presswear.tools.serialize import LARGEST

SUFFIX = ".toml"
_PARTS = "process", "servo", "life"
SWEEP = "sweep"
"""Table of what a sweep of the scene varies, which the scene itself does not need."""
_KEYS = ("title", "mechanism", *_PARTS, "settings", "surfaces", SWEEP)
_MOST_BYTES = 2**20
_DEEP_KEY = re.compile(r"""(?:(?:(?<![\w-])[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){20}""")
"""A key of more than 20 parts: the time that the parser takes grows with their square."""


EXAMPLES: Mapping[str, tuple[Press | SliderCrank | Linkage, str]] = {
    FOUR_BAR.name: (FOUR_BAR, "B"),
    SliderCrank.kind: (SliderCrank(), "B"),
    Press.kind: (Press(), "A,C"),
}
"""Mechanisms that a file may begin with, and the joints that have clearance in it."""


def example_file(kind: str) -> str:
    """The text of a file that describes one of EXAMPLES."""
    if kind not in EXAMPLES:
        raise unknown("mechanism", kind, EXAMPLES)
    mechanism, joints = EXAMPLES[kind]
    return (
        f"# A {kind}.  Every number has its unit; x points to the right, y upwards, and angles "
        "turn\n# counterclockwise.  Points are body.point or coordinates on the frame.\n"
        f"# Try: presswear list FILE, presswear run FILE.\n\n"
        f'title = "A {kind} of my own"\n\n'
        f"{toml_of(mechanism.linkage())}\n"
        "[settings]  # every key that presswear list FILE shows\n"
        f'joints = "{joints}"\nclearance = "0.3 mm"\nfriction = 0.02\n'
        'conventions = "refined"\nwear_updates = 1\n'
    )


def read_toml(file: Path) -> dict[str, Any]:
    """Return the tables of a TOML file; InputError says what is wrong with the file."""
    if not file.is_file():
        raise InputError(f"{file}: there is no such file")
    if file.stat().st_size > _MOST_BYTES:
        raise InputError(f"{file}: it has more than {_MOST_BYTES} bytes")
    try:
        text = read_checked(file).decode()
        if deep := _DEEP_KEY.search(text):
            line = text.count("\n", 0, deep.start()) + 1
            raise InputError(f"{file}: line {line}: a key has up to 20 parts with dots between")
        data = tomllib.loads(text)
        _check_integers(data, f"{file}: ")
        return data
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{file}: {error}") from None
    except InputError:
        raise
    except ValueError:
        # Python reads no integer of more than 4300 digits.
        raise InputError(f"{file}: an integer is too long; allowed is up to {LARGEST:g}") from None


def _check_integers(value: Any, place: str) -> None:
    """Raise InputError for an integer beyond all numbers of a machine, in any notation."""
    if isinstance(value, dict):
        for key, inner in value.items():
            _check_integers(inner, f"{place}{key}.")
    elif isinstance(value, list):
        for inner in value:
            _check_integers(inner, place)
    elif isinstance(value, int) and abs(value) > LARGEST:
        raise InputError(f"{place[:-1]}: an integer is too large; allowed is up to {LARGEST:g}")


def scene_from(file: Path) -> Scene:
    """The scene that a file describes.

    Raises
    ------
    InputError
        Naming the file, the key and the value that does not fit.
    """
    try:
        data = read_toml(file)
        for key in data:
            if key not in _KEYS:
                raise unknown("key", key, _KEYS)
        mechanism = _mechanism(data.get("mechanism"), file.parent)
        settings = _settings(data.get("settings", {}), file.parent)
        for name in data.keys() & set(_PARTS):
            settings |= _part(name, data[name])
        title = data.get("title", f"The linkage of {file.name}")
        # Without a word on it, nothing wears.
        plain = Scene(mechanism, file.stem, title, wear_updates=0)
        origins = dict.fromkeys((setting.key for setting in settings_of(plain)), DEFAULT)
        scene = changed(replace(plain, origins=origins), settings)
        scene = replace(scene, origins={**scene.origins, **dict.fromkeys(settings, IN_FILE)})
        source = data.get("surfaces")
        if source is None:
            return scene
        if not isinstance(source, str) or not source.endswith(TABLE):
            raise InputError(f"surfaces = {source!r}: a name that ends in {TABLE} is expected")
        return on_surfaces(scene, read_profiles(file.parent / source), source)
    except RecursionError as error:
        raise InputError(f"{file}: {error}") from None
    except InputError as error:
        told = str(error)
        raise InputError(told if told.startswith(str(file)) else f"{file}: {told}") from None


def _mechanism(given: Any, folder: Path) -> OneMechanism:
    """A linkage from its table, or a mechanism by its kind."""
    if isinstance(given, str):
        if given not in MECHANISMS:
            raise unknown("mechanism", given, (*MECHANISMS, "a table [mechanism]"))
        return MECHANISMS[given]()
    if not isinstance(given, Mapping):
        raise InputError("mechanism: the name of one or a table [mechanism] is needed")
    return read(given, "mechanism", units=True, folder=folder)


def _part(name: str, given: Any) -> dict[str, str]:
    """The table of a part, its kind among its keys, as settings."""
    if not isinstance(given, Mapping) or "kind" not in given:
        raise InputError(f"{name} = {given!r}: a table with a kind is expected")
    values = {f"{name}.{key}": value for key, value in given.items() if key != "kind"}
    return _settings({name: given["kind"], **values}, Path())


def _settings(given: Any, folder: Path) -> dict[str, str]:
    """Settings as text, as the command line has them; a law of one's own stands in the folder."""
    if not isinstance(given, Mapping):
        raise InputError(f"settings = {given!r}: a table is expected")
    found = {}
    for key, value in given.items():
        # A.clearance is a table A with a key in TOML.
        inner = value if isinstance(value, Mapping) else {"": value}
        for name, own in inner.items():
            full = f"{key}.{name}" if name else key
            if isinstance(own, bool) or not isinstance(own, str | int | float):
                raise InputError(f"settings.{full} = {own!r}: a text or a number is expected")
            found[full] = f"{folder / str(own)}" if ".py:" in str(own) else str(own)
    return found
