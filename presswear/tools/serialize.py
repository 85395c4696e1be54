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
_NAMES = ("name", "body")  # first fields by which messages tell the owner


def check_fields(owner: Any) -> None:
    """Convert and check all fields of a data class instance; raise InputError naming the field.

    Texts with units become numbers in SI, numbers of any kind Python numbers, sequences
    tuples, mappings the data classes of the annotation.
    """
    items = [item for item in fields(owner) if item.init]
    first = items[0].name
    label = getattr(owner, first)
    whose = f" of {label}" if first in _NAMES and isinstance(label, str) else ""
    for item in items:
        result = value = getattr(owner, item.name)
        name = item.name if item.name == first else f"{item.name}{whose}"
        meaning = meaning_of(item, owner)
        is_optional = item.default is None or NoneType in get_args(item.type)
        is_none = isinstance(value, str) and value == NONE
        if is_optional and isinstance(meaning, Quantity) and is_none:
            result = None
        elif value is not None or not is_optional:
            kind = item.type if meaning is None else Annotated[Any, meaning]
            result = converted(name, value, kind)
        if result is not value:
            object.__setattr__(owner, item.name, result)


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
    """Add the fields of a data class that have a range to its docstring, if it does not tell them.

    ``example`` is an instance, where the words of a choice depend on it.
    """
    text = inspect.cleandoc(owner.__doc__ or "")
    described = {line.partition(" : ")[0] for line in text.splitlines()}
    lines = []
    for item in fields(cast(Any, owner)):
        meaning = meaning_of(item, example)
        default = item.default
        if item.name in described or meaning is None:
            continue
        if isinstance(meaning, Choice):
            allowed = ", ".join(meaning.allowed())
            default = meaning.shown(default)
        else:
            allowed = meaning.range_text()
        ending = "" if default is MISSING else f", default {default}"
        lines.append(f"{item.name} : {allowed}{ending}\n    {meaning.text}")
    if lines:
        owner.__doc__ = "\n".join([text, "", "Parameters", "----------", *lines])
    return owner


def converted(name: str, value: Any, kind: Any) -> Any:
    """Return a value as its annotation says; raise InputError with its name.

    The second argument of ``Annotated`` is a ``Quantity`` or has a method ``convert``
    alike.
    """
    origin = get_origin(kind) or kind
    inner = get_args(kind)
    if kind is Any:
        return value
    if origin is Annotated:
        return inner[1].convert(name, value)
    if origin in (Union, UnionType):
        return _as_one_of(name, value, kind)
    if origin in (tuple, Sequence):
        return _as_tuple(name, value, kind)
    if origin is Mapping and isinstance(value, Mapping):
        result = {}
        for key, item in value.items():
            word = converted(f"name in {name}", key, inner[0])
            result[word] = converted(_part_name(name, f".{key}"), item, inner[1])
        return result
    if kind in (float, int):
        number = plain_number(value)
        if isinstance(number, int | kind) and not isinstance(number, bool):
            if -LARGEST <= number <= LARGEST:
                return kind(number)
            raise InputError(f"{refusal(name, value, kind)}, {LARGEST:g} at most")
    elif origin is Literal:
        Choice(inner).check(name, value)
        return value
    elif is_dataclass(origin) and isinstance(value, Mapping):
        return make(name, cast(Any, origin), value)
    elif isinstance(value, origin):
        return value
    raise refusal(name, value, kind)


def _part_name(name: str, part: str) -> str:
    head, of, owner = name.partition(" of ")
    return f"{head}{part}{of}{owner}"


def _as_one_of(name: str, value: Any, kind: Any) -> Any:
    """Return a value as the first type of a union that takes it."""
    kinds = get_args(kind)
    deeper = None
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
                deeper = deeper or error
    raise deeper or refusal(name, value, kind)


def _misfit(kind: Any, data: Mapping[str, Any]) -> tuple[int, int]:
    """Return how many keys of plain data a data class lacks, and how many are missing there."""
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
    return tuple(
        converted(_part_name(name, f"[{k}]"), row, kinds[k])
        for k, row in enumerate(rows)
    )


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
        first = {"kind": kind} if isinstance(kind, str) else {}
        items = (
            item.name
            for item in fields(value)
            if item.init and item.metadata != NOT_STORED
        )
        return first | {name: plain(getattr(value, name)) for name in items}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    number = plain_number(value)
    return None if isinstance(number, float) and not math.isfinite(number) else number


def from_plain(kind: Callable[..., T], data: Any, place: str) -> T:
    """Return a data class from what ``plain`` returned; nothing is filled in.

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


def _missing_keys(whole: Any, data: Any) -> Iterator[str]:
    """Yield names in nested plain data that other plain data lack."""
    if isinstance(whole, Mapping) and isinstance(data, Mapping):
        yield from whole.keys() - data.keys()
        for name in whole.keys() & data.keys():
            yield from _missing_keys(whole[name], data[name])


def typed(data: Any, kind: type[T], place: str) -> T:
    """Return plain data as the type that describes them, by msgspec; other keys are left out.

    InputError names the place of the first value that is missing or of a wrong type.
    """
    import msgspec  # only where something is read

    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        fault, _, inner = str(error).partition(" - at `$")
        inner = inner.strip(".`")
        where = f"{place}: {inner}" if inner else place
        raise InputError(f"{where}: {fault}" if where else fault) from None


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
    # JSON's true equals 1 and 2.0 equals 2, but neither is a schema.
    if type(document.get("schema")) is not int or document["schema"] != schema:
        stored = document.get("schema")
        raise InputError(f"{file} has schema {stored!r}; this version reads {schema}")
    return document


def write_json(file: Path, document: Mapping[str, Any]) -> None:
    """Write a document whole or not at all."""
    write_bytes(file, json.dumps(plain(document), indent=1, allow_nan=False).encode())
