"""Settings of a scene: keys, values, and text that changes them.

Keys are the names of the fields of a scene and its parts, without the parts' names.
"""

from collections.abc import Iterator, Mapping
from dataclasses import Field, dataclass, fields, is_dataclass, replace
from typing import Any

from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.scene.surfaces import Surfaces
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import digest
from presswear.tools.own import OwnFunction, is_function
from presswear.tools.quantities import (
    NONE,
    Choice,
    Kinds,
    Meaning,
    Words,
    choice_of,
    kinds_of,
    meaning_of,
    parse_quantity,
    sets_of,
    words_of,
)

_LONGEST = 200
"""Characters of a value that is told in full."""

SET = "set by the user"
"""Status of a value that was changed."""
IN_FILE = f"{SET}, in the file"
DEFAULT = "default"
"""Statuses of the values of a file: those that it gives, and the others.

Behind the first stands the value of the file where another was set in its place.
"""


@dataclass(frozen=True)
class Setting:
    """One thing that ``--set`` can change."""

    key: str
    value: Any
    meaning: Meaning | Choice | Words

    def described(self) -> str:
        """Value, range and text in one line."""
        if not isinstance(self.meaning, Meaning):
            return f"{self.value}  ({' | '.join(self.meaning.listed())})  {self.meaning.text}"
        value = "none" if self.value is None else self.meaning.with_unit(f"{self.value:.6g}")
        return f"{value}  ({self.meaning.range_text()}; {self.meaning.status})  {self.meaning.text}"


def settings_of(scene: Scene) -> Iterator[Setting]:
    """Everything that ``--set`` can change, with its present value.

    Of bearings set apart, ``JOINT.KEY``, what differs from the others.
    """
    yield from _settings(scene, scene.statuses)
    common = {setting.key: setting.value for setting in _settings(scene.bearings, {})}
    for name, own in scene.apart.items():
        for setting in _settings(own, {}):
            if setting.value != common[setting.key]:
                yield replace(setting, key=f"{name}.{setting.key}")


def setting_of(scene: Scene, key: str) -> Setting:
    """The setting that a key changes, those of single joints, ``JOINT.KEY``, among them.

    InputError for a key that is none, with the nearest that is one.
    """
    known = {setting.key: setting for setting in settings_of(scene)}
    for joint in scene.clearance_joints:
        for setting in _settings(scene.bearing(joint), {}):
            own = f"{joint}.{setting.key}"
            known.setdefault(own, replace(setting, key=own))
    if key not in known:
        raise unknown("key", key, sorted(known))
    return known[key]


def _settings(owner: Any, statuses: Mapping[str, str]) -> Iterator[Setting]:
    """The parts of an owner first, then its own values."""
    for item in fields(owner):
        value = getattr(owner, item.name)
        sets, kinds = sets_of(item), kinds_of(item)
        if sets is not None:
            yield Setting(item.name, value.name, sets.choice)
        if kinds is not None:
            yield from _of_kind(item.name, value, kinds, statuses)
        elif is_dataclass(value):
            yield from _settings(value, statuses)
    for item in fields(owner):
        meaning, words = meaning_of(item), choice_of(item, owner)
        if meaning is not None:
            status = statuses.get(item.name, meaning.status)
            yield Setting(item.name, getattr(owner, item.name), replace(meaning, status=status))
        elif text := words or words_of(item):
            yield Setting(item.name, getattr(owner, item.name), text)


def _of_kind(name: str, value: Any, kinds: Kinds, statuses: Mapping[str, str]) -> Iterator[Setting]:
    """The kind of a part that may be none, then its own values, ``NAME.KEY``."""
    yield Setting(name, _kind(value), kinds.choice)
    if value is not None:
        first = f"{name}."
        for setting in _settings(value, _within(first, statuses)):
            yield replace(setting, key=f"{first}{setting.key}")


def _within(first: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """The values whose keys begin in one way, by the rest of their keys."""
    return {key.removeprefix(first): own for key, own in values.items() if key.startswith(first)}


def _kind(value: Any) -> str:
    return NONE if value is None else str(value.kind)


def differences(first: Any, second: Any, key: str = "") -> list[tuple[str, Any, Any]]:
    """Keys under which two stored scenes differ, and both values; a part by its own keys.

    The name of a part stands under the part's key.  A function of one's own is told by its
    name and digest, and what would fill a screen by its beginning and digest.
    """
    if is_function(first) or is_function(second):
        first, second = (
            f"{OwnFunction(**own)}" if is_function(own) else own for own in (first, second)
        )
    elif isinstance(first, Mapping) and isinstance(second, Mapping):
        return [
            found
            for name in dict.fromkeys([*first, *second])
            for found in differences(
                first.get(name), second.get(name), key if key and name == "name" else name
            )
        ]
    return [] if first == second else [(key, _short(first), _short(second))]


def _short(value: Any) -> Any:
    text = f"{value}"
    return value if len(text) <= _LONGEST else f"{text[:20]}... ({digest(text.encode())[:12]})"


def changed(scene: Scene, settings: Mapping[str, Any]) -> Scene:
    """The scene with settings given as text with units, as on the command line, or as numbers, SI.

    A named set (``geometry``) is taken first, so that single values can be set on top.

    Raises
    ------
    InputError
        For a key that is none, or a value that does not fit.
    """
    known = {setting.key for setting in settings_of(scene) if "." not in setting.key}
    owners = (scene, scene.mechanism)
    parts = {own.name for part in owners for own in fields(part) if kinds_of(own) is not None}
    of_one = {setting.key for setting in _settings(scene.bearings, {})}
    apart: dict[str, dict[str, Any]] = {name: {} for name in scene.apart}
    for key, value in settings.items():
        joint, dot, own = key.rpartition(".")
        if not dot and key not in known:
            raise unknown("key", key, sorted(known))
        if dot and joint not in parts:
            if joint not in scene.mechanism.openable:
                raise unknown(f"joint in {key}", joint, scene.mechanism.openable)
            if own not in of_one:
                raise unknown(f"key of a joint in {key}", own, sorted(of_one))
            apart.setdefault(joint, {})[own] = value
    statuses = {**scene.statuses, **{key: _status(scene, key) for key in settings}}
    common = {key: value for key, value in settings.items() if key.rpartition(".")[0] not in apart}
    bearings = {name: _with(scene.bearing(name), common | own, name) for name, own in apart.items()}
    # Put together at once: a new mechanism may have other joints.
    found = replace(scene, statuses=statuses, apart=bearings, **_updates(scene, common))
    for key in settings:
        joint = key.rpartition(".")[0]
        if joint in apart and joint not in found.clearance_joints:
            raise InputError(f"{key}: joint {joint} has no clearance; joints = {found.joints}")
    return found


def _status(scene: Scene, key: str) -> str:
    """Status of a value that is set, by its key; it keeps that of the file that it replaces."""
    status = scene.statuses.get(key, "")
    if status != IN_FILE:
        return status if status.startswith(IN_FILE) else SET
    found = {own.key: own for own in settings_of(scene)}
    own = found.get(key) or found[key.rpartition(".")[2]]
    if own.value is None or not isinstance(own.meaning, Meaning):
        return f"{IN_FILE} {NONE if own.value is None else own.value}"
    return f"{IN_FILE} {own.meaning.with_unit(f'{own.value!r}')}"


def replaced(setting: Setting, statuses: Mapping[str, str]) -> Any:
    """Value of the file that a setting has taken the place of; its own where there is none."""
    _, is_there, text = statuses.get(setting.key, "").partition(f"{IN_FILE} ")
    if not is_there:
        return setting.value
    if not isinstance(setting.meaning, Meaning):
        return text
    return None if text == NONE else parse_quantity(setting.key, text, setting.meaning)


def begun_on(scene: Scene, surfaces: Surfaces, source: str) -> Scene:
    """The scene begun on surfaces, with a word on where they come from.

    Raises
    ------
    InputError
        Naming the source, where they do not fit the scene.
    """
    try:
        statuses = {**scene.statuses, "surfaces": source}
        return replace(scene, surfaces=surfaces, statuses=statuses)
    except InputError as error:
        raise InputError(f"{source}: {error}") from None


def _with(bearing: Bearing, settings: Mapping[str, Any], joint: str) -> Bearing:
    """The bearing of one joint with settings changed; InputError names the joint."""
    try:
        return replace(bearing, **_updates(bearing, settings))
    except InputError as error:
        raise InputError(f"{joint}.{error}") from None


def _updates(owner: Any, settings: Mapping[str, Any]) -> dict[str, Any]:
    """New values of the fields of an owner that settings change."""
    updates: dict[str, Any] = {}
    for item in fields(owner):
        value, is_given = getattr(owner, item.name), item.name in settings
        words, meaning, kinds = choice_of(item, owner), meaning_of(item), kinds_of(item)
        if kinds is not None:
            updates[item.name] = _made(item.name, value, kinds, settings)
        elif words is not None:
            # First: a law of one's own is data, but no part with settings of its own.
            if is_given:
                updates[item.name] = words.read(item.name, settings[item.name])
        elif is_dataclass(value):
            updates[item.name] = _part(item, value, settings)
        elif is_given and meaning is not None:
            given = settings[item.name]
            is_text = isinstance(given, str)
            updates[item.name] = parse_quantity(item.name, given, meaning) if is_text else given
        elif is_given and words_of(item) is not None:
            updates[item.name] = settings[item.name]
    return updates


def _made(name: str, value: Any, kinds: Kinds, settings: Mapping[str, Any]) -> Any:
    """A part that may be none, of the kind that is asked for, with its own fields changed."""
    kind, first = settings.get(name, _kind(value)), f"{name}."
    kinds.choice.check(name, kind)
    own = _within(first, settings)
    if kind == NONE:
        for key in own:
            raise InputError(
                f"{name}.{key}: {name} = {NONE}; with it goes {name} = {', '.join(kinds.kinds)}"
            )
        return None
    part = value if kind == _kind(value) else kinds.kinds[kind]()
    known = [item.name for item in fields(part)]
    for key in own:
        if key not in known:
            raise unknown(f"key of {kind} in {name}.{key}", key, known)
    try:
        return replace(part, **_updates(part, own))
    except InputError as error:
        raise InputError(f"{name}.{error}") from None


def _part(item: Field[Any], value: Any, settings: Mapping[str, Any]) -> Any:
    """A part of an owner, taken by its name where it has one, with its own fields changed."""
    sets = sets_of(item)
    if sets is not None and item.name in settings:
        sets.choice.check(item.name, settings[item.name])
        value = sets.sets[settings[item.name]]
    updates = _updates(value, settings)
    if sets is not None and updates and any(own.name == "name" for own in fields(value)):
        updates["name"] = f"{value.name}, changed"
    return replace(value, **updates)
