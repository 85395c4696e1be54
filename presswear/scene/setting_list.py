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
    settings = list(settings_in(scene, scene.origins))
    common = {setting.key: setting.value for setting in settings_in(scene.bearings)}
    for joint in scene.joint_bearings:
        for setting in _of_joint(scene, joint):
            name = setting.key.removeprefix(f"{joint}.")
            if setting.value != common.get(name):
                settings.append(setting)
    return settings


def applicable_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings of a scene without those that its mechanism does not read."""
    unread = {*getattr(scene.mechanism, "unread", ())}
    if "guide" not in scene.bearing_joints:
        unread |= {"guide_length", "guide_width"}
    return [setting for setting in settings_of(scene) if setting.key not in unread]


def used_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings whose values a run of the scene uses.

    It omits a value of the common bearing if no joint has it, values that the laws of a
    joint do not read, and the settings of the other engines.
    """
    used = set()  # keys and values of the bearings of all joints
    unused = set()  # keys of settings that nothing reads
    for joint in scene.bearing_joints:
        unread = unread_of(scene, joint)
        unused |= {f"{joint}.{key}" for key in unread}
        for setting in settings_in(scene.bearing(joint)):
            key, _, _ = setting.key.partition(".")
            if key not in unread:
                used.add((setting.key, setting.value))
    for engine in vars(scene.numerics).values():
        if engine.word != scene.solver.word:
            unused |= {setting.key for setting in settings_in(engine)}
    common = {setting.key for setting in settings_in(scene.bearings)} - {*NOT_COMMON}
    result = []
    for setting in applicable_settings_of(scene):
        is_used = setting.key not in common or (setting.key, setting.value) in used
        if is_used and setting.key not in unused:
            result.append(setting)
    return result


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
    """Yield the settings of the bearing of a joint, with their origins."""
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
    """Yield the settings of the parts of a data class, then the settings that are no parts."""
    without_parts = []
    for name, key, value, meaning, inner in fields_of(owner, prefix):
        if isinstance(meaning, Choice):
            setting = Setting(key, meaning.shown(value), meaning)
            if not meaning.is_part:
                without_parts.append(setting)
                without_parts += _numbers_of_law(setting, value, origins or {})
                continue
            yield setting
        elif meaning is not None:
            origin = (origins or {}).get(key, meaning.origin)
            if origin != meaning.origin:
                meaning = replace(meaning, origin=origin)
            without_parts.append(Setting(key, value, meaning))
        if has_settings(value):
            for setting in settings_in(value, origins, inner):
                if name != COMMON or setting.key not in NOT_COMMON:
                    yield setting
    yield from without_parts


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
    for field in fields(owner):
        name = field.name
        if name in getattr(owner, "unset", ()):
            continue
        key = f"{prefix}{name}"
        meaning = meaning_of(field, owner)
        is_optional = isinstance(meaning, Choice) and meaning.kinds is not None
        inner = f"{key}." if is_optional else prefix
        yield name, key, getattr(owner, name), meaning, inner


IN_FILE = f"{SET}, in the file"
DEFAULT = "default"  # origin of a value that a file leaves out
