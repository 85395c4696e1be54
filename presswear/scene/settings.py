"""Changes of the settings of a scene by their keys.

Keys are the names of the fields of a scene and of its parts, without the names of the
parts. A part that may be absent and a single joint are named before a dot:
``process.force``, ``A.clearance``.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

from presswear.linkage.servos import ConstantSpeed
from presswear.scene.bearing import NOT_COMMON, halved
from presswear.scene.fits import clearances_of, fit_of
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import (
    MOTOR,
    SERVO,
    check_keys,
    name_of_key,
    radial_name,
    settings_by_key,
)
from presswear.scene.setting_list import COMMON, IN_FILE, SET, fields_of, has_settings
from presswear.tools.arguments import checked_arguments
from presswear.tools.choices import NONE, ON, Choice
from presswear.tools.errors import InputError


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
    named = _by_name(settings)
    if scene.life is not None and f"{named.get('wear_updates')}".strip() == "0":
        named.setdefault("life", NONE)  # without wear there is no life
    _add_motor_and_servo(scene, named)
    single: dict[str, dict[str, Any]] = {name: {} for name in scene.joint_bearings}
    common = {}
    for key, value in named.items():
        joint, name = _joint_and_name(key, scene.mechanism.allowed_joints)
        if joint:
            single.setdefault(joint, {})[name] = value
        else:
            common[key] = value
    _release_elastic(scene, single, common)
    bearings = {}
    for joint, values in single.items():
        all_values = _without_single(common) | values
        bearings[joint] = _changed(scene.bearing(joint), all_values, label=f"{joint}.")
    origins = {**scene.origins, **dict.fromkeys(named, origin)}
    # In one step: a new mechanism may have joints of other names.
    result: Scene = _changed(scene, common, joint_bearings=bearings, origins=origins)
    check_keys(result, named)
    special_origins = _fit_origins(result, named, origin)
    special_origins |= _origins_in_file(scene, result, named)
    if not special_origins:
        return result
    return replace(result, origins=origins | special_origins)


def _by_name(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings by the names of their keys, radii in place of diameters."""
    keys: dict[str, str] = {}
    named = {}
    for key, value in settings.items():
        name = name_of_key(key)
        radial = radial_name(name)
        if radial in keys:
            raise InputError(
                f"{keys[radial]} and {key} are the same setting; set one of them"
            )
        keys[radial] = key
        is_doubled = radial != name
        named[radial] = halved(name.rpartition(".")[2], value) if is_doubled else value
    return named


def _origins_in_file(
    scene: Scene, result: Scene, keys: Iterable[str]
) -> dict[str, str]:
    """Return the origins of values that a file has already: they are no changes of it."""
    in_file = [key for key in keys if scene.origins.get(key) == IN_FILE]
    if not in_file:
        return {}
    before = settings_by_key(scene)
    after = settings_by_key(result)
    origins = {}
    for key in in_file:
        if key in before and before[key].value == after[key].value:
            origins[key] = IN_FILE
    return origins


def _joint_and_name(key: str, joints: Collection[str]) -> tuple[str, str]:
    """Return the joint with which a key begins, or an empty text, and the name behind it."""
    joint = key
    while joint and joint not in joints:
        joint = joint.rpartition(".")[0]
    return joint, key.removeprefix(joint).removeprefix(".")


def _without_single(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings without the keys that each joint has for itself."""
    return {key: value for key, value in settings.items() if key not in NOT_COMMON}


def _release_elastic(
    scene: Scene, single: Mapping[str, dict[str, Any]], common: dict[str, Any]
) -> None:
    """Give joints that get a stiffness a bearing without clearance, in place."""
    elastic = []
    for name, values in single.items():
        stiffness = f"{values.get('stiffness', NONE)}".strip()
        if stiffness in (NONE, "None"):
            continue
        elastic.append(name)
        if name not in scene.clearance_joints:
            values.setdefault("clearance", 0.0)
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


def _changed(
    owner: Any,
    settings: Mapping[str, Any],
    prefix: str = "",
    label: str = "",
    **updates: Any,
) -> Any:
    """Return a data class with its fields, and those of its parts, set by key.

    ``prefix`` is the beginning of the keys, and ``label`` that of messages.
    """
    for name, key, value, meaning, inner_prefix in fields_of(owner, prefix):
        result = value if meaning is None else settings.get(key, value)
        if isinstance(meaning, Choice) and meaning.is_part:
            result = meaning.chosen(f"{label}{key}", result, value)
        if isinstance(meaning, Choice) and meaning.parameters:
            numbers = _numbers_of(key, settings)
            result = meaning.with_numbers(f"{label}{key}", result, numbers)
        if has_settings(result) and name not in updates:
            allowed = _without_single(settings) if name == COMMON else settings
            result = _changed(result, allowed, inner_prefix, label)
        if result is not value:
            updates[name] = result
    if not updates:
        return owner
    try:
        return replace(owner, **updates)
    except InputError as error:
        is_named = prefix and f"{error}".startswith(f"{prefix[:-1]}: ")
        full_label = label if is_named else f"{label}{prefix}"
        raise InputError(f"{full_label}{error}") from None


def _numbers_of(key: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of the numbers of a user law, by their names."""
    start = f"{key}."
    return {
        name.removeprefix(start): value
        for name, value in settings.items()
        if name.startswith(start)
    }


def on_surfaces(scene: Scene, surfaces: Any, source: str) -> Scene:
    """Return a scene with initial surfaces, and a word on their source for messages."""
    try:
        return replace(
            scene, surfaces=surfaces, origins={**scene.origins, "surfaces": source}
        )
    except InputError as error:
        raise InputError(f"{source}: {error}") from None
