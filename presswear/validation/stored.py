"""Trials as files: data classes as plain data and back, and documents of them."""

import platform
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from presswear.tools.documents import typed, write_json
from presswear.tools.errors import InputError


def as_plain(owner: Any) -> Any:
    """A data class, and those inside it, as plain data.

    It is its fields; before them its ``word``, where it has one, and behind them the properties
    that its ``DERIVED`` names, for other programs.  One that has ``as_dict`` says itself what it
    is.
    """
    if hasattr(owner, "as_dict"):
        return owner.as_dict()
    if is_dataclass(owner):
        word = ("word",) if hasattr(owner, "word") else ()
        names = (*word, *(item.name for item in fields(owner)), *getattr(owner, "DERIVED", ()))
        return {name: as_plain(getattr(owner, name)) for name in names}
    if isinstance(owner, Mapping):
        return {name: as_plain(value) for name, value in owner.items()}
    if isinstance(owner, list | tuple):
        return [as_plain(value) for value in owner]
    return owner


def restored(kind: Any, data: Any, place: str = "it") -> Any:
    """Make a value of an annotated kind from what ``as_plain`` gave.

    Parameters
    ----------
    place : str
        Where the data stand, for messages.

    Raises
    ------
    InputError
        AdvanceObserver the place of the first value that is missing or of a wrong kind.
    """
    inner = get_args(kind)
    if not _holds_class(kind):
        return typed(data, kind, place)
    if isinstance(kind, UnionType):
        if data is None and NoneType in inner:
            return None
        words = {getattr(one, "word", ""): one for one in inner if one is not NoneType}
        word = typed(typed(data, dict[str, Any], place).get("word", ""), str, f"{place}.word")
        if word not in words:
            raise InputError(f"{place}: the word {word!r} is unknown")
        return restored(words[word], data, place)
    if get_origin(kind) is tuple:
        items = typed(data, list[Any], place)
        return tuple(restored(inner[0], item, place) for item in items)
    own = typed(data, dict[str, Any], place)
    if inner:
        return {name: restored(inner[1], value, f"{place}.{name}") for name, value in own.items()}
    if hasattr(kind, "from_dict"):
        return kind.from_dict(own)
    kinds = get_type_hints(kind)
    names = [item.name for item in fields(kind)]
    for name in names:
        if name not in own:
            raise InputError(f"{place}.{name} is missing")
    return kind(**{name: restored(kinds[name], own[name], f"{place}.{name}") for name in names})


def _holds_class(kind: Any) -> bool:
    return is_dataclass(kind) or any(map(_holds_class, get_args(kind)))


def write_document(folder: Path, name: str, schema: int, owner: Any) -> None:
    """Write something as a JSON file into a folder, which is made where needed."""
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / name, {"schema": schema, **as_plain(owner)})


def processor_name() -> str:
    """Name that the operating system gives to the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"
