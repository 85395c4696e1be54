"""Choices: fields that take one of a few words, a named instance or a kind of part."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from presswear.tools.errors import InputError, nearest, shown
from presswear.tools.not_modelled import not_modelled
from presswear.tools.user_function import UserFunction

NONE = "none"  # word for an optional part that is absent
ON = "on"  # word for an optional part of the only kind there is


@dataclass(frozen=True)
class Choice:
    """Field that takes one of a few words, a named instance, a kind of part, or a free text."""

    # allowed words, or a function of the owner that returns them
    words: tuple[str, ...] | Any
    text: str = ""
    parameters: tuple[str, ...] = ()  # allowed in a user function in place of a word
    # Words can be combined, except for the last one, which stands for none of them.
    # Words of one letter may be written side by side, others with commas between.
    several: bool = False
    # by name; the field holds one, or a changed one
    instances: Mapping[str, Any] | None = None
    # fields that no named instance states: they stay when another name is chosen
    stays: tuple[str, ...] = ()
    # classes by kind; the field holds an instance, or None
    kinds: Mapping[str, Any] | None = None
    # first values of a part that is either ``on`` or absent: those without a default
    needed: Mapping[str, Any] = field(default_factory=dict, hash=False)
    example: str = ""  # example of a free text, which its owner parses

    unit: ClassVar[str] = ""

    @property
    def is_part(self) -> bool:
        """True where the field holds a data class."""
        return self.instances is not None or self.kinds is not None

    def combine(self, words: Iterable[str]) -> str:
        """Return several words as one value, in the order in which they are allowed."""
        chosen = set(words)
        ordered = [word for word in self.words[:-1] if word in chosen]
        if not ordered:
            return str(self.words[-1])
        joined = "".join(ordered)
        are_letters = len(joined) == len(ordered)
        if are_letters and joined not in self.words:
            return joined
        return ",".join(ordered)

    def split(self, value: str) -> tuple[str, ...]:
        """Return the words of a combined value."""
        if value == self.words[-1]:
            return ()
        if value not in self.words and set(value) <= set(self.words):
            return tuple(value)
        return tuple(word.strip() for word in value.split(","))

    def allowed(self) -> tuple[str, ...]:
        """Return the allowed values in words."""
        if self.example:
            return (f"such as {self.example}",)
        values = [*self.words]
        if self.several and len(self.words) > 2:
            values.append(f"several together, as {self.combine(self.words)}")
        if self.parameters:
            values.append("FILE.py:FUNCTION")
        return tuple(values)

    def shown(self, value: Any) -> Any:
        """Return the word by which a field value is set: a name, a kind, or the value itself."""
        if self.instances is not None:
            for name, instance in self.instances.items():
                if self._with_fields_that_stay(instance, value) == value:
                    return name
            return "custom"
        if self.kinds is not None:
            return NONE if value is None else getattr(value, "kind", ON)
        return value

    def chosen(self, name: str, value: Any, before: Any) -> Any:
        """Return the field value as ``convert`` does, with the fields that stay as before.

        The value ``before`` is returned if it is that of the word.
        """
        if value is before or value == self.shown(before):
            return before
        result = self.convert(name, value)
        is_word = isinstance(value, str)
        return self._with_fields_that_stay(result, before) if is_word else result

    def _with_fields_that_stay(self, value: Any, before: Any) -> Any:
        if not self.stays:
            return value
        return replace(value, **{key: getattr(before, key) for key in self.stays})

    def convert(self, name: str, value: Any) -> Any:
        """Return the field value for a word, an instance or stored data; raise InputError."""
        if self.kinds is not None and value is not None:
            return self._convert_part(self.kinds, name, value)
        if self.instances is not None:
            return self._convert_instance(self.instances, name, value)
        is_function = callable(value) or isinstance(value, UserFunction | dict)
        if self.parameters and (is_function or ".py:" in str(value)):
            return UserFunction.read(name, value, self.parameters)
        if self.kinds is None:
            self.check(name, value)
        return value

    def with_numbers(self, name: str, value: Any, numbers: Mapping[str, Any]) -> Any:
        """Return a user law with new values of the numbers that it has; else the value."""
        if not numbers or value in self.words:
            return value
        law = self.convert(name, value)
        names = {number.name for number in law.numbers(name, self.parameters)}
        values = {key: value for key, value in numbers.items() if key in names}
        return law.with_values(name, values, self.parameters)

    def _convert_part(self, kinds: Mapping[str, Any], name: str, value: Any) -> Any:
        """Return a part for the word of its kind, an instance or stored data."""
        if isinstance(value, tuple(kinds.values())):
            return value
        data = _by_name(value) if isinstance(value, Mapping) else {"kind": value}
        if isinstance(value, str) and value == ON:
            data |= self.needed
        kind = data.pop("kind", ON if self.needed else None)
        self.check(name, kind)
        return None if kind == NONE else kinds[kind](**data)

    def _convert_instance(
        self, instances: Mapping[str, Any], name: str, value: Any
    ) -> Any:
        """Return an instance for its name, an instance or stored data."""
        class_ = type(next(iter(instances.values())))
        if isinstance(value, class_):
            return value
        if isinstance(value, Mapping):
            return class_(**_by_name(value))
        self.check(name, value)
        return instances[value]

    def check(self, name: str, value: Any) -> None:
        """Raise InputError unless the value is one of the words or a free text."""
        if isinstance(value, str):
            if self.example or value in self.words:
                return
            words = self.split(value) if self.several else ()
            are_distinct = len(set(words)) == len(words)
            if words and are_distinct and set(words) <= set(self.words[:-1]):
                return
        if self.example:
            raise InputError(f"{name} = {shown(value)}: a text is expected")
        allowed = ", ".join(self.allowed()) + nearest(str(value), self.words)
        absent = not_modelled(str(value))
        if absent:
            allowed += f". {absent}"
        raise InputError(f"{name} = {shown(value)}: allowed is one of {allowed}")


def _by_name(data: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(key): value for key, value in data.items()}
