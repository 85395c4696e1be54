"""Settings of a scene: the table of all values that can be set, changes of them, and their texts.

Keys are the names of the fields of a scene and of its parts, without the names of the
parts. A part that may be absent and a single joint are named before a dot:
``process.force``, ``A.clearance``.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, cast

import numpy as np

from presswear.linkage.elements import OutputPoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.servos import ConstantSpeed
from presswear.scene.bearing import DIAMETRAL, DOUBLED, SINGLE, halved
from presswear.scene.fits import clearances_of, fit_of
from presswear.scene.guide_clearance import unread_in_guide
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, nearest, shown, unknown
from presswear.tools.files import digest
from presswear.tools.not_modelled import not_modelled
from presswear.tools.quantities import (
    NONE,
    ON,
    SYMBOLS,
    Choice,
    Quantity,
    meaning_of,
    parse_quantity,
)
from presswear.tools.serialize import checked_arguments
from presswear.tools.user_function import UserFunction, is_stored_function

SET = "set by the user"  # origin of a value that was changed
IN_FILE = f"{SET}, in the file"
TABLES = "mechanism", "bearings", "limits", "settings"  # of a file
# of a file, too: the settings of a drive, which a file may have without a kind
MOTOR, SERVO = "motor", "servo"
_COMMON = "bearings"  # field of a scene with the bearing that joints share
DEFAULT = "default"  # origin of a value that a file leaves out
_MAX_VALUE_LENGTH = 200  # characters of a value in a list of differences
_MAX_VALUES = 1_000_000  # of a range
_DOUBLED = re.compile(rf"(?:^|(?<=\.))({'|'.join(DOUBLED)})$")
_DIGITS = 12  # of the values of a range: those of a finer range meet them
_RANGE = re.compile(
    r"\s*([^:]+?)\s*:\s*([^:]+?)\s*:\s*([0-9]{1,8})(?: ([^:]+?))?\s*(?::\s*(log)(?: ([^:]+))?\s*)?$"
)


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
    single = (
        setting for joint in scene.joint_bearings for setting in _of_joint(scene, joint)
    )
    differing = (
        one for one in single if one.value != common[one.key.rpartition(".")[2]]
    )
    return [*settings_in(scene, scene.origins), *differing]


def applicable_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings of a scene without those that its mechanism does not read."""
    unread = {*getattr(scene.mechanism, "unread", ())}
    if "guide" not in scene.bearing_joints:
        unread |= {"guide_length", "guide_width"}
    return [one for one in settings_of(scene) if one.key not in unread]


def used_settings_of(scene: Scene) -> list[Setting]:
    """Return the settings whose values a run of the scene uses.

    Left out are values of bearings that each joint has a value of its own for, or that
    its laws do not read, and the settings of the other engines.
    """
    used = {
        (one.key, one.value)
        for joint in scene.bearing_joints
        for one in settings_in(scene.bearing(joint))
        if one.key not in unread_of(scene, joint)
    }
    common = {one.key for one in settings_in(scene.bearings)} - {*SINGLE}
    engines = (
        one for one in vars(scene.numerics).values() if one.word != scene.solver.word
    )
    unused = {one.key for engine in engines for one in settings_in(engine)}
    unused |= {
        f"{joint}.{key}"
        for joint in scene.bearing_joints
        for key in unread_of(scene, joint)
    }
    return [
        one
        for one in applicable_settings_of(scene)
        if one.key not in unused
        and (one.key not in common or (one.key, one.value) in used)
    ]


def unread_of(scene: Scene, joint: str) -> tuple[str, ...]:
    """Return the keys of values of a bearing that a run of the scene does not read."""
    bearing = scene.bearing(joint)
    is_guide = any(guide.name == joint for guide in scene.loose_guides)
    return unread_in_guide(bearing) if is_guide else bearing.unread


def setting_of(scene: Scene, key: str) -> Setting:
    """Return the setting with a key, also one of a single joint; raise InputError for none."""
    settings = _by_key(scene)
    name = name_of_key(key)
    if name not in settings:
        raise _unknown_key(scene, key, settings)
    return settings[name]


def name_of_key(key: str) -> str:
    """Return a key with the name of the setting in place of its symbol.

    The name of the table that holds it in a file may stand before it.
    """
    table, _, rest = key.partition(".")
    first, dot, last = (rest if table in TABLES and rest else key).rpartition(".")
    return f"{first}{dot}{SYMBOLS.get(last, last)}"


def _by_key(scene: Scene) -> dict[str, Setting]:
    """Return all settings that a scene has by key; see ``_all_settings``."""
    return {setting.key: setting for setting in _all_settings(scene)}


def _all_settings(scene: Scene) -> Iterator[Setting]:
    """Yield all settings that a scene has, also those of each joint with a bearing."""
    yield from settings_in(scene, scene.origins)
    for joint in scene.bearing_joints:
        yield from _of_joint(scene, joint)


def _of_joint(scene: Scene, joint: str) -> Iterator[Setting]:
    for setting in settings_in(scene.bearing(joint)):
        key = f"{joint}.{setting.key}"
        meaning = setting.meaning
        if isinstance(meaning, Quantity):
            meaning = replace(meaning, origin=scene.origins.get(key, SET))
        yield Setting(key, setting.value, meaning)


def settings_in(
    owner: Any, origins: Mapping[str, str] | None = None, prefix: str = ""
) -> Iterator[Setting]:
    """Yield the settings of the parts of a data class, then those of its fields."""
    plain = []
    for name, key, value, meaning, inner in _fields_of(owner, prefix):
        if isinstance(meaning, Choice):
            setting = Setting(key, meaning.shown(value), meaning)
            if not meaning.is_part:
                plain.append(setting)
                continue
            yield setting
        elif meaning is not None:
            origin = (origins or {}).get(key, meaning.origin)
            if origin != meaning.origin:
                meaning = replace(meaning, origin=origin)
            plain.append(Setting(key, value, meaning))
        if _has_settings(value):
            for setting in settings_in(value, origins, inner):
                if name != _COMMON or setting.key not in SINGLE:
                    yield setting
    yield from plain


def _has_settings(value: Any) -> bool:
    return is_dataclass(value) and not isinstance(value, UserFunction | OutputPoint)


def _fields_of(owner: Any, prefix: str) -> Iterator[tuple[str, str, Any, Any, str]]:
    """Yield name, key, value and meaning of each field, and the prefix of the keys in it."""
    for item in fields(owner):
        if item.name in getattr(owner, "unset", ()):
            continue
        key = f"{prefix}{item.name}"
        meaning = meaning_of(item, owner)
        is_optional = isinstance(meaning, Choice) and meaning.kinds is not None
        inner = f"{key}." if is_optional else prefix
        yield item.name, key, getattr(owner, item.name), meaning, inner


@checked_arguments
def changed(scene: Scene, settings: Mapping[str, Any], origin: str = SET) -> Scene:
    """Return a scene with settings changed.

    Parameters
    ----------
    settings : mapping
        Texts with units, as on the command line, or numbers, SI, by key, or by the
        symbol of a key, such as ``c_f``. A named set or a part, such as ``geometry``,
        is applied first, so that single values can change it.
    origin : str
        Origin of the values, for the list of settings.

    Raises
    ------
    InputError
        For an unknown key, a key that stands twice, or a value that does not fit.
    """
    named = dict(_halved(name_of_key(key), value) for key, value in settings.items())
    if len(named) < len(settings):
        keys = [_radial_name(name_of_key(key)) for key in settings]
        twice = next(key for key in keys if keys.count(key) > 1)
        both = " and ".join(
            key for key, name in zip(settings, keys, strict=True) if name == twice
        )
        raise InputError(f"{both} are the same setting; set one of them")
    if scene.life is not None and f"{named.get('wear_updates')}".strip() == "0":
        named.setdefault("life", NONE)  # without wear there is no life
    _add_motor_and_servo(scene, named)
    single: dict[str, dict[str, Any]] = {name: {} for name in scene.joint_bearings}
    common = {}
    for key, value in named.items():
        first, _, last = key.rpartition(".")
        if first in scene.mechanism.allowed_joints:
            single.setdefault(first, {})[last] = value
        else:
            common[key] = value
    _release_elastic(scene, single, common)
    for_all = _without_single(common)
    bearings = {
        name: _changed(scene.bearing(name), for_all | values, message_prefix=f"{name}.")
        for name, values in single.items()
    }
    origins = {**scene.origins, **dict.fromkeys(named, origin)}
    # In one step: a new mechanism may have joints of other names.
    result: Scene = _changed(scene, common, joint_bearings=bearings, origins=origins)
    _check_keys(result, named)
    if fits := _fit_origins(result, named, origin):
        origins |= fits
        result = replace(result, origins=origins)
    if in_file := [key for key in named if scene.origins.get(key) == IN_FILE]:
        # A value that the file has already is no change of it.
        allowed = _by_key(result)
        before = _by_key(scene)
        same = [
            k for k in in_file if k in before and before[k].value == allowed[k].value
        ]
        result = replace(result, origins={**origins, **dict.fromkeys(same, IN_FILE)})
    return result


def _check_keys(scene: Scene, keys: Iterable[str]) -> None:
    """Raise InputError for a key that a scene does not have."""
    missing = set(keys)
    for setting in _all_settings(scene):
        if not missing:
            return
        missing.discard(setting.key)
    for key in keys:
        if key in missing:
            raise _unknown_key(scene, key, _by_key(scene))


def _without_single(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings without the keys that each joint has for itself."""
    return {key: value for key, value in settings.items() if key not in SINGLE}


def _release_elastic(
    scene: Scene, single: Mapping[str, dict[str, Any]], common: dict[str, Any]
) -> None:
    """Give joints that get a stiffness a bearing without clearance, in place."""
    elastic = [
        name
        for name, values in single.items()
        if f"{values.get('stiffness', NONE)}".strip() not in (NONE, "None")
    ]
    for name in elastic:
        if name not in scene.clearance_joints:
            single[name].setdefault("clearance", 0.0)
    joints = common.get("joints", scene.joints)
    if elastic and isinstance(joints, str):
        allowed = Choice((*scene.mechanism.allowed_joints, NONE), several=True)
        common["joints"] = allowed.combine((*allowed.split(joints), *elastic))


def _add_motor_and_servo(scene: Scene, settings: dict[str, Any]) -> None:
    """Add the words with which a motor or a servo that only has values begins, in place.

    A motor is there once it has a torque, and a servo with a stiffness alone turns its
    crank at a constant speed. InputError for values of a motor without a torque.
    """
    mechanism = scene.mechanism
    has_no_servo = getattr(mechanism, SERVO, NONE) is None
    if has_no_servo and f"{SERVO}.stiffness" in settings:
        settings.setdefault(SERVO, ConstantSpeed.kind)
    keys = [key for key in settings if key.partition(".")[0] == MOTOR]
    has_none = getattr(mechanism, MOTOR, NONE) is None
    if not keys or not has_none or f"{settings.get(MOTOR)}".strip() == NONE:
        return
    torque = f"{settings.get(f'{MOTOR}.torque')}".strip()
    if torque == NONE and f"{MOTOR}.law" not in settings:
        raise InputError(
            f"{MOTOR}.torque = none: a motor has a torque, such as 20 N m, or 0 N m for a free "
            f"crank; {MOTOR} = none leaves out the motor"
        )
    if f"{MOTOR}.torque" not in settings and MOTOR in vars(mechanism):
        raise InputError(
            f"{keys[0]}: a motor needs a torque, such as {MOTOR}.torque = 20 N m, or 0 N m for a "
            "free crank"
        )
    if MOTOR in vars(mechanism):
        settings.setdefault(MOTOR, ON)


def _radial_name(key: str) -> str:
    """Return a key; that of the radius or the radial clearance for one of ``DOUBLED``."""
    return _DOUBLED.sub(lambda match: DOUBLED[match[1]], key)


def _halved(key: str, value: Any) -> tuple[str, Any]:
    """Return a setting; of a diameter or a diametral clearance that of the radial one, m."""
    name = _radial_name(key)
    return name, value if name == key else halved(key.rpartition(".")[2], value)


def _fit_origins(
    scene: Scene, settings: Mapping[str, Any], origin: str
) -> dict[str, str]:
    """Return the origins of clearances that are fits: their least and largest clearance."""
    origins = {}
    for key, value in settings.items():
        joint, _, name = key.rpartition(".")
        if name == "clearance" and (fit := fit_of(value)):
            bearing = scene.bearing(joint) if joint else scene.bearings
            ends = clearances_of(fit, 2.0 * bearing.bearing_radius)
            low, high = (f"{1e3 * end:.6g}" for end in ends)
            origins[key] = f"{origin}: middle of {fit.text}, {low} to {high} mm"
    return origins


def _unknown_key(scene: Scene, key: str, allowed: Mapping[str, Setting]) -> InputError:
    first, _, last = name_of_key(key).rpartition(".")
    if last in DOUBLED:
        of_what = "diametral clearance" if last == DIAMETRAL else "diameter"
        return InputError(
            f"{key}: use {_radial_name(key)}, which is half the {of_what}"
        )
    if first in (MOTOR, SERVO) and first not in allowed:
        drives = (
            f"; specify the {MOTOR} of a drive in mechanism.drives"
            if isinstance(scene.mechanism, Linkage)
            else ""
        )
        return InputError(
            f"{key}: mechanism {scene.mechanism.kind} has no {first}{drives}"
        )
    if not first and last in SINGLE:
        joint = scene.mechanism.linkage().revolutes[-1].name
        return InputError(f"{key}: name the joint, for example {joint}.{last}")
    part = allowed.get(first)
    if part is not None and part.value == NONE:
        kinds = ", ".join(
            name for name in cast(Choice, part.meaning).words if name != NONE
        )
        return InputError(f"{key}: {first} = {NONE}; it needs {first} = {kinds}")
    if first in scene.mechanism.allowed_joints and first not in scene.bearing_joints:
        return InputError(
            f"{key}: joint {first} has no clearance; joints = {scene.joints}"
        )
    inner = [
        name.rpartition(".")[2] for name in allowed if name.startswith(f"{first}.")
    ]
    if part is not None and inner:
        return unknown(f"key of {first}", last, inner)
    if (
        first not in scene.bearing_joints
        and part is None
        and last in vars(scene.bearings)
    ):
        return unknown(f"joint in {key}:", first, scene.mechanism.allowed_joints)
    names = [
        name for name in allowed if name.rpartition(".")[0] not in scene.bearing_joints
    ]
    if first in scene.bearing_joints:
        names = [f"{first}.{name}" for name in (*inner, *DOUBLED)]
    hint = nearest(key, [*names, *DOUBLED, *SYMBOLS])
    absent = not_modelled(key)
    others = "." if absent else "; presswear list SCENE shows all keys"
    return InputError(f"unknown key {shown(key)}{hint or others} {absent}".rstrip())


def _changed(
    owner: Any,
    settings: Mapping[str, Any],
    prefix: str = "",
    message_prefix: str = "",
    **updates: Any,
) -> Any:
    """Return a data class with its fields, and those of its parts, set by key."""
    for name, key, value, meaning, inner in _fields_of(owner, prefix):
        result = settings.get(key, value) if meaning is not None else value
        if isinstance(meaning, Choice) and result is not value and meaning.is_part:
            is_same = result == meaning.shown(value)
            result = (
                value
                if is_same
                else meaning.chosen(f"{message_prefix}{key}", result, value)
            )
        if _has_settings(result) and name not in updates:
            mine = _without_single(settings) if name == _COMMON else settings
            result = _changed(result, mine, inner, message_prefix)
        if result is not value:
            updates[name] = result
    if not updates:
        return owner
    try:
        return replace(owner, **updates)
    except InputError as error:
        is_named = prefix and f"{error}".startswith(f"{prefix[:-1]}: ")
        label = message_prefix if is_named else f"{message_prefix}{prefix}"
        raise InputError(f"{label}{error}") from None


def values_of(key: str, text: str, meaning: Quantity) -> list[float]:
    """Return the values of a list or a range, SI, in the order in which they are typed.

    A list is as ``0.02,0.05,0.1``. A range has both ends and a number of values, in
    equal steps as ``2pi:12pi:200 rad/s``, or in equal ratios as
    ``1e8N/m:1e10N/m:5:log``. InputError with the key.
    """
    fit_text, _, count_text = text.rpartition(":")
    if fit := fit_of(fit_text):
        if fit.diameter is None or not count_text.strip().isdigit():
            raise InputError(
                f"{key} = {text}: a fit with its diameter and a number of values is expected, "
                "such as 110 H8/f7:5"
            )
        least, largest = clearances_of(fit, fit.diameter)
        return values_of(key, f"{least!r} m:{largest!r} m:{count_text}", meaning)
    if ":" not in text:
        return [
            float(parse_quantity(key, part.strip(), meaning))
            for part in text.split(",")
        ]
    match = _RANGE.match(text)
    if match is None:
        raise InputError(
            f"{key} = {text}: FIRST:LAST:COUNT or FIRST:LAST:COUNT:log is expected"
        )
    low, high, count, unit, log, unit_behind = match.groups("")
    if not 2 <= int(count) <= _MAX_VALUES:
        raise InputError(
            f"{key} = {text}: a number of values from 2 to {_MAX_VALUES} is expected"
        )
    first, final = (
        float(parse_quantity(key, f"{end} {unit or unit_behind}".strip(), meaning))
        for end in (low, high)
    )
    if first == final:
        raise InputError(f"{key} = {text}: two ends that differ are expected")
    if log and min(first, final) <= 0.0:
        raise InputError(f"{key} = {text}: equal ratios need ends above 0")
    space = np.geomspace if log else np.linspace
    values = [
        float(f"{value:.{_DIGITS}g}") for value in space(first, final, int(count))
    ]
    for value in values:
        meaning.check(
            key, int(value) if meaning.whole and value.is_integer() else value
        )
    return values


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
            return f"{UserFunction(**value)}"
        text = f"{value}"
        is_long = len(text) > _MAX_VALUE_LENGTH
        return f"{text[:20]}... ({digest(text.encode())[:12]})" if is_long else value

    return [] if first == second else [(key, short(first), short(second))]


def on_surfaces(scene: Scene, surfaces: Any, source: str) -> Scene:
    """Return a scene with initial surfaces, and a word on their source for messages."""
    try:
        return replace(
            scene, surfaces=surfaces, origins={**scene.origins, "surfaces": source}
        )
    except InputError as error:
        raise InputError(f"{source}: {error}") from None


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
