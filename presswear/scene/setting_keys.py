"""Settings of a scene by their keys, and messages for keys that it does not have."""

import re
from collections.abc import Iterable, Mapping
from typing import cast

from presswear.linkage.linkage import Linkage
from presswear.scene.bearing import DIAMETRAL, DOUBLED, NOT_COMMON
from presswear.scene.scene import Scene
from presswear.scene.setting_list import Setting, all_settings
from presswear.tools.choices import NONE, Choice
from presswear.tools.errors import InputError, nearest, shown, unknown
from presswear.tools.not_modelled import not_modelled
from presswear.tools.symbols import SYMBOLS

TABLES = "mechanism", "bearings", "limits", "settings"  # tables of a file
# Tables with the settings of a drive, which a file may have without a kind
MOTOR = "motor"
SERVO = "servo"
LAWS = "normal_law", "friction_law", "wear_law"  # settings that may be user laws
_DOUBLED = re.compile(rf"(?:^|(?<=\.))({'|'.join(DOUBLED)})$")


def setting_of(scene: Scene, key: str) -> Setting:
    """Return the setting with a key; raise InputError if the scene does not have the key."""
    settings = settings_by_key(scene)
    name = name_of_key(key)
    if name not in settings:
        raise _unknown_key(scene, key, settings)
    return settings[name]


def name_of_key(key: str) -> str:
    """Return a key with the name of the setting in place of its symbol.

    The key may begin with the name of its table in a file, which is left out. The law in
    the table of a user law has the key of the table, and numbers of a law have no symbols.
    """
    table, _, key_in_table = key.partition(".")
    if table in TABLES and key_in_table:
        key = key_in_table
    first, dot, last = key.rpartition(".")
    if first.rpartition(".")[2] in LAWS:
        return first if last == "law" else f"{first}.{last}"
    return f"{first}{dot}{SYMBOLS.get(last, last)}"


def settings_by_key(scene: Scene) -> dict[str, Setting]:
    """Return all settings that a scene has by key; see ``all_settings``."""
    return {setting.key: setting for setting in all_settings(scene)}


def check_keys(scene: Scene, keys: Iterable[str]) -> None:
    """Raise InputError for a key that a scene does not have."""
    missing = set(keys)
    for setting in all_settings(scene):
        if not missing:
            return
        missing.discard(setting.key)
    for key in keys:
        if key in missing:
            raise _unknown_key(scene, key, settings_by_key(scene))


def radial_name(key: str) -> str:
    """Return a key with radius or radial clearance in place of a setting of ``DOUBLED``."""
    return _DOUBLED.sub(lambda match: DOUBLED[match[1]], key)


def _unknown_key(scene: Scene, key: str, allowed: Mapping[str, Setting]) -> InputError:
    """Return the error for a key that a scene does not have, with the closest advice.

    ``first`` is the part of a key before its last dot: a joint, or a part such as
    ``process``.
    """
    first, _, last = name_of_key(key).rpartition(".")
    reason = _reason_for_absence(scene, key, allowed)
    if reason:
        return InputError(f"{key}: {reason}")
    is_joint = first in scene.bearing_joints
    inner = []  # keys behind ``first``
    for name in allowed:
        if name.startswith(f"{first}."):
            inner.append(name.removeprefix(f"{first}."))
    if first in allowed and inner:
        return unknown(f"key of {first}", last, inner)
    if first not in allowed and not is_joint and last in vars(scene.bearings):
        return unknown(f"joint in {key}:", first, scene.mechanism.allowed_joints)
    if absent := not_modelled(key):
        return InputError(f"unknown key {shown(key)}. {absent}")
    if is_joint:
        names = [f"{first}.{name}" for name in (*inner, *DOUBLED)]
    else:
        joints = scene.bearing_joints
        names = [name for name in allowed if name.rpartition(".")[0] not in joints]
    hint = nearest(key, [*names, *DOUBLED, *SYMBOLS])
    advice = "; presswear list SCENE --all shows all keys"
    return InputError(f"unknown key {shown(key)}{hint or advice}")


def _reason_for_absence(scene: Scene, key: str, allowed: Mapping[str, Setting]) -> str:
    """Return why a scene does not have a key of presswear; empty for any other key."""
    first, _, last = name_of_key(key).rpartition(".")
    if last in DOUBLED:
        of_what = "diametral clearance" if last == DIAMETRAL else "diameter"
        return f"use {radial_name(key)}, which is half the {of_what}"
    if first in (MOTOR, SERVO) and first not in allowed:
        advice = ""
        if isinstance(scene.mechanism, Linkage):
            advice = f"; specify the {MOTOR} of a drive in mechanism.drives"
        return f"mechanism {scene.mechanism.kind} has no {first}{advice}"
    if not first and last in NOT_COMMON:
        joint = scene.mechanism.linkage().revolutes[-1].name
        return f"name the joint, for example {joint}.{last}"
    owner = allowed.get(first)
    if owner is not None and owner.value == NONE:
        kinds = [word for word in cast(Choice, owner.meaning).words if word != NONE]
        return f"{first} = {NONE}; it needs {first} = {', '.join(kinds)}"
    if first in scene.mechanism.allowed_joints and first not in scene.bearing_joints:
        return f"joint {first} has no clearance; joints = {scene.joints}"
    return ""
