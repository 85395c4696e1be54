"""Differences between two scenes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from presswear.linkage.linkage import Linkage
from presswear.scene.bearing import SINGLE
from presswear.scene.scene import Scene
from presswear.scene.setting_list import settings_in, settings_of
from presswear.tools.choices import NONE, Choice
from presswear.tools.files import digest
from presswear.tools.quantities import Quantity
from presswear.tools.user_function import UserFunction, is_stored_function

_MAX_VALUE_LENGTH = 200  # characters of a value in a list of differences


def differences(first: Any, second: Any, key: str = "") -> list[tuple[str, Any, Any]]:
    """Return keys under which two stored scenes differ, with both values, long ones cut."""
    has_function = is_stored_function(first) or is_stored_function(second)
    if isinstance(first, Mapping) and isinstance(second, Mapping) and not has_function:
        inner = {
            n: key if key and n in ("name", "kind") else n for n in {**first, **second}
        }
        pairs = (
            (first.get(name), second.get(name), label) for name, label in inner.items()
        )
        return [difference for pair in pairs for difference in differences(*pair)]

    def short(value: Any) -> Any:
        if is_stored_function(value):
            return f"{UserFunction.from_plain(value)}"
        text = f"{value}"
        is_long = len(text) > _MAX_VALUE_LENGTH
        return f"{text[:20]}... ({digest(text.encode())[:12]})" if is_long else value

    return [] if first == second else [(key, short(first), short(second))]


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
    """Return the changes of a scene against another one that do not follow from others."""
    was = {one.key: one.value for one in settings_of(base)}
    settings = settings_of(scene)
    for one in settings:
        if not isinstance(one.meaning, Choice) or not one.meaning.is_part:
            continue
        if one.value not in one.meaning.words:
            was[one.key] = one.value  # a set without a name is described by its values
        elif one.value != was.get(one.key, one.value) and one.value != NONE:
            part = one.meaning.convert(one.key, one.value)
            prefix = f"{one.key}."
            inner = settings_in(part, prefix=prefix if one.meaning.kinds else "")
            was |= {item.key: item.value for item in inner}
    for joint in scene.joint_bearings:
        for key in [item.key for item in settings_in(scene.bearings)]:
            if key not in was and key not in SINGLE:
                continue  # a number of a user law, which the law has in its text
            before = getattr(base.bearings, key) if key in SINGLE else was[key]
            was.setdefault(f"{joint}.{key}", before)
    if not base.clearance_joints and scene.clearance_joints:
        was["wear_updates"] = Scene.wear_updates  # a scene without clearance has none
    changes = []
    for one in settings:
        if one.value != was.get(one.key, one.value):
            values = [
                NONE if value is None else value for value in (one.value, was[one.key])
            ]
            quantity = one.meaning if isinstance(one.meaning, Quantity) else Quantity()
            (value, before), unit = quantity.texts(*values)
            changes.append(Change(one.key, value, before, unit, one.meaning.text))
    return (*changes, *_part_changes(base, scene, {one.key for one in settings}))


def _part_changes(base: Scene, scene: Scene, keys: set[str]) -> Iterator[Change]:
    """Yield the changes of the mechanism and of the surfaces, which are not settings."""
    was = base.as_dict()
    data = scene.as_dict()
    names = [key for key, *_ in differences(was["mechanism"], data["mechanism"])]
    names = [key for key in dict.fromkeys(names) if key not in keys]
    if names:
        text = "mechanism; differs in " + ", ".join(names)
        new, old = (
            one.name if isinstance(one, Linkage) else one.kind
            for one in (scene.mechanism, base.mechanism)
        )
        yield Change("mechanism", new, old, "", text)
    if scene.surfaces and data["surfaces"] != was["surfaces"]:
        source = scene.origins.get("surfaces", "a script")
        yield Change(
            "surfaces", f"from {source}", "round", "", "initial surfaces of every run"
        )
