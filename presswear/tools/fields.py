"""Fields of data classes that a user sets.

``quantity``, ``count``, ``choice``, ``free_text``, ``named_set``, ``one_of`` and
``optional`` make the fields. Help, error messages, files and reports read the meaning of
a value from its field.
"""

from collections.abc import Mapping
from dataclasses import Field, field, replace
from typing import Any, get_args

from presswear.tools.choices import NONE, ON, Choice
from presswear.tools.quantities import Quantity


def quantity(
    default: float | None,
    unit: str,
    low: float,
    high: float,
    origin: str,
    text: str,
    **more: bool,
) -> Any:
    """Return a field for a number with a unit; ``more`` are fields of ``Quantity``."""
    return _field(default, Quantity(unit, low, high, origin, text, **more))


def _field(default: Any, meaning: Quantity | Choice) -> Any:
    return field(default=default, metadata={"meaning": meaning})


def count(default: int | None, low: int, high: int, origin: str, text: str) -> Any:
    """Return a data class field for a whole number without a unit."""
    return quantity(default, "", low, high, origin, text, whole=True)


def choice(
    default: str | None,
    words: Any,
    text: str,
    parameters: Any = (),
    several: bool = False,
) -> Any:
    """Return a data class field for one of a few words, also those of a Literal; see ``Choice``."""
    return _field(default, Choice(get_args(words) or words, text, parameters, several))


def free_text(default: str, example: str, text: str) -> Any:
    """Return a data class field for a text that its owner reads."""
    return _field(default, Choice((), text, example=example))


def named_set(
    default: str,
    instances: Mapping[str, Any],
    text: str,
    stays: tuple[str, ...] = (),
) -> Any:
    """Return a data class field for one of some data class instances, or a changed one.

    ``stays`` are fields that no instance states: they stay when a name is chosen.
    """
    choice = Choice(tuple(instances), text, instances=instances, stays=stays)
    return _field(instances[default], choice)


def one_of(kinds: Mapping[str, Any], text: str) -> Any:
    """Return a data class field for an instance of one of some data classes, or None."""
    return _field(None, Choice((NONE, *kinds), text, kinds=kinds))


def optional(kind: Any, needed: Mapping[str, Any], text: str) -> Any:
    """Return a data class field for an instance of a data class, or None.

    ``needed`` are first values of the fields that have no default.
    """
    return _field(None, Choice((NONE, ON), text, kinds={ON: kind}, needed=needed))


def meaning_of(item: Field[Any], owner: Any = None) -> Quantity | Choice | None:
    """Return the meaning of a field, None without; the words of a choice may need the owner."""
    meaning = item.metadata.get("meaning")
    if meaning is None:
        for annotation in getattr(item.type, "__metadata__", ()):
            if isinstance(annotation, Quantity | Choice):
                meaning = annotation
    if isinstance(meaning, Choice) and callable(meaning.words):
        return replace(meaning, words=meaning.words(owner))
    return meaning
