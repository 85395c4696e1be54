"""Data classes from plain data and back, with the one check of types and ranges.

Fields carry their meaning (``tools.quantities``) and their annotation. ``check_fields``
converts and checks all fields of an instance, so that a constructor takes numbers in
SI, texts with units, lists of any sort and plain data alike. ``plain`` and
``from_plain`` walk over the same fields.
"""

import inspect
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from numbers import Real
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    Self,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
)

import numpy as np

from presswear.tools.arguments import check_names
from presswear.tools.choices import NONE, Choice
from presswear.tools.errors import InputError, shown
from presswear.tools.fields import meaning_of
from presswear.tools.files import MOST_BYTES, read_checked, write_bytes
from presswear.tools.quantities import Quantity, plain_number
from presswear.tools.type_check import is_list, refusal

T = TypeVar("T")

LARGEST = 1e15  # largest magnitude of any number, SI: that of the stiffest contact
_MOST_PARTS = 4_000_000  # lists of a document; a sweep has one for each of its rows
NOT_STORED = {"stored": False}  # metadata of a field that plain data leave out
_NAMES = ("name", "body")  # first fields by which messages name the owner


def check_fields(owner: Any) -> None:
    """Convert and check all fields of a data class instance; raise InputError naming the field.

    Texts with units become numbers in SI, numbers of any kind Python numbers, sequences
    tuples, mappings the data classes of the annotation.
    """
    arguments = [field for field in fields(owner) if field.init]
    first = arguments[0].name
    label = getattr(owner, first)
    of_owner = f" of {label}" if first in _NAMES and isinstance(label, str) else ""
    for field in arguments:
        value = getattr(owner, field.name)
        result = value
        name = field.name if field.name == first else f"{field.name}{of_owner}"
        meaning = meaning_of(field, owner)
        is_optional = field.default is None or NoneType in get_args(field.type)
        is_none = isinstance(value, str) and value == NONE
        if is_optional and isinstance(meaning, Quantity) and is_none:
            result = None
        elif value is not None or not is_optional:
            kind = field.type if meaning is None else Annotated[Any, meaning]
            result = converted(name, value, kind)
        if result is not value:
            object.__setattr__(owner, field.name, result)


class Named:
    """Base of data classes whose constructors name the nearest to a misspelt argument."""

    def __new__(cls, *_values: Any, **named: Any) -> Self:
        """Create an instance; raise InputError for an argument that is not a field."""
        check_names(
            f"argument of {cls.__name__}",
            named,
            getattr(cls, "__dataclass_fields__", {}),
        )
        return super().__new__(cls)


class Checked(Named):
    """Base of data classes whose fields are converted and checked; see ``check_fields``."""

    def __post_init__(self) -> None:
        check_fields(self)


def documented(owner: type[T], example: T | None = None) -> type[T]:
    """Add the fields of a data class that have a range and no description to its docstring.

    ``example`` is an instance, if the words of a choice depend on it.
    """
    text = inspect.cleandoc(owner.__doc__ or "")
    described = {line.partition(" : ")[0] for line in text.splitlines()}
    lines = []
    for field in fields(cast(Any, owner)):
        meaning = meaning_of(field, example)
        default = field.default
        if field.name in described or meaning is None:
            continue
        if isinstance(meaning, Choice):
            allowed = ", ".join(meaning.allowed())
            default = meaning.shown(default)
        else:
            allowed = meaning.range_text()
        ending = "" if default is MISSING else f", default {default}"
        lines.append(f"{field.name} : {allowed}{ending}\n    {meaning.text}")
    if lines:
        owner.__doc__ = "\n".join([text, "", "Parameters", "----------", *lines])
    return owner


def converted(name: str, value: Any, kind: Any) -> Any:
    """Return a value as its annotation says; raise InputError with its name.

    The second argument of ``Annotated`` is a ``Quantity``, or has a method ``convert`` with
    the same arguments.
    """
    origin = get_origin(kind) or kind
    arguments = get_args(kind)
    if kind is Any:
        return value
    if origin is Annotated:
        _, meaning = arguments
        return meaning.convert(name, value)
    if origin in (Union, UnionType):
        return _as_one_of(name, value, kind)
    if origin in (tuple, Sequence):
        return _as_tuple(name, value, kind)
    if origin is Mapping and isinstance(value, Mapping):
        key_kind, item_kind = arguments
        result = {}
        for key, item in value.items():
            checked_key = converted(f"name in {name}", key, key_kind)
            item_name = _part_name(name, f".{key}")
            result[checked_key] = converted(item_name, item, item_kind)
        return result
    if kind in (float, int):
        number = plain_number(value)
        if isinstance(number, int | kind) and not isinstance(number, bool):
            if -LARGEST <= number <= LARGEST:
                return kind(number)
            raise InputError(f"{refusal(name, value, kind)}, {LARGEST:g} at most")
    elif origin is Literal:
        Choice(arguments).check(name, value)
        return value
    elif is_dataclass(origin) and isinstance(value, Mapping):
        return make(name, cast(Any, origin), value)
    elif isinstance(value, origin):
        return value
    raise refusal(name, value, kind)


def _part_name(name: str, suffix: str) -> str:
    """Return the name of a part of a value: ``table of A`` gives ``table[0] of A``."""
    head, separator, owner = name.partition(" of ")
    return f"{head}{suffix}{separator}{owner}"


def _as_one_of(name: str, value: Any, kind: Any) -> Any:
    """Return a value as the first type of a union that takes it."""
    kinds = get_args(kind)
    first_error = None
    classes: list[Any] = [member for member in kinds if is_dataclass(member)]
    takes_mapping = any(get_origin(member) is Mapping for member in kinds)
    if isinstance(value, Mapping) and classes and not takes_mapping:
        nearest = min(classes, key=lambda member: _misfit(member, value))
        return make(name, nearest, value)
    for member in kinds:
        try:
            return converted(name, value, member)
        except InputError as error:
            # The value as a whole is of this type, but a part of it is not.
            if isinstance(value, Real) or not str(error).startswith(f"{name} = "):
                first_error = first_error or error
    raise first_error or refusal(name, value, kind)


def _misfit(kind: Any, data: Mapping[str, Any]) -> tuple[int, int]:
    """Return how many keys of data a class lacks, and how many of the class data lack."""
    parameters = inspect.signature(kind).parameters
    needed = {key for key, item in parameters.items() if item.default is item.empty}
    return len(data.keys() - parameters.keys()), len(needed - data.keys())


def _as_tuple(name: str, value: Any, kind: Any) -> tuple[Any, ...]:
    if not is_list(value):
        raise refusal(name, value, kind)
    kinds = get_args(kind)
    rows = list(value)
    if get_origin(kind) is not tuple or kinds[-1] is Ellipsis:
        kinds = (kinds[0],) * len(rows)
    if len(rows) != len(kinds):
        raise InputError(f"{name} = {shown(value)}: a list of {len(kinds)} is expected")
    result = []
    for k, row in enumerate(rows):
        result.append(converted(_part_name(name, f"[{k}]"), row, kinds[k]))
    return tuple(result)


def make(place: str, kind: Callable[..., T], data: Any) -> T:
    """Call a data class or a function with plain data as its arguments.

    InputError names the place and the key that is unknown or missing, or the value that
    does not fit.
    """
    if not isinstance(data, Mapping):
        raise InputError(f"{place} = {shown(data)}: a table is expected")
    parameters = inspect.signature(kind).parameters
    arguments = {**data}
    if isinstance(getattr(kind, "kind", None), str):
        arguments.pop("kind", None)
    check_names(f"key of {place}", arguments, parameters)
    for key, parameter in parameters.items():
        if parameter.default is parameter.empty and key not in arguments:
            raise InputError(f"{place}: {key} is missing")
    try:
        return kind(**arguments)
    except InputError as error:
        raise type(error)(f"{place}: {error}") from None


def plain(value: Any) -> Any:
    """Return data that JSON can hold: a number that is not finite becomes None.

    A data class becomes a dictionary, SI, its ``kind`` first where it has one. A class
    with a method ``as_plain`` writes itself.
    """
    if hasattr(value, "as_plain"):
        return value.as_plain()
    if is_dataclass(value):
        kind = getattr(value, "kind", None)
        data = {"kind": kind} if isinstance(kind, str) else {}
        for field in fields(value):
            if field.init and field.metadata != NOT_STORED:
                data[field.name] = plain(getattr(value, field.name))
        return data
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    number = plain_number(value)
    if isinstance(number, float) and not math.isfinite(number):
        return None
    return number


def from_plain(kind: Callable[..., T], data: Any, place: str) -> T:
    """Return a data class from a result of ``plain``; missing keys get no default value.

    InputError names the place and the first key that does not fit or is missing.
    """
    try:
        result = make(place, kind, data)
    except (AttributeError, KeyError, TypeError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{place}: {error}") from None
    for key in _missing_keys(plain(result), data):
        raise InputError(f"{place}: {key!r} is missing")
    return result


def _missing_keys(complete: Any, data: Any) -> Iterator[str]:
    """Yield names in nested plain data that other plain data lack."""
    if isinstance(complete, Mapping) and isinstance(data, Mapping):
        yield from complete.keys() - data.keys()
        for name in complete.keys() & data.keys():
            yield from _missing_keys(complete[name], data[name])


def typed(data: Any, kind: type[T], place: str) -> T:
    """Return plain data as the type that describes them, by msgspec; other keys are left out.

    InputError names the place of the first value that is missing or of a wrong type.
    """
    import msgspec  # only where something is read

    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        fault, _, path = str(error).partition(" - at `$")
        places = [text for text in (place, path.strip(".`")) if text]
        raise InputError(": ".join([*places, fault])) from None


def read_json(
    file: Path, missing: str, schema: int, most: int = MOST_BYTES
) -> dict[str, Any]:
    """Read a document of one schema, all of whose numbers are finite.

    InputError with the message ``missing`` where there is no such file, and for more
    than ``most`` bytes.
    """
    import msgspec  # only where something is read

    if not file.is_file():
        raise InputError(missing)
    data = read_checked(file, most=most)
    parts = data.count(b"[") + data.count(b"{")
    # An empty list has two bytes in the file and 56 in memory.
    if parts > _MOST_PARTS:
        raise InputError(
            f"{file} has {parts:,} lists: at most {_MOST_PARTS:,} are expected"
        )
    try:
        document: dict[str, Any] = msgspec.json.decode(data, type=dict[str, Any])
    except (ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None
    stored = document.get("schema")
    # JSON's true equals 1 and 2.0 equals 2, but neither is a schema.
    if type(stored) is not int or stored != schema:
        raise InputError(f"{file} has schema {stored!r}; this version reads {schema}")
    return document


def write_json(file: Path, document: Mapping[str, Any]) -> None:
    """Write a document whole or not at all."""
    write_bytes(file, json.dumps(plain(document), indent=1, allow_nan=False).encode())
