"""List of the settings of a scene: all values that can be set."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, cast

from presswear.linkage.points import OutputPoint
from presswear.scene.bearing import NOT_COMMON
from presswear.scene.guide_clearance import unread_in_guide
from presswear.scene.scene import Scene
from presswear.tools.choices import NONE, Choice
from presswear.tools.fields import meaning_of
from presswear.tools.quantities import Quantity
from presswear.tools.user_function import UserFunction

OF_LAW = "law"  # origin of the default of a number of a user law
SET = "set by the user"  # origin of a value that was changed
COMMON = "bearings"  # field of a scene with the bearing that joints share


@dataclass(frozen=True)
class Setting:
    """One value that ``--set`` can change: a number, SI, a word, the name of a set or a kind."""

    key: str
    value: Any
    meaning: Quantity | Choice

    def described(self) -> str:
        """Return value, range and meaning in one line."""
        meaning = self.meaning
        if isinstance(meaning, Choice):
            return f"{self.value}  ({' | '.join(meaning.allowed())})  {meaning.text}"
        value = NONE if self.value is None else meaning.written(self.value)
        limits = meaning.in_unit_of(self.value or meaning.low).range_text()
        return f"{value}  ({limits}; {meaning.origin})  {meaning.text}"


def settings_of(scene: Scene) -> list[Setting]:
    """Return all settings with present values; of single joints only those that differ."""
    common = {setting.key: setting.value for setting in settings_in(scene.bearings)}
    differing = (
        setting
        for joint in scene.joint_bearings
        for setting in _of_joint(scene, joint)
        if setting.value != common.get(setting.key.removeprefix(f"{joint}."))
    )
    return [*settings_in(scene, scene.origins), *differing]


def applicable_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings of a scene without those that its mechanism does not read."""
    unread = {*getattr(scene.mechanism, "unread", ())}
    if "guide" not in scene.bearing_joints:
        unread |= {"guide_length", "guide_width"}
    return [setting for setting in settings_of(scene) if setting.key not in unread]


def used_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings whose values a run of the scene uses.

    Left out are values of bearings that each joint has a value of its own for, or that
    its laws do not read, and the settings of the other engines.
    """
    used = {
        (setting.key, setting.value)
        for joint in scene.bearing_joints
        for setting in settings_in(scene.bearing(joint))
        if setting.key.partition(".")[0] not in unread_of(scene, joint)
    }
    common = {setting.key for setting in settings_in(scene.bearings)} - {*NOT_COMMON}
    engines = (
        engine
        for engine in vars(scene.numerics).values()
        if engine.word != scene.solver.word
    )
    unused = {setting.key for engine in engines for setting in settings_in(engine)}
    unused |= {
        f"{joint}.{key}"
        for joint in scene.bearing_joints
        for key in unread_of(scene, joint)
    }
    return [
        setting
        for setting in applicable_settings_of(scene)
        if setting.key not in unused
        and (setting.key not in common or (setting.key, setting.value) in used)
    ]


def unread_of(scene: Scene, joint: str) -> tuple[str, ...]:
    """Return the keys of values of a bearing that a run of the scene does not read."""
    bearing = scene.bearing(joint)
    is_guide = any(guide.name == joint for guide in scene.loose_guides)
    return unread_in_guide(bearing) if is_guide else bearing.unread


def all_settings(scene: Scene) -> Iterator[Setting]:
    """Yield all settings that a scene has, also those of each joint with a bearing."""
    yield from settings_in(scene, scene.origins)
    for joint in scene.bearing_joints:
        yield from _of_joint(scene, joint)


def _of_joint(scene: Scene, joint: str) -> Iterator[Setting]:
    for setting in settings_in(scene.bearing(joint)):
        key = f"{joint}.{setting.key}"
        meaning = setting.meaning
        if isinstance(meaning, Quantity):
            default = OF_LAW if meaning.origin == OF_LAW else SET
            meaning = replace(meaning, origin=scene.origins.get(key, default))
        yield Setting(key, setting.value, meaning)


def settings_in(
    owner: Any, origins: Mapping[str, str] | None = None, prefix: str = ""
) -> Iterator[Setting]:
    """Yield the settings of the parts of a data class, then those of its fields."""
    plain = []
    for name, key, value, meaning, inner in fields_of(owner, prefix):
        if isinstance(meaning, Choice):
            setting = Setting(key, meaning.shown(value), meaning)
            if not meaning.is_part:
                plain.append(setting)
                plain += _numbers_of_law(setting, value, origins or {})
                continue
            yield setting
        elif meaning is not None:
            origin = (origins or {}).get(key, meaning.origin)
            if origin != meaning.origin:
                meaning = replace(meaning, origin=origin)
            plain.append(Setting(key, value, meaning))
        if has_settings(value):
            for setting in settings_in(value, origins, inner):
                if name != COMMON or setting.key not in NOT_COMMON:
                    yield setting
    yield from plain


def _numbers_of_law(
    setting: Setting, law: Any, origins: Mapping[str, str]
) -> Iterator[Setting]:
    """Yield the numbers of the user law that a setting may hold."""
    if isinstance(law, UserFunction):
        allowed = cast(Choice, setting.meaning).parameters
        for number, value in law.settings(setting.key, allowed):
            key = f"{setting.key}.{number.name}"
            origin = origins.get(key, number.meaning.origin)
            yield Setting(key, value, replace(number.meaning, origin=origin))


def has_settings(value: Any) -> bool:
    """Return whether a value is a part whose fields are settings."""
    return is_dataclass(value) and not isinstance(value, UserFunction | OutputPoint)


def fields_of(owner: Any, prefix: str) -> Iterator[tuple[str, str, Any, Any, str]]:
    """Yield name, key, value and meaning of each field, and the prefix of the keys in it."""
    for item in fields(owner):
        if item.name in getattr(owner, "unset", ()):
            continue
        key = f"{prefix}{item.name}"
        meaning = meaning_of(item, owner)
        is_optional = isinstance(meaning, Choice) and meaning.kinds is not None
        inner = f"{key}." if is_optional else prefix
        yield item.name, key, getattr(owner, item.name), meaning, inner


IN_FILE = f"{SET}, in the file"
DEFAULT = "default"  # origin of a value that a file leaves out
