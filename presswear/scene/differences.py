"""Differences between two scenes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from presswear.linkage.linkage import Linkage
from presswear.scene.bearing import NOT_COMMON
from presswear.scene.scene import Scene
from presswear.scene.setting_list import settings_in, settings_of
from presswear.tools.choices import NONE, Choice
from presswear.tools.files import digest
from presswear.tools.quantities import Quantity
from presswear.tools.user_function import UserFunction, is_stored_function

_MAX_VALUE_LENGTH = 200  # characters of a value in a list of differences


def differences(first: Any, second: Any, key: str = "") -> list[tuple[str, Any, Any]]:
    """Return keys under which two stored scenes differ, with both values; long ones are short.

    ``key`` is the key of both values in their scenes. ``name`` and ``kind`` of a part
    are listed under the key of the part.
    """
    has_function = is_stored_function(first) or is_stored_function(second)
    if isinstance(first, Mapping) and isinstance(second, Mapping) and not has_function:
        result = []
        for name in {**first, **second}:
            label = key if key and name in ("name", "kind") else name
            result += differences(first.get(name), second.get(name), label)
        return result
    return [] if first == second else [(key, _short(first), _short(second))]


def _short(value: Any) -> Any:
    """Return a value; of a long text the beginning and the digest."""
    if is_stored_function(value):
        return f"{UserFunction.from_plain(value)}"
    text = f"{value}"
    if len(text) <= _MAX_VALUE_LENGTH:
        return value
    return f"{text[:20]}... ({digest(text.encode())[:12]})"


def _mechanism_name(scene: Scene) -> str:
    mechanism = scene.mechanism
    return mechanism.name if isinstance(mechanism, Linkage) else mechanism.kind


@dataclass(frozen=True)
class Change:
    """Value that differs from the named scene or from the default, both in one unit."""

    key: str
    value: str
    was: str
    unit: str
    meaning: str

    def __str__(self) -> str:
        return f"{self.key.replace('_', ' ')} {self.value} {self.unit}".rstrip()


def changes_from(base: Scene, scene: Scene) -> tuple[Change, ...]:
    """Return the changes of a scene against a base scene that do not follow from others."""
    expected = _expected_values(base, scene)
    settings = settings_of(scene)
    changes = []
    for setting in settings:
        key = setting.key
        meaning = setting.meaning
        if setting.value == expected.get(key, setting.value):
            continue
        quantity = meaning if isinstance(meaning, Quantity) else Quantity()
        value = _or_none(setting.value)
        (text, before), unit = quantity.texts(value, _or_none(expected[key]))
        changes.append(Change(key, text, before, unit, meaning.text))
    keys = {setting.key for setting in settings}
    return (*changes, *_part_changes(base, scene, keys))


def _or_none(value: Any) -> Any:
    return NONE if value is None else value


def _expected_values(base: Scene, scene: Scene) -> dict[str, Any]:
    """Return the values by key of a base scene in which some parts are those of a scene.

    If a part of the scene has another name, such as another set of materials, the values
    of the part are those of this name. Values of a single joint are those of the common
    bearing.
    """
    values = {setting.key: setting.value for setting in settings_of(base)}
    for setting in settings_of(scene):
        key = setting.key
        meaning = setting.meaning
        if not isinstance(meaning, Choice) or not meaning.is_part:
            continue
        if setting.value not in meaning.words:
            values[key] = setting.value  # a set without a name: its values are compared
        elif setting.value not in (values.get(key, setting.value), NONE):
            expected = meaning.convert(key, setting.value)
            prefix = f"{key}." if meaning.kinds else ""
            for item in settings_in(expected, prefix=prefix):
                values[item.key] = item.value
    for joint in scene.joint_bearings:
        for item in settings_in(scene.bearings):
            key = item.key
            if key in NOT_COMMON:
                values.setdefault(f"{joint}.{key}", getattr(base.bearings, key))
            elif key in values:  # numbers of a user law are in the text of the law
                values.setdefault(f"{joint}.{key}", values[key])
    if not base.clearance_joints and scene.clearance_joints:
        # A scene without clearance has none.
        values["wear_updates"] = Scene.wear_updates
    return values


def _part_changes(base: Scene, scene: Scene, keys: set[str]) -> Iterator[Change]:
    """Yield the changes of the mechanism and of the surfaces, which are not settings."""
    before = base.as_dict()
    data = scene.as_dict()
    names = dict[str, None]()  # in the order of the mechanism
    for key, _, _ in differences(before["mechanism"], data["mechanism"]):
        if key not in keys:
            names[key] = None
    if names:
        text = f"mechanism; differs in {', '.join(names)}"
        value = _mechanism_name(scene)
        yield Change("mechanism", value, _mechanism_name(base), "", text)
    if scene.surfaces and data["surfaces"] != before["surfaces"]:
        source = scene.origins.get("surfaces", "a script")
        yield Change(
            "surfaces", f"from {source}", "round", "", "initial surfaces of every run"
        )
