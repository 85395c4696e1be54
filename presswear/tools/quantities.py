"""Physical quantities: what a field means, its unit and range, and how it is typed.

Every number that a person may set is a dataclass field made by ``quantity``; the
field carries its unit, range, where the value comes from and a description, so
that the help, the error messages and the report all speak from one place.
"""

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import Field, asdict, dataclass, field, fields
from typing import Any, ClassVar

from presswear.tools.errors import InputError, nearest, shown, unknown
from presswear.tools.own import OwnFunction
from presswear.tools.units import apart, in_si, units_of


@dataclass(frozen=True)
class Meaning:
    """Meaning of a quantity: unit (empty for a pure number), range, origin, text.

    The range includes its ends unless ``open_low`` excludes the lower one.
    """

    unit: str
    low: float
    high: float
    status: str
    text: str
    open_low: bool = False
    whole: bool = False

    def with_unit(self, value: str) -> str:
        """A value as text with the unit behind it."""
        return f"{value} {self.unit}".rstrip()

    def typed(self, value: float, inward: float) -> str:
        """A value in six digits, rounded up or down so that it can be typed where it is in range.

        In all digits where the range is narrower than that.
        """
        short = float(f"{value:g}")
        if (short - value) * inward < 0.0:
            short += inward * 10.0 ** (math.floor(math.log10(abs(value))) - 5)
        text = f"{short:g}"
        return text if self.low <= float(text) <= self.high else f"{value!r}"

    def range_text(self) -> str:
        """The allowed range as a person reads it, with the unit."""
        if math.isinf(self.high) and math.isinf(self.low):
            return self.with_unit(f"any finite number{' in' if self.unit else ''}")
        low = self.typed(self.low, 1.0)
        if math.isinf(self.high):
            return self.with_unit(f"{'above' if self.open_low else 'at least'} {low}")
        first = f"above {low} up to" if self.open_low else f"{low} to"
        return self.with_unit(f"{first} {self.typed(self.high, -1.0)}")

    def allows(self, value: float) -> bool:
        """True for a finite number in range."""
        is_above = self.low < value if self.open_low else self.low <= value
        return math.isfinite(value) and is_above and value <= self.high

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is a finite number in range."""
        kind = int if self.whole else (int, float)
        if not isinstance(value, kind) or isinstance(value, bool):
            raise InputError(
                f"{name} = {shown(value)}: a {'whole ' if self.whole else ''}number is expected; "
                f"allowed is {self.range_text()}"
            )
        # Beyond all floats: a whole number that was stored may be of any length.
        if abs(value) > sys.float_info.max:
            value = math.inf if value > 0 else -math.inf
        if not self.allows(value):
            told = f"{value:g}"
            # What is outside by a hair must not be told as what is allowed.
            if self.low <= float(told) <= self.high:
                told = f"{value!r}"
            raise InputError(f"{name} = {self.with_unit(told)}: allowed is {self.range_text()}")


NAMING = ("name", "body")
"""First fields, or arguments, that say whose the others are."""


def quantity(
    default: float | int | None,
    unit: str,
    low: float,
    high: float,
    status: str,
    text: str,
    *,
    open_low: bool = False,
    whole: bool = False,
) -> Any:
    """A dataclass field that carries its meaning; a default of None may stay None."""
    meaning = Meaning(unit, low, high, status, text, open_low, whole)
    return field(default=default, metadata={"meaning": meaning})


def count(default: int | None, low: int, high: int, status: str, text: str) -> Any:
    """A dataclass field for a whole number without a unit."""
    return quantity(default, "", low, high, status, text, whole=True)


@dataclass(frozen=True)
class Choice:
    """A named choice: the allowed words and what they decide.

    Attributes
    ----------
    own : tuple of str
        What a function of one's own, in place of a word, may ask for; empty: none is allowed.
    several : bool
        Whether the words can be taken together, but for the last, which stands for none of them:
        side by side where each has one letter, else with commas between.
    """

    words: tuple[str, ...]
    text: str
    own: tuple[str, ...] = ()
    several: bool = False

    unit: ClassVar[str] = ""

    @property
    def _between(self) -> str:
        return "" if all(len(word) == 1 for word in self.words[:-1]) else ","

    def together(self, words: Iterable[str]) -> str:
        """Several words as one value, in the order in which they are allowed."""
        taken = set(words)
        return self._between.join(own for own in self.words[:-1] if own in taken) or self.words[-1]

    def apart(self, value: str) -> tuple[str, ...]:
        """The words that a value puts together."""
        if value == self.words[-1]:
            return ()
        if "," in value or self._between:
            return tuple(part.strip() for part in value.split(","))
        return tuple(value)

    def listed(self) -> tuple[str, ...]:
        """Everything that is allowed, as a person reads it."""
        together = self.several and len(self.words) > 2
        several = [f"several, as {self.together(self.words)}"] if together else []
        return (*self.words, *several, *(["FILE.py:FUNCTION"] if self.own else []))

    def read(self, name: str, value: Any) -> Any:
        """One of the words, or a function of one's own; InputError where it is neither."""
        is_own = callable(value) or isinstance(value, OwnFunction | dict) or ".py:" in str(value)
        if self.own and is_own:
            return OwnFunction.asking(name, value, self.own)
        self.check(name, value)
        return value

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is one of the words."""
        if self.own and isinstance(value, OwnFunction):
            return
        if self.several and isinstance(value, str):
            parts = self.apart(value)
            if parts and len(set(parts)) == len(parts) and set(parts) <= set(self.words[:-1]):
                return
        if not (isinstance(value, str) and value in self.words):
            raise InputError(
                f"{name} = {shown(value)}: allowed is one of {', '.join(self.listed())}"
                f"{nearest(f'{value}', self.words)}"
            )


def choice(
    default: str | None,
    words: tuple[str, ...] | Callable[[Any], tuple[str, ...]],
    text: str,
    own: tuple[str, ...] = (),
    *,
    several: bool = False,
) -> Any:
    """A dataclass field that takes one of a few words, which may depend on its owner.

    See ``Choice`` for ``own`` and ``several``.
    """
    return field(default=default, metadata={"choice": (words, text, own, several)})


def choice_of(item: Field[Any], owner: Any) -> Choice | None:
    """The choice that a field made by ``choice`` offers its owner; None for any other field."""
    if "choice" not in item.metadata:
        return None
    words, *rest = item.metadata["choice"]
    return Choice(words(owner) if callable(words) else words, *rest)


@dataclass(frozen=True)
class Words:
    """A text in a form of its own, which its owner reads."""

    example: str
    text: str

    unit: ClassVar[str] = ""

    def listed(self) -> tuple[str, ...]:
        """What it may look like."""
        return (f"such as {self.example}",)


def words(default: str, example: str, text: str) -> Any:
    """A dataclass field that takes a text, which its owner checks."""
    return field(default=default, metadata={"words": Words(example, text)})


def words_of(item: Field[Any]) -> Words | None:
    """The meaning of a field made by ``words``; None for any other field."""
    found = item.metadata.get("words")
    return found if isinstance(found, Words) else None


@dataclass(frozen=True)
class NamedSets:
    """Sets of values that can be taken by name and then changed one by one."""

    sets: Mapping[str, Any]
    text: str

    @property
    def choice(self) -> Choice:
        """The names as a choice."""
        return Choice(tuple(self.sets), self.text)


def named_set(default: str, sets: Mapping[str, Any], text: str) -> Any:
    """A dataclass field that holds one of some dataclass instances with a ``name``."""
    return field(default=sets[default], metadata={"sets": NamedSets(sets, text)})


def sets_of(item: Field[Any]) -> NamedSets | None:
    """The sets of a field made by ``named_set``; None for any other field."""
    found = item.metadata.get("sets")
    return found if isinstance(found, NamedSets) else None


@dataclass(frozen=True)
class Kinds:
    """Data classes of which one may be taken by its ``kind``, and its fields set one by one."""

    kinds: Mapping[str, Any]
    text: str

    @property
    def choice(self) -> Choice:
        """The kinds, and none of them, as a choice."""
        return Choice((NONE, *self.kinds), self.text)


NONE = "none"


def one_of(kinds: Mapping[str, Any], text: str) -> Any:
    """A dataclass field that holds an instance of one of some data classes, or None."""
    return field(default=None, metadata={"kinds": Kinds(kinds, text)})


def kinds_of(item: Field[Any]) -> Kinds | None:
    """The kinds of a field made by ``one_of``; None for any other field."""
    found = item.metadata.get("kinds")
    return found if isinstance(found, Kinds) else None


def of_kind(kinds: Mapping[str, Any], stored: Mapping[str, Any] | None) -> Any:
    """One of some data classes from its kind and its fields as plain data, or None."""
    if stored is None:
        return None
    values = dict(stored)
    kind = values.pop("kind")
    Choice(tuple(kinds), "").check("kind", kind)
    return kinds[kind](**values)


def plain_of(owner: Any) -> dict[str, Any]:
    """A data class as plain data; what is one of some kinds says which."""
    found = asdict(owner)
    for item in fields(owner):
        value = getattr(owner, item.name)
        if kinds_of(item) is not None and value is not None:
            found[item.name] = {"kind": value.kind, **found[item.name]}
    return found


def check_fields(owner: Any) -> None:
    """Check every quantity and choice of a dataclass instance; of one with a name it is told."""
    first = fields(owner)[0].name
    whose = f" of {getattr(owner, first)}" if first in NAMING else ""
    for item in fields(owner):
        value = getattr(owner, item.name)
        meaning, words = meaning_of(item), choice_of(item, owner)
        if meaning is not None and not (value is None and item.default is None):
            meaning.check(f"{item.name}{whose}", value)
        if words is not None:
            words.check(item.name, value)
        if words_of(item) is not None and not isinstance(value, str):
            raise InputError(f"{item.name}{whose} = {shown(value)}: a text is expected")


def meaning_of(item: Field[Any]) -> Meaning | None:
    """The meaning of a field made by ``quantity``, or annotated with it; None for any other."""
    told = (item.metadata.get("meaning"), *getattr(item.type, "__metadata__", ()))
    return next((own for own in told if isinstance(own, Meaning)), None)


def _example(name: str, meaning: Meaning) -> str:
    """Words on a value that may be typed, common where that is allowed, else amid the range."""
    unit = meaning.unit
    if not unit:
        return ""
    text = units_of(unit)[0]
    parts = apart(text)
    common = None if parts is None else in_si(*parts, unit)
    if common is None or not meaning.allows(common):
        amid = 10.0 * meaning.low if meaning.low > 0.0 else meaning.high / 2.0
        amid = float(f"{amid:.0e}")
        text = meaning.with_unit(
            meaning.typed(amid if meaning.allows(amid) else meaning.high, -1.0)
        )
    return f", for instance {name}={text!r}"


def parse_quantity(name: str, text: str, meaning: Meaning) -> float | int:
    """Read a value with its unit and check its range.

    A quantity with a dimension needs its unit: 0.8 could be metres or millimetres,
    and a silent guess is worse than a question.
    """
    unit, parts = meaning.unit, apart(text)
    if parts is None or (unit and not parts[1]):
        fault = f"is not a number{' with a unit' * bool(unit)}" if parts is None else "has no unit"
        raise InputError(
            f"{name} = {text!r} {fault}{_example(name, meaning)}; allowed is {meaning.range_text()}"
        )
    if not unit and parts[1]:
        raise InputError(f"{name} = {text!r}: a pure number, without unit, is expected")
    value = in_si(*parts, unit)
    if value is None:
        raise InputError(f"{name} = {text!r}: {unknown('unit', parts[1], units_of(unit)[1])}")
    number: float | int = int(value) if meaning.whole and value.is_integer() else value
    meaning.check(name, number)
    return number
