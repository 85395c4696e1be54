"""What a person changed in a scene: against the named scene that it was, or the defaults."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from presswear.linkage.linkage import Linkage
from presswear.scene.catalog import SCENES
from presswear.scene.scene import Scene
from presswear.scene.settings import DEFAULT, IN_FILE, differences, replaced, settings_of
from presswear.tools.numbers import given
from presswear.tools.quantities import kinds_of, sets_of

_TOLD = 4
"""Most changes in a title; of more, the last place counts the others."""
_LARGEST_MM = 1.0
"""Lengths below this are told in mm, m."""


@dataclass(frozen=True)
class Change:
    """A value that is not what it was.

    Attributes
    ----------
    key, meaning : str
        Its key, and what it means.
    value, was, unit : str
        Both values in one unit.
    """

    key: str
    value: str
    was: str
    unit: str
    meaning: str

    def __str__(self) -> str:
        return f"{self.key.replace('_', ' ')} {self.value} {self.unit}".rstrip()


def named_scene(scene: Scene) -> Scene | None:
    """The named scene whose title, or else whose name, a scene has; None where there is none."""
    titles = {entry.title: name for name, entry in SCENES.items()}
    name = titles.get(scene.title, scene.name)
    return SCENES[name].make() if name in SCENES else None


def changes_of(scene: Scene) -> tuple[Change, ...]:
    """What differs from the named scene that a scene was, or from the defaults of its kind.

    A value that took the place of one in a file is told beside that.

    What follows from a named set that was taken, such as ``conventions``, is not told again.
    """
    base = named_scene(scene)
    if base is None:
        own = scene.mechanism
        base = Scene(own if isinstance(own, Linkage) else type(own)())
        if DEFAULT in scene.statuses.values():
            base = replace(base, wear_updates=0)  # a file that says nothing on it
    found, before = [], dict(_before(scene, base))
    for joint, own_bearing in scene.apart.items():
        before |= {f"{joint}.{key}": was for key, was in _before(own_bearing, base.bearing(joint))}
    for setting in settings_of(scene):
        was = replaced(setting, scene.statuses)
        was = before.get(setting.key, was) if was == setting.value else was
        if setting.value == was:
            continue
        meaning = setting.meaning
        unit = meaning.unit
        values = [own for own in (setting.value, was) if isinstance(own, float)]
        factor = 1.0
        if unit == "m" and values and max(map(abs, values)) < _LARGEST_MM:
            factor, unit = 1e3, "mm"
        value, before_it = (_text(own, factor) for own in (setting.value, was))
        unit = unit.replace("^2", "²")
        found.append(Change(setting.key, value, before_it, unit, meaning.text))
    return (*found, *_parts(scene, base))


def _parts(scene: Scene, base: Scene) -> Iterator[Change]:
    """Changes of what is no single setting: the mechanism, and the surfaces begun on."""
    own, other = scene.as_dict(), base.as_dict()
    keys = {setting.key for setting in settings_of(scene)}
    off = [key for key, *_ in differences(other["mechanism"], own["mechanism"]) if key not in keys]
    if off:
        text = "what moves; differs in " + ", ".join(dict.fromkeys(off))
        yield Change("mechanism", _called(scene), _called(base), "", text)
    if scene.surfaces and own["surfaces"] != other["surfaces"]:
        source = scene.statuses.get("surfaces", "a script")
        text = "surfaces that every start begins on"
        yield Change("surfaces", f"from {source}", "round", "", text)


def _called(scene: Scene) -> str:
    mechanism = scene.mechanism
    return mechanism.name if isinstance(mechanism, Linkage) else mechanism.kind


def _before(owner: Any, base: Any) -> Iterator[tuple[str, Any]]:
    """Values that the settings of an owner had in another of its class, by their keys.

    Behind a named set that the owner took, or a part of another kind, those that it came with.
    """
    for item in fields(owner):
        value, was = getattr(owner, item.name), getattr(base, item.name)
        sets, kinds = sets_of(item), kinds_of(item)
        if kinds is not None:
            yield item.name, "none" if was is None else was.kind
            if value is not None:
                own = was if type(was) is type(value) else type(value)()
                yield from ((f"{item.name}.{key}", old) for key, old in _before(value, own))
            continue
        if sets is not None:
            # One without a name is told by what differs in it.
            yield item.name, was.name if value.name in sets.sets else value.name
            was = was if value.name == was.name else sets.sets.get(value.name, was)
        if is_dataclass(value) and type(was) is type(value):
            yield from _before(value, was)
        elif not is_dataclass(value):
            yield item.name, was


def _text(value: Any, factor: float) -> str:
    if value is None:
        return "none"
    if isinstance(value, int | float):
        return given(factor * value)
    return f"{value}"


def title_of(scene: Scene) -> str:
    """The title of what was run.

    A named scene that was changed is no longer what its title says: the changes stand behind it,
    and so they do of a scene from a file that was changed where it was run.
    """
    is_own = named_scene(scene) is not None and all(
        scene.title != entry.title for entry in SCENES.values()
    )
    return scene.title if is_own else _with_changes(scene.title, scene)


def name_of(scene: Scene) -> str:
    """The name of what was run, as ``title_of`` tells its title."""
    return _with_changes(scene.name, scene)


def short_name_of(scene: Scene) -> str:
    """The name of what was run where there is no room for what was changed."""
    return scene.name if name_of(scene) == scene.name else f"{scene.name}, changed"


def _with_changes(first: str, scene: Scene) -> str:
    changes = changes_of(scene)
    if named_scene(scene) is None:
        in_file = {IN_FILE, DEFAULT, None}
        changes = tuple(own for own in changes if scene.statuses.get(own.key) not in in_file)
    if not changes:
        return first
    told = list(map(str, changes))
    if len(told) > _TOLD:
        told[_TOLD - 1 :] = [f"{len(told) - _TOLD + 1} more"]
    return f"{first}, changed: {', '.join(told)}"
